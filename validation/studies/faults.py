"""Would the suite notice?  Every fault of a catalogue is put into the running code, and the cases say what they see.

A control run without faults must be green: a catalogue on a red base proves nothing.  It also counts which cases call
which target; a fault is then shown to every case that calls it and is not too long.  A fault is caught by a row
whose verdict turns from passing to `deviates` or `changed`: a number moved out of what is allowed.  Crashes, values
that are no numbers, refusals and cases cut off are listed apart and do not count.  Verdicts are given here, where
no fault is: a judge that is itself the fault would acquit itself, so the case of the harness brings known rows
before it and counts its errors; in everyday use the baseline of that case pins the count.

By how much: error over what is allowed, of a band the distance from its middle over half its width.  A fault with a
size is made smaller in decades until no case sees it, starting where the measured excess predicts, with the cases
that saw it best.  A patch that was never called, a red control or a fault that nothing catches fails the study.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

from validation import baseline
from validation.compare import error_of, error_over_tolerance
from validation.execution import Ended, run_each_alone
from validation.provenance import provenance
from validation.registry import registry
from validation.runner import Note
from validation.schema import CaseRecord, Row
from validation.studies.fault_injection import Examined, Fault, FaultError, Task, examine
from validation.studies.fault_matrix import write_matrix
from validation.studies.store import write_json
from validation.verdict import GATING, case_verdicts, verdict_of

SCHEMA = "linecontact-faults/1"
FILE, FIGURE = "faults.json", "faults.svg"
CATALOGUE = "validation.studies.fault_catalogue"
QUICK_SECONDS, FULL_SECONDS = 1.0, 30.0  # longest case that takes part
SHOWN_SECONDS = 20.0  # of cases shown a fault, shortest first; the others only if these do not see it
PATIENCE = (5.0, 3.0)  # a case is cut off after so many times its seconds, and so many more
RETRIED = (1e-1, 1e-2, 1e-3)  # sizes at which a fault is shown again that at size 1 is only refused
KEEN = 3  # cases that are asked about smaller sizes: those that saw the fault best
LAST_DECADE = 16
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
    """What is known of a fault.

    Parameters
    ----------
    fault : Fault
    asked : list of str
        Cases that were shown it at size 1.
    sights : list of Sight
        At size 1.
    apart : dict of str to str
        Case to message: crashes, refusals, no number, cut off.
    calls : int
        Of the wrong function.
    size : float
        At which `sights` are: 1, or less where the codes only refuse or crash at 1.
    smallest : float or None
        The smallest decade that was seen; None if none was, or if the fault has no size.
    unseen : float or None
        The largest decade that was not seen.
    """

    fault: Fault
    asked: list[str] = field(default_factory=list)
    sights: list[Sight] = field(default_factory=list)
    apart: dict[str, str] = field(default_factory=dict)
    calls: int = 0
    size: float = 1.0
    smallest: float | None = None
    unseen: float | None = None

    @property
    def caught(self) -> bool:
        """Whether a numerical verdict changed."""
        return bool(self.sights)

    @property
    def excess(self) -> float:
        """Largest error over what is allowed; nan if nothing saw it."""
        return max((sight.excess for sight in self.sights), default=math.nan)


@dataclass
class Search:
    """Decades between which a fault stops being seen: bracketed from `seen` (exponent) upwards."""

    finding: Finding
    cases: list[str]
    predicted: int
    seen: int = 0
    lost: int | None = None

    def next_decade(self) -> int | None:
        """The exponent to try, None when the bracket is a decade wide.

        Examples
        --------
        >>> search = Search(Finding(Fault("f", "w", "m:f", lambda f, s: f, "s")), [], predicted=5)
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


