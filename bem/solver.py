"""Solution of a scene: the path through its targets, with every stored state certified.

The steps follow the method: the scene is posed in dimensionless form, complete contact is written down,
the path is followed from target to target (with adhesion event by event, without adhesion target by target), and
every stored state is refined, assessed by a finer evaluation and judged by an independent one.  Increments
between targets are stored at most once per largest increment, of the control and by default of the penetration, at
the same accuracy as targets.  BLAS runs on one thread: the matrices are small, two threads are slower, and digits do
not depend on the number of cores.

From a target the path continues from the numbers stored of it, not from those in memory: an interrupted path takes up
its last target and continues to the same states and events, bit for bit on the same machine.

A target that cannot be met, because nothing is there or because of what double precision or memory cannot do
(NUMERICAL_FAILURES), does not stop `solve`: the result has a row with the reason (missed.py), and the path goes on from
the last stored state; with adhesion that is where it turns, and the states behind are those of such a path.  Ctrl-C on
the path returns the states so far, status `interrupted`.  Mistakes of a scene raise SceneError.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

import numpy as np
from threadpoolctl import threadpool_limits

from bem import missed
from bem.flat import solve_flat
from bem.geometry.patches import ordered
from bem.loading.complete_contact import complete_contact
from bem.loading.crew import Crew
from bem.loading.points_without_edges import Complete, Separated
from bem.missed import FAILURES, NUMERICAL_FAILURES, MissedTargetError
from bem.path_for import path_for
from bem.problem import Problem, pose
from bem.record import Record, entries_of
from bem.recorder import Recorder
from bem.scene.memory_estimate import refuse_beyond_memory
from bem.scene.progress import Progress
from bem.scene.result import Result, asked_for
from bem.scene.scene import Scene, Table, Tables, scene_of
from bem.scene.state import Branch, Ending, State

if TYPE_CHECKING:
    from bem.recorder import AnyPoint

MOST_BETWEEN = 500  # limit: states stored between two targets
DEEPER = 0.05  # format: rms heights of penetration between states stored, or the largest increment if that is less
ALMOST = 0.9  # format: of that: steps under load are as long as the stiffness where they begin says

OnProgress = Callable[[Progress], None] | None
OnState = Callable[[Record], None] | None


@dataclass(frozen=True)
class Goal:
    """Target of the path: index, value in units of the scene, value of the control, separation to its last digit."""

    index: int
    target: float
    value: float
    separation: float | None


def solve(
    scene: Scene | Path | str | Table | None = None,
    progress: OnProgress = None,
    on_state: OnState = None,
    resume: Result | None = None,
    jobs: int = 1,
    **tables: Unpack[Tables],
) -> Result:
    """Solve a scene.

    Parameters
    ----------
    scene : Scene, path or mapping, optional
        Checked, as a file, or as its tables; SceneError lists its mistakes, or says how much memory is missing.
    progress : callable, optional
        Called after every accepted increment.
    on_state : callable, optional
        Called with all that is kept so far whenever a state is added: its last entry is new, `result("interrupted")`
        makes a result of all.
    resume : Result, optional
        An interrupted result of the same scene: its states are kept up to the last target, and the path goes on there.
    jobs : int
        Processes for the parts of a large contact with adhesion, at a tolerance of 1e-4 or more; results do not depend
        on it.  ChildProcessError if one is killed.
    **tables
        `profile`, `solid`, `loading`, `layer`, ...: objects or mappings, where no scene is given.

    Returns
    -------
    Result
        Status `converged`, `unreachable`, `not_converged` or `interrupted` (KeyboardInterrupt).  Every target has its
        row; those missed say why, and the others are met all the same.  `not_converged` also where a state is not
        certified.

    Examples
    --------
    >>> wave = {"kind": "harmonics", "period": 1.0, "orders": [1], "amplitudes": [0.01], "phases": [0.0]}
    >>> loading = {"control": "mean_pressure", "targets": [0.5 * np.pi * 0.01]}
    >>> result = solve(profile=wave, solid={"youngs_modulus": 1.0, "poisson_ratio": 0.0}, loading=loading)
    >>> result.status, round(result.targets[0].contact_fraction, 9)  # Westergaard: half of the wave touches
    ('converged', 0.5)
    """
    scene = scene_of(scene, tables)
    refuse_beyond_memory(scene)
    if scene.surface().is_flat:
        return solve_flat(scene)
    record = Record(scene)
    with threadpool_limits(limits=1, user_api="blas"), Crew(jobs) as crew:
        try:
            run = _Run(scene, pose(scene), record, progress, on_state, crew)
            if resume is not None:
                run.take_over(resume)
            status, failure = run.follow()
        except NUMERICAL_FAILURES as error:
            return record.result("not_converged", f"{type(error).__name__}: {error}")
    return record.result(status, failure)


class _Run:
    """Path through the targets of a scene."""

    def __init__(
        self, scene: Scene, problem: Problem, record: Record, progress: OnProgress, on_state: OnState, crew: Crew
    ) -> None:
        self.scene, self.problem, self.progress, self.record = scene, problem, progress, record
        self.complete = complete_contact(problem.profile, problem.law, problem.elastic.compliance)
        self.path = path_for(scene, problem, self.complete, crew)
        self.recorder = Recorder(scene, problem, self.complete, self.path, record, on_state)
        self.control = scene.loading.control
        self.goals = [
            Goal(index, target, problem.control_value(target, self.control), self._separation(target))
            for index, target in enumerate(scene.loading.targets)
        ]
        self.done = 0
        stop, between = scene.loading.stop_at_mean_pressure, scene.loading.at_mean_pressures
        pressures = [*between, *(() if stop is None else (stop,))]
        self.asked = {pressure: len(self.goals) + k for k, pressure in reversed(list(enumerate(pressures)))}  # index
        self.met: set[float] = set()  # mean pressures asked for that this leg of the path has met
        self.last: tuple[State, float | None] | None = None  # state kept, and the value of the control if at a target
        self.stored_value, self.stored_penetration = np.inf, np.nan  # of the last state stored: value, penetration in m
        self.branch: Branch = "loading"
        if scene.start_state is not None:
            self.last, self.branch = (scene.start_state, None), scene.start_state.branch
        self.point: AnyPoint = self._start()
        self.continues_from_point = (
            self.last is None
        )  # whether the path goes on from `point`, not from the last state as stored

    def _start(self) -> AnyPoint:
        """Return the first point of a path: surfaces apart, or complete contact."""
        first = self.goals[0].value
        if self.scene.loading.initial != "complete_contact":
            return Separated(min(0.0, first) - 1.0)
        fixed = self.problem.control.load_weight == 0
        tension = -float(np.min(self.complete.pressure.valleys[1]))  # no flaw opens under a pressure that leaves none
        return Complete(self.problem.profile.max_height if fixed else max(first, 2 * np.pi * tension) + 1.0)

    def _next_start(self) -> AnyPoint:
        """Return the point from which to follow the path: the current one, or the state stored last, rebuilt."""
        if self.continues_from_point:
            return self.point
        if self.last is None:
            return self._start()
        state, value = self.last
        point = self._checked(self._point_of(state, value))
        self.stored_value, self.stored_penetration = point.value, state.penetration
        return point

    def take_over(self, result: Result) -> None:
        """Keep an interrupted result up to its last target and continue there; later states are computed again."""
        entries = tuple(entries_of(result, self.record.begun))
        ends = [count for count, entry in enumerate(entries, 1) if self._ends_leg(entry.state)]
        entries = entries[: ends[-1]] if ends else ()
        for state in (entry.state for entry in entries):
            self._take_branch(state.branch)
            goal = None if state.index is None or state.index >= len(self.goals) else self.goals[state.index]
            if goal is not None:
                self._mark_target_pressure(goal)
                self.done = goal.index + 1
            elif state.index is not None:
                self.met.add(self._asked_at(state.index))
            if state.found:
                self.last = state, None if goal is None else goal.value
            if self._is_stop(state):
                self.done = len(self.goals)
        self.record.entries = list(entries)
        self.continues_from_point = self.continues_from_point and not entries

    def follow(self) -> tuple[Ending, str | None]:
        """Visit the remaining targets; return the status of the result, and the reason unless `converged`."""
        try:
            for index in range(self.done, len(self.goals)):
                if self._reach(index):
                    break
        except KeyboardInterrupt:
            return "interrupted", None
        return missed.verdict(self.record.states)

    def _reach(self, index: int) -> bool:
        """Follow the path to a target, or record why it is missed; return whether the path ends on the way."""
        goal = self.goals[index]
        try:
            return self._visit(goal, index)
        except MissedTargetError as error:
            why = error
        except NUMERICAL_FAILURES as error:
            why = missed.not_computed(error)
        self.record.pending_events, self.continues_from_point = [], False
        self._miss(why, f"target {index + 1} of {len(self.goals)}", index)
        return False

    def _miss(self, why: MissedTargetError, name: str, index: int) -> None:
        """Keep the row of a target that was not met."""
        reason = missed.sentence(why, name, *asked_for(self.record.begun.scene["loading"], index))
        self.recorder.miss(index, why.status, reason, self.branch)

    def _visit(self, goal: Goal, index: int) -> bool:
        """Follow the path to a target and store its state; return whether the path ends on the way, as asked."""
        self.point, self.continues_from_point = self._next_start(), True
        direction = self.path.direction(self.point, goal.value, goal.separation)
        if direction:
            self._take_branch("loading" if direction > 0 else "unloading")
        self._mark_target_pressure(goal)
        self._check_reach(goal.value)
        if self._follow_to(goal, self._spacing(goal.value), index):
            return True
        if self.point.value != goal.value:
            raise missed.passed_over()
        self.point = self._refined(self.point, direction)
        self._keep(self.point, index, goal.value)
        self.continues_from_point = not self.path.has_history
        return False

    def _follow_to(self, goal: Goal, spacing: float, index: int) -> bool:
        """Follow the path to a goal and store states asked for on the way; return whether the path ends, as asked."""
        direction = self.path.direction(self.point, goal.value, goal.separation)
        for point in self.path.advance(self.point, goal.value, goal.separation):
            before, self.point = self.point, self._checked(point)
            self._report(index)
            if self._store_crossings(before, point, index):
                return True
            if self._lost_under_load(point, goal.value):
                self._keep(point)
                at = point.events[-1].at.value if point.events else before.value
                raise missed.came_apart(self.problem.mean_pressure(at))
            if not point.last and point.value != goal.value and self._is_far(point, spacing):
                between = self._refined(point, direction)
                self._keep(between)
                if between.events:  # the path continues behind them
                    self.point = between
                    return self._follow_to(goal, spacing, index)
        return False

    def _separation(self, target: float) -> float | None:
        """Return the separation of a target, dimensionless and to its last digit; None under another control."""
        return target / self.problem.scales.height if self.control == "separation" else None

    def _checked(self, point: AnyPoint) -> AnyPoint:
        """Return the point; raise MissedTargetError if its status is a failure."""
        if point.status in FAILURES:
            raise missed.no_point(point.status, self.recorder.target_of(point), self.control, self.path.has_history)
        return point

    def _spacing(self, goal: float) -> float:
        """Return the least change of the control between states stored on the way to a goal."""
        joined = self.problem.control.value(self.problem.profile.max_height, self.complete.least_load)
        start, stop = (min(max(value, -joined), joined) for value in (self.point.value, goal))
        return max(self.path.increments.apart, abs(stop - start) / MOST_BETWEEN)

    def _is_far(self, point: AnyPoint, spacing: float) -> bool:
        """Return whether a point between targets is far enough from the last stored state to be stored as well."""
        depth = np.nan if point.state is None else point.state.penetration * self.problem.scales.height
        deeper = min(self.scene.accuracy.max_increment, DEEPER) * self.problem.scales.height
        return (
            abs(point.value - self.stored_value) >= spacing
            and not abs(depth - self.stored_penetration) < deeper * ALMOST
        )

    def _refined(self, point: AnyPoint, direction: float) -> AnyPoint:
        """Return the point at the accuracy of a target, and keep the events of the refinement."""
        refined = self._checked(self.path.refine(point, direction))
        self.recorder.note(refined.events)
        return refined

    def _keep(self, point: AnyPoint, index: int | None = None, goal: float | None = None) -> None:
        """Store a refined point as a state, with the index of its target; `goal` is its value of the control."""
        state = self.recorder.keep(point, self.branch, index)
        self.last = state, goal
        self.stored_value, self.stored_penetration = point.value, state.penetration

    def _take_branch(self, branch: Branch) -> None:
        """Turn to loading or unloading; every leg of the path meets all mean pressures asked for again."""
        if branch != self.branch:
            self.met.clear()
        self.branch = branch

    def _mark_target_pressure(self, goal: Goal) -> None:
        """Mark the pressure of a target as met, so that an equal one of at_mean_pressures stores no second state."""
        if self.control == "mean_pressure" and goal.target != self.scene.loading.stop_at_mean_pressure:
            self.met.add(goal.target)

    def _store_crossings(self, before: AnyPoint, after: AnyPoint, index: int) -> bool:
        """Record the events between two points, and store a state at each mean pressure asked for, in path order.

        `index` is the index of the target ahead.

        Returns
        -------
        bool
            Whether the path ends at one of the pressures.
        """
        ahead, direction = after.events, float(np.sign(after.value - before.value))
        for pressure in self._crossed(before, after):
            meeting: AnyPoint | None = self.path.at_load(before, after, self.problem.load_of(pressure))
            if meeting is None:
                continue
            self.met.add(pressure)
            try:
                meeting = self._checked(meeting)
                behind = tuple(event for event in ahead if direction * (event.at.value - meeting.value) <= 0)
                self.recorder.note(behind, before, after)
                ahead = ahead[len(behind) :]
                self._keep(meeting, self._index_of(pressure, index))
            except MissedTargetError as why:
                self._miss(why, "a pressure on the way", self.asked[pressure])
            if pressure == self.scene.loading.stop_at_mean_pressure:
                self.point = meeting
                return True
        self.recorder.note(ahead, before, after)
        return False

    def _crossed(self, before: AnyPoint, after: AnyPoint) -> list[float]:
        """Return the mean pressures asked for between the pressures of two points, in the order of the path."""
        wanted = self.asked.keys() - self.met
        start, end = (self.path.load_of(point) for point in (before, after)) if wanted else (None, None)
        if start is None or end is None:
            return []
        crossed = [at for at in wanted if self.path.may_meet(before, after, self.problem.load_of(at))]
        return sorted(crossed, reverse=bool(end < start))

    def _report(self, index: int) -> None:
        if self.progress is None:
            return
        state, effort = self.point.state, self.path.effort
        joined = self.point.status == "complete_contact"
        held = joined and self.control == "mean_pressure"  # else the pressure of complete contact is not known
        load = state.load if state is not None else self.point.value if held else 0.0
        self.progress(
            Progress(
                mean_pressure=self.problem.mean_pressure(load),
                contact_fraction=float(joined) if state is None else state.patches.contact_fraction,
                n_patches=0 if state is None else state.patches.count,
                increments_accepted=effort.accepted,
                increments_rejected=effort.rejected,
                evaluations=effort.evaluations,
                target_index=index,
                n_targets=len(self.goals),
                value=self.recorder.target_of(self.point),
            )
        )

    def _check_reach(self, goal: float) -> None:
        """Raise MissedTargetError at a tension before first touch, or a penetration beyond complete contact."""
        if self.control == "mean_pressure":
            if goal < 0 and self.point.status == "separated":
                raise missed.tension_apart()
        elif self.problem.control.load_weight == 0 and goal > self.problem.profile.max_height * (1 + 1e-12):
            raise missed.beyond_contact(self.problem.surface.max_height)

    def _lost_under_load(self, point: AnyPoint, goal: float) -> bool:
        """Return whether the surfaces came apart under load control: no state carries the tension asked for."""
        return self.control == "mean_pressure" and point.status == "separated" and goal < 0

    def _asked_at(self, index: int) -> float:
        """Return the value asked for at the target with an index, in the units of the scene."""
        return asked_for(self.record.begun.scene["loading"], index)[1]

    def _index_of(self, pressure: float, ahead: int) -> int:
        """Return the index of the target that is a mean pressure: the target ahead, or one on the way."""
        is_ahead = self.control == "mean_pressure" and self.goals[ahead].target == pressure
        return ahead if is_ahead else self.asked[pressure]

    def _is_stop(self, state: State) -> bool:
        """Return whether a path ends at a stored state, because its mean pressure is stop_at_mean_pressure."""
        stop = self.scene.loading.stop_at_mean_pressure
        if stop is None or state.index is None:
            return False
        pressure = self.control == "mean_pressure" or state.index >= len(self.goals)
        return pressure and self._asked_at(state.index) == stop

    def _ends_leg(self, state: State) -> bool:
        """Return whether a stored state is at a target of the path, or where the path stops."""
        return state.index is not None and (state.index < len(self.goals) or self._is_stop(state))

    def _point_of(self, state: State, goal: float | None = None) -> AnyPoint:
        """Return the point of the path at a stored state; `goal` is its control value if the state is at a target."""
        scales = self.problem.scales
        penetration = state.penetration / scales.height
        load = self.problem.load_of(state.mean_pressure)
        value = self.problem.control.value(penetration, load) if goal is None else goal
        if not state.edges:
            bare = load if self.control == "mean_pressure" else penetration
            kind = Complete if state.status == "complete_contact" else Separated
            return kind(bare if goal is None else goal)
        edges = np.array(state.edges) / scales.length
        patches = ordered(edges[:, 0], edges[:, 1])
        point: AnyPoint = self.path.restart(patches, penetration, value, self._separation(state.separation))
        return point
