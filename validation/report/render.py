"""report.html from a report: verdicts follow from its numbers, figures from its data, nothing from anywhere else."""

import hashlib
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path
from typing import Any

from markupsafe import Markup, escape

from bem.scene.atomic_file import write_atomically
from validation.harness.case import Case
from validation.harness.compare import combined_tolerance, error_of, error_over_tolerance
from validation.harness.execution import answers_in_order
from validation.harness.schema import CaseRecord, Figure, Report, Row, is_intact
from validation.harness.verdict import GATING, VERDICTS, case_verdicts, counts, fails, verdict_of
from validation.report.figures import panels_of, svg_of
from validation.report.pages import PAGE, ReportError, asset, filled, number
from validation.report.verification import first_screen, matrix
from validation.report.verification.allowances import LOOSE, budget_of, loose, unstated
from validation.report.verification.typesetting import typeset, unset, with_links

MANY = 12  # figures from which processes of their own draw them sooner
MARKS = {
    "agrees": "✓",
    "marginal": "≲",
    "expected deviation": "≈",
    "changed": "△",
    "deviates": "✗",
    "not converged": "✗",
    "error": "✗",
    "not run": "–",
}


Line = dict[str, Any]  # of the tables


@dataclass(frozen=True)
class DrawnFigure:
    """A figure of a case, drawn, and where it stands on the first screen; None for one that stands with its case."""

    case: str
    id: str
    caption: str
    svg: Markup
    files: list[str]
    place: str | None = None


def write_html(report: Report, folder: Path, jobs: int = 1) -> None:
    """Render a report into folder/report.html, under a temporary name first; its figures in so many processes."""
    write_atomically(folder / PAGE, render(report, jobs))


def render(report: Report, jobs: int = 1) -> str:
    """The page as text.

    ReportError where a case cites a source that is not in the bibliography, or the provenance has no date or commit.
    """
    absent = [name for name in ("date", "commit") if name not in report.provenance]
    if absent:
        raise ReportError(f"the provenance of the report has no {' and no '.join(absent)}")
    lines = {case.id: [_line(case, place, row) for place, row in enumerate(case.rows)] for case in report.cases}
    groups = list(dict.fromkeys(case.group for case in report.cases))
    hard = first_screen.hard_map(report.cases)
    drawn, overview = _drawn(report.cases, jobs), first_screen.scatter(report)
    return filled(
        "page.jinja",
        {
            "typeset": typeset,
            "with_links": with_links,
            "short": short,
            "error": error_of,
            "sha256": lambda text: hashlib.sha256(text.encode()).hexdigest(),
        },
        report=report,
        sentence=first_screen.first_sentence(report),
        passed=not fails(report) and is_intact(report),
        all_results=overview and DrawnFigure("", overview.id, overview.caption, svg_of(overview, "all-results"), []),
        lines=lines,
        verdicts=[(name, count, MARKS[name], name in GATING) for name, count in counts(report.cases).items()],
        marks=MARKS,
        worst=_worst_ratio(lines),
        intact=is_intact(report),
        failing=failures(report),
        bands=[(case, line) for case, given in lines.items() for line in given if line["row"].band is not None],
        is_overdue=lambda review: _is_before(review, str(report.provenance["date"])[:10]),
        groups=[(group, [case for case in report.cases if case.group == group]) for group in groups],
        placed={place: [one for one in drawn if one.place == place] for place in first_screen.PLACES},
        drawn=drawn,
        prices=first_screen.tables_at(report.cases, first_screen.PRICE),
        hard=hard,
        hard_counts=first_screen.counted_endings(hard),
        matrix=matrix.matrix_of(report.cases),
        columns=list(matrix.COLUMNS),
        tally=matrix.tally(report.cases),
        tallied=matrix.TALLIED,
        kinds=matrix.KINDS,
        summary={
            kind: [(c, line) for c, given in lines.items() for line in given if line["kind"] == kind]
            for kind in matrix.KINDS
        },
        unstated=unstated(report.cases),
        loose=loose(report.cases),
        loose_factor=LOOSE,
        case_verdict={case.id: _worst(case) for case in report.cases},
        bibliography=bibliography(report.cases),
    )


def failures(report: Report) -> list[tuple[str, str]]:
    """What gates, in the order of the report: the case ("" for the report itself) and what is wrong with it."""
    found = []
    if not is_intact(report):
        found.append(("", "report.json was changed after it was written: its checksum does not fit"))
    if len(report.cases) != report.planned:
        found.append(("", f"{report.planned} cases planned, {len(report.cases)} reported"))
    for case in report.cases:
        if case.status == "error":
            found.append((case.id, f"error, {case.message}"))
        elif case.status == "run" and not case.rows:
            found.append((case.id, "error, it compares nothing"))
        for row in case.rows:
            verdict = verdict_of(row)
            if verdict in GATING:
                allowed = f"{row.band.low:g} to {row.band.high:g}" if row.band else f"{combined_tolerance(row):.3g}"
                why = row.message or f"error {error_of(row):.3g}, allowed {allowed}"
                found.append((case.id, f"{row.quantity}: {verdict}, {why}"))
    return found


