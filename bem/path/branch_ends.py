"""First end of a branch on a span of the curve: the goal, a limit point, or a gap that closes.

Each end is an equilibrium with one more condition, located by itself.  The other conditions are evaluated at the
located end: a violated condition is met before it on the span.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass

from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.relaxation import interpenetration
from bem.loading.increments import Increments
from bem.path.fold import LimitPoint, LimitPoints
from bem.path.locating import AtControl, Refused, Start, settle
from bem.path.span import Span
from bem.path.steps import Way
from bem.path.touch import Touch, locate_touch


@dataclass(frozen=True, eq=False)
class GoalReached:
    """State at the last value of the control, and its parameter on the span."""

    balance: Balance
    place: float


End = GoalReached | LimitPoint | Touch


@dataclass(frozen=True, eq=False)
class BranchEnds:
    """Search for the first end of a branch on its spans.

    Parameters
    ----------
    system : System
    increments : Increments
    """

    system: System
    increments: Increments

    def first(self, span: Span, way: Way) -> End | Refused | None:
        """Return the first end on a span; None where there is none."""
        on_way = self.increments.way
        first: LimitPoint | Touch | Refused | None = LimitPoints(self.system, way.direction, on_way.tolerance).on(span)
        if isinstance(first, Refused):
            return first
        state, place = (span.last.balance.state, 1.0) if first is None else (first.at.balance.state, first.place)
        closed = interpenetration(self.system, state, on_way.allowed)
        if closed.position.size:
            first = locate_touch(self.system, span, (state, place), closed, on_way.tolerance)
            if isinstance(first, Refused):
                return first
        beyond = way.beyond(span.last.value if first is None else first.at.numbers.value)
        if beyond < 0:
            return first
        goal = self._goal(span, way)
        at_goal = isinstance(first, LimitPoint) and beyond <= first.at.error.value
        return first if isinstance(goal, Refused) and at_goal else goal

    def _goal(self, span: Span, way: Way) -> GoalReached | Touch | Refused:
        """Return the stable state on a span at the last value of the control, or the touch before it."""
        places = span.reaches(way.end)
        if places.size == 0:
            return Refused.UNCLEAR
        patches, _ = span.at(float(places[0]))
        start = Start(patches, span.first.numbers.penetration, way.end)
        settled = settle(self.system.sloped, start, AtControl(way.end), self.increments.fine)
        if isinstance(settled, Refused):
            return settled
        balance = settled[0]
        if balance.factor is None or not span.holds(balance.state.patches, way.end):
            return Refused.FAR
        place = span.parameter(balance.state.patches)
        closed = interpenetration(self.system, balance.state, self.increments.fine.allowed)
        if closed.position.size:
            return locate_touch(self.system, span, (balance.state, place), closed, self.increments.fine.tolerance)
        return GoalReached(balance, place)
