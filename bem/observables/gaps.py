"""Statistics of the gap between the surfaces, and the widest channel, for estimates of leakage along the ridges.

With the gap g(x), means <.> over the period lambda, and the open part of the period of length s lambda where g > 0,

    mean_open = <g> / s,    mean_cubic_root = <g^3>^(1/3);

quantiles are taken of g over the open length.  By Reynolds' equation the flow along the ridges is proportional to
<g^3>; across them one closed contact lets nothing through, so a line model says nothing of percolation.

The integral over a gap from a to a + w is the midpoint rule in theta, x = a + w (1 - cos theta)/2, where g is smooth.
Dimensionless (scaling.py).  Limits: 16 points per shortest wavelength in the middle of a gap, at least 24 on each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bem.audit.displacement import ComplianceRatio, DisplacementField, GapPoints
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import PatchPressure
from bem.geometry.profile import Profile

SHAPE_POINTS_PER_WAVE = 16  # format: of stored shapes and of gaps
LEAST_POINTS = 24  # format: on a patch or gap
FINER = 8  # format: interpolated heights for quantiles, per point
LEVELS = np.array([0.1, 0.25, 0.5, 0.75, 0.9])  # format: quantiles


@dataclass(frozen=True, eq=False)
class OpenGaps:
    """Points in gaps, one gap after the other: displacement and height at each, (n,), and their number on each gap."""

    x: FloatArray
    displacement: FloatArray
    height: FloatArray
    count: IntArray


@dataclass(frozen=True, eq=False)
class GapStatistics:
    """Statistics of the gap: `mean_cube` is <g^3>, `quantiles` belong to `LEVELS`."""

    mean_cube: float
    quantiles: FloatArray
    widest: float


def open_gaps(
    profile: Profile, pressure: PatchPressure, penetration: float, ratio: ComplianceRatio | None = None
) -> OpenGaps:
    """Return points in all gaps of a state with patches; `ratio` is the compliance relative to the half-space."""
    width = gap_widths(pressure)
    count = points_on(width, profile)
    gap = np.repeat(np.arange(count.size), count)
    from_left = clustered(width, count)
    points = GapPoints(gap, from_left, width[gap] - from_left)
    field = DisplacementField(pressure, ratio)
    x, displacement = field.positions(points), field.in_gaps(points)
    return OpenGaps(x, displacement, displacement - contact_shape(profile, x, penetration), count)


def statistics(heights: Sequence[FloatArray], widths: FloatArray) -> GapStatistics:
    """Return the statistics of gaps from their widths, (n_gaps,), and the heights at equidistant theta on each.

    Quantiles are taken of heights interpolated linearly in theta, `FINER` times as many and zero at both edges.

    Examples
    --------
    >>> theta = (np.arange(64) + 0.5) * np.pi / 64
    >>> gaps = statistics([np.sin(theta)], np.array([np.pi]))  # a half circle, 3 pi / 16 of g^3, on half of the period
    >>> round(gaps.mean_cube / (3 * np.pi / 32), 9), round(float(gaps.quantiles[2]), 2)
    (1.0, 0.87)
    """
    cube, fine, shares = 0.0, [], []
    for height, width in zip(heights, widths, strict=True):
        cube += float(np.sum(height**3 * _weights(height.size))) * width
        theta = np.concatenate([[0.0], _midpoints(height.size), [np.pi]])
        fine.append(np.interp(_midpoints(FINER * height.size), theta, np.concatenate([[0.0], height, [0.0]])))
        shares.append(_weights(FINER * height.size) * (width / np.sum(widths)))
    quantiles = _quantiles(np.concatenate(fine), np.concatenate(shares))
    return GapStatistics(float(cube / (2 * np.pi)), quantiles, float(np.max(widths)))


def _quantiles(heights: FloatArray, shares: FloatArray) -> FloatArray:
    """Return the heights at `LEVELS` of their cumulative shares, whose sum is 1."""
    order = np.argsort(heights)
    return np.asarray(np.interp(LEVELS, np.cumsum(shares[order]) - shares[order] / 2, heights[order]))


def statistics_of_openings(half_widths: FloatArray, openings: Sequence[FloatArray]) -> GapStatistics:
    """Return the statistics of gaps given by series: g = sum_n g_n sin((n + 1) theta) on each, t = cos theta."""
    heights = []
    for series in openings:
        theta = _midpoints(max(4 * series.size, LEAST_POINTS))
        heights.append(np.sin(np.multiply.outer(theta, np.arange(1, series.size + 1))) @ series)
    return statistics(heights, 2 * half_widths)


def apart(profile: Profile, penetration: float) -> GapStatistics:
    """Return the statistics of surfaces apart, penetration <= 0, on a uniform grid."""
    x = uniform(profile)
    heights = -contact_shape(profile, x, penetration)
    quantiles = _quantiles(heights, np.full(x.size, 1 / x.size))
    return GapStatistics(float(np.mean(heights**3)), quantiles, 2 * np.pi)


def uniform(profile: Profile) -> FloatArray:
    """Return uniform points, 16 per shortest wavelength and at least 256."""
    n = max(SHAPE_POINTS_PER_WAVE * profile.max_order, 256)
    return np.linspace(0.0, 2 * np.pi, n, endpoint=False)


def gap_widths(pressure: PatchPressure) -> FloatArray:
    """Return the widths of the gaps, each behind the patch with its index, (n_patches,)."""
    return np.asarray(np.append(pressure.left[1:], pressure.left[:1] + 2 * np.pi) - pressure.right)


def contact_shape(profile: Profile, x: FloatArray, penetration: float) -> FloatArray:
    """Return h - h_max + Delta, (n,)."""
    return np.asarray(profile.height(x) - profile.max_height + penetration)


def points_on(width: FloatArray, profile: Profile) -> IntArray:
    """Return the numbers of points on patches or gaps of these widths, (n,)."""
    density = SHAPE_POINTS_PER_WAVE / 4 * profile.max_order
    return np.maximum(np.ceil(density * width), LEAST_POINTS).astype(np.int64)


def clustered(width: FloatArray, count: IntArray) -> FloatArray:
    """Return distances width (1 - cos theta)/2 from the start of every interval, joined."""
    share = [np.sin(_midpoints(n) / 2) ** 2 for n in count]
    return np.asarray(np.repeat(width, count) * np.concatenate(share))


def _midpoints(n: int) -> FloatArray:
    """Return theta = (k + 1/2) pi / n, (n,)."""
    return np.asarray((np.arange(n) + 0.5) * (np.pi / n))


def _weights(n: int) -> FloatArray:
    """Return the shares of an interval that the points at `_midpoints` stand for, (n,)."""
    return np.asarray(np.sin(_midpoints(n)) * (np.pi / (2 * n)))
