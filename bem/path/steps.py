"""Steps along a branch: predicted to second order, corrected in the plane of the step, judged by its misfit.

A step is accepted if K > 0 at its end, the Newton step that is left is short, and the chord agrees with the derivatives
at both ends (stand.py); where it does not, both ends are evaluated again more finely before a shorter step is tried,
because the error of an evaluation turns the tangent of a soft motion.

A step is as long as the second order of its prediction stays small: the third order, which the Newton step corrects,
then is smaller still.
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
from bem.path.span import MISFIT, ON_SPAN, Span
from bem.path.stand import SHORT, Stand, first_stand, stand_near

BENT = 0.08  # of a step: largest share of its second order; from 0.2 on five of six steps fail
SHORTER = 3.0  # times: a step that is refused is repeated
SHORTEST_STEP = 1e-6  # limit: units: a step that is not tried is shorter
FORESEEN = 1.3  # steps: how far ahead a fold is located from where the control turns by its two derivatives
BEFORE = 0.8  # of the way to where the control turns: the longest step, where no fold is located there
BEYOND = 1 + ON_SPAN  # times the way to the last value of the control, which then lies on the span


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


def step_from(system: System, at: Stand, h: float, way: Way) -> Span | Refused:
    """Return the span of a step along the curve, from a point to its prediction at a parameter."""
    motion, change = at.ahead(h)
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
    fits = span is not None and span.misfit <= MISFIT
    if not fits or not stand.is_clear:
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


def evaluated_at_itself(system: System, at: Stand, way: Way) -> Stand | Refused:
    """Evaluate a point at its own edges, until its Newton step is short; its derivatives are then better.

    A point whose Newton step is short already is evaluated more finely: the error of its evaluation is what is left.
    """
    while True:
        normal, start = at.rate / at.unit**2, Start(at.patches, at.numbers.penetration, at.value)
        evaluate = evaluated_finely if at.off <= SHORT else evaluated_anywhere
        balance = evaluate(system.sloped, start, way.tolerance)
        stand = _point_of(system, balance, at.value, normal, float(normal @ at.rate))
        if isinstance(stand, Refused) or stand.off <= SHORT:
            return stand
        if not stand.off < at.off:
            return Refused.DIVERGED
        at = stand


def predicted(at: Stand, length: float, way: Way) -> float:
    """Return the parameter to which a step leads along the Taylor series of a point.

    The motion is no longer than asked, nor so long that its second order counts much; the control changes by no more
    than its largest step.  The motion goes a little beyond the last value of the control, so that it lies on the span.
    """
    h = min(length / at.speed, 2 * BENT * at.speed / max(at.bending, np.finfo(float).tiny))
    rate, bend = at.control_rate * way.direction, at.control_bend * way.direction
    for limit in (way.largest, -BEYOND * way.beyond(at.value)):
        if h * rate + h**2 / 2 * bend >= limit > 0:
            h = min(h, 2 * limit / (rate + np.sqrt(max(rate**2 + 2 * bend * limit, 0.0))))
    return h


def _point_of(
    system: System, balance: Balance | Refused, value: float, normal: FloatArray, length: float
) -> Stand | Refused:
    """Return the point of the curve next to forces, in the plane of their edges."""
    if isinstance(balance, Refused):
        return balance
    return stand_near(system, balance, value, normal, length) or Refused.SINGULAR
