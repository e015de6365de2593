"""Displacement of a given pressure everywhere, by a quadrature of its own: what the certificate measures with.

On a patch x = c + r cos(theta) the pressure is a cosine series, sigma dx = q(theta) d theta, and
u = -(1/pi) int log|2 sin((x - x')/2)| sigma dx' takes the logarithm apart into

- log|x - x'| inside the patch: log(r/2) and half of log 4 sin^2 of half the difference and the sum of the angles, by
  the product rule of Martensen and Kussmaul on 2 n equidistant angles (Kress, Linear Integral Equations, 3rd ed. 2014,
  section 12.3),
- log|x - x'| of patches near by: int T_n(t) log|z - t| / sqrt(1 - t^2) dt = -(pi/n) zeta^n,
  zeta = z - sgn(z) sqrt(z^2 - 1) (n = 0: -pi log|2 zeta|), as many n as the powers of zeta are worth,
- the rest, smooth over the boxes into which the circle is cut: patches far from a box, and what the period adds to
  those near it, by the midpoint rule in theta at Chebyshev nodes of every box, and from there by interpolation.

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

from bem.geometry.arrays import ComplexArray, FloatArray, IntArray
from bem.geometry.patches import PatchPressure

ComplianceRatio = Callable[[FloatArray], FloatArray]

ROUNDING = 1e-16
LONGEST_SERIES = 1 << 16  # modes of a layer
LARGEST_BLOCK = 1 << 16  # pairs of points and patches at a time: memory of larger arrays is asked for anew each time
TINY = 1e-300  # keeps sin(y)/y defined at 0
LEAST_BOXES, BOXES_PER_ROOT = 8, 4.0  # boxes of the circle, over the root of the number of patches (measured)
CLEAR = 3.0  # half boxes, and then a width of the patch, from the center of a box to that of the nearest far patch
TERMS = 4  # of a power series at a time


@dataclass(frozen=True, eq=False)
class GapPoints:
    """Points outside contact: the patch before the gap, and the distances from both edges of the gap, (n,) each."""

    gap: IntArray
    from_left: FloatArray
    from_right: FloatArray


@dataclass(frozen=True, eq=False)
class Pairs:
    """Points with the images of the patches near them: index of the point, of the patch, and distance from its center.

    All (n_pairs,); the image is the one from whose center the signed distance is counted.
    """

    point: IntArray
    patch: IntArray
    distance: FloatArray


@dataclass(frozen=True, eq=False)
class Boxes:
    """The circle in equal boxes: images of patches near each, and the rest of the field as Chebyshev series."""

    half: float  # half their width
    start: IntArray  # where the near images of each begin, (n_boxes + 1,)
    patch: IntArray  # near images, box by box, (n_near,), as their centers
    center: FloatArray
    series: FloatArray  # int log|2 sin| sigma dx' less log|x - x'| of the near images, (n_terms, n_boxes)

    def of(self, x: FloatArray) -> IntArray:
        """Box of each point of [0, 2 pi], (n,)."""
        return np.minimum((x / (2 * self.half)).astype(np.int64), self.start.size - 2)

    def pairs(self, x: FloatArray, box: IntArray) -> Pairs:
        """Points with their near images."""
        count = np.diff(self.start)[box]
        point = np.repeat(np.arange(x.size), count)
        at = np.arange(point.size) + np.repeat(self.start[box] - np.cumsum(count) + count, count)
        return Pairs(point, self.patch[at], x[point] - self.center[at])

    def rest(self, x: FloatArray, box: IntArray) -> FloatArray:
        """The smooth rest at points of boxes, by Clenshaw's rule, (n,)."""
        t = x / self.half - (2 * box + 1)
        now, before = np.zeros((2, x.size))
        for terms in self.series[:0:-1]:
            now, before = terms[box] + 2 * t * now - before, now
        return np.asarray(self.series[0, box] + t * now - before)


