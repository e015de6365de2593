"""Distributions of the widths of contact patches and of the gaps between them.

They are given exactly, as the sorted widths with the cumulative share of patches (or gaps) up to a width, instead of as
a histogram.  Any histogram follows, and so does the share of the length: the widths are summed.
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


def width_distribution(widths: FloatArray) -> WidthDistribution:
    """The distribution of given widths, (n,), all > 0; n may be 0.

    Examples
    --------
    >>> found = width_distribution(np.array([3.0, 1.0]))
    >>> found.widths.tolist(), found.number_share.tolist()
    ([1.0, 3.0], [0.5, 1.0])
    """
    return WidthDistribution(np.sort(widths), np.arange(1, widths.size + 1) / max(1, widths.size))
