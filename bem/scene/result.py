"""States, events and results of a loading path: what every number means, and its unit.

Units: m, Pa, J/m^2 of nominal area, Pa m^1/2, Pa/m, s.  The files that hold them: result_file.py.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

from numpy.typing import NDArray

from bem.audit.certificate import Certificate
from bem.scene.result_views import Views

FINAL_STATUSES = ("converged", "separated", "complete_contact")
STATUSES = (*FINAL_STATUSES, "unreachable", "not_converged", "interrupted")


class NotFiniteError(ArithmeticError):
    """A number of a state came out as NaN or infinite: such a state does not exist."""


class EnergyGainedError(ArithmeticError):
    """A jump gains energy beyond its error: an earlier event was missed, or its end cannot be reached."""


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
    """What is out of the ordinary in a scene: the key or group concerned, and the probable cause."""

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


@dataclass(frozen=True, repr=False)
class State:
    """An equilibrium on the path; energies in J/m^2 of nominal area, edges in m, `contact_stiffness` in Pa/m.

    Every number is finite.  Two may say that none exists: an estimated error is infinite where the corrected edges
    overlap; `mean_pressure` is NaN (null in the file) where any would do, in complete contact under a prescribed
    separation, and where the state asked for does not exist.  `total_displacement` is None there on a compressible
    layer.  `events` is the number of events up to this state; None in results that did not store it.  The status is
    `not_converged` where the certificate is not ok.  `peak_pressure` (Pa) and `largest_gap` (m), of samples
    of pressure and gap, are known at targets alone; there is no peak without contact.

    A target that was not met has its row too, `unreachable` or `not_converged`, and `certificate.reasons` says why.  It
    is that of surfaces apart where no contact carries a tension.  Where no state was found, only the quantity under
    control is a number, and all others are NaN (null in the file).

    Raises
    ------
    NotFiniteError
        Another number is NaN or infinite.
    """

    branch: str
    penetration: float
    separation: float
    total_displacement: float | None
    mean_pressure: float
    contact_fraction: float
    n_patches: int
    edges: tuple[tuple[float, float], ...]
    elastic_energy: float
    adhesion_energy: float
    total_energy: float
    stress_intensity_max: float | None
    contact_stiffness: float | None
    stable_at_fixed_load: bool | None
    error_estimate: ErrorEstimate
    certificate: Certificate
    unknowns: int
    evaluations: int
    cpu_seconds: float
    status: str
    target: bool
    events: int | None = None
    peak_pressure: float | None = None
    largest_gap: float | None = None

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
        """Whether the state was asked for, or passed on the way: not the row of a target that was not met."""
        return self.status != "unreachable" and not math.isnan(self.contact_fraction)

    def __post_init__(self) -> None:
        unknown = math.isnan(self.contact_fraction) and self.target and not self.edges
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
class Event:
    """A change of topology or stability; `position` in m, `energy_released` in J/m^2; kinds: bem/README.md, section 5.

    Penetration and mean pressure are those of the equilibrium from which the contact jumps.  The pressure is NaN (null
    in the file) where the last gap closes, or the first opens, under a given separation: the tension there has no
    bound.  The energy of an avalanche stands with its first event; it is None if the surfaces part under a held load.
    """

    kind: str
    penetration: float
    mean_pressure: float
    position: float | None
    energy_released: float | None
    error_estimate: EventError


@dataclass(frozen=True, eq=False)
class Entry:
    """What a path adds to a result at once: a state, events and warnings since the last one, and fields, if any."""

    events: tuple[Event, ...]
    state: State
    fields: dict[str, NDArray[Any]] = field(default_factory=dict)
    warnings: tuple[Caution, ...] = ()


@dataclass(frozen=True)
class Progress:
    """Where a running solution stands; pressure in Pa, `target_index` counts from 0, `value` is what is controlled."""

    mean_pressure: float
    contact_fraction: float
    n_patches: int
    increments_accepted: int
    increments_rejected: int
    evaluations: int
    target_index: int
    n_targets: int
    value: float = math.nan


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
        What was done to the samples of a scan, step by step (bem/scans/prepare_scan.py).
    """

    scene: dict[str, Any]
    effects: tuple[Effect, ...]
    provenance: dict[str, Any]
    states: tuple[State, ...]
    events: tuple[Event, ...]
    status: str
    fields: dict[str, NDArray[Any]] = field(default_factory=dict)
    failure: str | None = None
    groups: dict[str, float] = field(default_factory=dict)
    warnings: tuple[Caution, ...] = ()
    profile_preparation: tuple[dict[str, Any], ...] = ()

    def with_entries(self, entries: Iterable[Entry]) -> Result:
        """The same with these states, their events and their fields beside its own."""
        kept = tuple(entries)
        return replace(
            self,
            states=tuple(entry.state for entry in kept),
            events=tuple(event for entry in kept for event in entry.events),
            fields=self.fields | {name: values for entry in kept for name, values in entry.fields.items()},
            warnings=(*self.warnings, *(warning for entry in kept for warning in entry.warnings)),
        )

    @property
    def answered(self) -> bool:
        """Whether the scene has its answer: it ended as asked, or all that was not met lies behind a pull-off.

        A tension that the contact cannot carry, asked for on the way out, has one: how much it carried.
        """
        missed = [state for state in self.states if not state.found]
        pulled = [k for k, event in enumerate(self.events) if event.kind == "pull_off"]
        behind = [
            state.status == "unreachable" and bool(pulled) and pulled[0] < (state.events or 0) for state in missed
        ]
        return self.status in FINAL_STATUSES or (self.status == "unreachable" and any(behind) and all(behind))

    @property
    def targets(self) -> tuple[State, ...]:
        """The states at targets, one row each, whether it was met or not."""
        return tuple(state for state in self.states if state.target)
