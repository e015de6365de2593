"""Do the hard cases stay stable?  Every one in a row, over a denominator that is fixed beforehand.

The corpora of the boundary elements, of the finite element reference and of Persson's theory state what they expect
before anything runs.  Each case runs alone in a process under a time limit; corpus/endings.py says how it may end, and
counts that apart from whether the result is correct.  Planned and reported cases are counted and compared; a row that
is missing is an error of the study.

With `--random N --seed K` the cases are N scenes drawn at random instead (random_scenes.py), which random_trial.py
judges: the rows go to stability_random.json with the findings counted by kind, and the scenes of rows that do not
stand to the folder random/, so that each can be run alone.
"""

import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, replace
from functools import partial

from validation.corpus.endings import (
    GOOD,
    LIMITS,
    Trial,
    TrialRow,
    counts,
    measured,
    row_of,
    table_of,
    tasks_of,
)
from validation.corpus.hard.hard_case_run import TrialOutcome
from validation.corpus.random import random_trial
from validation.harness.case import Case, Found
from validation.harness.execution import Note
from validation.harness.executors import fresh_processes, local_processes
from validation.harness.schema import Cells, Row, Table
from validation.studies.bench import Bench, none_of, study_case

SCHEMA = "linecontact-stability/2"
FILE, RANDOM_FILE, RANDOM_FOLDER = "stability.json", "stability_random.json", "random"
Measure = Callable[[Trial], TrialOutcome]
ASKED = 10.0  # s of CPU time for a reduced case, as asked for; reported, seconds never gate


def random_tasks(number: int, seed: int) -> list[Trial]:
    """Scenes 0..number - 1 of a seed: each is the same whatever the number, and in whichever process."""
    names = (f"seed_{seed}_scene_{index}" for index in range(number))
    return [Trial("random", name, "reduced", LIMITS["reduced"]) for name in names]


def cases(
    bench: Bench, tasks: Sequence[Trial] | None = None, measure: Measure | None = None, file: str = FILE
) -> list[Case]:
    """The case of the study; quick: the reduced forms instead of the full ones.

    Other tasks than those of the study may be given, and another measurement than `measured`, importable by name. Rows
    depend on the processes of the bench by their seconds only, as long as none reaches its limit by the clock.
    """
    planned = tasks_of(bench.quick) if tasks is None else list(tasks)
    return [
        study_case("hard-cases", partial(_ended, bench, planned, measure or measured, file),
                   "Do the hard cases stay stable: does each end as expected, and is it correct?",
                   "statuses expected beforehand; certificates, closed forms and second routes", "carbone2009")
    ]  # fmt: skip


def _ended(bench: Bench, planned: Sequence[Trial], measure: Measure, file: str) -> Found:
    """RuntimeError for fewer rows than planned: a fault of this module."""
    rows, begun = list[TrialRow](), time.monotonic()
    for row in _rows(measure, planned, bench):
        rows.append(row)
        elapsed = time.monotonic() - begun
        bench.say(Note(f"[{len(rows)}/{len(planned)}] {_told(row)}; {elapsed:.0f} s so far"))
    order = {_key(task): place for place, task in enumerate(planned)}
    rows.sort(key=lambda row: order[_key(row)])
    if [_key(row) for row in rows] != list(order):
        raise RuntimeError(f"planned {len(planned)} cases, {len({_key(row) for row in rows})} of them reported")
    bench.write(file, SCHEMA, planned=len(planned), reported=len(rows), counts=counts(rows), findings=kinds(rows),
                rows=[asdict(row) for row in rows])  # fmt: skip
    for row in rows:
        if row.code == "random" and not row.stands:
            random_trial.case_of(row.id).write(bench.folder / RANDOM_FOLDER)
    yield from judged(rows)
    yield summary(rows)
    yield table_of(rows)
    yield {"cases": len(rows)}


def judged(rows: Sequence[TrialRow]) -> list[Row]:
    """Of every code, cases that did not end as expected, and those that did and are not correct."""
    found = []
    for code in dict.fromkeys(row.code for row in rows):
        chosen = [row for row in rows if row.code == code]
        ended = [_told(row) for row in chosen if row.ending not in GOOD]
        wrong = [_told(row) for row in chosen if row.ending in GOOD and not row.correct]
        found += [
            none_of(f"{code}: of {len(chosen)} cases, not ended as expected", ended),
            none_of(f"{code}: of {len(chosen)} cases, ended as expected and not correct", wrong),
        ]
    return found


def kinds(rows: Iterable[TrialRow]) -> dict[str, int]:
    """Cases with a finding of each kind, the most frequent first."""
    return dict(Counter(kind for row in rows for kind in sorted(set(row.kinds))).most_common())


def summary(rows: Sequence[TrialRow]) -> Table:
    """Counts of every code and of all; kinds of findings; what took long."""
    lines: list[Cells] = []
    for code in (*dict.fromkeys(row.code for row in rows), "all"):
        chosen = [row for row in rows if code in (row.code, "all")]
        lines += [[code, name, count] for name, count in counts(chosen).items()]
    lines += [["all", f"with a finding of {kind}", count] for kind, count in kinds(rows).items()]
    slow = [row for row in rows if row.form == "reduced" and (row.seconds or 0) > ASKED]
    lines += [[row.code, f"above {ASKED:g} s of CPU time: {row.id}", f"{row.seconds:.1f} s"] for row in slow]
    return Table(caption=f"How {len(rows)} cases ended.", columns=["code", "what", "count"], rows=lines)


def _rows(measure: Measure, tasks: Sequence[Trial], bench: Bench) -> Iterator[TrialRow]:
    """The rows of cases as they end, each in a process of its own; random ones share theirs."""
    drawn = [task for task in tasks if task.code == "random"]
    others = [task for task in tasks if task.code != "random"]
    store = replace(bench.store, each=False)
    for some, opener in ((others, fresh_processes), (drawn, local_processes)):
        found = store.answers(
            TrialRow, partial(_row, measure), some, lambda task: (f"{task.code} {task.id}", task.form), bench.jobs,
            opener, lambda task: task.limit,
        )  # fmt: skip
        for task, answer, seconds in found:
            late = isinstance(answer, TimeoutError)
            yield answer if isinstance(answer, TrialRow) else row_of(task, None if late else answer, seconds)


def _row(measure: Measure, task: Trial) -> TrialRow:
    """In a worker: the row of a case that ends."""
    return row_of(task, measure(task))


def _key(task: Trial | TrialRow) -> tuple[str, str, str]:
    return task.code, task.id, task.form


def _told(row: TrialRow) -> str:
    seconds = "" if row.seconds is None else f", {row.seconds:.1f} s"
    correct = "correct" if row.correct else "NOT correct"
    return f"{row.code} {row.id}: {row.ending}, {correct}{seconds}" + (f"; {row.message}" if row.message else "")
