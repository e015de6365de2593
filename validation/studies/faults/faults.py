"""Would the suite notice?  Every fault of the tables is put into a copy of the sources, and cases say what they see.

A control run without faults must be green: faults on a red base prove nothing.  It also counts which cases call the
function that a fault changes; a fault is then shown to the case that must notice it, and to the others that call it
as long as these are short.  A fault is caught by a row whose verdict turns from passing to `deviates` or `changed`: a
number moved out of what is allowed.  Crashes, refusals and values that are not numbers make the run fail as well, by
name: such a fault is noticed.  Cases cut off are listed apart and do not count.  Verdicts are given here, where no
fault is: a judge that is itself the fault would acquit itself, so the case of the harness brings known rows before it
and counts its errors; in everyday use the baseline of that case pins the count.

By how much: error over what is allowed, of a band the distance from its middle over half its width.  A fault with a
size is made smaller in decades until no case sees it, starting where the measured excess predicts, with the cases that
saw it best.  A red control, or a fault that its case does not notice, fails the study; a fault that does not fit the
sources is refused before anything runs.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from validation.harness import baseline
from validation.harness.case import Case, Found, registry
from validation.harness.execution import Note
from validation.harness.store import Store
from validation.harness.verdict import case_verdicts
from validation.report.fault_figure import FaultLine, write_matrix
from validation.studies.bench import HELD, Bench, none_of, study_case
from validation.studies.faults.fault_findings import (
    SCHEMA,
    Finding,
    Search,
    bad,
    compared,
    content_of,
    failures_of,
    table_of,
)
from validation.studies.faults.fault_injection import Examined, Exposure, Fault, FaultError, Studied, examine, faults_in

FILE, FIGURE = "faults.json", "faults.svg"
QUICK_SECONDS, FULL_SECONDS = 1.0, 30.0  # longest case that takes part, unless it must notice a fault
SHOWN_SECONDS = 20.0  # of cases shown a fault besides the one that must notice it, shortest first
PATIENCE = (5.0, 3.0)  # a case is cut off after so many times its seconds of the processor, and so many more
SIZES = (1.0, 1e-1, 1e-2, 1e-3)  # at which a fault is shown, one after another, as long as it is only refused


@dataclass(frozen=True)
class Runs:
    """How tasks are run: on these sources, with the answers of an earlier run, by so many processes at a time."""

    studied: Studied
    kept: Store
    jobs: int = 1

    def answers(self, tasks: Sequence[Exposure]) -> list[Examined]:
        """Answers in the order of the tasks; where a fault ended the process itself, what was asked is listed as ended.

        Those of an earlier run are taken; that a process ended is no answer to keep.  The control must not end its own.
        """
        found: dict[int, Examined] = {}
        with TemporaryDirectory() as copies:
            function = partial(examine, self.studied, Path(copies).resolve())
            answers = self.kept.answers(Examined, function, tasks, lambda task: (_name(task), task), self.jobs)
            for task, answer, _ in answers:
                if isinstance(answer, FaultError) or (isinstance(answer, Exception) and task.fault is None):
                    raise answer
                if isinstance(answer, Exception):
                    answer = Examined((), {}, tuple((name, str(answer)) for name, _ in task.cases))
                found[next(place for place, one in enumerate(tasks) if one is task)] = answer
                self.kept.report(Note(f"[{len(found)}/{len(tasks)}] {_name(task)}"))
        return [found[place] for place in range(len(tasks))]


def cases(bench: Bench, studied: Studied | None = None) -> list[Case]:
    """The case of the study; quick: the faults that are `quick` only, with cases below a second, without smaller sizes.

    `studied` is by default the tables of this folder; FaultError where a fault does not fit the sources, and, once the
    study runs, where one names a case that is not there.
    """
    studied = studied or Studied(faults_in())
    studied.functions()
    return [
        study_case("faults", partial(_noticed, bench, studied),
                   "Would the suite notice: is every fault put into the code seen by the case that must see it?",
                   "error over what is allowed, with the fault", "demillo1978")
    ]  # fmt: skip


def _noticed(bench: Bench, studied: Studied) -> Found:
    faults = [fault for fault in studied.faults if fault.quick or not bench.quick]
    runs = Runs(studied, bench.store, bench.jobs)
    control = control_run(runs, faults, bench.quick)
    red = [f"{record.id}: {verdict}" for record in control.records for verdict in case_verdicts(record) if bad(verdict)]
    findings = [] if red else examine_faults(runs, faults, control)
    if not bench.quick:
        shrink(runs, findings, control)
    bench.write(FILE, SCHEMA, **content_of(control, findings, len(faults)))
    if findings:
        lines = [FaultLine(one.fault.id, one.excesses, {*one.failed, *one.apart}, one.asked) for one in findings]
        write_matrix(bench.folder / FIGURE, [record.id for record in control.records], lines)
    yield none_of("verdicts of the control run that are not green: faults on a red base prove nothing", red)
    yield none_of(f"of {len(faults)} faults, not noticed by the case that must notice them", failures_of(findings))
    yield HELD.count("faults examined", len(faults), len(findings))
    yield table_of(findings)
    caught, noticed = (sum(getattr(one, name) for one in findings) for name in ("caught", "noticed"))
    yield {"caught by a verdict": caught, "noticed by name": noticed - caught, "cases": len(control.records)}


def control_run(runs: Runs, faults: Iterable[Fault], quick: bool) -> Examined:
    """The cases without a fault, and how often each calls what the faults change.

    Cases of the quick level that took at most `QUICK_SECONDS` or `FULL_SECONDS` when their baseline was made; one
    without a baseline takes part, and so does one that must notice a fault: FaultError where it is not there.
    """
    names = [case.id for case in registry(runs.studied.modules) if case.level == "quick"]
    asked = {fault.case: fault for fault in faults}
    if missing := asked.keys() - set(names):
        raise FaultError(f"{asked[missing.pop()].id}: its case is not one of {', '.join(names)}")
    known = baseline.expected_seconds(names, baseline.FOLDER)
    limit = QUICK_SECONDS if quick else FULL_SECONDS
    chosen = [name for name in names if known.get(name, 0.0) <= limit or name in asked]
    together = [chosen] if quick else [[name] for name in chosen]  # short ones: one process for all
    tasks = [Exposure(None, 0.0, tuple((name, 10 * FULL_SECONDS) for name in some)) for some in together]
    answers = runs.answers(tasks)
    records = {record.id: record for answer in answers for record in answer.records}
    calls = {name: counted for answer in answers for name, counted in answer.calls.items()}
    return Examined(tuple(records[name] for name in chosen), calls)


def examine_faults(runs: Runs, faults: Sequence[Fault], control: Examined) -> list[Finding]:
    """What the cases see of the faults: the one that must notice it, and short ones that call what it changes.

    A fault with a size that is only refused, or only crashes, is shown once more at the smaller `SIZES`.
    """
    findings = [Finding(fault) for fault in faults]
    seconds = {record.id: record.seconds for record in control.records}
    for finding in findings:
        called = [name for name, calls in control.calls.items() if calls.get(finding.fault.id)]
        finding.asked = [finding.fault.case]
        left = SHOWN_SECONDS
        for name in sorted(set(called) - {finding.fault.case}, key=lambda name: seconds[name]):
            left -= seconds[name]
            if left >= 0:
                finding.asked.append(name)
    for size in SIZES:
        shown = [
            finding
            for finding in findings
            if size == 1 or (finding.fault.size and not finding.caught and finding.failed | finding.apart)
        ]
        answers = runs.answers([_task(finding.fault, size, finding.asked, seconds) for finding in shown])
        for finding, answer in zip(shown, answers, strict=True):
            finding.calls += sum(sum(calls.values()) for calls in answer.calls.values())
            finding.sights, failed, apart = compared(control, answer)
            finding.failed, finding.apart = failed | finding.failed, apart | finding.apart
            finding.size = size
    return findings


def shrink(runs: Runs, findings: Iterable[Finding], control: Examined) -> None:
    """Find the smallest decade of every fault with a size that its keenest cases still see."""
    seconds = {record.id: record.seconds for record in control.records}
    searches = [Search.of(finding) for finding in findings if finding.caught and finding.fault.size]
    while open_ones := [(search, decade) for search in searches if (decade := search.next_decade()) is not None]:
        tasks = [_task(search.finding.fault, 10.0**-decade, search.cases, seconds) for search, decade in open_ones]
        for (search, decade), answer in zip(open_ones, runs.answers(tasks), strict=True):
            if compared(control, answer)[0]:
                search.seen = decade
            else:
                search.lost = decade
    for search in searches:
        search.finding.smallest = 10.0**-search.seen
        search.finding.unseen = None if search.lost is None else 10.0**-search.lost


def _name(task: Exposure) -> str:
    """Of a task, for people."""
    if task.fault is None:
        return f"control: {', '.join(case for case, _ in task.cases)}"
    return f"{task.fault.id} at size {task.size:g}"


def _task(fault: Fault, size: float, cases: Iterable[str], seconds: dict[str, float]) -> Exposure:
    times, more = PATIENCE
    return Exposure(fault, size, tuple((name, times * seconds[name] + more) for name in cases))
