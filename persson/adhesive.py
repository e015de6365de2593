"""Adhesion in the theory: effective work of adhesion, moving barrier, and the fixed point over all magnifications.

At a magnification where the slope variance S is resolved, the roughness not yet seen stores elastic energy and offers
more true area; what is left is the effective work of adhesion,

    gamma_eff(S) A(S) = gamma A(S_N) M(S_N - S) - U_el(S),     U_el(S) = 1/4 int_S^{S_N} A / q dS   (units of E*).

A detached zone of one wavelength, 2 pi / q, opens at a tension a E* with

    a(S) = sigma_a / E* = sqrt(2 gamma_eff+ q / w) / pi,       gamma_eff+ = max(gamma_eff / E*, 0),

w = 1 in the theory; w = 1/2, a detached width half as large, makes a larger by sqrt 2 (the paper's remark).  Stress is
absorbed at -a(S) (diffusion.py or volterra.py), which gives A(S) again: a fixed point, reached by Picard iterations
accelerated by Anderson mixing.  The nonadhesive part of U_el is exact, the rest is summed by the trapezoid rule in
W = int dS / q.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601; B. N. J. Persson,
Eur. Phys. J. E 8 (2002) 385; mixing: D. G. Anderson, J. ACM 12 (1965) 547.  Stresses in
units of E*, energies per area over E* in m.  Limits: sigma_0 > 0; gamma_eff < 0, no adhesion at that magnification,
holds the barrier at zero.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from persson.diffusion import StressDistribution, march, steps_of
from persson.magnification import MagnificationMesh
from persson.mathematics.area_factor import AreaFactor
from persson.mathematics.arrays import FloatArray, IntArray
from persson.mathematics.volterra import survival
from persson.nonadhesive import contact_fraction, energy_length
from persson.spectrum import Spectrum

BoolArray = NDArray[np.bool_]
Route = Literal["finite_volumes", "volterra"]
ROUTES: tuple[Route, ...] = ("finite_volumes", "volterra")

MIXING_DEPTH = 4


@dataclass(frozen=True, eq=False)
class AdhesionProblem:
    """Loads, work of adhesion and mesh of one fixed point; lengths in m, loads in units of E*.

    Attributes
    ----------
    loads : (n_loads,) array
        sigma_0 / E*.
    work_length : float
        gamma / E*, m.
    detached_width : float
        w, the detached width in wavelengths.
    """

    spectrum: Spectrum
    mesh: MagnificationMesh
    loads: FloatArray
    work_length: float
    area_factor: AreaFactor
    detached_width: float

    def nonadhesive_area(self) -> FloatArray:
        """Return A/A0 without adhesion at the nodes, (n_loads, n + 1)."""
        return contact_fraction(self.mesh.slope_variance, self.loads[:, None])

    @cached_property
    def nonadhesive_energy(self) -> FloatArray:
        """1/4 int_0^S A/q dS without adhesion at the nodes, (n_loads, n + 1), m."""
        nodes = self.mesh.slope_variance
        return np.stack([energy_length(self.spectrum, float(load), nodes) for load in self.loads])


@dataclass(frozen=True, eq=False)
class AdhesiveFields:
    """Solution of the fixed point at the nodes of its mesh, arrays (n_loads, n + 1).

    Attributes
    ----------
    area : A/A0.
    energy : U_el / E* of the roughness above each node, m.
    work : gamma_eff / E*, m.
    barrier : a = sigma_a / E* just below each node.
    distribution : P at the last node; None for the Volterra route.
    iterations : evaluations of the diffusion.
    converged : (n_loads,) whether the fixed point was met.
    """

    problem: AdhesionProblem
    area: FloatArray
    energy: FloatArray
    work: FloatArray
    barrier: FloatArray
    distribution: StressDistribution | None
    iterations: int
    converged: BoolArray

    @property
    def total_energy(self) -> FloatArray:
        """U_tot / (A0 E*) = U_el(S = 0) - gamma A(S_N) M(S_N) = -gamma_eff(S = 0), (n_loads,), m."""
        return -self.work[:, 0]

    def onset(self) -> float | None:
        """Return S above which the barrier of the first load stays positive.

        None if the barrier is positive everywhere.  At the last node it is that of the work of adhesion, positive.
        """
        work, nodes = self.work[0], self.problem.mesh.slope_variance
        below = np.flatnonzero(work <= 0)
        if below.size == 0:
            return None
        at = below[-1]
        return float(nodes[at] - work[at] * (nodes[at + 1] - nodes[at]) / (work[at + 1] - work[at]))


def solve_fixed_point(
    problem: AdhesionProblem,
    guess: FloatArray,
    *,
    route: Route,
    n_cells: int,
    tolerance: float,
    max_iterations: int,
) -> AdhesiveFields:
    """Solve for area, effective work of adhesion and barrier that are consistent at all magnifications.

    Parameters
    ----------
    problem : AdhesionProblem
    guess : (n_loads, n + 1) array
        A/A0 at the nodes to start from, in (0, 1].
    route : "finite_volumes" or "volterra"
    n_cells : int
        Of the finite volumes; the Volterra route has no grid in stress.
    tolerance : float
        Of max |T(A) - A| over the nodes.
    max_iterations : int
        Evaluations of the diffusion; a load that needs more is marked not converged.
    """
    known_area, known_energy = problem.nonadhesive_area(), problem.nonadhesive_energy
    factor = problem.area_factor(problem.mesh.slope_variance[-1] - problem.mesh.slope_variance)
    last: dict[int, tuple[FloatArray, FloatArray]] = {}
    every, barriers = np.arange(problem.loads.size), np.zeros(guess.shape)
    variance = problem.mesh.stress_variance

    def energy_above(area: FloatArray, rows: IntArray) -> FloatArray:
        known = (known_area[rows, 1:] + known_area[rows, :-1]) / 2
        cells = ((area[:, 1:] + area[:, :-1]) / 2 - known) * np.diff(problem.mesh.weight)
        below = known_energy[rows]
        below[:, 1:] += np.cumsum(cells, axis=1) / 4
        return np.asarray(below[:, -1:] - below)

    def work_of(area: FloatArray, rows: IntArray) -> FloatArray:
        return np.asarray((problem.work_length * area[:, -1:] * factor - energy_above(area, rows)) / area)

    def barrier_of(work: FloatArray, wavenumber: FloatArray) -> FloatArray:
        return np.asarray(np.sqrt(2 * np.maximum(work, 0) * wavenumber / problem.detached_width) / np.pi)

    def diffuse(area: FloatArray, rows: IntArray) -> FloatArray:
        work, loads = work_of(area, rows), problem.loads[rows]
        barrier = problem.mesh.smoothed(barrier_of(work, problem.mesh.before))
        barrier[:, 0] = barrier_of(work[:, :1], problem.mesh.after[:1])[:, 0]
        if route == "volterra":
            inside = problem.mesh.smoothed_inside(barrier_of((work[:, 1:] + work[:, :-1]) / 2, problem.mesh.inside))
            return np.stack(
                [survival(float(p), variance, b, m) for p, b, m in zip(loads, barrier, inside, strict=True)]
            )
        barriers[rows] = barrier
        # the step count covers all loads, so that the result does not depend on which loads are converged
        result = march(loads, variance, barrier, n_cells, steps_of(variance, barriers))
        last.update(
            zip(rows.tolist(), zip(result.distribution.faces, result.distribution.density, strict=True), strict=True)
        )
        return result.area

    area, iterations, converged = _anderson(diffuse, guess, tolerance, max_iterations)
    work = work_of(area, every)
    ends = [np.stack(part) for part in zip(*(last[load] for load in sorted(last)), strict=True)]
    return AdhesiveFields(
        problem=problem,
        area=area,
        energy=energy_above(area, every),
        work=work,
        barrier=barrier_of(work, problem.mesh.before),
        distribution=StressDistribution(*ends) if ends else None,
        iterations=iterations,
        converged=converged,
    )


def _anderson(
    mapping: Callable[[FloatArray, IntArray], FloatArray], guess: FloatArray, tolerance: float, max_iterations: int
) -> tuple[FloatArray, int, BoolArray]:
    """Find the fixed point of each row independently by Anderson mixing.

    The last step is a plain evaluation, so that area and distribution agree.

    `mapping` takes rows and their indices. Converged rows are not passed to `mapping` again.
    """
    state, image = guess.copy(), guess.copy()
    points: list[FloatArray] = []
    images: list[FloatArray] = []
    rows = np.arange(guess.shape[0])
    for iteration in range(1, max_iterations + 1):
        image[rows] = mapping(state[rows], rows)
        rows = rows[~(np.max(np.abs(image - state)[rows], axis=1) < tolerance)]
        if rows.size == 0 or iteration == max_iterations:
            break
        points, images = [*points[-MIXING_DEPTH:], state.copy()], [*images[-MIXING_DEPTH:], image.copy()]
        state[rows] = image[rows]
        for row in rows:
            mixed = _mix([p[row] for p in points], [i[row] for i in images])
            # a mixed iterate can leave the range (0, 1] of an area; a plain iterate cannot
            if np.all(mixed > 0) and np.all(mixed <= 1 + tolerance):
                state[row] = mixed
    return image, iteration, ~np.isin(np.arange(guess.shape[0]), rows)


def _mix(points: list[FloatArray], images: list[FloatArray]) -> FloatArray:
    """Return the weighted mean of the last images whose residual is smallest; the weights sum to one."""
    residuals = [image - point for image, point in zip(images, points, strict=True)]
    if len(residuals) == 1:
        return images[-1]
    differences = np.stack([residual - residuals[-1] for residual in residuals[:-1]], axis=1)
    weights = np.linalg.lstsq(differences, -residuals[-1], rcond=1e-10)[0]
    spread = np.stack([image - images[-1] for image in images[:-1]], axis=1)
    return np.asarray(images[-1] + spread @ weights)