class DisplacementField:
    """Mean-free displacement of a dimensionless pressure at points inside and outside its patches.

    The ratio is as of `certify`; ValueError where it is not 1 to rounding within 65536 modes.

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
        self._size = np.array([charge.size for charge in pressure.charges])
        self._powers = np.zeros((int(self._size.max(initial=1)) + TERMS, self.count))  # factors of zeta^n, n >= 1
        for i, charge in enumerate(pressure.charges):
            self._powers[: charge.size - 1, i] = charge[1:] / -np.arange(1, charge.size)
        self._mean = np.array([charge[0] for charge in pressure.charges])
        self._boxes = self._in_boxes(max(LEAST_BOXES, int(np.ceil(BOXES_PER_ROOT * np.sqrt(self.count)))))
        self._layer = None if compliance_ratio is None else self._layer_modes(compliance_ratio)

    def in_contact(self, x: FloatArray, owner: IntArray) -> FloatArray:
        """u at the n + 1 extrema of every patch in turn, (n,), with the index of the patch of each point."""

        def beyond_edge(pairs: Pairs, part: slice) -> FloatArray:
            size = np.abs(pairs.distance)
            own = (pairs.patch == owner[part][pairs.point]) & (size < np.pi)
            return np.where(own, np.inf, size - self.radius[pairs.patch])

        total = self._from_others(x, beyond_edge)
        first = np.searchsorted(owner, np.arange(self.count))
        for n in np.unique(self._size):
            who = np.flatnonzero(self._size == n)
            total[first[who, None] + np.arange(n + 1)] += self._inside(who, int(n))
        return self._completed(total, x)

    def in_gaps(self, points: GapPoints) -> FloatArray:
        """u at points outside contact, (n,); near an edge it needs the distance from it to full precision."""

        def beyond_edge(pairs: Pairs, part: slice) -> FloatArray:
            excess = np.abs(pairs.distance) - self.radius[pairs.patch]
            gap = points.gap[part][pairs.point]
            following = (gap + 1) % self.count
            for patch, known, side in ((gap, points.from_left, 1), (following, points.from_right, -1)):
                away = side * pairs.distance
                beside = (pairs.patch == patch) & (away > 0) & (away < 2 * np.pi)  # that image, and no other
                excess[beside] = known[part][pairs.point[beside]]
            return excess

        x = self.positions(points)
        return self._completed(self._from_others(x, beyond_edge), x)

    def positions(self, points: GapPoints) -> FloatArray:
        """x of points in gaps, (n,)."""
        return np.asarray(self.pressure.right[points.gap] + points.from_left)

    def _from_others(self, x: FloatArray, beyond_edge: Callable[[Pairs, slice], FloatArray]) -> FloatArray:
        """int log|2 sin| sigma dx' but for log|x - x'| of the images whose excess beyond the edge is infinite, (n,)."""
        x = x - 2 * np.pi * np.floor(x / (2 * np.pi))
        box = self._boxes.of(x)
        total = self._boxes.rest(x, box)
        most = int(np.diff(self._boxes.start).max())
        block = max(1, LARGEST_BLOCK // max(most, 1))
        for first in range(0, x.size, block):
            part = slice(first, first + block)
            pairs = self._boxes.pairs(x[part], box[part])
            excess = beyond_edge(pairs, part)
            outside = np.isfinite(excess)
            point, patch, distance = pairs.point[outside], pairs.patch[outside], pairs.distance[outside]
            logs = self._outside(patch, distance, excess[outside])
            total[part] += np.bincount(point, logs, total[part].size)
        return total

    def _outside(self, patch: IntArray, distance: FloatArray, excess: FloatArray) -> FloatArray:
        """int log|x - x'| sigma dx' of patches (n,) at points outside them, (n,).

        Given are the distance of each from its center, (n,), and its excess, how much of it lies beyond its edge.
        """
        beyond = excess / self.radius[patch]
        zeta = np.copysign(1 / (1 + beyond + np.sqrt(beyond * (2 + beyond))), distance)
        decay = -np.log(np.abs(zeta))
        wanted = np.minimum(np.log(10 / ROUNDING) / np.maximum(decay, TINY), self._size[patch] - 1.0)
        rounds = np.ceil(wanted / TERMS).astype(np.int64)
        most = int(rounds.max(initial=0))
        order = np.argsort((most - rounds).astype(np.min_scalar_type(most)), kind="stable")
        reach = np.cumsum(np.bincount(rounds, minlength=1)[::-1])[::-1]  # pairs with that many rounds, or more
        who, factor, total = patch[order], zeta[order], np.zeros(zeta.size)
        for k in range(most, 0, -1):
            active = slice(0, int(reach[k]))
            for terms in self._powers[TERMS * (k - 1) : TERMS * k][::-1]:
                total[active] += terms.take(who[active])
                total[active] *= factor[active]
        result = np.empty(zeta.size)
        result[order] = total
        return np.asarray(np.pi * (result + self._mean[patch] * (np.log(self.radius[patch] / 2) + decay)))

    def _in_boxes(self, count: int) -> Boxes:
        """The circle in boxes.  Around one, the far field is analytic in x up to CLEAR half boxes from its center."""
        half = np.pi / count
        middle = (2 * np.arange(count) + 1.0) * half
        base = np.rint((middle[:, None] - self.center) / (2 * np.pi))
        turns = base[:, :, None] + np.array([-1.0, 0.0, 1.0])
        away = np.abs(middle[:, None, None] - self.center[:, None] - 2 * np.pi * turns)
        near = away < CLEAR * half + 2 * self.radius[:, None]
        box, patch, image = np.nonzero(near)
        start = np.searchsorted(box, np.arange(count + 1))
        center = self.center[patch] + 2 * np.pi * turns[box, patch, image]

        terms = int(_decaying(np.array([CLEAR]))[0])
        nodes = middle[:, None] + half * np.cos((np.arange(terms) + 0.5) * (np.pi / terms))
        modes = _decaying(2 + (CLEAR - 1) * half / self.radius)
        sources, charges = self._sources(modes)
        careful = near.any(axis=2)
        values = _periodic_field(nodes, sources, charges, np.repeat(careful, modes, axis=1))
        rows, columns = np.nonzero(careful)
        for size in np.unique(modes[columns]):
            chosen = modes[columns] == size
            i, j = rows[chosen], columns[chosen]
            which = (np.cumsum(modes) - modes)[j, None] + np.arange(size)
            apart = (nodes[i] - 2 * np.pi * base[i, j, None])[:, :, None] - sources[which][:, None, :]
            np.add.at(values, i, np.einsum("ijk,ik->ij", _periodic_rest(apart, near[i, j]), charges[which]))
        series: FloatArray = dct(values, type=2, axis=1).T / terms
        series[0] /= 2
        return Boxes(half, start, patch, center, series)

    def _completed(self, total: FloatArray, x: FloatArray) -> FloatArray:
        """u from the integral of the half-space kernel."""
        total *= -1 / np.pi
        return total if self._layer is None else total + self._layer_field(x, self._layer)

    def _inside(self, who: IntArray, n: int) -> FloatArray:
        """int log|x - x'| sigma dx' at the n + 1 extrema of patches with n terms, by the Martensen-Kussmaul rule."""
        q = regular_part(np.stack([self.pressure.charges[i] for i in who]), n)
        weight = _kress_weights(n)
        j = np.arange(n + 1)
        folded = weight[np.abs(j[:, None] - j)] + weight[(j[:, None] + j) % (2 * n)]
        q[:, [0, -1]] /= 2
        # log|x - x'| = log(r/2) + 1/2 log 4 sin^2((a-b)/2) + 1/2 log 4 sin^2((a+b)/2), 0 <= b <= pi
        level = np.log(self.radius[who] / 2) * (np.pi / n) * q.sum(axis=1)
        return np.asarray(q @ folded / 2 + level[:, None])

    def _sources(self, modes: IntArray) -> tuple[FloatArray, FloatArray]:
        """Positions and charges (pi/n) q of n nodes of the midpoint rule on every patch, joined."""
        first = np.cumsum(modes) - modes
        sources, charges = np.empty((2, int(modes.sum())))
        for n in np.unique(modes):
            who = np.flatnonzero(modes == n)
            rows = first[who, None] + np.arange(n)
            angle = (np.arange(n) + 0.5) * (np.pi / n)
            low = np.stack([_cut(self.pressure.charges[i], int(n)) for i in who])
            sources[rows] = self.center[who, None] + self.radius[who, None] * np.cos(angle)
            charges[rows] = low @ np.cos(np.multiply.outer(np.arange(n), angle)) * (np.pi / n)
        return sources, charges

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
    """q = sum Q_k cos(k theta) at theta = j pi / n, j = 0..n, along the last axis; n >= number of coefficients."""
    padded = np.zeros((*charge.shape[:-1], n + 1))
    padded[..., : charge.shape[-1]] = charge / 2
    padded[..., 0] = charge[..., 0]
    return np.asarray(dct(padded, type=1))


@lru_cache(maxsize=256)
def _kress_weights(n: int) -> FloatArray:
    """Weights of int_0^2pi log(4 sin^2(s/2)) f ds at s = k pi / n, (2 n,): -(2 pi/n) sum cos(m s)/m, m = n halved."""
    spectrum = np.zeros(n + 1)
    spectrum[1:] = -2 * np.pi / np.arange(1, n + 1)
    return np.fft.irfft(spectrum, 2 * n)


def _periodic_field(x: FloatArray, sources: FloatArray, charges: FloatArray, left_out: NDArray[np.bool_]) -> FloatArray:
    """Sum of charge times log|2 sin((x - x')/2)| at points of boxes, (n_boxes, n), less sources left out of a box."""
    total = np.empty(x.shape)
    split = np.stack([np.cos(sources / 2), -np.sin(sources / 2)])
    block = max(1, LARGEST_BLOCK // (x.shape[1] * sources.size))
    for first in range(0, x.shape[0], block):
        part = slice(first, first + block)
        chord = 2 * np.stack([np.sin(x[part] / 2), np.cos(x[part] / 2)], axis=-1) @ split
        np.abs(chord, out=chord)
        np.copyto(chord, 1.0, where=left_out[part, None, :])
        total[part] = np.log(chord, out=chord) @ charges
    return total


def _periodic_rest(apart: FloatArray, near: NDArray[np.bool_]) -> FloatArray:
    """log|2 sin(d/2)| less log|d - 2 pi k| of the images k = -1, 0, 1 that are near, for d of shape (n, ., .)."""
    nearest = np.abs(apart - 2 * np.pi * np.rint(apart / (2 * np.pi)))
    ratio = 2 * np.sin(np.maximum(nearest, TINY) / 2)
    for image, is_near in zip((-1, 0, 1), near.T, strict=True):
        distance = np.abs(apart[is_near] - 2 * np.pi * image)
        ratio[is_near] /= np.maximum(distance, TINY)
    return np.asarray(np.log(ratio))


def _cut(charge: FloatArray, n: int) -> FloatArray:
    """The first n coefficients, zeros where there are fewer, (n,)."""
    cut = np.zeros(n)
    cut[: min(n, charge.size)] = charge[:n]
    return cut


def _decaying(distance: FloatArray) -> IntArray:
    """Terms, to rounding, of Chebyshev series whose nearest singularity is so many half intervals from the middle."""
    rate = np.log(distance + np.sqrt(distance * distance - 1))
    return np.asarray(np.ceil(-np.log(ROUNDING) / rate) + 1, dtype=np.int64)
