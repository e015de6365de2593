"""Do the hard cases stay stable?  Every one in a row, over a denominator that is fixed beforehand.

The corpora of the boundary elements, of the finite element reference and of Persson's theory state what they expect
before anything runs.  Each case runs alone in a process under a time limit; corpus/endings.py says how it may end, and
counts that apart from whether the result is correct.  Planned and reported cases are counted and compared; a row that
is missing is an error of the study.  Finished rows are kept (harness/store.py), so that an interrupted study continues.

With `--random N --seed K` the cases are N scenes drawn at random instead (random_scenes.py), which random_trial.py
judges: the rows go to stability_random.json with the findings counted by kind, and the scenes of rows that do not
stand to the folder random/, so that each can be run alone.
"""

import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any, get_args

from validation.corpus.endings import (
    COLUMNS,
    LIMITS,
    Code,
    Trial,
    TrialRow,
    cells,
    counts,
    measured,
    row_of,
    table_of,
    tasks_of,
)
from validation.corpus.hard.hard_case_run import TrialOutcome
from validation.corpus.random import random_trial
from validation.harness.execution import Listener, Note
from validation.harness.executors import fresh_processes, local_processes
from validation.harness.provenance import provenance
from validation.harness.store import Store, store_in, write_json
from validation.studies.shown import text_table

SCHEMA = "linecontact-stability/1"
FILE, RANDOM_FILE, RANDOM_FOLDER = "stability.json", "stability_random.json", "random"
Measure = Callable[[Trial], TrialOutcome]
ASKED = 10.0  # s of CPU time for a reduced case, as asked for; reported, seconds never gate


def random_tasks(number: int, seed: int) -> list[Trial]:
    """Scenes 0..number - 1 of a seed: each is the same whatever the number, and in whichever process."""
    names = (f"seed_{seed}_scene_{index}" for index in range(number))
    return [Trial("random", name, "reduced", LIMITS["reduced"]) for name in names]


def run(
    folder: Path,
    quick: bool,
    report: Listener,
    tasks: Sequence[Trial] | None = None,
    measure: Measure | None = None,
    jobs: int = 1,
    file: str = FILE,
) -> int:
    """Run the study, print its table, write stability.json (or `file`); 1 when a case fails.

    Quick: the reduced forms instead of the full ones. Other tasks than those of the study may be given, and another
    measurement than `measured`, importable by name. Rows depend on `jobs`, the cases at a time, by their seconds only,
    as long as none reaches its limit by the clock. RuntimeError for fewer rows than planned: a fault of this module.
    """
    planned = tasks_of(quick) if tasks is None else list(tasks)
    facts, rows, begun = provenance(), list[TrialRow](), time.monotonic()
    for row in _rows(measure or measured, planned, jobs, store_in(folder, report, each=False)):
        rows.append(row)
        elapsed = time.monotonic() - begun
        report(Note(f"[{len(rows)}/{len(planned)}] {_told(row)}; {elapsed:.0f} s so far"))
        _write(folder / file, facts, rows, len(planned))
    order = {_key(task): place for place, task in enumerate(planned)}
    rows.sort(key=lambda row: order[_key(row)])
    if [_key(row) for row in rows] != list(order):
        raise RuntimeError(f"planned {len(planned)} cases, {len({_key(row) for row in rows})} of them reported")
    _write(folder / file, facts, rows, len(planned))
    for row in rows:
        if row.code == "random" and not row.stands:
            random_trial.case_of(row.id).write(folder / RANDOM_FOLDER)
    print(text_table(COLUMNS, [cells(row) for row in rows]))
    for line in summary(rows, len(planned)):
        print(line)
    return 0 if all(row.stands for row in rows) else 1


def kinds(rows: Iterable[TrialRow]) -> dict[str, int]:
    """Cases with a finding of each kind, the most frequent first."""
    return dict(Counter(kind for row in rows for kind in sorted(set(row.kinds))).most_common())


def summary(rows: Sequence[TrialRow], planned: int) -> list[str]:
    """Counts of every code and of all, over the cases planned."""
    lines = [f"planned {planned}, reported {len(rows)}"]
    for code in (*get_args(Code), "all"):
        chosen = [row for row in rows if code in (row.code, "all")]
        if chosen:
            reported = ", ".join(f"{name} {count}" for name, count in counts(chosen).items())
            lines.append(f"{code}: {reported}; of {len(chosen)}")
    found = kinds(rows)
    lines += [f"with findings: {', '.join(f'{kind} {count}' for kind, count in found.items())}"] if found else []
    slow = [f"{row.id} ({row.seconds:.1f} s)" for row in rows if row.form == "reduced" and (row.seconds or 0) > ASKED]
    lines += [f"above {ASKED:g} s of CPU time: {', '.join(slow)}"] if slow else []
    return lines + [f"FAILED {row.code} {row.id}: {_told(row)}" for row in rows if not row.stands]


def _rows(
    measure: Callable[[Trial], TrialOutcome], tasks: Sequence[Trial], jobs: int, store: Store
) -> Iterator[TrialRow]:
    """The rows of cases as they end, up to `jobs` at a time, each in a process of its own; random ones share theirs."""
    drawn = [task for task in tasks if task.code == "random"]
    others = [task for task in tasks if task.code != "random"]
    for some, opener in ((others, fresh_processes), (drawn, local_processes)):
        found = store.answers(
            TrialRow, partial(_row, measure), some, lambda task: (f"{task.code} {task.id}", task.form), jobs, opener,
            lambda task: task.limit,
        )  # fmt: skip
        for task, answer, seconds in found:
            late = isinstance(answer, TimeoutError)
            yield answer if isinstance(answer, TrialRow) else row_of(task, None if late else answer, seconds)


def _row(measure: Measure, task: Trial) -> TrialRow:
    """In a worker: the row of a case that ends."""
    return row_of(task, measure(task))


def _write(path: Path, facts: dict[str, Any], rows: Sequence[TrialRow], planned: int) -> None:
    content = {
        "schema": SCHEMA,
        "provenance": facts,
        "planned": planned,
        "reported": len(rows),
        "counts": counts(rows),
        "findings": kinds(rows),
        "rows": [asdict(row) for row in rows],
        "table": table_of(rows).model_dump(mode="json"),
    }
    write_json(path, content)


def _key(task: Trial | TrialRow) -> tuple[str, str, str]:
    return task.code, task.id, task.form


def _told(row: TrialRow) -> str:
    seconds = "" if row.seconds is None else f", {row.seconds:.1f} s"
    correct = "correct" if row.correct else "NOT correct"
    return f"{row.code} {row.id}: {row.ending}, {correct}{seconds}" + (f"; {row.message}" if row.message else "")
