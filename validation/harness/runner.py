"""Runs cases in worker processes, keeps every finished one, and accounts for all of them.

Each case is one task on one BLAS thread; those that took longest when they ran before start first.  Its record goes to
OUT/cases/ID.json (store.py) as soon as it is there, with a key over the case, all sources and the versions of what they
run on: a run that was interrupted at any moment continues, and a record that other code made is computed again.  A case
that crashes is a record with its message (traceback in OUT/cases/ID.log), never a missing one; planned and reported
cases are counted and compared.
"""

import hashlib
import json
import time
import traceback
from collections.abc import Iterable, Mapping
from contextlib import closing
from pathlib import Path

from validation.harness.case import Case, Outcome
from validation.harness.execution import Ended, Listener, Note, Running, Started, run_in_processes
from validation.harness.executors import Opener, local_processes
from validation.harness.provenance import sources_digest, versions
from validation.harness.schema import CaseRecord
from validation.harness.store import Store
from validation.harness.verdict import counted

GUESSED_SECONDS = {"quick": 15.0, "standard": 60.0, "full": 300.0}  # of a case that never ran, by level


def run_cases(
    cases: Iterable[Case],
    folder: Path,
    jobs: int,
    report: Listener,
    expected: Mapping[str, float] | None = None,
    opener: Opener = local_processes,
    anew: bool = False,
) -> list[CaseRecord]:
    """Run what is not there yet; records in the order of the cases.

    Parameters
    ----------
    folder : Path
        Records go to folder/cases.
    expected : mapping of str to float
        Seconds that cases are expected to take, by id; what earlier runs in this folder took is preferred.
    opener : callable
        Opens the executor (executors.py).
    anew : bool
        Whether to run what is there too: cases whose sources are not among those that the key covers.

    Raises
    ------
    ExecutorError
        The executor is out of reach.
    KeyboardInterrupt
        After finished cases are stored.
    RuntimeError
        Fewer records than planned: a fault of this module.
    """
    planned = tuple(cases)
    store = folder / "cases"
    store.mkdir(parents=True, exist_ok=True)
    code = sources_digest()
    there = () if anew else planned
    stored = [_store(case, store, code, report).kept(CaseRecord, case.id) for case in there]
    records = {found.id: found for found in stored if found is not None and found.status == "run"}
    if records:
        report(Note(f"{len(records)} of {len(planned)} cases are there already"))
    waiting = [case for case in planned if case.id not in records]
    seconds = {case.id: _expected_seconds(case, store, expected or {}) for case in waiting}
    waiting.sort(key=lambda case: -seconds[case.id])
    for record in _computed(waiting, store, code, jobs, report, len(planned), seconds, opener):
        records[record.id] = record
    if set(records) != {case.id for case in planned}:
        raise RuntimeError(f"planned {len(planned)} cases, {len(records)} reported")
    if sources_digest() != code:
        report(Note("sources changed while cases ran: run again before trusting this report"))
    return [records[case.id] for case in planned]


