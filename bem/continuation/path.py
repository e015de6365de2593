"""The quasi-static path of an adhesive contact: increments, events, and the states asked for.

Between events the equilibrium edges are a smooth function of the control value tau (penetration, load or total
displacement) and are followed by a second-order predictor and Newton.  An increment is accepted only when Newton
stays on its branch (K > 0, positive definite Hessian, small steps along both tangents, no energy missing) and no gap
interpenetrates.  Otherwise the end of the branch in between is located by its own equation: the touch of a crest, or a
limit point (touch_points.py, limit_points.py), from which the contact jumps (jumps.py).  The path yields both the last
state of a branch and the first one behind the jump.  That neither depends on the increments is a property that tests
show; where no end is located, increments shrink until the jump begins from the last good edges.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bem.adhesive.branch import strays, tangent
from bem.adhesive.equilibrium import LARGEST_NEWTON_STEP, System, correct
from bem.adhesive.equilibrium_assessment import assess_equilibrium
from bem.adhesive.events import Settled, first_contact, interpenetration, settle
from bem.continuation.jumps import Jumps
from bem.continuation.limit_points import before_fold
from bem.continuation.opening import (
    Flaw,
    complete_potential,
    first_gap,
    flawed_potential,
    lowest_pressure,
    opened_gap,
    opening_load,
)
from bem.continuation.path_point import Point
from bem.elastic.gap import GapMinima, gap_field
from bem.geometry.patches import Patches
from bem.loading.assessment import Assessment
from bem.loading.complete_contact import CompleteContact, closing_place
from bem.loading.increments import Effort, Increments
from bem.loading.path_events import FIRST_TOUCH, NO_ERROR, Exact, PathEvent, path_events

FloatArray = NDArray[np.float64]


BRACKET = 64  # parts of the smallest increment in which an end of a branch is bracketed that is not located
CLOSED = 1e-9  # separation, in rms heights, at which the gaps that are left close together


@dataclass
class Path:
    """Follows the equilibrium of a system from point to point.

    Parameters
    ----------
    system : System
    increments : Increments
    crests : (n,) array
        Positions of the highest crests (more than one when equally high), where first touch happens.
    complete : CompleteContact
        Where the path ends, and may begin.
    flaw : Flaw, optional
        From which complete contact opens when the load falls; without it, it never does.
    """

    system: System
    increments: Increments
    crests: FloatArray
    complete: CompleteContact
    flaw: Flaw | None = None
    effort: Effort = field(default_factory=Effort)
    step: float = 0.0

    @property
    def jumps(self) -> Jumps:
        """What finds the ends of branches and jumps from them."""
        return Jumps(self.system, self.increments, self.complete, self.effort)

    def advance(self, point: Point, goal: float) -> Iterator[Point]:
        """Yield every accepted point from `point` to the goal; the last one is at the goal or has failed."""
        self.step = self.step or self.increments.largest / 4
        direction = np.sign(goal - point.value)
        closing = self._closing_value
        blocked: float | None = None
        while point.value != goal:
            if point.balance is None:
                apart = point.status == "separated"
                point = self._advance_without_edges(point, goal)
                yield point
                if point.balance is None and not (apart and point.status == "complete_contact"):
                    return
                continue
            last = self._last_increment(point, closing)
            if goal >= closing and direction > 0 and point.value >= closing - last * (1 + 1e-9):
                point = Point("complete_contact", goal, None, self._closed(point, goal))
                yield point
                return
            step = min(self.step, self.increments.largest, self._step_within_reach(point))
            shortest = self._shortest(point)
            if blocked is not None:
                if direction * (blocked - point.value) <= 0:
                    blocked = None
                else:
                    step = min(step, max(abs(blocked - point.value) / 2, shortest))
            step = max(step, shortest if blocked is not None else shortest * BRACKET)
            end = min(goal, closing - last) if goal >= closing else goal
            if step >= abs(end - point.value) * (1 - 1e-12):
                step, value = abs(end - point.value), end
            else:
                value = point.value + direction * step
            accepted, found = self._attempt(point, value)
            if accepted is not None and found is None:
                self.effort.accepted += 1
                self.step = min(2 * step, self.increments.largest)
                point = accepted
                yield point
                continue
            self.effort.rejected += 1
            overshoot, shorter = self._bracket(point, found, step, shortest)
            points = self._past_event(point, accepted, found, (value, end), overshoot <= 1.05 * shortest)
            if not points and overshoot > 1.05 * shortest:
                if found is None:
                    blocked = value
                self.step = shorter
                continue
            points = points or [self.jumps.unlocated(point if accepted is None else accepted, value, found)]
            yield from points
            point = points[-1]
            self.step = max(step, self.increments.largest / 8)
            blocked = None
            if point.status in ("not_converged", "ill_conditioned"):
                return

    def _past_event(
        self,
        point: Point,
        ahead: Point | None,
        found: GapMinima | None,
        ends: tuple[float, float],
        thorough: bool,
    ) -> list[Point]:
        """The end of the branch of a point and the state behind the jump; nothing where it is not located.

        Parameters
        ----------
        point, ahead : Point
            On the branch; None where Newton left it on the way.
        found : GapMinima or None
            Where the second interpenetrates.
        ends : (float, float)
            Where it was to be, and how far the path goes.
        thorough : bool
            Whether shorter increments are no alternative.
        """
        if ahead is not None and found is not None:
            return self.jumps.from_touch(point, ahead, found)
        reach, direction = ends[0] - point.value, np.sign(ends[0] - point.value)
        limit = self.jumps.limit_point(point, reach, thorough)
        if limit is None:  # it may lie behind the point: coarse evaluations lead a little farther than the branch
            return []
        if direction * (limit.exact.value - ends[1]) <= 0:
            return self.jumps.from_limit(limit, reach)
        state = limit.balance.state
        if limit.kind == "bifurcation":
            return []
        near = self._corrected(before_fold(limit, ends[1]), state.penetration, ends[1])
        return [] if near is None or self.interpenetrates(near) else [near]

    def _corrected(self, patches: Patches, penetration: float, value: float) -> Point | None:
        """The equilibrium near given edges at the accuracy of a target, if Newton finds one."""
        if not patches.is_ordered:
            return None
        inc = self.increments
        fine = correct(self.system, patches, penetration, value, inc.fine_tolerance, inc.fine_closure)
        self.effort.evaluations += fine.evaluations
        if fine.balance is None:
            return None
        return Point("converged", value, fine.balance, (), tangent(self.system.control, fine.balance))

    def interpenetrates(self, point: Point) -> bool:
        """Whether contact forms beside the edges of a point."""
        assert point.balance is not None
        return bool(interpenetration(self.system, point.balance.state, self.increments.allowed).position.size)

    def polish(self, point: Point, direction: float) -> Point:
        """The point at the accuracy of a target; a branch that ends within the coarse accuracy is left here.

        Parameters
        ----------
        point : Point
        direction : float
            Sign of the motion of the control that led here.
        """
        if point.balance is None:
            return Point(point.status, point.value)
        inc, state, value = self.increments, point.balance.state, point.value
        fine = correct(self.system, state.patches, state.penetration, value, inc.fine_tolerance, inc.fine_closure)
        self.effort.evaluations += fine.evaluations
        found = None
        if fine.balance is not None:
            polished = Point("converged", value, fine.balance, (), point.rate, point.curvature)
            found = interpenetration(self.system, fine.balance.state, inc.allowed)
            if found.position.size == 0:
                return polished
            before = self.polished_at(polished, value - direction * inc.smallest / 8)
            points = [] if before is None else self.jumps.from_touch(before, polished, found)
        else:
            points = self._past_event(point, None, None, (value + direction * inc.smallest / 8, value), True)
        if not points:
            return self.jumps.unlocated(point, value, found, fine=True)
        if points[-1].value != value and points[-1].balance is not None:
            points += self.advance(points[-1], value)
        events = [event for behind in points for event in behind.events]
        final = self.polish(points[-1], direction)
        return replace(final, events=(*events, *final.events))

    def afresh(self, point: Point) -> Point:
        """A point from which the path goes on as if it began there, so that a stored state restarts it exactly."""
        self.step = 0.0
        rate = None if point.balance is None else tangent(self.system.control, point.balance)
        return Point(point.status, point.value, point.balance, (), rate)

    def polished_at(self, point: Point, value: float) -> Point | None:
        """The point of the same branch at another value of the control, at the accuracy of a target, or None.

        The branch goes on where contact forms beside it.
        """
        assert point.balance is not None
        state = point.balance.state
        if point.fold is None:
            patches = state.patches.moved(self._predicted(point, value))
        else:
            patches = before_fold(point.fold, value)
        return self._corrected(patches, state.penetration, value)

    def _predicted(self, point: Point, value: float) -> FloatArray:
        """Outward motion of the edges from a point to another control value, to second order."""
        assert point.rate is not None
        change = value - point.value
        outward = change * point.rate
        return outward if point.curvature is None else outward + change**2 * point.curvature

    def assess(self, point: Point) -> Assessment:
        """Stability, stiffness and estimated errors, from finer evaluations."""
        assert point.balance is not None
        self.effort.evaluations += 2
        return assess_equilibrium(self.system, point.balance, point.value, 1e-2 * self.increments.fine_tolerance)

    def _advance_without_edges(self, point: Point, goal: float) -> Point:
        """From separated surfaces to first touch (at value 0), from complete contact to its opening, or to the goal."""
        if point.status == "complete_contact":
            return self._opened(point, goal)
        if point.status != "separated" or goal < 0:
            return Point(point.status, goal)
        touch = max(point.value, 0.0)
        settled = self._settled(first_contact(self.system, self.crests), touch, touch)
        changes = (*(("first_touch", float(crest)) for crest in self.crests), *settled.changes)
        touched = self.jumps.behind(FIRST_TOUCH, NO_ERROR, settled, changes)
        return Point("not_converged", touch) if touched is None else touched

    @property
    def _closing_value(self) -> float:
        """Penetration at which contact is complete; infinite when the load takes part in the control."""
        return self.system.elastic.profile.max_height * (1 - 1e-12) if self.system.control.load_weight == 0 else np.inf

    def _last_increment(self, point: Point, closing: float) -> float:
        """The increment before complete contact: the smallest; half the way, where several gaps are left."""
        assert point.balance is not None
        if point.balance.state.patches.count == 1:
            return self.increments.smallest
        return max((closing - point.value) / 2, CLOSED)

    def _closed(self, point: Point, value: float) -> tuple[PathEvent, ...]:
        """The last gap closes where the separation vanishes: a continuous end of the branch, no energy is released."""
        assert point.balance is not None
        patches = point.balance.state.patches
        last = int(np.argmax(patches.gap_after))  # others release energy when they close before it
        near = float(patches.right[last] + patches.gap_after[last] / 2)
        place = closing_place(self.complete, self.system.elastic.profile, self.system.law, near)
        return path_events((("complete_contact", place),), self._fully_joined(value), NO_ERROR, 0.0, 0.0)

    def _fully_joined(self, value: float) -> Exact:
        """Complete contact at a value of the control; the tension under which the last gap closes has no bound."""
        control, highest = self.system.control, self.system.elastic.profile.max_height
        value = value if control.load_weight else highest
        potential = complete_potential(self.system, self.complete, value)
        return Exact(value, highest, control.load(highest, value), potential)

    def _opened(self, point: Point, goal: float) -> Point:
        """Complete contact at the goal, or the equilibrium into which it opens on the way there."""
        if self.system.control.load_weight > 0:
            return self._opened_at_flaw(point, goal)
        if goal >= self._closing_value:
            return Point("complete_contact", goal)
        system, highest = self.system, self.system.elastic.profile.max_height
        value = max(goal, highest - self.increments.smallest)
        settled = self._settled(first_gap(system, self.complete, highest - value), value, value)
        if settled.balance is None or settled.changes:
            return Point("not_converged", value)
        opening = ("opening", lowest_pressure(self.complete))
        events = path_events((opening,), self._fully_joined(value), NO_ERROR, 0.0, 0.0)
        return Point("converged", value, settled.balance, events, tangent(system.control, settled.balance))

    def _opened_at_flaw(self, point: Point, goal: float) -> Point:
        """The same where the load takes part in the control: without a flaw complete contact stays."""
        flaw, system, complete, inc = self.flaw, self.system, self.complete, self.increments
        if flaw is None:
            return Point("complete_contact", goal)
        highest = system.elastic.profile.max_height
        load = opening_load(system, complete, flaw, inc.fine_tolerance)
        value = min(point.value, system.control.value(highest, load))
        if goal > value:
            return Point("complete_contact", goal)
        joined = self._fully_joined(value)
        settled = self._settled(opened_gap(system, complete, flaw, joined.load), highest, value)
        joined = replace(joined, potential=flawed_potential(system, complete, flaw, value, inc.fine_tolerance))
        behind = self.jumps.behind(joined, NO_ERROR, settled, (("opening", flaw.center), *settled.changes))
        return Point("not_converged", value) if behind is None else behind

    def _settled(self, start: Patches, penetration: float, value: float) -> Settled:
        inc = self.increments
        settled = settle(self.system, start, penetration, value, inc.tolerance, inc.closure, inc.allowed)
        self.effort.book(settled.evaluations, settled.local_evaluations)
        return settled

    def _attempt(self, point: Point, value: float) -> tuple[Point | None, GapMinima | None]:
        """Newton from the predicted edges; the new point (None: left the branch) and its interpenetrations."""
        assert point.balance is not None and point.rate is not None
        inc, here = self.increments, point.balance.state
        change = value - point.value
        predicted = here.patches.moved(self._predicted(point, value))
        if not predicted.is_ordered:
            return None, None
        corrected = correct(self.system, predicted, here.penetration, value, inc.tolerance, inc.closure)
        self.effort.evaluations += corrected.evaluations
        if corrected.balance is None:
            return None, None
        self.effort.unknowns = max(self.effort.unknowns, corrected.balance.state.unknowns)
        rate = tangent(self.system.control, corrected.balance)
        ahead = Point("converged", value, corrected.balance, (), rate, (rate - point.rate) / (2 * change))
        if strays(
            (point.balance, corrected.balance), (point.rate, rate), change, inc.closure
        ) or self.jumps.misses_energy(point, ahead):
            return None, None
        found = interpenetration(self.system, corrected.balance.state, inc.allowed)
        return ahead, (found if found.position.size else None)

    def _bracket(self, point: Point, found: GapMinima | None, step: float, shortest: float) -> tuple[float, float]:
        """How far a failed increment went beyond its event at most, and the increment to try instead."""
        assert point.balance is not None
        if found is None:
            return step, max(step / 4, shortest)
        state = point.balance.state
        patches = state.patches
        behind = patches.right[found.gap]
        inside = (found.position > behind) & (found.position < behind + patches.gap_after[found.gap])
        if not np.all(inside):
            return step, max(step / 4, shortest)
        before = gap_field(self.system.elastic, state)(found.position, found.gap)
        fraction = float(np.min(np.maximum(before, 0.0) / (np.maximum(before, 0.0) - found.depth)))
        return step * (1 - fraction), max(min(step * fraction + shortest / 2, 0.9 * step), shortest)

    def _shortest(self, point: Point) -> float:
        """Where the end of a branch is not located, the increment in which it is bracketed.

        A part of the smallest; less where within that edges at rest would lose all their stress intensity.

        Thin layers are so stiff that edges would close, and energies before and after an event not be comparable.
        """
        assert point.balance is not None
        here, control = point.balance, self.system.control
        loss = np.abs(here.state.stress_intensity_rate) * control.rate(here.state) / (2 * np.sqrt(here.work))
        return min(self.increments.smallest, 1 / float(loss.max())) / BRACKET

    def _step_within_reach(self, point: Point) -> float:
        """The increment whose predicted motion uses half of what Newton may travel."""
        assert point.balance is not None and point.rate is not None
        speed = float(np.max(np.abs(point.rate) / point.balance.state.patches.edge_room))
        return 0.5 * LARGEST_NEWTON_STEP / speed if speed > 0 else np.inf


def restart(path: Path, patches: Patches, penetration: float, value: float) -> Point:
    """The point of a path at given equilibrium edges; status `not_converged` when they are none."""
    inc = path.increments
    found = correct(path.system, patches, penetration, value, inc.fine_tolerance, inc.fine_closure)
    path.effort.evaluations += found.evaluations
    if found.balance is None:
        return Point("not_converged", value)
    return Point("converged", value, found.balance, (), tangent(path.system.control, found.balance))
