"""Persson's theory corrected for partial contact: the entry, without and with adhesion.

`solve` is the plain theory's solver with one more thing: a `Correction` (corrected_variance.py), one of `LITERATURE` or
the one calibrated for roughness in one direction (`calibrated`).  Without adhesion

    A/A0 = erf(sigma_0 / sqrt(2 tau)),   U_el / (A0 E*) = int (A/A0) S dV / q,   s = s_plain + int (U - U_plain)' d ln p

with the variance tau of the correction (a drift has none: the stress is marched, diffusion.py); with adhesion the
fixed point of adhesive.py with A S in the energy and the corrected variance, and the correction's own detached width;
or, where the correction has `edges`, area, distribution and the changes of energy and separation by adhesive_edges.py
and edge_distribution.py, and the area without adhesion, on which they build, by contact_slope.py.

Source: corrected_variance.py; separation: C. Yang, B. N. J. Persson, J. Phys.: Condens. Matter 20 (2008) 215214.  SI
units at the edge.  Limits: those of the plain theory; where a correction was found and tested is in its `range`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import PchipInterpolator
from scipy.special import erfinv

from persson import adhesive_edges, contact_slope
from persson.contact import AdhesiveContact
from persson.corrected_data import calibrated, calibration
from persson.corrected_variance import Correction, area_at, diffused, scales_of
from persson.diffusion import SAFE, StressDistribution, march
from persson.domain import groups_of, outside, refuse_extremes
from persson.magnification import MagnificationMesh, magnification_mesh
from persson.mathematics.arrays import FloatArray
from persson.mathematics.edge_distribution import EdgeDistribution, edge_distribution, full_contact
from persson.mathematics.separation import adhesive_part, load_ladder
from persson.nonadhesive import dimensionless_load, energy_length, plane_strain_modulus, separation_length, status_of
from persson.solve import BELOW_ZERO
from persson.solve import solve as solve_plain
from persson.spectrum import Spectrum
from persson.status import Status, advice_for

GROWTH, MARCHED_GROWTH = 0.0125, 0.05  # of S from node to node
LADDER, MARCHED_LADDER = 41, 21
CELLS = 300


@dataclass(frozen=True, eq=False)
class CorrectedContact:
    """What the corrected theory says at one load, SI units.

    Attributes
    ----------
    correction : Correction
    contact_fraction : float
        A/A0.
    separation : float or None
        Distance of the mean planes, m; None if it was not asked for.
    elastic_energy : float
        J/m^2 of nominal area, without the mean compression.
    status : str
        As of the plain theory; what to do about it is in `advice`.
    work_of_adhesion : float or None
        J/m^2.
    variance : float
        tau of the stress, in units of E*^2; nan where the distribution is not two Gaussians.
    edges : EdgeDistribution or None
        Of the stress, with adhesion at the edges.
    adhesive : AdhesiveContact or None
        The whole state, with adhesion.
    """

    spectrum: Spectrum
    mean_pressure: float
    plane_strain_modulus: float
    correction: Correction
    contact_fraction: float
    separation: float | None
    elastic_energy: float
    status: Status
    work_of_adhesion: float | None = None
    variance: float = np.nan
    edges: EdgeDistribution | None = None
    adhesive: AdhesiveContact | None = None
    distribution: StressDistribution | None = field(default=None, repr=False)

    @property
    def advice(self) -> str:
        """What the status means and what to do."""
        return advice_for(self.status)

    @property
    def outside_calibration(self) -> tuple[str, ...]:
        """Where the case lies outside of the domain of the calibrated correction (domain.py); empty if nowhere.

        With adhesion, of that of the edges (adhesive_edges.py) too.
        """
        modulus = self.plane_strain_modulus
        load, work = self.mean_pressure / modulus, (self.work_of_adhesion or 0.0) / modulus
        found = groups_of(self.spectrum, load, self.contact_fraction, work)
        tables = [calibration()["domain"]] + ([adhesive_edges.data()["domain"]] if work else [])
        return tuple(dict.fromkeys(words for table in tables for words in outside(table, found)))

    def pressure_distribution(self, pressure: ArrayLike) -> FloatArray:
        """P(sigma) per nominal area in 1/Pa at pressures in Pa; its integral is A/A0."""
        if self.adhesive is not None:
            return self.adhesive.pressure_distribution(pressure)
        modulus = self.plane_strain_modulus
        stress, mean = np.asarray(pressure, dtype=np.float64) / modulus, self.mean_pressure / modulus
        if self.distribution is not None:
            faces, density = self.distribution.faces[0], self.distribution.density[0]
            points = np.concatenate([faces[:1], (faces[1:] + faces[:-1]) / 2])
            value = PchipInterpolator(points, np.concatenate([[0.0], density]), extrapolate=False)(stress)
            return np.asarray(np.nan_to_num(value, nan=0.0) / modulus)
        if self.edges is not None:
            return np.asarray(self.edges.at(stress) / modulus)
        direct = np.exp(-((stress - mean) ** 2) / (2 * self.variance))
        image = -np.expm1(-2 * stress * mean / self.variance)
        return np.where(stress > 0, direct * image / (np.sqrt(2 * np.pi * self.variance) * modulus), 0.0)


def solve(
    spectrum: Spectrum,
    mean_pressure: float,
    *,
    youngs_modulus: float,
    poisson_ratio: float,
    correction: Correction | None = None,
    work_of_adhesion: float | None = None,
    with_separation: bool = True,
    resolution: float = 1.0,
) -> CorrectedContact:
    """Contact area, separation, energy and stress distribution at one load.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
    mean_pressure : float
        sigma_0 in Pa, > 0.
    youngs_modulus, poisson_ratio : float
        E > 0 in Pa; nu in (-1, 0.5].
    correction : Correction, optional
        One of `LITERATURE`; None for `corrected_data.calibrated()`.
    work_of_adhesion : float, optional
        gamma in J/m^2, > 0; None for no adhesion.
    with_separation : bool
        False spares the ladder of loads; the separation is then None.
    resolution : float
        > 0; 2 halves the steps of every discretisation.

    Raises
    ------
    ValueError
        An argument outside its range, with its value.

    Examples
    --------
    >>> from persson.corrected_variance import LITERATURE
    >>> from persson.spectrum import DiscreteSpectrum
    >>> lines = DiscreteSpectrum.self_affine(628.3, 0.7, 50e-6, 100)
    >>> given = dict(youngs_modulus=1e6, poisson_ratio=0.5, correction=LITERATURE["yang_persson_2008"])
    >>> found = solve(lines, 6667.0, **given)
    >>> round(found.contact_fraction, 4)
    0.0865
    """
    correction = calibrated() if correction is None else correction
    modulus = plane_strain_modulus(youngs_modulus, poisson_ratio)
    load = dimensionless_load(mean_pressure, modulus)
    if work_of_adhesion is not None and not (np.isfinite(work_of_adhesion) and work_of_adhesion > 0):
        raise ValueError(f"work_of_adhesion: {work_of_adhesion} must be finite and > 0 (J/m^2)")
    refuse_extremes(spectrum, load, None if work_of_adhesion is None else work_of_adhesion / modulus)
    if work_of_adhesion is not None and not correction.edges:
        state = solve_plain(
            spectrum,
            mean_pressure,
            youngs_modulus=youngs_modulus,
            poisson_ratio=poisson_ratio,
            work_of_adhesion=work_of_adhesion,
            with_separation=with_separation,
            resolution=resolution,
            correction=correction,
        )
        assert isinstance(state, AdhesiveContact)
        return CorrectedContact(
            spectrum=spectrum,
            mean_pressure=mean_pressure,
            plane_strain_modulus=modulus,
            correction=correction,
            contact_fraction=state.contact_fraction,
            separation=state.separation,
            elastic_energy=state.elastic_energy,
            status=state.status,
            work_of_adhesion=work_of_adhesion,
            adhesive=state,
        )
    if not (np.isfinite(resolution) and resolution > 0):
        raise ValueError(f"resolution: {resolution} must be finite and > 0")
    drifts = correction.form == "drift"
    total = spectrum.total_slope_variance
    steps = MARCHED_LADDER if drifts else LADDER
    loads = load_ladder(load, total, round(steps * resolution)) if with_separation else np.array([load])
    mesh = magnification_mesh(
        spectrum,
        4 * (load / SAFE) ** 2 * 0.99,
        1 + (MARCHED_GROWTH if drifts else GROWTH) / resolution,
        substeps=round(6 * resolution) or 1,
    )
    area, spread, distribution = _fields(correction, mesh, loads, max(8, round(CELLS * resolution)))
    stored = correction.stored(mesh.stress_variance, area, scales_of(mesh))
    energy = np.sum(stored * np.diff(mesh.weight), axis=1) / 4
    separation = None
    if with_separation:
        plain = np.array([float(energy_length(spectrum, float(p), np.array([total]))[0]) for p in loads])
        separation = separation_length(spectrum, load) + adhesive_part(loads, energy - plain)
    fraction, variance, stored_energy, edges = float(area[0, -1]), float(spread[0, -1]), float(energy[0]), None
    if work_of_adhesion is not None:
        law = adhesive_edges.EdgeLaw(spectrum, work_of_adhesion / modulus)
        reference, fraction = law.at(load)
        if fraction == 1:
            stored_energy, separation = spectrum.full_contact_energy, None if separation is None else 0.0
            edges = full_contact(load, total / 4)
        else:
            shift, gained = law.changes(load, reference)
            stored_energy, separation = stored_energy + gained, None if separation is None else separation + shift
            edges = edge_distribution(reference, fraction, reference - load)
    elif correction.edges:
        fraction = float(contact_slope.contact_fractions(spectrum, np.array([load]))[0][0])
        variance = float(load / erfinv(fraction)) ** 2 / 2 if fraction < 1 else total / 4
    status = status_of(spectrum, fraction)
    if status == "converged" and separation is not None and separation < -BELOW_ZERO * spectrum.h_rms:
        status = "below_zero"
    return CorrectedContact(
        spectrum=spectrum,
        mean_pressure=mean_pressure,
        plane_strain_modulus=modulus,
        correction=correction,
        contact_fraction=fraction,
        separation=separation,
        elastic_energy=modulus * stored_energy,
        status=status,
        work_of_adhesion=work_of_adhesion,
        variance=np.nan if drifts or edges is not None else variance,
        edges=edges,
        distribution=distribution,
    )


def _fields(
    correction: Correction, mesh: MagnificationMesh, loads: FloatArray, cells: int
) -> tuple[FloatArray, FloatArray, StressDistribution | None]:
    """A/A0 and tau at the nodes, (n_loads, n + 1), and the distribution where there is a drift."""
    if correction.form != "drift":
        spread = diffused(correction, mesh, loads)
        return area_at(loads[:, None], spread), spread, None
    barrier = np.zeros((loads.size, mesh.slope_variance.size))
    scales = scales_of(mesh)
    found = march(
        loads, mesh.stress_variance, barrier, cells, lambda cell, area: correction.factor(area, scales.of(cell))
    )
    return found.area, np.broadcast_to(mesh.stress_variance, found.area.shape), found.distribution
