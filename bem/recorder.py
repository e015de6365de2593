"""Points of a path as the states, events and fields of its record.

Fields are computed at the targets that ask for them, by modules that are imported only then.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bem.certified_states import (
    complete_state,
    equilibrium_state,
    event_of,
    jump_end,
    missed_state,
    separated_state,
    tension_of,
)
from bem.geometry.patches import PatchPressure
from bem.geometry.scaling import ATOMIC
from bem.loading.complete_contact import CompleteContact
from bem.loading.loading_path import LoadingPath
from bem.loading.path_events import PathEvent
from bem.missed import EnergyGainedError
from bem.problem import Problem
from bem.record import Record
from bem.scene.result import Caution, JumpEnd, asked_for
from bem.scene.scene import Scene
from bem.scene.scene_tables import OUTPUTS
from bem.scene.state import Branch, State, Status

if TYPE_CHECKING:
    from bem.elastic.collocation import Evaluation
    from bem.geometry.arrays import FloatArray
    from bem.nonadhesive.convex_path import ConvexPoint
    from bem.nonadhesive.gap_series import GapEvaluation
    from bem.path.points_with_edges import Point

    AnyPoint = Point | ConvexPoint

TENSION = "interior_tension"  # subject of a warning
MOST_AT_ENDS = 100  # format: patches at an end of a jump that is stored; of more, its neighbours on the path are stored


@dataclass(frozen=True, eq=False)
class Recorder:
    """Recorder of points of a path as states, events and fields.

    Parameters
    ----------
    scene, problem, complete, path
        Scene, its problem, its complete contact, and its path.
    record : Record
        Record that receives states, events and fields.
    on_state : callable or None
        Called with the record whenever an entry is added.
    """

    scene: Scene
    problem: Problem
    complete: CompleteContact
    path: LoadingPath[Any, Any]
    record: Record
    on_state: Callable[[Record], None] | None

    def note(
        self, events: tuple[PathEvent, ...], before: AnyPoint | None = None, after: AnyPoint | None = None
    ) -> None:
        """Add events between two points to the next state; the first one has the ends of the jump, if it is one.

        Raises
        ------
        EnergyGainedError
            An event gains energy, beyond its error.
        """
        converted = [event_of(self.problem, event) for event in events]
        if events and before is not None and after is not None:
            start, arrival = self._ends(events[0], before, after)
            converted[0] = replace(converted[0], before=start, after=arrival)
        for event in converted:
            released, error = event.energy_released, event.error_estimate.energy_released
            if released is not None and error is not None and released < -error:
                at = f"{event.kind} at a penetration of {event.penetration:.9g} m"
                raise EnergyGainedError(f"{at} releases {released:.3g} +- {error:.1g} J/m^2")
            self.record.pending_events.append(event)

    def _ends(self, event: PathEvent, before: Any, after: Any) -> tuple[JumpEnd | None, JumpEnd | None]:
        """Return the points before and after a jump; None where nothing jumps, or for too many patches."""
        problem, jumps = self.problem, self.path.has_history and (before.last or before.state is None)
        patches = [None if point.state is None else point.patches for point in (before, after)] if jumps else []
        if not jumps or any(each is not None and each.count > MOST_AT_ENDS for each in patches):
            return None, None
        deepest = problem.profile.max_height
        if after.status == "complete_contact":
            penetration, load = deepest, problem.control.load(deepest, after.value)
        elif after.state is None:
            penetration, load = self._penetration_of(after), 0.0
        else:
            penetration, load = after.state.penetration, after.load
        start = jump_end(problem, before.status, patches[0], event.at.penetration, event.at.load)
        return start, jump_end(problem, after.status, patches[1], penetration, load)

    def keep(self, point: AnyPoint, branch: Branch, index: int | None = None) -> State:
        """Add a refined point as a state, assessed and certified if it has edges; `index` is that of its target."""
        target = index is not None
        state, fields = self._described(point, target), self._fields(point, index)
        tension = tension_of(self.problem, self.path.largest_tension)
        state = self.record.add(state, fields, tension, branch=branch, target=target, index=index, **self._cost())
        self._tell()
        return state

    def miss(self, index: int, status: Status, reason: str, branch: Branch) -> None:
        """Add the row of a target that was not met."""
        control, value = asked_for(self.record.begun.scene["loading"], index)
        state = missed_state(control, value, status, reason, separated_state(self.problem, 0.0))
        tension = tension_of(self.problem, self.path.largest_tension)
        self.record.miss(state, tension, branch=branch, target=True, index=index, **self._cost())
        self._tell()

    def _tell(self) -> None:
        if self.on_state is not None:
            self.on_state(self.record)

    def target_of(self, point: AnyPoint) -> float:
        """Return the controlled quantity of a point, SI."""
        if self.scene.loading.control == "mean_pressure":
            return self.problem.mean_pressure(point.value)
        if self.scene.loading.control == "separation":
            return self.problem.surface.max_height - point.value * self.problem.scales.height
        return point.value * self.problem.scales.height

    def _described(self, point: AnyPoint, target: bool) -> State:
        """Return a point as a state."""
        if point.status == "complete_contact":
            load = self.problem.control.load(self.problem.profile.max_height, point.value)
            return complete_state(self.problem, self.complete, load)
        if point.state is None:
            return separated_state(self.problem, self._penetration_of(point))
        assessment = self.path.assess(point)
        if assessment.work is not None:
            self._warn_of_tension(point.state, assessment.work)
        return equilibrium_state(self.problem, point.state, assessment, self.scene.accuracy.tolerance, target)

    def _warn_of_tension(self, state: Evaluation | GapEvaluation, work: FloatArray) -> None:
        """Warn once where the tension inside the contact would open it at a flaw of atomic size."""
        tension, record, scales = import_module("bem.adhesive.interior_tension"), self.record, self.problem.scales
        warned = [*record.pending_warnings, *(caution for entry in record.entries for caution in entry.warnings)]
        if any(caution.about == TENSION for caution in warned):
            return
        flaw = ATOMIC / scales.length
        largest, opening = tension.largest_tension(state.pressure(), flaw), tension.opening_tension(work, flaw)
        if largest > opening:
            told = f"at a penetration of {state.penetration * scales.height:.4g} m the tension inside the contact is "
            told += f"{largest * scales.stress:.3g} Pa; {opening * scales.stress:.3g} Pa open a flaw of "
            told += f"{ATOMIC:g} m, the distance of atoms. The path holds it closed: bem/README.md, section 10"
            record.pending_warnings.append(Caution(TENSION, told))

    def _cost(self) -> dict[str, Any]:
        """Return evaluations and CPU seconds since the last entry."""
        effort = self.path.effort
        evaluations, cpu = effort.evaluations, time.process_time() + effort.cpu_elsewhere
        cost = {"evaluations": evaluations - self.record.evaluations, "cpu_seconds": cpu - self.record.cpu}
        self.record.evaluations, self.record.cpu = evaluations, cpu
        return cost

    def _fields(self, point: AnyPoint, index: int | None) -> dict[str, NDArray[Any]]:
        """Return the arrays asked for at a target; the modules that compute them are imported only then."""
        wanted = [name for name in OUTPUTS if index is not None and self.scene.wants(name, index)]
        if not wanted:
            return {}
        stored = import_module("bem.stored_fields")
        state, k = point.state, self.record.stored
        fields: dict[str, NDArray[Any]]
        if point.status == "complete_contact":
            load = point.value if self.scene.loading.control == "mean_pressure" else self.complete.least_load
            fields = stored.complete_contact_fields(wanted, self.problem, self.complete, load, k)
        else:
            pressure = PatchPressure(np.empty(0), np.empty(0), ()) if state is None else state.pressure()
            depth = self._penetration_of(point) if state is None else state.penetration
            fields = stored.contact_fields(wanted, self.problem, pressure, depth, k)
        return fields

    def _penetration_of(self, point: AnyPoint) -> float:
        """Return the penetration of surfaces that are apart."""
        return 0.0 if self.scene.loading.control == "mean_pressure" else min(point.value, 0.0)
