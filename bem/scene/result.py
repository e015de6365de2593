"""States, events and results of a loading path, with the meaning and the unit of every number.

Units: m, Pa, J/m^2 of nominal area, Pa m^1/2, Pa/m, s.  A `Number` is NaN where none exists; files hold null there.
The files: result_file.py.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, Literal, get_args

from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, PlainValidator

from bem.audit.certificate import Certificate
from bem.scene.result_views import Views

Branch = Literal["loading", "unloading"]
FinalStatus = Literal["converged", "separated", "complete_contact"]
Status = Literal[FinalStatus, "unreachable", "not_converged", "interrupted"]
EventKind = Literal[
    "first_touch",
    "new_contact",
    "coalescence",
    "detachment",
    "pull_off",
    "complete_contact",
    "opening",
    "bifurcation",
]
FINAL_STATUSES: tuple[str, ...] = get_args(FinalStatus)
STATUSES: tuple[str, ...] = get_args(Status)


def _nan_of_null(value: Any) -> Any:
    return math.nan if value is None else value


Number = Annotated[float, BeforeValidator(_nan_of_null)]


class NotFiniteError(ArithmeticError, ValueError):
    """Error of a state with a number that is NaN or infinite: such a state does not exist."""


class EnergyGainedError(ArithmeticError):
    """Error of a jump that gains energy beyond its error: an earlier event was missed, or its end cannot be reached."""


UNPHYSICAL = NotFiniteError, EnergyGainedError


@dataclass(frozen=True)
class Effect:
    """Effect of the vocabulary: whether it is active in a scene, and why; `seconds` is null, as no run measures it."""

    name: str
    active: bool
    reason: str
    seconds: float | None = None


@dataclass(frozen=True)
class Caution:
    """Warning: the key, group or state concerned, and the probable cause."""

    about: str
    message: str


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated absolute error of every number a state reports, in the unit of that number; None: not estimated."""

    mean_pressure: float | None = None
    contact_fraction: float | None = None
    penetration: float | None = None
    separation: float | None = None
    total_displacement: float | None = None
    elastic_energy: float | None = None
    adhesion_energy: float | None = None
    total_energy: float | None = None
    stress_intensity_max: float | None = None
    contact_stiffness: float | None = None


@dataclass(frozen=True)
class GapQuantiles:
    """Heights below which the gap lies on 10, 25, 50, 75 and 90 % of the open length, m."""

    p10: float
    p25: float
    p50: float
    p75: float
    p90: float


@dataclass(frozen=True)
class Gaps:
    """Gap between the surfaces at a target, m (bem/observables/gaps.py).

    Attributes
    ----------
    mean_open : float
        Mean over the open length: the separation over `open_fraction`.
    mean_cubic_root : float
        Cubic root of the mean of g^3 over the period: the flow along the ridges is that of a channel of this height.
    quantiles : GapQuantiles
    widest_channel : float
        Widest interval without contact; the period where the surfaces are apart.
    open_fraction : float
        Share of the period that is open.
    """

    mean_open: float
    mean_cubic_root: float
    quantiles: GapQuantiles
    widest_channel: float
    open_fraction: float


CLOSED = Gaps(0.0, 0.0, GapQuantiles(0.0, 0.0, 0.0, 0.0, 0.0), 0.0, 0.0)


@dataclass(frozen=True, repr=False, kw_only=True)
class State:
    """Equilibrium on the path; energies in J/m^2 of nominal area, edges in m, `contact_stiffness` in Pa/m.

    The defaults are those of surfaces apart.  Every number is finite, with two exceptions.  An estimated error is
    infinite where the corrected edges overlap.  `mean_pressure` is NaN where any pressure would do: in complete contact
    under a prescribed separation.  `total_displacement` is None there on a compressible layer.

    A target that was not met has a row too, with status `unreachable` or `not_converged`, and `certificate.reasons`
    say why.  Its numbers are those of surfaces apart where no contact carries the tension asked for; elsewhere the
    quantity under control is a number, and all others are NaN.

    Attributes
    ----------
    target : bool
        Whether the scene asks for this state.
    index : int or None
        Index of the target: in loading.targets, then in loading.at_mean_pressures, then stop_at_mean_pressure
        (`asked_for`).  None between targets.
    stored : int or None
        The k of its arrays x_k, ... in fields.npz; None where none are stored.
    events : int
        Number of events up to this state.
    peak_pressure, largest_gap : float or None
        Pa and m, of samples of pressure and gap; known at targets alone.  There is no peak without contact.
    gaps : Gaps or None
        Known at targets alone.
    unknowns, evaluations, cpu_seconds
        Unknowns of the system; evaluations and CPU seconds since the state before.

    Raises
    ------
    NotFiniteError
        Another number is NaN or infinite.
    """

    branch: Branch = "loading"
    target: bool = False
    index: int | None = None
    status: Status
    penetration: Number
    separation: Number
    total_displacement: float | None = None
    mean_pressure: Number = 0.0
    contact_fraction: Number = 0.0
    n_patches: int = 0
    edges: tuple[tuple[float, float], ...] = ()
    elastic_energy: Number = 0.0
    adhesion_energy: Number = 0.0
    total_energy: Number = 0.0
    stress_intensity_max: float | None = None
    contact_stiffness: float | None = None
    stable_at_fixed_load: bool | None = None
    peak_pressure: float | None = None
    largest_gap: float | None = None
    gaps: Gaps | None = None
    error_estimate: ErrorEstimate = field(default_factory=ErrorEstimate)
    certificate: Certificate = field(default_factory=Certificate)
    events: int = 0
    stored: int | None = None
    unknowns: int = 0
    evaluations: int = 0
    cpu_seconds: float = 0.0

    def __repr__(self) -> str:
        if not self.found:
            return f"<State {self.status}: {'; '.join(self.certificate.reasons)}>"
        judged = "certified" if self.certificate.ok else "not certified"
        return (
            f"<State {self.status} ({self.branch}): separation {self.separation:.6g} m, {self.mean_pressure:.6g} Pa, "
            f"contact fraction {self.contact_fraction:.6g}, patches {self.n_patches}, {judged}>"
        )

    @property
    def found(self) -> bool:
        """Existence of the state: False in the row of a target that was not met."""
        return self.status != "unreachable" and not math.isnan(self.contact_fraction)

    def __post_init__(self) -> None:
        unknown = math.isnan(self.contact_fraction) and not self.edges
        if unknown and self.status in ("unreachable", "not_converged"):
            return
        numbers = {name: value for name, value in vars(self).items() if isinstance(value, float)}
        if self.status in ("complete_contact", "unreachable") and math.isnan(self.mean_pressure):
            del numbers["mean_pressure"]
        numbers |= {f"edges[{i}]": a + b for i, (a, b) in enumerate(self.edges)}
        numbers |= {f"certificate.{name}": value for name, value in vars(self.certificate).items()}
        for name, value in numbers.items():
            if isinstance(value, float) and not math.isfinite(value):
                raise NotFiniteError(f"{name} is {value}")
        for name, value in vars(self.error_estimate).items():
            if value is not None and math.isnan(value):
                raise NotFiniteError(f"error_estimate.{name} is {value}")


