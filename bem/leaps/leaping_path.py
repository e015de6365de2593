"""A path of few digits: from value to value of the control in leaps, with exact equilibria where states are kept.

What lies between two leaps is not located.  An event is a bracket: it lies somewhere in the interval of its leap, and
its error says so.  At 1e-4 brackets are narrower than leaps: one in which something happens is halved until the event
is in a short one.  Overdriven by up to an interval, a jump may end in another minimum, so that now and then a state is
an equilibrium of another branch; the shorter the interval, the rarer (bem/README.md, section 4).  States that are kept
are settled at the accuracy of targets, and a short leap comes before each value that is asked for: events beside it are
told apart.

First touch, complete contact, stored states and their assessment are those of the exact path.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from bem.adhesive.branch import tangent
from bem.adhesive.relaxation import interpenetration
from bem.continuation.locating import AtLoad, Refused, Start, settle
from bem.continuation.path import Path
from bem.continuation.points_with_edges import Equilibrium, Point
from bem.geometry.patches import Patches
from bem.leaps.brackets import brackets, unbracketed
from bem.leaps.leap import Leapt, leap, newton, quiet_leap
from bem.leaps.spread import Spread, Spreading
from bem.loading.assessment import Assessment, Quantities
from bem.loading.crew import Crew
from bem.loading.increments import Accuracy, Effort, Increments
from bem.loading.path_events import PathTension
from bem.loading.points_without_edges import Complete, Failed, Separated

# rms heights at a tolerance of 1e-3, and the power of the tolerance with which it grows from there
INTERVAL, GROWTH = 0.01, 0.7
RESIDUAL = 1e-2  # of states that are not kept, and in proportion less below 1e-3
LAST_LEAP = 2e-3  # rms heights before a value that is asked for
NOT_SHORT = 0.3  # speed: of an interval: no leap of its own is that short
LEAPS_TRIED = 16  # limit: of an interval in which one fails: shorter and shorter, up to what happens in it
HALVINGS = 6  # limit: of an interval in which a load is met
WINDOWED, FEW = 64, 0.8  # speed: patches from which windows leap; part of them below which they no longer do
CLOSE = 1e-9  # derived: of the smallest increment: as good as there
STATES_APART = 20.0  # format: times `accuracy.max_increment` between states stored: a state takes as long as ten leaps
DOUBTED = 1 / 3  # derived: of the tolerance: correction of a number whose estimated error is the tolerance of it

AnyPoint = Point | Spread


@dataclass(frozen=True, eq=False)
class LeapingPath:
    """Leaps from state to state.

    Parameters
    ----------
    exact : Path
        That of the same scene event by event.
    tolerance : float
        Of what is reported: it says how long leaps are.
    crew : Crew
        Processes in which windows leap.
    """

    exact: Path
    tolerance: float
    crew: Crew
    has_history: ClassVar[bool] = True
    largest_tension: ClassVar[PathTension | None] = None  # not located yet

    @cached_property
    def bracket(self) -> float:
        """Change of the control in a leap in which something happens."""
        ratio = self.tolerance / 1e-3
        return min(INTERVAL * float(min(ratio, ratio**GROWTH)), self.exact.increments.largest)

    @cached_property
    def interval(self) -> float:
        """Change of the control in a leap at most: where nothing happens it is no shorter than at 1e-3."""
        return max(self.bracket, min(INTERVAL, self.exact.increments.largest))

    @cached_property
    def increments(self) -> Increments:
        """The increments of the exact path, with states farther apart."""
        return replace(self.exact.increments, largest=STATES_APART * self.exact.increments.largest)

    @cached_property
    def between(self) -> Accuracy:
        """Accuracy of states that are not kept: edges need only be near enough for the next leap."""
        coarse = self.increments.coarse
        return replace(coarse, residual=max(coarse.residual, RESIDUAL * min(1.0, self.tolerance / 1e-3)))

    @cached_property
    def spreading(self) -> Spreading:
        """What leads many patches."""
        return Spreading(self.exact.system, self.increments.fine, self.crew)

    def _spreads(self, count: int) -> bool:
        """Whether so many patches leap in windows: on a half-space, at a given penetration."""
        system = self.exact.system
        return count >= WINDOWED and system.elastic.compliance is None and not system.control.load_weight

    @property
    def effort(self) -> Effort:
        """Counts of the work done."""
        return self.exact.effort

    def direction(self, point: AnyPoint, goal: float, separation: float | None = None) -> float:
        """Sign of the motion of the control from a point to a goal."""
        return float(np.sign(goal - point.value))

    def advance(self, point: AnyPoint, goal: float, separation: float | None = None) -> Iterator[AnyPoint]:
        """Yield the point behind every leap on the way to the goal; the last one is there or has failed."""
        before: AnyPoint | None = None
        while point.value != goal:
            if isinstance(point, Equilibrium | Spread):
                before, point = point, self._next(before, point, goal)
            else:
                before, point = None, self.exact.bare.advance(point, goal)
            yield point
            if isinstance(point, Failed):
                return

    def refine(self, point: AnyPoint, direction: float) -> AnyPoint:
        """The point at the accuracy of a target, with events that only this accuracy shows."""
        if isinstance(point, Spread):
            return self.spreading.settled(point, direction * LAST_LEAP) or Failed(point.value, "not_converged")
        if not isinstance(point, Equilibrium) or point.settled:
            return replace(point, events=())
        start = Start(point.patches, point.state.penetration, point.value)
        at_rest, fine = np.zeros(point.balance.work.size), self.increments.fine
        landed = leap(self.exact.system, start, at_rest, point.value, fine, point.balance)
        found = self._behind(point, landed, direction * LAST_LEAP)
        return replace(found, settled=True) if isinstance(found, Equilibrium) else found

    def restart(self, patches: Patches, penetration: float, value: float, separation: float | None = None) -> AnyPoint:
        """The point at given equilibrium edges, from which the path continues as if it began there."""
        if self._spreads(patches.count):
            return self.spreading.restarted(patches, value) or Failed(value, "not_converged")
        return self.exact.restart(patches, penetration, value, separation)

    def assess(self, point: Equilibrium | Spread) -> Assessment:
        """Stability, stiffness and estimated errors: those of the equilibrium, and that the path is uncertain."""
        found = self.spreading.assess(point) if isinstance(point, Spread) else self.exact.assess(point)
        part, state = DOUBTED * self.tolerance, point.state
        load = part * max(abs(state.load), abs(found.stiffness))
        energy = part * (state.elastic_energy + abs(found.adhesion_energy))
        doubt = Quantities(
            penetration=self.exact.system.control.load_weight * load,
            load=load,
            contact_length=part * float(np.sum(state.patches.width)),
            elastic_energy=energy,
            adhesion_energy=energy,
            total_energy=energy,
            stress_intensity=part * float(np.max(state.stress_intensity)),
            stiffness=part * abs(found.stiffness),
        )
        return replace(found, correction=found.correction.widened(doubt))

    def load_of(self, point: AnyPoint) -> float | None:
        """Load at a point; None without edges."""
        return point.load if isinstance(point, Spread) else self.exact.load_of(point)

    def may_meet(self, before: AnyPoint, after: AnyPoint, load: float) -> bool:
        """Whether a load is met between two successive points, or may have been before an event between them."""
        start, end = self.load_of(before), self.load_of(after)
        if start is None or end is None:
            return False
        ends = [event.at.load + sign * event.error.load for event in after.events[:1] for sign in (-1, 1)]
        return min(start, end, *ends) < load <= max(start, end, *ends)

    def at_load(self, before: AnyPoint, after: AnyPoint, load: float) -> AnyPoint | None:
        """The refined point at a load between two successive points; None where the path jumps over it.

        Where events lie between them, or the state is far from either, the interval is halved until it is on the
        branch of one of its ends.
        """
        if isinstance(before, Separated | Complete | Failed) or isinstance(after, Separated | Complete | Failed):
            beside = [None if isinstance(point, Spread) else point for point in (before, after)]
            return None if beside[0] is None or beside[1] is None else self.exact.at_load(beside[0], beside[1], load)
        for _ in range(HALVINGS):
            found = self._on_branch(before, after, load) or self._on_branch(after, before, load)
            if found is not None and not isinstance(found, Refused):
                return found
            middle = self._leapt(None, before, (before.value + after.value) / 2)
            if not isinstance(middle, Equilibrium | Spread):
                return None
            before, after = (before, middle) if self.may_meet(before, middle, load) else (middle, after)
        return None

    def _on_branch(
        self, point: Equilibrium | Spread, other: Equilibrium | Spread, load: float
    ) -> AnyPoint | Refused | None:
        """The state at a load on the branch of a point, on its way to another one.

        None where it is not there, `Refused.FAR` where that is too far away to tell.
        """
        if isinstance(point, Spread):
            return self.spreading.at_load(point, other.value, load)
        system, fine = self.exact.system, self.increments.fine
        start = Start(point.patches, point.state.penetration, point.value)
        found = settle(system.sloped, start, AtLoad(system, load, fine.residual), fine)
        if found is Refused.FAR:
            return found
        if isinstance(found, Refused) or found[0].factor is None:
            return None
        between = min(point.value, other.value) <= found[1] <= max(point.value, other.value)
        closed = interpenetration(system, found[0].state, fine.allowed)
        return Equilibrium.of(found[1], found[0], settled=True) if between and not closed.position.size else None

    def _next(self, before: AnyPoint | None, point: Equilibrium | Spread, goal: float) -> AnyPoint:
        """The point behind the next leap; where that fails, behind shorter ones up to what happens in it."""
        direction, closing, end = self.direction(point, goal), self.exact.bare.closing_value, goal
        if direction > 0 and goal >= closing:
            end = closing - self.exact.last_increment(point.value, point.patches.count, closing)
            if point.value >= end - CLOSE * self.increments.smallest:
                return self.exact.bare.closed(point.patches, goal)
        change = self._change(abs(end - point.value))
        value = end if change == abs(end - point.value) else point.value + direction * change
        first, beyond = point, None
        for _ in range(LEAPS_TRIED):
            found = self._leapt(before, point, value)
            if isinstance(found, Failed):
                self.effort.rejected += 1
                beyond, value = value, (point.value + value) / 2
                continue
            self.effort.accepted += 1
            if beyond in (None, value) or found.events or not isinstance(found, Equilibrium | Spread):
                return found
            before, point = point, found
            value = beyond if self._may_hold_events(beyond - value) else (value + beyond) / 2
        return found if point is first else point

    def _may_hold_events(self, change: float) -> bool:
        """Whether a leap is so short that events may lie in it."""
        return abs(change) <= (1 + NOT_SHORT) * self.bracket

    def _change(self, left: float) -> float:
        """Change of the control in the next leap: the last one is short, and none is much shorter than an interval."""
        if left <= (1 + NOT_SHORT) * LAST_LEAP:
            return left
        return left - LAST_LEAP if left - LAST_LEAP < (1 + NOT_SHORT) * self.interval else self.interval

    def _leapt(self, before: AnyPoint | None, point: Equilibrium | Spread, value: float) -> AnyPoint:
        """The point behind a leap to a value of the control; where something happens in it, it must be short."""
        system, change = self.exact.system, value - point.value
        quiet = not self._may_hold_events(change)
        if isinstance(point, Spread):
            return self._gathered(self.spreading.leapt(point, value, self.between, quiet=quiet), value)
        rate = tangent(system, point.balance)
        motion = change * rate
        if isinstance(before, Equilibrium) and not point.events:
            past = point.value - before.value
            motion = motion + change**2 / (2 * past) * (rate - tangent(system, before.balance))
        start = Start(point.patches, point.state.penetration, point.value)
        if quiet:
            landed = quiet_leap(system, start, motion, value, self.between)
        else:
            landed = leap(system, start, motion, value, self.between, point.balance)
        return Failed(value, "not_converged") if landed is None else self._spread(self._behind(point, landed, change))

    def _spread(self, point: Point) -> AnyPoint:
        """A point that leaps in windows, if its patches are many."""
        if not isinstance(point, Equilibrium) or not self._spreads(point.patches.count):
            return point
        rate = tangent(self.exact.system, point.balance)
        return Spread(point.value, point.state, rate, np.zeros(rate.size), events=point.events)

    def _gathered(self, point: Spread | None, value: float) -> AnyPoint:
        """A point that leaps as a whole, if its patches are few."""
        if point is None:
            return Failed(value, "not_converged")
        if point.patches.count >= FEW * WINDOWED:
            return point
        found = newton(self.exact.system, point.patches, value, value, self.between).balance
        if found is None:
            return Failed(value, "not_converged")
        return replace(Equilibrium.of(value, found), events=point.events)

    def _behind(self, point: Equilibrium, landed: Leapt, width: float) -> Point:
        """The point behind a leap, with its events as brackets: they lie in an interval of this width before it."""
        relaxed = landed.relaxed
        if relaxed.balance is None:
            numbers, error = unbracketed(self.exact.system, point.balance, point.value, relaxed, width)
            return self.exact.jumps.behind(numbers, error, relaxed, relaxed.changes)
        if relaxed.status != "converged":
            return Failed(relaxed.target, "not_converged")
        events = brackets(self.exact.system, landed, point.value, width)
        return replace(Equilibrium.of(relaxed.target, relaxed.balance), events=events)
