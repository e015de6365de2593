"""Logarithmic potential of charges on the circle, of many charges at many points in nearly linear time.

    phi(x) = sum_j q_j log|2 sin((x - x_j)/2)|,   2 sin((x - x_j)/2) = 2 (sin(x/2) cos(x_j/2) - cos(x/2) sin(x_j/2)):

the chord is a matrix product, and few pairs are summed one by one.  For many, the circle is cut into equal boxes.
Between boxes that touch the sum goes pair by pair; between all others the logarithm is a polynomial of both positions
(Fong, Darve, J. Comput. Phys. 228 (2009) 8712, doi:10.1016/j.jcp.2009.08.031, here with boxes of one size),

    log|2 sin((x - x')/2)| = sum_kl C_kl(distance of the boxes) T_k(t) T_l(t'),   t, t' in (-1, 1) across the boxes.

C depends on the distance alone, so what the boxes do to one another is a convolution round the circle, by the
discrete Fourier transform.  The nearest singularity is three half boxes from the center of a box: n terms leave
(3 + sqrt 8)^-n, and 20 of them rounding.  Dimensionless; positions in radians, on any turn of the circle.  Limits:
rounding of the positions, 3e-15 |q_j| over the chord to x_j (measured); no point may lie on a charge.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from bem.geometry import chebyshev
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI
from bem.kernels.potential import pair_by_pair

DIRECT, PER_BOX = 800_000, 18  # speed: pairs up to which boxes do not pay, and root of the pairs per box (measured)
BOX_TERMS = 20  # derived: of a polynomial in a box; (3 + sqrt 8)^-20 = 5e-16


@dataclass(frozen=True, eq=False)
class LogarithmicPotential:
    """Potential sum_j q_j log|2 sin((x - x_j)/2)| as a function of position.

    Attributes
    ----------
    position : (n_charges,) array
        x_j, dimensionless (one period is 2 pi), at least one, in any order.
    charge : (n_charges,) array
        q_j.

    Examples
    --------
    The potential of three equal charges, evenly spread, is log|2 sin(3 x/2)|:

    >>> potential = LogarithmicPotential(TWO_PI / 3 * np.arange(3), np.ones(3))
    >>> [round(float(phi), 4) for phi in (*potential(np.array([0.1])), np.log(2 * np.sin(0.15)))]
    [-1.2077, -1.2077]
    """

    position: FloatArray
    charge: FloatArray

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return the potential at points x, (n,), none of them on a charge."""
        half, points = x / 2, np.empty((2, x.size))
        np.sin(half, out=points[0])
        np.cos(half, out=points[1])
        points *= 2
        pairs = x.size * self.position.size
        if pairs <= DIRECT:
            return pair_by_pair(points, self._sources, self.charge)
        series = self._series(1 << int(np.log2(np.sqrt(pairs) / PER_BOX)))
        return box_potential(x, points, self.position, self._sources, self.charge, series)

    @cached_property
    def _sources(self) -> FloatArray:
        """Rows cos(x_j/2) and -sin(x_j/2) of the charges, (2, n_charges).

        Cached from call to call.
        """
        return np.array([np.cos(self.position / 2), -np.sin(self.position / 2)])

    def _series(self, boxes: int) -> FloatArray:
        """Return the Chebyshev series in every box of the potential of charges not beside it, (boxes, BOX_TERMS)."""
        if boxes not in self._prepared:
            moments = box_moments(self.position, self.charge, boxes)
            spectrum = _coupling(boxes) @ np.fft.rfft(moments[:, :, None], axis=0)
            self._prepared[boxes] = np.fft.irfft(spectrum, boxes, axis=0)[:, :, 0]
        return self._prepared[boxes]

    @cached_property
    def _prepared(self) -> dict[int, FloatArray]:
        return {}


def box_moments(position: FloatArray, charge: FloatArray, boxes: int) -> FloatArray:
    """Return the sums of q_j T_k(t_j) over the charges in each of equal boxes of the circle, (boxes, BOX_TERMS)."""
    box, values = _in_boxes(position, boxes)
    entry = box * BOX_TERMS + np.arange(BOX_TERMS)[:, None]
    moments = np.bincount(entry.ravel(), (values * charge).ravel(), boxes * BOX_TERMS)
    return np.asarray(moments.reshape(boxes, BOX_TERMS), dtype=np.float64)


def box_potential(
    x: FloatArray, points: FloatArray, position: FloatArray, sources: FloatArray, charge: FloatArray, series: FloatArray
) -> FloatArray:
    """Return the potential at x, (n,): pair by pair for charges in and beside the box of x, plus a series per box.

    Points and sources are as in `pair_by_pair`; series of T_k across the boxes, (boxes, BOX_TERMS).
    """
    boxes = series.shape[0]
    (box_x, values), box = _in_boxes(x, boxes), _in_boxes(position, boxes)[0]
    total = np.einsum("kn,kn->n", values, series.T.take(box_x, axis=1))
    order_x, order = np.argsort(box_x, kind="stable"), np.argsort(box, kind="stable")
    ends_x, ends = (np.cumsum(np.bincount(which, minlength=boxes)).tolist() for which in (box_x, box))
    circle = np.concatenate([order[ends[-2] :], order, order[: ends[0]]])  # from the last box round to the first
    in_last = order.size - ends[-2]
    starts = [0, in_last, *(in_last + end for end in ends), circle.size]  # of boxes -1, 0, 1, ..., 0 in the circle
    points, sources, charge = points[:, order_x], sources[:, circle], charge[circle]
    touching = [
        pair_by_pair(
            np.ascontiguousarray(points[:, first:last]),
            np.ascontiguousarray(sources[:, start:stop]),
            charge[start:stop],
        )
        for first, last, start, stop in zip([0, *ends_x], ends_x, starts, starts[3:], strict=False)
    ]
    total[order_x] += np.concatenate(touching)
    return np.asarray(total)


def _in_boxes(x: FloatArray, boxes: int) -> tuple[IntArray, FloatArray]:
    """Return the box of each point, (n,), and the Chebyshev polynomials at the points, (BOX_TERMS, n)."""
    place = x * (boxes / TWO_PI)
    box = np.floor(place).astype(np.int64)
    values = np.empty((BOX_TERMS, x.size))
    values[0], values[1], twice = 1.0, 2 * (place - box) - 1, 4 * (place - box) - 2
    for k in range(2, BOX_TERMS):
        np.multiply(twice, values[k - 1], out=values[k])
        values[k] -= values[k - 2]
    return box % boxes, values


@lru_cache(maxsize=16)
def _coupling(boxes: int) -> NDArray[np.complex128]:
    """Return C_kl, zero for touching boxes, transformed over the distance, (boxes // 2 + 1, BOX_TERMS, BOX_TERMS)."""
    node = chebyshev.basis_nodes(BOX_TERMS)
    distance = (np.arange(2, boxes - 1)[:, None, None] + (node[:, None] - node) / 2) * (TWO_PI / boxes)
    series = np.zeros((boxes, BOX_TERMS, BOX_TERMS))
    in_source = chebyshev.coefficients(np.log(2 * np.sin(distance / 2)))
    series[2:-1] = chebyshev.coefficients(in_source.swapaxes(1, 2)).swapaxes(1, 2)
    return np.fft.rfft(series, axis=0)
