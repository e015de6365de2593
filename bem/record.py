"""What a run keeps: states, assessed and certified, events and fields, as a result at any time.

A state is kept at once with the events on the way to it and its fields, or not at all: an interrupt leaves nothing half
done.  Every state counts what was spent since the last one.  Fields are computed at the targets that ask for them, by
modules that are imported only then.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bem.certified_states import (
    Cost,
    Missed,
    Place,
    complete_state,
    equilibrium_state,
    event_of,
    missed_state,
    separated_state,
)
from bem.geometry.patches import PatchPressure
from bem.geometry.scaling import ATOMIC
from bem.loading.complete_contact import CompleteContact
from bem.loading.loading_path import LoadingPath
from bem.loading.path_events import PathEvent
from bem.problem import Problem
from bem.scene.effects import effects_of
from bem.scene.plausibility import cautions_of, groups_of, pressure_groups
from bem.scene.result import Caution, EnergyGainedError, Entry, Event, Result, State
from bem.scene.result_file import provenance
from bem.scene.scene import Scene
from bem.scene.scene_tables import OUTPUTS

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
    """What has been found so far.

    Attributes
    ----------
    begun : Result
        What all states share.
    entries : list of Entry
        What is kept, in the order found.
    ahead, warned : list of Event, list of Caution
        Events and warnings since the last entry: they are kept with the next one.
    shapes : int
        Entries with fields.
    evaluations, cpu
        Counted up to the last state.
    """

    scene: Scene
    entries: list[Entry] = field(default_factory=list)
    ahead: list[Event] = field(default_factory=list)
    warned: list[Caution] = field(default_factory=list)
    shapes: int = 0
    evaluations: int = 0
    cpu: float = field(default_factory=time.process_time)
    begun: Result = field(init=False)

    def __post_init__(self) -> None:
        resolved, groups = self.scene.resolved(), groups_of(self.scene)
        self.begun = Result(
            scene=resolved,
            effects=effects_of(self.scene),
            provenance=provenance(resolved),
            states=(),
            events=(),
            status="interrupted",
            fields={} if self.scene.scan is None else self.scene.scan.drawn() | _lines(self.scene),
            groups=groups,
            warnings=cautions_of(self.scene, groups),
            profile_preparation=self.scene.preparation(),
        )

    @property
    def states(self) -> list[State]:
        """Those kept."""
        return [entry.state for entry in self.entries]

    def add(self, state: State, fields: dict[str, NDArray[Any]]) -> State:
        """Keep a state with its fields and the events on the way to it; the state with the number of events."""
        state = replace(state, events=self._happened + len(self.ahead))
        entry = Entry(tuple(self.ahead), state, fields, tuple(self.warned))
        self.entries.append(entry)
        self.ahead, self.warned, self.shapes = [], [], self.shapes + bool(fields)
        return entry.state

    def miss(self, state: State) -> None:
        """Keep the row of a target that was not met; events ahead are left for the next state."""
        self.entries.append(Entry((), replace(state, events=self._happened)))

    @property
    def _happened(self) -> int:
        """Number of events kept."""
        return (self.entries[-1].state.events or 0) if self.entries else 0

    def result(self, status: str, failure: str | None = None) -> Result:
        """All of it."""
        kept = self.begun.with_entries(self.entries)
        groups = kept.groups | pressure_groups(kept.groups, [state for state in kept.states if state.found])
        return replace(kept, status=status, failure=failure, groups=groups)


def entries_of(result: Result, begun: Result, has_fields: Callable[[State], bool]) -> Iterator[Entry]:
    """The entries that an interrupted result is made of, up to one that is not complete.

    Parameters
    ----------
    result : Result
    begun : Result
        What all its states share.
    has_fields : callable
        Whether fields belong to a state; they may be missing from a result that was kept without them.
    """
    before, shape = 0, 0
    warnings = tuple(warning for warning in result.warnings if warning not in begun.warnings)
    shared = {name: values for name, values in result.fields.items() if not _index(name) and name not in begun.fields}
    for state in result.states:
        wanted = has_fields(state)
        own = {name: values for name, values in result.fields.items() if wanted and _index(name) == str(shape)}
        if state.events is None or (wanted and not own):
            return
        yield Entry(result.events[before : state.events], state, own | shared if wanted else {}, warnings)
        before, shape, warnings = state.events, shape + wanted, ()


def _lines(scene: Scene) -> dict[str, NDArray[Any]]:
    """The lines of the profile of a scan as it is solved: what its file alone does not say."""
    surface = scene.surface()
    ascending = np.argsort(surface.orders)
    wavenumbers = 2 * np.pi / surface.period * surface.orders[ascending]
    return {"profile_q": wavenumbers, "profile_amplitude": np.abs(surface.amplitudes[ascending])}


def _index(name: str) -> str:
    """The index of the stored state that the name of an array ends in, or nothing."""
    index = name.rpartition("_")[2]
    return index if index.isdigit() else ""


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
        Called with the record whenever an entry is added.
    """

    scene: Scene
    problem: Problem
    complete: CompleteContact
    path: LoadingPath[Any, Any]
    record: Record
    on_state: Callable[[Record], None] | None

    def note(self, events: tuple[PathEvent, ...]) -> None:
        """Keep events, with the next state.

        Raises
        ------
        EnergyGainedError
            One of them releases less than no energy, beyond its error.
        """
        for event in [event_of(self.problem, event) for event in events]:
            released, error = event.energy_released, event.error_estimate.energy_released
            if released is not None and error is not None and released < -error:
                at = f"{event.kind} at a penetration of {event.penetration:.9g} m"
                raise EnergyGainedError(f"{at} releases {released:.3g} +- {error:.1g} J/m^2")
            self.record.ahead.append(event)

    def keep(self, point: AnyPoint, branch: str, target: bool) -> State:
        """Keep a refined point as a state: assessed and certified where it has edges."""
        state = self.record.add(self._described(point, branch, target), self._fields(point) if target else {})
        self._tell()
        return state

    def miss(self, missed: Missed, branch: str) -> None:
        """Keep the row of a target that was not met."""
        place = Place(branch, True, self._cost(0))
        if missed.status == "unreachable" and missed.control == "mean_pressure":
            apart = separated_state(self.problem, 0.0, missed.status, place)
            self.record.miss(replace(apart, certificate=replace(apart.certificate, reasons=(missed.reason,))))
        else:
            self.record.miss(missed_state(missed, place))
        self._tell()

    def _tell(self) -> None:
        if self.on_state is not None:
            self.on_state(self.record)

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

    def _described(self, point: AnyPoint, branch: str, target: bool) -> State:
        """A point as a state."""
        if point.status == "complete_contact":
            load = self.problem.control.load(self.problem.profile.max_height, point.value)
            return complete_state(self.problem, self.complete, load, Place(branch, target, self._cost(0)))
        if point.state is None:
            place = Place(branch, target, self._cost(0))
            return separated_state(self.problem, self._penetration_of(point), "separated", place)
        assessment = self.path.assess(point)
        if assessment.work is not None:
            self._warn_of_tension(point.state, assessment.work)
        place = Place(branch, target, self._cost(point.state.unknowns))
        return equilibrium_state(self.problem, point.state, assessment, self.scene.accuracy.tolerance, place)

    def _warn_of_tension(self, state: Evaluation | GapEvaluation, work: FloatArray) -> None:
        """Once, where the tension inside the contact would open it at a flaw of atomic size."""
        tension, record, scales = import_module("bem.adhesive.interior_tension"), self.record, self.problem.scales
        if any(caution.about == TENSION for entry in record.entries for caution in entry.warnings):
            return
        flaw = ATOMIC / scales.length
        largest, opening = tension.largest_tension(state.pressure(), flaw), tension.opening_tension(work, flaw)
        if largest > opening:
            told = f"at a penetration of {state.penetration * scales.height:.4g} m the tension inside the contact is "
            told += f"{largest * scales.stress:.3g} Pa; {opening * scales.stress:.3g} Pa open a flaw of "
            told += f"{ATOMIC:g} m, the distance of atoms. The path holds it closed: bem/README.md, section 10"
            record.warned = [Caution(TENSION, told)]

    def _cost(self, unknowns: int) -> Cost:
        """Evaluations and CPU seconds since the last state."""
        effort = self.path.effort
        evaluations, cpu = effort.evaluations, time.process_time() + effort.cpu_elsewhere
        cost = Cost(unknowns, evaluations - self.record.evaluations, cpu - self.record.cpu)
        self.record.evaluations, self.record.cpu = evaluations, cpu
        return cost

    def _fields(self, point: AnyPoint) -> dict[str, NDArray[Any]]:
        """Fields asked for at this target; the modules that compute them are imported only then."""
        wanted = self.outputs_at(self.target_of(point))
        if not wanted:
            return {}
        observables = import_module("bem.observables.observables")
        state, index = point.state, self.record.shapes
        found: dict[str, NDArray[Any]]
        if point.status == "complete_contact":
            load = point.value if self.scene.loading.control == "mean_pressure" else self.complete.least_load
            found = observables.complete_contact_fields(wanted, self.problem, self.complete, load, index)
        else:
            pressure = PatchPressure(np.empty(0), np.empty(0), ()) if state is None else state.pressure()
            depth = self._penetration_of(point) if state is None else state.penetration
            found = observables.contact_fields(wanted, self.problem, pressure, depth, index)
        return found

    def _penetration_of(self, point: AnyPoint) -> float:
        """Penetration of surfaces that are apart."""
        return 0.0 if self.scene.loading.control == "mean_pressure" else min(point.value, 0.0)
