"""A statement of the paper as a row: its number, ours with its uncertainty, and the verdict; and all on one page.

A statement agrees when the two numbers differ by no more than the tolerance given, or twice the uncertainties of both.
Where the paper gives a number its last digit is its uncertainty; where it says "about" the tolerance says how much.

A row that would agree with anything says nothing.  So each names the alternative that it excludes, and what it accepts
is at most half the distance to it: an ensemble that scatters more is no test, and its row is not run.  Where we find
otherwise the row is a known discrepancy: the band of the ratio ours / paper's, which leaves 1 out, and the cause; it is
not run where the two differ by less than two standard errors.  Where the paper only says that two things differ, the
row is yes or no.

The page, which a reader can tick, has a line for each row that cites the paper, in the order of its topics: what the
paper says and where, its number and ours with the standard error, what would have been accepted, and the verdict that
follows; a last, empty box for the reader.  Of a row with several values the one farthest from the paper's is shown.
Beside it, how many of the differences stored beside the tolerances have moved.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from validation.harness.case import Outcome
from validation.harness.compare import combined_tolerance, error_of
from validation.harness.rows import Against
from validation.harness.schema import CaseRecord, Cells, Reference, Row, Table, Tolerance
from validation.harness.verdict import verdict_of

PAPER = "Carbone, Scaraggi, Tartaglino 2009"
STALE = 0.2  # of the tolerance: a difference that left the stored one by more has moved


@dataclass(frozen=True)
class Alternative:
    """What a statement excludes: a value in the unit of the row, and in words."""

    value: float
    words: str


@dataclass(frozen=True)
class Passage:
    """Where the paper says something; `shortfall` is why the ensemble is not the paper's: its rows are not run then.

    In all rows `ours` is our number, with its standard error `error`, and `paper` the paper's; `reported` is to be read
    beside the verdict.
    """

    where: str
    shortfall: str = ""

    @property
    def source(self) -> str:
        """As rows cite it."""
        return f"{PAPER}, {self.where}"

    def states(
        self,
        quantity: str,
        ours: float | Sequence[float],
        error: float,
        paper: float | Sequence[float],
        allowed: float,
        against: Alternative,
        *,
        measured: float,
        last_digit: float = 0.0,
        reported: str = "",
    ) -> Row:
        """A row that agrees or deviates.

        `allowed` is the tolerance of the difference, `measured` the difference found when it was set, `last_digit` the
        uncertainty of the paper's number, `against` what would contradict it.  ValueError where the tolerance itself
        reaches further than half the way to the alternative, unless the row is not run.
        """
        said = _values(paper)
        distance = min(abs(against.value - value) for value in said if value is not None)
        if allowed > distance / 2 and not self.shortfall:
            raise ValueError(
                f"{quantity}: a tolerance of {allowed:g} does not exclude {against.value:g}, {against.words}"
            )
        source = Reference(kind="independent code", source=self.source, uncertainty=last_digit)
        tolerance = Tolerance(value=allowed, measured=measured, basis="required")
        row = Row(quantity=quantity, unit="", reference=source, norm="absolute", expected=said, computed=_values(ours),
                  uncertainty=error, tolerance=tolerance)  # fmt: skip
        accepted = combined_tolerance(row)
        if accepted > distance / 2:
            why = f"no test: {accepted:.2g} is accepted, {against.value:.4g} ({against.words}) is {distance:.2g} away"
            row = not_run(row, _said(why, reported))
        else:
            row = row.model_copy(update={"message": _said(f"excludes {against.value:.4g}, {against.words}", reported)})
        return unless_short(row, self.shortfall)

    def is_otherwise(
        self,
        quantity: str,
        ours: float | Sequence[float],
        error: float,
        paper: float | Sequence[float],
        band: tuple[float, float],
        cause: str,
        *,
        unit: str = "",
        reported: str = "",
    ) -> Row:
        """A row where we find otherwise than the paper, or than the theory: the ratio lies in a band, for this cause.

        ValueError where the band holds 1, where there is no disagreement.
        """
        if band[0] <= 1 <= band[1]:
            raise ValueError(f"{quantity}: a band of {band[0]:g} to {band[1]:g} holds 1, where the two agree")
        row = Against("independent code", self.source).ratio(quantity, unit, _values(paper), _values(ours), band, cause,
                                                             self.source, uncertainty=error)  # fmt: skip
        apart = abs(error_of(row.model_copy(update={"band": None})))
        if apart < 2 * error:
            row = not_run(row, f"no finding: {apart / error:.1f} errors apart")
        else:
            row = row.model_copy(update={"message": reported})
        return unless_short(row, self.shortfall)

    def says_they_differ(self, quantity: str, found: bool, message: str) -> Row:
        """A row where the paper gives no number for how two things differ: yes (1) or no (0), with what was found."""
        row = Against("independent code", self.source).count(f"{quantity} (yes: 1)", 1.0, found, message=message)
        return unless_short(row, self.shortfall)


def not_run(row: Row, message: str) -> Row:
    """The row with the reason why it judges nothing."""
    return row.model_copy(update={"status": "not run", "message": message})


def unless_short(row: Row, shortfall: str) -> Row:
    """The row, not run where the ensemble is not the paper's: two short realisations have no error to speak of."""
    return not_run(row, shortfall) if shortfall else row


def stale(rows: Sequence[Row]) -> Row:
    """How many statements differ from the paper otherwise than was stored beside their tolerance."""
    moved = [
        row.quantity
        for row in rows
        if row.status == "run"
        and row.tolerance is not None
        and row.tolerance.measured is not None
        and abs(error_of(row) - row.tolerance.measured) > STALE * row.tolerance.value
    ]
    stored = Against("self", "the differences stored beside the tolerances")
    return stored.count("statements whose stored difference is stale", 0.0, len(moved), message="; ".join(moved))


def _said(*parts: str) -> str:
    return "; ".join(filter(None, parts))


def _values(value: float | Sequence[float]) -> list[float | None]:
    """A list of numbers; nan, which no report holds, is None."""
    listed = [value] if isinstance(value, float | int) else value
    return [None if math.isnan(one) else float(one) for one in listed]


BOX = "\N{BALLOT BOX}"
COLUMNS = [
    "topic", "the paper", "quantity", "paper", "ours", "standard error", "accepted", "verdict", "why", "tick",
]  # fmt: skip


def summary_of(records: Sequence[CaseRecord]) -> Outcome:
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
    said = row.reference.source.removeprefix(f"{PAPER}, ")
    error = row.uncertainty or None
    return [topic, said, row.quantity, paper, ours, error, accepted, verdict_of(row), _said(cause, row.message), BOX]


def _farthest(row: Row) -> tuple[float | None, float | None]:
    """The values of paper and ours that differ most."""
    pairs = list(zip(row.expected, row.computed, strict=True))
    return max(pairs, key=lambda pair: math.inf if None in pair else abs(float(pair[1] or 0) - float(pair[0] or 0)))
