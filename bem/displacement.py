"""Displacement of a given pressure everywhere, by a quadrature of its own: what the certificate measures with.

On a patch x = c + r cos(theta) the pressure is a cosine series, sigma dx = q(theta) d theta, and
u = -(1/pi) int log|2 sin((x - x')/2)| sigma dx' takes the logarithm apart into

- log|x - x'| inside the patch: log(r/2) and half of log 4 sin^2 of half the difference and the sum of the angles, by
  the product rule of Martensen and Kussmaul on 2 n equidistant angles (Kress, Linear Integral Equations, 3rd ed. 2014,
  section 12.3),
- log|x - x'| outside it: int T_n(t) log|z - t| / sqrt(1 - t^2) dt = -(pi/n) zeta^n, zeta = z - sgn(z) sqrt(z^2 - 1)
  (n = 0: -pi log|2 zeta|), all n where zeta is not small,
- the periodic rest log sinc((x - x')/2), smooth, by the midpoint rule in theta.

A layer adds (ratio_m - 1) sigma_m / m to mode m.  Nothing is taken from the collocation or the gap search.
Dimensionless (scaling.py), mean-free.  Limits: double precision, 1e-15 of the largest u; contact not complete.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct

from bem.patches import PatchPressure

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
ComplexArray = NDArray[np.complex128]
ComplianceRatio = Callable[[FloatArray], FloatArray]

ROUNDING = 1e-16
LONGEST_SERIES = 1 << 16  # modes of a layer
SHORT_SERIES, SHORT_REACH = 24, 0.2  # terms that are enough up to this |zeta|: 0.2^24 = 2e-17
LARGEST_BLOCK = 1 << 19  # points times patches at a time
TINY = 1e-300  # keeps sin(y)/y defined at 0


@dataclass(frozen=True, eq=False)
class GapPoints:
    """Points outside contact: the patch before the gap, and the distances from both edges of the gap, (n,) each."""

    gap: IntArray
    from_left: FloatArray
    from_right: FloatArray


class DisplacementField:
    """Mean-free displacement of a pressure at points inside and outside its patches.

    Parameters
    ----------
    pressure : PatchPressure
        Dimensionless.
    compliance_ratio : callable, optional
        Compliance of a layer over that of the half-space for orders m >= 1, (n,) to (n,), tending to 1.

    Raises
    ------
    ValueError
        The ratio is not 1 to rounding within 65536 modes.

    Examples
    --------
    A force spread as 1/sqrt(1 - t^2) over |x| <= 0.01 seen from the other side of the circle, -log(2):

    >>> half = np.array([0.01])
    >>> field = DisplacementField(PatchPressure(-half, half, (np.ones(1),)))
    >>> point = GapPoints(np.array([0]), np.array([np.pi - 0.01]), np.array([np.pi - 0.01]))
    >>> [round(float(u), 4) for u in (*field.in_gaps(point), -np.log(2))]
    [-0.6931, -0.6931]
    """

    def __init__(self, pressure: PatchPressure, compliance_ratio: ComplianceRatio | None = None) -> None:
        self.pressure = pressure
        self.count = pressure.left.size
        self.center = (pressure.left + pressure.right) / 2
        self.radius = (pressure.right - pressure.left) / 2
        self._layer = None if compliance_ratio is None else self._layer_modes(compliance_ratio)

    def in_contact(self, x: FloatArray, owner: IntArray) -> FloatArray:
        """u at the n + 1 extrema of every patch in turn, (n,), with the index of the patch of each point."""
        total = np.empty(x.size)
        block = max(1, LARGEST_BLOCK // self.count)
        for first in range(0, x.size, block):
            part = slice(first, first + block)
            distance = self._distance(x[part])
            excess = np.abs(distance) - self.radius
            excess[np.arange(excess.shape[0]), owner[part]] = np.inf
            total[part] = self._outside(distance, excess)
            for i in range(self.count):
                total[part] += self._periodic_rest(i, distance[:, i])
        for i in range(self.count):
            first, last = np.searchsorted(owner, [i, i + 1])
            total[first:last] += self._inside(i)
        return self._completed(total, x)

    def in_gaps(self, points: GapPoints) -> FloatArray:
        """u at points outside contact, (n,); near an edge it needs the distance from it to full precision."""
        x = self.positions(points)
        total = np.empty(x.size)
        block = max(1, LARGEST_BLOCK // self.count)
        for first in range(0, x.size, block):
            part = slice(first, first + block)
            place, gap = np.arange(x[part].size), points.gap[part]
            distance = self._distance(x[part])
            excess = np.abs(distance) - self.radius
            following = (gap + 1) % self.count
            for patch, known, side in ((gap, points.from_left, 1), (following, points.from_right, -1)):
                beside = side * distance[place, patch] > 0
                excess[place[beside], patch[beside]] = known[part][beside]
            total[part] = self._outside(distance, excess)
            for i in range(self.count):
                total[part] += self._periodic_rest(i, distance[:, i])
        return self._completed(total, x)

    def positions(self, points: GapPoints) -> FloatArray:
        """x of points in gaps, (n,)."""
        return np.asarray(self.pressure.right[points.gap] + points.from_left)

    def _distance(self, x: FloatArray) -> FloatArray:
        """From the center of each patch to the nearest image of each point, (n, L)."""
        return np.asarray(np.remainder(x[:, None] - self.center + np.pi, 2 * np.pi) - np.pi)

    def _completed(self, total: FloatArray, x: FloatArray) -> FloatArray:
        """u from the integral of the half-space kernel."""
        total *= -1 / np.pi
        return total if self._layer is None else total + self._layer_field(x, self._layer)

    def _inside(self, i: int) -> FloatArray:
        """int log|x - x'| sigma dx' at the n + 1 extrema of patch i, by the Martensen-Kussmaul rule."""
        q = regular_part(self.pressure.charges[i], self.pressure.charges[i].size)
        n = q.size - 1
        weight = _kress_weights(n)
        j = np.arange(n + 1)
        folded = weight[np.abs(j[:, None] - j)] + weight[(j[:, None] + j) % (2 * n)]
        q_ends_halved = q.copy()
        q_ends_halved[[0, -1]] /= 2
        # log|x - x'| = log(r/2) + 1/2 log 4 sin^2((a-b)/2) + 1/2 log 4 sin^2((a+b)/2), 0 <= b <= pi
        level = np.log(self.radius[i] / 2) * (np.pi / n) * np.sum(q_ends_halved)
        return np.asarray(folded @ q_ends_halved / 2 + level)

    def _outside(self, distance: FloatArray, excess: FloatArray) -> FloatArray:
        """Sum over the patches of int log|x - x'| sigma dx' outside them, (n,).

        Parameters
        ----------
        distance, excess : (n, L) arrays
            From the centers, and how much of it lies beyond the edge; infinite for patches to be left out.
        """
        beyond = excess / self.radius
        zeta = np.copysign(1 / (1 + beyond + np.sqrt(beyond * (2 + beyond))), distance)
        terms = np.zeros((SHORT_SERIES, self.count))
        mean = np.empty(self.count)
        for i, charge in enumerate(self.pressure.charges):
            low = charge[1 : SHORT_SERIES + 1]
            mean[i], terms[: low.size, i] = charge[0], -low / np.arange(1, low.size + 1)
        size = np.abs(zeta)
        total = _horner(terms, zeta)
        for i in range(self.count):
            near = np.flatnonzero(size[:, i] > SHORT_REACH)
            charge = self.pressure.charges[i]
            total[near, i] = _horner(-charge[1:] / np.arange(1, charge.size), zeta[near, i])
        inside = size == 0
        total += mean * np.log(self.radius / 2 / np.where(inside, self.radius / 2, size))
        total[inside] = 0.0
        return np.asarray(total.sum(axis=1) * np.pi)

    def _periodic_rest(self, i: int, distance: FloatArray) -> FloatArray:
        """int log sinc((x - x')/2) sigma dx', analytic up to |x - x'| = 2 pi."""
        z = np.pi / self.radius[i]  # nearest singularity for points at most half a period away
        modes = int(np.ceil(-np.log(ROUNDING) / np.log(z + np.sqrt(z * z - 1)))) + 2
        angle = (np.arange(modes) + 0.5) * (np.pi / modes)
        low = self.pressure.charges[i][:modes]
        q = np.cos(np.multiply.outer(angle, np.arange(low.size))) @ low
        half = distance[:, None] / 2 - self.radius[i] / 2 * np.cos(angle)
        half += TINY
        return np.asarray(np.log(np.sin(half) / half) @ (q * (np.pi / modes)))

    def _layer_modes(self, compliance_ratio: ComplianceRatio) -> ComplexArray:
        """2 (ratio_m - 1)/m sigma_m for m = 1.., up to where the ratio is 1 to rounding."""
        highest = 16
        while abs(float(compliance_ratio(np.array([float(highest)]))[0]) - 1) > ROUNDING:
            highest *= 2
            if highest > LONGEST_SERIES:
                raise ValueError(f"compliance_ratio: not 1 to rounding at order {highest // 2}")
        m = np.arange(1, highest + 1)
        modes = np.zeros(highest, dtype=np.complex128)
        for c, r, charge in zip(self.center, self.radius, self.pressure.charges, strict=True):
            n = charge.size + int(np.ceil(highest * r)) + 20
            weighted = regular_part(charge, n) * (np.pi / n)
            weighted[[0, -1]] /= 2
            x = c + r * np.cos(np.arange(n + 1) * (np.pi / n))
            modes += np.exp(-1j * np.multiply.outer(m, x)) @ weighted
        return np.asarray(modes * (compliance_ratio(m.astype(np.float64)) - 1) / m / np.pi)

    def _layer_field(self, x: FloatArray, modes: ComplexArray) -> FloatArray:
        """What a layer adds at points x, (n,)."""
        total = np.zeros(x.size)
        for first in range(0, modes.size, 64):
            part = modes[first : first + 64]
            m = np.arange(first + 1, first + 1 + part.size)
            total += (np.exp(1j * np.multiply.outer(x, m)) @ part).real
        return total


def regular_part(charge: FloatArray, n: int) -> FloatArray:
    """q = sum Q_k cos(k theta) at theta = j pi / n, j = 0..n, (n + 1,); n >= number of coefficients."""
    padded = np.zeros(n + 1)
    padded[: charge.size] = charge / 2
    padded[0] = charge[0]
    return np.asarray(dct(padded, type=1))


@lru_cache(maxsize=256)
def _kress_weights(n: int) -> FloatArray:
    """Weights of int_0^2pi log(4 sin^2(s/2)) f ds at s = k pi / n, (2 n,): -(2 pi/n) sum cos(m s)/m, m = n halved."""
    spectrum = np.zeros(n + 1)
    spectrum[1:] = -2 * np.pi / np.arange(1, n + 1)
    return np.fft.irfft(spectrum, 2 * n)


def _horner(series: FloatArray, zeta: FloatArray) -> FloatArray:
    """sum_{n >= 1} series[n - 1] zeta^n, same shape as zeta; coefficients for each column of it, or for all."""
    total = np.zeros(zeta.shape)
    for coefficient in series[::-1]:
        total += coefficient
        total *= zeta
    return total
