"""Jumps of an adhesive path: where the contact goes when its branch has ended, and the energy that it releases.

A branch ends at a limit point or where a crest touches; both are located first (branch_ends.py, touch_points.py), so
that neither the jump nor its numbers depend on the increments.  The jump itself follows the forces at the value of the
control at which the branch ends (relaxation.py), and goes on by finer evaluations where only coarse ones find it at
rest; what it releases is the difference of the potential of two equilibria, each improved until another resolution
changes nothing.  Where no end is located within the smallest increment, the jump begins from the last good edges, and
the increment is its error.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bem.adhesive.branch import outward_motion, unstable_patches
from bem.adhesive.equilibrium import Balance, System, edge_positions
from bem.adhesive.relaxation import Cause, Relaxed, interpenetration, relax
from bem.continuation.branch_ends import BranchEnds, TouchedFold
from bem.continuation.departure import departure
from bem.continuation.limit_points import LimitPoint, sharper
from bem.continuation.opening import complete_potential
from bem.continuation.points_with_edges import BranchEnd, Equilibrium, Point, equilibrium
from bem.continuation.rest import at_rest
from bem.continuation.touch_points import Bracket, locate_touch
from bem.elastic.collocation import Evaluation
from bem.elastic.gap import GapMinima, gap_field
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import Patches
from bem.loading.complete_contact import CompleteContact
from bem.loading.increments import Increments
from bem.loading.path_events import EventNumbers, PathEvent, path_events
from bem.loading.path_point import Complete, Failed, Separated

DEEPER = 1e-8  # rms heights, by which a gap beside the one that touches is closed before
DOUBT = 3.0  # times its error: less energy is not released
SURE = 10.0  # times its error: more energy surely is, less is looked at more sharply
TIED = 1e-6  # relative difference of patches that move alike
MOVING = 0.3  # of the largest motion in units of the edge scale: patches that move with a mode


@dataclass(frozen=True, eq=False)
class Jumps:
    """Jumps from the ends of branches.

    Parameters
    ----------
    system : System
    increments : Increments
    complete : CompleteContact
    """

    system: System
    increments: Increments
    complete: CompleteContact

    @property
    def ends(self) -> BranchEnds:
        """What finds limit points, and tells one branch from another."""
        return BranchEnds(self.system, self.increments)

    def from_touch(self, point: Equilibrium, ahead: Equilibrium | TouchedFold, found: GapMinima) -> list[Point]:
        """The touch between two points of a branch and the state behind its jump; nothing where it is not located."""
        before = point.state
        behind = before.patches.right[found.gap]
        inside = (found.position > behind) & (found.position < behind + before.patches.gap_after[found.gap])
        if not np.all(inside):
            return []
        gaps = gap_field(self.system.elastic, before)(found.position, found.gap), found.depth
        width = abs(ahead.value - point.value)
        touch = locate_touch(
            self.system,
            lambda value: interpolated(point, ahead, value),
            before.penetration,
            Bracket((point.value, ahead.value), gaps, found, self.increments.smallest, isinstance(ahead, TouchedFold)),
            self.ends.fine,
        )
        if touch is None:
            return []
        end = equilibrium(self.system, touch.exact.value, touch.balance, last=True)
        if isinstance(ahead, TouchedFold) and self.ends.surely_misses_energy(point, end):
            return []  # the fold was of another branch
        state = touch.balance.state
        deeper = interpenetration(self.system, state, DEEPER - min(touch.left, 0.0))
        if deeper.position.size:  # another minimum of the gap closed before, which at `ahead` there was none of
            return self.from_touch(point, end, deeper) if abs(end.value - point.value) < width else []
        relaxed = self._relaxed(state, state.patches, touch.exact.value, found=touch.touching)
        after = self.behind(touch.exact, touch.error, relaxed, relaxed.changes)
        return [] if after is None else [end, after]

    def from_limit(self, limit: LimitPoint, goal: float) -> list[Point]:
        """A limit point and the state behind its jump; nothing where the forces lead to no other state.

        ===============  ======================================  ===================================================
        limit point      edges pushed along its mode             what follows
        ===============  ======================================  ===================================================
        fold             feel no force that leads on             nothing: the branch does not end there
        fold             feel one                                a jump at the same value of the control; nothing where
                                                                 patches stay and it releases less than its doubt
        broken symmetry  feel one, or do not fall back           the event that the symmetry breaks, and such a jump
        broken symmetry  fall back: another branch begins here   that event, and the other branch, taken up as close as
                                                                 it was found, at the goal if that is nearer; a smallest
                                                                 increment behind where it was not found; from there
                                                                 forces may still lead to a jump
        ===============  ======================================  ===================================================

        Parameters
        ----------
        limit : LimitPoint
        goal : float
            Where the path ends, behind the limit point.
        """
        way = departure(self.system, limit, self.increments.coarse, self.increments.fine)
        if limit.kind == "fold" and not way.leads_on:
            return []
        state, value, outward = limit.balance.state, limit.exact.value, way.outward
        pushed, moving = state.patches.moved(outward), _moving(state.patches, outward)
        place = ("bifurcation", _leading(state.patches, outward))
        left, behind, other = abs(goal - value), self.increments.smallest, way.other
        if other is None:
            relaxed = self._relaxed(state, pushed, value, moving, fine=way.fine or not way.leads_on)
            if way.leads_on or relaxed.changes or _departed(state.patches, relaxed, outward):
                breaks = limit.kind == "broken_symmetry"
                changes = (place, *relaxed.changes) if breaks or not relaxed.changes else relaxed.changes
                return self._jumped(limit, relaxed, changes, moved=breaks or bool(relaxed.changes))
        else:
            behind = abs(other.value - value)
            part = np.sqrt(left / behind) if left < behind else 1.0  # the control grows as the length squared
            pushed = state.patches.moved(part * outward_motion(state.patches, other.here.state.patches))
        value = goal if left <= behind else value + float(np.copysign(behind, goal - value))
        relaxed = self._relaxed(state, pushed, value, moving, fine=other is not None)
        points = self._jumped(limit, relaxed, (place, *relaxed.changes), moved=bool(relaxed.changes))
        if points or relaxed.balance is None:
            return points
        return [
            equilibrium(self.system, value, relaxed.balance, path_events((place,), limit.exact, limit.error, 0.0, 0.0))
        ]

    def _jumped(
        self, limit: LimitPoint, relaxed: Relaxed, changes: tuple[tuple[str, float], ...], moved: bool
    ) -> list[Point]:
        """A limit point and the point behind the jump from it; nothing where none was found, or nothing happened."""
        if relaxed.balance is None and not relaxed.changes:
            return []
        behind = self.behind(limit.exact, limit.error, relaxed, changes, moved)
        first = behind.events[0] if behind is not None and behind.events else None
        sure = first is not None and first.energy_released > SURE * first.energy_error
        if limit.kind == "fold" and not (moved or sure):  # its doubt may be more than its error
            finer = if_solvable(sharper, self.system, limit, self.increments.fine.tolerance) or limit
            found = if_solvable(self.behind, finer.exact, finer.error, relaxed, changes, moved, sharply=True)
            limit, behind = (limit, behind) if found is None else (finer, found)
        return [] if behind is None else [BranchEnd(limit.exact.value, limit), behind]

    def unlocated(
        self, start: Equilibrium, value: float, found: GapMinima | None, width: float, fine: bool = False
    ) -> Point:
        """The state at `value` behind an end of the branch that was not located, from the last good edges.

        The end lies within `width`, over which the numbers of a branch change by up to twice what its tangent says:
        before a fold as the root of the distance.
        What the accuracy between targets leaves undecided (a shallow minimum, or none) that of targets decides.
        Edges that leap without a release of energy have not jumped: Newton only did not reach that far.
        """
        here, state = start.balance, start.state
        unstable = unstable_patches(here) if found is None else None
        relaxed = self._relaxed(state, state.patches, value, unstable, found, fine)
        pushed = self._at_fixed_edges(here, start.value, value)
        if relaxed.balance is not None and not relaxed.changes:
            ahead = equilibrium(self.system, value, relaxed.balance)
            if not self.ends.surely_misses_energy(start, ahead):
                return self._resting(relaxed)
        control, stiffness = self.system.control, here.stiffness
        deeper = abs(2 * width / (control.penetration_weight + control.load_weight * stiffness))
        error = EventNumbers(width, deeper, deeper * abs(stiffness), deeper * abs(stiffness) * width)
        changes = relaxed.changes or (("bifurcation", float(state.patches.center[unstable_patches(here)[0]])),)
        return self.behind(pushed, error, relaxed, changes, bool(relaxed.changes)) or self._resting(relaxed)

    def behind(
        self,
        at: EventNumbers,
        error: EventNumbers,
        relaxed: Relaxed,
        changes: tuple[tuple[str, float], ...],
        moved: bool = True,
        sharply: bool = False,
    ) -> Point | None:
        """The point behind a jump with its events; None where nothing changed and no energy is released.

        Where only coarse evaluations find it at rest, the jump goes on from there by finer ones.

        Parameters
        ----------
        at, error : EventNumbers
            The state from which the contact jumps, and its errors.
        relaxed : Relaxed
            Where the jump ended.
        changes : tuple of (kind, position)
            What happened, in order.
        moved : bool
            Whether something surely did; else the energy released must exceed its error.
        sharply : bool
            Whether that error is of two of the finest evaluations, and must be known.
        """
        if relaxed.balance is None:
            return self._without_edges(at, error, relaxed, changes)
        value, here, found = relaxed.target, relaxed.balance, self._at_rest(relaxed.balance, relaxed.target, sharply)
        if found is None and relaxed.status == "converged":
            finer = self._relaxed(here.state, here.state.patches, value, fine=True)
            if finer.status in ("converged", "separated", "complete_contact"):
                changes = (*changes, *finer.changes) if moved or not finer.changes else finer.changes
                relaxed, moved = finer, moved or bool(finer.changes)
            if relaxed.balance is None:
                return self._without_edges(at, error, relaxed, changes)
            here, found = relaxed.balance, self._at_rest(relaxed.balance, value, sharply)
        after, uncertain = self._at_fixed_edges(here, value, value), np.inf
        if found is not None:
            here, after, uncertain = found[0], found[1], found[2].potential
        released = at.potential - self._led_to(here.state, after.potential, at.value - after.value)
        doubt = error.potential + uncertain + self._elsewhere(at, error, after.penetration, after.load)
        if not moved and (sharply or np.isfinite(doubt)) and not released > DOUBT * doubt:
            return None
        events = path_events(changes, at, error, released, doubt)
        return (
            equilibrium(self.system, value, here, events) if relaxed.status == "converged" else _failed(relaxed, events)
        )

    def _at_rest(self, here: Balance, value: float, sharply: bool) -> tuple[Balance, EventNumbers, EventNumbers] | None:
        """The equilibrium behind a jump, improved, if finer evaluations find it."""
        fine, finest = self.ends.fine
        energies = finest if self.system.elastic.kernel else fine  # their error falls with the square of the tolerance
        return at_rest(self.system, here, value, (finest, finest) if sharply else (fine, energies))

    def _without_edges(
        self, at: EventNumbers, error: EventNumbers, relaxed: Relaxed, changes: tuple[tuple[str, float], ...]
    ) -> Separated | Complete | Failed:
        """The point behind a jump that leaves no edges, or did not end."""
        released, doubt = np.nan, error.potential
        if relaxed.status == "separated":
            changes = (*changes[:-1], ("pull_off", changes[-1][1]))
            if self.system.control.penetration_weight:  # a dead tension falls for ever
                released = at.potential
                doubt += self._elsewhere(at, error, at.penetration, 0.0)
        elif relaxed.status == "complete_contact":
            released = at.potential - complete_potential(self.system, self.complete, relaxed.target)
            highest = self.system.elastic.profile.max_height
            doubt += self._elsewhere(at, error, highest, self.system.control.load(highest, relaxed.target))
        events = path_events(changes, at, error, released, doubt)
        if relaxed.status == "separated":
            return Separated(relaxed.target, events=events)
        if relaxed.status == "complete_contact":
            return Complete(relaxed.target, events=events)
        return _failed(relaxed, events)

    def _elsewhere(self, at: EventNumbers, error: EventNumbers, penetration: float, load: float) -> float:
        """Change of the energy released where the jump to this penetration and load lies elsewhere within its error."""
        works = self.system.control.penetration_weight > 0  # the load does work, or the penetration
        return error.value * (abs(at.load - load) if works else abs(at.penetration - penetration))

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
            if relaxed.status != "not_converged":
                break
        return relaxed

    def _resting(self, relaxed: Relaxed) -> Equilibrium | Failed:
        """The state that forces led to, as a point of the branch that went there."""
        if relaxed.balance is None or relaxed.status != "converged":
            return _failed(relaxed)
        return equilibrium(self.system, relaxed.target, relaxed.balance)

    def _at_fixed_edges(self, here: Balance, start: float, value: float) -> EventNumbers:
        """Numbers of a state after a change of the control at fixed edges."""
        control, change = self.system.control, value - start
        state = here.state
        deeper = change * control.rate(state)
        potential = self._led_to(state, here.potential, change)
        return EventNumbers(value, state.penetration + deeper, state.load + deeper * state.load_rate, potential)

    def _led_to(self, state: Evaluation, potential: float, change: float) -> float:
        """The potential of a state after a change of the control at fixed edges."""
        control = self.system.control
        return potential + change * (control.force(state) + change / 2 * control.force_rate(state))


def _failed(relaxed: Relaxed, events: tuple[PathEvent, ...] = ()) -> Failed:
    """An event that does not end in a state, with what happened until then."""
    status: Literal["not_converged", "ill_conditioned"] = "not_converged"
    if relaxed.status == "ill_conditioned":
        status = "ill_conditioned"
    return Failed(relaxed.target, status, events=events)


def _moving(patches: Patches, outward: FloatArray) -> IntArray:
    """Patches that move with a motion of the edges."""
    size = np.abs(outward) / patches.edge_scale
    return np.unique(np.flatnonzero(size > MOVING * size.max()) % patches.count)


def _leading(patches: Patches, outward: FloatArray) -> float:
    """Centre of the patch that grows or shrinks most in a motion of the edges; of two alike, that which shrinks."""
    growth = (outward / patches.edge_scale).reshape(2, -1).sum(axis=0)
    leading = int(np.argmax(np.abs(growth) * np.where(growth < 0, 1 + TIED, 1.0)))
    return float(patches.center[leading])


def _departed(start: Patches, relaxed: Relaxed, outward: FloatArray) -> bool:
    """Whether edges that were pushed outward from an equilibrium did not fall back to it."""
    if relaxed.balance is None:
        return False
    moved = np.abs(edge_positions(relaxed.balance.state.patches) - edge_positions(start)) / start.edge_scale
    return float(moved.max()) > 2 * float(np.max(np.abs(outward) / start.edge_scale))


def interpolated(first: Equilibrium, last: Equilibrium | TouchedFold, value: float) -> Patches:
    """Edges between two points of a branch, by the cubic that has their places and tangents.

    Towards a fold the edges are quadratic in the root of the distance from it.
    """
    width = last.value - first.value
    here, there = first.state.patches, last.state.patches
    moved = np.concatenate([here.left - there.left, there.right - here.right])
    t = (value - first.value) / width
    if isinstance(last, TouchedFold):
        root = float(np.sqrt(np.clip(1 - t, 0.0, 1.0)))
        return here.moved((1 - root) * ((1 - root) * moved + 2 * root * width * first.rate))
    curved = (1 - t) * (first.rate * width - moved) + t * (moved - last.rate * width)
    return here.moved(t * moved + t * (1 - t) * curved)
