"""Persson's theory at one load: the public entry.

Without adhesion the answer is a closed form.  With adhesion: a fixed point on a coarse mesh for a ladder of loads
(its energies give the separation), then one on a fine mesh that crowds where the barrier leaves zero.  With much
adhesion the area does not vanish with the load: contact and separation coexist at zero load, and the state is marked
`branches`; with less of it, or at higher loads, the work balance may give a negative separation (`below_zero`).
At sigma_0 > 0 the fixed point was unique in every case tried (from no adhesion and from full contact).

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.  SI units.  Errors
of the default resolution, paper's case: area 2e-6 of its value, separation 4e-6 h_rms.
"""

from __future__ import annotations

import numpy as np

from persson.adhesive import ROUTES, AdhesionProblem, AdhesiveFields, Route, solve_fixed_point
from persson.contact import AdhesiveContact
from persson.diffusion import SAFE
from persson.magnification import MagnificationMesh, magnification_mesh
from persson.mathematics.area_factor import AREA_FACTORS
from persson.mathematics.arrays import FloatArray
from persson.mathematics.separation import adhesive_part, load_ladder
from persson.nonadhesive import (
    NonadhesiveContact,
    dimensionless_load,
    plane_strain_modulus,
    separation_length,
    solve_nonadhesive,
    status_of,
)
from persson.spectrum import Spectrum
from persson.status import Status

FINE_GROWTH, FINE_CELLS = 0.0125, 800
COARSE_GROWTH, COARSE_CELLS, COARSE_SUBSTEPS, COARSE_LINES = 0.05, 300, 3, 50
LADDER = 21
TOLERANCE, COARSE_TOLERANCE = 1e-9, 1e-7
BRANCHES_FROM = 0.5  # of the energy of full contact: far below the 1.5 at which branches appear
NEAR_ZERO_LOADS = (1e-4, 1e-3)  # in standard deviations of the full-contact stress
BELOW_ZERO = 1e-3  # of h_rms: ten times the error of the separation
PROPORTIONAL = 0.5  # of d ln A / d ln sigma_0 between them: 1 without branches, 0 where contact persists at zero load


