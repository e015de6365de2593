"""States at given loads on the stretches of a path.

On a stretch the load is monotonic (path.py splits it where the load turns); the parameter at which it has a value is
found by the Illinois form of the secant, each trial being a point of the curve, whose load is exact to second order.
Under a given separation the last gap closes, and the first opens, under a tension without bound: loads beyond the load
of the narrowest gap on the path are met in between, in the gap that a row of cracks has at the load (opening.py).
Dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from importlib import import_module

import numpy as np
from numpy.polynomial import polynomial

from bem.adhesive.equilibrium import System
from bem.elastic.collocation import evaluate
from bem.loading.complete_contact import CompleteContact
from bem.loading.control import LoadControl
from bem.loading.increments import MAXIMUM_ITERATIONS, Accuracy
from bem.path.locating import LAST, LOCATED, AtControl, AtLoad, Refused, Start, evaluated, settle
from bem.path.opening import FINEST_GAP, Flaw, flaw_of, opening_load, with_gap
from bem.path.points_with_edges import Equilibrium, Stretch
from bem.path.span import Span
from bem.path.stand import SHORT, Stand, stand_near

LOAD_ACCURACY = LOCATED / 100  # of the load, or of a load of 1e-3
DIGITS = 64  # derived: spacings of the control, by which rounding misses a load in a narrow gap; 26 at most


@dataclass(frozen=True, eq=False)
class Loads:
    """Search for loads on a path.

    Parameters
    ----------
    system : System
    complete : CompleteContact
    fine : Accuracy
        Accuracy of the states at loads.
    on_way : float
        Tolerance of evaluations on the way.
    asked : tuple of float
        Loads that are asked for on the way.
    """

    system: System
    complete: CompleteContact
    fine: Accuracy
    on_way: float
    asked: tuple[float, ...] = ()

    def on_stretch(self, stretch: Stretch, load: float) -> Equilibrium | None:
        """Return the state at a load between the loads at both ends of a stretch; None where there is none."""
        (a, b), span = stretch.ends, stretch.span
        miss_a, miss_b = (at - load for at in stretch.loads)
        if miss_a * miss_b > 0:
            return None
        allowed = LOAD_ACCURACY * max(abs(load), 1e-3)
        point: Stand | None = None
        for _ in range(MAXIMUM_ITERATIONS):
            s = (a * miss_b - b * miss_a) / (miss_b - miss_a)
            point = self.point(span, s)
            if point is None:
                return None
            miss = point.numbers.load - load
            if abs(miss) <= allowed:
                break
            if miss * miss_b < 0:
                a, miss_a = b, miss_b
            else:
                miss_a /= 2
            b, miss_b = s, miss
        return None if point is None else self._state_at(point, load, allowed)

    def _state_at(self, point: Stand, load: float, allowed: float) -> Equilibrium | None:
        """Return the state at a load near a point of the curve; near an extremum at the control of the point."""
        start = Start(point.patches, point.numbers.penetration, point.value)
        for on in (AtLoad(self.system, load, allowed), AtControl(point.value)):
            settled = settle(self.system.sloped, start, on, self.fine)
            if not isinstance(settled, Refused) and abs(settled[0].state.load - load) <= 10 * allowed:
                return Equilibrium.of(settled[1], settled[0], settled=True)
        return None

    def point(self, span: Span, s: float, near: float = SHORT) -> Stand | None:
        """Return the point of the curve at a parameter of a span, within so many units of where it is evaluated."""
        if s in (0.0, 1.0):
            return span.first if s == 0 else span.last
        start, last = span.at(s), np.inf
        while True:
            balance, value = evaluated(self.system.sloped, start, self.on_way), start.value
            point = None if isinstance(balance, Refused) else stand_near(self.system, balance, value, span.normal, 1.0)
            if point is None:
                return None
            if not near < point.off < last:
                return point
            last, start = point.off, Start(point.patches, point.numbers.penetration, point.value)

    def turns(self, span: Span, reach: float) -> Iterator[tuple[float, Stand]]:
        """Yield the turn of the load on a span up to a parameter, if a load asked for may lie beyond its ends.

        The cubic with the loads and their rates at both ends decides; the secant of the rate finds the parameter.
        """
        ends, rates = self._ends(span)
        if rates[0] * rates[1] >= 0 or not self._may_pass(ends, rates):
            return
        turn = self._turn(span, rates, LOCATED)
        if turn is not None and turn[0] < reach:
            yield turn

    def least_on(self, span: Span, reach: float, below: float, level: float) -> Stand | None:
        """Return the point up to a parameter at which the load is least on a span, if it may be below a load there."""
        ends, rates = self._ends(span)
        if not rates[0] < 0 < rates[1] or 2 * extremes(ends, rates)[1] - min(ends) >= below:
            return None
        turn = self._turn(span, rates, level, LAST)
        return None if turn is None or turn[0] >= reach else turn[1]

    def _ends(self, span: Span) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the loads at both ends of a span, and their rates by its parameter."""
        first, last = span.first, span.last
        return (first.numbers.load, last.numbers.load), (self._rate(span, first), self._rate(span, last))

    def _turn(
        self, span: Span, rates: tuple[float, float], level: float, near: float = SHORT
    ) -> tuple[float, Stand] | None:
        """Return the parameter and the point at which the rate of the load vanishes, by the Illinois secant.

        The rate vanishes to a level of its change on the span, in states within `near` of their evaluation.
        """
        (low, high), (rate_low, rate_high) = (0.0, 1.0), rates
        allowed = level * abs(rate_low - rate_high)
        for _ in range(MAXIMUM_ITERATIONS):
            s = low - rate_low * (high - low) / (rate_high - rate_low)
            point = self.point(span, s, near)
            if point is None:
                return None
            rate = self._rate(span, point)
            if abs(rate) <= allowed:
                return s, point
            if rate * rate_high < 0:
                low, rate_low = high, rate_high
            else:
                rate_low /= 2
            high, rate_high = s, rate
        return None

    def _may_pass(self, ends: tuple[float, float], rates: tuple[float, float]) -> bool:
        """Return whether a load asked for lies beyond both ends, up to twice as far as the cubic goes."""
        top, bottom = extremes(ends, rates)
        highest, lowest = max(ends), min(ends)
        above, below = 2 * (top - highest), 2 * (lowest - bottom)
        return any(highest <= load <= highest + above or lowest - below <= load <= lowest for load in self.asked)

    def _rate(self, span: Span, point: Stand) -> float:
        """Return dP/ds at a point of a span."""
        row, along = AtLoad(self.system, 0.0, 0.0).row(point.balance, point.value), point.by(span.normal)[0]
        return float(row.by_edges @ along[:-1] + row.by_control * along[-1])

    def in_last_gap(self, point: Equilibrium, load: float, tolerance: float) -> Equilibrium | None:
        """Return the state at a load between complete contact and a point with one gap."""
        patches, system = point.patches, self.system
        widest = float(patches.gap_after[0])
        center = float(patches.right[0]) + widest / 2

        def gap(width: float) -> Flaw:
            return flaw_of(system, self.complete, width, tolerance) or Flaw(center, width)

        def miss(width: float) -> float:
            return opening_load(system, self.complete, gap(width), tolerance) - load

        if patches.count > 1 or widest <= FINEST_GAP or miss(FINEST_GAP) * miss(widest) > 0:
            return None
        brentq = import_module("scipy.optimize").brentq
        flaw = gap(float(brentq(miss, FINEST_GAP, widest, rtol=LAST)))
        crack, highest = with_gap(flaw.center, flaw.width), system.elastic.profile.max_height
        state = LoadControl().reach(evaluate(system.elastic, crack, highest, tolerance), load)
        depth = state.penetration
        allowed = max(LOAD_ACCURACY * max(abs(load), 1e-3), DIGITS * float(np.spacing(depth)) * state.load_rate)
        settled = settle(system, Start(crack, depth, depth), AtLoad(system, load, allowed), self.fine)
        return None if isinstance(settled, Refused) else Equilibrium.of(settled[1], settled[0], settled=True)


def extremes(ends: tuple[float, float], rates: tuple[float, float]) -> tuple[float, float]:
    """Return the largest and the least value of the cubic with given values and rates at the ends of [0, 1]."""
    (first, last), (a, b) = ends, rates
    rise = last - first
    cubic = np.array([first, a, 3 * rise - 2 * a - b, a + b - 2 * rise])
    places = np.clip(polynomial.polyroots(polynomial.polyder(cubic)).real, 0.0, 1.0)
    values = polynomial.polyval(places, cubic)
    return max(*ends, *values), min(*ends, *values)
