"""One setting solved: what the states at its targets say, and what they took.

A target is known by what is held there (the control of the scene, or a mean pressure on the way), its value, and how
often the path has been there.  What is left free is the mean pressure, or the separation under a given pressure.
Exceptions of a scene become a status with the reason; a run beyond its limit of seconds ends as `stopped`.
"""

import math
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from bem.contact_state import ContactState
from bem.elastic.layer import Layer
from bem.geometry.scaling import Solid
from bem.missed import NUMERICAL_FAILURES
from bem.scene.result import FINAL_STATUSES, Progress, Result, State
from bem.scene.scene import Scene, SceneError, parse_scene
from bem.solver import solve
from validation.harness.arrays import FloatArray

PULLED_OFF = "pulled off"  # status of a setting of which all targets that were not met lie behind a pull-off
SAME = 1e-9  # relative distance within which a state is at a target
MOST_NODES = 8  # targets at which nodes are varied
NODE_TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-10, 1e-12)
REFERENCE_NODES = 1e-14


Key = tuple[str, float, int]  # what is held, its value, how often the path has been there, from 1


class TooLongError(RuntimeError):
    """A run has taken more seconds than it may."""


@dataclass(frozen=True)
class ToSolve:
    """A scene to solve: its tables, the folder in which its file names begin, and the CPU seconds that it may take."""

    name: str
    tables: dict[str, Any]
    base: str
    limit: float
    nodes: bool = False


@dataclass(frozen=True)
class Reading:
    """A state at a target; errors are those that the solver estimates, nan where it does not."""

    key: Key
    branch: str
    patches: int
    certified: bool
    contact_fraction: float
    fraction_error: float
    free: str  # what is left free
    free_value: float
    free_error: float


@dataclass(frozen=True)
class NodeCurve:
    """The edges of a state evaluated at each of NODE_TOLERANCES: unknowns per patch, errors, CPU seconds."""

    key: Key
    per_patch: tuple[float, ...]
    load_errors: tuple[float, ...]
    intensity_errors: tuple[float, ...]
    seconds: tuple[float, ...]


@dataclass(frozen=True)
class Solved:
    """What came of a setting."""

    status: str
    failure: str
    seconds: float = 0.0
    evaluations: int = 0
    unknowns: int = 0
    rms_height: float = math.nan
    rms_slope: float = math.nan
    pressure_scale: float = math.nan
    readings: tuple[Reading, ...] = ()
    nodes: tuple[NodeCurve, ...] = ()

    @property
    def good(self) -> bool:
        """Whether it ended as asked."""
        return self.status in (*FINAL_STATUSES, PULLED_OFF)


def solved(task: ToSolve) -> Solved:
    """Solve a scene; never raises for what it is."""
    try:
        scene = parse_scene(task.tables, task.base)
    except SceneError as error:
        return Solved("refused", str(error))
    begun = time.process_time()

    def watch(progress: Progress) -> None:
        if time.process_time() - begun > task.limit:
            raise TooLongError

    try:
        result = solve(scene, progress=watch)
    except SceneError as error:
        return Solved("refused", str(error))
    except TooLongError:
        seconds = time.process_time() - begun
        return Solved("stopped", f"took more than {task.limit:.0f} s", seconds)
    seconds = time.process_time() - begun
    return Solved(
        status=PULLED_OFF if result.answered and result.status not in FINAL_STATUSES else result.status,
        failure=result.failure or "",
        seconds=seconds,
        evaluations=sum(state.evaluations for state in result.states),
        unknowns=max((state.unknowns for state in result.states), default=0),
        rms_height=result.groups["rms_height"],
        rms_slope=result.groups["rms_slope"],
        pressure_scale=result.groups["pressure_scale"],
        readings=tuple(reading for reading, _ in readings(scene, result)),
        nodes=tuple(_node_curves(scene, result)) if task.nodes else (),
    )


def readings(scene: Scene, result: Result) -> Iterator[tuple[Reading, State]]:
    """The states at targets that are there, each with its state."""
    loading, visits = scene.loading, Counter[tuple[str, float]]()
    last = loading.stop_at_mean_pressure
    asked = [*loading.at_mean_pressures, *(() if last is None else [last])]
    passed = 0
    for state in result.targets:
        if state.status not in FINAL_STATUSES:
            continue
        target = loading.targets[passed] if passed < len(loading.targets) else math.nan
        found = getattr(state, loading.control)
        height = 1e-3 * result.groups["rms_height"]
        at_goal = found is None or abs(found - target) <= SAME * max(abs(target), height)
        if at_goal or not asked:
            held, value, passed = loading.control, target, passed + 1
        else:
            held, value = "mean_pressure", min(asked, key=lambda pressure: abs(pressure - state.mean_pressure))
        visits[held, value] += 1
        free = "separation" if held == "mean_pressure" else "mean_pressure"
        estimates = (getattr(state.error_estimate, name) for name in ("contact_fraction", free))
        fraction_error, free_error = (math.nan if error is None else error for error in estimates)
        reading = Reading((held, value, visits[held, value]), state.branch, state.n_patches, state.certificate.ok,
                          state.contact_fraction, fraction_error, free, getattr(state, free), free_error)  # fmt: skip
        yield reading, state


def _node_curves(scene: Scene, result: Result) -> Iterator[NodeCurve]:
    """Edges of some states evaluated with fewer and more nodes; states that these cannot carry are left out."""
    with_edges = [(reading, state) for reading, state in readings(scene, result) if state.edges]
    step = max(1, -(-len(with_edges) // MOST_NODES))
    scale = result.groups["pressure_scale"]
    for reading, state in with_edges[step - 1 :: step]:
        found = [_evaluated(scene, state, tolerance) for tolerance in (REFERENCE_NODES, *NODE_TOLERANCES)]
        if any(one is None for one in found):
            continue
        (_, pressure, intensity, _), *others = [one for one in found if one is not None]
        load = max(abs(pressure), 1e-3 * scale)
        # without adhesion K is zero: errors are then those of a load of this size on one edge
        tip = float(np.max(np.abs(intensity))) if scene.adhesion else load * math.sqrt(float(scene.profile.period or 1))
        yield NodeCurve(
            reading.key,
            tuple(one[0] for one in others),
            tuple(abs(other - pressure) / load for _, other, _, _ in others),
            tuple(float(np.max(np.abs(coarse - intensity))) / tip for _, _, coarse, _ in others),
            tuple(one[3] for one in others),
        )


def _evaluated(scene: Scene, state: State, tolerance: float) -> tuple[float, float, FloatArray, float] | None:
    """Unknowns per patch, mean pressure, K at all edges and CPU seconds; None where nodes on patches do not do."""
    solid = Solid(scene.solid.youngs_modulus, scene.solid.poisson_ratio)
    layer = None if scene.layer is None else Layer(scene.layer.thickness)
    surface, begun = scene.surface(), time.process_time()
    try:
        at = ContactState(surface, solid, state.edges, state.penetration, layer=layer, tolerance=tolerance)
        pressure, intensity = at.mean_pressure, at.stress_intensity
    except NUMERICAL_FAILURES:
        return None
    return at.evaluation.unknowns / len(state.edges), pressure, intensity, time.process_time() - begun
