"""Path of a contact through loading and unloading, from first touch on: targets, jumps, number of patches.

Input are the problem, the kind of control and its targets alone. The contact begins at the highest crest. A branch of
equilibria is followed by continuation (`continuation`) until

- the gap between the faces vanishes off the contact (touch): a patch is put in there;
- the control turns (fold) or the least eigenvalue of the Hessian vanishes (bifurcation): the state is no minimum of the
  energy any more, and the edges are pushed along the softest mode;
- a gap is narrower than NARROW, without adhesion or under a penetration near h_max: its patches are merged.

Behind each the energy descends at a fixed control (`descent`), and the next branch begins. What patches and gaps do
there are the changes of a jump; a jump that keeps them all is called a bifurcation, at the edge that moves most.
Without adhesion a state is the minimum of a convex problem and has no history: its targets are met in increasing
order, and the jumps are those of loading.

On the coarse mesh TRACKING jumps are located to about 1e-3 rms heights, and widths of patches to about 1 %: starts for
finer meshes (`solve`, `jumps`).  A jump that SECANTS leave unlocated ends the path: not_converged from there on.
A penetration above h_max, and a load that nothing carries, are unreachable.

Units: as in `problem` (dimensionless).
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from fem_reference.closure import ControlKind, intervals, start_edges
from fem_reference.continuation import Branch, Point, gap_minima, gap_near
from fem_reference.crests import chosen_crests
from fem_reference.descent import NARROW, SEED, Change, NoRestError, descend, with_patch, without_narrow
from fem_reference.factors import SingularSystemError
from fem_reference.mesh import Resolution
from fem_reference.problem import FloatArray, InvalidProblemError, Problem

TRACKING = Resolution(2, 4, 4)
FIRST, LONGEST, SHORTEST = 0.1, 0.35, 1e-5  # lengths of a step, in units of the scales
HEIGHT = 0.5  # rms heights: unit of a control that is a height
LOADS = 12  # units in the largest load
BEYOND = 2e-3  # units of the control: how far behind a jump the energy descends
BEYOND_TOUCH = 0.05  # the same where a patch begins without adhesion, of no width at touch
TOUCHED = 1e-4  # rms heights: gap at which a touch is located
TURNED = 1e-2  # component of the control of a tangent, in units, at which a fold is located
PUSH = 0.1  # of the patch or gap beside an edge: how far the softest mode is followed
SECANTS = 8

Cause = Literal["touch", "fold", "bifurcation", "merging"]
Status = Literal["converged", "separated", "complete_contact", "unreachable", "not_converged"]


@dataclass(frozen=True)
class Jump:
    """End of a branch: its cause, the value of the control, and what came behind it.

    `before` is the last point of the branch (None at first touch), `after` the first one of the next branch (None where
    contact is lost or complete).
    """

    cause: Cause
    value: float
    changes: tuple[Change, ...]
    before: Point | None
    after: Point | None


@dataclass(frozen=True)
class Target:
    """A target of the path: value of the control, status, and edges (n_patches, 2) in periods."""

    value: float
    status: Status
    edges: FloatArray


@dataclass(frozen=True)
class Path:
    """Targets in their order, jumps in the order met, the points of all branches, and why the path ended early.

    Targets behind the end of a path (`failure`) are not converged.
    """

    targets: tuple[Target, ...]
    jumps: tuple[Jump, ...]
    points: tuple[Point, ...]
    failure: str = ""


class PathError(RuntimeError):
    """A branch that cannot be followed, with the value of the control and the reason."""


def follow(problem: Problem, kind: ControlKind, targets: list[float], resolution: Resolution = TRACKING) -> Path:
    """Follow the contact from first touch through targets of a control, in their order.

    Examples
    --------
    >>> wave = Problem(1.0, 0.3, 1.0, 1.0, [1], [0.01], [0.0], 1e-5)
    >>> path = follow(wave, "penetration", [0.5, -1.0])
    >>> [target.status for target in path.targets], [jump.changes[-1].kind for jump in path.jumps]
    (['converged', 'separated'], ['first_touch', 'pull_off'])
    """
    branch = Branch(problem, kind, resolution, step_unit(kind, targets))
    if problem.work_of_adhesion > 0.0:
        return _followed(branch, targets)
    rising = sorted(set(targets))
    path = _followed(branch, rising)
    return replace(path, targets=tuple(path.targets[rising.index(target)] for target in targets))


def step_unit(kind: ControlKind, targets: list[float]) -> float:
    """Return the unit of a control in steps along a branch: a height, or a share of the largest load."""
    return (max(map(abs, targets)) / LOADS or 1.0) if kind == "mean_pressure" else HEIGHT


def _followed(branch: Branch, targets: list[float]) -> Path:
    """Follow a path whose history counts."""
    met: list[Target] = []
    jumps: list[Jump] = []
    points: list[Point] = []
    point, complete = None, False
    adhesive, none = branch.problem.work_of_adhesion > 0.0, np.zeros((0, 2))
    for target in targets:
        if branch.kind == "penetration" and target > branch.problem.highest:
            met.append(Target(target, "unreachable", none))
            continue
        try:
            if point is None and not complete and (target >= 0.0 if adhesive else target > 0.0):
                jumps.append(_first_touch(branch, target))
                point, complete = jumps[-1].after, jumps[-1].changes[-1].kind == "complete_contact"
            length = FIRST
            while point is not None and point.value != target:
                direction = float(np.sign(target - point.value))
                forwards = point if point.tangent[-1] * direction > 0.0 else replace(point, tangent=-point.tangent)
                end, length = _step(branch, forwards, target, length)
                jump = _jump(branch, forwards, end, target, direction)
                if jump is None:
                    point = end
                    points.append(point)
                else:
                    jumps.append(jump)
                    point, length = jump.after, FIRST
                    complete = point is None and jump.changes[-1].kind == "complete_contact"
        except (PathError, NoRestError, InvalidProblemError, SingularSystemError) as reason:
            met += [Target(value, "not_converged", none) for value in targets[len(met) :]]
            return Path(tuple(met), tuple(jumps), tuple(points), str(reason))
        if point is None:
            met.append(Target(target, _without_edges(branch, complete, target), none))
        else:
            met.append(Target(target, "converged", point.edges))
    return Path(tuple(met), tuple(jumps), tuple(points))


def _without_edges(branch: Branch, complete: bool, target: float) -> Status:
    """Return the status of a target where contact is complete or lost."""
    if complete and branch.kind == "penetration" and target < branch.problem.highest:
        return "unreachable"  # complete contact has penetration h_max
    if not complete and branch.kind == "mean_pressure" and target < 0.0:
        return "unreachable"  # nothing carries tension
    return "complete_contact" if complete else "separated"


def _first_touch(branch: Branch, target: float) -> Jump:
    """Return the jump into contact at the highest crest."""
    problem, crest = branch.problem, chosen_crests(branch.problem, 1)
    if problem.work_of_adhesion > 0.0:
        edges, value = crest[:, None] + SEED * np.array([[-1.0, 1.0]]), 0.0
    else:
        value = min(target, BEYOND_TOUCH * branch.unit)
        edges = start_edges(problem, crest, branch.control(value), branch.resolution, 1.0)
    rest = descend(branch, edges, value, 1.0)
    return Jump("touch", 0.0, (Change("first_touch", float(crest[0])), *rest.changes), None, rest.point)


def _step(branch: Branch, point: Point, target: float, length: float) -> tuple[Point, float]:
    """Return the next point of a branch, at the target where that is near, and the length of the next step.

    Raises
    ------
    PathError
        Where steps of SHORTEST fail.
    """
    while length > SHORTEST:
        ahead = (target - point.value) / point.tangent[-1]
        end = branch.step(point, ahead, target) if ahead <= length else branch.step(point, length)
        if end is not None:
            return end, min(1.5 * length, LONGEST)
        length /= 3.0
    raise PathError(
        f"the branch of {len(point.edges)} patches cannot be followed beyond {branch.kind} {point.value:.6g}: "
        f"its steps fail down to the shortest, {SHORTEST:g}; allowed: targets that end before it, another control, "
        "or another resolution"
    )


def _jump(branch: Branch, start: Point, end: Point, target: float, direction: float) -> Jump | None:
    """Return the first jump between two points of a branch, or None."""
    if intervals(end.edges)[1::2].min() < NARROW:
        return _merging(branch, start, end, target, direction)
    turned = end.tangent[-1] * direction < 0.0
    cause: Cause = "fold" if turned else "bifurcation"
    place = end
    if turned or not end.stable:
        place = _zero(
            branch,
            start,
            end,
            lambda p: p.tangent[-1] * direction if turned else p.lowest,
            TURNED * branch.unit if turned else 1e-3 * start.lowest,
            cause,
        )
    entered = [x for x, gap in gap_minima(place.evaluation) if gap < -TOUCHED]
    if entered:
        cause = "touch"
        place = _zero(branch, start, place, lambda p: min(gap_near(p.evaluation, x) for x in entered), TOUCHED, cause)
    elif not (turned or not end.stable):
        return None
    beyond = BEYOND_TOUCH if cause == "touch" and branch.problem.work_of_adhesion == 0.0 else BEYOND
    value = place.value + direction * min(beyond * branch.unit, abs(target - place.value))
    begun: tuple[Change, ...] = ()
    if cause == "touch":
        x = min(entered, key=lambda x: gap_near(place.evaluation, x))
        edges, begun = with_patch(place.edges, x), (Change("new_contact", x % 1.0),)
    else:
        lengths = branch.scales(place.edges)[:-1]
        push = place.softest / np.max(np.abs(place.softest) / lengths)
        edges = place.edges + PUSH * push.reshape(-1, 2)
    rest = descend(branch, edges, value, direction)
    changes = begun + rest.changes
    if not changes:
        edge = int(np.argmax(np.abs(place.softest)))
        changes = (Change("bifurcation", float(place.edges.flat[edge] % 1.0)),)
    return Jump(cause, place.value, changes, place, rest.point)


def _zero(branch: Branch, start: Point, end: Point, of: Callable[[Point], float], within: float, cause: Cause) -> Point:
    """Return the point between two at which a number that changes its sign is nearly zero (regula falsi, Illinois).

    Raises
    ------
    PathError
        Where a point between the two is not found, or the number stays beyond `within`.
    """
    low, high, last, number = (0.0, of(start)), (_length(branch, start, end), of(end)), 0, np.inf
    for _ in range(SECANTS):
        length = low[0] + (high[0] - low[0]) * low[1] / (low[1] - high[1])
        between = branch.step(start, length)
        if between is None:
            raise PathError(
                f"a point of the branch at {branch.kind} {start.value:.6g} to {end.value:.6g} is not found; "
                "allowed: targets that end before it, another control, or another resolution"
            )
        number = of(between)
        if abs(number) < within:
            return between
        if number > 0.0:
            low, high = (length, number), (high[0], high[1] * (0.5 if last > 0 else 1.0))
        else:
            low, high = (low[0], low[1] * (0.5 if last < 0 else 1.0)), (length, number)
        last = 1 if number > 0.0 else -1
    raise PathError(
        f"the {cause} at {branch.kind} {start.value:.6g} to {end.value:.6g} is not located: {abs(number):.2g} is left "
        f"after {SECANTS} secants, more than {within:.2g}; allowed: targets before it, another control or resolution"
    )


def _length(branch: Branch, start: Point, end: Point) -> float:
    """Return the length of the step that leads from one point to another."""
    weight = start.tangent / branch.scales(start.edges) ** 2
    return float((end.place - start.place) @ weight / (start.tangent @ weight))


def _merging(branch: Branch, start: Point, end: Point, target: float, direction: float) -> Jump:
    """Return the merging at a narrow gap, whose square is linear in the control; the last gap closes at h_max."""
    gaps = [intervals(point.edges)[1::2] for point in (start, end)]
    k = int(np.argmin(gaps[1]))
    before, after = (float(gap[k]) ** 2 for gap in gaps)
    value = end.value + (end.value - start.value) * after / (before - after)
    closing = np.zeros(end.edges.shape, dtype=bool)
    edges, changes = without_narrow(end.edges, closing)
    if edges.size == 0:
        closed = branch.problem.highest if branch.kind == "penetration" else value
        return Jump("merging", closed, tuple(changes), end, None)
    reached = value + direction * min(BEYOND * branch.unit, abs(target - value))
    rest = descend(branch, edges, reached, direction)
    return Jump("merging", value, (*changes, *rest.changes), end, rest.point)
