"""A case: a question, where its answer is known from, and the function that computes it.

`Case.compute` takes nothing and returns an `Outcome` of rows and figure data; it must be importable by name (a module
level function or a `functools.partial` of one), since cases run in processes of their own.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from validation.schema import Figure, Level, Row, Table


@dataclass(frozen=True)
class Outcome:
    """What a case found.

    Parameters
    ----------
    rows : tuple of Row
        The comparisons, at least one unless `skipped` says why not.
    figures, tables : tuples
        Data of figures and tables.
    counts : dict of str to int
        What the answer cost in unknowns, evaluations, factorisations: gated by baselines in a 20 % band.
    skipped : str
        The reason why the case could not run here, such as an optional package that is absent.
    """

    rows: tuple[Row, ...] = ()
    figures: tuple[Figure, ...] = ()
    tables: tuple[Table, ...] = ()
    counts: dict[str, int] = field(default_factory=dict)
    skipped: str = ""


@dataclass(frozen=True)
class Case:
    """A case of the registry.

    Parameters
    ----------
    id : str
        Lower case words joined by hyphens; names the files of the case.
    group : str
        Heading under which it is reported.
    level : {"quick", "standard", "full"}
        The lowest level at which it runs.
    question : str
        What is asked, in one sentence.
    equations : str
        The equations that answer it.
    sources : tuple of str
        Keys of validation/report/bibliography.json.
    compute : callable
        Returns the `Outcome`.
    effects : tuple of str
        Effects of the solver that are active.
    scene : str
        The scene, verbatim.
    """

    id: str
    group: str
    level: Level
    question: str
    equations: str
    sources: tuple[str, ...]
    compute: Callable[[], Outcome]
    effects: tuple[str, ...] = ()
    scene: str = ""
