"""Events of a leap: brackets, which lie somewhere in an interval of the control.

Their numbers are those of the branch that ended, followed to the middle of the interval, and their errors say how far
its ends are.  The energy released is what two branches differ by there: their potentials at the end of the interval,
less the work that the difference of their loads does from its middle on.  Its error is that work; where it is negative
the leap itself lifted the contact into another minimum, and the error is no less than that.  Dimensionless.
"""

from __future__ import annotations

from bem.adhesive.branch import after_step, tangent
from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.relaxation import Relaxed
from bem.leaps.leap import Leapt
from bem.loading.increments import SAFETY
from bem.loading.path_events import EventNumbers, PathEvent, path_events


def brackets(system: System, landed: Leapt, value: float, width: float) -> tuple[PathEvent, ...]:
    """What happened in an interval of this width before the end of a leap that began at a value, and found edges.

    A snap that leaves all patches in place is an event if it surely releases energy.
    """
    relaxed, before = landed.relaxed, landed.before
    if before is None or relaxed.balance is None or not relaxed.changes:
        return ()
    middle, end, error = _bracket(system, before, value, relaxed.target, width)
    lag = (end.load - relaxed.balance.state.load) * width / 2
    released = end.potential - relaxed.balance.potential - lag
    doubt = max(abs(lag), -released)
    surely = any(kind != "bifurcation" for kind, _ in relaxed.changes)
    return path_events(relaxed.changes, middle, error, released, doubt) if surely or released > SAFETY * doubt else ()


def unbracketed(
    system: System, before: Balance, value: float, relaxed: Relaxed, width: float
) -> tuple[EventNumbers, EventNumbers]:
    """The end of a branch behind which there are no edges, with its error, in such an interval."""
    middle, _, error = _bracket(system, before, value, relaxed.target, width)
    return middle, error


def _bracket(
    system: System, before: Balance, value: float, target: float, width: float
) -> tuple[EventNumbers, EventNumbers, EventNumbers]:
    """A branch followed to the middle of an interval and to its end, and how far the ends are from the middle."""
    rate, change = tangent(system, before), target - value
    end = after_step(system, before, value, change * rate, change)
    middle = after_step(system, before, value, (change - width / 2) * rate, change - width / 2)
    return (
        middle,
        end,
        EventNumbers(
            abs(width) / 2,
            abs(end.penetration - middle.penetration),
            abs(end.load - middle.load),
            abs(end.potential - middle.potential),
        ),
    )
