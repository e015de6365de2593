"""ContactMechanics and Adhesion (extra `peers`) on a uniform grid, driven as their documentation says.

Without adhesion: constrained conjugate gradients of Polonsky and Keer (1999) at a given load.  With it: an exponential
cohesive law minimised at a given mean gap by those of Bugnicourt et al. (2018), along the path of separations.  JKR is
the limit of a range rho of zero, which the grid keeps from it: rho = sqrt(c dx gamma / E*), so that cohesion acts along
c = 8 spacings beside an edge; with fewer, edges are held by the lattice.
"""

from __future__ import annotations

import io
from contextlib import redirect_stdout
from functools import partial
from typing import Any

import numpy as np
from Adhesion.Interactions import Exponential
from Adhesion.System import BoundedSmoothContactSystem
from ContactMechanics import PeriodicFFTElasticHalfSpace
from ContactMechanics.Systems import NonSmoothContactSystem
from NuMPI.Optimization import constrained_conjugate_gradients
from SurfaceTopography import UniformLineScan

from validation.challenge.entrants.uniform_grid import Grid, OnGrid, affordable, answers

SPACINGS = 8
STEP = 0.1  # of the path, in the span of the separations
TOLERANCE = 1e-4  # of the gradient, in the largest cohesive force on a point
OVERLAP = 1e-12  # m
ITERATIONS = 50_000


def solve(problem: dict[str, Any], points: int) -> dict[str, Any]:
    """The states at the targets."""
    if "layer" in problem:
        raise NotImplementedError("layers under lines")
    if "adhesion" in problem and problem["path"]["control"] == "mean_pressure":
        raise NotImplementedError("adhesion at a given load")
    grid = Grid(problem, affordable(problem, points))
    return answers(grid, _adhesive(grid) if "adhesion" in problem else _bare(grid))


def _bare(grid: Grid) -> list[OnGrid]:
    height, _ = grid.profile()
    states = []
    for pressure in grid.problem["path"]["targets"]:
        half_space = PeriodicFFTElasticHalfSpace((grid.points,), grid.modulus, (grid.period,))
        surface = UniformLineScan(height, grid.period, periodic=True)
        found = NonSmoothContactSystem(substrate=half_space, surface=surface).minimize_proxy(
            external_force=pressure * grid.period, pentol=OVERLAP, maxiter=ITERATIONS
        )
        if not found.success:
            raise ArithmeticError(str(found.message))
        states.append(OnGrid(found.x - height - found.offset, found.jac > 0, float(pressure)))
    return states


def _adhesive(grid: Grid) -> list[OnGrid]:
    (height, slope), adhesion, path = grid.profile(), grid.problem["adhesion"], grid.problem["path"]
    top = float(np.sum(np.abs(grid.problem["profile"]["amplitudes"]))) if path["control"] == "penetration" else 0.0
    targets = top - path["targets"] if path["control"] == "penetration" else path["targets"]
    gamma, spacing = adhesion["work_of_adhesion"], grid.period / grid.points
    rho = np.sqrt(SPACINGS * spacing * gamma / grid.modulus)
    work = gamma * (np.sqrt(1 + slope**2) if adhesion["slope_term"] else np.ones(grid.points))
    half_space = PeriodicFFTElasticHalfSpace((grid.points,), grid.modulus, (grid.period,))
    system = BoundedSmoothContactSystem(half_space, Exponential(work, rho), UniformLineScan(height, grid.period, True))
    states, gap, mean = [], height.max() - height, float(np.mean(height.max() - height))
    for target in targets:
        steps = max(1, int(np.ceil(abs(mean - target) / (STEP * np.ptp([*targets, height.max()])))))
        for separation in np.linspace(mean, target, steps + 1)[1:]:
            start = np.maximum(gap + separation - mean, 0.0)
            with redirect_stdout(io.StringIO()):  # it reports every direction of negative curvature
                found = constrained_conjugate_gradients(
                    system.primal_objective(0.0, gradient=True), system.primal_hessian_product, start,
                    mean_val=separation, gtol=TOLERANCE * gamma / rho * spacing, maxiter=ITERATIONS,
                )  # fmt: skip
            if not found.success:
                raise ArithmeticError(f"separation {separation:.3g} m: {found.message}")
            gap, mean = np.asarray(found.x, dtype=np.float64).ravel(), float(separation)
        _, force = system.primal_evaluate(gap + height, gap, pot=True, forces=True)
        uniform = float(np.mean(half_space.force))  # the package's spring of the mean displacement
        pressure = (float(np.mean(np.asarray(force).ravel()[gap > 0])) - uniform) / spacing
        states.append(OnGrid(gap, gap <= 0, pressure))
    return states


on_256, on_512, on_1024, on_2048 = (partial(solve, points=n) for n in (256, 512, 1024, 2048))