def _worst_ratio(lines: Mapping[str, list[Line]]) -> dict[str, Any] | None:
    """The largest error over tolerance of all rows that have one, with its case; None when none has."""
    known = [{"ratio": line["ratio"], "case": case} for case, given in lines.items() for line in given]
    ratios = [one for one in known if one["ratio"] is not None and not math.isnan(one["ratio"])]
    return max(ratios, key=lambda one: float(one["ratio"]), default=None)


def _is_before(review: str, today: str) -> bool:
    try:
        return date.fromisoformat(review) < date.fromisoformat(today)
    except ValueError:  # no dates: nothing can be overdue
        return False


def _line(case: CaseRecord, place: int, row: Row) -> Line:
    """A row as the tables show it; what begins with `sort_` is the number behind a text, "" where there is none.

    `name` is its quantity without what the error is scaled with, which stands in `norm`.
    """
    allowed = f"{row.band.low:g} to {row.band.high:g}" if row.band else number(combined_tolerance(row))
    worst = matrix.worst_place(row)
    name, over = matrix.named(row.quantity, row.unit)
    scale = "" if row.scale == 1 else f"{number(row.scale)} {row.unit}".strip()
    spread = Markup(" <small>± {:.2g}</small>").format(row.uncertainty)
    return dict(
        **vars(budget_of(row)),
        row=row,
        target=matrix.row_id(case, place),
        kind=matrix.kind_of(row),
        name=name,
        norm=f"{row.norm}, over {' = '.join(filter(None, (over, scale)))}" if over or scale else row.norm,
        expected=_value(row.expected, worst),
        computed=_value(row.computed, worst) + (spread if row.uncertainty > 0 else ""),
        error=error_of(row),
        allowed=allowed,
        ratio=None if row.band else error_over_tolerance(row),
        verdict=verdict_of(row),
        sort_expected=row.expected[worst],
        sort_computed=row.computed[worst],
        sort_allowed=row.band.high if row.band else combined_tolerance(row),
    )


def _value(values: list[float | None], worst: int) -> Markup:
    """The value at the worst place; how many there are beside it."""
    text = escape(number(values[worst]))
    return text if len(values) == 1 else text + Markup(" <small>largest error of {}</small>").format(len(values))


def short(commit: str) -> str:
    """A commit by its first twelve digits; what follows them in words is kept."""
    return re.sub(r"^([0-9a-f]{12})[0-9a-f]{28}", r"\1", str(commit))


def _drawn(cases: Sequence[CaseRecord], jobs: int) -> list[DrawnFigure]:
    """The figures of all cases; many are drawn in processes of their own."""
    asked = [(case.id, figure) for case in cases for figure in case.figures]
    last = {figure.id: case for case, figure in asked}  # of cases in two forms the latter is on the first screen
    processes = jobs if len(asked) >= MANY else 1
    found = list(map(_in_svg, asked)) if processes == 1 else answers_in_order(_in_svg, asked, processes)
    drawn = []
    for one in found:
        if isinstance(one, Exception):
            raise one
        drawn.append(one if last[one.id] == one.case else replace(one, place=None))
    return drawn


def _in_svg(asked: tuple[str, Figure]) -> DrawnFigure:
    case, figure = asked
    place = first_screen.place_of(figure)
    draw = panels_of if place == "centre" else svg_of
    return DrawnFigure(case, figure.id, figure.caption, draw(figure, f"{case}-{figure.id}"), figure.files, place)


def _worst(case: CaseRecord) -> str:
    """The verdict that stands for a case: the most serious of its rows."""
    given = case_verdicts(case)
    return max(given, key=lambda verdict: (verdict in GATING, VERDICTS.index(verdict)))


def bibliography(cases: Iterable[CaseRecord | Case]) -> list[tuple[str, str]]:
    """Keys that cases cite, with the entries; a source written out, of more than one word, is none.

    ReportError where a key is not in the bibliography.
    """
    known = json.loads(asset("bibliography.json"))
    cited = sorted({key for case in cases for key in case.sources if " " not in key})
    unknown = [key for key in cited if key not in known]
    if unknown:
        raise ReportError(f"sources not in the bibliography: {', '.join(unknown)}")
    return [(key, known[key]) for key in cited]


def refuse_unset(cases: Iterable[Case]) -> None:
    """Refuse equations that cannot be set, before any work, by a ReportError that names them."""
    found = [f"case {case.id!r}: {why}" for case in cases for why in unset(case.equations)]
    if found:
        raise ReportError(f"an equation cannot be set: {'; '.join(found)}")
