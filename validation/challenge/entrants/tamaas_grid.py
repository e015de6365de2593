"""tamaas (extra `tamaas`) on a uniform grid, driven as its documentation says.

Its conjugate gradients of Polonsky and Keer take pressures without adhesion, and gaps with an exponential cohesive
law; mean gap or mean pressure is given.  The range of the law is that of contact_mechanics.py; a work of adhesion that
varies along the profile is not offered.  Where it stops converging, as at pull-off, the path ends: later states are
left out.
"""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import tamaas

from validation.challenge.entrants.uniform_grid import Grid, OnGrid, affordable, answers
from validation.harness.arrays import FloatArray

SPACINGS = 8
STEPS = 20  # of the path between targets; the first is solved at once
BARE, ADHESIVE = 1e-12, 1e-9  # tolerances of the solver
ITERATIONS = 30_000
TOUCHING = 1e-15  # m


def solve(problem: dict[str, Any], points: int) -> dict[str, Any]:
    """The states at the targets."""
    if "layer" in problem:
        raise NotImplementedError("layers")
    if problem.get("adhesion", {}).get("slope_term"):
        raise NotImplementedError("a work of adhesion that varies along the profile")
    tamaas.set_log_level(tamaas.LogLevel.error)
    points = affordable(problem, points)
    grid, path = Grid(problem, points), problem["path"]
    height, _ = grid.profile()
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_1d, [grid.period], [points])
    model.E, model.nu = problem["solid"]["youngs_modulus"], problem["solid"]["poisson_ratio"]
    kinds = tamaas.PolonskyKeerRey
    targets = path["targets"]
    if path["control"] == "penetration":
        targets = float(np.sum(np.abs(problem["profile"]["amplitudes"]))) - targets  # separations; crests in phase
    if "adhesion" not in problem:
        solver = kinds(model, height, BARE)
        solver.max_iter = ITERATIONS
        return answers(grid, [_state(solver, model, height, float(target), BARE) for target in targets])
    by_load = path["control"] == "mean_pressure"
    solver = kinds(
        model, height, ADHESIVE, primal_type=kinds.gap, constraint_type=kinds.pressure if by_load else kinds.gap
    )
    solver.max_iter = ITERATIONS
    cohesion = tamaas.ExponentialAdhesionFunctional(height)
    work = problem["adhesion"]["work_of_adhesion"]
    rho = np.sqrt(SPACINGS * grid.period / points * work / grid.modulus)
    cohesion.parameters = {"rho": float(rho), "surface_energy": float(work)}
    solver.addFunctionalTerm(cohesion)
    states = [_state(solver, model, height, float(targets[0]), ADHESIVE)]
    for before, target in pairwise(targets):
        try:
            for step in np.linspace(before, target, STEPS + 1)[1:]:
                state = _state(solver, model, height, float(step), ADHESIVE)
        except ArithmeticError:  # where contact is lost, say; the states before are good
            break
        states.append(state)
    return answers(grid, states)


def _state(solver: Any, model: Any, height: FloatArray, target: float, tolerance: float) -> OnGrid:
    error = solver.solve(target)
    if not error <= tolerance:
        raise ArithmeticError(f"error {error:.1e} after {ITERATIONS} iterations at {target:.3g}")
    pressure = np.array(model.traction).ravel()
    gap = np.array(model.displacement).ravel() - height
    gap -= gap.min()
    contact = pressure > 0 if tolerance == BARE else gap <= TOUCHING
    return OnGrid(gap, contact, float(pressure.mean()))


on_512, on_1024, on_2048, on_4096 = (partial(solve, points=n) for n in (512, 1024, 2048, 4096))
