"""history.html: errors and counts of cases over many reports, and what rose out of the band of the earlier ones.

Reports are taken by date.  Each is judged by all before it, through two rules:

    error   <= 5 max(earlier errors and the measured errors that stood beside their tolerances)
    count   <= max(earlier counts on the same kernels: processor, BLAS, compiled or NumPy)

Errors vary with the last bits that kernels round differently: over sixteen reports of 39 to 48 cases, on four kernels,
an error was at most 2.05 times that maximum, hence 5 (one was 4.96 times, on the first kernels but one; its measured
error was then taken from there).  Counts of one code on the same kernels are equal: any rise is one.  A fall is none,
neither is a change of seconds.  A value that is not a number rises always, and so does a case that ends in an error.
Rows with a band have no error to follow; their verdict is in the report itself.
"""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from bem.scene.atomic_file import write_atomically
from validation.harness.compare import combined_tolerance, error_of
from validation.harness.figure_data import axes, drawn, semilogy, trace
from validation.harness.schema import Figure, Report, Series
from validation.harness.verdict import counts
from validation.report.figures import COLOURS, svg_of
from validation.report.pages import filled, number
from validation.report.render import short

Kind = Literal["error", "count"]
Key = tuple[str, str, Kind]  # case, quantity

FACTOR = 5.0  # 2.05 measured


@dataclass(frozen=True)
class Course:
    """A number of a case over n reports."""

    case: str
    quantity: str
    kind: Kind
    # errors, scaled as their rows say, or counts; None where a report does not have it; (n,)
    values: tuple[float | None, ...]
    limits: tuple[float, ...]  # tolerances of the errors; nan for counts; (n,)
    # the largest value that the reports before allow; None where there is none to judge by; (n,)
    bands: tuple[float | None, ...]

    def rises(self, k: int) -> bool:
        """Whether the value of report k is above its band, or no number."""
        value, band = self.values[k], self.bands[k]
        return value is not None and (math.isnan(value) or (band is not None and not value <= band))

    @property
    def changed(self) -> bool:
        """Whether the reports that have it differ."""
        return len({value for value in self.values if value is not None}) > 1

    def told(self, k: int) -> str:
        """The rise of report k in words."""
        value, band = self.values[k], self.bands[k]
        allowed = "" if band is None else f", the earlier reports allow {band:.4g}"
        return f"{self.case}: {self.quantity}: {self.kind} {value:.4g}{allowed}"


@dataclass(frozen=True)
class History:
    """Reports by date, the lines of their cases, cases that ended in an error in report k, and cases that are gone."""

    reports: tuple[Report, ...]
    lines: tuple[Course, ...]
    failed: tuple[tuple[int, str], ...]
    gone: tuple[str, ...]

    @property
    def unjudged(self) -> int:
        """How many numbers of the newest report the earlier ones say nothing about."""
        return sum(line.values[-1] is not None and line.bands[-1] is None for line in self.lines)

    def rises(self, k: int) -> list[str]:
        """What rose in report k, one sentence each; -1 is the newest."""
        k %= len(self.reports)
        return [said for place, said in self.failed if place == k] + [
            line.told(k) for line in self.lines if line.rises(k)
        ]


def history_of(reports: Sequence[Report]) -> History:
    """The history of reports of one suite, given in any order."""
    ordered = tuple(sorted(reports, key=lambda report: str(report.provenance.get("date", ""))))
    found: dict[Key, dict[int, _Value]] = {}
    for k, report in enumerate(ordered):
        for key, value in _values(report).items():
            found.setdefault(key, {})[k] = value
    kernels = [tuple(str(report.provenance.get(name)) for name in ("blas", "kernels")) for report in ordered]
    failed = tuple(
        (k, f"{case.id}: error, {case.message}")
        for k, report in enumerate(ordered)
        for case in report.cases
        if case.status == "error"
    )
    last = {case.id for case in ordered[-1].cases}
    gone = dict.fromkeys(case.id for report in ordered[:-1] for case in report.cases if case.id not in last)
    return History(ordered, tuple(_line(*key, given, kernels) for key, given in found.items()), failed, tuple(gone))


@dataclass(frozen=True)
class _Value:
    value: float
    limit: float = math.nan
    measured: float = 0.0


def _values(report: Report) -> dict[Key, _Value]:
    """Errors and counts of a report; quantities of one name are numbered."""
    found: dict[Key, _Value] = {}
    for case in report.cases:
        seen: Counter[str] = Counter()
        for row in case.rows:
            seen[row.quantity] += 1
            if row.tolerance is not None and row.status != "not run":
                name = row.quantity + (f" #{seen[row.quantity]}" if seen[row.quantity] > 1 else "")
                found[case.id, name, "error"] = _Value(
                    error_of(row), combined_tolerance(row), row.tolerance.measured or 0.0
                )
        for name, count in case.counts.items():
            found[case.id, name, "count"] = _Value(count)
    return found


