"""Errors and counts of cases over many verification reports, and what rose out of the band of the earlier ones.

Reports are taken by date.  Each is judged by all before it, through two rules:

    error   <= 5 max(earlier errors and the measured errors that stood beside their tolerances)
    count   <= max(earlier counts on the same kernels: processor, BLAS, compiled or NumPy)

Errors vary with the last bits that kernels round differently: over sixteen reports of 39 to 48 cases, on four kernels,
an error was at most 2.05 times that maximum, hence 5 (one was 4.96 times, on the first kernels but one; its measured
error was then taken from there).  Counts of one code on the same kernels are equal: any rise is one.  A fall is none,
neither is a change of seconds.  A value that is not a number rises always, and so does a case that ends in an error.
Rows with a band have no error to follow; their verdict is in the report itself.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from validation.harness.compare import combined_tolerance, error_of
from validation.harness.schema import Report

FACTOR = 5.0  # 2.05 measured


@dataclass(frozen=True)
class Course:
    """A number of a case over n reports."""

    case: str
    quantity: str
    kind: Literal["error", "count"]
    # errors, scaled as their rows say, or counts; None where a report does not have it; (n,)
    values: tuple[float | None, ...]
    limits: tuple[float, ...]  # tolerances of the errors; nan for counts; (n,)
    # the largest value that the reports before allow; None where there is none to judge by; (n,)
    bands: tuple[float | None, ...]

    def rises(self, k: int) -> bool:
        """Whether the value of report k is above its band, or no number."""
        value, band = self.values[k], self.bands[k]
        return value is not None and (math.isnan(value) or (band is not None and not value <= band))

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
    found: dict[tuple[str, str, Literal["error", "count"]], dict[int, _Value]] = {}
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


def _values(report: Report) -> dict[tuple[str, str, Literal["error", "count"]], _Value]:
    """Errors and counts of a report; quantities of one name are numbered."""
    found: dict[tuple[str, str, Literal["error", "count"]], _Value] = {}
    for case in report.cases:
        seen: Counter[str] = Counter()
        for row in case.rows:
            seen[row.quantity] += 1
            if row.tolerance is not None and row.status != "not run":
                name = row.quantity + (f" #{seen[row.quantity]}" if seen[row.quantity] > 1 else "")
                found[case.id, name, "error"] = _Value(error_of(row), combined_tolerance(row), row.tolerance.measured)
        for name, count in case.counts.items():
            found[case.id, name, "count"] = _Value(count)
    return found


def _line(
    case: str, quantity: str, kind: Literal["error", "count"], given: dict[int, _Value], kernels: list[tuple[str, ...]]
) -> Course:
    n = len(kernels)
    bands: list[float | None] = []
    for k in range(n):
        before = [given[j] for j in range(k) if j in given and (kind == "error" or kernels[j] == kernels[k])]
        tops = [max(one.value, one.measured) for one in before if not math.isnan(one.value)]
        bands.append(None if not tops else max(tops) * (FACTOR if kind == "error" else 1.0))
    values = tuple(given[k].value if k in given else None for k in range(n))
    limits = tuple(given[k].limit if k in given else math.nan for k in range(n))
    return Course(case, quantity, kind, values, limits, tuple(bands))
