"""A case in words, scenes solved, numbers of their states, and rows against one reference.

A tolerance is 2.5 times the error measured, which stands in the row; or it is `required`, as asked for whatever was
measured; or it is given as (tolerance, measured).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Literal

import bem
from bem.scene.result import Result, State
from bem.scene.scene import Scene
from validation.harness.case import Case, Outcome
from validation.harness.rows import Pinned, compared, counted
from validation.harness.schema import Band, Code, Level, Norm, Reference, ReferenceKind, Row
from validation.references import adapters

Values = float | None | Iterable[float | None]
Work = Literal["unknowns", "evaluations", "states", "events"]

SAFETY = 2.5  # times the error measured: a tolerance
OVER_STATES: Norm = "maximum over states"
REVIEW = "2027-11-21"  # of known discrepancies


@dataclass(frozen=True)
class Against:
    """Makes rows against one reference; the first arguments of all are quantity, unit, expected and computed values."""

    kind: ReferenceKind
    source: str
    uncertainty: float = 0.0

    @property
    def reference(self) -> Reference:
        """As rows hold it."""
        return Reference(kind=self.kind, source=self.source, uncertainty=self.uncertainty)

    def row(
        self,
        quantity: str,
        unit: str,
        expected: Values,
        computed: Values,
        measured: float | tuple[float, float],
        norm: Norm = "relative",
        scale: float | None = None,
        *,
        required: float | None = None,
        uncertainty: float = 0.0,
        pinned: Pinned = "converged",
        code: Code | None = None,
    ) -> Row:
        """A comparison with a tolerance, scaled as `compared` does."""
        allowed, known = measured if isinstance(measured, tuple) else (SAFETY * measured, measured)
        return compared(quantity, unit, self.reference, _listed(expected), _listed(computed),
                        allowed if required is None else required, known, norm, scale,
                        basis="measured" if required is None else "required", pinned=pinned, uncertainty=uncertainty,
                        code=code)  # fmt: skip

    def count(
        self, quantity: str, expected: Values, computed: Values, tolerance: float = 0.5, message: str = ""
    ) -> Row:
        """A comparison of counts, or of yes (1) and no (0)."""
        return counted(quantity, self.reference, _listed(expected), _listed(computed), tolerance, message)

    def ratio(
        self,
        quantity: str,
        unit: str,
        expected: Values,
        computed: Values,
        band: tuple[float, float],
        cause: str,
        source: str,
        *,
        uncertainty: float = 0.0,
        review: str = REVIEW,
    ) -> Row:
        """A known discrepancy: the ratio lies in a band, for this cause, by this source."""
        known = Band(low=band[0], high=band[1], cause=cause, source=source, review=review)
        return Row(quantity=quantity, unit=unit, reference=self.reference, norm="ratio", expected=_listed(expected),
                   computed=_listed(computed), uncertainty=uncertainty, band=known)  # fmt: skip


def _listed(values: Values) -> list[float | None]:
    many = values if isinstance(values, Iterable) else [values]
    return [None if value is None else float(value) for value in many]


def case(
    identity: str,
    group: str,
    compute: Callable[[], Outcome],
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
    text = adapters.scene_text(scene) if scene.isidentifier() else scene
    return Case(identity, group, level, question, equations, tuple(sources.split()), compute, tuple(effects.split()),
                text, code, problem)  # fmt: skip


def posed(name: str, **tables: Any) -> Scene:
    """A scene of the registry with some keys of its tables changed; None removes a table or key."""
    return adapters.scene(name, tables)


def solved(name: str, **tables: Any) -> Result:
    """The same, solved."""
    return bem.solve(posed(name, **tables))


def column(states: Iterable[Any], name: str, unit: float | None = None) -> list[Any]:
    """What every state, or event, says under a name; numbers in a unit, where one is given, None where it has none."""
    values = [getattr(state, name) for state in states]
    return values if unit is None else [None if value is None else value / unit for value in values]


def touching(states: Iterable[State]) -> list[State]:
    """Those with patches and gaps."""
    return [state for state in states if state.edges]


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
