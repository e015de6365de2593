"""Jumps of an adhesive path: where the contact goes when its branch has ended, and the energy that it releases.

A branch ends where it folds, where a symmetry breaks, or where a gap closes; all are located (fold.py, touch.py), so
that neither the jump nor its numbers depend on the steps.  The jump follows the forces at the value of the control at
which the branch ends (relaxation.py): from a fold pushed along its mode, where the force grows as the square of the
motion, from a broken symmetry along a branch that begins there, or on both sides of its mode.  The energy released
is the difference of the potential of two equilibria, each located with its error.  A jump that leaves all patches in
place is an event if it releases more than the error stated.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from bem.adhesive.branch import after_step, moving_patches, numbers_of, outward_motion, unstable_patches
from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.relaxation import LOCAL_RESIDUAL, NO_CAUSE, Cause, Relaxed, fall, interpenetration
from bem.adhesive.vanishing import TIED
from bem.elastic.collocation import Evaluation
from bem.elastic.gap import GapMinima
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import Patches
from bem.loading.complete_contact import CompleteContact
from bem.loading.increments import FINE, MAXIMUM_ITERATIONS, SAFETY, Increments
from bem.loading.path_events import EventNumbers, PathEvent, path_events
from bem.loading.points_without_edges import Complete, Failed, Separated
from bem.path.fold import LimitPoint
from bem.path.locating import OFF, AtControl, Located, Refused, Start, locate
from bem.path.opening import complete_potential
from bem.path.points_with_edges import Equilibrium, Point
from bem.path.stand import LONGEST_MOTION
from bem.path.touch import Touch

FORCES = 1e-2, 1e-4, 1e-6  # of the work of adhesion: forces that a push from a fold shall meet, tried in turn


@dataclass(frozen=True, eq=False)
class Landed(Relaxed):
    """End of a jump: `balance` where the descent ended, and the minimum there; None where none is located."""

    minimum: Located | None


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

    def from_touch(self, touch: Touch) -> Point:
        """Return the state behind the touch of a crest."""
        state, at = touch.at.balance.state, touch.at
        landed = self._landed(state, state.patches, at.numbers.value, touching=touch.touching)
        return self.behind(at.numbers, at.error, landed, landed.changes)

    def from_fold(self, limit: LimitPoint) -> Point | None:
        """Return the state behind a fold; None where edges pushed along its mode fall back to it."""
        at, mode = limit.at, limit.modes[:, 0]
        state, patches, work = at.balance.state, at.patches, at.balance.work
        length = np.sqrt(np.array(FORCES) * float(work @ np.abs(mode)) / limit.bend)
        longest = LONGEST_MOTION / float(np.max(np.abs(mode) / patches.edge_scale))
        for part in np.minimum(length, longest):
            landed = self._landed(state, patches.moved(part * mode), at.numbers.value, moving_patches(patches, mode))
            if self._returned(patches, landed, part * mode):
                continue
            changes = landed.changes or (("bifurcation", leading_patch(patches, mode)),)
            return self.behind(at.numbers, at.error, landed, changes, surely=bool(landed.changes))
        return None

    def from_broken_symmetry(self, at: Located, other: Patches) -> Point | None:
        """Return the state behind a broken symmetry; None where the contact falls back to where it was.

        Parameters
        ----------
        at : Located
            Point at which the symmetry breaks.
        other : Patches
            Edges of an unstable branch that begins there, from which forces lead on.
        """
        patches, state = at.patches, at.balance.state
        outward = outward_motion(patches, other)
        landed = self._landed(state, patches.moved(outward), at.numbers.value, moving_patches(patches, outward))
        if self._returned(patches, landed, outward):
            return None
        changes = (("bifurcation", leading_patch(patches, outward)), *landed.changes)
        return self.behind(at.numbers, at.error, landed, changes)

    def unlocated(self, balance: Balance, start: float, value: float) -> Point:
        """Return the state at `value` behind an end of the branch that was not located.

        The contact jumps from the last good edges before this end.
        """
        state, width = balance.state, abs(value - start)
        landed = self._landed(state, state.patches, value, unstable_patches(balance))
        control, stiffness = self.system.control, balance.stiffness
        deeper = abs(2 * width / (control.penetration_weight + control.load_weight * stiffness))
        error = EventNumbers(width, deeper, deeper * abs(stiffness), deeper * abs(stiffness) * width)
        changes = landed.changes or (("bifurcation", float(state.patches.center[unstable_patches(balance)[0]])),)
        at = after_step(self.system, balance, start, np.zeros(2 * state.patches.count), value - start)
        return self.behind(at, error, landed, changes, bool(landed.changes))

    def behind(
        self,
        at: EventNumbers,
        error: EventNumbers,
        landed: Landed,
        changes: tuple[tuple[str, float], ...],
        surely: bool = True,
    ) -> Point:
        """Return the point behind a jump with its events.

        Parameters
        ----------
        at, error : EventNumbers
            The state from which the contact jumps, and its errors.
        landed : Landed
            End of the jump.
        changes : tuple of (kind, position)
            Changes of the contact, in order.
        surely : bool
            True if something surely happened; else the energy released must exceed its error.
        """
        if landed.balance is None:
            return self._without_edges(at, error, landed, changes)
        value, balance, minimum = landed.target, landed.balance, landed.minimum
        if minimum is None:
            patches, after, uncertain = balance.state.patches, numbers_of(balance, value), np.inf
        else:
            balance, patches, after, uncertain = (
                minimum.balance,
                minimum.patches,
                minimum.numbers,
                minimum.error.potential,
            )
        released = at.potential - after.potential
        doubt = error.potential + uncertain + self._moved_by_error(at, error, after.penetration, after.load)
        happened = surely or not np.isfinite(doubt) or released > SAFETY * doubt
        tolerance = self.increments.way.tolerance
        coarse = (OFF * tolerance) ** 2 if tolerance > FINE.tolerance else 0.0  # energies err by the square
        stated = doubt + coarse * balance.state.elastic_energy
        events = path_events(changes, at, error, released, stated) if happened else ()
        if landed.status != "converged":
            return _failed(landed, events)
        return Equilibrium(value, balance, patches, after.load, events=events)

    def _minimum(self, balance: Balance, value: float) -> Located | None:
        """Return the stable equilibrium in which a jump ended, with its errors; None where there is none."""
        start = Start(balance.state.patches, balance.state.penetration, value)
        located = locate(self.system, start, AtControl(value), self.increments.way.tolerance, known=balance)
        if isinstance(located, Refused) or located.balance.factor is None:
            return None
        moved = outward_motion(balance.state.patches, located.patches) / balance.state.patches.edge_scale
        return located if np.max(np.abs(moved)) <= LONGEST_MOTION else None

    def _returned(self, start: Patches, landed: Landed, outward: FloatArray) -> bool:
        """Return whether edges that were pushed outward fell back to an equilibrium."""
        if landed.balance is None or landed.changes:
            return False
        moved = np.abs(outward_motion(start, landed.balance.state.patches)) / start.edge_scale
        return float(moved.max()) <= 2 * float(np.max(np.abs(outward) / start.edge_scale))

    def _without_edges(
        self, at: EventNumbers, error: EventNumbers, landed: Landed, changes: tuple[tuple[str, float], ...]
    ) -> Separated | Complete | Failed:
        """Return the point behind a jump that leaves no edges, or did not end."""
        released, doubt = np.nan, error.potential
        if landed.status == "separated":
            changes = (*changes[:-1], ("pull_off", changes[-1][1]))
            if self.system.control.penetration_weight:  # a dead tension falls for ever
                released = at.potential
                doubt += self._moved_by_error(at, error, at.penetration, 0.0)
        elif landed.status == "complete_contact":
            released = at.potential - complete_potential(self.system, self.complete, landed.target)
            highest = self.system.elastic.profile.max_height
            doubt += self._moved_by_error(at, error, highest, self.system.control.load(highest, landed.target))
        events = path_events(changes, at, error, released, doubt)
        if landed.status == "separated":
            return Separated(landed.target, events=events)
        if landed.status == "complete_contact":
            return Complete(landed.target, events=events)
        return _failed(landed, events)

    def _moved_by_error(self, at: EventNumbers, error: EventNumbers, penetration: float, load: float) -> float:
        """Return the change of the energy released if the control of the jump is off by its error.

        The jump leads to `penetration` and `load`.
        """
        works = self.system.control.penetration_weight > 0  # the load does work, or the penetration
        return error.value * (abs(at.load - load) if works else abs(at.penetration - penetration))

    def _landed(
        self,
        before: Evaluation,
        patches: Patches,
        value: float,
        unstable: IntArray | None = None,
        touching: GapMinima | None = None,
    ) -> Landed:
        """Follow the forces from edges to the end of a jump."""
        cause = Cause(unstable, touching, before, local_tolerance=self.increments.coarse.tolerance)
        return self.landed(patches, before.penetration, value, cause)

    def landed(self, patches: Patches, penetration: float, value: float, cause: Cause = NO_CAUSE) -> Landed:
        """Follow the forces from edges to the next equilibrium, and locate it.

        The descent ends where Newton goes on; where Newton leads elsewhere, or a gap closes on the way, it continues.
        """
        way, changes = self.increments.way, tuple[tuple[str, float], ...]()
        accuracy = replace(way, residual=max(way.residual, LOCAL_RESIDUAL))
        for _ in range(MAXIMUM_ITERATIONS):
            fallen = fall(self.system, patches, penetration, value, accuracy, cause)
            changes += fallen.changes
            balance = fallen.balance
            minimum = None if balance is None else self._minimum(balance, value)
            if balance is None or fallen.status != "converged":
                return Landed(fallen.status, value, balance, changes, minimum)
            state = balance.state if minimum is None else minimum.balance.state
            closed = interpenetration(self.system, state, way.allowed)
            if closed.position.size == 0 and (minimum is not None or accuracy == way):
                return Landed(fallen.status, value, balance, changes, minimum)
            patches, penetration = state.patches, state.penetration
            if closed.position.size == 0:
                cause, accuracy = NO_CAUSE, way
            else:
                cause = Cause(None, closed, state, local_tolerance=self.increments.coarse.tolerance)
        return Landed("not_converged", value, None, changes, None)


def _failed(landed: Landed, events: tuple[PathEvent, ...] = ()) -> Failed:
    """Return the failure of a jump that does not end in a state, with the events until then."""
    status: Literal["not_converged", "ill_conditioned"] = "not_converged"
    if landed.status == "ill_conditioned":
        status = "ill_conditioned"
    return Failed(landed.target, status, events=events)


def leading_patch(patches: Patches, outward: FloatArray) -> float:
    """Return the centre of the patch that grows or shrinks most in a motion; of two alike, of the one that shrinks."""
    growth = (outward / patches.edge_scale).reshape(2, -1).sum(axis=0)
    leading = int(np.argmax(np.abs(growth) * np.where(growth < 0, 1 + TIED, 1.0)))
    return float(patches.center[leading])
