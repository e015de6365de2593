"""The verdict of a row, from its numbers alone.

agrees: within the tolerance, or within the combined uncertainty of both sides; marginal: so, but with nine tenths of it
used up.  expected deviation: inside the band of
a known discrepancy.  changed: outside that band, on either side: agreeing too well fails too.  deviates: outside the
tolerance.  not converged, error: with a message; a value that is not a number is an error.  not run: with a reason.
"""

import math
from collections.abc import Iterable
from typing import Literal, get_args

from validation.harness.compare import combined_tolerance, error_of
from validation.harness.schema import CaseRecord, Report, Row

Verdict = Literal[
    "agrees", "marginal", "expected deviation", "changed", "deviates", "not converged", "error", "not run"
]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
MARGINAL = 0.9  # of what is allowed: words of the report, no result depends on it
PASSING: frozenset[Verdict] = frozenset({"agrees", "marginal", "expected deviation"})
GATING: frozenset[Verdict] = frozenset({"changed", "deviates", "not converged", "error"})


def verdict_of(row: Row) -> Verdict:
    """The verdict of a row: its status where it did not run, else what its numbers say."""
    if row.status != "run":
        return row.status
    error = error_of(row)
    if math.isnan(error):
        return "error"
    if row.band is not None:
        return "expected deviation" if row.band.low <= error <= row.band.high else "changed"
    allowed = combined_tolerance(row)
    if error > allowed:
        return "deviates"
    return "marginal" if error > MARGINAL * allowed else "agrees"


def case_verdicts(case: CaseRecord) -> list[Verdict]:
    """Verdicts of a case: those of its rows, or its own; one that compares nothing is an error."""
    if case.status != "run":
        return [case.status]
    return [verdict_of(row) for row in case.rows] or ["error"]


def counts(cases: Iterable[CaseRecord]) -> dict[Verdict, int]:
    """How often each verdict was given, also those never given."""
    found = [verdict for case in cases for verdict in case_verdicts(case)]
    return {verdict: found.count(verdict) for verdict in VERDICTS}


def counted(count: int, word: str, many: str | None = None) -> str:
    """A count with its noun.

    Examples
    --------
    >>> counted(1, "case"), counted(0, "case"), counted(2, "process", "processes")
    ('1 case', '0 cases', '2 processes')
    """
    return f"{count} {word if count == 1 else many or word + 's'}"


def fails(report: Report) -> bool:
    """Whether anything gating failed, or fewer or more cases are reported than were planned."""
    given = counts(report.cases)
    return len(report.cases) != report.planned or any(given[verdict] for verdict in GATING)
