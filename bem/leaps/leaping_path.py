"""A path of few digits: from value to value of the control in leaps, with exact equilibria where states are kept.

What lies between two leaps is not located.  An event is a bracket: it lies somewhere in the interval of its leap, and
its error says so.  Overdriven by up to an interval, a jump may end in another minimum, so that now and then a state is
an equilibrium of another branch; the shorter the interval, the rarer (bem/README.md, section 4).  States that are kept are
settled at the accuracy of targets, and just before a value that is asked for a short leap comes, behind which events
that lie beside it are told apart.

First touch, complete contact, stored states and their assessment are those of the exact path.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from bem.adhesive.branch import after_step
from bem.adhesive.relaxation import Relaxed
from bem.continuation.jumps import DOUBT
from bem.continuation.locating import AtLoad, Refused, Start, settle
from bem.continuation.path import Path
from bem.continuation.points_with_edges import Equilibrium, Point
from bem.geometry.patches import Patches
from bem.leaps.leap import leap, tangent
from bem.loading.assessment import Assessment
from bem.loading.increments import Effort, Increments
from bem.loading.path_events import EventNumbers, path_events
from bem.loading.path_point import Complete, Failed, Separated

LAST_LEAP = 2e-3  # rms heights before a value that is asked for
NOT_SHORT = 0.3  # of an interval: less is left to no leap of its own
HALVINGS = 6  # of an interval in which a leap fails


@dataclass(frozen=True, eq=False)
class LeapingPath:
    """Leaps from state to state.

    Parameters
    ----------
    exact : Path
        That of the same scene event by event.
    interval : float
        Of the control, from one leap to the next.
    """

    exact: Path
    interval: float
    has_history: ClassVar[bool] = True

    @property
    def increments(self) -> Increments:
        """Those of the exact path."""
        return self.exact.increments

    @property
    def effort(self) -> Effort:
        """Counts of the work done."""
        return self.exact.effort

    def direction(self, point: Point, goal: float, separation: float | None = None) -> float:
        """Sign of the motion of the control from a point to a goal."""
        return self.exact.direction(point, goal, separation)

    def advance(self, point: Point, goal: float, separation: float | None = None) -> Iterator[Point]:
        """Yield the point behind every leap on the way to the goal; the last one is there or has failed."""
        closing, before = self.exact.bare.closing_value, None
        while point.value != goal:
            if isinstance(point, Equilibrium):
                before, point = point, self._next(before, point, goal, closing)
            else:
                before, point = None, self.exact.bare.advance(point, goal)
            yield point
            if isinstance(point, Failed):
                return

    def refine(self, point: Point, direction: float) -> Point:
        """The point at the accuracy of a target, with events that only this accuracy shows."""
        if not isinstance(point, Equilibrium) or point.settled:
            return replace(point, events=())
        at_rest = np.zeros(point.balance.work.size)
        landed = leap(self.exact.system, point.balance, at_rest, point.value, self.increments.fine)
        found = self._behind(point, landed, direction * LAST_LEAP)
        return replace(found, settled=True) if isinstance(found, Equilibrium) else found

    def restart(self, patches: Patches, penetration: float, value: float, separation: float | None = None) -> Point:
        """The point at given equilibrium edges, from which the path continues as if it began there."""
        return self.exact.restart(patches, penetration, value, separation)

    def assess(self, point: Equilibrium) -> Assessment:
        """Stability, stiffness and estimated errors, from finer evaluations."""
        return self.exact.assess(point)

    def load_of(self, point: Point) -> float | None:
        """Load at a point; None without edges."""
        return self.exact.load_of(point)

    def may_meet(self, before: Point, after: Point, load: float) -> bool:
        """Whether a load is met between two successive points."""
        start, end = self.load_of(before), self.load_of(after)
        return start is not None and end is not None and min(start, end) < load <= max(start, end)

    def at_load(self, before: Point, after: Point, load: float) -> Point | None:
        """The refined point at a load between two successive points; None where the path jumps over it."""
        if not (isinstance(before, Equilibrium) and isinstance(after, Equilibrium)):
            return self.exact.at_load(before, after, load)
        system, fine = self.exact.system, self.increments.fine
        for _ in range(HALVINGS):
            for point in (after, before):
                start = Start(point.patches, point.state.penetration, point.value)
                found = settle(system.sloped, start, AtLoad(system, load, fine.residual), fine)
                if not isinstance(found, Refused) and min(before.value, after.value) <= found[1] <= max(before.value, after.value):
                    return Equilibrium.of(found[1], found[0], settled=True)
            middle = self._leapt(None, before, (before.value + after.value) / 2)
            if not isinstance(middle, Equilibrium):
                return None
            before, after = (before, middle) if self.may_meet(before, middle, load) else (middle, after)
        return None

    def _next(self, before: Point | None, point: Equilibrium, goal: float, closing: float) -> Point:
        """The point behind the next leap; where none is found, behind a shorter one."""
        direction, value = self.direction(point, goal), 0.0
        if direction > 0 and goal >= closing and closing - point.value <= LAST_LEAP:
            return self.exact.bare.closed(point, goal)
        left = abs(min(goal, closing) - point.value)
        change = self._interval(left)
        for _ in range(HALVINGS):
            value = goal if change == left and goal < closing else point.value + direction * change
            found = self._leapt(before, point, value)
            if not isinstance(found, Failed):
                self.effort.accepted += 1
                return found
            self.effort.rejected += 1
            change /= 2
        return Failed(value, "not_converged")

    def _interval(self, left: float) -> float:
        """Change of the control in the next leap: the last one is short, and none is much shorter than an interval."""
        if left <= (1 + NOT_SHORT) * LAST_LEAP:
            return left
        return left - LAST_LEAP if left - LAST_LEAP < (1 + NOT_SHORT) * self.interval else self.interval

    def _leapt(self, before: Point | None, point: Equilibrium, value: float) -> Point:
        """The point behind a leap to a value of the control."""
        system, change = self.exact.system, value - point.value
        rate = tangent(system, point.balance)
        motion = change * rate
        if isinstance(before, Equilibrium) and not point.events:
            past = point.value - before.value
            motion = motion + change**2 / (2 * past) * (rate - tangent(system, before.balance))
        landed = leap(system, point.balance, motion, value, self.increments.coarse)
        return self._behind(point, landed, change)

    def _behind(self, point: Equilibrium, landed: Relaxed, width: float) -> Point:
        """The point behind a leap, with its events as brackets: they lie in an interval of this width before it."""
        system, here, value = self.exact.system, point.balance, landed.target
        rate, change = tangent(system, here), value - point.value
        old = after_step(system, here, point.value, change * rate, change)
        at = after_step(system, here, point.value, (change - width / 2) * rate, change - width / 2)
        error = _half(at, old, width)
        if landed.balance is None:
            return self.exact.jumps.behind(replace(at, potential=old.potential), error, landed, landed.changes)
        if landed.status != "converged":
            return Failed(value, "not_converged")
        state = landed.balance.state
        released = old.potential - landed.balance.potential
        doubt = abs(width * (system.control.force(here.state) - system.control.force(state)))
        surely = any(kind != "bifurcation" for kind, _ in landed.changes)
        changes = landed.changes if surely or released > DOUBT * doubt else ()
        found = Equilibrium.of(value, landed.balance)
        return replace(found, events=path_events(changes, at, error, released, doubt))


def _half(middle: EventNumbers, end: EventNumbers, width: float) -> EventNumbers:
    """How far the ends of a bracket are from its middle; in it the potential is known to what the load is."""
    return EventNumbers(
        abs(width) / 2,
        abs(end.penetration - middle.penetration),
        abs(end.load - middle.load),
        abs(end.potential - middle.potential),
    )
