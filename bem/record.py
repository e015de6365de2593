"""Growing result of a run: states with certificates, passed or failed, with events and fields.

A state is added at once with the events on the way to it and its fields, or not at all: an interrupt leaves nothing
half done.  Every state has the cost since the state before.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bem.certified_states import not_below_rounding
from bem.missed import uncertified
from bem.scene.array_names import split
from bem.scene.effects import effects_of
from bem.scene.plausibility import cautions_of, groups_of
from bem.scene.provenance import provenance
from bem.scene.result import Caution, Entry, Event, LargestTension, Result
from bem.scene.result_invariants import judged
from bem.scene.scene import Scene
from bem.scene.state import Ending, State

if TYPE_CHECKING:
    from bem.nonadhesive.convex_path import ConvexPoint
    from bem.path.points_with_edges import Point

    AnyPoint = Point | ConvexPoint

BETWEEN = "states"  # subject of a warning


@dataclass
class Record:
    """Growing result of a run: an entry for each stored state or missed target.

    Attributes
    ----------
    begun : Result
        Result without states: scene, effects, provenance, groups and warnings of the scene.
    entries : list of Entry
        In the order of the path.
    pending_events, pending_warnings : list of Event, list of Caution
        Events and warnings since the last entry; `add` moves both into the new entry.
    evaluations, cpu
        Totals up to the last entry.
    """

    scene: Scene
    entries: list[Entry] = field(default_factory=list)
    pending_events: list[Event] = field(default_factory=list)
    pending_warnings: list[Caution] = field(default_factory=list)
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
        """States of the entries."""
        return [entry.state for entry in self.entries]

    def add(
        self, state: State, fields: dict[str, NDArray[Any]], tension: LargestTension | None = None, **place: Any
    ) -> State:
        """Add a state with its fields and the events on the way to it; return it as stored.

        `place` has its other attributes: branch, target, index, evaluations, cpu_seconds.
        """
        events, stored = self._events + len(self.pending_events), self.stored if fields else None
        state = not_below_rounding(replace(state, events=events, stored=stored, **place))
        if not (state.target or state.certificate.ok):
            told = f"a state between targets is not certified, {uncertified(state)}; the run is judged by its targets"
            self.pending_warnings.append(Caution(BETWEEN, told))
        if not state.target:
            state = replace(state, peak_pressure=None, largest_gap=None, gaps=None)
        self.entries.append(Entry(tuple(self.pending_events), state, fields, tuple(self.pending_warnings), tension))
        self.pending_events, self.pending_warnings = [], []
        return state

    def miss(self, state: State, tension: LargestTension | None = None, **place: Any) -> None:
        """Add the row of a target that was not met; the next state takes the events ahead."""
        self.entries.append(Entry((), replace(state, events=self._events, **place), tension=tension))

    @property
    def stored(self) -> int:
        """Number of states with fields."""
        return sum(state.stored is not None for state in self.states)

    @property
    def _events(self) -> int:
        """Number of events of all entries."""
        return self.entries[-1].state.events if self.entries else 0

    def result(self, status: Ending, failure: str | None = None) -> Result:
        """Return the result of all entries; one that contradicts itself is `not_converged`, with all its states."""
        return judged(replace(self.begun.with_entries(self.entries), status=status, failure=failure))


def entries_of(result: Result, begun: Result) -> Iterator[Entry]:
    """Yield the entries of an interrupted result, up to a state whose arrays are missing.

    Parameters
    ----------
    result : Result
    begun : Result
        Result of the scene without states.
    """
    before, tension = 0, result.largest_tension
    warnings = tuple(warning for warning in result.warnings if warning not in begun.warnings)
    shared = {name: values for name, values in result.fields.items() if not split(name)[1] and name not in begun.fields}
    for state in result.states:
        own = {name: values for name, values in result.fields.items() if split(name)[1] == str(state.stored)}
        if state.stored is not None and not own:
            return
        yield Entry(result.events[before : state.events], state, own | shared if own else {}, warnings, tension)
        before, warnings, tension = state.events, (), None


def _lines(scene: Scene) -> dict[str, NDArray[Any]]:
    """Return the harmonics of the prepared profile of a scan, which its file alone does not give."""
    surface = scene.surface()
    ascending = np.argsort(surface.orders)
    wavenumbers = 2 * np.pi / surface.period * surface.orders[ascending]
    waves = (surface.amplitudes * np.exp(1j * surface.phases))[ascending]
    return {"profile_q": wavenumbers, "profile_amplitude": np.abs(waves), "profile_phase": np.angle(waves)}
