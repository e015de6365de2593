"""What is known of a fault, and its report: rows that saw it and by how much, what was refused, how small it may be.

Caught is what a row sees whose verdict turns from passing to `deviates` or `changed`.  By how much: error over what is
allowed, of a band the distance from its middle over half its width.  Noticed is also what makes a case or a row fail by
name (crash, no number, not converged): the verification run fails all the same.  A case cut off proves nothing.
Reported are a table, faults.json, and the lines of the figure of faults against cases.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any

from validation.harness.compare import error_of, error_over_tolerance
from validation.harness.schema import CaseRecord, Cells, Row, Table
from validation.harness.store import plain
from validation.harness.verdict import GATING, case_verdicts, verdict_of
from validation.studies.faults.fault_injection import Examined, Fault, TooSlowError

LAST_DECADE = 16
KEEN = 3  # cases that are asked about smaller sizes: those that saw the fault best
MISSED = frozenset({"deviates", "changed"})  # verdicts by which a fault counts as caught


@dataclass(frozen=True)
class Sight:
    """A row that saw a fault: error over what is allowed; infinite where the error is."""

    case: str
    quantity: str
    error: float
    excess: float
    verdict: str


@dataclass
class Finding:
    """What is known of a fault."""

    fault: Fault
    asked: list[str] = field(default_factory=list)  # cases that were shown it
    sights: list[Sight] = field(default_factory=list)  # at `size`
    failed: dict[str, str] = field(default_factory=dict)  # case to message: crashes, refusals, no number, not converged
    # case to message: cut off, rows that are there only with or only without the fault
    apart: dict[str, str] = field(default_factory=dict)
    calls: int = 0  # of the function with the fault
    size: float = 1.0  # at which `sights` are: 1, or less where the codes only refuse or crash at 1
    smallest: float | None = None  # the least decade that was seen; None if none was, or if the fault has no size
    unseen: float | None = None  # the largest decade that was not seen

    @property
    def caught(self) -> bool:
        """Whether a numerical verdict changed."""
        return bool(self.sights)

    @property
    def noticed(self) -> bool:
        """Whether a verification run fails: by a numerical verdict, or by name."""
        return self.caught or bool(self.failed)

    @property
    def excesses(self) -> dict[str, float]:
        """Cases that caught it and the largest error over what is allowed in each, the largest last."""
        return {sight.case: sight.excess for sight in sorted(self.sights, key=lambda sight: sight.excess)}

    @property
    def excess(self) -> float:
        """Largest error over what is allowed; nan if nothing saw it."""
        return max(self.excesses.values(), default=math.nan)


@dataclass
class Search:
    """Decades between which a fault stops being seen: bracketed from `seen` (exponent) upwards."""

    finding: Finding
    cases: list[str]
    predicted: int
    seen: int = 0
    lost: int | None = None

    @classmethod
    def of(cls, finding: Finding) -> Search:
        """The search that a fault which is seen begins with, predicted from its excess."""
        keen = sorted(finding.excesses, key=lambda case: -finding.excesses[case])[:KEEN]
        reach = math.log10(finding.excess) if 1 < finding.excess < math.inf else 0.0
        seen = -round(math.log10(finding.size))
        return cls(finding, keen, min(seen + int(reach), LAST_DECADE - 1), seen)

    def next_decade(self) -> int | None:
        """The exponent to try, None when the bracket is a decade wide.

        Examples
        --------
        >>> search = Search(Finding(Fault("f", "w", "m", "a", "b", "c", "s")), [], predicted=5)
        >>> search.next_decade()
        6
        >>> search.lost = 6
        >>> search.next_decade()
        5
        >>> search.seen = 5
        >>> search.next_decade() is None
        True
        """
        if self.lost is None:
            ahead = max(self.seen, self.predicted) + 1
            return min(ahead, LAST_DECADE) if self.seen < LAST_DECADE else None
        if self.lost - self.seen <= 1:
            return None
        return self.predicted if self.seen < self.predicted < self.lost else (self.seen + self.lost) // 2


def compared(control: Examined, answer: Examined) -> tuple[list[Sight], dict[str, str], dict[str, str]]:
    """Rows whose verdict changed to a miss, what failed by name, and what says nothing, by case."""
    before = {record.id: record for record in control.records}
    sights: list[Sight] = []
    failed, apart = dict(answer.ended), dict[str, str]()
    for record in answer.records:
        if record.status != "run":
            cut_off = record.message.startswith(TooSlowError.__name__)
            (apart if cut_off else failed)[record.id] = record.message
            continue
        old = _rows_by_name(before[record.id])
        for name, row in _rows_by_name(record).items():
            verdict = verdict_of(row)
            if name not in old or verdict in MISSED:
                if name in old and not bad(verdict_of(old[name])):
                    sights.append(Sight(record.id, row.quantity, error_of(row), excess_of(row), verdict))
                elif name not in old:
                    apart.setdefault(record.id, f"{row.quantity}: a row that is not there without the fault")
            elif bad(verdict):
                failed.setdefault(record.id, f"{row.quantity}: {row.message or 'not a number'}")
        for name in old.keys() - _rows_by_name(record).keys():
            apart.setdefault(record.id, f"{name[0]}: the row is gone")
    return sights, failed, apart


def excess_of(row: Row) -> float:
    """Error over what is allowed; of a band the distance from its middle over half its width."""
    if row.band is None:
        return error_over_tolerance(row)
    middle, half = (row.band.low + row.band.high) / 2, (row.band.high - row.band.low) / 2
    return abs(error_of(row) - middle) / half


def bad(verdict: str) -> bool:
    """Whether a verdict gates."""
    return verdict in GATING


def _rows_by_name(record: CaseRecord) -> dict[tuple[str, int], Row]:
    """Rows by quantity, and how often that occurred before."""
    found: dict[tuple[str, int], Row] = {}
    for row in record.rows:
        found[(row.quantity, sum(name == row.quantity for name, _ in found))] = row
    return found


SCHEMA = "linecontact-faults/3"


def failures_of(findings: Iterable[Finding]) -> list[str]:
    """What the study asks for and did not get, one line each."""
    lines = []
    for finding in findings:
        others = {*finding.failed, *finding.excesses}
        if finding.fault.case not in others:
            reported = f"noticed by {', '.join(sorted(others))}" if others else "nothing notices it"
            lines.append(f"{finding.fault.id}: {finding.fault.case}, which must notice it, does not; {reported}")
    return lines


def table_of(findings: Iterable[Finding]) -> Table:
    """A line for every fault: how many of the cases asked caught it, by how much, how small it may be."""
    rows: list[Cells] = []
    for finding in findings:
        best = max(finding.sights, key=lambda sight: sight.excess, default=None)
        unseen = f"by name: {', '.join(sorted(finding.failed))}" if finding.failed else "NOTHING"
        keenest = unseen if best is None else f"{best.case}: {best.quantity}"
        rows.append([finding.fault.id, f"{len(finding.excesses)} of {len(finding.asked)}", plain(finding.excess),
                     finding.smallest, keenest, ", ".join(sorted(finding.apart))])  # fmt: skip
    return Table(
        caption="Faults, the smallest decade of each that is caught, and the row that saw it best; apart: cut off, or "
        "rows that are there only with or without the fault. Drawn in faults.svg.",
        columns=["fault", "caught by", "error / allowed", "smallest", "keenest row", "apart"],
        rows=rows,
    )


def content_of(control: Examined, findings: Iterable[Finding], planned: int) -> dict[str, Any]:
    """Contents of faults.json: control, findings, faults that were to be examined."""
    return {
        "planned": planned,
        "control": [
            {"case": record.id, "seconds": record.seconds, "verdicts": list(case_verdicts(record))}
            for record in control.records
        ],
        "faults": [
            asdict(finding.fault)
            | {
                "caught": finding.caught,
                "noticed": finding.noticed,
                "calls": finding.calls,
                "size_shown": finding.size,
                "asked": finding.asked,
                "caught_by": [asdict(sight) for sight in sorted(finding.sights, key=lambda sight: -sight.excess)],
                "crashes_and_refusals": finding.failed,
                "apart": finding.apart,
                "smallest_size_caught": finding.smallest,
                "largest_size_missed": finding.unseen,
            }
            for finding in findings
        ],
    }
