"""Would the suite notice?  Every fault of a catalogue is put into the running code, and the cases say what they see.

A control run without faults must be green: a catalogue on a red base proves nothing.  It also counts which cases call
which target; a fault is then shown to every case that calls it and is not too long.  A fault is caught by a row
whose verdict turns from passing to `deviates` or `changed`: a number moved out of what is allowed.  Crashes, refusals
and values that are no numbers make the run fail as well, by name: such a fault is noticed.  Cases cut off are listed
apart and do not count.  Verdicts are given here, where no fault is: a judge that is itself the fault would acquit
itself, so the case of the harness brings known rows before it and counts its errors; in everyday use the baseline of
that case pins the count.

By how much: error over what is allowed, of a band the distance from its middle over half its width.  A fault with a
size is made smaller in decades until no case sees it, starting where the measured excess predicts, with the cases
that saw it best.  A patch that was never called, a red control or a fault that nothing catches fails the study.
Finished answers are kept (answers.py): an interrupted study goes on.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from importlib import import_module
from pathlib import Path

from validation.harness import baseline
from validation.harness.execution import Ended, run_each_alone
from validation.harness.provenance import provenance
from validation.harness.registry import registry
from validation.harness.runner import Note
from validation.harness.verdict import case_verdicts
from validation.report.fault_matrix import write_matrix
from validation.studies.answers import Answers, answers_in
from validation.studies.faults.fault_findings import LAST_DECADE, Finding, Search, bad, compared
from validation.studies.faults.fault_injection import Examined, Fault, FaultError, Task, examine
from validation.studies.faults.fault_report import content_of, failures_of, lines_of, table_of
from validation.studies.store import write_json

FILE, FIGURE = "faults.json", "faults.svg"
CATALOGUE = "validation.studies.faults.fault_catalogue"
QUICK_SECONDS, FULL_SECONDS = 1.0, 30.0  # longest case that takes part
SHOWN_SECONDS = 20.0  # of cases shown a fault, shortest first; the others only if these do not see it
PATIENCE = (5.0, 3.0)  # a case is cut off after so many times its seconds of the processor, and so many more
RETRIED = (1e-1, 1e-2, 1e-3)  # sizes at which a fault is shown again that at size 1 is only refused
KEEN = 3  # cases that are asked about smaller sizes: those that saw the fault best


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
    answers = answers_in(folder, report)
    control = control_run(catalogue, quick, jobs, answers, modules)
    red = [f"{record.id}: {verdict}" for record in control.records for verdict in case_verdicts(record) if bad(verdict)]
    findings = [] if red else examine_faults(faults, catalogue, control, jobs, answers, modules)
    failures = [f"control run is not green: {line}" for line in red] + failures_of(findings)
    write_json(folder / FILE, content_of(facts, control, findings, len(faults), failures))
    if findings:
        write_matrix(folder / FIGURE, [record.id for record in control.records], lines_of(findings))
    if not quick:
        shrink(findings, catalogue, control, jobs, answers, modules)
        write_json(folder / FILE, content_of(facts, control, findings, len(faults), failures))
    print(table_of(findings))
    for line in failures:
        print(f"NOT MET: {line}")
    caught = sum(finding.caught for finding in findings)
    by_name = sum(finding.noticed for finding in findings) - caught
    told = f"{caught} of {len(faults)} faults caught by {len(control.records)} cases, {by_name} more noticed by name"
    print(f"{told}; {folder / FILE}")
    return 1 if failures or len(findings) != len(faults) else 0


def control_run(catalogue: str, quick: bool, jobs: int, kept: Answers, modules: tuple[str, ...] = ()) -> Examined:
    """The cases without a fault, and how often each calls each target.

    Cases of the quick level that took at most `QUICK_SECONDS` or `FULL_SECONDS` when their baseline was made; one
    without a baseline takes part.

    Parameters
    ----------
    catalogue : str
        Module of the faults.
    quick : bool
        Cases below `QUICK_SECONDS` only.
    jobs : int
        Processes at a time.
    kept : Answers
        Of an earlier run; new ones are added.
    modules : tuple of str
        Of the registry of cases; empty: all.
    """
    cases = [case for case in (registry(modules) if modules else registry()) if case.level == "quick"]
    known = baseline.expected_seconds([case.id for case in cases], baseline.FOLDER)
    limit = QUICK_SECONDS if quick else FULL_SECONDS
    chosen = [case.id for case in cases if known.get(case.id, 0.0) <= limit]
    tasks = [Task(catalogue, None, 0.0, ((name, 10 * FULL_SECONDS),), modules) for name in chosen]
    if quick:  # short ones: one process for all
        tasks = [Task(catalogue, None, 0.0, tuple((name, 10 * FULL_SECONDS) for name in chosen), modules)]
    answers = answers_of(tasks, jobs, kept)
    records = {record.id: record for answer in answers for record in answer.records}
    calls = {name: counted for answer in answers for name, counted in answer.calls.items()}
    return Examined(tuple(records[name] for name in chosen), calls)


def examine_faults(
    faults: Sequence[Fault],
    catalogue: str,
    control: Examined,
    jobs: int,
    kept: Answers,
    modules: tuple[str, ...] = (),
) -> list[Finding]:
    """What the cases that call a fault see of it at size 1: the short ones first, then the others if need be.

    A fault with a size that is only refused, or only crashes, is shown once more at the smaller `RETRIED` sizes.

    Parameters
    ----------
    faults : sequence of Fault
    catalogue, jobs, kept, modules
        As of `control_run`.
    control : Examined
        Of the control run.
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
            if chosen and not finding.caught and (size == 1 or (finding.fault.size and finding.failed | finding.apart)):
                asked.append((finding, chosen))
        tasks = [_task(catalogue, finding.fault, size, chosen, seconds, modules) for finding, chosen in asked]
        for (finding, chosen), answer in zip(asked, answers_of(tasks, jobs, kept), strict=True):
            finding.asked += [name for name in chosen if name not in finding.asked]
            finding.calls += sum(sum(calls.values()) for calls in answer.calls.values())
            sights, failed, apart = compared(control, answer)
            finding.sights += sights
            finding.failed = failed | finding.failed
            finding.apart = apart | finding.apart
            finding.size = size
    return findings


