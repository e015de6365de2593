"""State of a path: the numbers that are stored of an equilibrium, with their meaning and unit.

Units: m, Pa, J/m^2 of nominal area, Pa m^1/2, Pa/m, s.  A number that does not exist is NaN, and null in files.
result_invariants.py states what holds between the numbers of stored states.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, get_args

from pydantic import Field, ValidatorFunctionWrapHandler, WrapValidator

from bem.audit.certificate import Certificate

Branch = Literal["loading", "unloading"]
FinalStatus = Literal["converged", "separated", "complete_contact"]
Status = Literal[FinalStatus, "unreachable", "not_converged", "interrupted"]
Ending = Literal["converged", "unreachable", "not_converged", "interrupted"]  # status of a path
FINAL_STATUSES: tuple[str, ...] = get_args(FinalStatus)
STATUSES: tuple[str, ...] = get_args(Status)


LARGEST = 1e150  # derived: magnitude of any number in SI units, whose square is a double with room for a factor


def _nan_of_null(value: Any, number: ValidatorFunctionWrapHandler) -> Any:
    """Return NaN in place of None, and any other value as a number of its type."""
    return math.nan if value is None else number(value)


Quantity = Annotated[float, Field(gt=-LARGEST, lt=LARGEST)]
MaybeNan = Annotated[float, Field(gt=-LARGEST, lt=LARGEST), WrapValidator(_nan_of_null)]
Bound = Annotated[float, Field(ge=0, lt=LARGEST)]  # of an error
Count = Annotated[int, Field(ge=0, lt=2**63)]


class NotFiniteError(ArithmeticError, ValueError):
    """Error of a state with a number that is NaN or infinite: such a state does not exist."""


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated absolute error of every number a state reports, in the unit of that number; None: not estimated."""

    mean_pressure: Bound | None = None
    contact_fraction: Bound | None = None
    penetration: Bound | None = None
    separation: Bound | None = None
    total_displacement: Bound | None = None
    elastic_energy: Bound | None = None
    adhesion_energy: Bound | None = None
    total_energy: Bound | None = None
    stress_intensity_max: Bound | None = None
    contact_stiffness: Bound | None = None


@dataclass(frozen=True)
class GapQuantiles:
    """Heights below which the gap lies on 10, 25, 50, 75 and 90 % of the open length, m."""

    p10: Quantity
    p25: Quantity
    p50: Quantity
    p75: Quantity
    p90: Quantity


@dataclass(frozen=True)
class GapNumbers:
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

    mean_open: Quantity
    mean_cubic_root: Quantity
    quantiles: GapQuantiles
    widest_channel: Quantity
    open_fraction: Quantity


CLOSED = GapNumbers(0.0, 0.0, GapQuantiles(0.0, 0.0, 0.0, 0.0, 0.0), 0.0, 0.0)


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
        Quantity of events up to this state.
    peak_pressure, largest_gap : float or None
        Pa and m, of samples of pressure and gap; known at targets alone.  There is no peak without contact.
    gaps : GapNumbers or None
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
    index: Count | None = None
    status: Status
    penetration: MaybeNan
    separation: MaybeNan
    total_displacement: Quantity | None = None
    mean_pressure: MaybeNan = 0.0
    contact_fraction: MaybeNan = 0.0
    n_patches: Count = 0
    edges: tuple[tuple[Quantity, Quantity], ...] = ()
    elastic_energy: MaybeNan = 0.0
    adhesion_energy: MaybeNan = 0.0
    total_energy: MaybeNan = 0.0
    stress_intensity_max: Quantity | None = None
    contact_stiffness: Quantity | None = None
    stable_at_fixed_load: bool | None = None
    peak_pressure: Quantity | None = None
    largest_gap: Quantity | None = None
    gaps: GapNumbers | None = None
    error_estimate: ErrorEstimate = field(default_factory=ErrorEstimate)
    certificate: Certificate = field(default_factory=Certificate)
    events: Count = 0
    stored: Count | None = None
    unknowns: Count = 0
    evaluations: Count = 0
    cpu_seconds: Bound = 0.0

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
