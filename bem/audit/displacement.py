"""Displacement of a given pressure everywhere, by a quadrature of its own: what the certificate measures with.

On a patch x = c + r cos(theta) the pressure is a cosine series, sigma dx = q(theta) d theta, and
u = -(1/pi) int log|2 sin((x - x')/2)| sigma dx' takes the logarithm apart into

- log|x - x'| inside the patch: log(r/2) and half of log 4 sin^2 of half the difference and the sum of the angles, by
  the product rule of Martensen and Kussmaul on 2 n equidistant angles (Kress, Linear Integral Equations, 3rd ed. 2014,
  section 12.3),
- log|x - x'| of patches near by: int T_n(t) log|z - t| / sqrt(1 - t^2) dt = -(pi/n) zeta^n,
  zeta = z - sgn(z) sqrt(z^2 - 1) (n = 0: -pi log|2 zeta|), as many n as the powers of zeta are worth,
- the rest, smooth over boxes of the circle, by the midpoint rule in theta at Chebyshev nodes of a box, and from there
  by interpolation: over the whole circle what the period adds to images of the patches within a turn, with s = d/(2 pi)

      log|2 sin(d/2)| = log|d/l| + log|(d - 2 pi)/l| + log|(d + 2 pi)/l| + log(sin(pi s)/(pi s (1 - s^2))),

  l = (2 pi)^(2/3), and over boxes ever half as wide the images that are far from them as well.

A layer adds (ratio_m - 1) sigma_m / m to mode m.  Nothing is taken from the collocation or the gap search.
Dimensionless (scaling.py), mean-free.  Limits: double precision, 2e-15 of the largest u with 60 patches, 8e-15 with
2000 (measured); contact not complete.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bem.geometry.arrays import ComplexArray, FloatArray, IntArray
from bem.geometry.patches import PatchPressure

ComplianceRatio = Callable[[FloatArray], FloatArray]

SERIES_ROUNDING = 1e-16  # derived: of the displacement, over its largest
MOST_LAYER_MODES = 1 << 16  # limit: modes of a layer
ORDERS = 64  # speed: of them at a time
LARGEST_BLOCK = 1 << 14  # speed: pairs of points and patches at a time, or logarithms: they stay in the cache
TINY = 1e-300  # derived: keeps the number of terms defined at an edge
UNIT = (2 * np.pi) ** (2 / 3)  # derived: of length: three images make up for the period without a constant
CLEAR = 3.0  # speed: half boxes, and a width of the patch, from the centre of a box to that of the nearest far patch
AT_ONCE = 4  # speed: of a power series at a time


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

    @property
    def count(self) -> int:
        """Number of boxes."""
        return self.start.size - 1

    def of(self, x: FloatArray) -> IntArray:
        """Box of each point of [0, 2 pi], (n,)."""
        return np.minimum((x / (2 * self.half)).astype(np.int64), self.count - 1)

    def images(self, box: IntArray) -> tuple[IntArray, IntArray]:
        """Near images of some boxes, one box after the other: place of the box in the list, and index of the image."""
        return _joined(self.start[box], np.diff(self.start)[box])

    def pairs(self, x: FloatArray, box: IntArray) -> Pairs:
        """Points with their near images."""
        point, image = self.images(box)
        return Pairs(point, self.patch[image], x[point] - self.center[image])

    def rest(self, x: FloatArray, box: IntArray) -> FloatArray:
        """Evaluate the smooth rest at points of boxes by Clenshaw's rule, (n,)."""
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
        self._terms = np.zeros((self.count, int(self._size.max(initial=1)) + AT_ONCE))  # charges, filled up with zeros
        self._terms[np.arange(self._terms.shape[1]) < self._size[:, None]] = np.concatenate(pressure.charges)
        # factors of zeta^n, n >= 1
        self._powers = np.ascontiguousarray((self._terms[:, 1:] / -np.arange(1, self._terms.shape[1])).T)
        self._boxes = self._in_boxes()
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
        block = max(1, LARGEST_BLOCK // int(np.diff(self._boxes.start).max()))
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
        wanted = np.minimum(np.log(10 / SERIES_ROUNDING) / np.maximum(decay, TINY), self._size[patch] - 1.0)
        rounds = np.ceil(wanted / AT_ONCE).astype(np.int64)
        most = int(rounds.max(initial=0))
        order = np.argsort((most - rounds).astype(np.min_scalar_type(most)), kind="stable")
        reach = np.cumsum(np.bincount(rounds, minlength=1)[::-1])[::-1]  # pairs with that many rounds, or more
        who, factor, total = patch[order], zeta[order], np.zeros(zeta.size)
        for k in range(most, 0, -1):
            active = slice(0, int(reach[k]))
            for terms in self._powers[AT_ONCE * (k - 1) : AT_ONCE * k][::-1]:
                total[active] += terms.take(who[active])
                total[active] *= factor[active]
        result = np.empty(zeta.size)
        result[order] = total
        return np.asarray(np.pi * (result + self._terms[patch, 0] * (np.log(self.radius[patch] / (2 * UNIT)) + decay)))

    def _in_boxes(self) -> Boxes:
        """Divide the circle into boxes, halved until they are as many as the patches."""
        boxes = self._whole_circle()
        while boxes.count < self.count:  # twice or half as many take as long (measured)
            boxes = self._halved(boxes)
        return boxes

    def _whole_circle(self) -> Boxes:
        """Return one box for the circle, with three images of every patch; singularities of the rest are 4 pi away."""
        center = self.center - 2 * np.pi * np.floor(self.center / (2 * np.pi))
        modes, terms = _decaying(2 * np.pi / self.radius), int(_decaying(np.array([2.0]))[0])
        sources, charges = self._sources(modes)
        turns = (_nodes(np.full(1, np.pi), np.pi, terms).T - np.repeat(center, modes) - sources) / (2 * np.pi)
        turns = np.abs(turns, out=turns)
        beyond = turns > 0.5  # from 1 rather than from 0, where the sine is small
        rest = np.log(np.sinc(turns - beyond) / np.where(beyond, turns * (1 + turns), 1 - turns * turns))
        images = np.concatenate([center - 2 * np.pi, center, center + 2 * np.pi])
        patch = np.tile(np.arange(self.count), 3)
        return Boxes(np.pi, np.array([0, patch.size]), patch, images, _series((rest @ charges)[None]))

    def _halved(self, whole: Boxes) -> Boxes:
        """Boxes half as wide.  Around one, the far field is analytic in x up to CLEAR half boxes from its center."""
        half, count = whole.half / 2, 2 * whole.count
        middle, parent = np.asarray((2 * np.arange(count) + 1.0) * half), np.arange(count) // 2
        box, image = whole.images(parent)
        patch, center = whole.patch[image], whole.center[image]
        near = np.abs(middle[box] - center) < CLEAR * half + 2 * self.radius[patch]
        start = np.searchsorted(box[near], np.arange(count + 1))

        nodes = _nodes(middle, half, int(_decaying(np.array([CLEAR]))[0]))
        values = (_in_halves(nodes.shape[1], whole.series.shape[0]) @ whole.series).T.reshape(nodes.shape)
        modes = _decaying(2 + (CLEAR - 1) * half / self.radius)
        sources, charges = self._sources(modes)
        far, which = _joined((np.cumsum(modes) - modes)[patch[~near]], modes[patch[~near]])
        owner, position = box[~near][far], (center[~near][far] + sources[which]) / UNIT
        scaled = nodes / UNIT
        block = max(1, LARGEST_BLOCK // nodes.shape[1])
        for first in range(0, which.size, block):
            part = slice(first, first + block)
            logs = scaled[owner[part]]
            logs -= position[part, None]
            np.log(np.abs(logs, out=logs), out=logs)
            logs *= charges[which[part], None]
            begin = np.flatnonzero(np.diff(owner[part], prepend=-1))
            values[owner[part][begin]] += np.add.reduceat(logs, begin, axis=0)
        return Boxes(half, start, patch[near], center[near], _series(values))

    def _completed(self, total: FloatArray, x: FloatArray) -> FloatArray:
        """u from the integral of the half-space kernel."""
        total *= -1 / np.pi
        return total if self._layer is None else total + self._layer_field(x, self._layer)

    def _inside(self, who: IntArray, n: int) -> FloatArray:
        """int log|x - x'| sigma dx' at the n + 1 extrema of patches with n terms, by the Martensen-Kussmaul rule."""
        q = regular_part(np.stack([self.pressure.charges[i] for i in who]), n)
        around = np.concatenate([q, q[:, -2:0:-1]], axis=1)  # at the 2 n angles of the whole circle
        # log|x - x'| = log(r/2) + 1/2 log 4 sin^2((a-b)/2) + 1/2 log 4 sin^2((a+b)/2), 0 <= b <= pi
        logs = np.fft.irfft(np.fft.rfft(around) * _kress_factors(n), 2 * n)[:, : n + 1]
        level = np.log(self.radius[who] / (2 * UNIT)) * (np.pi / (2 * n)) * around.sum(axis=1)
        return np.asarray(logs / 2 + level[:, None])

    def _sources(self, modes: IntArray) -> tuple[FloatArray, FloatArray]:
        """Places from the center and charges (pi/n) q of n nodes of the midpoint rule on every patch, joined."""
        first = np.cumsum(modes) - modes
        sources, charges = np.empty((2, int(modes.sum())))
        for n in np.unique(modes).tolist():
            who = np.flatnonzero(modes == n)
            rows, waves, low = first[who, None] + np.arange(n), _waves(n), self._terms[who, :n]
            sources[rows] = self.radius[who, None] * waves[1]
            charges[rows] = low @ waves[: low.shape[1]] * (np.pi / n)
        return sources, charges

    def _layer_modes(self, compliance_ratio: ComplianceRatio) -> ComplexArray:
        """2 (ratio_m - 1)/m sigma_m for m = 1.., up to where the ratio is 1 to rounding."""
        highest = 16
        while abs(float(compliance_ratio(np.array([float(highest)]))[0]) - 1) > SERIES_ROUNDING:
            highest *= 2
            if highest > MOST_LAYER_MODES:
                raise ValueError(f"compliance_ratio: not 1 to rounding at order {highest // 2}")
        m = np.arange(1, highest + 1)
        modes = np.zeros(highest, dtype=np.complex128)
        for c, r, charge in zip(self.center, self.radius, self.pressure.charges, strict=True):
            n = charge.size + int(np.ceil(highest * r)) + 20
            weighted = regular_part(charge, n) * (np.pi / n)
            weighted[[0, -1]] /= 2
            x = c + r * np.cos(np.arange(n + 1) * (np.pi / n))
            lowest = np.exp(-1j * np.multiply.outer(m[:ORDERS], x))
            for first in range(0, highest, ORDERS):
                few = slice(first, first + ORDERS)
                modes[few] += lowest[: modes[few].size] @ (weighted * np.exp(-1j * first * x))
        return np.asarray(modes * (compliance_ratio(m.astype(np.float64)) - 1) / m / np.pi)

    def _layer_field(self, x: FloatArray, modes: ComplexArray) -> FloatArray:
        """Return the displacement that a layer adds at points x, (n,)."""
        total = np.zeros(x.size)
        lowest = np.exp(1j * np.multiply.outer(x, np.arange(1, ORDERS + 1)))
        for first in range(0, modes.size, ORDERS):
            part = modes[first : first + ORDERS]
            total += (lowest[:, : part.size] @ part * np.exp(1j * first * x)).real
        return total


def regular_part(charge: FloatArray, n: int) -> FloatArray:
    """q = sum Q_k cos(k theta) at theta = j pi / n, j = 0..n, along the last axis; n >= number of coefficients."""
    spectrum = np.zeros((*charge.shape[:-1], n + 1))
    spectrum[..., : charge.shape[-1]] = n * charge
    spectrum[..., 0] *= 2
    return np.fft.irfft(spectrum, 2 * n)[..., : n + 1]


def series_and_twice_the_mean(values: FloatArray) -> FloatArray:
    """2 Q_0, Q_1, .., Q_n-1 of sum Q_k cos(k theta) through values at (j + 1/2) pi / n along the last axis."""
    n = values.shape[-1]
    spectrum = np.fft.rfft(np.concatenate([values, values[..., ::-1]], axis=-1)) / half_steps(n)
    return np.asarray(spectrum.real[..., :n] / n)


@lru_cache(maxsize=256)
def half_steps(n: int) -> ComplexArray:
    """exp(i k pi / (2 n)) for k = 0 .. n: from values at j pi / n to those half a step behind them, (n + 1,)."""
    return np.asarray(np.exp(1j * np.arange(n + 1) * (np.pi / (2 * n))))


def _kress_factors(n: int) -> FloatArray:
    """Return the discrete Fourier transform of the weights of int_0^2pi log(4 sin^2(s/2)) f ds, (n + 1,).

    The weights at s = k pi / n, k < 2 n, are -(2 pi/n) sum_{m < n} cos(m s)/m - (pi/n^2) cos(n s).
    """
    factors = np.zeros(n + 1)
    factors[1:] = -2 * np.pi / np.arange(1, n + 1)
    return factors


def _joined(first: IntArray, count: IntArray) -> tuple[IntArray, IntArray]:
    """Ranges of integers one after the other: the place of each in the list of ranges, and its value."""
    range_of = np.repeat(np.arange(count.size), count)
    return range_of, np.arange(range_of.size) + (first - np.cumsum(count) + count)[range_of]


@lru_cache(maxsize=256)
def _waves(n: int) -> FloatArray:
    """cos(k theta) for k < n at the nodes theta of the midpoint rule, (n, n)."""
    return np.asarray(np.cos(np.multiply.outer(np.arange(n), (np.arange(n) + 0.5) * (np.pi / n))))


@lru_cache(maxsize=4)
def _in_halves(nodes: int, terms: int) -> FloatArray:
    """Chebyshev polynomials of a box at the nodes of its halves, (2 n_nodes, n_terms)."""
    places = _nodes(np.array([-0.5, 0.5]), 0.5, nodes).ravel()
    return np.asarray(np.polynomial.chebyshev.chebvander(places, terms - 1), dtype=np.float64)


def _nodes(middle: FloatArray, half: float, terms: int) -> FloatArray:
    """Chebyshev nodes of boxes, (n_boxes, n_terms)."""
    return np.asarray(middle[:, None] + half * np.cos((np.arange(terms) + 0.5) * (np.pi / terms)))


def _series(values: FloatArray) -> FloatArray:
    """Chebyshev series through values at the nodes of boxes, (n_boxes, n_terms), transposed."""
    series = series_and_twice_the_mean(values).T
    series[0] /= 2
    return series


def _decaying(distance: FloatArray) -> IntArray:
    """Terms, to rounding, of Chebyshev series whose nearest singularity is so many half intervals from the middle."""
    rate = np.log(distance + np.sqrt(distance * distance - 1))
    return np.asarray(np.ceil(-np.log(SERIES_ROUNDING) / rate) + 1, dtype=np.int64)
