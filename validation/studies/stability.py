"""Do the hard cases stay stable?  Every one in a row, over a denominator that is fixed beforehand.

The corpora of the boundary elements (cases/hard_cases.py), of the finite element reference and of Persson's theory
state what they expect before anything runs.  Each case runs alone in a process under a time limit, and ends in one of

    converged             every status is the one expected
    refused as expected   with the reason, which names the argument
    refused               unexpectedly, with the reason: a failure
    not converged         some status is not the one expected
    crashed               any other exception, or the process died
    timed out             the limit was reached

Apart from that it is correct or not: certificates, events, closed forms, second routes found nothing against it.  A
case that converged and is not correct is the worst kind, and counted.  Planned and reported cases are counted and
compared; a row that is missing is an error of the study.  Rows already in stability.json that the same sources made
are kept, so that an interrupted study goes on.

With `--random N --seed K` the cases are N scenes drawn at random instead (random_scenes.py), which random_trial.py
judges: the rows go to stability_random.json with the findings counted by kind, and the scenes of rows that do not
stand to the folder random/, so that each can be run alone.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any, Literal, Protocol, get_args

from validation.cases import hard_case_run, hard_fem_cases, hard_persson_cases
from validation.cases.hard_case_run import Outcome
from validation.cases.hard_cases import HARD_CASES
from validation.execution import Ended, Running, run_in_processes, run_in_turn
from validation.provenance import provenance, sources_digest, versions
from validation.runner import Note
from validation.schema import Table
from validation.studies import random_trial
from validation.studies.store import text_table, write_json

SCHEMA = "linecontact-stability/1"
FILE, RANDOM_FILE, RANDOM_FOLDER = "stability.json", "stability_random.json", "random"
LIMITS = {"reduced": 120.0, "full": 1800.0}  # s of the clock
TOGETHER = 20  # random scenes that share a process, whose start takes as long as a scene
ASKED = 10.0  # s of CPU time for a reduced case, as asked for; reported, seconds never gate

Code = Literal["bem", "fem", "persson", "random"]
Form = Literal["reduced", "full"]
Ending = Literal["converged", "refused as expected", "refused", "not converged", "crashed", "timed out"]
ENDINGS: tuple[Ending, ...] = get_args(Ending)
GOOD: tuple[Ending, ...] = ("converged", "refused as expected")


@dataclass(frozen=True)
class Task:
    """A case of a code, in one of its forms, with the seconds it may take."""

    code: Code
    id: str
    form: Form
    limit: float


@dataclass(frozen=True)
class Row:
    """What became of a case; `correct` is False where there is no result to judge; `kinds` are those of findings."""

    code: Code
    id: str
    form: Form
    reason: str
    expected: tuple[str, ...]
    observed: tuple[str, ...]
    ending: Ending
    correct: bool
    message: str
    seconds: float | None
    kinds: tuple[str, ...] = ()

    @property
    def stands(self) -> bool:
        """Whether it ended as expected and is correct."""
        return self.ending in GOOD and self.correct


def tasks_of(quick: bool) -> list[Task]:
    """All cases of the three corpora, in order."""
    form: Form = "reduced" if quick else "full"
    return [Task(code, name, form, LIMITS[form]) for code, corpus in _corpora().items() for name in corpus]


def random_tasks(number: int, seed: int) -> list[Task]:
    """Scenes 0..number - 1 of a seed: each is the same whatever the number, and in whichever process."""
    names = (random_trial.RandomCase(seed, index).id for index in range(number))
    return [Task("random", name, "reduced", LIMITS["reduced"]) for name in names]


def run(
    folder: Path,
    quick: bool,
    report: Callable[[Note], None],
    tasks: Sequence[Task] | None = None,
    measure: Callable[[Task], Outcome] | None = None,
    jobs: int = 1,
    file: str = FILE,
) -> int:
    """Run the study, print its table, write stability.json; 1 when a case fails.

    Parameters
    ----------
    folder : Path
    quick : bool
        The reduced forms instead of the full ones.
    report : callable
        Gets a `Note` for every step.
    tasks : sequence of Task, optional
        Others than those of the study.
    measure : callable, optional
        Another measurement than `measured`, importable by name.
    jobs : int
        Cases at a time; rows depend on it by their seconds only, as long as none reaches its limit by the clock.
    file : str
        Name of the file of rows.

    Raises
    ------
    RuntimeError
        Fewer rows than planned: a fault of this module.
    """
    planned = tasks_of(quick) if tasks is None else list(tasks)
    key, facts = _key(), provenance()
    wanted = {_plain(task) for task in planned}
    rows = [row for row in _stored(folder / file, key) if _task(row) in wanted]
    if rows:
        report(Note(f"{len(rows)} of {len(planned)} cases are there already"))
    there, begun = {_task(row) for row in rows}, time.monotonic()
    missing = [task for task in planned if _plain(task) not in there]
    for row in _rows(measure or measured, missing, jobs, report):
        rows.append(row)
        elapsed = time.monotonic() - begun
        report(Note(f"[{len(rows)}/{len(planned)}] {_told(rows[-1])}; {elapsed:.0f} s so far"))
        _write(folder / file, key, facts, rows, len(planned))
    order = {_plain(task): place for place, task in enumerate(planned)}
    rows.sort(key=lambda row: order[_task(row)])
    if [_task(row) for row in rows] != list(order):
        raise RuntimeError(f"planned {len(planned)} cases, {len({_task(row) for row in rows})} of them reported")
    _write(folder / file, key, facts, rows, len(planned))
    for row in rows:
        if row.code == "random" and not row.stands:
            random_trial.case_of(row.id).drawn.write(folder / RANDOM_FOLDER)
    print(text_table(COLUMNS, [_cells(row) for row in rows]))
    for line in summary(rows, len(planned)):
        print(line)
    return 0 if all(row.stands for row in rows) else 1


def measured(task: Task) -> Outcome:
    """One case, in a process of its own."""
    return RUNNERS[task.code](_case(task), task.form == "full")


def row_of(task: Task, answer: Outcome | Exception | None, seconds: float | None = None) -> Row:
    """The row of a case from its outcome, from the exception in its place, or from neither: then the time was up."""
    case = _case(task)
    name: tuple[Code, str, Form, str] = (task.code, task.id, task.form, case.reason)
    if isinstance(answer, Outcome):
        message = "; ".join(filter(None, [answer.refused_reason, *answer.findings]))
        judged = (_ending(answer), answer.correct, message, answer.seconds)
        return Row(*name, answer.expected, answer.observed, *judged, answer.kinds)
    expected = case.expectation(task.form == "full")
    if answer is None:
        return Row(*name, expected, (), "timed out", False, f"no answer in {task.limit:g} s", seconds)
    return Row(*name, expected, (), "crashed", False, f"{type(answer).__name__}: {answer}", seconds)


def _ending(outcome: Outcome) -> Ending:
    if outcome.refused_reason is not None:
        return "refused as expected" if outcome.observed == outcome.expected else "refused"
    return "converged" if outcome.converged else "not converged"


def counts(rows: Iterable[Row]) -> dict[str, int]:
    """How many cases ended how, and how many are correct; the endings sum up to the rows."""
    known = list(rows)
    found: dict[str, int] = {ending: sum(row.ending == ending for row in known) for ending in ENDINGS}
    found["correct"] = sum(row.correct for row in known)
    found["converged, not correct"] = sum(row.ending == "converged" and not row.correct for row in known)
    return found


def kinds(rows: Iterable[Row]) -> dict[str, int]:
    """Cases with a finding of each kind, the most frequent first."""
    return dict(Counter(kind for row in rows for kind in sorted(set(row.kinds))).most_common())


def summary(rows: Sequence[Row], planned: int) -> list[str]:
    """Counts of every code and of all, over the cases planned."""
    lines = [f"planned {planned}, reported {len(rows)}"]
    for code in (*get_args(Code), "all"):
        chosen = [row for row in rows if code in (row.code, "all")]
        if chosen:
            told = ", ".join(f"{name} {count}" for name, count in counts(chosen).items())
            lines.append(f"{code}: {told}; of {len(chosen)}")
    found = kinds(rows)
    lines += [f"with findings: {', '.join(f'{kind} {count}' for kind, count in found.items())}"] if found else []
    slow = [f"{row.id} ({row.seconds:.1f} s)" for row in rows if row.form == "reduced" and (row.seconds or 0) > ASKED]
    lines += [f"above {ASKED:g} s of CPU time: {', '.join(slow)}"] if slow else []
    return lines + [f"FAILED {row.code} {row.id}: {_told(row)}" for row in rows if not row.stands]


COLUMNS = ["code", "case", "expected", "observed", "ending", "correct", "CPU s"]


def table_of(rows: Sequence[Row]) -> Table:
    """The rows as a table of a report."""
    form = rows[0].form if rows else "reduced"
    return Table(
        caption=f"Hard cases, {form} forms: what was expected beforehand, what came out, and whether it is correct.",
        columns=COLUMNS,
        rows=[_cells(row) for row in rows],
    )


class _Hard(Protocol):
    """A case whatever its code."""

    @property
    def id(self) -> str: ...

    @property
    def reason(self) -> str: ...

    def expectation(self, full: bool) -> tuple[str, ...]: ...


def _corpora() -> dict[Code, dict[str, _Hard]]:
    """The cases of every code by their names."""
    corpora: dict[Code, Sequence[_Hard]] = {
        "bem": HARD_CASES,
        "fem": hard_fem_cases.FEM_CASES,
        "persson": hard_persson_cases.PERSSON_CASES,
    }
    return {code: {case.id: case for case in cases} for code, cases in corpora.items()}


def _case(task: Task) -> _Hard:
    """The case of a task."""
    return random_trial.case_of(task.id) if task.code == "random" else _corpora()[task.code][task.id]


RUNNERS: dict[Code, Callable[[Any, bool], Outcome]] = {
    "bem": hard_case_run.run_case,
    "fem": hard_fem_cases.run_case,
    "persson": hard_persson_cases.run_case,
    "random": random_trial.run_case,
}


def _rows(
    measure: Callable[[Task], Outcome], tasks: Sequence[Task], jobs: int, report: Callable[[Note], None]
) -> Iterator[Row]:
    """The rows of cases as they end, up to `jobs` at a time, each in a process of its own, random ones in groups."""
    groups: list[tuple[Task, ...]] = [(task,) for task in tasks if task.code != "random"]
    drawn = [task for task in tasks if task.code == "random"]
    groups += [tuple(drawn[first : first + TOGETHER]) for first in range(0, len(drawn), TOGETHER)]
    if jobs == 1:
        for group in groups:
            yield from _in_turn(measure, group, report)
        return
    with closing(run_in_processes(partial(_listed, measure), groups, jobs)) as events:
        for event in events:
            names = [_name(group[0]) for group in (event.items if isinstance(event, Running) else (event.item,))]
            if isinstance(event, Ended):
                answer = event.answer
                yield from answer if isinstance(answer, list) else [row_of(task, answer) for task in event.item]
            elif isinstance(event, Running):
                report(Note(", ".join(f"{n} {passed:.0f} s" for n, passed in zip(names, event.seconds, strict=True))))
            else:
                report(Note(f"{names[0]}: started"))


def _listed(measure: Callable[[Task], Outcome], tasks: Sequence[Task]) -> list[Row]:
    """The rows of cases that share a process, told at the end."""
    return list(_in_turn(measure, tasks, lambda note: None))


def _in_turn(
    measure: Callable[[Task], Outcome], tasks: Sequence[Task], report: Callable[[Note], None]
) -> Iterator[Row]:
    """Cases one after another in one process, which another replaces where a case kills it or reaches its limit."""
    with closing(run_in_turn(measure, tasks, lambda task: task.limit)) as events:
        for event, seconds in events:
            if isinstance(event, Ended):
                late = isinstance(event.answer, TimeoutError)
                yield row_of(event.item, None if late else event.answer, seconds)
            elif isinstance(event, Running):
                report(Note(f"{_name(event.items[0])}: {seconds:.0f} s"))
            else:
                report(Note(f"{_name(event.item)}: started"))


def _key() -> str:
    """What rows depend on: all sources and the versions of what they run on."""
    return hashlib.sha256((sources_digest() + json.dumps(versions(), sort_keys=True)).encode()).hexdigest()


def _stored(path: Path, key: str) -> list[Row]:
    """Rows of an earlier run of the same sources that have an answer."""
    try:
        content = json.loads(path.read_text("utf-8"))
        if content["schema"] != SCHEMA or content["key"] != key:
            return []
        rows = [Row(**{name: _tuple(row[name]) for name in NAMES}) for row in content["rows"]]
    except (OSError, ValueError, KeyError, TypeError):
        return []
    return [row for row in rows if row.ending not in ("crashed", "timed out")]


NAMES = tuple(field.name for field in fields(Row))


def _write(path: Path, key: str, facts: dict[str, Any], rows: Sequence[Row], planned: int) -> None:
    """The file of the study with the rows so far."""
    content = {
        "schema": SCHEMA,
        "key": key,
        "provenance": facts,
        "planned": planned,
        "reported": len(rows),
        "counts": counts(rows),
        "findings": kinds(rows),
        "rows": [asdict(row) for row in rows],
        "table": table_of(rows).model_dump(mode="json"),
    }
    write_json(path, content)


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _task(row: Row) -> tuple[str, str, str]:
    return row.code, row.id, row.form


def _name(task: Task) -> str:
    return f"{task.code} {task.id}"


def _plain(task: Task) -> tuple[str, str, str]:
    return task.code, task.id, task.form


def _cells(row: Row) -> list[str | float | int | None]:
    correct = "yes" if row.correct else "NO"
    seconds = None if row.seconds is None else round(row.seconds, 2)
    return [row.code, row.id, _short(row.expected), _short(row.observed), row.ending, correct, seconds]


def _short(statuses: Sequence[str]) -> str:
    """Statuses of the targets, runs of the same counted; the status of the result first where it is another."""
    shown = list(statuses)
    if len(shown) > 1 and shown[0] == "converged":
        shown = shown[1:]
    runs: list[list[Any]] = []
    for status in shown:
        if runs and runs[-1][0] == status:
            runs[-1][1] += 1
        else:
            runs.append([status, 1])
    return ", ".join(status if count == 1 else f"{count} {status}" for status, count in runs)


def _told(row: Row) -> str:
    seconds = "" if row.seconds is None else f", {row.seconds:.1f} s"
    correct = "correct" if row.correct else "NOT correct"
    return f"{row.code} {row.id}: {row.ending}, {correct}{seconds}" + (f"; {row.message}" if row.message else "")
