"""Locate where a branch of equilibria turns: the least penetration, displacement or load that a contact can carry.

The patch that shrinks fastest towards the fold leads: its width w is prescribed (`closure`), which stays regular where
the control turns. On the coarse mesh w is lowered in small steps until the controlled quantity q rises again; then, on
each of three meshes, q(w) is closed at five Chebyshev points about its minimum, and

    dq/dw = 0

is solved on the polynomial of degree four through them. The value of q is of second order in the place, so that it is
known far better than the widths. All quantities of the state there are those of their own polynomials; their
uncertainties are the spread over the meshes, as in `result`.

Limits: edges of the JKR closure, with adhesion; the fold must be the next one met as q falls.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.optimize import minimize_scalar

from fem_reference.closure import Closure, Control, Evaluation, close, evaluate, residual, scouting
from fem_reference.mesh import Resolution
from fem_reference.problem import FloatArray, InvalidProblemError, Problem
from fem_reference.result import Result, quantities, spread
from fem_reference.solve import companions

STEP = 0.9  # factor of the width from one state of the scouting to the next
STEPS = 60
NEAR = 0.04  # of the width: half the range in which the fold is looked for on fine meshes
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
    """Locate the fold that a state meets when its contact fraction falls, on the meshes of the state.

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
    coarse = scouting(ladder[0])
    leader = _leader(problem, state.evaluation, turning, coarse)
    scout = _scouted(problem, state.evaluation.edges, leader, turning, coarse)
    width = float(np.diff(scout.evaluation.edges)[leader, 0])
    found = []
    for resolution in ladder:
        points = width * (1.0 + NEAR * np.cos(np.pi * (np.arange(POINTS) + 0.5) / POINTS))
        states = [_closed(problem, scout, leader, float(w), resolution) for w in points]
        curves = {
            name: Chebyshev.fit(points, [float(quantities(s.evaluation)[name]) for s in states], POINTS - 1)
            for name in NUMBERS
        }
        slope = curves[turning].deriv()
        roots = [float(r.real) for r in slope.roots() if abs(r.imag) < 1e-12 and points.min() < r.real < points.max()]
        if len(roots) != 1:
            raise InvalidProblemError(
                "state", f"has {len(roots)} folds where patch {leader} is {width:.4g} periods wide"
            )
        found.append(({name: float(curve(roots[0])) for name, curve in curves.items()}, states[POINTS // 2]))
        width = roots[0]
    last = found[-1][1].evaluation
    uncertain = {name: float(spread([np.array(v[name]) for v, _ in found], ladder)) for name in NUMBERS}
    return Fold(found[-1][0], uncertain, last.edges * problem.period)


def _leader(problem: Problem, state: Evaluation, turning: Turning, resolution: Resolution) -> int:
    """Return the patch whose width changes most, relative to itself, as the controlled quantity falls."""
    unit = problem.unit_stress if turning == "mean_pressure" else problem.unit_height
    at = float(quantities(state)[turning]) / unit
    here = close(problem, state.edges, resolution, Control(turning, at))
    if here.outcome != "converged":
        raise InvalidProblemError("state", f"is not met on the coarse mesh: {here.outcome}, {here.message}")
    mesh, step = here.evaluation.states.mesh, 1e-5 * max(abs(at), 1.0)
    base, aside = (
        residual(problem, evaluate(problem, mesh, resolution, control), control)
        for control in (Control(turning, at), Control(turning, at - step))
    )
    motion = np.linalg.solve(here.jacobian, base - aside).reshape(here.evaluation.edges.shape)
    return int(np.argmin(np.diff(motion) / np.diff(here.evaluation.edges)))


def _scouted(problem: Problem, edges: FloatArray, leader: int, turning: Turning, resolution: Resolution) -> Closure:
    """Return the closure at the least q on a coarse mesh, starting from edges (n_patches, 2) in periods on."""
    walked: list[tuple[float, float, FloatArray]] = []  # width of the leader, q, edges
    for _ in range(STEPS):
        width = float(np.diff(edges)[leader, 0])
        here = close(problem, edges, resolution, Control("width", width, leader))
        if here.outcome != "converged":
            raise InvalidProblemError("state", f"leads to no fold of the {turning}: {here.outcome}, {here.message}")
        walked.append((width, float(quantities(here.evaluation)[turning]), here.evaluation.edges))
        if len(walked) > 1 and walked[-1][1] > walked[-2][1]:
            break
        edges = _with_width(here.evaluation.edges, leader, STEP * width)
    else:
        raise InvalidProblemError("state", f"leads to no fold of the {turning} in {STEPS} steps")
    if len(walked) == 2:
        raise InvalidProblemError("state", f"lies beyond the fold of the {turning}, or within {1 - STEP:.0%} of it")
    middle = walked[-2]

    def at(width: float) -> Closure:
        return close(
            problem, _with_width(middle[2], leader, width), resolution, Control("width", width, leader), here.jacobian
        )

    least = minimize_scalar(
        lambda width: float(quantities(at(float(width)).evaluation)[turning]),
        bounds=(walked[-1][0], walked[-3][0]),
        method="bounded",
        options={"xatol": 0.2 * NEAR * middle[0]},
    )
    return at(float(least.x))


def _with_width(edges: FloatArray, leader: int, width: float) -> FloatArray:
    """Edges (n_patches, 2) with one patch given a width about its middle."""
    changed = edges.copy()
    changed[leader] = edges[leader].mean() + 0.5 * width * np.array([-1.0, 1.0])
    return changed


def _closed(problem: Problem, scout: Closure, leader: int, width: float, resolution: Resolution) -> Closure:
    """Return the closure on one mesh where the leading patch has a given width.

    The scout is the closure at the fold of the coarse mesh: it gives the first edges and the Jacobian.
    """
    start = _with_width(scout.evaluation.edges, leader, width)
    found = close(problem, start, resolution, Control("width", width, leader), scout.jacobian)
    if found.outcome != "converged":
        raise InvalidProblemError("state", f"no state near the fold: {found.outcome}, {found.message}")
    return found