def run(
    folder: Path,
    quick: bool,
    report: Callable[[Note], None],
    catalogue: str = CATALOGUE,
    modules: tuple[str, ...] = (),
) -> int:
    """Run the study, print its table, write faults.json and faults.svg; 1 when anything it asks for is not met.

    Parameters
    ----------
    folder : Path
    quick : bool
        The faults named in QUICK of the catalogue only, with cases below a second and without smaller sizes.
    report : callable
        Gets a `Note` for every step.
    catalogue : str
        Module with `CATALOGUE` and `QUICK`.
    modules : tuple of str
        Of the registry of cases; empty: all.
    """
    folder.mkdir(parents=True, exist_ok=True)
    source = import_module(catalogue)
    faults = [fault for fault in source.CATALOGUE if not quick or fault.id in source.QUICK]
    facts = provenance()
    jobs = os.cpu_count() or 1
    control = control_run(catalogue, quick, jobs, report, modules)
    red = [f"{record.id}: {verdict}" for record in control.records for verdict in case_verdicts(record) if bad(verdict)]
    findings = [] if red else examine_faults(faults, catalogue, control, jobs, report, modules)
    failures = [f"control run is not green: {line}" for line in red] + failures_of(findings)
    write_json(folder / FILE, content_of(facts, control, findings, len(faults), failures))
    if findings:
        write_matrix(folder / FIGURE, [record.id for record in control.records], findings)
    if not quick:
        shrink(findings, catalogue, control, jobs, report, modules)
        write_json(folder / FILE, content_of(facts, control, findings, len(faults), failures))
    print(table_of(findings))
    for line in failures:
        print(f"NOT MET: {line}")
    caught = sum(finding.caught for finding in findings)
    print(f"{caught} of {len(faults)} faults caught by {len(control.records)} cases; {folder / FILE}")
    return 1 if failures or len(findings) != len(faults) else 0


def control_run(
    catalogue: str, quick: bool, jobs: int, report: Callable[[Note], None], modules: tuple[str, ...] = ()
) -> Examined:
    """The cases without a fault, and how often each calls each target.

    Cases of the quick level that took at most `QUICK_SECONDS` or `FULL_SECONDS` when their baseline was made; one
    without a baseline takes part.
    """
    cases = [case for case in (registry(modules) if modules else registry()) if case.level == "quick"]
    known = baseline.expected_seconds([case.id for case in cases], baseline.FOLDER)
    limit = QUICK_SECONDS if quick else FULL_SECONDS
    chosen = [case.id for case in cases if known.get(case.id, 0.0) <= limit]
    tasks = [Task(catalogue, None, 0.0, ((name, 10 * FULL_SECONDS),), modules) for name in chosen]
    if quick:  # short ones: one process for all
        tasks = [Task(catalogue, None, 0.0, tuple((name, 10 * FULL_SECONDS) for name in chosen), modules)]
    answers = answers_of(tasks, jobs, report)
    records = {record.id: record for answer in answers for record in answer.records}
    calls = {name: counted for answer in answers for name, counted in answer.calls.items()}
    return Examined(tuple(records[name] for name in chosen), calls)


def examine_faults(
    faults: Sequence[Fault],
    catalogue: str,
    control: Examined,
    jobs: int,
    report: Callable[[Note], None],
    modules: tuple[str, ...] = (),
) -> list[Finding]:
    """What the cases that call a fault see of it at size 1: the short ones first, then the others if need be.

    A fault with a size that is only refused, or only crashes, is shown once more at the smaller `RETRIED` sizes.
    """
    findings = [Finding(fault) for fault in faults]
    seconds = {record.id: record.seconds for record in control.records}
    callers = {
        fault.id: sorted(
            (name for name, calls in control.calls.items() if calls.get(fault.target)), key=lambda name: seconds[name]
        )
        for fault in faults
    }
    for first, size in ((True, 1.0), (False, 1.0), *((True, smaller) for smaller in RETRIED)):
        asked: list[tuple[Finding, list[str]]] = []
        for finding in findings:
            named = callers[finding.fault.id]
            short = [name for place, name in enumerate(named) if _total(seconds, named[: place + 1])]
            chosen = short if first else [name for name in named if name not in short]
            if chosen and not finding.caught and (size == 1 or (finding.fault.size and finding.apart)):
                asked.append((finding, chosen))
        tasks = [_task(catalogue, finding.fault, size, chosen, seconds, modules) for finding, chosen in asked]
        for (finding, chosen), answer in zip(asked, answers_of(tasks, jobs, report), strict=True):
            finding.asked += [name for name in chosen if name not in finding.asked]
            finding.calls += sum(sum(calls.values()) for calls in answer.calls.values())
            sights, apart = compared(control, answer)
            finding.sights += sights
            finding.apart = apart | finding.apart
            finding.size = size
    return findings


