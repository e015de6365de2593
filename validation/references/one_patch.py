"""Closed form of a single contact patch on a symmetric profile: mean pressure, penetration, energy, gap beside it.

On h = sum_m h_m cos(m y), y = 2 pi x / period, one patch |y| < a of a half-space carries

    p(y) = Q(y) / sqrt((cos y - cos a) / 2),   Q(y) = sum_{k=0}^{M} c_k cos((k + 1/2) y)

(Muskhelishvili, Some Basic Problems of the Mathematical Theory of Elasticity, chapter 19, written for the period).
With P_m = E* q m h_m / 2, q = 2 pi / period, the displacement there is that of h if

    sum_{k >= m} c_k L_{k-m}(cos a) = P_m / 2 for m >= 1,   mean pressure = sum_{k >= 0} c_k L_k(cos a),

L_n the Legendre polynomials, which expand the root, and the stress intensity at an edge is
K = -2 Q(a) sqrt(pi / (q sin a)), so that K^2 = 2 E* w gives Q(a).  With h_1 alone this is Johnson's mean pressure.

A flat punch with these edges has the compliance C(a) = dDelta/dp = -period ln sin^2(a/2) / (pi E*).  Let p_0(a) be the
mean pressure without stress intensity: as a grows, a punch of the width reached is pressed down, so that

    Delta_0 = int_0^a C dp_0,   U_0 = int_0^a p_0 C dp_0,   and with s = p - p_0 at the same edges
    Delta = Delta_0 + C s,      U = U_0 + C s (p_0 + s / 2) - w a / pi.

The gap opens beside the edge by dg/dx = -2 Q(y) / (E* sqrt((cos a - cos y) / 2)), in equilibrium or not.
SI units.  Limits: symmetric profiles, one patch, no slope term; Delta counts from the height in the middle.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss, legval
from numpy.typing import ArrayLike

from validation.harness.arrays import FloatArray

POINTS = 6.0  # of a Gauss rule, in a wavelength of the shortest wave, besides LEAST_POINTS
LEAST_POINTS = 40


@dataclass(frozen=True)
class OnePatch:
    """Equilibria of one patch about the middle of a symmetric profile.

    Examples
    --------
    Westergaard, half of the period in contact: p = pi E* h_1 / (2 period), Delta = h_1 (1 + ln 2) / 2.

    >>> wave = OnePatch(0.01, 1e6, (1e-4,), 0.0)
    >>> abs(float(wave.mean_pressure(np.pi / 2)) / (np.pi * 1e6 * 1e-4 / 0.02) - 1) < 1e-15
    True
    >>> bool(abs(wave.penetration(np.pi / 2) / 0.5e-4 - 1 - np.log(2)) < 1e-14)
    True
    """

    period: float  # m
    modulus: float  # E* = E / (1 - nu^2), Pa
    harmonics: tuple[float, ...]  # h_1, ..., h_M, m
    work: float  # of adhesion, J/m^2; 0 without adhesion

    def mean_pressure(self, angle: ArrayLike) -> FloatArray:
        """Return the mean pressure in Pa at a = pi times the contact fraction, in (0, pi), same shape."""
        return self._mean_pressure(np.asarray(angle, dtype=np.float64), self.work)

    def penetration(self, angle: ArrayLike) -> FloatArray:
        """Return the penetration Delta in m, in the shape of `angle`."""
        return self._state(np.asarray(angle, dtype=np.float64))[0]

    def energy(self, angle: ArrayLike) -> FloatArray:
        """Return the sum of elastic and adhesion energy in J/m^2 of nominal area, in the shape of `angle`."""
        return self._state(np.asarray(angle, dtype=np.float64))[1]

    def gap(self, angle: float, pressure: float, y: float) -> float:
        """Return the gap in m at y in (a, pi) beside a patch under a mean pressure in Pa, in equilibrium or not."""
        c = self._series(np.array([angle]))[:, 0]
        c[0] = pressure - float(c[1:] @ _legendre(np.array([angle]), c.size)[1:, 0])
        node, weight = self._rule(y - angle)
        at = angle + (y - angle) * node**2  # the root at the edge is a factor node there
        slope = -2 / self.modulus * np.cos(np.multiply.outer(at, np.arange(c.size) + 0.5)) @ c
        slope /= np.sqrt((np.cos(angle) - np.cos(at)) / 2)
        return float(weight @ (slope * 2 * node)) * (y - angle) * self.period / (2 * np.pi)

    def _mean_pressure(self, angle: FloatArray, work: float) -> FloatArray:
        c, q = self._series(angle), 2 * np.pi / self.period
        at_edge = -np.sqrt(self.modulus * work * q * np.sin(angle) / (2 * np.pi))
        for k in range(1, len(c)):
            at_edge = at_edge - c[k] * np.cos((k + 0.5) * angle)
        c[0] = at_edge / np.cos(angle / 2)
        return np.asarray(np.sum(c * _legendre(angle, len(c)), axis=0))

    def _series(self, angle: FloatArray) -> FloatArray:
        """Return c_k for k >= 1, (M + 1, ...), with c_0 set to zero."""
        order, q = len(self.harmonics), 2 * np.pi / self.period
        legendre = _legendre(angle, order + 1)
        c = np.zeros((order + 1, *angle.shape))
        for m in range(order, 0, -1):
            c[m] = self.modulus * q * m * self.harmonics[m - 1] / 4
            c[m] -= np.sum(c[m + 1 :] * legendre[1 : order + 1 - m], axis=0)
        return c

    def _state(self, angle: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return Delta and U, integrated by parts: dC/da = -period cot(a/2) / (pi E*) multiplies p_0 ~ a^2."""
        node, weight = self._rule(float(np.max(angle)))
        within = np.multiply.outer(node, angle)
        free = self._mean_pressure(within, 0.0)
        softening = self.period / (np.pi * self.modulus) / np.tan(within / 2) * angle
        compliance = -self.period * np.log(np.sin(angle / 2) ** 2) / (np.pi * self.modulus)
        p_0 = self._mean_pressure(angle, 0.0)
        more = self._mean_pressure(angle, self.work) - p_0
        depth = compliance * p_0 + np.tensordot(weight, softening * free, 1)
        energy = compliance * p_0**2 / 2 + np.tensordot(weight, softening * free**2 / 2, 1)
        energy = energy + compliance * more * (p_0 + more / 2) - self.work * angle / np.pi
        return np.asarray(depth + compliance * more), np.asarray(energy)

    def _rule(self, length: float) -> tuple[FloatArray, FloatArray]:
        """Return nodes and weights on (0, 1) for a stretch of a given length in y."""
        node, weight = leggauss(LEAST_POINTS + int(POINTS * len(self.harmonics) * length / (2 * np.pi)))
        return (node + 1) / 2, weight / 2


def _legendre(angle: FloatArray, count: int) -> FloatArray:
    """Return L_0, ..., L_{count-1} at cos a, (count, ...)."""
    return np.asarray(legval(np.cos(angle), np.eye(count)))
