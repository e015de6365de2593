"""Span of a branch between two stands: a quintic in s = c . xi, and how far it is trusted.

The goal, a fold, a touch and the turn of the load between two stands are searched for on their span.  The *misfit* of a
span is the part of the chord that the derivatives at both ends do not account for.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import comb

import numpy as np
from numpy.polynomial import polynomial

from bem.adhesive.branch import outward_motion
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.path.locating import Start
from bem.path.stand import Stand

MISFIT = 0.06  # of the chord, and of the rise of the control: disagreement of two ends, distance from the quintic


@dataclass(frozen=True, eq=False)
class Span:
    """Curve between two of its points, a quintic in a parameter s from 0 to 1.

    s is c . xi, c along the chord or along the tangent at the end, by whichever both ends agree better: near a fold the
    control and all edges that follow it are polynomials of the mode that folds.

    Attributes
    ----------
    first, last : Stand
    normal : (2 L,) array
        c: s of edges that are moved outward by xi from the first point is c . xi.
    coefficients : (6, 2 L + 1) array
        Coefficients of the motions, and of the control less its value at the first point, by powers of s.
    rise : float
        Largest change of the control per s.
    misfit : float
        Chord less its prediction by the derivatives z' and z'' at both ends: y - (z'0 + z'1)/2 - (z''0 - z''1)/12, over
        the length of the chord, or over the rise.
    """

    first: Stand
    last: Stand
    normal: FloatArray
    coefficients: FloatArray
    rise: float
    misfit: float

    @classmethod
    def between(cls, first: Stand, last: Stand) -> Span | None:
        """Return the span between two points; None where neither parameter grows from one to the other."""
        chord = outward_motion(first.patches, last.patches)
        whole, size = np.append(chord, last.value - first.value), float(np.max(np.abs(chord / first.unit)))
        span: Span | None = None
        for along in (chord, last.rate):
            normal = along / first.unit**2
            if min(normal @ first.rate, normal @ last.rate, normal @ chord) <= 0:
                continue
            normal = normal / float(normal @ chord)
            (z0, w0), (z1, w1) = first.by(normal), last.by(normal)
            off = whole - (z0 + z1) / 2 - (w0 - w1) / 12
            rise = max(abs(float(z0[-1])), abs(float(z1[-1])), abs(float(whole[-1])))
            misfit = max(float(np.max(np.abs(off[:-1] / first.unit))) / size, abs(float(off[-1])) / rise)
            if span is None or misfit < span.misfit:
                a, b, c = whole - z0 - w0 / 2, z1 - z0 - w0, w1 - w0
                higher = (10 * a - 4 * b + c / 2, -15 * a + 7 * b - c, 6 * a - 3 * b + c / 2)
                coefficients = np.array([0 * whole, z0, w0 / 2, *higher])
                span = cls(first, last, normal, coefficients, rise, misfit)
        return span

    @property
    def size(self) -> float:
        """Length of the chord."""
        return float(np.max(np.abs(outward_motion(self.first.patches, self.last.patches) / self.first.unit)))

    def _at(self, s: float) -> FloatArray:
        """Return the motions, and the control less its value at the first point, (2 L + 1,)."""
        return np.asarray(polynomial.polyval(s, self.coefficients))

    def at(self, s: float) -> Start:
        """Return the edges and the control at a parameter, from which Newton starts."""
        y, first = self._at(s), self.first
        return Start(first.patches.moved(y[:-1]), first.numbers.penetration, first.value + float(y[-1]))

    def parameter(self, patches: Patches) -> float:
        """Return s of the plane in which edges lie."""
        return float(self.normal @ outward_motion(self.first.patches, patches))

    def holds(self, patches: Patches, value: float) -> bool:
        """Return whether edges at a value of the control lie on this span, to within `MISFIT`."""
        motion = outward_motion(self.first.patches, patches)
        s = float(self.normal @ motion)
        y = self._at(s)
        off = float(np.max(np.abs((motion - y[:-1]) / self.first.unit)))
        risen = abs(value - self.first.value - float(y[-1]))
        return -MISFIT <= s <= 1 + MISFIT and off <= MISFIT * self.size and risen <= MISFIT * self.rise

    def turns(self) -> FloatArray:
        """Return the parameters at which the control turns, ascending."""
        return _roots(np.arange(1, len(self.coefficients)) * self.coefficients[1:, -1])

    def reaches(self, value: float) -> FloatArray:
        """Return the parameters at which the control has a value, ascending."""
        control = self.coefficients[:, -1].copy()
        control[0] = self.first.value - value
        return _roots(control)


def _roots(coefficients: FloatArray) -> FloatArray:
    """Return the real roots from 0 to 1, ascending: none where all coefficients of Bernstein have one sign.

    Examples
    --------
    >>> _roots(np.array([0.06, -0.5, 1.0])).round(9).tolist(), _roots(np.array([0.3, -1.0, 1.0])).tolist()
    ([0.2, 0.3], [])
    """
    control_points = _to_bernstein(coefficients.size) @ coefficients
    if control_points.min() > 0 or control_points.max() < 0:
        return np.zeros(0)
    roots = polynomial.polyroots(coefficients)
    real = np.sort(roots.real[np.abs(roots.imag) < 1e-9 * (1 + np.abs(roots.real))])
    return np.asarray(real[(real >= 0) & (real <= 1)])


@lru_cache(maxsize=2)
def _to_bernstein(count: int) -> FloatArray:
    """Return the matrix from coefficients of powers to those of Bernstein's polynomials on [0, 1], (count, count)."""
    return np.array([[comb(i, k) / comb(count - 1, k) for k in range(count)] for i in range(count)])
