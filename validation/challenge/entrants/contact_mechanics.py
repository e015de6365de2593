"""ContactMechanics and Adhesion (extra `peers`) on a uniform grid, driven as their documentation says.

Without adhesion: constrained conjugate gradients of Polonsky and Keer (1999) at a given load.  With it: an exponential
cohesive law minimised at a given mean gap by those of Bugnicourt et al. (2018), along the path of separations.  JKR is
the limit of a range rho of zero, which the grid keeps from it: rho = sqrt(c dx gamma / E*), so that cohesion acts along
c = 8 spacings beside an edge; with fewer, edges are held by the lattice.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from validation.challenge.entrants.uniform_grid import Grid, OnGrid, affordable, answers
from validation.references.fft_adhesion import CohesiveGrid, missing
from validation.references.fft_solver import pressed

if missing():
    raise ModuleNotFoundError(missing())

SPACINGS = 8
STEP = 0.1  # of the path, in the span of the separations
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
    loads = map(float, grid.problem["path"]["targets"])
    return [OnGrid(*pressed(height, grid.period, grid.modulus, load)[:2], load) for load in loads]


def _adhesive(grid: Grid) -> list[OnGrid]:
    (height, slope), adhesion, path = grid.profile(), grid.problem["adhesion"], grid.problem["path"]
    top = float(np.sum(np.abs(grid.problem["profile"]["amplitudes"]))) if path["control"] == "penetration" else 0.0
    targets = top - path["targets"] if path["control"] == "penetration" else path["targets"]
    gamma = adhesion["work_of_adhesion"]
    rho = float(np.sqrt(SPACINGS * grid.period / grid.points * gamma / grid.modulus))
    counted = slope if adhesion["slope_term"] else 0.0
    system = CohesiveGrid(height, counted, grid.period, grid.modulus, (gamma, rho))
    states, gap, mean = [], height.max() - height, float(np.mean(height.max() - height))
    for target in targets:
        steps = max(1, int(np.ceil(abs(mean - target) / (STEP * np.ptp([*targets, height.max()])))))
        for separation in np.linspace(mean, target, steps + 1)[1:]:
            gap, _ = system.relaxed(np.maximum(gap + separation - mean, 0.0), float(separation), ITERATIONS)
            mean = float(separation)
        states.append(OnGrid(gap, gap <= 0, system.load(gap)[0]))
    return states


on_256, on_512, on_1024, on_2048 = (partial(solve, points=n) for n in (256, 512, 1024, 2048))
