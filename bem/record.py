"""What a run keeps: states, assessed and certified, events and fields, as a result at any time.

Every state counts what was spent since the last one.  Fields are computed at the targets that ask for them, by modules
that are imported only then.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bem.geometry.patches import PatchPressure
from bem.loading.complete_contact import CompleteContact
from bem.loading.loading_path import LoadingPath
from bem.loading.path_events import PathEvent
from bem.problem import Problem
from bem.scene.effects import effects_of
from bem.scene.plausibility import cautions_of, groups_of, pressure_groups
from bem.scene.result import Caution, Effect, EnergyGainedError, Event, Result, State
from bem.scene.result_file import provenance
from bem.scene.scene import Scene
from bem.scene.scene_tables import OUTPUTS
from bem.states import Cost, Place, complete_state, equilibrium_state, event_of, separated_state

if TYPE_CHECKING:
    from bem.continuation.points_with_edges import Point
    from bem.elastic.collocation import Evaluation
    from bem.geometry.arrays import FloatArray
    from bem.nonadhesive.convex_path import ConvexPoint
    from bem.nonadhesive.gap_series import GapEvaluation

    AnyPoint = Point | ConvexPoint

TENSION = "interior_tension"  # what a warning is about


@dataclass
class Record:
    """What has been found so far."""

    scene: Scene
    states: list[State] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    fields: dict[str, NDArray[Any]] = field(default_factory=dict)
    shapes: int = 0
    evaluations: int = 0
    cpu: float = field(default_factory=time.process_time)
    groups: dict[str, float] = field(init=False)
    warnings: tuple[Caution, ...] = field(init=False)
    preparation: tuple[dict[str, Any], ...] = field(init=False)
    effects: tuple[Effect, ...] = field(init=False)

    def __post_init__(self) -> None:
        self.groups = groups_of(self.scene)
        self.warnings = cautions_of(self.scene, self.groups)
        self.preparation = self.scene.preparation()
        self.effects = effects_of(self.scene)
        if self.scene.scan is not None:
            self.fields |= self.scene.scan.drawn()

    def result(self, status: str, failure: str | None = None) -> Result:
        """All of it."""
        resolved = self.scene.resolved()
        return Result(
            scene=resolved,
            effects=self.effects,
            provenance=provenance(resolved),
            states=tuple(self.states),
            events=tuple(self.events),
            status=status,
            fields=dict(self.fields),
            failure=failure,
            groups=self.groups | pressure_groups(self.groups, self.states),
            warnings=self.warnings,
            profile_preparation=self.preparation,
        )


@dataclass(frozen=True, eq=False)
class Recorder:
    """Turns the points of a path into what is kept of them.

    Parameters
    ----------
    scene, problem, complete, path
        What is solved.
    record : Record
        To which states, events and fields are added.
    on_state : callable or None
        Called with all that is kept so far, as an interrupted result, whenever a state is added.
    """

    scene: Scene
    problem: Problem
    complete: CompleteContact
    path: LoadingPath[Any, Any]
    record: Record
    on_state: Callable[[Result], None] | None

    def note(self, events: tuple[PathEvent, ...]) -> None:
        """Keep events.

        Raises
        ------
        EnergyGainedError
            One of them releases less than no energy, beyond its error; it is kept.
        """
        for event in [event_of(self.problem, event) for event in events]:
            self.record.events.append(event)
            released, error = event.energy_released, event.error_estimate.energy_released
            if released is not None and error is not None and released < -error:
                at = f"{event.kind} at a penetration of {event.penetration:.9g} m"
                raise EnergyGainedError(f"{at} releases {released:.3g} +- {error:.1g} J/m^2")

    def keep(self, point: AnyPoint, branch: str, target: bool, status: str | None = None) -> None:
        """Keep a refined point as a state: assessed and certified where it has edges."""
        state = replace(self._described(point, branch, target, status), events=len(self.record.events))
        self.record.states.append(state)
        if target:
            self._store_fields(point)
        if self.on_state is not None:
            self.on_state(self.record.result("interrupted"))

    def target_of(self, point: AnyPoint) -> float:
        """The controlled quantity of a point, SI."""
        if self.scene.loading.control == "mean_pressure":
            return self.problem.mean_pressure(point.value)
        if self.scene.loading.control == "separation":
            return self.problem.surface.max_height - point.value * self.problem.scales.height
        return point.value * self.problem.scales.height

    def outputs_at(self, target: float) -> list[str]:
        """Fields asked for at a value of the controlled quantity, SI."""
        return [name for name in OUTPUTS if self.scene.wants(name, target)]

    def _described(self, point: AnyPoint, branch: str, target: bool, status: str | None) -> State:
        """A point as a state; `status` is that of surfaces apart, where it is another than that."""
        if point.status == "complete_contact":
            load = self.problem.control.load(self.problem.profile.max_height, point.value)
            return complete_state(self.problem, self.complete, load, Place(branch, target, self._cost(0)))
        if point.state is None:
            place = Place(branch, target, self._cost(0))
            return separated_state(self.problem, self._penetration_of(point), status or "separated", place)
        assessment = self.path.assess(point)
        if assessment.work is not None:
            self._warn_of_tension(point.state, assessment.work)
        place = Place(branch, target, self._cost(point.state.unknowns))
        return equilibrium_state(self.problem, point.state, assessment, self.scene.accuracy.tolerance, place)

    def _warn_of_tension(self, state: Evaluation | GapEvaluation, work: FloatArray) -> None:
        """Once, where the tension inside the contact would open it at a flaw of atomic size."""
        tension, record, scales = import_module("bem.adhesive.interior_tension"), self.record, self.problem.scales
        if any(caution.about == TENSION for caution in record.warnings):
            return
        flaw = tension.ATOMIC / scales.length
        largest, opening = tension.largest_tension(state.pressure(), flaw), tension.opening_tension(work, flaw)
        if largest > opening:
            told = f"at a penetration of {state.penetration * scales.height:.4g} m the tension inside the contact is "
            told += f"{largest * scales.stress:.3g} Pa; {opening * scales.stress:.3g} Pa open a flaw of "
            told += f"{tension.ATOMIC:g} m, the distance of atoms. The path holds it closed: bem/README.md, section 10"
            record.warnings = (*record.warnings, Caution(TENSION, told))

    def _cost(self, unknowns: int) -> Cost:
        """Evaluations and CPU seconds since the last state."""
        evaluations, cpu = self.path.effort.evaluations, time.process_time()
        cost = Cost(unknowns, evaluations - self.record.evaluations, cpu - self.record.cpu)
        self.record.evaluations, self.record.cpu = evaluations, cpu
        return cost

    def _store_fields(self, point: AnyPoint) -> None:
        """Fields asked for at this target; the modules that compute them are imported only then."""
        wanted = self.outputs_at(self.target_of(point))
        if not wanted:
            return
        observables = import_module("bem.observables.observables")
        record, state = self.record, point.state
        if point.status == "complete_contact":
            load = point.value if self.scene.loading.control == "mean_pressure" else self.complete.least_load
            stored = observables.complete_contact_fields(wanted, self.problem, self.complete, load, record.shapes)
        else:
            pressure = PatchPressure(np.empty(0), np.empty(0), ()) if state is None else state.pressure()
            depth = self._penetration_of(point) if state is None else state.penetration
            stored = observables.contact_fields(wanted, self.problem, pressure, depth, record.shapes)
        record.fields.update(stored)
        record.shapes += 1

    def _penetration_of(self, point: AnyPoint) -> float:
        """Penetration of surfaces that are apart."""
        return 0.0 if self.scene.loading.control == "mean_pressure" else min(point.value, 0.0)
