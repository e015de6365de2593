"""Jumps of a path on finer meshes: where a branch ends, in what state, and what energy is released behind it.

A path (`path`) locates its jumps on one coarse mesh. Here the last state of the branch is found again on each of three
meshes (`solve.companions`), and every number carries the uncertainty that follows from the three (`result`).

- Fold, bifurcation: five points of the branch on planes across its tangent at the coarse fold, as far apart as the
  control changes by 5e-4 of its unit, by its curvature there. The control has its extremum on the polynomial through
  them; all other numbers are those of their own polynomials there.
- Touch: three points at fixed values of the control about the coarse touch; the least gap near the crest vanishes on
  the polynomial through them.
- First touch is at zero by definition.

Released is the potential energy before less the one behind, at the value of the control of the same mesh: of elastic
and adhesive energy under a penetration, with the mean compression under a total displacement, less the work of the load
under a load. Behind pull-off it is zero; behind complete contact none is stated.

Limits: jumps of adhesive contacts; without adhesion nothing is released, and only touches are located.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from fem_reference.closure import ControlKind, Evaluation
from fem_reference.contact import KeptFactors
from fem_reference.continuation import Branch, Point, Solution, gap_near
from fem_reference.mesh import Resolution, layer_mesh
from fem_reference.path import LOADS, Jump, PathError
from fem_reference.problem import FloatArray, Problem
from fem_reference.result import quantities, spread
from fem_reference.solve import companions

PLANES = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])  # across the branch at a fold, over the outer ones
FARTHEST, NEAR = 0.1, 0.01  # outer planes at most, and where the curvature is measured, in units of the scales
TURN = 5e-4  # units of its own by which the control changes between a fold and the outer planes
VALUES = np.array([-4e-3, 0.0, 4e-3])  # about a touch, from its own on, rms heights or shares of the largest load
CLOSED = 1e-9  # residual of K
NUMBERS = ("penetration", "total_displacement", "mean_pressure", "contact_fraction", "total_energy")


@dataclass(frozen=True)
class LocatedJump:
    """Numbers of the last state before a jump and the energy released, SI units, each with its uncertainty.

    The keys are NUMBERS and `energy_released` (J/m per period), where one is stated.
    """

    values: Mapping[str, float]
    uncertainty: Mapping[str, float]


def locate(problem: Problem, kind: ControlKind, jump: Jump, unit: float, finest: Resolution) -> LocatedJump:
    """Locate a jump of a path on the finest mesh and its two companions.

    Parameters
    ----------
    problem, kind, unit
        Those of the path.
    jump : Jump
    finest : Resolution

    Raises
    ------
    PathError
        Where a mesh has no such state.
    """
    ladder = companions(finest)
    meshes = [_numbers(Branch(problem, kind, resolution, unit), jump) for resolution in ladder]
    uncertainty = {name: float(spread([np.array(values[name]) for values in meshes], ladder)) for name in meshes[-1]}
    return LocatedJump(meshes[-1], uncertainty)


def _numbers(branch: Branch, jump: Jump) -> dict[str, float]:
    """Return the numbers of a jump on one mesh."""
    numbers, before, value = dict.fromkeys(NUMBERS, 0.0), 0.0, jump.value
    if jump.before is not None:
        touch = jump.cause == "touch"
        places, states = _about(branch, jump.before) if touch else _across(branch, jump.before)
        line = Polynomial.fit(
            places,
            [gap_near(state.evaluation, jump.changes[0].position) for state in states]
            if touch
            else [state.value for state in states],
            len(places) - 1,
        )
        roots = (line if touch else line.deriv()).roots()
        real = [float(root.real) for root in roots if abs(root.imag) < 1e-9]
        if not real:
            raise PathError(f"no {jump.cause} on the mesh {branch.resolution} near {branch.kind} {value:.6g}")
        at = min(real, key=abs)

        def there(numbers: list[float]) -> float:
            return float(Polynomial.fit(places, numbers, len(places) - 1)(at))

        value = there([state.value for state in states])
        numbers = {name: there([float(quantities(state.evaluation)[name]) for state in states]) for name in NUMBERS}
        before = there([potential(branch.kind, state.evaluation) for state in states])
    behind = 0.0
    if jump.after is not None:
        border = np.append(np.zeros(jump.after.edges.size), 1.0)
        step = np.append(np.zeros(jump.after.edges.size), value - jump.after.value)
        behind = potential(branch.kind, _row(branch, jump.after, step[None], border)[0].evaluation)
    if jump.after is not None or jump.changes[-1].kind == "pull_off":
        numbers["energy_released"] = before - behind
    return numbers


def _across(branch: Branch, point: Point) -> tuple[FloatArray, list[Solution]]:
    """Return distances along the tangent of a point, and the state on the plane normal to it at each distance."""
    border = point.tangent / branch.scales(point.edges) ** 2

    def row(places: FloatArray) -> list[Solution]:
        return _row(branch, point, places[:, None] * point.tangent, border)

    before, at, behind = (state.value for state in row(np.array([-NEAR, 0.0, NEAR])))
    curvature = abs(before - 2.0 * at + behind) / (2.0 * NEAR**2 * branch.unit)  # of the control in its units
    places = PLANES * min(FARTHEST, float(np.sqrt(TURN / curvature)))
    return places, row(places)


def _about(branch: Branch, point: Point) -> tuple[FloatArray, list[Solution]]:
    """Return offsets of the control about its value at a point, and the state at each offset."""
    values = VALUES * (LOADS * branch.unit if branch.kind == "mean_pressure" else 1.0)
    border = np.append(np.zeros(point.edges.size), 1.0)
    return values, _row(branch, point, values[:, None] * point.tangent / point.tangent[-1], border)


def _row(branch: Branch, point: Point, steps: FloatArray, border: FloatArray) -> list[Solution]:
    """Solve on a finer mesh at steps (n, 2 n_patches + 1) from a coarse point, the middle step first."""
    problem, middle = branch.problem, len(steps) // 2
    mesh, kept = layer_mesh(problem.depth, point.edges, branch.resolution, problem.highest_order), KeptFactors()
    slope = branch.by_edges_of(branch.evaluated(mesh, point.value, kept), point.value, kept)
    base, states = point.place, dict[int, Solution]()
    for k in sorted(range(len(steps)), key=lambda k: abs(k - middle)):
        place = base + steps[k] - (steps[middle] if states else 0.0)
        state = branch.solved(mesh, slope, place, border, CLOSED)
        if state is None:
            raise PathError(f"no state on the mesh {branch.resolution} near {branch.kind} {place[-1]:.6g}")
        if not states:
            base, slope, mesh = state.place, state.by_edges, state.evaluation.states.mesh
        states[k] = state
    return [states[k] for k in range(len(steps))]


def potential(kind: ControlKind, evaluation: Evaluation) -> float:
    """Return the potential energy (J/m) whose minimum a state under a control is."""
    numbers = {name: float(number) for name, number in quantities(evaluation).items() if np.ndim(number) == 0}
    if kind == "total_displacement":
        return numbers["strain_energy"] + numbers["adhesion_energy"]
    work = numbers["load"] * numbers["penetration"] if kind == "mean_pressure" else 0.0
    return numbers["total_energy"] - work
