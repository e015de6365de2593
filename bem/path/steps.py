"""Steps along a branch: predicted to second order, corrected in the plane of the step, judged by its misfit.

A step is accepted if K > 0 at its end, the Newton step that is left is short, and the chord agrees with the derivatives
at both ends (stand.py).  Where it does not, the end is evaluated again more finely before a shorter step is tried, and
then the start: what Newton left there, or the error of a faint K, turns the tangent of a soft motion.

The Newton step and the misfit are of third order in the length of the step, which grows or shrinks with the cube root
of the ratio of the Newton step to the step it should be (pacopy's and AUTO's control does the same by the count of
iterations).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.third_derivatives import with_slopes
from bem.geometry.arrays import FloatArray
from bem.path.locating import Refused, Start, evaluated_anywhere, evaluated_finely
from bem.path.points_with_edges import Equilibrium
from bem.path.span import MISFIT, Span
from bem.path.stand import SHORT, Stand, first_stand, stand_near

GOOD = MISFIT / 2  # units: the Newton step that a prediction should leave
SHORTER = 3.0  # times: a step that is refused is repeated
LONGER = SHORTER**0.5  # times the last step: the next, at most
BENT = 2 * MISFIT  # of a step: its second order, at most
SHORTEST_STEP = 1e-6  # limit: units: a step that is not tried is shorter
PAST = GOOD  # units: how far a step may go past where the control turns
BEYOND = 1 + MISFIT  # times the way to where the control turns, or to its last value: both then lie on the span


@dataclass(frozen=True, eq=False)
class Way:
    """Direction, end and step limits with which a branch is followed.

    Attributes
    ----------
    direction : float
        Sign of the motion of the control.
    end : float
        Last value of the control.
    longest : float
        Length of a step, in units.
    largest : float
        Change of the control in a step.
    tolerance : float
        Tolerance of the evaluations.
    """

    direction: float
    end: float
    longest: float
    largest: float
    tolerance: float

    def beyond(self, value: float) -> float:
        """Return the distance by which a value lies beyond the end."""
        return (value - self.end) * self.direction


def curve_from(system: System, point: Equilibrium, way: Way) -> Stand | None:
    """Return the first point of the curve of a stable state."""
    balance = with_slopes(system, point.balance, point.value, way.tolerance)
    return first_stand(system, balance, point.value, way.direction)


def step_from(system: System, at: Stand, ahead: tuple[FloatArray, float], way: Way) -> Span | Refused:
    """Return the span of a step along the curve, from a point to its prediction `ahead`."""
    motion, change = ahead
    tried = float(np.max(np.abs(motion / at.unit)))
    normal = motion / at.unit**2
    start = Start(at.patches.moved(motion), at.numbers.penetration, at.value + change)
    balance = evaluated_anywhere(system.sloped, start, way.tolerance)
    stand = _point_of(system, balance, start.value, normal, float(normal @ motion))
    if isinstance(stand, Refused):
        return stand
    if stand.off > tried / SHORTER:
        return Refused.DIVERGED
    span = Span.between(at, stand)
    if span is None or span.misfit > MISFIT or not stand.is_clear:
        refined = evaluated_at_itself(system, stand, way)
        if isinstance(refined, Refused):
            return refined
        span = Span.between(at, refined)
    return span if span is not None and span.misfit <= MISFIT else Refused.MISFIT


def shorter_steps(length: float) -> Iterator[float]:
    """Yield a length, and shorter lengths."""
    while length >= SHORTEST_STEP:
        yield length
        length /= SHORTER


def growth(span: Span) -> float:
    """Return the factor by which the next step may be longer."""
    return float(np.cbrt(GOOD / max(span.last.off, GOOD / LONGER**3)))


def evaluated_at_itself(system: System, at: Stand, way: Way) -> Stand | Refused:
    """Evaluate a point finely at its own edges, until its Newton step is short; its derivatives are then better."""
    while True:
        normal = at.rate / at.unit**2
        balance = evaluated_finely(system.sloped, Start(at.patches, at.numbers.penetration, at.value), way.tolerance)
        stand = _point_of(system, balance, at.value, normal, float(normal @ at.rate))
        if isinstance(stand, Refused) or stand.off <= SHORT:
            return stand
        if not stand.off < at.off:
            return Refused.DIVERGED
        at = stand


def predicted(at: Stand, length: float, way: Way) -> tuple[FloatArray, float]:
    """Return the motion of the edges and the change of the control along the Taylor series.

    The motion is as long as asked, and the control changes by no more than its largest step.  The motion goes a little
    beyond a turn of the control and beyond its last value, so that both lie on the span.
    """

    def at_parameter(h: float) -> tuple[FloatArray, float]:
        return h * at.rate + h**2 / 2 * at.bend, h * at.control_rate + h**2 / 2 * at.control_bend

    bent = float(np.max(np.abs(at.bend / at.unit)))
    h = min(length / at.speed, 2 * BENT * at.speed / bent if bent > 0 else np.inf)
    for _ in range(3):
        h *= min(1.0, length / float(np.max(np.abs(at_parameter(h)[0] / at.unit))))
    rate, bend = at.control_rate * way.direction, at.control_bend * way.direction
    if bend < 0 < rate:
        turn = -rate / bend
        h = min(h, max(BEYOND * turn, turn + PAST / at.speed))
    for limit in (way.largest, -BEYOND * way.beyond(at.value)):
        if h * rate + h**2 / 2 * bend >= limit > 0:
            h = min(h, 2 * limit / (rate + np.sqrt(max(rate**2 + 2 * bend * limit, 0.0))))
    return at_parameter(h)


def _point_of(
    system: System, balance: Balance | Refused, value: float, normal: FloatArray, length: float
) -> Stand | Refused:
    """Return the point of the curve next to forces, in the plane of their edges."""
    if isinstance(balance, Refused):
        return balance
    return stand_near(system, balance, value, normal, length) or Refused.SINGULAR