def shrink(
    findings: Iterable[Finding],
    catalogue: str,
    control: Examined,
    jobs: int,
    report: Callable[[Note], None],
    modules: tuple[str, ...] = (),
) -> None:
    """Find the smallest decade of every fault with a size that its keenest cases still see."""
    seconds = {record.id: record.seconds for record in control.records}
    searches = []
    for finding in findings:
        if finding.caught and finding.fault.size:
            best = sorted(finding.sights, key=lambda sight: -sight.excess)
            keen = list(dict.fromkeys(sight.case for sight in best))[:KEEN]
            reach = math.log10(finding.excess) if 1 < finding.excess < math.inf else 0.0
            seen = -round(math.log10(finding.size))
            searches.append(Search(finding, keen, min(seen + int(reach), LAST_DECADE - 1), seen))
    while open_ones := [(search, decade) for search in searches if (decade := search.next_decade()) is not None]:
        tasks = [
            _task(catalogue, search.finding.fault, 10.0**-decade, search.cases, seconds, modules)
            for search, decade in open_ones
        ]
        for (search, decade), answer in zip(open_ones, answers_of(tasks, jobs, report), strict=True):
            if compared(control, answer)[0]:
                search.seen = decade
            else:
                search.lost = decade
    for search in searches:
        search.finding.smallest = 10.0**-search.seen
        search.finding.unseen = None if search.lost is None else 10.0**-search.lost


def compared(control: Examined, answer: Examined) -> tuple[list[Sight], dict[str, str]]:
    """Rows whose verdict changed to a miss, and what went wrong in another way, by case."""
    before = {record.id: record for record in control.records}
    sights: list[Sight] = []
    apart = dict(answer.ended)
    for record in answer.records:
        if record.status != "run":
            apart[record.id] = record.message
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
                apart.setdefault(record.id, f"{row.quantity}: {row.message or 'not a number'}")
        for name in old.keys() - _rows_by_name(record).keys():
            apart.setdefault(record.id, f"{name[0]}: the row is gone")
    return sights, apart


def excess_of(row: Row) -> float:
    """Error over what is allowed; of a band the distance from its middle over half its width."""
    if row.band is None:
        return error_over_tolerance(row)
    middle, half = (row.band.low + row.band.high) / 2, (row.band.high - row.band.low) / 2
    return abs(error_of(row) - middle) / half


def bad(verdict: str) -> bool:
    """Whether a verdict gates."""
    return verdict in GATING


def answers_of(tasks: Sequence[Task], jobs: int, report: Callable[[Note], None]) -> list[Examined]:
    """Answers in the order of the tasks; where a fault ended the process itself, what was asked is listed as ended.

    Raises
    ------
    FaultError
        A fault whose target does not exist.
    WorkerDiedError
        The control run ended its process.
    """
    found: dict[int, Examined] = {}
    with closing(run_each_alone(examine, tasks, jobs)) as events:
        for event in events:
            if isinstance(event, Ended):
                place = next(at for at, task in enumerate(tasks) if task is event.item)
                answer = event.answer
                if isinstance(answer, FaultError) or (isinstance(answer, Exception) and event.item.fault is None):
                    raise answer
                if isinstance(answer, Exception):
                    answer = Examined((), {}, tuple((name, str(answer)) for name, _ in event.item.cases))
                found[place] = answer
                name = event.item.fault or f"control: {', '.join(case for case, _ in event.item.cases)}"
                size = "" if event.item.fault is None else f" at size {event.item.size:g}"
                report(Note(f"[{len(found)}/{len(tasks)}] {name}{size}"))
    return [found[place] for place in range(len(tasks))]


