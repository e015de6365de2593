"""What comes first on a piece of the curve: its goal, a limit point, or a gap that closes.

Each is an equilibrium with one more condition, located by itself.  At the one that is located the others are evaluated:
one that is violated lies before it.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass

from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.relaxation import interpenetration
from bem.continuation.curve import Piece
from bem.continuation.folds import LimitPoint, LimitPoints
from bem.continuation.locating import AtControl, Refused, Start, settle
from bem.continuation.steps import Way
from bem.continuation.touches import Touch, locate_touch
from bem.loading.increments import Increments


@dataclass(frozen=True, eq=False)
class Goal:
    """The state at the last value of the control, and its parameter."""

    balance: Balance
    place: float


End = Goal | LimitPoint | Touch


@dataclass(frozen=True, eq=False)
class BranchEnds:
    """Finds the first end of a branch on its pieces.

    Parameters
    ----------
    system : System
    increments : Increments
    """

    system: System
    increments: Increments

    def first(self, piece: Piece, way: Way) -> End | Refused | None:
        """The first one on a piece; None where there is none."""
        on_way = self.increments.way
        first: LimitPoint | Touch | Refused | None = LimitPoints(self.system, way.direction, on_way.tolerance).on(piece)
        if isinstance(first, Refused):
            return first
        state, place = (piece.last.balance.state, 1.0) if first is None else (first.at.balance.state, first.place)
        closed = interpenetration(self.system, state, on_way.allowed)
        if closed.position.size:
            first = locate_touch(self.system, piece, (state, place), closed, on_way.tolerance)
            if isinstance(first, Refused):
                return first
        beyond = way.beyond(piece.last.value if first is None else first.at.numbers.value)
        if beyond < 0:
            return first
        goal = self._goal(piece, way)
        at_goal = isinstance(first, LimitPoint) and beyond <= first.at.error.value
        return first if isinstance(goal, Refused) and at_goal else goal

    def _goal(self, piece: Piece, way: Way) -> Goal | Touch | Refused:
        """The stable state on a piece at the last value of the control, or the touch before it."""
        places = piece.reaches(way.end)
        if places.size == 0:
            return Refused.UNCLEAR
        patches, _ = piece.at(float(places[0]))
        start = Start(patches, piece.first.numbers.penetration, way.end)
        settled = settle(self.system.sloped, start, AtControl(way.end), self.increments.fine)
        if isinstance(settled, Refused):
            return settled
        here = settled[0]
        if here.factor is None or not piece.holds(here.state.patches, way.end):
            return Refused.FAR
        place = piece.parameter(here.state.patches)
        found = interpenetration(self.system, here.state, self.increments.fine.allowed)
        if found.position.size:
            return locate_touch(self.system, piece, (here.state, place), found, self.increments.fine.tolerance)
        return Goal(here, place)
