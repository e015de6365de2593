"""Jumps of an adhesive path: where a branch ends, where the contact jumps from there, and the energy that it releases.

A branch ends at a limit point or where a crest touches; both are located first (limit_points.py, touch_points.py), so
that neither the jump nor its numbers depend on the increments.  The jump itself follows the forces at the value of the
control at which the branch ends (events.py); what it releases is the difference of the potential of two equilibria,
each improved until another resolution changes nothing.  Where no end is located within the smallest increment, the
jump begins from the last good edges, and the increment is its error.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bem.adhesive.branch import misses_energy, tangent, unstable_patches
from bem.adhesive.equilibrium import Balance, System, balance, edge_positions
from bem.adhesive.events import Cause, Relaxed, interpenetration, relax
from bem.continuation.departure import departure
from bem.continuation.limit_points import LimitPoint, at_rest, locate_limit_point
from bem.continuation.opening import complete_potential
from bem.continuation.path_point import BranchEnd, Equilibrium, Point
from bem.continuation.touch_points import Bracket, locate_touch
from bem.elastic.collocation import Evaluation
from bem.elastic.gap import GapMinima, gap_field
from bem.geometry.patches import Patches
from bem.loading.complete_contact import CompleteContact
from bem.loading.increments import Effort, Increments
from bem.loading.path_events import Exact, PathEvent, path_events
from bem.loading.path_point import Complete, Failed, Separated

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

FINE = 1e-5  # tolerance of the first of the two evaluations that give an event its numbers
DOUBT = 3.0  # times its error: less energy is not released
TIED = 1e-6  # relative difference of patches that move alike
MOVING = 0.3  # of the largest motion in units of the edge scale: patches that move with a mode


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
        finest = self.increments.fine.tolerance
        return max(min(FINE, self.increments.coarse.tolerance), finest), finest

    def from_touch(self, point: Equilibrium, ahead: Equilibrium, found: GapMinima) -> list[Point]:
        """The touch between two points of a branch and the state behind its jump; nothing where it is not located."""
        before = point.state
        behind = before.patches.right[found.gap]
        inside = (found.position > behind) & (found.position < behind + before.patches.gap_after[found.gap])
        if not np.all(inside):
            return []
        gaps = gap_field(self.system.elastic, before)(found.position, found.gap), found.depth
        touch = locate_touch(
            self.system,
            lambda value: _interpolated(point, ahead, value),
            before.penetration,
            Bracket((point.value, ahead.value), gaps, found),
            self._fine,
        )
        if touch is None:
            return []
        self.effort.evaluations += touch.evaluations
        end = self._equilibrium(touch.exact.value, touch.balance, last=True)
        state = touch.balance.state
        relaxed = self._relaxed(state, state.patches, touch.exact.value, found=touch.touching)
        after = self.behind(touch.exact, touch.error, relaxed, relaxed.changes)
        return [] if after is None else [end, after]

    def limit_point(self, point: Equilibrium, reach: float, thorough: bool) -> LimitPoint | None:
        """The limit point that ends the branch of a point within about `reach` of the control, if there is one."""
        coarse = self.increments.coarse.tolerance
        limit = locate_limit_point(self.system, point.balance, point.value, reach, (coarse, *self._fine), thorough)
        if limit is None:
            return None
        self.effort.evaluations += limit.evaluations
        touched = interpenetration(self.system, limit.balance.state, self.increments.fine.allowed)
        return None if touched.position.size else limit

    def from_limit(self, limit: LimitPoint, reach: float) -> list[Point]:
        """A limit point and the state behind its jump; nothing where the forces lead to no other state.

        Where the branch turns unstable and others leave it continuously, one of these continues a smallest increment
        behind, in the direction of `reach`.
        """
        inc, value, patches = self.increments, limit.exact.value, limit.balance.state.patches
        outward, leads_on, evaluations = departure(self.system, limit, inc.coarse)
        self.effort.evaluations += evaluations
        size = np.abs(outward) / patches.edge_scale
        moving = np.unique(np.flatnonzero(size > MOVING * size.max()) % patches.count)
        growth = (outward / patches.edge_scale).reshape(2, -1).sum(axis=0)
        leading = int(np.argmax(np.abs(growth) * np.where(growth < 0, 1 + TIED, 1.0)))  # of two alike, what shrinks
        place = ("bifurcation", float(patches.center[leading]))
        broken = limit.kind == "bifurcation"
        if not leads_on and not broken:
            return []
        state, away = limit.balance.state, patches.moved(outward)
        relaxed = self._relaxed(state, away, value, moving, fine=not leads_on)
        if not leads_on:
            leads_on = bool(relaxed.changes) or _departed(patches, relaxed, float(size.max()))
        if not leads_on:
            value += float(np.copysign(inc.smallest, reach))
            relaxed = self._relaxed(state, away, value, moving)
        changes = (place, *relaxed.changes) if broken or not relaxed.changes else relaxed.changes
        if relaxed.balance is None and not relaxed.changes:
            return []
        behind = self.behind(limit.exact, limit.error, relaxed, changes, leads_on or bool(relaxed.changes))
        if behind is not None:
            return [BranchEnd(limit.exact.value, limit), behind]
        if not broken or relaxed.balance is None:
            return []
        return [self._equilibrium(value, relaxed.balance, path_events((place,), limit.exact, limit.error, 0.0, 0.0))]

    def unlocated(self, start: Equilibrium, value: float, found: GapMinima | None, fine: bool = False) -> Point:
        """The state at `value` behind an end of the branch that was not located, from the last good edges.

        What the accuracy between targets leaves undecided (a shallow minimum, or none) that of targets decides.
        Edges that leap without a release of energy have not jumped: Newton only did not reach that far.
        """
        here, state = start.balance, start.state
        unstable = unstable_patches(here) if found is None else None
        relaxed = self._relaxed(state, state.patches, value, unstable, found, fine)
        pushed = self._exact(here, start.value, value)
        if relaxed.balance is not None and not relaxed.changes:
            ahead = self._equilibrium(value, relaxed.balance)
            if not self.misses_energy(start, ahead):
                return self._resting(relaxed)
        width, control, stiffness = abs(value - start.value), self.system.control, here.stiffness
        deeper = abs(width / (control.penetration_weight + control.load_weight * stiffness))
        error = Exact(width, deeper, deeper * abs(stiffness), deeper * abs(stiffness) * width)
        changes = relaxed.changes or (("bifurcation", float(state.patches.center[unstable_patches(here)[0]])),)
        return self.behind(pushed, error, relaxed, changes, bool(relaxed.changes)) or self._resting(relaxed)

    def misses_energy(self, start: Equilibrium, end: Equilibrium) -> bool:
        """Whether more energy went missing between two points than the forces along one branch account for.

        Newton can step over a short unstable stretch of the path.  What the coarse evaluations suspect, the accuracy
        of targets decides: coarse energies and tangents may be no better than what adhesion adds to them.
        """
        inc, system, change, rates = self.increments, self.system, end.value - start.value, (start.rate, end.rate)
        if not misses_energy(system, (start.balance, end.balance), rates, change, inc.coarse.tolerance):
            return False
        ends = self._finer(start.balance, start.value), self._finer(end.balance, end.value)
        return misses_energy(system, ends, rates, change, inc.fine.tolerance)

    def behind(
        self,
        at: Exact,
        error: Exact,
        relaxed: Relaxed,
        changes: tuple[tuple[str, float], ...],
        moved: bool = True,
    ) -> Point | None:
        """The point behind a jump with its events; None where nothing changed and no energy is released.

        Parameters
        ----------
        at, error : Exact
            The state from which the contact jumps, and its errors.
        relaxed : Relaxed
            Where the jump ended.
        changes : tuple of (kind, position)
            What happened, in order.
        moved : bool
            Whether something surely did; else the energy released must exceed its error.
        """
        if relaxed.balance is None:
            return self._without_edges(at, error, relaxed, changes)
        system, value = self.system, relaxed.target
        found = at_rest(system, relaxed.balance, value, self._fine)
        self.effort.evaluations += 2
        here, after, uncertain = (relaxed.balance, self._exact(relaxed.balance, value, value), np.inf)
        if found is not None:
            here, after, uncertain = found[0], found[1], found[2].potential
        released = at.potential - self._led_to(here.state, after.potential, at.value - after.value)
        works = system.control.penetration_weight > 0  # the load does work, or the penetration
        eased = abs(at.load - after.load) if works else abs(at.penetration - after.penetration)
        doubt = error.potential + uncertain + error.value * eased  # of a jump elsewhere
        if not moved and released <= DOUBT * doubt:
            return None
        events = path_events(changes, at, error, released, doubt)
        return self._equilibrium(value, here, events) if relaxed.status == "converged" else _failed(relaxed, events)

    def _without_edges(
        self, at: Exact, error: Exact, relaxed: Relaxed, changes: tuple[tuple[str, float], ...]
    ) -> Separated | Complete | Failed:
        """The point behind a jump that leaves no edges, or did not end."""
        released = np.nan
        if relaxed.status == "separated":
            changes = (*changes[:-1], ("pull_off", changes[-1][1]))
            if self.system.control.penetration_weight:  # a dead tension falls for ever
                released = at.potential
        elif relaxed.status == "complete_contact":
            released = at.potential - complete_potential(self.system, self.complete, relaxed.target)
        events = path_events(changes, at, error, released, error.potential)
        if relaxed.status == "separated":
            return Separated(relaxed.target, events=events)
        if relaxed.status == "complete_contact":
            return Complete(relaxed.target, events=events)
        return _failed(relaxed, events)

    def _relaxed(
        self,
        before: Evaluation,
        patches: Patches,
        value: float,
        unstable: IntArray | None = None,
        found: GapMinima | None = None,
        fine: bool = False,
    ) -> Relaxed:
        """Where the forces lead; what the accuracy between targets leaves open that of targets decides."""
        cause = Cause(unstable, found, before)
        for accuracy in (self.increments.coarse, self.increments.fine)[int(fine) :]:
            relaxed = relax(self.system, patches, before.penetration, value, accuracy, cause)
            self.effort.book(relaxed.evaluations, relaxed.local_evaluations)
            if relaxed.status != "not_converged":
                break
        return relaxed

    def _resting(self, relaxed: Relaxed) -> Equilibrium | Failed:
        """The state that forces led to, as a point of the branch that went there."""
        if relaxed.balance is None or relaxed.status != "converged":
            return _failed(relaxed)
        return self._equilibrium(relaxed.target, relaxed.balance)

    def _equilibrium(
        self, value: float, here: Balance, events: tuple[PathEvent, ...] = (), last: bool = False
    ) -> Equilibrium:
        """A point with its tangent."""
        return Equilibrium(value, here, tangent(self.system.control, here), events=events, last=last)

    def _exact(self, here: Balance, start: float, value: float) -> Exact:
        """Numbers of a state after a change of the control at fixed edges."""
        control, change = self.system.control, value - start
        state = here.state
        deeper = change * control.rate(state)
        potential = self._led_to(state, here.potential, change)
        return Exact(value, state.penetration + deeper, state.load + deeper * state.load_rate, potential)

    def _led_to(self, state: Evaluation, potential: float, change: float) -> float:
        """The potential of a state after a change of the control at fixed edges."""
        control = self.system.control
        return potential + change * (control.force(state) + change / 2 * control.force_rate(state))

    def _finer(self, here: Balance, value: float) -> Balance:
        """The forces on the same edges at the accuracy of a target."""
        self.effort.evaluations += 1
        state = here.state
        return balance(self.system, state.patches, state.penetration, value, self.increments.fine.tolerance)


def _failed(relaxed: Relaxed, events: tuple[PathEvent, ...] = ()) -> Failed:
    """An event that does not end in a state, with what happened until then."""
    status: Literal["not_converged", "ill_conditioned"] = "not_converged"
    if relaxed.status == "ill_conditioned":
        status = "ill_conditioned"
    return Failed(relaxed.target, status, events=events)


def _departed(start: Patches, relaxed: Relaxed, pushed: float) -> bool:
    """Whether edges that were pushed from an equilibrium, in units of their edge scale, did not fall back to it."""
    if relaxed.balance is None:
        return False
    moved = np.abs(edge_positions(relaxed.balance.state.patches) - edge_positions(start)) / start.edge_scale
    return float(moved.max()) > 2 * pushed


def _interpolated(first: Equilibrium, last: Equilibrium, value: float) -> Patches:
    """Edges between two points of a branch, by the cubic that has their places and tangents."""
    width = last.value - first.value
    here, there = first.state.patches, last.state.patches
    moved = np.concatenate([here.left - there.left, there.right - here.right])
    t = (value - first.value) / width
    curved = (1 - t) * (first.rate * width - moved) + t * (moved - last.rate * width)
    return here.moved(t * moved + t * (1 - t) * curved)