def _line(case: str, quantity: str, kind: Kind, given: dict[int, _Value], kernels: list[tuple[str, ...]]) -> Course:
    n = len(kernels)
    bands: list[float | None] = []
    for k in range(n):
        before = [given[j] for j in range(k) if j in given and (kind == "error" or kernels[j] == kernels[k])]
        tops = [max(one.value, one.measured) for one in before if not math.isnan(one.value)]
        bands.append(None if not tops else max(tops) * (FACTOR if kind == "error" else 1.0))
    values = tuple(given[k].value if k in given else None for k in range(n))
    limits = tuple(given[k].limit if k in given else math.nan for k in range(n))
    return Course(case, quantity, kind, values, limits, tuple(bands))


PAGE = "history.html"


def write_history(history: History, folder: Path) -> Path:
    """Write the page of a history into a folder; its path."""
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / PAGE, render_history(history))
    return folder / PAGE


def render_history(history: History) -> str:
    """The page of a history as text."""
    lines: dict[str, list[Course]] = {}
    for line in history.lines:
        lines.setdefault(line.case, []).append(line)
    told = [(named(report, k), report, history.rises(k - 1)) for k, report in enumerate(history.reports, 1)]
    return filled(
        "history.jinja",
        history=history,
        factor=FACTOR,
        newest=told[-1][0],
        now=told[-1][2],
        rises=[(name, rises) for name, _, rises in reversed(told) if rises],
        reports=[(len(rises), _cells(report, k, len(rises))) for k, (_, report, rises) in enumerate(told, 1)],
        cases=[_case(name, given) for name, given in lines.items()],
    )


def named(report: Report, k: int) -> str:
    """A report by its number, date and commit."""
    return f"report {k} ({_date(report)}, {_commit(report)})"


def _date(report: Report) -> str:
    return str(report.provenance.get("date", "no date"))[:16].replace("T", " ")


def _commit(report: Report) -> str:
    commit = str(report.provenance.get("commit", "no commit"))
    return commit if short(commit) == commit else f"commit {short(commit)}"


def _cells(report: Report, k: int, rises: int) -> list[float | str | None]:
    """A report in the table, besides its verdict."""
    facts, given = report.provenance, counts(report.cases)
    kernels = ", ".join(filter(None, (str(facts.get("blas", "")).rpartition(" ")[2], str(facts.get("kernels") or ""))))
    failing, seconds = given["deviates"] + given["error"], facts.get("seconds")
    return [k, _date(report), _commit(report).removeprefix("commit "), kernels, len(report.cases), failing, rises,
            seconds if isinstance(seconds, int | float) else None]  # fmt: skip


def _case(name: str, lines: list[Course]) -> dict[str, Any]:
    """A case on the page: what rose in the newest report, its largest errors, its counts, and its figure."""
    errors = [line for line in lines if line.kind == "error"]
    known = [line for line in lines if line.kind == "count" and line.values[-1] is not None]
    figure = _figure(name, lines)
    return {
        "name": name,
        "lines": lines,
        "rises": sum(line.rises(-1) for line in lines),
        "over_tolerance": _largest(_over(line.values[-1], line.limits[-1]) for line in errors),
        "over_band": _largest(_over(line.values[-1], line.bands[-1]) for line in errors),
        "counts": ", ".join(f"{number(line.values[-1])} {line.quantity}" for line in known),
        "caption": figure and figure.caption,
        "svg": figure and svg_of(figure, f"history-{name}"),
    }


def _figure(name: str, lines: list[Course]) -> Figure | None:
    """Errors over their tolerances, those nearest to them, and how counts changed since they were first known."""
    courses = {line: _overs(line) for line in lines if line.kind == "error" and any(line.values)}
    nearest = sorted(courses, key=lambda line: -(_largest(courses[line]) or 0))
    above = [_trace(line, [over or None for over in courses[line]]) for line in nearest[: len(COLOURS)]]
    below = [_trace(line, [None if v is None else 100 * (v / first - 1) for v in line.values]) for line in lines
             if line.kind == "count" and (first := next(filter(None, line.values), None))]  # fmt: skip
    counted = axes("report", "counts, change / %", *below) if below else None
    if not above:
        return None if counted is None else drawn(name, f"{name}: counts.", counted)
    most = f" (the {len(above)} largest)" if len(nearest) > len(above) else ""
    caption = f"{name}: errors over their tolerances{most}{', and how counts changed' if below else ''}."
    return drawn(name, caption, semilogy("report", "error / tolerance", *above), counted)


def _trace(line: Course, y: list[float | None]) -> Series:
    """A curve over the reports; points where one is missing."""
    label = line.quantity if len(line.quantity) < 48 else f"{line.quantity[:46]}…"
    return trace(label, range(1, len(y) + 1), y, "points" if None in y else "line")


def _overs(line: Course) -> list[float | None]:
    """Errors over their tolerances."""
    return [_over(value, limit) for value, limit in zip(line.values, line.limits, strict=True)]


def _over(value: float | None, limit: float | None) -> float | None:
    """A ratio, None where it has no meaning."""
    return None if value is None or not limit or math.isnan(value) or math.isnan(limit) else value / limit


def _largest(ratios: Iterable[float | None]) -> float | None:
    return max((ratio for ratio in ratios if ratio is not None), default=None)
