"""Where a branch of equilibria turns: the least penetration, displacement or load that a contact can carry.

Along a branch the contact fraction a is prescribed (`closure`), which stays regular where the control turns. From a
state on the branch a is lowered in small steps on the coarse mesh until the controlled quantity q rises again; then, on
each of three meshes, q(a) is closed at five Chebyshev points about its minimum, and

    dq/da = 0

is solved on the polynomial of degree four through them. The value of q is of second order in the place, so that it is
known far better than the contact fraction. All quantities of the state there are those of their own polynomials; their
uncertainties are the spread over the meshes, as in `result`.

Limits: edges of the JKR closure, with adhesion; the fold must be met by a falling contact fraction.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.optimize import minimize_scalar

from fem_reference.closure import Closure, Control, close, scouting
from fem_reference.crests import scaled_patches
from fem_reference.mesh import Resolution
from fem_reference.problem import FloatArray, InvalidProblemError, Problem
from fem_reference.result import Result, quantities, spread
from fem_reference.solve import companions

STEP = 0.95  # factor of the contact fraction from one state of the scouting to the next
STEPS = 120
NEAR = 0.04  # of the contact fraction: half the range in which the fold is looked for on fine meshes
POINTS = 5
NUMBERS = (
    "contact_fraction",
    "penetration",
    "total_displacement",
    "mean_pressure",
    "elastic_energy",
    "adhesion_energy",
    "total_energy",
)
Turning = Literal["penetration", "total_displacement", "mean_pressure"]


@dataclass(frozen=True)
class Fold:
    """The state at a fold, SI units as in `Result`.

    Parameters
    ----------
    values, uncertainty : mapping
        From `NUMBERS` to each number and its uncertainty.
    edges : FloatArray, shape (n_patches, 2)
        At the nearest of the states computed, m.
    """

    values: Mapping[str, float]
    uncertainty: Mapping[str, float]
    edges: FloatArray


def fold(state: Result, turning: Turning) -> Fold:
    """The fold that a state meets when its contact fraction falls, on the meshes of the state.

    Parameters
    ----------
    state : Result
        A closure with adhesion.
    turning : {"penetration", "total_displacement", "mean_pressure"}
        What is controlled, and has its minimum at the fold.

    Raises
    ------
    InvalidProblemError
        Naming `state`: no converged closure, or a branch that ends otherwise, with the reason.
    """
    if state.status != "converged" or state.closure_residual is None or state.problem.work_of_adhesion == 0.0:
        raise InvalidProblemError("state", f"must be a converged closure with adhesion, is {state.status}")
    problem, ladder = state.problem, companions(state.resolution)
    scout = _scouted(problem, state.edges / problem.period, turning, scouting(ladder[0]))
    fraction = float(np.sum(np.diff(scout.evaluation.edges)))
    found = []
    for resolution in ladder:
        points = fraction * (1.0 + NEAR * np.cos(np.pi * (np.arange(POINTS) + 0.5) / POINTS))
        states = [_closed(problem, scout, float(a), resolution) for a in points]
        curves = {
            name: Chebyshev.fit(points, [float(quantities(s.evaluation)[name]) for s in states], POINTS - 1)
            for name in NUMBERS
        }
        slope = curves[turning].deriv()
        roots = [float(r.real) for r in slope.roots() if abs(r.imag) < 1e-12 and points.min() < r.real < points.max()]
        if len(roots) != 1:
            raise InvalidProblemError("state", f"has {len(roots)} folds near contact fraction {fraction:.4g}")
        found.append(({name: float(curve(roots[0])) for name, curve in curves.items()}, states[POINTS // 2]))
        fraction = roots[0]
    last = found[-1][1].evaluation
    uncertain = {name: float(spread([np.array(v[name]) for v, _ in found], ladder)) for name in NUMBERS}
    return Fold(found[-1][0], uncertain, last.edges * problem.period)


def _scouted(problem: Problem, edges: FloatArray, turning: Turning, resolution: Resolution) -> Closure:
    """The closure at the least q on a coarse mesh, from edges (n_patches, 2) in periods on."""
    walked: list[tuple[float, float, FloatArray]] = []  # contact fraction, q, edges
    for _ in range(STEPS):
        fraction = float(np.sum(np.diff(edges)))
        here = close(problem, edges, resolution, Control("contact_fraction", fraction))
        if here.outcome != "converged":
            raise InvalidProblemError("state", f"leads to no fold of the {turning}: {here.outcome}, {here.message}")
        walked.append((fraction, float(quantities(here.evaluation)[turning]), here.evaluation.edges))
        if len(walked) > 2 and walked[-1][1] > walked[-2][1]:
            break
        edges = scaled_patches(here.evaluation.edges, STEP)
    else:
        raise InvalidProblemError("state", f"leads to no fold of the {turning} in {STEPS} steps")
    middle = walked[-2][2]

    def at(fraction: float) -> Closure:
        start = scaled_patches(middle, fraction / walked[-2][0])
        return close(problem, start, resolution, Control("contact_fraction", fraction))

    least = minimize_scalar(
        lambda fraction: float(quantities(at(float(fraction)).evaluation)[turning]),
        bounds=(walked[-1][0], walked[-3][0]),
        method="bounded",
        options={"xatol": 0.2 * NEAR * walked[-2][0]},
    )
    return at(float(least.x))


def _closed(problem: Problem, scout: Closure, fraction: float, resolution: Resolution) -> Closure:
    """The closure at a contact fraction near the scout's, on one mesh."""
    known = scout.evaluation.edges
    start = scaled_patches(known, fraction / float(np.sum(np.diff(known))))
    found = close(problem, start, resolution, Control("contact_fraction", fraction), scout.jacobian)
    if found.outcome != "converged":
        raise InvalidProblemError("state", f"no state near the fold: {found.outcome}, {found.message}")
    return found
