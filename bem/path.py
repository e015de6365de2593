"""The quasi-static path of an adhesive contact: increments, events, and the states asked for.

Between events the equilibrium edges are a smooth function of the control value tau (penetration, load or total
displacement) and are followed by a second-order predictor and Newton.  An increment is accepted only when Newton
stays on its branch (K > 0, positive definite Hessian, small steps, no energy missing) and no gap interpenetrates.
Otherwise the event in between is bracketed down to the smallest increment: new contacts by the secant of their gap,
ends of branches by bisection.  Only there is it resolved (events.py).  The path is unique; that the result does not
depend on the smallest increment is a property to verify, not to assume.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bem.assessment import Assessment, assess_equilibrium
from bem.branch import misses_energy, symmetry_breaking, tangent, unstable_patches
from bem.collocation import Evaluation
from bem.complete_contact import CompleteContact
from bem.equilibrium import LARGEST_NEWTON_STEP, Balance, System, balance, correct, energy_noise
from bem.events import Settled, first_contact, interpenetration, settle
from bem.gap import GapMinima, gap_field
from bem.increments import Effort, Increments, PathEvent, PathStatus, path_events
from bem.opening import (
    RESOLVED_GAP,
    complete_potential,
    first_gap,
    flawed_potential,
    lowest_pressure,
    opened_gap,
    opening_load,
    with_gap,
)
from bem.patches import Patches

FloatArray = NDArray[np.float64]

TOLD = 1e-3  # error of the energy that an event releases, above which it is evaluated more finely


@dataclass(frozen=True, eq=False)
class Point:
    """A state on the path: an equilibrium, or none where the surfaces are apart or fully joined.

    Attributes
    ----------
    value : float
        Of the control.
    balance : Balance or None
        Forces on the edges, where there are any.
    events : tuple of PathEvent
        What happened on the way here.
    rate, curvature : (2 L,) arrays or None
        First derivative and half the second derivative of the outward motion of the edges by tau.
    """

    status: PathStatus
    value: float
    balance: Balance | None = None
    events: tuple[PathEvent, ...] = ()
    rate: FloatArray | None = None
    curvature: FloatArray | None = None

    @property
    def state(self) -> Evaluation | None:
        """The evaluation behind the balance."""
        return None if self.balance is None else self.balance.state


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
    flaw : float, optional
        Width of the gap from which complete contact opens when the load falls; without it, it never does.
    """

    system: System
    increments: Increments
    crests: FloatArray
    complete: CompleteContact
    flaw: float | None = None
    effort: Effort = field(default_factory=Effort)
    step: float = 0.0

    def advance(self, point: Point, goal: float) -> Iterator[Point]:
        """Yield every accepted point from `point` to the goal; the last one is at the goal or has failed."""
        self.step = self.step or self.increments.largest / 4
        direction = np.sign(goal - point.value)
        closing = self._closing_value
        blocked: float | None = None
        while point.value != goal:
            if point.balance is None:
                point = self._advance_without_edges(point, goal)
                yield point
                if point.balance is None:
                    return
                continue
            if direction > 0 and point.value >= closing - self.increments.smallest * (1 + 1e-9) and goal >= closing:
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
            step = max(step, shortest)
            end = min(goal, closing - self.increments.smallest) if goal >= closing else goal
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
            if overshoot > 1.05 * shortest:
                if found is None:
                    blocked = value
                self.step = shorter
                continue
            point = self._resolve(point if accepted is None else accepted, value, found)
            self.step = max(step, self.increments.largest / 8)
            blocked = None
            yield point
            if point.status in ("not_converged", "ill_conditioned"):
                return

    def polish(self, point: Point) -> Point:
        """The point at the accuracy of a target; an event within the coarse accuracy is resolved here."""
        if point.balance is None:
            return Point(point.status, point.value)
        inc, state = self.increments, point.balance.state
        fine = correct(self.system, state.patches, state.penetration, point.value, inc.fine_tolerance, inc.fine_closure)
        self.effort.evaluations += fine.evaluations
        if fine.balance is not None:
            point = Point("converged", point.value, fine.balance, (), point.rate, point.curvature)
            found = interpenetration(self.system, fine.balance.state, inc.allowed)
            return point if found.position.size == 0 else self._resolve(point, point.value, found, fine=True)
        return self._resolve(point, point.value, None, fine=True)

    def afresh(self, point: Point) -> Point:
        """A point from which the path goes on as if it began there, so that a stored state restarts it exactly."""
        self.step = 0.0
        rate = None if point.balance is None else tangent(self.system.control, point.balance)
        return Point(point.status, point.value, point.balance, (), rate)

    def polished_at(self, point: Point, value: float) -> Point | None:
        """The point at another control value on the same branch, at the accuracy of a target, if there is one."""
        assert point.balance is not None
        inc, here = self.increments, point.balance.state
        predicted = here.patches.moved(self._predicted(point, value))
        if not predicted.is_ordered:
            return None
        fine = correct(self.system, predicted, here.penetration, value, inc.fine_tolerance, inc.fine_closure)
        self.effort.evaluations += fine.evaluations
        if fine.balance is None or interpenetration(self.system, fine.balance.state, inc.allowed).position.size:
            return None
        return Point("converged", value, fine.balance, (), tangent(self.system.control, fine.balance))

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
        inc = self.increments
        touch = max(point.value, 0.0)
        settled = settle(
            self.system, first_contact(self.system, self.crests), touch, touch, inc.tolerance, inc.closure, inc.allowed
        )
        self.effort.book(settled.evaluations, settled.local_evaluations)
        if settled.balance is None:
            return Point(settled.status, touch)
        changes = (*(("first_touch", float(crest)) for crest in self.crests), *settled.changes)
        return self._point_after(settled, touch, changes, -settled.balance.potential)

    @property
    def _closing_value(self) -> float:
        """Penetration at which contact is complete; infinite when the load takes part in the control."""
        return self.system.elastic.profile.max_height * (1 - 1e-12) if self.system.control.load_weight == 0 else np.inf

    def _closed(self, point: Point, value: float) -> tuple[PathEvent, ...]:
        """The last gaps close where the separation vanishes: a continuous end of the branch, no energy is released."""
        assert point.balance is not None
        state = point.balance.state
        middles = state.patches.right + state.patches.gap_after / 2
        changes = tuple(("complete_contact", float(x)) for x in middles)
        return path_events(changes, value, self.system.elastic.profile.max_height, state.load, 0.0)

    def _complete_load(self, value: float) -> float:
        """Load of complete contact at a value of the control; nan where the control leaves it open."""
        control = self.system.control
        if control.load_weight == 0:
            return np.nan
        return (value - control.penetration_weight * self.system.elastic.profile.max_height) / control.load_weight

    def _opened(self, point: Point, goal: float) -> Point:
        """Complete contact at the goal, or the equilibrium into which it opens on the way there."""
        inc, system = self.increments, self.system
        highest = system.elastic.profile.max_height
        if system.control.load_weight == 0:
            if goal >= self._closing_value:
                return Point("complete_contact", goal)
            value = max(goal, highest - inc.smallest)
            start, at = first_gap(system, self.complete, highest - value), value
        else:
            if self.flaw is None:
                return Point("complete_contact", goal)
            load = opening_load(system, self.complete, self.flaw, inc.fine_tolerance)
            value = min(point.value, system.control.value(highest, load))
            if goal > value:
                return Point("complete_contact", goal)
            start, at = opened_gap(system, self.complete, self.flaw, self._complete_load(value)), highest
        settled = settle(system, start, at, value, inc.tolerance, inc.closure, inc.allowed)
        self.effort.book(settled.evaluations, settled.local_evaluations)
        opening = (("opening", lowest_pressure(self.complete)),)
        changes = (*opening, *settled.changes)
        if settled.balance is None:
            opened = path_events(opening, value, highest, self._complete_load(value), np.nan)
            if settled.status != "separated":
                return Point(settled.status, value, None, opened)
            pulled = (("pull_off", settled.changes[-1][1]),)
            return Point(settled.status, value, None, (*opened, *path_events(pulled, value, 0.0, 0.0, np.nan)))
        released = 0.0
        if self.flaw is not None and system.control.load_weight > 0 and self.flaw < RESOLVED_GAP:
            load, ahead = self._complete_load(value), settled.balance
            flawed = flawed_potential(system, self.complete, self.flaw, load, value, ahead.state)
            released = flawed - ahead.potential
        elif self.flaw is not None and system.control.load_weight > 0:
            gap = with_gap(lowest_pressure(self.complete), self.flaw)
            released = balance(system, gap, highest, value, inc.tolerance).potential - settled.balance.potential
        return self._point_after(settled, value, changes, released)

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
        if self._jumped(point, ahead):
            return None, None
        found = interpenetration(self.system, corrected.balance.state, inc.allowed)
        return ahead, (found if found.position.size else None)

    def _jumped(self, start: Point, end: Point) -> bool:
        """Whether more energy went missing between two points than the forces along one branch account for.

        Newton can step over a short unstable stretch of the path.  What the coarse evaluations suspect, the accuracy
        of targets decides: coarse energies and tangents may be no better than what adhesion adds to them.
        """
        assert start.balance is not None and end.balance is not None and start.rate is not None and end.rate is not None
        inc, system, change, rates = self.increments, self.system, end.value - start.value, (start.rate, end.rate)
        if not misses_energy(system, (start.balance, end.balance), rates, change, inc.tolerance):
            return False
        ends = self._finer(start.balance, start.value), self._finer(end.balance, end.value)
        return misses_energy(system, ends, rates, change, inc.fine_tolerance)

    def _finer(self, here: Balance, value: float) -> Balance:
        """The forces on the same edges at the accuracy of a target."""
        self.effort.evaluations += 1
        state = here.state
        return balance(self.system, state.patches, state.penetration, value, self.increments.fine_tolerance)

    def _released(self, before: Balance, start: float, after: Balance, value: float, tolerance: float) -> float:
        """Potential that a jump sets free, at the accuracy of targets where energies of this tolerance do not tell."""
        released = self._pushed(before, value - start) - after.potential
        if energy_noise(self.system, before, after, tolerance) > TOLD * abs(released):
            released = self._pushed(self._finer(before, start), value - start) - self._finer(after, value).potential
        return released

    def _pushed(self, here: Balance, change: float) -> float:
        """The potential after a change of the target at fixed edges."""
        control = self.system.control
        return here.potential + change * (control.force(here.state) + change / 2 * control.force_rate(here.state))

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

    def _resolve(self, start: Point, value: float, found: GapMinima | None, fine: bool = False) -> Point:
        """Settle an event at `value`: from the last good edges, or from an equilibrium that interpenetrates (found).

        What the accuracy between targets leaves undecided (a shallow minimum, or none) that of targets decides.
        A jump of the edges that releases no energy is none: Newton only did not reach that far.
        """
        assert start.balance is not None
        inc = self.increments
        unstable = unstable_patches(start.balance) if found is None else None
        for tolerance, closure in ((inc.tolerance, inc.closure), (inc.fine_tolerance, inc.fine_closure))[int(fine) :]:
            settled = settle(
                self.system,
                start.balance.state.patches,
                start.balance.state.penetration,
                value,
                tolerance,
                closure,
                inc.allowed,
                unstable,
                found,
                start.balance.state,
            )
            self.effort.book(settled.evaluations, settled.local_evaluations)
            if settled.status != "not_converged":
                break
        broken = symmetry_breaking(start.balance) if found is None and settled.changes else ()
        if settled.balance is None:
            changes, load = (*broken, *settled.changes), 0.0
            penetration = self.system.control.guess(start.balance.state.penetration, value)
            released, before = np.nan, self._pushed(start.balance, value - start.value)
            if settled.status == "separated":
                changes = (*changes[:-1], ("pull_off", changes[-1][1]))
                released = before if self.system.control.load_weight == 0 else np.nan  # a dead tension falls for ever
            elif settled.status == "complete_contact":
                penetration, load = self.system.elastic.profile.max_height, start.balance.state.load
                released = before - complete_potential(self.system, self.complete, start.balance.state, value)
            return Point(settled.status, value, None, path_events(changes, value, penetration, load, released))
        ahead = Point(settled.status, value, settled.balance, (), tangent(self.system.control, settled.balance))
        jumped = bool(settled.changes) or self._jumped(start, ahead)
        released = self._released(start.balance, start.value, settled.balance, value, tolerance) if jumped else 0.0
        if not settled.changes and released <= 0:
            return ahead
        return self._point_after(settled, value, (*broken, *settled.changes), released)

    def _point_after(
        self, settled: Settled, value: float, changes: tuple[tuple[str, float], ...], released: float
    ) -> Point:
        """The equilibrium after an event, with its events."""
        assert settled.balance is not None
        state = settled.balance.state
        events = path_events(changes, value, state.penetration, state.load, released)
        return Point(settled.status, value, settled.balance, events, tangent(self.system.control, settled.balance))

    def _shortest(self, point: Point) -> float:
        """The smallest increment; less where within it edges at rest would lose all their stress intensity.

        Thin layers are so stiff that edges would close, and energies before and after an event not be comparable.
        """
        assert point.balance is not None
        here, control = point.balance, self.system.control
        loss = np.abs(here.state.stress_intensity_rate) * control.rate(here.state) / (2 * np.sqrt(here.work))
        return min(self.increments.smallest, 1 / float(loss.max()))

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
