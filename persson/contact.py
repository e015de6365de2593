"""Contact with adhesion by the theory, as `solve` returns it, in SI units.

Arrays over magnification belong to the nodes of the mesh on which the state was found (`slope_variances`); at a
wavenumber of the spectrum or any other they are interpolated.  Source: persson/adhesive.py.  Limits: P(sigma) is
interpolated through the finite volumes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import PchipInterpolator

from persson.adhesive import AdhesiveFields
from persson.diffusion import REACH, StressDistribution, march
from persson.mathematics.arrays import FloatArray
from persson.nonadhesive import power
from persson.spectrum import Spectrum
from persson.status import Status, advice_for

CELLS_PER_DEVIATION = 80


@dataclass(frozen=True, eq=False)
class AdhesiveContact:
    """Solution of the theory with adhesion at one load.

    Attributes
    ----------
    contact_fraction : float
        A/A0 with all roughness resolved.
    separation : float or None
        Distance of the mean planes, m; None without `with_separation`.
    status : str
        Key of the table in status.py; `advice` states the action to take.
    zero_load_contact_fraction : float or None
        A/A0 to which contact tends at zero load, where it coexists with separation; None where it vanishes.
    fields : AdhesiveFields
        The state at all magnifications, dimensionless.
    """

    spectrum: Spectrum
    mean_pressure: float
    plane_strain_modulus: float
    work_of_adhesion: float
    contact_fraction: float
    separation: float | None
    status: Status
    zero_load_contact_fraction: float | None
    fields: AdhesiveFields

    @property
    def advice(self) -> str:
        """Meaning of the status, and the action to take."""
        return advice_for(self.status)

    @property
    def elastic_energy(self) -> float:
        """J/m^2 of nominal area, without the mean compression."""
        return self.plane_strain_modulus * float(self.fields.energy[0, 0])

    @property
    def total_energy(self) -> float:
        """U_el - gamma A M in J/m^2 of nominal area."""
        return self.plane_strain_modulus * float(self.fields.total_energy[0])

    @property
    def adhesion_energy(self) -> float:
        """-gamma A M in J/m^2 of nominal area; M = <sqrt(1 + h'^2)>, the true length over the projected one."""
        return self.total_energy - self.elastic_energy

    @property
    def detachment_stress(self) -> float:
        """sigma_a at the largest wavenumber, Pa."""
        return self.plane_strain_modulus * float(self.fields.barrier[0, -1])

    @property
    def slope_variances(self) -> FloatArray:
        """S at the nodes, (n + 1,)."""
        return self.fields.problem.mesh.slope_variance

    @property
    def wavenumbers(self) -> FloatArray:
        """q just below the nodes, rad/m, (n + 1,)."""
        return self.fields.problem.mesh.before

    @property
    def areas(self) -> FloatArray:
        """A/A0 at the nodes, (n + 1,)."""
        return np.asarray(self.fields.area[0])

    @property
    def effective_work(self) -> FloatArray:
        """gamma_eff in J/m^2 at the nodes, (n + 1,); negative where roughness undoes adhesion."""
        return np.asarray(self.plane_strain_modulus * self.fields.work[0])

    @property
    def detachment_stresses(self) -> FloatArray:
        """sigma_a in Pa just below the nodes, (n + 1,)."""
        return np.asarray(self.plane_strain_modulus * self.fields.barrier[0])

    @property
    def contact_fractions(self) -> FloatArray:
        """A/A0 when the wavenumbers of the spectrum up to q_m are resolved, (n,)."""
        return np.asarray(PchipInterpolator(self.slope_variances, self.areas)(self.spectrum.slope_variance))

    def contact_fraction_at(self, wavenumber: float) -> float:
        """Return A/A0 with the roughness up to a wavenumber (rad/m) resolved."""
        variance = self.spectrum.resolved_variance(wavenumber)
        return float(PchipInterpolator(self.slope_variances, self.areas)(variance))

    def displacement_power(self, period_wavenumber: float | None = None) -> FloatArray:
        """Return C_u = C A(q)/A0 in m^3 at the wavenumbers of the spectrum; lines need q0 of their period 2 pi / q0."""
        return power(self.spectrum, period_wavenumber) * self.contact_fractions

    def pressure_power(self, period_wavenumber: float | None = None) -> FloatArray:
        """Return C_sigma = E*^2 q^2 C_u / 4 in Pa^2 m at the wavenumbers of the spectrum."""
        stiffness = self.plane_strain_modulus * self.spectrum.wavenumbers / 2
        return np.asarray(stiffness**2 * self.displacement_power(period_wavenumber))

    def stress_distribution(self, wavenumber: float | None = None) -> StressDistribution:
        """Return P in finite volumes, in units of E*, with the roughness up to a wavenumber (rad/m) resolved."""
        mesh = self.fields.problem.mesh
        total = float(mesh.slope_variance[-1])
        resolved = total if wavenumber is None else min(self.spectrum.resolved_variance(wavenumber), total)
        if resolved == 0:
            raise ValueError(f"wavenumber: {wavenumber} resolves no roughness; P is a delta function there (rad/m)")
        if resolved == total and self.fields.distribution is not None:
            return self.fields.distribution
        before_end = mesh.slope_variance < resolved * (1 - 1e-12)
        barrier = mesh.smoothed(self.fields.barrier)[0]
        barrier[0] = barrier[1]
        square = np.interp(resolved, mesh.slope_variance, barrier**2)
        spread = mesh.stress_variance
        nodes = np.append(spread[before_end], np.interp(resolved, mesh.slope_variance, spread))
        path = np.append(barrier[before_end], np.sqrt(square))
        loads = self.fields.problem.loads[:1]
        deviations = (float(loads[0] + path[-1]) / np.sqrt(nodes[-1])) + REACH
        n_cells = int(np.ceil(CELLS_PER_DEVIATION * deviations))
        return march(loads, nodes, path[None, :], n_cells).distribution

    def pressure_distribution(self, pressure: ArrayLike, wavenumber: float | None = None) -> FloatArray:
        """Return P(sigma) per nominal area in 1/Pa at pressures in Pa, tension < 0; the integral of P is A/A0."""
        distribution = self.stress_distribution(wavenumber)
        faces, density = distribution.faces[0], distribution.density[0]
        points = np.concatenate([faces[:1], (faces[1:] + faces[:-1]) / 2])
        interpolant = PchipInterpolator(points, np.concatenate([[0.0], density]), extrapolate=False)
        value = interpolant(np.asarray(pressure, dtype=np.float64) / self.plane_strain_modulus)
        return np.asarray(np.nan_to_num(value, nan=0.0) / self.plane_strain_modulus)
