"""A case: a question, where its answer is known from, and the function that computes it.

`Case.compute` takes nothing and returns an `Outcome` of rows and figure data; it must be importable by name (a module
level function or a `functools.partial` of one), since cases run in processes of their own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from validation.harness.schema import Code, Figure, Level, Row, Table


@dataclass(frozen=True)
class Outcome:
    """What a case found."""

    rows: tuple[Row, ...] = ()  # the comparisons, at least one unless `skipped` says why not
    figures: tuple[Figure, ...] = ()
    tables: tuple[Table, ...] = ()
    # what the answer cost in unknowns, evaluations, factorisations: gated by baselines in a 20 % band
    counts: dict[str, int] = field(default_factory=dict)
    skipped: str = ""  # the reason why the case could not run here, such as an optional package that is absent


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