def solve(
    spectrum: Spectrum,
    mean_pressure: float,
    *,
    youngs_modulus: float,
    poisson_ratio: float,
    work_of_adhesion: float | None = None,
    area_factor: str = "gaussian_slope_1d",
    detached_width: float = 1.0,
    route: Route = "finite_volumes",
    resolution: float = 1.0,
    with_separation: bool = True,
    max_iterations: int = 80,
) -> NonadhesiveContact | AdhesiveContact:
    """Compute area, separation, energies, stress distribution and spectra of a rough contact at one load.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
    mean_pressure : float
        sigma_0 in Pa, > 0.
    youngs_modulus, poisson_ratio : float
        E > 0 in Pa; nu in (-1, 0.5].
    work_of_adhesion : float, optional
        gamma in J/m^2, > 0; None for no adhesion.
    area_factor : "gaussian_slope_1d" or "isotropic_2d"
        Real over projected area of the roughness not resolved.
    detached_width : float
        In wavelengths, in (0, 1]; 0.5 raises the detachment stress by sqrt 2.
    route : "finite_volumes" or "volterra"
        Two independent solutions of the theory.
    resolution : float
        > 0; 2 halves the steps of every discretisation.
    with_separation : bool
        False spares the ladder of loads; the separation is then None.
    max_iterations : int
        Of each fixed point; a fixed point not met has status `not_converged`.

    Raises
    ------
    ValueError
        An argument outside its range, with its value.

    Examples
    --------
    >>> from persson.spectrum import DiscreteSpectrum
    >>> lines = DiscreteSpectrum.self_affine(628.3, 0.7, 50e-6, 100)
    >>> dry = solve(lines, 6667.0, youngs_modulus=1e6, poisson_ratio=0.5)
    >>> wet = solve(lines, 6667.0, youngs_modulus=1e6, poisson_ratio=0.5, work_of_adhesion=0.03)
    >>> bool(dry.contact_fraction < wet.contact_fraction), wet.status
    (True, 'converged')
    """
    if work_of_adhesion is None:
        return solve_nonadhesive(spectrum, mean_pressure, youngs_modulus=youngs_modulus, poisson_ratio=poisson_ratio)
    modulus = plane_strain_modulus(youngs_modulus, poisson_ratio)
    load = dimensionless_load(mean_pressure, modulus)
    _check(work_of_adhesion, area_factor, detached_width, route, resolution, max_iterations)
    factor, work_length = AREA_FACTORS[area_factor], work_of_adhesion / modulus
    total = spectrum.total_slope_variance
    barrier_scale = float(np.sqrt(2 * work_length * factor(total) / detached_width)) / np.pi

    def mesh(growth: float, substeps: int, lines: int, onset: float | None, lowest: float = load) -> MagnificationMesh:
        return magnification_mesh(
            spectrum,
            4 * (lowest / SAFE) ** 2 * 0.99,
            1 + growth / resolution,
            barrier_scale=barrier_scale,
            substeps=round(substeps * resolution) or 1,
            most_resolved=round(lines * resolution),
            onsets=() if onset is None else (onset,),
        )

    def fields(nodes: MagnificationMesh, loads: FloatArray, guess: FloatArray | None, coarse: bool) -> AdhesiveFields:
        problem = AdhesionProblem(spectrum, nodes, loads, work_length, factor, detached_width)
        return solve_fixed_point(
            problem,
            problem.nonadhesive_area() if guess is None else guess,
            route=route,
            n_cells=max(8, round((COARSE_CELLS if coarse else FINE_CELLS) * resolution)),
            tolerance=COARSE_TOLERANCE if coarse else TOLERANCE,
            max_iterations=max_iterations,
        )

    def refined(coarse: AdhesiveFields) -> AdhesiveFields:
        nodes = mesh(FINE_GROWTH, 6, 200, coarse.onset())
        guess = np.interp(nodes.slope_variance, coarse.problem.mesh.slope_variance, coarse.area[0])
        return fields(nodes, np.array([load]), guess[None, :], coarse=False)

    rough = mesh(COARSE_GROWTH, COARSE_SUBSTEPS, COARSE_LINES, None)
    loads = load_ladder(load, total, LADDER) if with_separation else np.array([load])
    ladder = fields(rough, loads, None, coarse=True)
    state = refined(ladder)
    persisting: float | None = None
    if work_length * float(factor(total)) > BRANCHES_FROM * spectrum.full_contact_energy:
        tiny = np.array(NEAR_ZERO_LOADS) * np.sqrt(total) / 2
        nodes = mesh(COARSE_GROWTH, COARSE_SUBSTEPS, COARSE_LINES, None, float(tiny[0]))
        guess = np.interp(nodes.slope_variance, rough.slope_variance, ladder.area[0])
        low, high = fields(nodes, tiny, np.stack([guess, guess]), coarse=True).area[:, -1]
        if np.log(high / low) < PROPORTIONAL * np.log(tiny[1] / tiny[0]):
            persisting = float(low - (high - low) * tiny[0] / (tiny[1] - tiny[0]))
    separation = None
    if with_separation:
        added = ladder.total_energy - ladder.problem.nonadhesive_energy[:, -1]
        separation = separation_length(spectrum, load) + adhesive_part(loads, added)
    status: Status = status_of(spectrum, float(state.area[0, -1]))
    if not state.converged.all() or (with_separation and not ladder.converged.all()):
        status = "not_converged"
    elif persisting is not None and status == "converged":
        status = "branches"
    elif separation is not None and separation < -BELOW_ZERO * spectrum.h_rms and status == "converged":
        status = "below_zero"
    return AdhesiveContact(
        spectrum=spectrum,
        mean_pressure=mean_pressure,
        plane_strain_modulus=modulus,
        work_of_adhesion=work_of_adhesion,
        contact_fraction=float(state.area[0, -1]),
        separation=separation,
        status=status,
        zero_load_contact_fraction=persisting,
        fields=state,
    )


def _check(
    work: float, area_factor: str, detached_width: float, route: str, resolution: float, max_iterations: int
) -> None:
    if not (np.isfinite(work) and work > 0):
        raise ValueError(f"work_of_adhesion: {work} must be finite and > 0 (J/m^2); leave it out for no adhesion")
    if area_factor not in AREA_FACTORS:
        raise ValueError(f"area_factor: {area_factor!r} must be one of {', '.join(AREA_FACTORS)}")
    if not 0 < detached_width <= 1:
        raise ValueError(f"detached_width: {detached_width} must lie in (0, 1] (wavelengths)")
    if route not in ROUTES:
        raise ValueError(f"route: {route!r} must be one of {', '.join(ROUTES)}")
    if not (np.isfinite(resolution) and resolution > 0):
        raise ValueError(f"resolution: {resolution} must be finite and > 0")
    if max_iterations < 1:
        raise ValueError(f"max_iterations: {max_iterations} must be >= 1")
