"""tamaas (extra `tamaas`) on a uniform grid, driven as its documentation says.

Its conjugate gradients of Polonsky and Keer take pressures without adhesion, and gaps with an exponential cohesive
law; mean gap or mean pressure is given.  The range of the law is that of cohesive_grid.py; a work of adhesion that
varies along the profile is not offered.  Where it stops converging, as at pull-off, the path ends: later states are
left out.
"""

from itertools import pairwise
from typing import Any

import numpy as np
import tamaas

from validation.harness.arrays import FloatArray
from validation.harness.route import Answer, Problem
from validation.references.posed_contacts import highest
from validation.routes.cohesive_grid import cohesive_range
from validation.routes.uniform_grid import Grid, OnGrid, affordable, answers

STEPS = 20  # of the path between targets; the first is solved at once
BARE, ADHESIVE = 1e-12, 1e-9  # tolerances of the solver
ITERATIONS = 30_000
TOUCHING = 1e-15  # m


def solve(problem: Problem, points: int) -> Answer:
    """The states at the targets."""
    if problem.thickness is not None:
        raise NotImplementedError("layers")
    if problem.slope_term:
        raise NotImplementedError("a work of adhesion that varies along the profile")
    tamaas.set_log_level(tamaas.LogLevel.error)
    points = affordable(problem, points)
    grid = Grid(problem, points)
    height, _ = grid.profile()
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_1d, [grid.period], [points])
    model.E, model.nu = problem.youngs_modulus, problem.poisson_ratio
    kinds = tamaas.PolonskyKeerRey
    targets = np.array(problem.targets)
    if problem.control == "penetration":
        targets = highest(problem) - targets  # separations
    if problem.work_of_adhesion is None:
        solver = kinds(model, height, BARE)
        solver.max_iter = ITERATIONS
        found = [_state(solver, model, height, float(target), BARE) for target in targets]
        return Answer(values=answers(grid, found), unknowns=points)
    by_load, work = problem.control == "mean_pressure", problem.work_of_adhesion
    solver = kinds(
        model, height, ADHESIVE, primal_type=kinds.gap, constraint_type=kinds.pressure if by_load else kinds.gap
    )
    solver.max_iter = ITERATIONS
    cohesion = tamaas.ExponentialAdhesionFunctional(height)
    cohesion.parameters = {"rho": cohesive_range(problem, points), "surface_energy": float(work)}
    solver.addFunctionalTerm(cohesion)
    states = [_state(solver, model, height, float(targets[0]), ADHESIVE)]
    for before, target in pairwise(targets):
        try:
            for step in np.linspace(before, target, STEPS + 1)[1:]:
                state = _state(solver, model, height, float(step), ADHESIVE)
        except ArithmeticError:  # where contact is lost, say; the states before are good
            break
        states.append(state)
    return Answer(values=answers(grid, states), unknowns=points)


def _state(solver: Any, model: Any, height: FloatArray, target: float, tolerance: float) -> OnGrid:
    error = solver.solve(target)
    if not error <= tolerance:
        raise ArithmeticError(f"error {error:.1e} after {ITERATIONS} iterations at {target:.3g}")
    pressure = np.array(model.traction).ravel()
    gap = np.array(model.displacement).ravel() - height
    gap -= gap.min()
    contact = pressure > 0 if tolerance == BARE else gap <= TOUCHING
    return OnGrid(gap, contact, float(pressure.mean()))
