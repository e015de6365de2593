"""Path of a large contact: windows followed side by side where there are many patches, else the whole contact.

Every window is followed by the engine of the whole contact (bem/path/path.py), which locates every event in it.
Windows are joined after each step (spread.py).  If windows fail, the step is halved, and at last the whole contact is
followed over it.  Targets, first touch, complete contact and loads on the way come from the whole contact.
Dimensionless; half-space, penetration control.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from bem.adhesive.branch import tangent
from bem.geometry.patches import Patches
from bem.loading.assessment import Assessment
from bem.loading.crew import Crew
from bem.loading.increments import Effort, Increments
from bem.loading.path_events import EventNumbers, PathTension, path_events
from bem.loading.points_without_edges import Failed
from bem.path.jump import Jumps
from bem.path.loads import extremes
from bem.path.locating import Start
from bem.path.path import Path
from bem.path.points_with_edges import Equilibrium, Point
from bem.path.rest import at_rest
from bem.windows.landing import WINDOW_STEP
from bem.windows.spread import Spread, Spreading

MANY_PATCHES, FEWER = 100, 0.8  # speed: patches from which windows are followed; part below which they are not
PARTS_OF_STEP = 1.0, 0.5, 0.25, 0.125  # limit: tried in turn, then the whole contact

AnyPoint = Point | Spread


@dataclass(eq=False)
class TurnInWindows:
    """Step of windows on unloading with the lowest turn of the load: the state at its start, and its last value."""

    load: float = 0.0
    step: tuple[Spread, float] | None = None

    def note(self, first: Spread, last: Spread) -> None:
        """Keep a step in which the load turns, if the load may be less there than before."""
        change = last.value - first.value
        falls, rises = change * first.stiffness < 0, change * last.stiffness > 0
        bottom = extremes((first.load, last.load), (change * first.stiffness, change * last.stiffness))[1]
        if falls and rises and bottom < self.load:
            self.load, self.step = bottom, (first, last.value)


@dataclass(frozen=True, eq=False)
class WindowedPath:
    """Path of a contact that follows windows where patches are many.

    Parameters
    ----------
    whole : Path
        Path of the whole contact.
    crew : Crew
        Processes in which windows are followed.
    turn : TurnInWindows
        Turn of the load while windows are followed.
    """

    whole: Path
    crew: Crew
    turn: TurnInWindows = field(default_factory=TurnInWindows)
    has_history: ClassVar[bool] = True

    @property
    def increments(self) -> Increments:
        """Sizes of increments, and accuracies."""
        return self.whole.increments

    @property
    def effort(self) -> Effort:
        """Counts of the work done."""
        return self.whole.effort

    @property
    def largest_tension(self) -> PathTension | None:
        """Least load met on unloading.

        The whole contact is followed over the step of windows in which the load turns lowest.
        """
        if self.turn.step is not None:
            start, value = self.turn.step
            self.turn.step = None
            point = self._gathered(start)
            if not isinstance(point, Failed):
                for _ in self.whole.advance(point, value):
                    pass
        return self.whole.largest_tension

    @cached_property
    def spreading(self) -> Spreading:
        """Path of many patches."""
        return Spreading(self.whole, self.crew)

    def direction(self, point: AnyPoint, goal: float, separation: float | None = None) -> float:
        """Return the sign of the motion of the control from a point to a goal."""
        return float(np.sign(goal - point.value))

    def advance(self, point: AnyPoint, goal: float, separation: float | None = None) -> Iterator[AnyPoint]:
        """Yield the points on the way to the goal; the last point is at the goal or has failed."""
        while point.value != goal:
            spread = self._spread(point, goal)
            if spread is not None:
                for point in self._stepped(spread, goal):
                    yield point
                if isinstance(point, Failed):
                    return
                continue
            start = self._gathered(point)
            if isinstance(start, Failed):
                yield start
                return
            if start is not point and start.events:
                yield start
            for point in self.whole.advance(start, goal):
                yield point
                if not point.last and self._spread_begins(point, goal):
                    break
            else:
                return

    def refine(self, point: AnyPoint, direction: float) -> AnyPoint:
        """Return the point at the accuracy of a target, with events that only this accuracy shows."""
        return self._gathered(point, fine=True) if isinstance(point, Spread) else self.whole.refine(point, direction)

    def restart(self, patches: Patches, penetration: float, value: float, separation: float | None = None) -> AnyPoint:
        """Return the point at given equilibrium edges, from which the path continues as if it began there."""
        return self.whole.restart(patches, penetration, value, separation)

    def assess(self, point: Equilibrium) -> Assessment:
        """Return stability, stiffness and estimated errors, from finer evaluations."""
        return self.whole.assess(point)

    def load_of(self, point: AnyPoint) -> float | None:
        """Return the load at a point; None without edges."""
        return point.load if isinstance(point, Spread) else self.whole.load_of(point)

    def may_meet(self, before: AnyPoint, after: AnyPoint, load: float) -> bool:
        """Return whether a load is met between two successive points, or may have been."""
        if not isinstance(after, Spread):
            return not isinstance(before, Spread) and self.whole.may_meet(before, after, load)
        start = self.load_of(before)
        if start is None:
            return False
        ends = [event.at.load + sign * event.error.load for event in after.events for sign in (-1, 1)]
        return min(start, after.load, *ends) < load <= max(start, after.load, *ends)

    def at_load(self, before: AnyPoint, after: AnyPoint, load: float) -> AnyPoint | None:
        """Return the refined point at a load between two successive points; None where the path jumps over it.

        Between joined windows the whole contact is followed to find it.
        """
        if not isinstance(after, Spread) and not isinstance(before, Spread):
            return self.whole.at_load(before, after, load)
        last = self._gathered(before)
        for point in () if isinstance(last, Failed) else self.whole.advance(last, after.value):
            if isinstance(point, Failed):
                return None
            if self.whole.may_meet(last, point, load):
                met = self.whole.at_load(last, point, load)
                if met is not None:
                    return met
            last = point
        return None

    def _spread_begins(self, point: AnyPoint, goal: float) -> bool:
        """Return whether windows go on from a point: many patches, and more than a step before contact is complete."""
        if not isinstance(point, Equilibrium | Spread) or point.value == goal:
            return False
        closing = self.whole.bare.closing_value
        closes = goal >= closing and point.value >= closing - 2 * WINDOW_STEP
        enough = MANY_PATCHES * (FEWER if isinstance(point, Spread) else 1.0)
        return point.patches.count >= enough and not closes

    def _spread(self, point: AnyPoint, goal: float) -> Spread | None:
        """Return a point as windows follow it; None where the whole contact is followed."""
        if not self._spread_begins(point, goal):
            return None
        if not isinstance(point, Equilibrium):
            return point if isinstance(point, Spread) else None
        if point.balance.factor is None:
            return None
        return self.spreading.at(point.value, point.patches, tangent(self.whole.system, point.balance))

    def _stepped(self, point: Spread, goal: float) -> Iterator[AnyPoint]:
        """Yield the points of one step: the joined windows at its end, or the whole contact on the way there."""
        direction, way = self.direction(point, goal), abs(goal - point.value)
        end = goal if way <= WINDOW_STEP else point.value + direction * WINDOW_STEP
        for part in PARTS_OF_STEP:
            value = end if part == 1.0 else point.value + part * (end - point.value)
            behind = self.spreading.stepped(point, value)
            if behind is not None:
                self.effort.accepted += 1
                if direction < 0:
                    self.turn.note(point, behind)
                    for event in behind.events:
                        self.whole.least_load.note("jump", event.at, event.error)
                yield behind
                return
            self.effort.rejected += 1
        start = self._gathered(point)
        yield start
        if not isinstance(start, Failed):
            yield from self.whole.advance(start, end)

    def _gathered(self, point: AnyPoint, fine: bool = False) -> Point:
        """Return joined windows as an equilibrium of the whole contact, with events; other points unchanged."""
        if not isinstance(point, Spread):
            return point
        value, whole = point.value, self.whole
        increments = replace(whole.increments, way=whole.increments.fine) if fine else whole.increments
        jumps = Jumps(whole.system, increments, whole.complete)
        rested = at_rest(jumps, Start(point.patches, value, value))
        if rested.balance is None or rested.status != "converged":
            return Failed(value, "not_converged")
        equilibrium = Equilibrium.of(value, rested.balance, settled=fine)
        state = point.state
        numbers = EventNumbers(value, state.penetration, state.load, np.nan)
        error = EventNumbers(
            WINDOW_STEP, WINDOW_STEP, abs(equilibrium.load - state.load) + WINDOW_STEP * abs(point.stiffness), np.nan
        )
        return replace(equilibrium, events=path_events(rested.changes, numbers, error, np.nan, np.nan))
