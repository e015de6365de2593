"""Result of a loading path: states, events, warnings, largest tension and arrays, with what was solved.

Units: m, Pa, J/m^2 of nominal area.  A number that does not exist is NaN, and null in files.  state.py has the states,
result_invariants.py what holds in every result, result_file.py and journal.py the files.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal

from numpy.typing import NDArray
from pydantic import PlainSerializer, PlainValidator

from bem.scene.result_views import Views
from bem.scene.state import Bound, Ending, FinalStatus, MaybeNan, Quantity, State
from bem.scene.stored_arrays import decoded, encoded

EventKind = Literal[
    "first_touch", "new_contact", "coalescence", "detachment", "pull_off", "complete_contact", "opening", "bifurcation"
]
Arrays = Annotated[dict[str, NDArray[Any]], PlainValidator(decoded), PlainSerializer(encoded)]  # base64 of an npz file


@dataclass(frozen=True)
class Effect:
    """Effect of the vocabulary: whether it is active in a scene, and why; `seconds` is null, as no run measures it."""

    name: str
    active: bool
    reason: str
    seconds: Quantity | None = None


@dataclass(frozen=True)
class Caution:
    """Warning: the key, group or state concerned, and the probable cause."""

    about: str
    message: str


@dataclass(frozen=True)
class EventError:
    """Estimated absolute error of the numbers of an event, in their units."""

    penetration: Bound
    mean_pressure: Bound | None
    energy_released: Bound | None


@dataclass(frozen=True)
class JumpEnd:
    """State at one end of a jump, located by the path but not certified: penetration and edges in m, pressure in Pa."""

    status: FinalStatus
    penetration: Quantity
    mean_pressure: MaybeNan
    edges: tuple[tuple[Quantity, Quantity], ...] = ()


@dataclass(frozen=True)
class Event:
    """Change of topology or stability; `position` in m, `energy_released` in J/m^2; kinds: bem/README.md, section 5.

    Penetration and mean pressure are those of the equilibrium from which the contact jumps.  The pressure is NaN
    where the last gap closes, or the first opens, under a given separation: the tension there has no
    bound.  The first event of an avalanche holds all of the energy released, later ones 0; the energy is None if the
    surfaces part under a held load.  The first holds `before` and `after` too, the states at the ends of the jump;
    both are None where nothing jumps, or where more than 100 patches touch.
    """

    kind: EventKind
    penetration: Quantity
    mean_pressure: MaybeNan
    position: Quantity | None
    energy_released: Quantity | None
    error_estimate: EventError
    before: JumpEnd | None = None
    after: JumpEnd | None = None


@dataclass(frozen=True)
class TensionError:
    """Bound on the error of the largest tension, Pa."""

    mean_pressure: Bound


@dataclass(frozen=True)
class LargestTension:
    """Least mean pressure on unloading, with its place on the path.

    Candidates are the turns of the load (dP/dDelta = 0 on a branch), folds, and both sides of jumps, each located
    like an event.  A stored state is no candidate of its own.  The path provides the numbers as
    `LoadingPath.largest_tension`, a `bem.loading.path_events.PathTension` in the units of the path; certified_states.py
    converts them once.

    Attributes
    ----------
    mean_pressure : float
        Pa, negative.
    penetration, separation : float
        m.
    kind : {"turn", "fold", "jump"}
    error_estimate : TensionError
    """

    mean_pressure: Quantity
    penetration: Quantity
    separation: Quantity
    kind: Literal["turn", "fold", "jump"]
    error_estimate: TensionError


@dataclass(frozen=True, eq=False)
class Entry:
    """State with the events, warnings and largest tension since the state before, and its arrays, if any."""

    events: tuple[Event, ...]
    state: State
    fields: Arrays = field(default_factory=dict)
    warnings: tuple[Caution, ...] = ()
    tension: LargestTension | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Result(Views):
    """All states and events of a path.

    Parameters
    ----------
    scene : dict
        The resolved scene, `Scene.resolved()`.
    effects : tuple of Effect
    provenance : dict
        See `provenance`.
    states : tuple of State
        In the order visited.
    events : tuple of Event
    status : str
        "converged", "unreachable", "not_converged" or "interrupted".  A path whose contact was pulled off before a
        tension asked for is `unreachable` too: no state carries that tension, and the pull-off is the answer.  Then
        `answered` is true, and the terminal says "unreachable, answered: pulled off".
    fields : dict of arrays
        Contents of fields.npz.
    failure : str, optional
        Why the status is `unreachable` or `not_converged`.
    groups : dict of floats
        The dimensionless groups that decide, and the scales they are made with (plausibility.py).
    warnings : tuple of Caution
    profile_preparation : tuple of dict
        Steps by which the samples of a scan were prepared (bem/scans/prepare_line.py).
    largest_tension : LargestTension, optional
        None where nothing is unloaded, where there is no tension, or where contact stays complete for want of a flaw.
    """

    scene: dict[str, Any]
    effects: tuple[Effect, ...]
    provenance: dict[str, str]
    states: tuple[State, ...]
    events: tuple[Event, ...]
    status: Ending
    fields: Arrays = field(default_factory=dict)
    failure: str | None = None
    groups: dict[str, Quantity] = field(default_factory=dict)
    warnings: tuple[Caution, ...] = ()
    profile_preparation: tuple[dict[str, Any], ...] = ()
    largest_tension: LargestTension | None = None

    def with_entries(self, entries: Iterable[Entry]) -> Result:
        """Return a result with the states, events, warnings and largest tension of entries, and their arrays added."""
        parts = tuple(entries)
        tensions = [entry.tension for entry in parts if entry.tension is not None]
        return replace(
            self,
            states=tuple(entry.state for entry in parts),
            events=tuple(event for entry in parts for event in entry.events),
            fields=self.fields | {name: values for entry in parts for name, values in entry.fields.items()},
            warnings=(*self.warnings, *(warning for entry in parts for warning in entry.warnings)),
            largest_tension=min(tensions, key=lambda tension: tension.mean_pressure, default=None),
        )

    @property
    def targets(self) -> tuple[State, ...]:
        """States at targets, one row each, met or not."""
        return tuple(state for state in self.states if state.target)


def asked_for(loading: Mapping[str, Any], index: int) -> tuple[str, float]:
    """Return the quantity and the value (m or Pa) of the target with an index, of a resolved [loading].

    Examples
    --------
    >>> loading = {"control": "separation", "targets": [2e-6], "at_mean_pressures": [5e4], "stop_at_mean_pressure": 1e5}
    >>> asked_for(loading, 0), asked_for(loading, 2)
    (('separation', 2e-06), ('mean_pressure', 100000.0))
    """
    targets = loading["targets"]
    if index < len(targets):
        return loading["control"], targets[index]
    stop = loading.get("stop_at_mean_pressure")
    pressures = [*loading["at_mean_pressures"], *([] if stop is None else [stop])]
    return "mean_pressure", pressures[index - len(targets)]
