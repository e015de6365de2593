"""report.html from a report: verdicts follow from its numbers, figures from its data, nothing from anywhere else."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from validation.compare import combined_tolerance, error_of, error_over_tolerance
from validation.report.figures import svg_of
from validation.runner import write_atomically
from validation.schema import CaseRecord, Report, Row
from validation.verdict import GATING, VERDICTS, case_verdicts, counts, verdict_of

PAGE = "report.html"
LANDING = "landing-"  # prefix of the ids of figures that open the page
MARKS = {
    "agrees": "✓",
    "expected deviation": "≈",
    "changed": "△",
    "deviates": "✗",
    "not converged": "✗",
    "error": "✗",
    "not run": "–",
}


class ReportError(ValueError):
    """A report that cannot be read or rendered."""


@dataclass(frozen=True)
class Line:
    """A row as the tables show it."""

    row: Row
    expected: str
    computed: str
    error: float
    allowed: str
    ratio: float | None
    verdict: str


def write_html(report: Report, folder: Path) -> None:
    """Render a report into folder/report.html, under a temporary name first.

    Raises
    ------
    ReportError
        A case cites a source that is not in the bibliography.
    """
    write_atomically(folder / PAGE, render(report))


def render(report: Report) -> str:
    """The page as text."""
    environment = Environment(
        loader=PackageLoader("validation.report", "."),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["number"] = number
    lines = {case.id: [_line(row) for row in case.rows] for case in report.cases}
    ratios = [line.ratio for case in lines.values() for line in case if line.ratio is not None]
    finite = [ratio for ratio in ratios if math.isfinite(ratio)]
    page = environment.get_template("page.jinja").render(
        report=report,
        lines=lines,
        verdicts=[(name, count, MARKS[name], name in GATING) for name, count in counts(report.cases).items()],
        marks=MARKS,
        worst=max(finite) if finite else None,
        landing=[_drawn(case, LANDING) for case in report.cases if any(f.id.startswith(LANDING) for f in case.figures)],
        figures={case.id: _drawn(case, "") for case in report.cases},
        case_verdict={case.id: _worst(case) for case in report.cases},
        bibliography=_bibliography(report.cases),
        style=_asset("style.css"),
        script=_asset("sort.js"),
    )
    return str(page)


def number(value: Any) -> str:
    """A number with the digits a reader needs; other values as they are.

    Examples
    --------
    >>> number(1.23456789e-12), number(0.25), number(3), number(None)
    ('1.235e-12', '0.25', '3', '–')
    """
    if value is None:
        return "–"
    if isinstance(value, bool) or not isinstance(value, float):
        return str(value)
    if math.isnan(value):
        return "not a number"
    return f"{value:.4g}" if value == 0 or 1e-3 <= abs(value) < 1e5 else f"{value:.3e}"


def _line(row: Row) -> Line:
    allowed = f"{row.band.low:g} to {row.band.high:g}" if row.band else number(combined_tolerance(row))
    worst = _place_of_worst(row)
    return Line(
        row=row,
        expected=_value(row.expected, worst),
        computed=_value(row.computed, worst),
        error=error_of(row),
        allowed=allowed,
        ratio=None if row.band else error_over_tolerance(row),
        verdict=verdict_of(row),
    )


def _place_of_worst(row: Row) -> int:
    """Index of the value that is farthest off."""
    misses = [
        math.inf if a is None or b is None or math.isnan(a - b) else abs(a - b)
        for a, b in zip(row.computed, row.expected, strict=True)
    ]
    return misses.index(max(misses))


def _value(values: list[float | None], worst: int) -> str:
    """The value at the worst place; how many there are beside it."""
    text = number(values[worst])
    return text if len(values) == 1 else f"{text} (worst of {len(values)})"


def _drawn(case: CaseRecord, prefix: str) -> list[tuple[str, str, str]]:
    """Id, caption and SVG of the figures of a case whose id begins with `prefix`."""
    chosen = [figure for figure in case.figures if figure.id.startswith(prefix)]
    where = "top" if prefix else "case"
    return [(figure.id, figure.caption, svg_of(figure, f"{where}-{case.id}-{figure.id}")) for figure in chosen]


def _worst(case: CaseRecord) -> str:
    """The verdict that stands for a case: the most serious of its rows."""
    given = case_verdicts(case)
    return max(given, key=lambda verdict: (verdict in GATING, VERDICTS.index(verdict)))


def _bibliography(cases: Iterable[CaseRecord]) -> list[tuple[str, str]]:
    known = json.loads(_asset("bibliography.json"))
    cited = sorted({key for case in cases for key in case.sources})
    unknown = [key for key in cited if key not in known]
    if unknown:
        raise ReportError(f"sources not in the bibliography: {', '.join(unknown)}")
    return [(key, known[key]) for key in cited]


def _asset(name: str) -> str:
    return resources.files("validation.report").joinpath(name).read_text("utf-8")
