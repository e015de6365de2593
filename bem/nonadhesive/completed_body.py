"""Pressure of complete contact, to its last digits, stiffness against opening, and controls next to complete contact.

Complete contact has the pressure p_0 + q(x), q = sum m h_m / ratio_m cos(m x + phi_m).  Next to it the tension that
opens a gap is a small difference of p_0 and q: q is summed at single points without rounding of m x, and its changes
from there as products of sines.  A control alpha Delta + beta load is a condition alpha s + 2 pi beta tau = rest on the
separation s and the deficit tau, what the mean pressure lacks to that of complete contact.  Dimensionless (scaling.py).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.geometry.patches import TWO_PI
from bem.geometry.profile import Profile
from bem.loading.complete_contact import CompleteContact
from bem.loading.control import Control

EXACT_PHASE = float(1 << 24)  # derived: positions are multiples of its inverse and a rest; order times these is exact
STIFFENING, MOST_TERMS = 1e-16, 1 << 16  # derived: of a layer: size of the terms left out, and number of the others
LOWEST = 0.99  # derived: of the lowest value of q: deeper minima open first, and their tension may be a tiny difference
POINT_ROUNDING = 4e-16  # derived: of q at a point, over its lowest value and the root of summed squared amplitudes


@dataclass(frozen=True, eq=False)
class CompletedBody:
    """Pressure of complete contact and stiffness against opening.

    Parameters
    ----------
    complete : CompleteContact
    max_height : float
        Of the profile.
    compliance_ratio : callable, optional
        Compliance of a layer over that of the half-space for orders m >= 1, (n,) to (n,), tending to 1.
    """

    complete: CompleteContact
    max_height: float
    compliance_ratio: Callable[[FloatArray], FloatArray] | None = None

    @property
    def pressure(self) -> Profile:
        """q: the zero-mean pressure of complete contact."""
        return self.complete.pressure

    @cached_property
    def minima(self) -> tuple[FloatArray, FloatArray]:
        """Positions of the local minima of q, ascending, and its values, (n,) each; the lowest to their last digits."""
        q = self.pressure
        x, values = q.valleys[0], q.valleys[1].copy()
        lowest = values <= LOWEST * values.min()
        values[lowest] = self.at_anchor(x[lowest])
        return x, values

    @cached_property
    def lowest(self) -> float:
        """Mean pressure of complete contact without tension, -min q."""
        return -float(self.minima[1].min())

    @cached_property
    def rounding(self) -> float:
        """Accuracy of q at an anchor less q at another, in double precision."""
        return POINT_ROUNDING * (abs(self.lowest) + float(np.sqrt(np.sum(self.pressure.amplitudes**2))))

    @cached_property
    def stiffening(self) -> FloatArray:
        """Stiffness that a layer adds to the modes m = 1.., (n,); empty for a half-space."""
        if self.compliance_ratio is None:
            return np.empty(0)
        size = 16
        while True:
            m = np.arange(1.0, size + 1)
            added = m / self.compliance_ratio(m) - m
            if np.max(np.abs(added[-3:])) <= STIFFENING * max(1.0, float(np.max(np.abs(added)))) or size >= MOST_TERMS:
                return np.asarray(added)
            size *= 2

    @cached_property
    def highest_order(self) -> float:
        """Of the waves of the pressure and those that a layer makes more than twice as stiff as a half-space."""
        m = np.arange(1, self.stiffening.size + 1)
        return float(np.max(m[self.stiffening > m], initial=self.pressure.max_order))

    def waves_at(self, anchor: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Cosine and sine of m x + phi_m, (n, n_harmonics) each: the products m x are not rounded."""
        m, phase = self.pressure.orders.astype(np.float64), self.pressure.phases
        coarse = np.rint(anchor * EXACT_PHASE) / EXACT_PHASE
        first, rest = np.multiply.outer(coarse, m), np.multiply.outer(anchor - coarse, m) + phase
        cosine, sine = np.cos(first), np.sin(first)
        return cosine * np.cos(rest) - sine * np.sin(rest), sine * np.cos(rest) + cosine * np.sin(rest)

    def at_anchor(self, anchor: FloatArray) -> FloatArray:
        """q at single points, to its last digits, (n,); the same for a point alone and among others."""
        return np.asarray(np.sum(self.waves_at(anchor)[0] * self.pressure.amplitudes, axis=1))

    def change_from_anchor(self, anchor: float, offset: FloatArray) -> FloatArray:
        """Return q(anchor + offset) - q(anchor), relatively accurate however small the offsets, (n,)."""
        amplitude = self.pressure.amplitudes
        cosine, sine = (wave[0] for wave in self.waves_at(np.array([anchor])))
        half = np.multiply.outer(offset / 2, self.pressure.orders.astype(np.float64))
        rise = np.sin(half)
        return np.asarray(-2 * ((rise * np.cos(half)) @ (amplitude * sine) + (rise * rise) @ (amplitude * cosine)))


@dataclass(frozen=True)
class LinearControl:
    """Linear control alpha s + 2 pi beta tau = rest: a control next to complete contact.

    Parameters
    ----------
    separation_weight, load_weight, rest : float
        alpha, beta >= 0.
    rounding : float
        Accuracy of `rest`: a small difference of large numbers where it comes from heights and loads.
    """

    separation_weight: float
    load_weight: float
    rest: float
    rounding: float = 0.0

    def rate(self, separation_rate: float) -> float:
        """Return the derivative of the left-hand side by the deficit, where a deficit opens gaps at this rate."""
        return self.separation_weight * separation_rate + TWO_PI * self.load_weight

    def deficit(self, separation: float, separation_rate: float) -> float:
        """Return the deficit that meets the condition, from the separation at no deficit and its derivative."""
        return (self.rest - self.separation_weight * separation) / self.rate(separation_rate)


def condition_of(body: CompletedBody, control: Control, value: float, separation: float | None = None) -> LinearControl:
    """Return the condition of a control at a value, or of a separation given to full precision."""
    if separation is not None:
        return LinearControl(1.0, 0.0, separation)
    alpha, beta = control.penetration_weight, control.load_weight
    whole = alpha * body.max_height + beta * TWO_PI * body.lowest
    return LinearControl(alpha, beta, whole - value, float(np.finfo(float).eps) * whole)
