"""A case: a question, where its answer is known from, and the function that computes it.

A function yields what it finds, in the order of the report: rows, figures, tables, and counts of work by their names.
`Case.compute` takes nothing and returns it `gathered`; it must be importable by name (a module level function or a
`functools.partial` of one), since cases run in processes of their own.

The registry holds all of them.  A case without question, equations, group or sources is refused when it is loaded, as
is a second case of the same name.  What a case compares is checked when it has run (schema.Row).
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from fnmatch import fnmatch
from importlib import import_module
from re import fullmatch
from typing import get_args

from validation.harness.schema import ID, Code, Figure, Level, Row, Table

LEVELS: tuple[Level, ...] = get_args(Level)
CASES = "validation.cases"  # loaded by its name, with its list MODULES: cases import what runs them


@dataclass(frozen=True)
class Outcome:
    """What a case found."""

    rows: tuple[Row, ...] = ()  # the comparisons, at least one unless `skipped` says why not
    figures: tuple[Figure, ...] = ()
    tables: tuple[Table, ...] = ()
    # what the answer cost in unknowns, evaluations, factorisations: gated by baselines in a 20 % band
    counts: dict[str, int] = field(default_factory=dict)
    skipped: str = ""  # the reason why the case could not run here, such as an optional package that is absent


Found = Iterator[Row | Figure | Table | dict[str, int]]


def gathered(find: Callable[[], Found]) -> Outcome:
    """What a case yields, each kind in its order, the counts together.

    TypeError for anything else, ValueError for a count of a name that another has.
    """
    found = list(find())
    for one in found:
        if not isinstance(one, (Row, Figure, Table, dict)):
            raise TypeError(f"a case yields rows, figures, tables and counts, not {type(one).__name__}")
    names = [name for one in found if isinstance(one, dict) for name in one]
    if len(set(names)) != len(names):
        raise ValueError(f"counts of one name: {', '.join(sorted({n for n in names if names.count(n) > 1}))}")
    return Outcome(
        rows=tuple(one for one in found if isinstance(one, Row)),
        figures=tuple(one for one in found if isinstance(one, Figure)),
        tables=tuple(one for one in found if isinstance(one, Table)),
        counts={name: count for one in found if isinstance(one, dict) for name, count in one.items()},
    )


@dataclass(frozen=True)
class Case:
    """A case of the registry."""

    id: str  # lower case words joined by hyphens; names the files of the case
    group: str  # heading under which it is reported
    level: Level  # the lowest one at which it runs
    question: str  # what is asked, in one sentence
    equations: str  # those that answer it
    sources: tuple[str, ...]  # keys of validation/report/bibliography.json
    compute: Callable[[], Outcome]
    effects: tuple[str, ...] = ()  # of the solver, that are active
    scene: str = ""  # verbatim
    code: Code = "bem"  # whose answers its rows judge, where they do not say otherwise
    problem: str = ""  # what is solved, in a few words: cases of one problem share a line of the matrix


class CaseError(ValueError):
    """A registry that cannot be used, or a case that is not in it."""


def registry(modules: Iterable[str] | None = None) -> tuple[Case, ...]:
    """The cases of these modules, all by default, in the order of the report; CaseError as of `checked`."""
    names = import_module(CASES).MODULES if modules is None else modules
    return checked(case for name in names for case in import_module(name).CASES)


def checked(found: Iterable[Case]) -> tuple[Case, ...]:
    """The cases; CaseError where one is incomplete, or two have one name."""
    cases = tuple(found)
    for case in cases:
        _check(case)
    ids = [case.id for case in cases]
    repeated = sorted({name for name in ids if ids.count(name) > 1})
    if repeated:
        raise CaseError(f"cases of the same name: {', '.join(repeated)}")
    return cases


def select(cases: Iterable[Case], level: str, pattern: str | None = None) -> tuple[Case, ...]:
    """Cases of a level and those below it, or of all levels those that a pattern names.

    A pattern that is the name of a case chooses that case only; any other those in whose name or group it occurs, or
    whose name or group it matches as a shell pattern. CaseError for an unknown level, or where nothing matches.
    """
    if level not in LEVELS:
        raise CaseError(f"level {level!r}: one of {', '.join(LEVELS)} is allowed")
    every = tuple(cases)
    if pattern is None:
        included = LEVELS[: LEVELS.index(level) + 1]
        return tuple(case for case in every if case.level in included)
    chosen = tuple(case for case in every if case.id == pattern) or tuple(
        case for case in every if any(pattern in name or fnmatch(name, pattern) for name in (case.id, case.group))
    )
    if not chosen:
        raise CaseError(f"--only {pattern!r} matches no case of: {', '.join(case.id for case in every)}")
    return chosen


def _check(case: Case) -> None:
    for name in ("id", "group", "question", "equations", "sources"):
        if not getattr(case, name):
            raise CaseError(f"case {case.id!r}: {name} is empty")
    if not fullmatch(ID, case.id):
        raise CaseError(f"case {case.id!r}: the id names files; letters, digits, dots, hyphens and underscores only")
    if case.level not in LEVELS:
        raise CaseError(f"case {case.id!r}: level {case.level!r} is not one of {', '.join(LEVELS)}")
