"""First end of a branch on a span of the curve: the goal, a limit point, or a gap that closes.

Each end is an equilibrium with one more condition, located by itself.  The other conditions are evaluated at the
located end: a violated condition is met before it on the span.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.relaxation import interpenetration
from bem.loading.increments import Accuracy, Increments
from bem.path.fold import LimitPoint, LimitPoints
from bem.path.locating import AtControl, Refused, settle
from bem.path.span import Span
from bem.path.steps import Way
from bem.path.touch import Touch, locate_touch


@dataclass(frozen=True, eq=False)
class GoalReached:
    """State at the last value of the control, and its parameter on the span."""

    balance: Balance
    place: float


End = GoalReached | LimitPoint | Touch


def first_end(system: System, increments: Increments, span: Span, way: Way) -> End | Refused | None:
    """Return the first end of a branch on a span; None where there is none."""
    on_way = increments.way
    first: LimitPoint | Touch | Refused | None = LimitPoints(system, way.direction, on_way.tolerance).on(span)
    if isinstance(first, Refused):
        return first
    state, place = (span.last.balance.state, 1.0) if first is None else (first.at.balance.state, first.place)
    closed = interpenetration(system, state, on_way.allowed)
    if closed.position.size:
        first = locate_touch(system, span, (state, place), closed, on_way.tolerance)
        if isinstance(first, Refused):
            return first
    beyond = way.beyond(span.last.value if first is None else first.at.numbers.value)
    if beyond < 0:
        return first
    goal = _goal(system, increments.fine, span, way)
    at_goal = isinstance(first, LimitPoint) and beyond <= first.at.error.value
    return first if isinstance(goal, Refused) and at_goal else goal


def _goal(system: System, accuracy: Accuracy, span: Span, way: Way) -> GoalReached | Touch | Refused:
    """Return the stable state on a span at the last value of the control, or the touch before it."""
    places = span.reaches(way.end)
    if places.size == 0:
        return Refused.UNCLEAR
    start = replace(span.at(float(places[0])), value=way.end)
    settled = settle(system.sloped, start, AtControl(way.end), accuracy)
    if isinstance(settled, Refused):
        return settled
    balance = settled[0]
    if balance.factor is None or not span.holds(balance.state.patches, way.end):
        return Refused.FAR
    place = span.parameter(balance.state.patches)
    closed = interpenetration(system, balance.state, accuracy.allowed)
    if closed.position.size:
        return locate_touch(system, span, (balance.state, place), closed, accuracy.tolerance)
    return GoalReached(balance, place)
