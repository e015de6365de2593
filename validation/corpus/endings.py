"""What became of a case of the corpus: a row that holds how it ended and, apart from that, whether it is correct.

The corpora of the boundary elements (hard_cases.py), of the finite element reference (hard_fem_cases.py), of Persson's
theory (hard_persson_cases.py) and of scenes drawn at random (random_trial.py) state what they expect before anything
runs.  Each case ends in one of

    converged             every status is the one expected
    refused as expected   with the reason, which names the argument
    refused               unexpectedly, with the reason: a failure
    not converged         some status is not the one expected
    crashed               any other exception, or the process died
    timed out             the limit was reached

Apart from that it is correct or not: certificates, events, closed forms, second routes found nothing against it.  A
case that converged and is not correct is the worst kind, and counted.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Literal, get_args

from validation.corpus.hard.hard_case_run import Asked, TrialOutcome, run
from validation.corpus.hard.hard_cases import HARD_CASES
from validation.corpus.hard.hard_fem_cases import FEM_CASES
from validation.corpus.hard.hard_persson_cases import PERSSON_CASES
from validation.corpus.random import random_trial
from validation.harness.schema import Cells, Table

LIMITS = {"reduced": 120.0, "full": 1800.0}  # s of the clock

Code = Literal["bem", "fem", "persson", "random"]
Form = Literal["reduced", "full"]
Ending = Literal["converged", "refused as expected", "refused", "not converged", "crashed", "timed out"]
ENDINGS: tuple[Ending, ...] = get_args(Ending)
GOOD: tuple[Ending, ...] = ("converged", "refused as expected")


@dataclass(frozen=True)
class Trial:
    """A case of a code, in one of its forms, with the seconds it may take."""

    code: Code
    id: str
    form: Form
    limit: float


@dataclass(frozen=True)
class TrialRow:
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


def tasks_of(quick: bool) -> list[Trial]:
    """All cases of the three corpora, in order."""
    form: Form = "reduced" if quick else "full"
    return [Trial(code, name, form, LIMITS[form]) for code, corpus in CORPORA.items() for name in corpus]


def measured(task: Trial) -> TrialOutcome:
    """One case, in a process of its own."""
    return run(_case(task), task.form == "full")


def row_of(task: Trial, answer: TrialOutcome | Exception | None, seconds: float | None = None) -> TrialRow:
    """The row of a case from its outcome, from the exception in its place, or from neither: then the time was up."""
    case = _case(task)
    if isinstance(answer, TrialOutcome):
        ending: Ending = "converged" if answer.converged else "not converged"
        if answer.refused_reason is not None:
            ending = "refused as expected" if answer.observed == answer.expected else "refused"
        message = "; ".join(filter(None, [answer.refused_reason, *answer.findings]))
        judged = (ending, answer.correct, message, answer.seconds, answer.kinds)
        return TrialRow(task.code, task.id, task.form, case.reason, answer.expected, answer.observed, *judged)
    ending, message = "timed out", f"no answer in {task.limit:g} s"
    if answer is not None:
        ending, message = "crashed", f"{type(answer).__name__}: {answer}"
    expected = case.expectation(task.form == "full")
    return TrialRow(task.code, task.id, task.form, case.reason, expected, (), ending, False, message, seconds)


def counts(rows: Iterable[TrialRow]) -> dict[str, int]:
    """How many cases ended how, and how many are correct; the endings sum up to the rows."""
    known = list(rows)
    found: dict[str, int] = {ending: sum(row.ending == ending for row in known) for ending in ENDINGS}
    found["correct"] = sum(row.correct for row in known)
    found["converged, not correct"] = sum(row.ending == "converged" and not row.correct for row in known)
    return found


COLUMNS = ["code", "case", "expected", "observed", "ending", "correct", "CPU s"]


def table_of(rows: Sequence[TrialRow], left: Sequence[Trial] = ()) -> Table:
    """The rows as a table of a report, with tasks that are left to a higher level."""
    form = rows[0].form if rows else "reduced"
    later = [[task.code, task.id, _short(_case(task).expectation(task.form == "full")), "", "not run", "–", None]
             for task in left]  # fmt: skip
    return Table(
        id=f"hard-{form}",
        caption=f"Hard cases, {form} forms: what was expected beforehand, what came out, and whether it is correct.",
        columns=COLUMNS,
        rows=[*map(cells, rows), *later],
    )


CORPORA: dict[Code, Mapping[str, Asked]] = {  # the cases of every code by their names
    "bem": {case.id: case for case in HARD_CASES},
    "fem": {case.id: case for case in FEM_CASES},
    "persson": {case.id: case for case in PERSSON_CASES},
}


def _case(task: Trial) -> Asked:
    """The case of a task."""
    return random_trial.case_of(task.id) if task.code == "random" else CORPORA[task.code][task.id]


def cells(row: TrialRow) -> Cells:
    """A row as cells of the columns `COLUMNS`."""
    correct = "yes" if row.correct else "NO"
    seconds = None if row.seconds is None else round(row.seconds, 2)
    return [row.code, row.id, _short(row.expected), _short(row.observed), row.ending, correct, seconds]


def _short(statuses: Sequence[str]) -> str:
    """Statuses of the targets, runs of the same counted; the status of the result first where it is another."""
    shown = list(statuses)
    if len(shown) > 1 and shown[0] == "converged":
        shown = shown[1:]
    runs = [(status, len(list(same))) for status, same in groupby(shown)]
    return ", ".join(status if count == 1 else f"{count} {status}" for status, count in runs)
