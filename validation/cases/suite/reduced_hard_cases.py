"""The hard cases in their reduced forms as cases of the registry, one for each code: every one is a row.

What each expects is stated beforehand in hard_cases.py, hard_fem_cases.py and hard_persson_cases.py.  A row holds two
answers apart: whether the case ended as expected, and whether nothing was found against its result.  A case that
crashes is a row with its message.  At the quick level those run that take less than a third of a second, at the
standard level the others; the table of the first lists them too, so that the map of the report shows all.  Full forms:
`python -m validation study stability`.
"""

from collections.abc import Sequence
from functools import partial

from validation.cases.shared.checks import Against, Found, case
from validation.corpus.endings import GOOD, Trial, TrialRow, counts, measured, row_of, table_of, tasks_of
from validation.harness.schema import Code

EXPECTED = Against("self", "the expectation stated beforehand, and the checks that each case names")
NAMES: dict[Code, tuple[str, str, str]] = {
    "bem": ("boundary-elements", "the boundary element solver", "carbone2009 johnson1995 westergaard1939 tada2000"),
    "fem": ("finite-elements", "the finite element reference", "carbone2008 johnson1995 westergaard1939"),
    "persson": ("theory", "Persson's theory", "carbone2009 persson2001"),
}
QUICK: dict[str, tuple[str, ...]] = {
    "bem": (
        *("flat", "flat_without_adhesion", "gap_1e-4", "contact_fraction_1e-5", "tension_no_branch_carries"),
        *("thin_layer_without_adhesion", "thin_incompressible_layer", "last_gaps_that_close_together"),
        *("penetration_beyond_complete_contact", "harmonics_1", "harmonics_1_without_adhesion"),
        *("vanishing_patch_without_adhesion", "last_gap_without_adhesion"),
    ),
    "fem": (
        *("apart", "incompressible_by_displacement", "narrower_than_the_mesh", "poisson_ratio_-0.9"),
        *("poisson_ratio_0.5", "thin_incompressible_layer_in_complete_contact", "thin_incompressible_layer"),
    ),
    "persson": (
        *("complete_contact_without_adhesion", "nan_load", "no_load", "one_line_without_adhesion", "tension"),
        *("tiny_load_without_adhesion", "complete_contact", "work_1e-08", "nearly_complete_contact", "one_line"),
        *("rms_height_1e-09", "two_lines", "hurst_0.01"),
    ),
}


def _hard_cases(code: Code) -> Found:
    """Those of a code that the quick level leaves to this one."""
    return _of([task for task in tasks_of(quick=True) if task.code == code and task.id not in QUICK[code]])


def _quick() -> Found:
    every = tasks_of(quick=True)
    return _of([task for task in every if task.id in QUICK[task.code]], every)


def _of(planned: list[Trial], every: Sequence[Trial] = ()) -> Found:
    """Tasks that are run; those of all that are not are left to a higher level."""
    ended = [_ended(task) for task in planned]
    found = counts(ended)
    reached = found["converged"] + found["refused as expected"]
    yield EXPECTED.count("cases reported, ended as expected, correct", [len(planned)] * 3,
                         [len(ended), reached, found["correct"]])  # fmt: skip
    for row in ended:
        yield EXPECTED.count(f"{row.id}: ended as expected, correct", [1.0, 1.0], [row.ending in GOOD, row.correct],
                             message=row.message, code=None if row.code == "random" else row.code)  # fmt: skip
    yield table_of(ended, [task for task in every if task not in planned])


def _ended(task: Trial) -> TrialRow:
    """The row of a case, also when it crashes."""
    try:
        return row_of(task, measured(task))
    except Exception as error:
        return row_of(task, error)


EQUATIONS = "expected outcome stated beforehand; certificates, closed forms, second routes, invariances"
CASES = (
    *(
        case(f"hard-cases-{name}", "stability", partial(_hard_cases, code),
             f"Does {words} end as expected in every hard case, and is what it gives correct?",
             EQUATIONS, sources, level="standard", code=code)
        for code, (name, words, sources) in NAMES.items()
    ),
    case("hard-cases-quick", "stability", _quick,
         "Do the hard cases that take no time end as expected, and correct, by all three codes?",
         EQUATIONS, "carbone2009 johnson1995 westergaard1939 persson2001 carbone2008"),
)  # fmt: skip
