"""Jumps of an adhesive path: where a branch ends, where the contact jumps from there, and the energy that it releases.

A branch ends at a limit point or where a crest touches; both are located first (limit_points.py, touch_points.py), so
that neither the jump nor its numbers depend on the increments.  The jump itself follows the forces at the value of the
control at which the branch ends (events.py); what it releases is the difference of the potential of two equilibria,
each improved until another resolution changes nothing.  Where no end is located within the smallest increment, the
jump begins from the last good edges, and the increment is its error.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bem.adhesive.branch import misses_energy, tangent, unstable_patches
from bem.adhesive.equilibrium import Balance, System, balance, edge_positions
from bem.adhesive.events import Settled, interpenetration, settle
from bem.continuation.departure import departure
from bem.continuation.limit_points import LimitPoint, at_rest, locate_limit_point
from bem.continuation.opening import complete_potential
from bem.continuation.path_point import Point
from bem.continuation.touch_points import locate_touch
from bem.elastic.gap import GapMinima, gap_field
from bem.geometry.patches import Patches
from bem.loading.complete_contact import CompleteContact
from bem.loading.increments import Effort, Increments
from bem.loading.path_events import Exact, path_events

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

FINE = 1e-5  # tolerance of the first of the two evaluations that give an event its numbers
DOUBT = 3.0  # times its error: less energy is not released
TIED = 1e-6  # relative difference of patches that move alike
MOVING = 0.3  # of the largest motion in units of room: patches that move with a mode


@dataclass(frozen=True, eq=False)
class Jumps:
    """Finds the ends of branches and jumps from them.

    Parameters
    ----------
    system : System
    increments : Increments
    complete : CompleteContact
    effort : Effort
        On which evaluations are booked.
    """

    system: System
    increments: Increments
    complete: CompleteContact
    effort: Effort

    @property
    def _fine(self) -> tuple[float, float]:
        """Tolerances of the two evaluations that give an event its numbers."""
        finest = self.increments.fine_tolerance
        return max(min(FINE, self.increments.tolerance), finest), finest

    def from_touch(self, point: Point, ahead: Point, found: GapMinima) -> list[Point]:
        """The touch between two points of a branch and the state behind its jump; nothing where it is not located."""
        assert point.balance is not None and ahead.balance is not None
        before = point.balance.state
        behind = before.patches.right[found.gap]
        inside = (found.position > behind) & (found.position < behind + before.patches.gap_after[found.gap])
        if not np.all(inside):
            return []
        gaps = gap_field(self.system.elastic, before)(found.position, found.gap), found.depth
        touch = locate_touch(
            self.system,
            lambda value: _interpolated(point, ahead, value),
            before.penetration,
            (point.value, ahead.value),
            gaps,
            found,
            self._fine,
        )
        if touch is None:
            return []
        self.effort.evaluations += touch.evaluations
        end = self._with_tangent(Point("converged", touch.exact.value, touch.balance, last=True))
        settled = self._settled(touch.balance, touch.balance.state.patches, touch.exact.value, None, touch.touching)
        after = self.behind(touch.exact, touch.error, settled, settled.changes)
        return [] if after is None else [end, after]

    def limit_point(self, point: Point, reach: float, thorough: bool) -> LimitPoint | None:
        """The limit point that ends the branch of a point within about `reach` of the control, if there is one."""
        assert point.balance is not None
        coarse = self.increments.tolerance
        limit = locate_limit_point(self.system, point.balance, point.value, reach, (coarse, *self._fine), thorough)
        if limit is None:
            return None
        self.effort.evaluations += limit.evaluations
        touched = interpenetration(self.system, limit.balance.state, self.increments.allowed)
        return None if touched.position.size else limit

    def from_limit(self, limit: LimitPoint, reach: float) -> list[Point]:
        """A limit point and the state behind its jump; nothing where the forces lead to no other state.

        Where the branch turns unstable and others leave it continuously, one of these goes on a smallest increment
        behind, in the direction of `reach`.
        """
        inc, value, patches = self.increments, limit.exact.value, limit.balance.state.patches
        outward, leads_on, evaluations = departure(self.system, limit, inc.tolerance, inc.closure)
        self.effort.evaluations += evaluations
        size = np.abs(outward) / patches.edge_room
        moving = np.unique(np.flatnonzero(size > MOVING * size.max()) % patches.count)
        growth = (outward / patches.edge_room).reshape(2, -1).sum(axis=0)
        leading = int(np.argmax(np.abs(growth) * np.where(growth < 0, 1 + TIED, 1.0)))  # of two alike, what shrinks
        place = ("bifurcation", float(patches.center[leading]))
        broken = limit.kind == "bifurcation"
        if not leads_on and not broken:
            return []
        settled = self._settled(limit.balance, patches.moved(outward), value, moving, fine=not leads_on)
        if not leads_on:
            leads_on = bool(settled.changes) or _departed(patches, settled, float(size.max()))
        if not leads_on:
            value += float(np.copysign(inc.smallest, reach))
            settled = self._settled(limit.balance, patches.moved(outward), value, moving)
        changes = (place, *settled.changes) if broken or not settled.changes else settled.changes
        if settled.balance is None and not settled.changes:
            return []
        behind = self.behind(limit.exact, limit.error, settled, changes, leads_on or bool(settled.changes))
        if behind is None and broken:
            events = path_events((place,), limit.exact, limit.error, 0.0, 0.0)
            return [self._with_tangent(Point("converged", value, settled.balance, events))]
        end = Point("converged", limit.exact.value, limit.balance, last=True, fold=None if broken else limit)
        return [] if behind is None else [end, behind]

    def unlocated(self, start: Point, value: float, found: GapMinima | None, fine: bool = False) -> Point:
        """The state at `value` behind an end of the branch that was not located, from the last good edges.

        What the accuracy between targets leaves undecided (a shallow minimum, or none) that of targets decides.
        A jump of the edges that releases no energy is none: Newton only did not reach that far.
        """
        assert start.balance is not None
        here, state = start.balance, start.balance.state
        unstable = unstable_patches(here) if found is None else None
        settled = self._settled(here, state.patches, value, unstable, found, fine)
        pushed = self._exact(here, start.value, value)
        moved = settled.balance
        if moved is not None and not settled.changes:
            ahead = self._with_tangent(Point(settled.status, value, moved))
            if not self.misses_energy(start, ahead):
                return ahead
        width, control, stiffness = abs(value - start.value), self.system.control, here.stiffness
        deeper = abs(width / (control.penetration_weight + control.load_weight * stiffness))
        error = Exact(width, deeper, deeper * abs(stiffness), deeper * abs(stiffness) * width)
        changes = settled.changes or (("bifurcation", float(state.patches.center[unstable_patches(here)[0]])),)
        behind = self.behind(pushed, error, settled, changes, bool(settled.changes))
        if behind is None:
            assert settled.balance is not None
            return self._with_tangent(Point(settled.status, value, settled.balance))
        return behind

    def misses_energy(self, start: Point, end: Point) -> bool:
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

    def behind(
        self,
        at: Exact,
        error: Exact,
        settled: Settled,
        changes: tuple[tuple[str, float], ...],
        moved: bool = True,
    ) -> Point | None:
        """The point behind a jump with its events; None where nothing changed and no energy is released.

        Parameters
        ----------
        at, error : Exact
            The state from which the contact jumps, and its errors.
        settled : Settled
            Where the jump ended.
        changes : tuple of (kind, position)
            What happened, in order.
        moved : bool
            Whether something surely did; else the energy released must exceed its error.
        """
        system, value = self.system, settled.target
        if settled.balance is None:
            released = np.nan
            if settled.status == "separated":
                changes = (*changes[:-1], ("pull_off", changes[-1][1]))
                if system.control.penetration_weight:  # a dead tension falls for ever
                    released = at.potential
            elif settled.status == "complete_contact":
                released = at.potential - complete_potential(system, self.complete, value)
            return Point(settled.status, value, None, path_events(changes, at, error, released, error.potential))
        found = at_rest(system, settled.balance, value, self._fine)
        self.effort.evaluations += 2
        here, after, uncertain = (settled.balance, self._exact(settled.balance, value, value), np.inf)
        if found is not None:
            here, after, uncertain = found[0], found[1], found[2].potential
        released = at.potential - self._led_back(here, after, at.value)
        works = system.control.penetration_weight > 0  # the load does work, or the penetration
        eased = abs(at.load - after.load) if works else abs(at.penetration - after.penetration)
        doubt = error.potential + uncertain + error.value * eased  # of a jump elsewhere
        if not moved and released <= DOUBT * doubt:
            return None
        return self._with_tangent(Point(settled.status, value, here, path_events(changes, at, error, released, doubt)))

    def _settled(
        self,
        here: Balance,
        patches: Patches,
        value: float,
        unstable: IntArray | None,
        found: GapMinima | None = None,
        fine: bool = False,
    ) -> Settled:
        """Where the forces lead; what the accuracy between targets leaves open that of targets decides."""
        inc, state = self.increments, here.state
        for tolerance, closure in ((inc.tolerance, inc.closure), (inc.fine_tolerance, inc.fine_closure))[int(fine) :]:
            settled = settle(
                self.system, patches, state.penetration, value, tolerance, closure, inc.allowed, unstable, found, state
            )
            self.effort.book(settled.evaluations, settled.local_evaluations)
            if settled.status != "not_converged":
                break
        return settled

    def _exact(self, here: Balance, start: float, value: float) -> Exact:
        """Numbers of a state after a change of the control at fixed edges."""
        control, change = self.system.control, value - start
        state = here.state
        deeper = change * control.rate(state)
        potential = here.potential + change * (control.force(state) + change / 2 * control.force_rate(state))
        return Exact(value, state.penetration + deeper, state.load + deeper * state.load_rate, potential)

    def _led_back(self, here: Balance, exact: Exact, value: float) -> float:
        """The potential that a state next to the value of a limit point has at that value."""
        control, change = self.system.control, value - exact.value
        return exact.potential + change * (control.force(here.state) + change / 2 * control.force_rate(here.state))

    def _finer(self, here: Balance, value: float) -> Balance:
        """The forces on the same edges at the accuracy of a target."""
        self.effort.evaluations += 1
        state = here.state
        return balance(self.system, state.patches, state.penetration, value, self.increments.fine_tolerance)

    def _with_tangent(self, point: Point) -> Point:
        assert point.balance is not None
        return replace(point, rate=tangent(self.system.control, point.balance))


def _departed(start: Patches, settled: Settled, pushed: float) -> bool:
    """Whether edges that were pushed from an equilibrium, in units of their room, did not fall back to it."""
    if settled.balance is None:
        return False
    moved = np.abs(edge_positions(settled.balance.state.patches) - edge_positions(start)) / start.edge_room
    return float(moved.max()) > 2 * pushed


def _interpolated(first: Point, last: Point, value: float) -> Patches:
    """Edges between two points of a branch, by the cubic that has their places and tangents."""
    assert first.balance is not None and last.balance is not None and first.rate is not None and last.rate is not None
    width = last.value - first.value
    here, there = first.balance.state.patches, last.balance.state.patches
    moved = np.concatenate([here.left - there.left, there.right - here.right])
    t = (value - first.value) / width
    curved = (1 - t) * (first.rate * width - moved) + t * (moved - last.rate * width)
    return here.moved(t * moved + t * (1 - t) * curved)