def shrink(
    findings: Iterable[Finding],
    catalogue: str,
    control: Examined,
    jobs: int,
    kept: Answers,
    modules: tuple[str, ...] = (),
) -> None:
    """Find the smallest decade of every fault with a size that its keenest cases still see.

    Parameters
    ----------
    findings : iterable of Finding
        Their `smallest` and `unseen` are set.
    catalogue, control, jobs, kept, modules
        As of `examine_faults`.
    """
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
        for (search, decade), answer in zip(open_ones, answers_of(tasks, jobs, kept), strict=True):
            if compared(control, answer)[0]:
                search.seen = decade
            else:
                search.lost = decade
    for search in searches:
        search.finding.smallest = 10.0**-search.seen
        search.finding.unseen = None if search.lost is None else 10.0**-search.lost


def answers_of(tasks: Sequence[Task], jobs: int, kept: Answers) -> list[Examined]:
    """Answers in the order of the tasks; where a fault ended the process itself, what was asked is listed as ended.

    Those of an earlier run are taken; that a process ended is no answer to keep.

    Parameters
    ----------
    tasks : sequence of Task
    jobs : int
        Processes at a time.
    kept : Answers
        Of an earlier run; new ones are added.

    Raises
    ------
    FaultError
        A fault whose target does not exist.
    WorkerDiedError
        The control run ended its process.
    """
    known = {place: kept.kept(Examined, _name(task), task) for place, task in enumerate(tasks)}
    found = {place: answer for place, answer in known.items() if answer is not None}
    missing = [task for place, task in enumerate(tasks) if place not in found]
    with closing(run_each_alone(examine, missing, jobs)) as events:
        for event in events:
            if isinstance(event, Ended):
                place = next(at for at, task in enumerate(tasks) if task is event.item)
                answer = event.answer
                if isinstance(answer, FaultError) or (isinstance(answer, Exception) and event.item.fault is None):
                    raise answer
                if isinstance(answer, Exception):
                    answer = Examined((), {}, tuple((name, str(answer)) for name, _ in event.item.cases))
                else:
                    kept.keep(Examined, answer, _name(event.item), event.item)
                found[place] = answer
                kept.report(Note(f"[{len(found)}/{len(tasks)}] {_name(event.item)}"))
    return [found[place] for place in range(len(tasks))]


def _name(task: Task) -> str:
    """Of a task, for people."""
    if task.fault is None:
        return f"control: {', '.join(case for case, _ in task.cases)}"
    return f"{task.fault} at size {task.size:g}"


def _task(
    catalogue: str, fault: Fault, size: float, cases: Iterable[str], seconds: dict[str, float], modules: tuple[str, ...]
) -> Task:
    times, more = PATIENCE
    return Task(catalogue, fault.id, size, tuple((name, times * seconds[name] + more) for name in cases), modules)


def _total(seconds: dict[str, float], names: Sequence[str]) -> bool:
    """Whether these cases together are short, or there is only one."""
    return len(names) == 1 or sum(seconds[name] for name in names) <= SHOWN_SECONDS
