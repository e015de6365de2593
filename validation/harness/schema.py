"""What a report holds: rows with numbers, figures as data, cases, provenance.  report.json is this and nothing else.

A row is refused when it lacks a reference, a quantity, a norm or an acceptance rule, or when its rule is not finite:
an infinite tolerance, scale or uncertainty would accept anything.  Verdicts are not stored: they
follow from the numbers (verdict.py), so that a changed number changes the verdict.  `checksum` is the SHA-256 of the
content without that field, keys sorted.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterable
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

SCHEMA = "linecontact-report/1"

ReferenceKind = Literal["exact", "manufactured", "FEM", "theory", "predicted order", "paper's method", "dense algebra",
                        "independent code", "self"]  # fmt: skip
Code = Literal["bem", "fem", "persson", "paper's method", "suite"]  # whose answer is judged; the suite's own numbers
Norm = Literal["absolute", "relative", "maximum over states", "ratio"]
Level = Literal["quick", "standard", "full"]
Text = Annotated[str, Field(min_length=1)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
ID = r"[A-Za-z0-9][A-Za-z0-9._-]*"
Id = Annotated[str, Field(pattern=f"^{ID}$")]  # of elements of the page, and of files
Beside = Annotated[str, Field(pattern=f"^{ID}(/{ID})*$")]  # the path of a file in the folder of the report
Fact = str | int | float | bool | None | list[str | int | float] | dict[str, str | int | float | bool | None]
Cells = list[str | float | int | None]  # of a line of a table
LISTED = 3  # mistakes of a file that are told
DRAWN = 1e250  # largest number of a figure: beyond it the margins of axes are no numbers
Count = Annotated[int, Field(ge=-(2**63), lt=2**63)]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Reference(_Strict):
    """What a quantity is compared with; `uncertainty` in the unit of the quantity (or of the scaled error)."""

    kind: ReferenceKind
    source: Text
    uncertainty: Finite = Field(0.0, ge=0)


class Tolerance(_Strict):
    """Largest accepted error, and where it comes from: 2 to 3 times the error measured, required, or provisional.

    Nothing is `measured` where the uncertainty of both sides decides.
    """

    value: Finite = Field(gt=0)
    measured: Finite | None = Field(None, ge=0)
    basis: Literal["measured", "required", "provisional"] = "measured"

    @model_validator(mode="after")
    def _not_below_measured(self) -> Tolerance:
        if self.measured is None:
            if self.basis == "measured":
                raise ValueError(f"tolerance {self.value:g} is to be measured, and no measured error is given")
        elif self.measured > self.value:
            raise ValueError(f"tolerance {self.value:g} is below the measured error {self.measured:g}")
        return self


class Band(_Strict):
    """A known discrepancy: the ratio computed / expected lies in [low, high], for this cause."""

    low: Finite
    high: Finite
    cause: Text
    source: Text
    review: Text

    @model_validator(mode="after")
    def _ordered(self) -> Band:
        if not self.low < self.high:
            raise ValueError(f"band [{self.low:g}, {self.high:g}] is empty")
        return self


class Row(_Strict):
    """One comparison.

    `error` is max |computed - expected| / scale over the values; with a band it is the ratio computed / expected.
    `pinned` is the class of the computed values in baselines: `exact` (a number of patches), `tight` (quadrature),
    `converged` (to the tolerance), `unconverged` (shown, never pinned).  `code` is whose answer was computed, by
    default that of the case.
    """

    quantity: Text
    unit: str
    reference: Reference
    norm: Norm
    expected: list[float | None]
    computed: list[float | None]
    scale: Finite = Field(1.0, gt=0)
    uncertainty: Finite = Field(0.0, ge=0)
    tolerance: Tolerance | None = None
    band: Band | None = None
    pinned: Literal["exact", "tight", "converged", "unconverged"] = "converged"
    status: Literal["run", "not run", "not converged", "error"] = "run"
    message: str = ""
    code: Code | None = None

    @model_validator(mode="after")
    def _complete(self) -> Row:
        if len(self.expected) != len(self.computed) or not self.expected:
            raise ValueError(f"{self.quantity}: {len(self.computed)} computed for {len(self.expected)} expected values")
        if (self.tolerance is None) == (self.band is None):
            raise ValueError(f"{self.quantity}: needs an acceptance rule, either a tolerance or a band")
        if (self.norm == "ratio") != (self.band is not None):
            raise ValueError(f"{self.quantity}: the norm 'ratio' goes with a band, and only with one")
        if self.status != "run" and not self.message:
            raise ValueError(f"{self.quantity}: status {self.status!r} needs a message")
        return self


class Series(_Strict):
    """One curve or set of points; a `band` or error `bars` lie between `y` and `upper`, `thin` curves stay behind.

    Series of one `hue` share a colour; without it, each takes the next one. `notes` stand beside the points.
    """

    label: str
    x: list[float | None]
    y: list[float | None]
    style: Literal["line", "points", "dots", "dashed", "band", "bars", "thin", "grey"] = "line"
    upper: list[float | None] | None = None
    hue: int | None = Field(None, ge=0)
    notes: list[str] = []

    @model_validator(mode="after")
    def _of_one_length(self) -> Series:
        if len(self.x) != len(self.y) or (self.upper is not None and len(self.upper) != len(self.x)):
            raise ValueError(f"series {self.label!r}: {len(self.x)} values of x for {len(self.y)} of y")
        if (self.style in ("band", "bars")) != (self.upper is not None):
            raise ValueError(f"series {self.label!r}: a band or bars have an upper side, and nothing else has")
        if self.notes and len(self.notes) != len(self.x):
            raise ValueError(f"series {self.label!r}: {len(self.notes)} notes for {len(self.x)} points")
        for value in (*self.x, *self.y, *(self.upper or ())):
            if value is not None and DRAWN < abs(value) < math.inf:
                raise ValueError(f"series {self.label!r}: {value:g}, at most {DRAWN:g} can be drawn")
        return self

    def noted(self, notes: Iterable[object]) -> Series:
        """The same with a text beside each point."""
        return self.model_copy(update={"notes": [str(note) for note in notes]})


class Panel(_Strict):
    """Axes with their series."""

    xlabel: str
    ylabel: str
    xscale: Literal["linear", "log"] = "linear"
    yscale: Literal["linear", "log", "symlog"] = "linear"
    series: list[Series] = Field(min_length=1)


class Figure(_Strict):
    """A solution above, and its signed error below where there is one; `files` lie beside the report, by their path."""

    id: Id
    caption: Text
    solution: Panel
    error: Panel | None = None
    files: list[Beside] = []


class Table(_Strict):
    """A table of numbers and texts; its `id` begins with its place on the first screen, where it has one."""

    id: Id | Literal[""] = ""
    caption: Text
    columns: list[str]
    rows: list[Cells]


class CaseRecord(_Strict):
    """All that is reported of a case; `drawn` names its figures, so that one that went missing is noticed."""

    id: Id
    group: Text
    level: Level
    question: Text
    equations: Text
    sources: list[str]
    effects: list[str] = []
    scene: str = ""
    rows: list[Row]
    figures: list[Figure] = []
    drawn: list[str] = []
    tables: list[Table] = []
    counts: dict[str, Count] = {}
    seconds: float = 0.0
    code: Code = "bem"
    problem: str = ""
    status: Literal["run", "error", "not run"] = "run"
    message: str = ""

    @model_validator(mode="after")
    def _figures_are_there(self) -> CaseRecord:
        missing = set(self.drawn) - {figure.id for figure in self.figures}
        if missing:
            raise ValueError(f"case {self.id}: missing figure {', '.join(sorted(missing))}")
        return self


class Report(_Strict):
    """Contents of report.json."""

    schema_: Literal["linecontact-report/1"] = Field("linecontact-report/1", alias="schema")
    level: str
    command: str
    planned: Count
    provenance: dict[str, Fact]
    cases: list[CaseRecord]
    changes: list[str] = []
    checksum: str = ""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


def mistakes_in(error: ValidationError) -> str:
    """What a file of another form has wrong, in one line; the first of many."""
    found = [f"{'.'.join(map(str, one['loc'])) or 'content'}: {one['msg']}" for one in error.errors()]
    more = [f"{len(found) - LISTED} more"] if len(found) > LISTED else []
    return "; ".join([*found[:LISTED], *more])


def with_checksum(report: Report) -> Report:
    """The report with the checksum of its content.

    Examples
    --------
    >>> report = Report(level="quick", command="run", planned=0, provenance={}, cases=[])
    >>> is_intact(report), is_intact(with_checksum(report))
    (False, True)
    """
    return report.model_copy(update={"checksum": _checksum(report)})


def is_intact(report: Report) -> bool:
    """Whether the checksum of a report is that of its content."""
    return report.checksum == _checksum(report)


def _checksum(report: Report) -> str:
    content = json.loads(report.model_dump_json(by_alias=True))
    del content["checksum"]
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
