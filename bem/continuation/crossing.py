"""The state between two points of an adhesive path at which the load has a given value.

On a branch the load is a smooth function of the control value.  With adhesion it is found by Newton with the stiffness
of the branch and the predictor of the path, first at the accuracy between targets, then at that of a target.  Where
Newton leaves the branch or the two points, the Illinois form of the secant takes its place, from the second point where
that is the fold or the touch that ends the branch; where that fails, the path is followed again in smaller increments.
A load that events lower is met several times: the first counts.  Under a given separation the last gap closes, and the
first opens, under a tension without bound: loads beyond that of the narrowest gap on the path are met in between, in
the gap that a row of cracks has at that load (opening.py).  Without adhesion load control leads there at once
(convex_path.py).  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from importlib import import_module
from itertools import pairwise
from typing import Protocol, Self

import numpy as np

from bem.adhesive.equilibrium import System
from bem.continuation.opening import FINEST_GAP, Flaw, flaw_of, opening_load, with_gap
from bem.continuation.points_with_edges import Equilibrium, Point, WithEdges
from bem.continuation.softness import after_step
from bem.elastic.collocation import evaluate
from bem.geometry.patches import Patches
from bem.loading.complete_contact import CompleteContact
from bem.loading.control import LoadControl
from bem.loading.increments import Accuracy, Increments

SECANT_STEPS = 30
NEWTON_STEPS = 6
LOAD_ACCURACY = 1e-11
STIFF = 100.0  # times the accuracy: what one digit of the control changes in the load of a narrow gap
DIGITS = 64  # spacings of the control that Newton may still go to and fro there; measured 26
COARSE_LOAD_ACCURACY = 1e-5  # from where Newton needs one or two steps
REFINEMENTS, REFINEMENT = 3, 16  # finer paths where Newton does not reach the load, and how much finer each is
REFINED_TOLERANCE, REFINED_RESIDUAL = 1e-6, 1e-7  # of evaluations in finer increments
COARSE_RESIDUAL = 0.1  # of that between targets, so that the coarse load is as smooth as its accuracy asks


class Branches(Protocol):
    """What is asked of the path between the points (path.py)."""

    @property
    def system(self) -> System:
        """Edges, law and control."""
        ...

    @property
    def increments(self) -> Increments:
        """Sizes and accuracies."""
        ...

    @property
    def complete(self) -> CompleteContact:
        """Complete contact."""
        ...

    def advance(self, point: Point, goal: float) -> Iterator[Point]:
        """Points on the way to a goal."""
        ...

    def corrected(self, patches: Patches, penetration: float, value: float) -> Equilibrium | None:
        """The equilibrium near given edges."""
        ...

    def refined_at(self, point: WithEdges, value: float) -> Equilibrium | None:
        """The point of the same branch at another value."""
        ...

    def interpenetrates(self, point: WithEdges) -> bool:
        """Whether contact forms beside the edges."""
        ...

    def with_increments(self, increments: Increments) -> Self:
        """The same path in other increments."""
        ...


def at_load(path: Branches, before: Point, after: Point, load: float) -> Equilibrium | None:
    """The refined point between two points at which the load is `load`; None where it does not exist.

    Parameters
    ----------
    path : Branches
    before, after : Point
        Of one branch; complete contact, at one end, has no edges.
    load : float
        Dimensionless load per period.
    """
    if isinstance(before, WithEdges) and isinstance(after, WithEdges):
        return _first(path, before, after, load, REFINEMENTS)
    beside = [point for point in (before, after) if isinstance(point, WithEdges)]
    return _in_last_gap(path, beside[0], load) if beside else None


def _in_last_gap(path: Branches, point: WithEdges, load: float) -> Equilibrium | None:
    """The point at a load between complete contact and a point with one gap."""
    patches, system, tolerance = point.state.patches, path.system, path.increments.coarse.tolerance
    widest = float(patches.gap_after[0])
    center = float(patches.right[0]) + widest / 2

    def gap(width: float) -> Flaw:
        return flaw_of(system, path.complete, width, tolerance) or Flaw(center, width)

    def miss(width: float) -> float:
        return opening_load(system, path.complete, gap(width), tolerance) - load

    if patches.count > 1 or widest <= FINEST_GAP or miss(FINEST_GAP) * miss(widest) > 0:
        return None
    flaw = gap(float(import_module("scipy.optimize").brentq(miss, FINEST_GAP, widest, rtol=COARSE_LOAD_ACCURACY)))
    crack = with_gap(flaw.center, flaw.width)
    highest = system.elastic.profile.max_height
    depth = LoadControl().reach(evaluate(system.elastic, crack, highest, tolerance), load).penetration
    found = path.corrected(crack, depth, depth)
    return None if found is None else _newton(path, found, _ahead(path, found, load), load, LOAD_ACCURACY)


def _first(path: Branches, before: WithEdges, after: WithEdges, load: float, refinements: int) -> Equilibrium | None:
    """The state in which the load is first reached; where Newton does not reach so far, in that many finer paths."""
    found = _root(path, before, after, load)
    if found is not None or refinements == 0:
        return found
    reach = abs(after.value - before.value)
    start = replace(before, increment=None) if isinstance(before, Equilibrium) else before
    points = [before, *_refined(path, reach).advance(start, after.value)]
    if points[-1].state is None:
        return _root(path, before, after, load)
    for first, last in pairwise(point for point in points if isinstance(point, WithEdges)):
        if not first.last and may_meet(path, first, last, load):
            found = _first(path, first, last, load, refinements - 1)
            if found is not None:
                return found
    return None


def _refined(path: Branches, reach: float) -> Branches:
    """The same path in smaller increments, with finer evaluations."""
    inc = path.increments
    accuracy = replace(
        inc.coarse,
        tolerance=min(inc.coarse.tolerance, REFINED_TOLERANCE),
        residual=min(inc.coarse.residual, REFINED_RESIDUAL),
    )
    return path.with_increments(
        Increments(reach / REFINEMENT, min(reach, inc.smallest) / REFINEMENT, accuracy, inc.fine)
    )


def _root(path: Branches, before: WithEdges, after: WithEdges, load: float) -> Equilibrium | None:
    """The point of this load on the branch before the event, if there is one, else on that after it."""
    coarse, ends = _tracking(path), (min(before.value, after.value), max(before.value, after.value))
    found = _newton(coarse, before, _ahead(path, before, load), load, COARSE_LOAD_ACCURACY, ends)
    if found is None:
        found = _between(coarse, before, after, load, COARSE_LOAD_ACCURACY)
    refined = None if found is None else _newton(path, found, found.value, load, LOAD_ACCURACY)
    if refined is None:
        refined = _between(path, before, after, load, LOAD_ACCURACY)
    return None if refined is None or path.interpenetrates(refined) else refined


def may_meet(path: Branches, before: WithEdges, after: WithEdges, load: float) -> bool:
    """Whether the load is met between two points with edges, or may have been before an event that lowered it."""
    start, end = _load(path, before), _load(path, after)
    if min(start, end) < load <= max(start, end):
        return True
    low, high = sorted((before.value, after.value))
    return after.last and low <= _ahead(path, before, load) <= high


def _tracking(path: Branches) -> Branches:
    """The same path, whose points are only as accurate as between targets."""
    inc = path.increments
    accuracy = Accuracy(inc.coarse.tolerance, COARSE_RESIDUAL * inc.coarse.residual, inc.fine.allowed)
    return path.with_increments(replace(inc, fine=accuracy))


def _between(path: Branches, before: WithEdges, after: WithEdges, load: float, accuracy: float) -> Equilibrium | None:
    """The point of this load on the branch between two points, to a relative accuracy of the load."""
    ends = (before.value, _load(path, before) - load), (after.value, _load(path, after) - load)
    if ends[0][1] * ends[1][1] > 0:
        return None
    found = _secant(path, before, *ends, load, accuracy)
    return _secant(path, after, *ends, load, accuracy) if found is None and after.last else found


def _secant(
    path: Branches,
    base: WithEdges,
    first: tuple[float, float],
    second: tuple[float, float],
    load: float,
    accuracy: float,
) -> Equilibrium | None:
    """The point on the branch of `base` between two control values whose misses of the load differ in sign."""
    (low, low_miss), (high, high_miss) = first, second
    last_side = 0
    for _ in range(SECANT_STEPS):
        found = path.refined_at(base, low - low_miss * (high - low) / (high_miss - low_miss))
        if found is None:
            return None
        miss = found.state.load - load
        if abs(miss) <= accuracy * max(abs(load), 1e-3):
            return found
        side = 1 if miss * high_miss > 0 else -1
        if side > 0:
            high, high_miss = found.value, miss
            low_miss = low_miss / 2 if last_side == side else low_miss
        else:
            low, low_miss = found.value, miss
            high_miss = high_miss / 2 if last_side == side else high_miss
        last_side = side
    return None


def _newton(
    path: Branches,
    point: WithEdges,
    value: float,
    load: float,
    accuracy: float,
    ends: tuple[float, float] = (-np.inf, np.inf),
) -> Equilibrium | None:
    """The point of this load on the branch of `point`, by Newton from a control value; None where that leaves it.

    Points are as accurate as between targets: a finer root next to one of them may lie beyond it.
    """
    nearest, least = None, STIFF * accuracy
    for _ in range(NEWTON_STEPS):
        found = path.refined_at(point, value) if ends[0] <= value <= ends[1] else None
        if found is None:
            return None
        point, ahead = found, _ahead(path, found, load)
        miss = abs(found.state.load - load) / max(abs(load), 1e-3)
        if miss <= accuracy:
            return found
        if miss <= least and abs(ahead - value) <= DIGITS * np.spacing(abs(value)):
            nearest, least = found, miss  # in narrow gaps the control may have no number between
        value = ahead
    return nearest


def _load(path: Branches, point: WithEdges) -> float:
    """Load at a point; halfway to a fold with what the forces that are left on its edges still change."""
    here = point.balance
    if not isinstance(point, Equilibrium) or here.residual <= path.increments.coarse.residual:
        return here.state.load
    return after_step(path.system, here, point.value, -here.response(here.gradient), 0.0).load


def _ahead(path: Branches, point: WithEdges, load: float) -> float:
    """The control value at which the tangent of the branch at a point has this load."""
    control = path.system.control
    miss = _load(path, point) - load
    return point.value - miss * (control.penetration_weight / point.balance.stiffness + control.load_weight)
