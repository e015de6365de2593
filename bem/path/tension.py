"""Largest tension of a path: the least load on unloading, at turns of the load, at folds and on both sides of jumps.

The load turns on a branch where dP/ds = 0.  The turn is found on a span of the curve by the secant of the rate, and
its equilibrium is located in its plane, like any event, with its error: as the load is stationary, the place itself
counts in second order.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from bem.adhesive.equilibrium import System
from bem.loading.path_events import EventNumbers, PathTension
from bem.path.loads import Loads
from bem.path.locating import AtControl, InPlane, Located, Refused, Start, locate
from bem.path.points_with_edges import Equilibrium
from bem.path.span import Span

TURNED = 1e-7  # derived: of the change of the rate on a span: its square, 1e-14, is missing of the load


@dataclass(eq=False)
class LeastLoad:
    """Least load that a path has met on unloading, and the state in which it did; None before."""

    met: PathTension | None = None

    @property
    def load(self) -> float:
        """Least load; 0 before any tension."""
        return 0.0 if self.met is None else self.met.at.load

    def note(self, kind: Literal["turn", "fold", "jump"], at: EventNumbers, error: EventNumbers) -> None:
        """Keep a state if its load is the least.

        If a branch ends at the turn of its load, to within the errors, the end of the branch replaces the turn.
        """
        met = self.met
        ends_in_turn = met is not None and met.kind == "turn" and kind != "turn"
        within = met.error.load + error.load if met is not None and ends_in_turn else 0.0
        if at.load < self.load + within:
            self.met = PathTension(kind, at, error)


def turn_of_load(system: System, loads: Loads, span: Span, reach: float, below: float) -> Located | Refused | None:
    """Return the state of least load on a span up to a parameter; None where the load is not below `below`."""
    point = loads.least_on(span, reach, below, TURNED)
    if point is None:
        return None
    start = Start(point.patches, point.numbers.penetration, point.value)
    return locate(system, start, InPlane(point.patches, span.normal), loads.on_way)


def behind_jump(system: System, point: Equilibrium, error: EventNumbers, tolerance: float) -> Located | Refused:
    """Return the state behind a jump, its error widened by the error of the control at which the jump begins."""
    start = Start(point.patches, point.state.penetration, point.value)
    at = locate(system, start, AtControl(point.value), tolerance, known=point.balance)
    if isinstance(at, Refused):
        return at
    moved = error.value * abs(at.balance.stiffness)
    own = at.error
    wider = EventNumbers(error.value, own.penetration + error.value, own.load + moved, own.potential)
    return Located(at.balance, at.numbers, wider, at.step)
