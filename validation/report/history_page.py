"""history.html: accuracy and counts of every case over many reports, and what rose; by the rules of history.py."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from bem.scene.atomic_file import write_atomically
from validation.harness.figure_data import axes, drawn, semilogy, trace
from validation.harness.schema import Figure, Report
from validation.harness.verdict import counts
from validation.report.figures import COLOURS, svg_of
from validation.report.history import FACTOR, Course, History
from validation.report.render import filled, number

PAGE = "history.html"


def write_history(history: History, folder: Path) -> Path:
    """Write the page of a history into a folder; its path."""
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / PAGE, render_history(history))
    return folder / PAGE


def render_history(history: History) -> str:
    """The page of a history as text."""
    n = len(history.reports)
    names = list(dict.fromkeys(line.case for line in history.lines))
    lines = {name: [line for line in history.lines if line.case == name] for name in names}
    figures = {name: figure for name in names if (figure := _figure(name, lines[name])) is not None}
    return filled(
        "history.jinja",
        n=n,
        newest=named(history.reports[-1], n),
        factor=FACTOR,
        reports=[_report(report, k + 1, len(history.rises(k))) for k, report in enumerate(history.reports)],
        rises=[(named(report, k + 1), rises) for k, report in reversed(list(enumerate(history.reports)))
               if (rises := history.rises(k))],
        now=history.rises(n - 1),
        gone=history.gone,
        unjudged=history.unjudged,
        summary=[_summary(name, lines[name]) for name in names],
        tables={name: [_cells(line) for line in lines[name]] for name in names},
        figures={name: (figure.caption, svg_of(figure, f"history-{name}")) for name, figure in figures.items()},
    )  # fmt: skip


def named(report: Report, k: int) -> str:
    """A report by its number, date and commit."""
    return f"report {k} ({_date(report)}, {_commit(report)})"


def _date(report: Report) -> str:
    return str(report.provenance.get("date", "no date"))[:16].replace("T", " ")


def _commit(report: Report) -> str:
    commit = str(report.provenance.get("commit", "no commit"))
    return f"commit {commit[:12]}{commit[40:]}" if commit[:40].isalnum() and len(commit) >= 40 else commit


def _report(report: Report, k: int, rises: int) -> list[tuple[str, float | str]]:
    """Cells of a report: text, and what it is sorted by."""
    facts = report.provenance
    failing = sum(count for verdict, count in counts(report.cases).items() if verdict in ("deviates", "error"))
    texts = [_date(report), _commit(report).removeprefix("commit ")]
    kernels = ", ".join(filter(None, (str(facts.get("blas", "")).rpartition(" ")[2], str(facts.get("kernels") or ""))))
    seconds = facts.get("seconds")
    numbers = [len(report.cases), failing, rises, seconds if isinstance(seconds, int | float) else None]
    return [("✗ rises" if rises else "✓ in band", rises), (str(k), k), *((text, text) for text in (*texts, kernels)),
            *((number(value), "" if value is None else float(value)) for value in numbers)]  # fmt: skip


def _summary(name: str, lines: list[Course]) -> dict[str, Any]:
    """The newest state of a case: whether it rose, its largest error over tolerance and over band, its counts."""
    errors = [line for line in lines if line.kind == "error"]
    return {
        "case": name,
        "rises": sum(line.rises(-1) for line in lines),
        "tolerance": _largest([_over(line.values[-1], line.limits[-1]) for line in errors]),
        "band": _largest([_over(line.values[-1], line.bands[-1]) for line in errors]),
        "counts": ", ".join(
            f"{number(line.values[-1])} {line.quantity}"
            for line in lines
            if line.kind == "count" and line.values[-1] is not None
        ),
    }


def _cells(line: Course) -> dict[str, Any]:
    """A row of the table of a case."""
    changed = len({value for value in line.values if value is not None}) > 1
    values = [(number(value), line.rises(k)) for k, value in enumerate(line.values)]
    return {"quantity": line.quantity, "kind": line.kind, "band": line.bands[-1], "values": values, "changed": changed}


def _figure(name: str, lines: list[Course]) -> Figure | None:
    """Errors over their tolerances, those nearest to them, and how counts changed since they were first known."""
    errors = [line for line in lines if line.kind == "error" and any(value for value in line.values)]
    errors.sort(key=lambda line: -(_largest([_over(v, t) for v, t in zip(line.values, line.limits, strict=True)]) or 0))
    above = [
        _trace(line, [_over(v, t) or None for v, t in zip(line.values, line.limits, strict=True)])
        for line in errors[: len(COLOURS)]
    ]
    below = []
    for line in lines:
        first = next((value for value in line.values if value), None)
        if line.kind == "count" and first:
            below.append(_trace(line, [None if v is None else 100 * (v / first - 1) for v in line.values]))
    left = len(errors) - len(above)
    caption = f"{name}: errors over their tolerances{f' (the {len(above)} largest)' if left else ''}"
    counted = axes("report", "counts, change / %", *below) if below else None
    if not above:
        return None if counted is None else drawn(name, f"{name}: counts.", counted)
    whole = f"{caption}, and how counts changed." if below else f"{caption}."
    return drawn(name, whole, semilogy("report", "error / tolerance", *above), counted)


def _trace(line: Course, y: list[float | None]) -> Any:
    """A curve over the reports; points where one is missing."""
    label = line.quantity if len(line.quantity) < 48 else f"{line.quantity[:46]}…"
    return trace(label, range(1, len(y) + 1), y, "points" if None in y else "line")


def _over(value: float | None, limit: float | None) -> float | None:
    """A ratio, None where it has no meaning."""
    return None if value is None or not limit or math.isnan(value) or math.isnan(limit) else value / limit


def _largest(ratios: list[float | None]) -> float | None:
    return max((ratio for ratio in ratios if ratio is not None), default=None)
