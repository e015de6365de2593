"""Largest tension of a path: the least load on unloading, at turns of the load, at folds and on both sides of jumps.

The load turns on a branch where dP/ds = 0.  That place is found on a span of the curve by the secant of the rate, and
the equilibrium there is located in its plane, like any event, with its error: as the load is stationary, the place
itself counts in second order.  Dimensionless.
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
        """The least load; 0 before any tension."""
        return 0.0 if self.met is None else self.met.at.load

    def note(self, kind: Literal["turn", "fold", "jump"], at: EventNumbers, error: EventNumbers) -> None:
        """Keep a state, if its load is the least."""
        if at.load < self.load:
            self.met = PathTension(kind, at, error)


def turn_of_load(system: System, loads: Loads, span: Span, reach: float, below: float) -> Located | Refused | None:
    """Return the state in which the load is least on a span up to a parameter; None where it is not below a load."""
    place = loads.least_on(span, reach, below, TURNED)
    if place is None:
        return None
    patches, value = span.at(place)
    start = Start(patches, span.first.numbers.penetration, value)
    return locate(system, start, InPlane(patches, span.normal), loads.on_way)


def behind_jump(system: System, point: Equilibrium, error: EventNumbers, tolerance: float) -> Located | Refused:
    """Return the state behind a jump that begins at a control known to within an error, with its own."""
    start = Start(point.patches, point.state.penetration, point.value)
    at = locate(system, start, AtControl(point.value), tolerance, known=point.balance)
    if isinstance(at, Refused):
        return at
    moved = error.value * abs(at.balance.stiffness)
    own = at.error
    wider = EventNumbers(error.value, own.penetration + error.value, own.load + moved, own.potential)
    return Located(at.balance, at.numbers, wider, at.step)