def _computed(
    cases: list[Case],
    store: Path,
    code: str,
    jobs: int,
    report: Listener,
    planned: int,
    seconds: Mapping[str, float],
    opener: Opener,
) -> Iterable[CaseRecord]:
    """Records as they are finished; what is done and what is left is reported."""
    if not cases:
        return
    local = opener is local_processes
    workers = min(jobs, len(cases)) if local else 1
    where = counted(workers, "process", "processes") if local else "workers elsewhere"
    report(Note(f"{counted(len(cases), 'case')} on {where}"))
    begun, left = time.monotonic(), {case.id for case in cases}
    with closing(run_in_processes(_ran, cases, workers, opener=opener)) as events:
        for event in events:
            if isinstance(event, Started):
                report(Note(f"{event.item.id}: started"))
            elif isinstance(event, Running):
                names = ", ".join(
                    f"{case.id} ({passed:.0f} s)" for case, passed in zip(event.items, event.seconds, strict=True)
                )
                rest = dict(seconds)
                for case, passed in zip(event.items, event.seconds, strict=True):
                    rest[case.id] = max(seconds[case.id] - passed, 0.0)
                report(Note(f"{len(left)} of {planned} left, {_clock(begun, left, rest, workers)}; running: {names}"))
            elif isinstance(event, Ended):
                ran = event.answer
                if isinstance(ran, Exception):
                    ran = failed_record(event.item, f"{type(ran).__name__}: {ran}", 0.0), ""
                record = _kept(*ran, event.item, store, code)
                left.discard(record.id)
                ending = f"{record.seconds:.1f} s" if record.status == "run" else f"{record.status}: {record.message}"
                done = f"[{planned - len(left)}/{planned}]"
                report(Note(f"{done} {record.id}: {ending}; {_clock(begun, left, seconds, workers)}"))
                yield record


def _clock(begun: float, left: Iterable[str], seconds: Mapping[str, float], workers: int) -> str:
    """Time since the beginning, and the time that what is left would take on all workers."""
    elapsed = time.monotonic() - begun
    todo = [seconds[name] for name in left]
    ahead = max(sum(todo) / workers, max(todo)) if todo else 0.0
    return f"{elapsed:.0f} s so far, about {ahead:.0f} s to go"


def _expected_seconds(case: Case, store: Path, expected: Mapping[str, float]) -> float:
    """What the case took here before, also with other code; else what is expected of it; else a guess by level."""
    try:
        before = json.loads((store / f"{case.id}.json").read_text("utf-8"))["answer"]["seconds"]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        before = None
    if isinstance(before, float) and before > 0:
        return before
    return expected.get(case.id, GUESSED_SECONDS[case.level])


def _ran(case: Case) -> tuple[CaseRecord, str]:
    """One case, in a worker: its record, also when it crashes, and then the traceback ("" without one)."""
    begun = time.perf_counter()
    try:
        return record_of(case, case.compute(), time.perf_counter() - begun), ""
    except (Exception, SystemExit) as error:
        message = f"{type(error).__name__}: {error}"
        return failed_record(case, message, time.perf_counter() - begun), traceback.format_exc()


def _kept(record: CaseRecord, trace: str, case: Case, folder: Path, code: str) -> CaseRecord:
    """The record, after it and its traceback were stored."""
    log = folder / f"{case.id}.log"
    if trace:
        log.write_text(trace, "utf-8", "backslashreplace")
    else:
        log.unlink(missing_ok=True)
    _store(case, folder, code, lambda note: None).keep(CaseRecord, record, case.id)
    return record


def record_of(case: Case, outcome: Outcome, seconds: float) -> CaseRecord:
    """What is reported of a case that ran: all that it says and found, or why it was skipped."""
    known = vars(case) | vars(outcome)
    return CaseRecord(
        **{name: known[name] for name in CaseRecord.model_fields if name in known},
        drawn=[figure.id for figure in outcome.figures],
        seconds=seconds,
        status="not run" if outcome.skipped else "run",
        message=outcome.skipped,
    )


def failed_record(case: Case, message: str, seconds: float) -> CaseRecord:
    """What is reported of a case that crashed: kind and text of the exception in place of rows.

    Halves of surrogate pairs, which no file holds, stand in it by their escapes.
    """
    record = record_of(case, Outcome(rows=()), seconds)
    storable = message.encode("utf-8", "backslashreplace").decode()
    return record.model_copy(update={"status": "error", "message": storable})


def _store(case: Case, folder: Path, code: str, report: Listener) -> Store:
    """The store of the record of a case, which the same code, versions and scene made."""
    parts = (case.scene, code, json.dumps(versions(), sort_keys=True))
    return Store(folder, hashlib.sha256("\0".join(parts).encode()).hexdigest(), report, each=False)
