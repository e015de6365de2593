"""The quasi-static path of an adhesive contact: increments, events, and the states asked for.

Between events the equilibrium edges are a smooth function of the control value tau (penetration, load or total
displacement) and are followed by a second-order predictor and Newton.  An increment is accepted only when Newton
stays on its branch (K > 0, positive definite Hessian, small steps along both tangents, no energy missing) and no gap
interpenetrates.  Otherwise the end of the branch in between is located by its own equation: the touch of a crest, or a
limit point (touch_points.py, branch_ends.py), from which the contact jumps (jumps.py).  The path yields both the last
state of a branch and the first one behind the jump.  That neither depends on the increments is a property that tests
show; where no end is located, increments shrink until the jump begins from the last good edges.

A point carries what the path needs to go on from it, the next increment among it; a path holds no state of its own;
its system counts the work.  What `advance` knows besides, a value of the control that Newton did not reach and what it
asked about the next fold, it forgets at its goal.  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

import numpy as np

from bem.adhesive.branch import tangent
from bem.adhesive.equilibrium import LARGEST_NEWTON_STEP, System, correct
from bem.adhesive.equilibrium_assessment import assess_equilibrium
from bem.adhesive.relaxation import interpenetration
from bem.continuation import crossing
from bem.continuation.bare_states import BareStates
from bem.continuation.branch_ends import HALFWAY, TouchedFold
from bem.continuation.jumps import Jumps
from bem.continuation.limit_points import before_fold
from bem.continuation.opening import Flaw
from bem.continuation.points_with_edges import Equilibrium, Point, WithEdges
from bem.elastic.gap import GapMinima, gap_field
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.assessment import Assessment
from bem.loading.complete_contact import CompleteContact
from bem.loading.increments import Effort, Increments
from bem.loading.path_point import Complete, Failed, Separated

PART = 0.0625  # of the shortest wave that may pin an edge: how far it moves in an increment, as its tangent says
BRACKET = 64  # parts of the smallest increment in which an end of a branch is bracketed that is not located
FRACTIONS = 64  # of an increment: the way halfway to a fold, so that the same states are met on every processor
NEARBY = 8  # parts of the smallest increment: events nearer to a point are looked for from there
MOST_JUMPS = 100  # in a row, none of which leads nearer to the goal: the path does not lead on
SAME_VALUE = 1e-9  # of the largest increment
CLOSED = 1e-9  # separation, in rms heights, at which the gaps that are left close together


@dataclass(frozen=True)
class Pace:
    """How the path continues.

    Attributes
    ----------
    increment : float
        The next one.
    blocked : float or None
        A value of the control that Newton did not reach.
    fold : {"unasked", "ahead", "near", "asked"}
        What is known of the next fold: nothing; the increment leads halfway to where it is foretold; it has done so,
        and the fold is looked for at once; it was asked for from this point.
    """

    increment: float
    blocked: float | None = None
    fold: Literal["unasked", "ahead", "near", "asked"] = "unasked"


@dataclass(frozen=True)
class Trial:
    """An increment to try: its size and end, the shortest worth trying, and how far the path goes before it closes."""

    step: float
    value: float
    shortest: float
    end: float


@dataclass(frozen=True, eq=False)
class Attempt:
    """What Newton found: the point ahead (None: it left the branch), and where that interpenetrates.

    `too_long` says that a jump may hide in the increment.
    """

    ahead: Equilibrium | None = None
    found: GapMinima | None = None
    too_long: bool = False


@dataclass(frozen=True, eq=False)
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
    has_history: ClassVar[bool] = True

    @property
    def effort(self) -> Effort:
        """Counts of the work done."""
        return self.system.effort

    @property
    def jumps(self) -> Jumps:
        """What jumps from the ends of branches, and finds these."""
        return Jumps(self.system, self.increments, self.complete)

    @property
    def bare(self) -> BareStates:
        """What leads to and from states without edges."""
        return BareStates(self.jumps, self.crests, self.flaw)

    def with_increments(self, increments: Increments) -> Path:
        """The same path in other increments."""
        return replace(self, increments=increments)

    def direction(self, point: Point, goal: float, separation: float | None = None) -> float:
        """Sign of the motion of the control from a point to a goal; `separation` is the goal again, not needed here."""
        return float(np.sign(goal - point.value))

    def advance(self, point: Point, goal: float, separation: float | None = None) -> Iterator[Point]:
        """Yield every accepted point from `point` to the goal; the last one is at the goal or has failed.

        1. Without edges: to first touch, to where complete contact opens, or to the goal.
        2. Choose an increment; where none is left before the gaps close, contact is complete.
        3. Try it: Newton from the edges that the branch predicts.  Where the point already foretells a fold on the way,
           try half the way to that fold first.
        4. Accepted: the next increment is up to twice as long.
        5. Too long for energies to tell whether a jump lies within: half of it comes first.
        6. Refused: jump from the end of the branch in between, or try a shorter increment, where a fold is foretold
           halfway to it first.  Jumps for ever that do not lead nearer to the goal are a failure.
        """
        pace, jumps, left = self._pace(point), 0, abs(goal - point.value)
        while point.value != goal:
            direction = self.direction(point, goal)
            if not isinstance(point, Equilibrium):
                start, point = point, self.bare.advance(point, goal)
                yield point
                joined = isinstance(start, Separated) and isinstance(point, Complete)
                if not isinstance(point, Equilibrium) and not joined:
                    return
                continue
            trial = self._trial(point, goal, direction, pace)
            if trial is None:
                yield self.bare.closed(point, goal)
                return
            if pace.fold == "unasked" and point.state.slope_compliance.size:
                half = self._halfway(point, trial)
                if half is not None:
                    pace = Pace(half, trial.value, "ahead")
                    continue
                pace = replace(pace, fold="asked")
            attempt = Attempt() if pace.fold == "near" else self._attempt(point, trial.value, pace.fold == "ahead")
            if attempt.too_long and trial.step >= 2 * self.increments.smallest:
                self.effort.rejected += 1
                pace = Pace(trial.step / 2, pace.blocked, "asked" if pace.fold == "asked" else "unasked")
                continue
            if attempt.ahead is not None and attempt.found is None:
                self.effort.accepted += 1
                longer = min(2 * trial.step, self._largest(attempt.ahead))
                pace = Pace(longer, fold="near") if pace.fold == "ahead" else Pace(longer, pace.blocked)
                point = replace(attempt.ahead, increment=pace.increment)
                yield point
                continue
            self.effort.rejected += int(pace.fold != "near")
            points, pace = self._past_refusal(point, attempt, trial, pace)
            if not points:
                continue
            pace = Pace(max(trial.step, self.increments.largest / 8))
            point = _with_increment(points[-1], pace.increment)
            yield from (*points[:-1], point)
            if isinstance(point, Failed):
                return
            leads_on = abs(goal - point.value) < left - SAME_VALUE * self.increments.largest
            jumps, left = (0, abs(goal - point.value)) if leads_on else (jumps + 1, left)
            if jumps == MOST_JUMPS:
                yield Failed(point.value, "jumps_again")
                return

    def refine(self, point: Point, direction: float) -> Point:
        """The point at the accuracy of a target.

        Where the fine state interpenetrates, or there is none, the branch ended within the coarse accuracy: at a touch,
        or at a limit point.  The path then jumps from there, returns to the value, and refines what it finds.

        Parameters
        ----------
        point : Point
        direction : float
            Sign of the motion of the control that led here.
        """
        if not isinstance(point, Equilibrium):
            return replace(point, events=())
        inc, state, value = self.increments, point.state, point.value
        fine = correct(self.system, state.patches, state.penetration, value, inc.fine)
        found = None
        if fine.balance is not None:
            refined = replace(point, balance=fine.balance, events=(), last=False)
            found = interpenetration(self.system, fine.balance.state, inc.fine.allowed)
            if found.position.size == 0:
                return refined
            before = self.refined_at(refined, value - direction * inc.smallest / NEARBY)
            points = [] if before is None else self.jumps.from_touch(before, refined, found)
        else:
            points = self._past_event(point, Attempt(), (value + direction * inc.smallest / NEARBY, value), True)
        if not points:
            behind = self.jumps.unlocated(point, value, found, inc.smallest / NEARBY, fine=True)
            there = behind.state
            rest = None if there is None else self.corrected(there.patches, there.penetration, value)
            return _with_increment(replace(rest, events=behind.events) if rest else behind, point.increment)
        points = [*points[:-1], _with_increment(points[-1], point.increment)]
        if points[-1].value != value and points[-1].state is not None:
            points += self.advance(points[-1], value)
        events = [event for passed in points for event in passed.events]
        final = self.refine(points[-1], direction)
        return replace(final, events=(*events, *final.events))

    def restart(self, patches: Patches, penetration: float, value: float, separation: float | None = None) -> Point:
        """The point at given equilibrium edges, from which the path continues as if it began there."""
        return self.corrected(patches, penetration, value) or Failed(value, "not_converged")

    def corrected(self, patches: Patches, penetration: float, value: float) -> Equilibrium | None:
        """The equilibrium near given edges at the accuracy of a target, if Newton finds one."""
        if not patches.is_ordered:
            return None
        fine = correct(self.system, patches, penetration, value, self.increments.fine)
        if fine.balance is None:
            return None
        return Equilibrium(value, fine.balance, tangent(self.system.control, fine.balance))

    def refined_at(self, point: WithEdges, value: float) -> Equilibrium | None:
        """The point of the same branch at another value of the control, at the accuracy of a target, or None.

        The branch continues where contact forms beside it.
        """
        return self.corrected(point.predicted(value), point.state.penetration, value)

    def interpenetrates(self, point: WithEdges) -> bool:
        """Whether contact forms beside the edges of a point."""
        return bool(interpenetration(self.system, point.state, self.increments.fine.allowed).position.size)

    def assess(self, point: WithEdges) -> Assessment:
        """Stability, stiffness and estimated errors, from finer evaluations."""
        return assess_equilibrium(self.system, point.balance, point.value, 1e-2 * self.increments.fine.tolerance)

    def load_of(self, point: Point) -> float | None:
        """Load at a point; None without edges, but for a gap that narrows under a tension without bound."""
        if point.state is not None:
            return point.state.load
        narrowing = self.system.control.load_weight == 0 and isinstance(point, Complete)
        return -np.inf if narrowing else None

    def may_meet(self, before: Point, after: Point, load: float) -> bool:
        """Whether a load is met between two points, or may have been before an event that lowered it."""
        if before.last:
            return False
        if isinstance(before, WithEdges) and isinstance(after, WithEdges):
            return crossing.may_meet(self, before, after, load)
        start, end = self.load_of(before), self.load_of(after)
        return start is not None and end is not None and min(start, end) < load <= max(start, end)

    def at_load(self, before: Point, after: Point, load: float) -> Point | None:
        """The refined point at a load between two points; None where the path jumps over it."""
        return crossing.at_load(self, before, after, load)

    def _pace(self, point: Point) -> Pace:
        """How a path continues from a point: as the point says, or as from a beginning."""
        known = point.increment if isinstance(point, Equilibrium) else None
        return Pace(known or self.increments.largest / 4)

    def _trial(self, point: Equilibrium, goal: float, direction: float, pace: Pace) -> Trial | None:
        """The increment to try; None where the gaps close.

        As long as the pace allows and Newton reaches; before a value that Newton did not reach, halfway to it; but not
        shorter than the shortest.  The last one ends at the goal.
        """
        closing = self.bare.closing_value
        last = self._last_increment(point, closing)
        if goal >= closing and direction > 0 and point.value >= closing - last * (1 + 1e-9):
            return None
        step, shortest = min(pace.increment, self._largest(point), self._within_reach(point)), self._shortest(point)
        if pace.blocked is not None and direction * (pace.blocked - point.value) > 0:
            step = min(step, abs(pace.blocked - point.value) / 2)
        step, end = max(step, shortest), min(goal, closing - last) if goal >= closing else goal
        if step >= abs(end - point.value) * (1 - 1e-12):
            return Trial(abs(end - point.value), end, shortest, end)
        return Trial(step, point.value + direction * step, shortest, end)

    def _attempt(self, point: Equilibrium, value: float, halfway: bool) -> Attempt:
        """Newton from the predicted edges, and the gaps beside the edges that it finds."""
        inc, change, predicted = self.increments, value - point.value, point.predicted(value)
        if not predicted.is_ordered:
            return Attempt()
        system = self.system.sloped if halfway else self.system  # from there the fold is looked for
        accuracy = inc.coarse
        if halfway and point.balance.residual <= accuracy.residual:  # what is left would add up from point to point
            accuracy = replace(accuracy, residual=HALFWAY * accuracy.residual)
        corrected = correct(system, predicted, point.state.penetration, value, accuracy)
        if corrected.balance is None:
            return Attempt()
        self.effort.unknowns = max(self.effort.unknowns, corrected.balance.state.unknowns)
        rate = tangent(self.system.control, corrected.balance)
        ahead = Equilibrium(value, corrected.balance, rate, (rate - point.rate) / (2 * change))
        if self.jumps.ends.leaps(point, ahead):
            return Attempt()
        found = interpenetration(self.system, corrected.balance.state, inc.coarse.allowed)
        if found.position.size:
            return Attempt(ahead, found)
        return Attempt(ahead, too_long=self.jumps.ends.may_hide_a_jump(point, ahead))

    def _past_refusal(self, point: Equilibrium, attempt: Attempt, trial: Trial, pace: Pace) -> tuple[list[Point], Pace]:
        """The points behind the event in a refused increment; none where a shorter one comes first, and the pace.

        A fold is looked for from halfway, where it is foretold better, and what comes before it is met.
        """
        if attempt.ahead is None and pace.fold == "unasked":
            half = self._halfway(point, trial)
            if half is not None:
                return [], Pace(half, trial.value, "ahead")
        overshoot, shorter = self._bracket(point, attempt.found, trial.step, trial.shortest)
        thorough = overshoot <= 1.05 * trial.shortest
        points = self._past_event(point, attempt, (trial.value, trial.end), thorough)
        if pace.fold == "near":  # no Newton has begun from here
            return points, Pace(shorter)
        if not points and thorough:
            start = point if attempt.ahead is None else attempt.ahead
            points = [self.jumps.unlocated(start, trial.value, attempt.found, trial.step)]
        return points, Pace(shorter, trial.value if attempt.found is None else pace.blocked, "asked")

    def _halfway(self, point: Equilibrium, trial: Trial) -> float | None:
        """The increment halfway to where a fold is foretold, if that is shorter than the one to try."""
        foretold = self.jumps.ends.foretold(point, trial.value - point.value)
        half = np.floor(foretold / 2 / trial.step * FRACTIONS) / FRACTIONS * trial.step
        return half if self.increments.smallest / NEARBY < half < trial.step else None

    def _past_event(
        self, point: Equilibrium, attempt: Attempt, ends: tuple[float, float], thorough: bool
    ) -> list[Point]:
        """The end of the branch of a point and the state behind the jump; nothing where it is not located.

        Parameters
        ----------
        point : Equilibrium
        attempt : Attempt
            To follow the branch.
        ends : (float, float)
            Where the attempt was to lead, and how far the path goes: a limit point beyond that does not end this path,
            and the point at its end, just before, is found from there.  Where there is none, and that is within the
            error of the limit point, the contact jumps all the same.
        thorough : bool
            Whether shorter increments would not help.
        """
        if attempt.ahead is not None and attempt.found is not None:
            return self.jumps.from_touch(point, attempt.ahead, attempt.found)
        reach, direction = ends[0] - point.value, np.sign(ends[0] - point.value)
        limit = self.jumps.ends.limit_point(point, reach, thorough)
        if limit is None:
            return []
        if isinstance(limit, TouchedFold):
            within = direction * (limit.value - ends[1]) <= 0
            return self.jumps.from_touch(point, limit, limit.found) if within else []
        beyond = direction * (limit.exact.value - ends[1])  # negative behind the point too: coarse states go too far
        if beyond > 0:
            along = limit.balance.state.patches.moved((ends[1] - limit.exact.value) * point.rate)
            edges = before_fold(limit, ends[1]) if limit.kind == "fold" else along
            near = self.corrected(edges, limit.balance.state.penetration, ends[1])
            if near is not None:
                return [] if self.interpenetrates(near) else [near]
        points = self.jumps.from_limit(limit, ends[1]) if beyond <= limit.error.value else []
        return points if beyond <= 0 or len(points) > 1 else []  # another branch that begins beyond is not there yet

    def _largest(self, point: Equilibrium) -> float:
        """The largest increment of the control at a point: the one asked for, or what moves the contact as far."""
        control = self.system.control
        if control.load_weight == 0:
            return self.increments.largest
        growth = control.penetration_weight + control.load_weight * point.balance.stiffness
        return max(self.increments.largest, self.increments.deepest * growth)

    def _last_increment(self, point: Equilibrium, closing: float) -> float:
        """The increment before complete contact: the smallest; half the way, where several gaps are left."""
        if point.state.patches.count == 1:
            return self.increments.smallest
        return max((closing - point.value) / 2, CLOSED)

    def _bracket(
        self, point: Equilibrium, found: GapMinima | None, step: float, shortest: float
    ) -> tuple[float, float]:
        """How far a failed increment went beyond its event at most, and the increment to try instead."""
        if found is None:
            return step, max(step / 4, shortest)
        patches = point.state.patches
        behind = patches.right[found.gap]
        inside = (found.position > behind) & (found.position < behind + patches.gap_after[found.gap])
        if not np.all(inside):
            return step, max(step / 4, shortest)
        before = gap_field(self.system.elastic, point.state)(found.position, found.gap)
        fraction = float(np.min(np.maximum(before, 0.0) / (np.maximum(before, 0.0) - found.depth)))
        return step * (1 - fraction), max(min(step * fraction + shortest / 2, 0.9 * step), shortest)

    def _within_reach(self, point: Equilibrium) -> float:
        """The increment whose predicted motion uses half of what Newton may travel, and a part of a pinning wave."""
        scale = point.state.patches.edge_scale
        wave = self.system.pinning.shortest(point.balance.work, scale)
        travel = np.minimum(0.5 * LARGEST_NEWTON_STEP * scale, PART * wave)
        with np.errstate(divide="ignore"):
            return float(np.min(travel / np.abs(point.rate)))

    def _shortest(self, point: Equilibrium) -> float:
        """Where the end of a branch is not located, the increment in which it is bracketed.

        A part of the smallest; less where within that edges at rest would lose all their stress intensity.

        Thin layers are so stiff that edges would close, and energies before and after an event not be comparable.
        """
        here, control = point.balance, self.system.control
        loss = np.abs(here.state.stress_intensity_rate) * control.rate(here.state) / (2 * np.sqrt(here.work))
        return min(self.increments.smallest, 1 / float(loss.max())) / BRACKET


def _with_increment(point: Point, increment: float | None) -> Point:
    """The point with the increment with which the path continues from there, where it has edges."""
    return replace(point, increment=increment) if isinstance(point, Equilibrium) else point
