"""Distributions of the widths of contact patches and of the gaps between them.

They are given exactly, as the sorted widths with two cumulative shares, instead of as a histogram: the share of
patches (or gaps) up to a width, and the share of the contact (or gap) length in them.  Any histogram follows.
Dimensionless or SI alike: the unit is that of the widths.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.geometry.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class WidthDistribution:
    """Cumulative distribution of widths."""

    widths: FloatArray  # sorted, increasing, (n,)
    number_share: FloatArray  # of the patches at most so wide; the last is 1; (n,)
    length_share: FloatArray  # of the total length in patches at most so wide; the last is 1; (n,)


def width_distribution(widths: FloatArray) -> WidthDistribution:
    """The distribution of given widths, (n,), all > 0; n may be 0.

    Examples
    --------
    >>> found = width_distribution(np.array([3.0, 1.0]))
    >>> found.widths.tolist(), found.number_share.tolist(), found.length_share.tolist()
    ([1.0, 3.0], [0.5, 1.0], [0.25, 1.0])
    """
    ordered = np.sort(widths)
    cumulated = np.cumsum(ordered)
    total = cumulated[-1] if ordered.size else 1.0
    return WidthDistribution(ordered, np.arange(1, ordered.size + 1) / max(1, ordered.size), cumulated / total)