@dataclass(frozen=True)
class EventError:
    """Estimated absolute error of the numbers of an event, in their units."""

    penetration: float
    mean_pressure: float | None
    energy_released: float | None


@dataclass(frozen=True)
class JumpEnd:
    """State at one end of a jump, located by the path but not certified: penetration and edges in m, pressure in Pa."""

    status: FinalStatus
    penetration: float
    mean_pressure: Number
    edges: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True)
class Event:
    """Change of topology or stability; `position` in m, `energy_released` in J/m^2; kinds: bem/README.md, section 5.

    Penetration and mean pressure are those of the equilibrium from which the contact jumps.  The pressure is NaN
    where the last gap closes, or the first opens, under a given separation: the tension there has no
    bound.  The energy of an avalanche stands with its first event; it is None if the surfaces part under a held load.
    So do the states `before` and `after` the jump, if at most 100 patches touch; both are None where nothing jumps.
    """

    kind: EventKind
    penetration: float
    mean_pressure: Number
    position: float | None
    energy_released: float | None
    error_estimate: EventError
    before: JumpEnd | None = None
    after: JumpEnd | None = None


@dataclass(frozen=True)
class TensionError:
    """Bound on the error of the largest tension, Pa."""

    mean_pressure: float


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

    mean_pressure: float
    penetration: float
    separation: float
    kind: Literal["turn", "fold", "jump"]
    error_estimate: TensionError


@dataclass(frozen=True, eq=False)
class Entry:
    """State with the events, warnings and largest tension since the state before, and its arrays, if any."""

    events: tuple[Event, ...]
    state: State
    fields: dict[str, NDArray[Any]] = field(default_factory=dict)
    warnings: tuple[Caution, ...] = ()
    tension: LargestTension | None = None


@dataclass(frozen=True)
class Progress:
    """Progress of a solution; pressure in Pa, `target_index` counts from 0, `value` is the value of the control."""

    mean_pressure: float
    contact_fraction: float
    n_patches: int
    increments_accepted: int
    increments_rejected: int
    evaluations: int
    target_index: int
    n_targets: int
    value: float = math.nan


def _refused(value: Any) -> Any:
    raise ValueError("arrays are not stored here but in fields.npz")


Arrays = Annotated[dict[str, NDArray[Any]], Field(exclude=True), PlainValidator(_refused)]


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
        One of `STATUSES`.
    fields : dict of arrays
        Contents of fields.npz.
    failure : str, optional
        Why the status is `unreachable` or `not_converged`.
    groups : dict of floats
        The dimensionless groups that decide, and the scales they are made with (plausibility.py).
    warnings : tuple of Caution
    profile_preparation : tuple of dict
        Steps by which the samples of a scan were prepared (bem/scans/prepare_scan.py).
    largest_tension : LargestTension, optional
        None where nothing is unloaded, where there is no tension, or where contact stays complete for want of a flaw.
    """

    scene: dict[str, Any]
    effects: tuple[Effect, ...]
    provenance: dict[str, Any]
    states: tuple[State, ...]
    events: tuple[Event, ...]
    status: Status
    fields: Arrays = field(default_factory=dict)
    failure: str | None = None
    groups: dict[str, Number] = field(default_factory=dict)
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
    def answered(self) -> bool:
        """Success of the scene: it ended as asked, or every target that was not met lies behind a pull-off.

        A tension beyond what the contact carries, asked for on the way out, is answered by the pull-off.
        """
        missed = [state for state in self.states if not state.found]
        pulled = [k for k, event in enumerate(self.events) if event.kind == "pull_off"]
        behind = [state.status == "unreachable" and bool(pulled) and pulled[0] < state.events for state in missed]
        return self.status in FINAL_STATUSES or (self.status == "unreachable" and any(behind) and all(behind))

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