def failures_of(findings: Iterable[Finding]) -> list[str]:
    """What the study asks for and did not get, one line each."""
    lines = []
    for finding in findings:
        name = finding.fault.id
        if not finding.calls and not finding.apart:
            lines.append(f"{name}: no case calls {finding.fault.target}")
        elif not finding.caught:
            lines.append(f"{name}: nothing catches it; asked: {', '.join(finding.asked)}")
    return lines


def table_of(findings: Iterable[Finding]) -> str:
    """The table on stdout."""
    lines = [f"{'fault':34} {'caught by':>9} {'error/allowed':>13} {'smallest':>9} {'keenest case'}"]
    for finding in findings:
        cases = {sight.case for sight in finding.sights}
        best = max(finding.sights, key=lambda sight: sight.excess, default=None)
        keenest = "NOTHING" if best is None else f"{best.case}: {best.quantity}"
        smallest = "-" if finding.smallest is None else f"{finding.smallest:.0e}"
        apart = f"  [apart: {', '.join(sorted(finding.apart))}]" if finding.apart else ""
        lines.append(
            f"{finding.fault.id:34} {len(cases):>3} of {len(finding.asked):<2} {finding.excess:>13.3g} "
            f"{smallest:>9} {keenest}{apart}"
        )
    return "\n".join(lines)


def content_of(
    facts: dict[str, Any], control: Examined, findings: Iterable[Finding], planned: int, failures: list[str]
) -> dict[str, Any]:
    """Contents of faults.json."""
    return {
        "schema": SCHEMA,
        "provenance": facts,
        "planned": planned,
        "failures": failures,
        "control": [
            {"case": record.id, "seconds": record.seconds, "verdicts": list(case_verdicts(record))}
            for record in control.records
        ],
        "faults": [
            {
                "id": finding.fault.id,
                "what": finding.fault.what,
                "target": finding.fault.target,
                "size": finding.fault.size,
                "caught": finding.caught,
                "calls": finding.calls,
                "size_shown": finding.size,
                "asked": finding.asked,
                "caught_by": [
                    {
                        "case": sight.case,
                        "quantity": sight.quantity,
                        "verdict": sight.verdict,
                        "error": sight.error,
                        "error_over_allowed": sight.excess,
                    }
                    for sight in sorted(finding.sights, key=lambda sight: -sight.excess)
                ],
                "crashes_and_refusals": finding.apart,
                "smallest_size_caught": finding.smallest,
                "largest_size_missed": finding.unseen,
            }
            for finding in findings
        ],
    }


def _task(
    catalogue: str, fault: Fault, size: float, cases: Iterable[str], seconds: dict[str, float], modules: tuple[str, ...]
) -> Task:
    times, more = PATIENCE
    return Task(catalogue, fault.id, size, tuple((name, times * seconds[name] + more) for name in cases), modules)


def _total(seconds: dict[str, float], names: Sequence[str]) -> bool:
    """Whether these cases together are short, or there is only one."""
    return len(names) == 1 or sum(seconds[name] for name in names) <= SHOWN_SECONDS


def _rows_by_name(record: CaseRecord) -> dict[tuple[str, int], Row]:
    """Rows by quantity, and how often that occurred before."""
    found: dict[tuple[str, int], Row] = {}
    for row in record.rows:
        found[(row.quantity, sum(name == row.quantity for name, _ in found))] = row
    return found
