"""The quasi-static path of an adhesive contact: curves of equilibria from event to event, and the states asked for.

A branch is followed as a smooth curve in steps (steps.py).  On every step the first end of the branch is looked for
(branch_ends.py), as the equilibrium that meets its own condition: the goal, a fold, a broken symmetry, or a gap that
closes.  From there the contact jumps (jump.py), or another branch is taken up (symmetry.py), and the curve of
the next equilibrium is followed.  A step in which it is not clear what happens is repeated at a third of its length.

A point carries all that the path needs to go on from it.  A path holds no state of its own.  The system counts the
work.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from bem.adhesive.branch import outward_motion
from bem.adhesive.equilibrium import System
from bem.adhesive.equilibrium_assessment import assess_equilibrium
from bem.adhesive.relaxation import interpenetration
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.assessment import Assessment
from bem.loading.complete_contact import CompleteContact
from bem.loading.increments import MAXIMUM_ITERATIONS, Effort, Increments
from bem.loading.path_events import EventNumbers, PathTension, path_events
from bem.loading.points_without_edges import Complete, Failed, Separated
from bem.path.bare_states import BareStates
from bem.path.branch_ends import End, GoalReached, first_end
from bem.path.fold import LimitPoint
from bem.path.jump import Jumps, leading_patch
from bem.path.loads import Loads
from bem.path.locating import LOCATED, AtControl, Condition, InPlane, Located, Refused, Start, settle
from bem.path.opening import Flaw
from bem.path.points_with_edges import Equilibrium, Point, Stretch
from bem.path.span import Span
from bem.path.stand import LONGEST_STEP, SHORT, Stand
from bem.path.steps import (
    SHORTER,
    SHORTEST_STEP,
    Way,
    curve_from,
    evaluated_at_itself,
    growth,
    predicted,
    step_from,
)
from bem.path.symmetry import alone, other_branch
from bem.path.tension import LeastLoad, behind_jump, turn_of_load
from bem.path.touch import Touch

FIRST = 0.5  # speed: of the longest step: the first one of a branch
NATURAL = 1e2 * LOCATED, 1e3 * LOCATED, 1e4 * LOCATED, 1e5 * LOCATED  # steps of the control where no other is left


@dataclass(frozen=True, eq=False)
class Path:
    """Path of the equilibrium of a system from point to point.

    Parameters
    ----------
    system : System
    increments : Increments
    crests : (n,) array
        Positions of the highest crests (more than one when equally high), where first touch happens.
    complete : CompleteContact
        Complete contact, in which the path ends and may begin.
    flaw : Flaw, optional
        Flaw from which complete contact opens when the load falls; without a flaw complete contact never opens.
    asked_loads : tuple of float
        Loads at which states are asked for on the way: points are made where the load turns near one.
    """

    system: System
    increments: Increments
    crests: FloatArray
    complete: CompleteContact
    flaw: Flaw | None = None
    asked_loads: tuple[float, ...] = ()
    has_history: ClassVar[bool] = True
    least_load: LeastLoad = field(default_factory=LeastLoad)

    @property
    def largest_tension(self) -> PathTension | None:
        """Least load met on unloading since this path was made; None before any tension."""
        return self.least_load.met

    @property
    def effort(self) -> Effort:
        """Counts of the work done."""
        return self.system.effort

    @property
    def jumps(self) -> Jumps:
        """Jumps from the ends of branches."""
        return Jumps(self.system, self.increments, self.complete)

    @property
    def bare(self) -> BareStates:
        """Transitions to and from states without edges."""
        finely = replace(self.increments, way=self.increments.fine)  # a release from complete contact may be tiny
        return BareStates(self.system, finely, self.complete, self.crests, self.flaw)

    @property
    def loads(self) -> Loads:
        """Search for loads on the way."""
        return Loads(self.system, self.complete, self.increments.fine, self.increments.way.tolerance, self.asked_loads)

    def direction(self, point: Point, goal: float, separation: float | None = None) -> float:
        """Return the sign of the motion of the control from a point to a goal; `separation` is not needed."""
        return float(np.sign(goal - point.value))

    def advance(self, point: Point, goal: float, separation: float | None = None) -> Iterator[Point]:
        """Yield every accepted point from `point` to the goal; the last point is at the goal or has failed.

        Without edges: to first touch, to the opening of complete contact, or to the goal.  With edges: along the curve
        to the first end of the branch, and to the point behind it.  Endless jumps that do not lead nearer to the goal
        are a failure.
        """
        jumps, distance = 0, abs(goal - point.value)
        while point.value != goal:
            if not isinstance(point, Equilibrium):
                start, point = point, self.bare.advance(point, goal)
                if goal < start.value and point.events and np.isfinite(point.events[0].at.load):
                    self.least_load.note("jump", point.events[0].at, point.events[0].error)
                    self._note_behind(point, point.events[0].error)
                yield point
                joined = isinstance(start, Separated) and isinstance(point, Complete)
                if not isinstance(point, Equilibrium) and not joined:
                    return
                continue
            for point in self._along(point, goal):  # noqa: B020
                yield point
            if isinstance(point, Failed):
                return
            leads_on = abs(goal - point.value) < distance - LOCATED * self.increments.largest
            jumps, distance = (0, abs(goal - point.value)) if leads_on else (jumps + 1, distance)
            if jumps == MAXIMUM_ITERATIONS:
                yield Failed(point.value, "jumps_again")
                return

    def refine(self, point: Point, direction: float) -> Point:
        """Return the point at the accuracy of a target; `direction` is not needed.

        The point is settled in its plane of the curve, because near a fold a value of the control fixes no state.
        """
        if not isinstance(point, Equilibrium) or point.settled:
            return replace(point, events=())
        start, stretch = Start(point.patches, point.state.penetration, point.value), point.stretch
        return self._stable(start, None if stretch is None else InPlane(point.patches, stretch.span.normal))

    def restart(self, patches: Patches, penetration: float, value: float, separation: float | None = None) -> Point:
        """Return the point at given equilibrium edges, from which the path continues as if it began at this point."""
        return self._stable(Start(patches, penetration, value))

    def assess(self, point: Equilibrium) -> Assessment:
        """Return stability, stiffness and estimated errors, from finer evaluations."""
        return assess_equilibrium(self.system, point.balance, point.value, 1e-2 * self.increments.fine.tolerance)

    def load_of(self, point: Point) -> float | None:
        """Return the load at a point; None without edges, but -inf for a gap that narrows under unbounded tension."""
        if isinstance(point, Equilibrium):
            return point.load
        narrowing = self.system.control.load_weight == 0 and isinstance(point, Complete)
        return -np.inf if narrowing else None

    def may_meet(self, before: Point, after: Point, load: float) -> bool:
        """Return whether a load is met between two successive points."""
        if isinstance(before, Equilibrium) and isinstance(after, Equilibrium):
            if after.stretch is None:
                return False
            low, high = sorted(after.stretch.loads)
            return low < load <= high
        start, end = self.load_of(before), self.load_of(after)
        return start is not None and end is not None and min(start, end) < load <= max(start, end)

    def at_load(self, before: Point, after: Point, load: float) -> Point | None:
        """Return the refined point at a load between two successive points; None where the path jumps over it."""
        if isinstance(before, Equilibrium) and isinstance(after, Equilibrium):
            return None if after.stretch is None else self.loads.on_stretch(after.stretch, load)
        beside = [point for point in (before, after) if isinstance(point, Equilibrium)]
        return self.loads.in_last_gap(beside[0], load, self.increments.coarse.tolerance) if beside else None

    def _stable(self, start: Start, on: Condition | None = None) -> Equilibrium | Failed:
        """Return the stable state next to edges that meets a condition, or at the value of the control of the start."""
        settled = settle(self.system.sloped, start, on or AtControl(start.value), self.increments.fine)
        if isinstance(settled, Refused) or settled[0].factor is None:
            return Failed(start.value, "not_converged")
        return Equilibrium.of(settled[1], settled[0], settled=True)

    def _way(self, point: Equilibrium, direction: float, end: float) -> Way:
        """Return the direction, end and step limits with which a branch is followed from a point."""
        largest, control = self.increments.largest, self.system.control
        if control.load_weight:  # a stiff contact hardly moves
            growth_of_control = control.penetration_weight + control.load_weight * point.balance.stiffness
            largest = max(largest, self.increments.deepest * growth_of_control)
        longest = LONGEST_STEP * min(1.0, self.increments.deepest / Increments.deepest)
        return Way(direction, end, longest, largest, self.increments.between)

    def _along(self, point: Equilibrium, goal: float) -> Iterator[Point]:
        """Yield points along the curve of a state, to the goal or to the point behind the first end of the branch."""
        direction, closing, end = self.direction(point, goal), self.bare.closing_value, goal
        if direction > 0 and goal >= closing:
            one_gap, way_left = point.patches.count == 1, closing - point.value
            end = closing - (self.increments.smallest if one_gap else max(way_left / 2, LOCATED))
            if point.value >= end - LOCATED * self.increments.smallest:
                yield self.bare.closed(point.state.patches, goal)
                return
        way = self._way(point, direction, end)
        at = curve_from(self.system, point, way)
        if at is None:
            yield Failed(point.value, "not_converged")
            return
        length, load = FIRST * way.longest, point.load
        while True:
            ahead = predicted(at, length, way)
            tried = float(np.max(np.abs(ahead[0] / at.unit)))
            if tried < SHORTEST_STEP:
                yield self._by_control(at, way)
                return
            span = step_from(self.system, at, ahead, way)
            branch_end = span if isinstance(span, Refused) else first_end(self.system, self.increments, span, way)
            if isinstance(span, Refused) or isinstance(branch_end, Refused):
                self.effort.rejected += 1
                length = tried / SHORTER
                if span is Refused.MISFIT and at.off > SHORT:
                    refined = evaluated_at_itself(self.system, at, way)
                    at = at if isinstance(refined, Refused) else refined
                continue
            self.effort.accepted += 1
            if branch_end is not None:
                yield from self._ended(span, branch_end, way, load)
                return
            self._note_turn(span, 1.0, way)
            yield from self._stretches(span, 1.0, Equilibrium.near(span.last), load)
            at, length = span.last, min(way.longest, tried * growth(span))
            load = at.numbers.load

    def _stretches(self, span: Span, reach: float, point: Equilibrium, load: float) -> Iterator[Equilibrium]:
        """Yield a point on a span with the stretch to it from a load, after a point where the load turns before."""
        start = 0.0
        for s, top in self.loads.turns(span, reach) if self.asked_loads else ():
            yield replace(Equilibrium.near(top), stretch=Stretch(span, (start, s), (load, top.numbers.load)))
            start, load = s, top.numbers.load
        yield replace(point, stretch=Stretch(span, (start, reach), (load, point.load)))

    def _ended(self, span: Span, end: End, way: Way, load: float) -> Iterator[Point]:
        """Yield the end of a branch, to which a span leads from a load, and the point behind it."""
        self._note_turn(span, end.place, way)
        if isinstance(end, GoalReached):
            yield from self._stretches(span, end.place, Equilibrium.of(way.end, end.balance, settled=True), load)
            return
        at = end.at
        yield from self._stretches(span, end.place, Equilibrium.near(at, last=True), load)
        if isinstance(end, Touch):
            behind = self.jumps.from_touch(end)
        elif end.kind == "fold":
            behind = self.jumps.from_fold(end) or self._by_control(span.first, way)
        else:
            behind = self._behind_broken_symmetry(span, end, way)
        if way.direction < 0:
            self.least_load.note(
                "fold" if isinstance(end, LimitPoint) and end.kind == "fold" else "jump", at.numbers, at.error
            )
            self._note_behind(behind, at.error)
        yield behind

    def _note_turn(self, span: Span, reach: float, way: Way) -> None:
        """Note the least load on a span on unloading, if it is less than before."""
        if way.direction < 0:
            turn = turn_of_load(self.system, self.loads, span, reach, self.least_load.load)
            if isinstance(turn, Located):
                self.least_load.note("turn", turn.numbers, turn.error)

    def _note_behind(self, behind: Point, error: EventNumbers) -> None:
        """Note the load behind a jump that begins where the control has an error, if it is less than before."""
        if isinstance(behind, Equilibrium) and behind.load < self.least_load.load:
            at = behind_jump(self.system, behind, error, self.increments.way.tolerance)
            if isinstance(at, Located):
                self.least_load.note("jump", at.numbers, at.error)

    def _behind_broken_symmetry(self, span: Span, limit: LimitPoint, way: Way) -> Point:
        """Return the branch that begins where a symmetry breaks, if it is stable and leads on; else follow forces.

        If no such branch is found nearby, the control is stepped.
        """
        motion, at = alone(limit), limit.at
        other = other_branch(self.system, limit, motion, way)
        if isinstance(other, Refused):
            return self._by_control(span.first, way)
        if other.balance.factor is None or (other.value - at.numbers.value) * way.direction <= 0:
            return self.jumps.from_broken_symmetry(at, other.patches) or self._by_control(span.first, way)
        events = path_events((("bifurcation", leading_patch(at.patches, motion)),), at.numbers, at.error, 0.0, 0.0)
        if way.beyond(other.value) <= 0:
            return replace(Equilibrium.near(other), events=events)
        part = np.sqrt(max(-way.beyond(at.numbers.value), 0.0) / abs(other.value - at.numbers.value))
        outward = part * outward_motion(at.patches, other.patches)
        settled = self._stable(Start(at.patches.moved(outward), at.numbers.penetration, way.end))
        return replace(settled, events=events)

    def _by_control(self, at: Stand, way: Way) -> Point:
        """Return the state a little farther on by the control, where no step along the curve is left.

        If edges hardly move, nothing happened.  Else an end of the branch was not located, and is counted.
        """
        for change in NATURAL:
            change = min(change * self.increments.largest / self.increments.deepest, -way.beyond(at.value))
            value = at.value + way.direction * change
            point = self._stable(Start(at.patches, at.numbers.penetration, value))
            if isinstance(point, Failed):
                continue
            if interpenetration(self.system, point.state, self.increments.way.allowed).position.size == 0:
                return point
        self.effort.unlocated += 1
        return self.jumps.unlocated(at.balance, at.value, value)
