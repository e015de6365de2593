"""Gaps between contact patches, in order on the circle: the mirror of patches.py.

A gap is kept as its half width and its center, and that as a fixed point near it and a small distance from there, so
that gaps may be narrower than positions are rounded.  What opens in it is g = sum g_n sin((n + 1) theta), n >= 0, with
x = center + half width cos(theta).  Lengths are dimensionless (scaled by 1/q0).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem.geometry.arrays import FloatArray
from bem.geometry.patches import TWO_PI, Patches, ordered


@dataclass(frozen=True, eq=False)
class Gaps:
    """Gaps in order on the circle, (G,) each.

    Parameters
    ----------
    anchor : array
        A point near each gap.
    shift : array
        Center less anchor.
    half_width : array
    """

    anchor: FloatArray
    shift: FloatArray
    half_width: FloatArray

    @property
    def count(self) -> int:
        """Number of gaps G."""
        return int(self.anchor.size)

    @cached_property
    def center(self) -> FloatArray:
        """Middles, (G,)."""
        return self.anchor + self.shift

    @cached_property
    def patch_after(self) -> FloatArray:
        """Width of the contact behind each gap, (G,)."""
        following = np.append(self.center[1:], self.center[:1] + TWO_PI)
        return following - self.center - self.half_width - np.roll(self.half_width, -1)

    @cached_property
    def patch_before(self) -> FloatArray:
        """Width of the contact before each gap, (G,)."""
        return np.roll(self.patch_after, 1)

    def moved(self, outward: FloatArray) -> Gaps:
        """Return the gaps after each end moved out of its gap by the given (2 G,) amounts, all left ends first."""
        left, right = outward[: self.count], outward[self.count :]
        return Gaps(self.anchor, self.shift + (right - left) / 2, self.half_width + (right + left) / 2)

    def kept(self, which: NDArray[np.bool_]) -> Gaps:
        """Return the gaps for which `which` is True."""
        return Gaps(self.anchor[which], self.shift[which], self.half_width[which])

    def joined(self, others: Gaps) -> Gaps:
        """Return these gaps and others in order; gaps that touch are one."""
        parts = np.hstack([(gaps.anchor, gaps.shift, gaps.half_width) for gaps in (self, others)])
        return Gaps(*parts[:, np.argsort(parts[0] + parts[1])]).united()

    def united(self) -> Gaps:
        """Return the gaps with gaps that touch as one."""
        if self.count < 2 or np.min(self.patch_after) > 0:
            return self
        first = int(np.argmin(self.patch_after))
        second = (first + 1) % self.count
        left, right = self.center[first] - self.half_width[first], self.center[second] + self.half_width[second]
        right += TWO_PI if second < first else 0.0
        both = np.isin(np.arange(self.count), (first, second))
        whole = Gaps(np.array([(left + right) / 2 % TWO_PI]), np.zeros(1), np.array([(right - left) / 2]))
        return self.kept(~both).joined(whole)

    def patches(self) -> Patches:
        """Return the patches between the gaps."""
        right = np.append(self.center[1:], self.center[:1] + TWO_PI) - np.roll(self.half_width, -1)
        return ordered(self.center + self.half_width, right)


def gaps_of(patches: Patches) -> Gaps:
    """Return the gaps between patches, anchored in their middles."""
    middle = (patches.right + patches.gap_after / 2) % TWO_PI
    order = np.argsort(middle)
    return Gaps(middle[order], np.zeros(order.size), patches.gap_after[order] / 2)


def sines(series: FloatArray, theta: FloatArray) -> FloatArray:
    """Return sum g_n sin((n + 1) theta), shape of theta: what opens in a gap."""
    return np.asarray(np.sin(np.multiply.outer(theta, np.arange(1, series.size + 1))) @ series)
