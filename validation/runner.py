"""Runs cases in worker processes, keeps every finished one, and accounts for all of them.

Each case is one process task on one BLAS thread.  Its record is written to OUT/cases/ID.json under a temporary name and
renamed, with a key over the case and all sources: a run that was interrupted goes on, and a record made by other
code is computed again.  A case that crashes is a record with its message (traceback in OUT/cases/ID.log), never a
missing one; planned and reported cases are counted and compared.
"""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import os
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError
from threadpoolctl import threadpool_limits

from validation.case import Case, Outcome
from validation.provenance import sources_digest
from validation.schema import CaseRecord

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
PULSE = 5.0  # s between signs of life


@dataclass(frozen=True)
class Note:
    """A line of progress."""

    text: str


Report = Callable[[Note], None]


def run_cases(cases: Iterable[Case], folder: Path, jobs: int, report: Report) -> list[CaseRecord]:
    """Run what is not there yet; records in the order of the cases.

    Parameters
    ----------
    cases : iterable of Case
    folder : Path
        Records go to folder/cases.
    jobs : int
        Worker processes.
    report : callable
        Gets a `Note` for every step.

    Raises
    ------
    KeyboardInterrupt
        After finished cases are stored.
    RuntimeError
        Fewer records than planned: a fault of this module.
    """
    planned = tuple(cases)
    store = folder / "cases"
    store.mkdir(parents=True, exist_ok=True)
    code = sources_digest()
    records = {case.id: found for case in planned if (found := _stored(case, store, code)) is not None}
    if records:
        report(Note(f"{len(records)} of {len(planned)} cases are there already"))
    waiting = [case for case in planned if case.id not in records]
    waiting.sort(key=lambda case: case.level == "quick")
    for record in _computed(waiting, store, code, jobs, report, len(records), len(planned)):
        records[record.id] = record
    if set(records) != {case.id for case in planned}:
        raise RuntimeError(f"planned {len(planned)} cases, {len(records)} reported")
    return [records[case.id] for case in planned]


def _computed(
    cases: list[Case], store: Path, code: str, jobs: int, report: Report, done: int, planned: int
) -> Iterable[CaseRecord]:
    """Records as they are finished; cases that a dying worker took with it run again, each in a pool of its own."""

    def kept(case: Case, record: CaseRecord) -> CaseRecord:
        nonlocal done
        _keep(record, case, store, code)
        done += 1
        outcome = f"{record.seconds:.1f} s" if record.status == "run" else f"{record.status}: {record.message}"
        report(Note(f"[{done}/{planned}] {case.id}: {outcome}"))
        return record

    orphans: list[Case] = []
    for case, record in _finished(cases, store, jobs, report):
        if record is None:
            orphans.append(case)
        else:
            yield kept(case, record)
    for orphan in orphans:
        for case, record in _finished([orphan], store, 1, report):
            yield kept(case, record or _failed(case, "the worker process ended without an answer", 0.0))


def _finished(cases: list[Case], store: Path, jobs: int, report: Report) -> Iterator[tuple[Case, CaseRecord | None]]:
    """Cases as they end, with their record; None when the pool broke, by this case or by another."""
    if not cases:
        return
    for name in THREAD_VARIABLES:
        os.environ[name] = "1"
    begun = time.monotonic()
    context = multiprocessing.get_context("spawn")
    workers = min(jobs, len(cases))
    with ProcessPoolExecutor(max_workers=workers, mp_context=context) as pool:
        running: dict[Future[CaseRecord], Case] = {pool.submit(_run, case, store): case for case in cases}
        report(Note(f"{len(cases)} cases on {workers} processes"))
        try:
            while running:
                finished, _ = wait(running, timeout=PULSE, return_when=FIRST_COMPLETED)
                if not finished:
                    names = ", ".join(case.id for case in list(running.values())[:workers])
                    elapsed = time.monotonic() - begun
                    report(Note(f"{len(running)} cases left after {elapsed:.0f} s; running: {names}"))
                for future in finished:
                    case = running.pop(future)
                    yield case, _result(future, case)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in multiprocessing.active_children():
                process.terminate()
            raise


def _run(case: Case, store: Path) -> CaseRecord:
    """One case, in a worker: its record, also when it crashes."""
    begun = time.perf_counter()
    try:
        with threadpool_limits(limits=1):
            outcome = case.compute()
        return _record(case, outcome, time.perf_counter() - begun)
    except (Exception, SystemExit) as error:
        (store / f"{case.id}.log").write_text(traceback.format_exc())
        return _failed(case, f"{type(error).__name__}: {error}", time.perf_counter() - begun)


def _result(future: Future[CaseRecord], case: Case) -> CaseRecord | None:
    """The record of a finished future, None when the pool broke."""
    try:
        return future.result()
    except BrokenProcessPool:
        return None
    except (Exception, SystemExit) as error:
        return _failed(case, f"{type(error).__name__}: {error}", 0.0)


def _record(case: Case, outcome: Outcome, seconds: float) -> CaseRecord:
    return CaseRecord(
        id=case.id,
        group=case.group,
        level=case.level,
        question=case.question,
        equations=case.equations,
        sources=list(case.sources),
        effects=list(case.effects),
        scene=case.scene,
        rows=list(outcome.rows),
        figures=list(outcome.figures),
        tables=list(outcome.tables),
        counts=dict(outcome.counts),
        seconds=seconds,
        status="not run" if outcome.skipped else "run",
        message=outcome.skipped,
    )


def _failed(case: Case, message: str, seconds: float) -> CaseRecord:
    record = _record(case, Outcome(rows=()), seconds)
    return record.model_copy(update={"status": "error", "message": message})


def _key(case: Case, code: str) -> str:
    return hashlib.sha256(f"{case.id}\0{case.scene}\0{code}".encode()).hexdigest()


def _stored(case: Case, store: Path, code: str) -> CaseRecord | None:
    """The stored record of a case if the same code made it and it did not crash."""
    try:
        content = json.loads((store / f"{case.id}.json").read_text())
        if content["key"] != _key(case, code):
            return None
        record = CaseRecord.model_validate(content["record"])
    except (OSError, ValueError, KeyError, TypeError, ValidationError):
        return None
    return record if record.status == "run" else None


def _keep(record: CaseRecord, case: Case, store: Path, code: str) -> None:
    content = {"key": _key(case, code), "record": record.model_dump(mode="json")}
    write_atomically(store / f"{record.id}.json", json.dumps(content, indent=1))


def write_atomically(path: Path, text: str) -> None:
    """Write a text file under a temporary name, flush it to disk and rename it."""
    temporary = path.with_name(path.name + ".part")
    with temporary.open("w", encoding="utf-8") as stream:
        stream.write(text)
        stream.flush()
        os.fsync(stream.fileno())
    temporary.replace(path)
