"""A scene solved: follow the path through its targets, certify every state kept, keep what converged.

The order of things is that of the method: the scene is posed in dimensionless form, complete contact is written down,
the path is followed from target to target (with adhesion event by event, without adhesion target by target), and
every stored state is refined, assessed by a finer evaluation and certified by an independent one.  Increments
between targets are stored at most once per largest increment, of the control and by default of the penetration, at
the same accuracy as targets.  BLAS runs on one thread: the matrices are small, two threads are slower, and digits do
not depend on the number of cores.

From a target the path continues from the numbers stored of it, not from those in memory: an interrupted path takes up
its last target and continues to the same states and events, bit for bit on the same machine.

Nothing but an interrupt leaves `solve`: what double precision or memory cannot do (NUMERICAL_FAILURES) ends the path as
`not_converged`, with the reason in `Result.failure`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Unpack

import numpy as np
from threadpoolctl import threadpool_limits

from bem.elastic.hierarchical import IllConditionedSystemError
from bem.flat import flat_states
from bem.geometry.patches import ordered
from bem.geometry.profile import Profile
from bem.loading.complete_contact import complete_contact
from bem.loading.path_point import Complete, Separated
from bem.path_for import path_for
from bem.problem import Problem, pose
from bem.record import Record, Recorder
from bem.scene.result import UNPHYSICAL, Progress, Result, State
from bem.scene.scene import Scene
from bem.scene_objects import Described, Tables, scene_of
from bem.states import flat_state

if TYPE_CHECKING:
    from bem.record import AnyPoint

MOST_BETWEEN = 500  # states stored between two targets
DEEPER = 0.05  # rms heights of penetration between two states stored, or the largest increment where that is less
ALMOST = 0.9  # of that: steps under load are as long as the stiffness where they begin says
FAILURES = {
    "not_converged": "no equilibrium was found",
    "ill_conditioned": "the gaps are too narrow to resolve",
    "jumps_again": "the contact jumps again and again",
}
NUMERICAL_FAILURES = (IllConditionedSystemError, *UNPHYSICAL, FloatingPointError, np.linalg.LinAlgError, MemoryError)


@dataclass(frozen=True)
class Goal:
    """A target: in the units of the scene, as value of the control, and as separation to its last digit."""

    target: float
    value: float
    separation: float | None


def solve(
    scene: Described = None,
    progress: Callable[[Progress], None] | None = None,
    on_state: Callable[[Result], None] | None = None,
    resume: Result | None = None,
    **tables: Unpack[Tables],
) -> Result:
    """Solve a scene.

    Parameters
    ----------
    scene : Scene, path or mapping, optional
        Checked, as a file, or as its tables; SceneError lists its mistakes.
    progress : callable, optional
        Called after every accepted increment.
    on_state : callable, optional
        Called with all that is kept so far, as an interrupted result, whenever a state is added.
    resume : Result, optional
        An interrupted result of the same scene: its states are kept up to the last target, and the path continues
        from there.
    **tables
        `profile`, `solid`, `loading`, `layer`, ...: objects or mappings, where no scene is given.

    Returns
    -------
    Result
        Status `converged`, `unreachable`, `not_converged` or `interrupted` (KeyboardInterrupt); states before
        a failure are kept.  `not_converged` also where a state is not certified.

    Examples
    --------
    >>> wave = {"kind": "harmonics", "period": 1.0, "orders": [1], "amplitudes": [0.01], "phases": [0.0]}
    >>> loading = {"control": "mean_pressure", "targets": [0.5 * np.pi * 0.01]}
    >>> result = solve(profile=wave, solid={"youngs_modulus": 1.0, "poisson_ratio": 0.0}, loading=loading)
    >>> result.status, round(result.targets[0].contact_fraction, 9)  # Westergaard: half of the wave touches
    ('converged', 0.5)
    """
    scene = scene_of(scene, tables)
    surface = scene.surface()
    if surface.is_flat:
        return _solve_flat(scene, surface)
    record = Record(scene)
    with threadpool_limits(limits=1, user_api="blas"):
        try:
            run = _Run(scene, pose(scene, surface), record, progress, on_state)
            if resume is not None:
                run.take_over(resume)
            status, failure = run.follow()
        except NUMERICAL_FAILURES as error:
            status, failure = "not_converged", f"{type(error).__name__}: {error}"
    return record.result(status, failure)


class _Run:
    """One path through the targets of a scene."""

    def __init__(
        self,
        scene: Scene,
        problem: Problem,
        record: Record,
        progress: Callable[[Progress], None] | None,
        on_state: Callable[[Result], None] | None,
    ) -> None:
        self.scene, self.problem, self.progress, self.record = scene, problem, progress, record
        self.complete = complete_contact(problem.profile, problem.law, problem.elastic.compliance)
        self.path = path_for(scene, problem, self.complete)
        self.recorder = Recorder(scene, problem, self.complete, self.path, record, on_state)
        kind = scene.loading.control
        self.goals = [
            Goal(target, problem.control_value(target, kind), self._separation(target))
            for target in scene.loading.targets
        ]
        self.done = 0
        self.met: set[float] = set()  # mean pressures asked for that this leg of the path has met
        self.kept, self.kept_penetration = np.inf, np.nan  # of the last state stored: value, penetration in m
        self.branch = "loading"
        self.failed = ""
        self.point = self._start()
        if scene.start_state is not None:
            self.kept, self.kept_penetration = self.point.value, scene.start_state.penetration

    def _start(self) -> AnyPoint:
        """Where the path begins: surfaces apart, complete contact, or a stored state."""
        first = self.goals[0].value
        if self.scene.start_state is not None:
            self.branch = self.scene.start_state.branch
            return self._point_of(self.scene.start_state)
        if self.scene.loading.initial != "complete_contact":
            return Separated(min(0.0, first) - 1.0)
        fixed = self.problem.control.load_weight == 0
        return Complete(self.problem.profile.max_height if fixed else first + 1.0)

    def take_over(self, result: Result) -> None:
        """Keep an interrupted result up to its last target and stand there; what came after it is computed again."""
        record, last = self.record, 0
        for count, state in enumerate(result.states, 1):
            if self._is_goal(state):
                self.done, last = self.done + 1, count
        if last == 0 or result.states[last - 1].events is None:  # which events came before it is not known
            return
        record.states, record.warnings = list(result.states[:last]), result.warnings
        record.events = list(result.events[: record.states[-1].events])
        self.done = 0
        for state in record.states:
            self._take_branch(state.branch)
            if self._is_goal(state):
                self.done += 1
            elif state.target:
                self.met.add(min(self._asked, key=lambda pressure: abs(pressure - state.mean_pressure)))
            if state.target and self.recorder.outputs_at(getattr(state, self.scene.loading.control)):
                record.shapes += 1
        belongs = {name: name.rpartition("_")[2] for name in result.fields}
        record.fields = {
            name: result.fields[name] for name, of in belongs.items() if not of.isdigit() or int(of) < record.shapes
        }
        self.kept, self.kept_penetration = self.goals[self.done - 1].value, record.states[-1].penetration
        self.point = self._point_of(record.states[-1], self.kept)

    def follow(self) -> tuple[str, str | None]:
        """Visit the remaining targets; the status of the result, and why, where it is not a final one."""
        try:
            for index in range(self.done, len(self.goals)):
                status = self._reach(index)
                if status == "converged":
                    break
                if status is not None:
                    target = f"target {index + 1} of {len(self.goals)}, {self.goals[index].target:g}"
                    return status, f"{target}: {self._reason(status)}"
        except KeyboardInterrupt:
            return "interrupted", None
        refused = [state for state in self.record.states if not state.certificate.ok]
        if refused:
            first, count = refused[0], f"{len(refused)} of {len(self.record.states)} states are not certified"
            reason = next(iter(first.certificate.reasons), "")
            return "not_converged", f"{count}, the first at a separation of {first.separation:.9g} m: {reason}"
        return "converged", None

    def _reason(self, status: str) -> str:
        """Why the path ended before a target."""
        if status == "unreachable":
            return "no state of this path is there"
        return f"{FAILURES[self.failed]} at {self.recorder.target_of(self.point):.9g}"

    def _reach(self, index: int) -> str | None:
        """Follow the path to one target; None to continue, else the status with which the path ends."""
        goal = self.goals[index]
        direction = self.path.direction(self.point, goal.value, goal.separation)
        if direction:
            self._take_branch("loading" if direction > 0 else "unloading")
        if self._out_of_reach(goal.value):
            return "unreachable"
        ended = self._follow_to(goal, self._spacing(goal.value), index)
        if ended is not None:
            return ended
        if self.point.value != goal.value:  # what opened at a flaw closed again, or came apart
            return "not_converged"
        self.point = self._refined(self.point, direction)
        if self._fails(self.point):
            return "not_converged"
        self._keep(self.point, target=True)
        if self.path.has_history:
            self.point = self._point_of(self.record.states[-1], goal.value)
        return "not_converged" if self._fails(self.point) else None

    def _follow_to(self, goal: Goal, spacing: float, index: int) -> str | None:
        """Follow the path to a goal, storing what is asked for on the way; the status of the path where it ends."""
        direction = self.path.direction(self.point, goal.value, goal.separation)
        for point in self.path.advance(self.point, goal.value, goal.separation):
            before, self.point = self.point, point
            self._report(index)
            if self._fails(point):
                self.recorder.note(point.events)
                return "not_converged"
            ended = self._passed(before, point)
            if ended is not None:
                return ended
            if self._lost_under_load(point, goal.value):
                self._keep(point, target=True, status="unreachable")
                return "unreachable"
            if not point.last and point.value != goal.value and self._is_far(point, spacing):
                between = self._refined(point, direction)
                if self._fails(between):
                    return "not_converged"
                self._keep(between, target=False)
                if between.events:  # the path continues behind them
                    self.point = between
                    return self._follow_to(goal, spacing, index)
        return None

    def _separation(self, target: float) -> float | None:
        """The separation that a target asks for, dimensionless and to its last digit; None under another control."""
        return target / self.problem.scales.height if self.scene.loading.control == "separation" else None

    def _fails(self, point: AnyPoint) -> bool:
        """Whether there is no such point."""
        self.failed = point.status
        return point.status in FAILURES

    def _spacing(self, goal: float) -> float:
        """Least change of the control between stored states on the way to a goal: the largest increment, or more."""
        joined = self.problem.control.value(self.problem.profile.max_height, self.complete.least_load)
        start, stop = (min(max(value, -joined), joined) for value in (self.point.value, goal))
        return max(self.path.increments.largest, abs(stop - start) / MOST_BETWEEN)

    def _is_far(self, point: AnyPoint, spacing: float) -> bool:
        """Whether a point between targets is far enough from the last state stored to be stored as well."""
        depth = np.nan if point.state is None else point.state.penetration * self.problem.scales.height
        deeper = min(self.scene.accuracy.max_increment, DEEPER) * self.problem.scales.height
        return abs(point.value - self.kept) >= spacing and not abs(depth - self.kept_penetration) < deeper * ALMOST

    def _refined(self, point: AnyPoint, direction: float) -> AnyPoint:
        """The point at the accuracy of a target, the events on the way to which are kept."""
        refined: AnyPoint = self.path.refine(point, direction)
        self.recorder.note(refined.events)
        return refined

    def _keep(self, point: AnyPoint, target: bool, status: str | None = None) -> None:
        """Store a refined point as a state."""
        self.recorder.keep(point, self.branch, target, status)
        self.kept, self.kept_penetration = point.value, self.record.states[-1].penetration

    def _take_branch(self, branch: str) -> None:
        """Turn to loading or unloading; every leg of the path meets the mean pressures asked for anew."""
        if branch != self.branch:
            self.met.clear()
        self.branch = branch

    @property
    def _asked(self) -> set[float]:
        """Mean pressures at which a state is asked for."""
        loading = self.scene.loading
        stop = loading.stop_at_mean_pressure
        return {*loading.at_mean_pressures, *(() if stop is None else (stop,))}

    def _passed(self, before: AnyPoint, after: AnyPoint) -> str | None:
        """Keep the events between two points, and states where asked mean pressures are crossed, in their order.

        Returns
        -------
        str or None
            The status of the path where it ends at one of them.
        """
        ahead, direction = after.events, float(np.sign(after.value - before.value))
        for pressure in self._crossed(before, after):
            found: AnyPoint | None = self.path.at_load(before, after, self.problem.load_of(pressure))
            if found is None:
                continue
            if self._fails(found):
                return "not_converged"
            behind = tuple(event for event in ahead if direction * (event.at.value - found.value) <= 0)
            self.recorder.note(behind)
            ahead = ahead[len(behind) :]
            self.met.add(pressure)
            self._keep(found, target=True)
            if pressure == self.scene.loading.stop_at_mean_pressure:
                self.point = found
                return "converged"
        self.recorder.note(ahead)
        return None

    def _crossed(self, before: AnyPoint, after: AnyPoint) -> list[float]:
        """Mean pressures asked for that lie between those of two points, in the order in which they are crossed."""
        wanted = self._asked - self.met
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
        self.progress(
            Progress(
                mean_pressure=0.0 if state is None else self.problem.mean_pressure(state.load),
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

    def _out_of_reach(self, goal: float) -> bool:
        """A tension before first touch, or a penetration beyond complete contact."""
        if self.scene.loading.control == "mean_pressure":
            return goal < 0 and self.point.status == "separated"
        return self.problem.control.load_weight == 0 and goal > self.problem.profile.max_height * (1 + 1e-12)

    def _lost_under_load(self, point: AnyPoint, goal: float) -> bool:
        """Whether load control pulled off: no state carries the tension asked for."""
        return self.scene.loading.control == "mean_pressure" and point.status == "separated" and goal < 0

    def _is_goal(self, state: State) -> bool:
        """Whether a stored state is the next target of the path, not a pressure on the way."""
        if not state.target or self.done == len(self.goals):
            return False
        target = self.goals[self.done].target
        value = getattr(state, self.scene.loading.control)
        scale = max(abs(target), self.problem.scales.height * 1e-3)
        return value is not None and abs(value - target) <= 1e-9 * scale

    def _point_of(self, state: State, goal: float | None = None) -> AnyPoint:
        """The point of the path at a stored state, which stands at a goal unless the scene starts there."""
        scales = self.problem.scales
        penetration = state.penetration / scales.height
        load = self.problem.load_of(state.mean_pressure)
        value = self.problem.control.value(penetration, load) if goal is None else goal
        if not state.edges:
            bare = load if self.scene.loading.control == "mean_pressure" else penetration
            kind = Complete if state.status == "complete_contact" else Separated
            return kind(bare if goal is None else goal)
        edges = np.array(state.edges) / scales.length
        patches = ordered(edges[:, 0], edges[:, 1])
        point: AnyPoint = self.path.restart(patches, penetration, value, self._separation(state.separation))
        return point


def _solve_flat(scene: Scene, surface: Profile) -> Result:
    """Two flat surfaces: exact answers."""
    work = 0.0 if scene.adhesion is None else scene.adhesion.work_of_adhesion
    states: list[State] = []
    last = -np.inf
    for flat in flat_states(scene):
        states.append(flat_state(flat, -work, "loading" if flat.penetration >= last else "unloading"))
        last = flat.penetration
    if states[-1].status != "unreachable":
        return Record(scene, states).result("converged")
    target = f"target {len(states)} of {len(scene.loading.targets)}, {scene.loading.targets[len(states) - 1]:g}"
    return Record(scene, states).result(
        "unreachable", f"{target}: flat surfaces neither overlap nor carry this tension"
    )
