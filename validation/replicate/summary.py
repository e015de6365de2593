"""Every statement of the paper with our number and the verdict, on one page that a reader can tick.

A line for each row that cites the paper, in the order of its topics: what the paper says and where, its number and
ours with the standard error, what would have been accepted, and the verdict that follows; a last, empty box for the
reader.  Of a row with several values the one farthest from the paper's is shown.  Beside it, how many of the
differences stored beside the tolerances have moved (statements.py).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from validation.harness.case import Outcome
from validation.harness.compare import combined_tolerance
from validation.harness.schema import CaseRecord, Cells, Row, Table
from validation.harness.verdict import verdict_of
from validation.replicate.statements import PAPER, stale

BOX = "\N{BALLOT BOX}"
COLUMNS = [
    "topic", "the paper", "quantity", "paper", "ours", "standard error", "accepted", "verdict", "why", "tick",
]  # fmt: skip


def compute(records: Sequence[CaseRecord]) -> Outcome:
    """Row and table of the topics that were judged."""
    table = Table(
        caption="The paper's statements. Accepted: the distance from the paper's number, or, where we find otherwise, "
        "the band of the ratio to it. Ours, where the paper prints none: loads, windows, weights and lower ends of "
        "fits, seeds (0 to 10), and every number of the theory, which is computed here for the same lines. The fit of "
        "a double Gaussian to the theory's own distribution and the checks against exact results (tensile tail, mean "
        "gap, moments of independent phases) are ours too, and not listed.",
        columns=COLUMNS,
        rows=[line for record in records for line in _lines(record)],
    )
    judged = [row for record in records for row in record.rows if _of_paper(row)]
    return Outcome(rows=(stale(judged),), tables=(table,))


def _lines(record: CaseRecord) -> list[Cells]:
    """Of a topic; one that could not be judged says why."""
    topic = record.id.removeprefix("replicate-")
    if not record.rows:
        return [[topic, record.question, None, None, None, None, None, record.status, record.message, BOX]]
    return [_line(topic, row) for row in record.rows if _of_paper(row)]


def _of_paper(row: Row) -> bool:
    return row.reference.source.startswith(f"{PAPER}, ")


def _line(topic: str, row: Row) -> Cells:
    paper, ours = _farthest(row)
    accepted = f"+- {combined_tolerance(row):.2g}" if row.band is None else f"x {row.band.low:g} to {row.band.high:g}"
    cause = row.band.cause if row.band is not None and row.status == "run" else ""
    why = "; ".join(part for part in (cause, row.message) if part)
    said = row.reference.source.removeprefix(f"{PAPER}, ")
    error = row.uncertainty or None
    return [topic, said, row.quantity, paper, ours, error, accepted, verdict_of(row), why, BOX]


def _farthest(row: Row) -> tuple[float | None, float | None]:
    """The values of paper and ours that differ most."""
    pairs = list(zip(row.expected, row.computed, strict=True))
    return max(pairs, key=lambda pair: math.inf if None in pair else abs(float(pair[1] or 0) - float(pair[0] or 0)))
