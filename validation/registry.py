"""The registry of all cases, and the choice of those that a run includes.

A case without question, equations, group or sources is refused when the registry is loaded, as is a second case of the
same name.  What a case compares is checked when it has run (schema.Row).
"""

from __future__ import annotations

from collections.abc import Iterable
from fnmatch import fnmatch
from importlib import import_module
from typing import get_args

from validation.case import Case
from validation.cases import MODULES
from validation.schema import Level

LEVELS: tuple[Level, ...] = get_args(Level)


class CaseError(ValueError):
    """A registry that cannot be used, or a case that is not in it."""


def registry(modules: Iterable[str] = MODULES) -> tuple[Case, ...]:
    """All cases, in the order of the report.

    Raises
    ------
    CaseError
        An incomplete case, or two of one name.
    """
    cases = tuple(case for name in modules for case in import_module(name).CASES)
    for case in cases:
        _check(case)
    ids = [case.id for case in cases]
    repeated = sorted({name for name in ids if ids.count(name) > 1})
    if repeated:
        raise CaseError(f"cases of the same name: {', '.join(repeated)}")
    return cases


def select(cases: Iterable[Case], level: str, pattern: str | None = None) -> tuple[Case, ...]:
    """Cases of a level and those below it, or of all levels those whose name or group matches a pattern.

    Raises
    ------
    CaseError
        Unknown level, or nothing matches.
    """
    if level not in LEVELS:
        raise CaseError(f"level {level!r}: one of {', '.join(LEVELS)} is allowed")
    every = tuple(cases)
    if pattern is None:
        included = LEVELS[: LEVELS.index(level) + 1]
        return tuple(case for case in every if case.level in included)
    chosen = tuple(case for case in every if fnmatch(case.id, pattern) or fnmatch(case.group, pattern))
    if not chosen:
        raise CaseError(f"--only {pattern!r} matches none of: {', '.join(case.id for case in every)}")
    return chosen


def _check(case: Case) -> None:
    for name in ("id", "group", "question", "equations", "sources"):
        if not getattr(case, name):
            raise CaseError(f"case {case.id!r}: {name} is empty")
    if case.level not in LEVELS:
        raise CaseError(f"case {case.id!r}: level {case.level!r} is none of {', '.join(LEVELS)}")
