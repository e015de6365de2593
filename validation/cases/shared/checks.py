"""A case in words, scenes solved, and numbers of their states; rows against one reference are those of `Against`."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence, Sized
from functools import partial
from typing import Any

import numpy as np

import bem
from bem.scene.result import Result, State
from validation.harness.arrays import FloatArray
from validation.harness.case import Case, gathered
from validation.harness.case import Found as Found
from validation.harness.rows import Against as Against
from validation.harness.schema import Code, Level, Norm
from validation.routes.scenes import posed as posed
from validation.routes.scenes import scene_text

OVER_STATES: Norm = "maximum over states"


def case(
    identity: str,
    group: str,
    find: Callable[[], Found],
    question: str,
    equations: str,
    sources: str,
    effects: str = "",
    *,
    level: Level = "quick",
    scene: str = "",
    code: Code = "bem",
    problem: str = "",
) -> Case:
    """A case; sources and effects are words in a text, the scene is a name of the registry or a text of more lines."""
    text = scene_text(scene) if scene.isidentifier() else scene
    return Case(identity, group, level, question, equations, tuple(sources.split()), partial(gathered, find),
                tuple(effects.split()), text, code, problem)  # fmt: skip


def in_forms(
    forms: Mapping[str, tuple[Any, ...]], group: str, find: Callable[..., Found], *words: str, **named: Any
) -> Iterator[Case]:
    """One case in several forms, by their names: the level of each, and what `find` is given; the rest as `case`."""
    for identity, (level, *given) in forms.items():
        yield case(identity, group, partial(find, *given), *words, level=level, **named)


def solved(name: str, **tables: Any) -> Result:
    """The same, solved."""
    return bem.solve(posed(name, **tables))


def column(states: Iterable[Any], name: str, unit: float | None = None) -> list[Any]:
    """What every state, or event, says under a name; numbers in a unit, where one is given, None where it has none."""
    values = [getattr(state, name) for state in states]
    return values if unit is None else [None if value is None else value / unit for value in values]


def as_many(values: Sequence[Any], expected: Sized) -> list[Any]:
    """Values, if they are as many as expected; else nothing for every one, which is an error of its row."""
    return list(values) if len(values) == len(expected) else [None] * len(expected)


def touching(states: Iterable[State]) -> list[State]:
    """Those with patches and gaps."""
    return [state for state in states if state.edges]


def beside(edges: FloatArray, period: float) -> FloatArray:
    """The shorter of the patch and the gap beside every edge, (n_patches, 2), m."""
    lengths = np.diff(np.append(edges.ravel(), edges[0, 0] + period))
    return np.minimum(lengths, np.roll(lengths, 1)).reshape(edges.shape)


def refused(*results: Result) -> float:
    """How many states of some paths have a certificate that is not ok."""
    return float(sum(not state.certificate.ok for result in results for state in result.states))


def work(names: str, *results: Result) -> dict[str, int]:
    """What paths cost: the largest number of unknowns, and sums of evaluations, states, events; those named."""
    states = [state for result in results for state in result.states]
    known = {
        "unknowns": max((state.unknowns for state in states), default=0),
        "evaluations": sum(state.evaluations for state in states),
        "states": len(states),
        "events": sum(len(result.events) for result in results),
    }
    return {name: known[name] for name in names.split()}
