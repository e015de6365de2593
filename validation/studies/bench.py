"""What every study is: cases that need a folder, many processes and hours; carried out, they are a report.

A study hands back cases as the suite has them (harness/case.py), whose functions work at a `Bench`: what was finished
there is kept, so that the same command continues after an interruption.  Their rows, tables and figures go to
report.json, the figures also to files beside it (maps and the faults are drawn as files alone), and verdicts follow
from the rows as everywhere.  What a part of a study has instead of an answer is a row that fails, never a part that is
missing.
"""

import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

from validation.harness.case import Case, CaseError, Found, gathered
from validation.harness.execution import Listener
from validation.harness.executors import ExecutorError, Opener, local_processes
from validation.harness.provenance import provenance
from validation.harness.rows import Against
from validation.harness.runner import failed_record, record_of
from validation.harness.schema import SCHEMA, CaseRecord, Code, Report, Row
from validation.harness.store import Store, store_in, write_json
from validation.report.figures import linked, write_figure

FIGURES = "figures"  # folder of their files, beside the report
GROUP = "studies"
HELD = Against("self", "what the study asks for")


@dataclass(frozen=True)
class Bench:
    """Where a study works, in its short form or in full, on which processes, and who is told."""

    folder: Path
    quick: bool
    say: Listener
    jobs: int = 1
    opener: Opener = local_processes
    facts: Mapping[str, Any] = field(default_factory=provenance)  # before anything runs

    @cached_property
    def store(self) -> Store:
        """Of finished parts."""
        return store_in(self.folder, self.say)

    def write(self, file: str, schema: str, **content: Any) -> None:
        """Numbers for other programs than the report: JSON, beside its schema and where it is from."""
        write_json(self.folder / file, {"schema": schema, "provenance": self.facts, "quick": self.quick} | content)


def study_case(
    name: str,
    find: Callable[[], Found],
    question: str,
    equations: str,
    sources: str,
    effects: str = "",
    code: Code = "suite",
) -> Case:
    """The case of a study; sources and effects are words in a text."""
    return Case(name, GROUP, "full", question, equations, tuple(sources.split()), partial(gathered, find),
                tuple(effects.split()), code=code)  # fmt: skip


def failed(name: str, why: object) -> Row:
    """The row of what has no answer: in its place stands why, of an exception its kind and text."""
    told = f"{type(why).__name__}: {why}" if isinstance(why, Exception) else str(why)
    row = HELD.count(f"{name}: answered (1: yes)", 1.0, None)
    return row.model_copy(update={"status": "error", "message": told})


def no_more(quantity: str, unit: str, found: float | None, most: float) -> Row:
    """A row for what is asked to be at most so large, a number or (nan) none."""
    return HELD.row(quantity, unit, 0.0, found, None, "absolute", required=most, pinned="unconverged")


def none_of(quantity: str, found: Sequence[str]) -> Row:
    """A row for what there should be none of, by name."""
    return HELD.count(quantity, 0.0, len(found), message="; ".join(found))


def carried_out(study: str, cases: Sequence[Case], bench: Bench, command: str) -> Report:
    """The report of a study, made by a command; errors as of `reported`."""
    begun = time.monotonic()
    records = [reported(case, bench.folder) for case in cases]
    return Report(
        schema_=SCHEMA,
        level=f"study {study}, short form" if bench.quick else f"study {study}",
        command=command,
        planned=len(cases),
        provenance=dict(bench.facts) | {"seconds": round(time.monotonic() - begun, 1), "jobs": bench.jobs},
        cases=records,
    )


def reported(case: Case, folder: Path) -> CaseRecord:
    """The record of a case, its figures written in the folder of the report; one that crashes says why.

    CaseError and ExecutorError are the caller's, and so is what the disk refuses; a traceback goes to ID.log.
    """
    begun = time.perf_counter()
    try:
        outcome = case.compute()
    except (CaseError, ExecutorError):
        raise
    except Exception as error:
        if isinstance(error, OSError) and not isinstance(error, (TimeoutError, ConnectionError)):
            raise
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{case.id}.log").write_text(traceback.format_exc(), "utf-8", "backslashreplace")
        return failed_record(case, f"{type(error).__name__}: {error}", time.perf_counter() - begun)
    for figure in outcome.figures:
        write_figure(figure, folder / FIGURES)
    shown = replace(outcome, figures=tuple(linked(figure, FIGURES) for figure in outcome.figures))
    return record_of(case, shown, time.perf_counter() - begun)
