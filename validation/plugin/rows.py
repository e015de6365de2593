"""Rows of a case, and the one rule that judges them.

A row compares values with reference values.  It passes where

    |value - reference| <= allowed   and   max |value - reference| <= 5 stored error + 1e-13 max |reference|

For rows by construction, whose stored error often is zero, the last term is at least a thousandth of `allowed`.
`allowed` is the combined uncertainty of both sides, sqrt(u_value^2 + u_reference^2) with k = 2, or a requirement that
is declared with its reason.  The stored error is in stored.csv.  A known deviation has a band for the ratio
value / reference instead, and fails outside the band on either side.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validation.harness.figure_data import drawn, trace

WORSE = 5.0  # an error above this many stored errors is a regression
ROUNDING = 1e-13  # of the largest reference: differences below are rounding
FAR_BELOW = 1e-3  # of what is allowed: errors of a row by construction below this share are rounding
MARGINAL = 0.9  # of what is allowed


class Code(StrEnum):
    """Origin of a value: two of them make a line of the matrix."""

    BEM = "bem"
    FEM = "fem"
    THEORY = "theory"
    DENSE = "dense algebra"
    GRID = "grid method"
    EXACT = "closed form"
    RATE = "predicted rate"
    IDENTITY = "identity"
    STORED = "stored"
    USER = "user"


class Quantity(StrEnum):
    """Column of the matrix."""

    AREA = "contact fraction"
    PRESSURE = "mean pressure"
    LENGTH = "separation"
    EDGES = "edges"
    ENERGY = "energy"
    INTENSITY = "K, G"
    POINTS = "at points"
    SPECTRUM = "spectrum"
    STIFFNESS = "stiffness"
    RATE = "order"
    COUNT = "count"


Kind = Literal["accuracy", "regression", "construction"]
Verdict = Literal[
    "agrees", "marginal", "expected deviation", "changed", "deviates", "not converged", "error", "not run"
]
KINDS: tuple[Kind, ...] = get_args(Kind)
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
PASSING: tuple[Verdict, ...] = ("agrees", "marginal", "expected deviation", "not run")
WITHOUT_UNCERTAINTY = (Code.EXACT, Code.RATE, Code.IDENTITY)  # references that are exact
Uncertainty = ArrayLike | tuple[ArrayLike, ArrayLike]
Curve = tuple[ArrayLike, ArrayLike] | tuple[ArrayLike, ArrayLike, Any]  # x, y, style


@dataclass(frozen=True)
class Row:
    """Comparison of numbers: lists hold one number per value, all in `unit`.

    `reason` states where `allowed` comes from.  With a `cause`, values are ratios, references the middle of the band,
    and `allowed` is half the band.  `stored` is the stored error, or the stored value of a count; None where there is
    none.
    """

    name: str
    of: str
    by: str
    quantity: str
    kind: Kind
    values: list[float] = field(default_factory=list)
    references: list[float] = field(default_factory=list)
    value_uncertainties: list[float] = field(default_factory=list)
    reference_uncertainties: list[float] = field(default_factory=list)
    allowed: list[float] = field(default_factory=list)
    reason: str = ""
    unit: str = ""
    source: str = ""
    cause: str = ""
    place: str = ""  # file:line
    stored: float | None = None
    must_be_stored: bool = False
    message: str = ""  # of a value that does not exist

    @property
    def key(self) -> str:
        """Name of the row in stored.csv."""
        return f"{self.name} [{self.of}, {self.by}]"

    @property
    def errors(self) -> NDArray[np.float64]:
        """Absolute differences |value - reference|."""
        return np.abs(np.subtract(self.values, self.references))

    @property
    def error(self) -> float:
        """Largest |value - reference|; NaN where a value is missing."""
        return float(np.max(self.errors)) if self.values else math.nan

    @property
    def shares(self) -> NDArray[np.float64]:
        """Errors over the allowed errors; infinite for a nonzero error where zero is allowed."""
        allowed = np.asarray(self.allowed)
        exact = np.where(self.errors == 0, 0.0, np.inf)
        return np.where(allowed > 0, self.errors / np.where(allowed > 0, allowed, 1.0), exact)

    @property
    def worst(self) -> int:
        """Index of the value that decides: a NaN first, then the largest share of the allowed error."""
        return int(np.argmax(self.shares)) if self.values else 0

    @property
    def share(self) -> float:
        """Largest error over the allowed error."""
        return float(np.max(self.shares)) if self.values else math.nan

    @property
    def limit(self) -> float:
        """Largest error that is not a regression."""
        if self.stored is None or self.kind == "regression" or self.cause:
            return math.inf
        rounding = ROUNDING * float(np.max(np.abs(self.references)))
        if self.kind == "construction":  # most vanish: rounding is what is far below their requirement
            rounding = max(rounding, FAR_BELOW * float(np.min(self.allowed)))
        return WORSE * self.stored + rounding

    @property
    def verdict(self) -> Verdict:
        """Verdict by the rule of the module."""
        if self.message:
            return "not converged"
        numbers = [*self.values, *self.references, *self.allowed]
        if not self.values or not np.all(np.isfinite(numbers)):
            return "error"
        if self.cause:
            return "expected deviation" if self.share <= 1 else "changed"
        if self.must_be_stored and self.stored is None:
            return "error"
        if not self.share <= 1:
            return "deviates"
        if not self.error <= self.limit:
            return "changed"
        return "marginal" if self.share > MARGINAL else "agrees"

    def described(self) -> str:
        """Return lines that tell a person why the row failed."""
        head = f"{self.place}: {self.name}: {self.verdict}"
        if not self.values or self.message:
            return f"{head}\n    {self.message or self.reason}"
        at = self.worst
        of_many = f" (worst: {at + 1} of {len(self.values)})" if len(self.values) > 1 else ""
        unit = f" {self.unit}" if self.unit else ""
        value, reference, allowed = self.values[at], self.references[at], self.allowed[at]
        lines = [
            head,
            f"    measured    {value:.12g}{unit} ({self.of}){of_many}",
            f"    expected    {reference:.12g}{unit} ({self.by}{': ' if self.source else ''}{self.source})",
            f"    difference  {value - reference:+.3g}{unit}, {self.share:.3g} of the allowed {allowed:.3g}{unit} "
            f"({self.reason})",
        ]
        if self.cause:
            band = f"{reference - allowed:.6g} to {reference + allowed:.6g}"
            lines[2:] = [f"    band        {band}, cause: {self.cause}"]
        if self.must_be_stored and self.stored is None:
            lines.append("    stored      nothing: run the case with --store --reason TEXT")
        elif self.stored is not None and not self.error <= self.limit:
            lines.append(f"    stored      error {self.stored:.3g}{unit}; fails above {self.limit:.3g}{unit}")
        return "\n".join(lines)


class Pair(NamedTuple):
    """Rows between two codes with one source, made by `Rows.between`; options as of `Rows.compare` and `Rows.known`."""

    compare: Callable[..., Row]
    known: Callable[..., Row]


@dataclass(repr=False)
class Rows:
    """Rows, figures and tables of one case.

    `stored` holds stored errors by key, None where the case has no stored.csv.  With `eager` a failing row raises where
    it is made (`--pdb`), else `conclude` raises at the end of the case.
    """

    stored: Mapping[str, float] | None = None
    eager: bool = False
    failure: type[BaseException] = AssertionError
    rows: list[Row] = field(default_factory=list)
    figures: list[dict[str, Any]] = field(default_factory=list)
    tables: list[dict[str, Any]] = field(default_factory=list)
    costs: list[dict[str, Any]] = field(default_factory=list)
    statements: dict[str, dict[str, Any]] = field(default_factory=dict)  # of the paper: our numbers by measure

    def __repr__(self) -> str:
        return f"<{len(self.rows)} rows>"

    def compare(
        self,
        name: str,
        value: ArrayLike,
        reference: ArrayLike,
        *,
        of: str,
        by: str,
        quantity: str,
        uncertainty: Uncertainty | None = None,
        required: ArrayLike | None = None,
        because: str = "",
        unit: str = "",
        source: str = "",
        kind: Kind = "accuracy",
    ) -> Row:
        """Compare values with references.

        Parameters
        ----------
        uncertainty
            U (k = 2) of value and reference, in `unit`, as a pair; a single U only where the reference is exact.
            Rows of accuracy need it.
        required
            Largest difference allowed, decided before the run and `because` of a reason; by default the combined U.
        kind
            "accuracy": the two sides share neither code nor derived quantities.  "construction": identities,
            self-comparisons, own certificates, counts, yes or no.
        """
        __tracebackhide__ = True
        if uncertainty is None and (required is None or kind == "accuracy"):
            raise TypeError(f"{name}: needs uncertainty= of value and reference, also where required= decides")
        if (required is None) != (not because):
            raise TypeError(f"{name}: required= and because= go together: a requirement has its reason")
        if not isinstance(uncertainty, tuple) and kind == "accuracy" and by not in WITHOUT_UNCERTAINTY:
            raise TypeError(f"{name}: needs uncertainty=(of {of}, of {by}): the reference is not exact")
        sides = uncertainty if isinstance(uncertainty, tuple) else (0.0 if uncertainty is None else uncertainty, 0.0)
        if kind == "accuracy" and quantity == Quantity.COUNT and by != Code.USER and not any(map(np.any, sides)):
            raise TypeError(f"{name}: a count, or a yes or no, has no uncertainty: kind='construction'")
        return self._compared(
            name,
            value,
            reference,
            sides,
            required,
            of=of,
            by=by,
            quantity=quantity,
            kind=kind,
            unit=unit,
            source=source,
            reason=because or "U of both sides",
        )

    def between(self, of: str, by: str, source: str = "", kind: Kind = "accuracy", **options: Any) -> Pair:
        """Return a maker of rows between two codes."""
        given = {"of": of, "by": by, "source": source, "kind": kind} | options
        return Pair(partial(self.compare, **given), partial(self.known, **given))

    def known(
        self,
        name: str,
        value: ArrayLike,
        reference: ArrayLike,
        *,
        band: tuple[float, float],
        cause: str,
        uncertainty: tuple[ArrayLike, ArrayLike],
        of: str,
        by: str,
        quantity: str,
        source: str = "",
        kind: Kind = "accuracy",
    ) -> Row:
        """Compare value / reference with the band of a deviation that is understood; `uncertainty` as of `compare`."""
        __tracebackhide__ = True
        low, high = band
        if not low < high or not cause:
            raise TypeError(f"{name}: a band has low < high and a cause")
        values, references = np.asarray(value, float), np.asarray(reference, float)
        ratio = values / references
        u_value, u_reference = (np.asarray(u, float) for u in uncertainty)
        sides = u_value / np.abs(references), np.abs(ratio) * u_reference / np.abs(references)
        return self._compared(
            name,
            ratio,
            (low + high) / 2,
            sides,
            (high - low) / 2,
            of=of,
            by=by,
            quantity=quantity,
            kind=kind,
            source=source,
            reason="half the band",
            cause=cause,
        )

    def order(
        self,
        name: str,
        sizes: ArrayLike,
        errors: ArrayLike,
        predicted: float,
        *,
        of: str,
        required: float | None = None,
        because: str = "",
        source: str = "",
        kind: Kind = "accuracy",
    ) -> Row:
        """Compare the fitted order p of errors ~ sizes^-p with the predicted one.

        `sizes` grow with the effort (unknowns, cells).  U is twice the standard error of the slope of log error against
        log size; allowed is U, or what is required.  The curve becomes a figure.
        """
        __tracebackhide__ = True
        size, error = np.asarray(sizes, float), np.asarray(errors, float)
        if len(size) < 3:
            raise TypeError(f"{name}: {len(size)} sizes; an order and its scatter need three")
        (slope, _), covariance = np.polyfit(np.log(size), np.log(error), 1, cov="unscaled")
        line = np.polyval(np.polyfit(np.log(size), np.log(error), 1), np.log(size))
        scatter = math.sqrt(float(np.sum((np.log(error) - line) ** 2)) / (len(size) - 2) * covariance[0, 0])
        self.curves(
            name,
            "size",
            "error",
            {"measured": (size, error), f"order {predicted:g}": (size, error[-1] * (size[-1] / size) ** predicted)},
            log="xy",
        )
        return self._compared(
            name,
            -slope,
            predicted,
            (2 * scatter, 0.0),
            required,
            of=of,
            by=Code.RATE,
            kind=kind,
            quantity=Quantity.RATE,
            source=source,
            reason=because or "U of the fit",
        )

    def count(self, name: str, value: float, within: float = 0.2, *, of: str, unit: str = "") -> Row:
        """Compare an amount of work with the stored one, within a share of it (regression)."""
        __tracebackhide__ = True
        stored = (self.stored or {}).get(f"{name} [{of}, {Code.STORED}]")
        reference = value if stored is None else stored
        return self._compared(
            name,
            value,
            reference,
            (0.0, 0.0),
            within * abs(reference),
            of=of,
            by=Code.STORED,
            kind="regression",
            quantity=Quantity.COUNT,
            unit=unit,
            reason=f"{within:.0%} of the stored number",
        )

    def not_converged(
        self, name: str, message: str, *, of: str, by: str, quantity: str, kind: Kind = "accuracy"
    ) -> Row:
        """Add a failed row for a state that should exist and was not found, with its message."""
        __tracebackhide__ = True
        codes = str(of), str(by), str(Quantity(quantity))
        return self._add(Row(name, *codes, kind, place=_caller(), message=message or "not converged"))

    def curves(
        self,
        title: str,
        x: str,
        y: str,
        curves: Mapping[str, Curve],
        *,
        log: str = "",
        front: bool = False,
    ) -> None:
        """Add a figure of curves {label: (x, y)} or {label: (x, y, style)}; `log` names logarithmic axes, such as "xy".

        Styles are those of `Series`: "line", "points", "dashed", ...; where none is given, the first curve is points
        and all others are lines.  With `front` the figure stands on the first screen.
        """
        series = [
            trace(label, curve[0], curve[1], curve[2] if len(curve) == 3 else "line" if number else "points", number)
            for number, (label, curve) in enumerate(curves.items())
        ]
        figure = drawn(f"figure-{len(self.figures) + 1}", title, x, y, *series, log=log)
        self.figures.append(figure.model_dump() | {"front": front})

    def cost(self, problem: str, route: str, setting: str, error: float, seconds: float, spread: float) -> None:
        """Add a measured price: CPU seconds, and half their range over repeats, of an error at a setting."""
        numbers = {"error": float(error), "seconds": float(seconds), "spread": float(spread)}
        self.costs.append({"problem": problem, "route": str(route), "setting": setting} | numbers)

    def table(
        self,
        title: str,
        columns: Sequence[str],
        lines: Sequence[Sequence[str | float | int | None]],
        *,
        front: bool = False,
    ) -> None:
        """Add a table of numbers and texts; with `front` it stands on the first screen, among the three ways."""
        plain = [[cell.item() if isinstance(cell, np.generic) else cell for cell in line] for line in lines]
        self.tables.append({"title": title, "columns": list(columns), "lines": plain, "front": front})

    def content(self) -> dict[str, Any]:
        """Return rows, figures, tables and costs as plain values."""
        return {name: getattr(self, name) for name in ("figures", "tables", "costs", "statements")} | {
            "rows": [asdict(row) for row in self.rows]
        }

    def conclude(self) -> None:
        """Raise where a row fails, where there is none, or where a stored row is gone."""
        __tracebackhide__ = True
        gone = sorted(set(self.stored or ()) - {row.key for row in self.rows})
        failed = [row for row in self.rows if row.verdict not in PASSING]
        lines = [row.described() for row in failed]
        if gone:
            lines.insert(0, f"stored rows are gone: {', '.join(gone)}; run with --store --reason TEXT if this is meant")
        if failed:
            names = ", ".join(f"{row.name} ({row.of}, {row.by}) {row.verdict}" for row in failed[:3])
            lines.insert(0, f"{len(failed)} of {len(self.rows)} rows: {names}{', ...' if len(failed) > 3 else ''}")
        if not self.rows:
            lines.insert(0, "a case without a row compares nothing")
        if lines:
            raise self.failure("\n".join(lines))

    def _compared(
        self,
        name: str,
        value: ArrayLike,
        reference: ArrayLike,
        sides: tuple[ArrayLike, ArrayLike],
        required: ArrayLike | None,
        **fields: Any,
    ) -> Row:
        __tracebackhide__ = True
        values, references = (np.ravel(np.asarray(side, float)) for side in (value, reference))
        texts: dict[str, Any] = {name: str(fields.pop(name)) for name in ("of", "by", "quantity")}
        Quantity(texts["quantity"])
        row = Row(name, **texts, **fields, place=_caller())
        if values.size == 0 or (references.size not in (1, values.size)):
            return self._add(replace(row, reason=f"{values.size} values, {references.size} references"))
        u_value, u_reference = (np.abs(np.ravel(np.asarray(side, float))) for side in sides)
        allowed = np.hypot(u_value, u_reference) if required is None else np.abs(np.ravel(np.asarray(required, float)))
        lists = [
            np.broadcast_to(of, values.shape).tolist() for of in (values, references, u_value, u_reference, allowed)
        ]
        names = "values", "references", "value_uncertainties", "reference_uncertainties", "allowed"
        stored = None if self.stored is None else self.stored.get(row.key)
        must = self.stored is not None and not row.cause
        return self._add(replace(row, **dict(zip(names, lists, strict=True)), stored=stored, must_be_stored=must))

    def _add(self, row: Row) -> Row:
        __tracebackhide__ = True
        if any(other.key == row.key for other in self.rows):
            raise TypeError(f"{row.key}: a second row of this name")
        self.rows.append(row)
        if self.eager and row.verdict not in PASSING:
            raise self.failure(row.described())
        return row


def _caller() -> str:
    """Return file:line of the case that makes a row."""
    frame: Any = sys._getframe(1)
    while frame.f_code.co_filename == __file__:
        frame = frame.f_back
    path = Path(frame.f_code.co_filename)
    return f"{path.parent.name}/{path.name}:{frame.f_lineno}"
