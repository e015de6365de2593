"""The hard cases in their reduced forms as cases of the registry, one for each code: every one is a row.

What each expects is stated beforehand in hard_cases.py, hard_fem_cases.py and hard_persson_cases.py.  A row holds two
answers apart: whether the case ended as expected, and whether nothing was found against its result.  A case that
crashes is a row with its message.  The full forms are those of `python -m validation study stability`.
"""

from __future__ import annotations

from functools import partial

from validation.corpus.endings import GOOD, Code, Task, counts, measured, row_of, table_of, tasks_of
from validation.corpus.endings import Row as HardRow
from validation.harness.case import Case, Outcome
from validation.harness.rows import counted
from validation.harness.schema import Reference

REFERENCE = Reference(kind="self", source="the expectation stated beforehand, and the checks that each case names")


def _hard_cases(code: Code) -> Outcome:
    planned = [task for task in tasks_of(quick=True) if task.code == code]
    ended = [_ended(task) for task in planned]
    found = counts(ended)
    reached = found["converged"] + found["refused as expected"]
    total = counted("cases reported, ended as expected, correct", REFERENCE, [float(len(planned))] * 3,
                    [float(len(ended)), float(reached), float(found["correct"])])  # fmt: skip
    rows = (
        counted(f"{row.id}: ended as expected, correct", REFERENCE, [1.0, 1.0],
                [float(row.ending in GOOD), float(row.correct)], message=row.message)
        for row in ended
    )  # fmt: skip
    return Outcome(rows=(total, *rows), tables=(table_of(ended),))


def _ended(task: Task) -> HardRow:
    """The row of a case, also when it crashes."""
    try:
        return row_of(task, measured(task))
    except Exception as error:
        return row_of(task, error)


NAMES: dict[Code, tuple[str, str, tuple[str, ...]]] = {
    "bem": (
        "boundary-elements",
        "the boundary element solver",
        ("carbone2009", "johnson1995", "westergaard1939", "tada2000"),
    ),
    "fem": ("finite-elements", "the finite element reference", ("carbone2008", "johnson1995", "westergaard1939")),
    "persson": ("theory", "Persson's theory", ("carbone2009", "persson2001")),
}

CASES = tuple(
    Case(id=f"hard-cases-{NAMES[code][0]}", group="stability", level="standard",
         question=f"Does {NAMES[code][1]} end as expected in every hard case, and is what it gives correct?",
         equations="expected outcome stated beforehand; certificates, closed forms, second routes, invariances",
         sources=NAMES[code][2], compute=partial(_hard_cases, code))
    for code in NAMES
)  # fmt: skip
