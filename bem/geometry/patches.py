"""Contact domain: patches [a_i, b_i] in order on the circle [0, 2 pi), and the pressure they carry.

Edges are kept as two arrays, `left` in [0, 2 pi) increasing and `right` > `left`, where the last patch may
reach beyond 2 pi.  Edge vectors have length 2 L and list all left edges, then all right edges; the outward
direction is -x on the left, +x on the right.  Lengths are dimensionless (scaled by 1/q0).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from bem.geometry.arrays import FloatArray
from bem.geometry.minima import OFFSETS, refined

TWO_PI = 2 * np.pi
SHUT_GAP = 1e-7  # periods: a gap too narrow to be evaluated
POSITION_ROUNDING = 3 * TWO_PI * float(np.finfo(float).eps)  # of center, edge and point, each rounded; measured 1.1e-15
CHARGE_ROUNDING = 1e-14  # of charges of order 1 per node, and of heights, times a mean pressure above 1; measured 4e-15


@dataclass(frozen=True, eq=False)
class Patches:
    """Contact patches in order on the circle.

    Parameters
    ----------
    left, right : (L,) arrays
        Edges, dimensionless.
    """

    left: FloatArray
    right: FloatArray

    @property
    def count(self) -> int:
        """Number of patches L."""
        return int(self.left.size)

    @cached_property
    def center(self) -> FloatArray:
        """Midpoints, (L,)."""
        return (self.left + self.right) / 2

    @cached_property
    def half_width(self) -> FloatArray:
        """Half widths, (L,)."""
        return (self.right - self.left) / 2

    @cached_property
    def width(self) -> FloatArray:
        """Widths, (L,)."""
        return self.right - self.left

    @cached_property
    def gap_after(self) -> FloatArray:
        """Width of the gap behind each patch, up to the next one on the circle, (L,)."""
        return np.concatenate([self.left[1:], self.left[:1] + TWO_PI]) - self.right

    @cached_property
    def gap_before(self) -> FloatArray:
        """Width of the gap before each patch, (L,)."""
        return np.concatenate([self.gap_after[-1:], self.gap_after[:-1]])

    @property
    def contact_fraction(self) -> float:
        """Projected contact length over the period."""
        return float(np.sum(self.width)) / TWO_PI

    @cached_property
    def edge_scale(self) -> FloatArray:
        """min(patch width, adjacent gap) of each edge, (2 L,): the length in which an edge may move."""
        return np.concatenate([np.minimum(self.width, self.gap_before), np.minimum(self.width, self.gap_after)])

    @property
    def is_ordered(self) -> bool:
        """True if all widths and gaps are positive."""
        return bool(self.width.min(initial=np.inf) > 0 and self.gap_after.min(initial=np.inf) > 0)

    def moved(self, outward: FloatArray) -> Patches:
        """Return the patches after each edge moved outward by the given (2 L,) amounts."""
        count = self.count
        return Patches(self.left - outward[:count], self.right + outward[count:])

    def with_patch(self, left: float, right: float) -> Patches:
        """Return the patches with a further patch, inserted in order."""
        return ordered(np.append(self.left, left), np.append(self.right, right))

    def merged_after(self, index: int) -> Patches:
        """Return the patches with the gap behind patch `index` closed; ValueError for the only patch."""
        closed = np.zeros(self.count, dtype=bool)
        closed[index] = True
        return self.merged_at(closed)

    def merged_at(self, closed: NDArray[np.bool_]) -> Patches:
        """Return the patches with the gaps closed behind patches marked in `closed`, (L,); ValueError if all are."""
        if np.all(closed):
            raise ValueError("the gap of a single patch closes to complete contact, which has no edges")
        left = self.left[~np.roll(closed, 1)]
        right = self.right[~closed]
        if closed[-1]:  # the patch that begins last ends a period on
            right = np.append(right[1:], right[0] + TWO_PI)
        return ordered(left, right)

    def joined(self, others: Patches) -> Patches | None:
        """Return these patches and others in order; None if any two patches overlap."""
        both = ordered(np.concatenate([self.left, others.left]), np.concatenate([self.right, others.right]))
        return both if both.is_ordered else None

    def canonical(self) -> Patches:
        """Return the patches with every left edge in [0, 2 pi), in order."""
        return ordered(self.left, self.right)


def ordered(left: FloatArray, right: FloatArray) -> Patches:
    """Return patches sorted by their left edge, which is brought into [0, 2 pi).

    Examples
    --------
    >>> ordered(np.array([7.0, 1.0]), np.array([7.5, 2.0])).left.round(3).tolist()
    [0.717, 1.0]
    """
    shift = np.floor(left / TWO_PI) * TWO_PI
    start, stop = left - shift, right - shift
    beyond = start >= TWO_PI  # -tiny + 2 pi is 2 pi itself in floating point: a rounding below zero belongs to zero
    start, stop = np.where(beyond, 0.0, start), np.where(beyond, right, stop)
    order = np.argsort(start)
    return Patches(start[order], stop[order])


@dataclass(frozen=True, eq=False)
class PatchPressure:
    """Pressure as a Chebyshev series with square-root edges on each patch.

    sigma(x) = sum_n charges[i][n] T_n(t) / (r_i sqrt(1 - t^2)),  x = c_i + r_i t.

    Parameters
    ----------
    left, right : (L,) arrays
        Edges of the patches, dimensionless.
    charges : tuple of L arrays (N_i,)
        Chebyshev coefficients, in units of force per length.
    """

    left: FloatArray
    right: FloatArray
    charges: tuple[FloatArray, ...]

    @property
    def load(self) -> float:
        """Force per period, int sigma dx."""
        return float(np.pi * sum(charge[0] for charge in self.charges))

    def peak(self) -> float:
        """Return the largest pressure of at least one patch; below zero if all pressure is tension.

        With t = cos(theta) the pressure is smooth in theta between the edges, where it falls to zero or, under
        adhesion, to -infinity.  It is sampled at four points for each coefficient, and refined between them.

        Examples
        --------
        >>> half = np.array([1.0])
        >>> round(PatchPressure(-half, half, (np.array([0.5, 0.0, -0.5]),)).peak(), 5)  # sigma = sqrt(1 - x^2)
        1.0
        """
        half_width = (self.right - self.left) / 2
        sampled = [_sampled(charge) / half for charge, half in zip(self.charges, half_width, strict=True)]
        highest = max(float(values.max()) for values in sampled)
        for charge, half, values in zip(self.charges, half_width, sampled, strict=True):
            top, count = int(np.argmax(values)), values.size
            if 0 < top < count - 1 and 3 * values[top] - values[top - 1] - values[top + 1] > highest:
                lowest = refined(partial(_tension, charge / half), (top + 0.5 + OFFSETS) * (np.pi / count))
                highest = max(highest, -float(lowest.value[0]))
        return highest


def _sampled(charge: FloatArray) -> FloatArray:
    """Return r sigma of a patch at four points for each coefficient, equidistant in theta."""
    count, order = 4 * charge.size, np.arange(charge.size)
    modes = np.zeros(count + 1, dtype=np.complex128)
    modes[: charge.size] = charge * np.where(order, count, 2 * count) * np.exp(0.5j * np.pi / count * order)
    return np.asarray(np.fft.irfft(modes, 2 * count)[:count] / np.sin((np.arange(count) + 0.5) * (np.pi / count)))


def _tension(charge: FloatArray, theta: FloatArray) -> FloatArray:
    """Return minus the pressure of a series on a patch of half width 1, shape of theta."""
    return np.asarray(-np.cos(np.multiply.outer(theta, np.arange(charge.size))) @ charge / np.sin(theta))
