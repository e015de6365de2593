"""The gaps between contact patches, in order on the circle: the mirror of patches.py.

A gap is kept as its half width and its center, and that as a fixed point near it and a small distance from there, so
that gaps may be narrower than positions are rounded.  Lengths are dimensionless (scaled by 1/q0).
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
    """Gaps in order on the circle, dimensionless, (G,) each.

    Parameters
    ----------
    anchor : array
        A point near each.
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
        """Gaps after each end moved out of it by the given (2 G,) amounts, all left ends first."""
        left, right = outward[: self.count], outward[self.count :]
        return Gaps(self.anchor, self.shift + (right - left) / 2, self.half_width + (right + left) / 2)

    def kept(self, which: NDArray[np.bool_]) -> Gaps:
        """Return the gaps for which `which` is True."""
        return Gaps(self.anchor[which], self.shift[which], self.half_width[which])

    def joined(self, others: Gaps) -> Gaps:
        """Return these gaps and others in order; gaps that touch become one gap."""
        parts = [np.concatenate(pair) for pair in zip(self._arrays, others._arrays, strict=True)]
        order = np.argsort(parts[0] + parts[1])
        return _united(Gaps(*(part[order] for part in parts)))

    def patches(self) -> Patches:
        """Return the patches between the gaps."""
        right = np.append(self.center[1:], self.center[:1] + TWO_PI) - np.roll(self.half_width, -1)
        return ordered(self.center + self.half_width, right)

    @property
    def _arrays(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        return self.anchor, self.shift, self.half_width


def gaps_of(patches: Patches) -> Gaps:
    """Return the gaps between patches, anchored in their middles."""
    middle = patches.right + patches.gap_after / 2
    turned = middle % TWO_PI
    order = np.argsort(turned)
    return Gaps(turned[order], np.zeros(order.size), patches.gap_after[order] / 2)


def _united(gaps: Gaps) -> Gaps:
    """Gaps in order of their centers, those that touch united."""
    while gaps.count > 1 and np.min(gaps.patch_after) <= 0:
        first = int(np.argmin(gaps.patch_after))
        second = (first + 1) % gaps.count
        left, right = gaps.center[first] - gaps.half_width[first], gaps.center[second] + gaps.half_width[second]
        right += TWO_PI if second < first else 0.0
        kept = np.ones(gaps.count, dtype=bool)
        kept[second] = False
        anchor, shift, half = (part.copy() for part in gaps._arrays)
        anchor[first], shift[first], half[first] = (left + right) / 2, 0.0, (right - left) / 2
        gaps = Gaps(anchor, shift, half).kept(kept)
    return gaps
