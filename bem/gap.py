"""The gap outside contact: where the surfaces interpenetrate, and by how much.

The displacement u(x) = -(1/pi) int log|2 sin((x - x')/2)| sigma dx' in a gap is sampled at points that cluster at
the edges, x = b + g (1 - cos theta)/2, where it is a smooth function of theta, and interpolated to a grid that
resolves the profile; minima that come near zero are evaluated again at their own place and refined by a
parabola.  The two patches beside a gap contribute through the outer form of the logarithmic moments,

    int log|t - t'| T_n / sqrt(1 - t'^2) dt' = -(pi/n) zeta^n (n >= 1),  -pi log|2 zeta| (n = 0),
    zeta = t - sgn(t) sqrt(t^2 - 1),

all others through their skeleton charges.  Dimensionless; the skeleton limits the accuracy to that of the state.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from bem import chebyshev
from bem.collocation import Elastic, Evaluation
from bem.patches import Patches, PatchPressure

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

SUSPICIOUS_GAP = 1e-3  # of the rms height: interpolated minima below are evaluated again
POINTS_PER_WAVELENGTH = 10
REFINEMENTS, REFINEMENT_RATIO = 2, 20.0  # of a minimum: parabolas on ever shorter bases, 1/400 of a grid cell at last
NEGLIGIBLE = -39.0  # logarithm of what a decaying power may lose
GRID_RATIO = 1.2  # steps of the list of grid sizes, so that equal ones are treated together
LARGEST_MATRIX = 1_000_000  # entries of an interpolation, 8 MB; longer series are summed by Clenshaw's rule
_TERMS = 8  # of a power series summed at a time


@dataclass(frozen=True, eq=False)
class GapField:
    """Gap of a solved state at points outside contact."""

    elastic: Elastic
    state: Evaluation
    pressure: PatchPressure
    nodes: FloatArray
    starts: IntArray

    def __call__(self, x: FloatArray, gap: IntArray) -> FloatArray:
        """Gap u - (h - h_max + Delta) at points x, each lying in the gap behind patch `gap`, (n,)."""
        profile = self.elastic.profile
        contact = profile.height(x) - profile.max_height + self.state.penetration
        return self.displacement(x, gap) - contact

    def displacement(self, x: FloatArray, gap: IntArray) -> FloatArray:
        """Mean-free interface displacement at points x, each lying in the gap behind patch `gap`, (n,)."""
        sources = np.stack([np.cos(self.nodes / 2), -np.sin(self.nodes / 2)])
        points = 2 * np.stack([np.sin(x / 2), np.cos(x / 2)], axis=1)
        total = np.empty(x.size)
        block = max(1, 2_000_000 // self.nodes.size)
        for first in range(0, x.size, block):
            chord = points[first : first + block] @ sources  # 2 sin((x - x')/2)
            np.log(np.abs(chord, out=chord), out=chord)
            total[first : first + block] = chord @ self.state.skeleton
        for correction in self.elastic.corrections:
            total += correction.field(x, self.nodes, self.state.skeleton)
        following = (gap + 1) % self.state.patches.count
        total += self._near_patch(gap, x)
        total += self._near_patch(following, x - np.where(following <= gap, 2 * np.pi, 0.0))
        return np.asarray(-total / np.pi)

    def _near_patch(self, index: IntArray, x: FloatArray) -> FloatArray:
        """Exact logarithmic part of one patch less that of its skeleton, for each x the patch it lies beside, (n,)."""
        patches = self.state.patches
        charges, skeleton, sources = self._tables
        t = (x - patches.center[index]) / patches.half_width[index]
        zeta = 1 / (t + np.copysign(np.sqrt(np.maximum(t * t - 1, 0.0)), t))
        exact = np.log(np.abs(2 * zeta)) * charges[index, 0] + _power_series(charges[:, 1:], index, zeta)
        coarse = np.einsum("nk,nk->n", np.log(np.abs(t[:, None] - sources[index])), skeleton[index])
        return np.asarray(-np.pi * exact - coarse)

    @cached_property
    def _tables(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Series of the patches by rows, and charges and places in (-1, 1) of their skeletons, filled up with zeros."""
        modes = self.state.resolution.modes
        series = np.zeros((modes.size, max(charge.size for charge in self.pressure.charges)))
        skeleton, sources = np.zeros((2, modes.size, int(modes.max())))
        for i, (charge, start, count) in enumerate(zip(self.pressure.charges, self.starts, modes, strict=True)):
            series[i, : charge.size] = charge
            skeleton[i, :count] = self.state.skeleton[start : start + count]
            sources[i, :count] = chebyshev.basis_nodes(int(count))
        return series, skeleton, sources


def _power_series(coefficients: FloatArray, row: IntArray, zeta: FloatArray) -> FloatArray:
    """sum_{n >= 1} c_n zeta^n / n for each zeta the row of its series, (n,); each as far as its powers are not lost."""
    count = -(-coefficients.shape[1] // _TERMS) * _TERMS
    terms = np.zeros((coefficients.shape[0], count))
    terms[:, : coefficients.shape[1]] = coefficients / np.arange(1, coefficients.shape[1] + 1)
    seen = np.minimum(NEGLIGIBLE / np.log(np.abs(zeta) - 1e-16), count)
    order = np.argsort(-seen)
    reach = np.searchsorted(-seen[order], -np.arange(0, count, _TERMS))  # points that see the terms from there on
    powers = np.repeat(zeta[order, None], _TERMS, axis=1)
    np.multiply.accumulate(powers, axis=1, out=powers)
    row, factor, total = row[order], np.ones(zeta.size), np.zeros(zeta.size)
    for first, active in zip(range(0, count, _TERMS), reach, strict=True):
        part = np.einsum("nk,nk->n", powers[:active], terms[row[:active], first : first + _TERMS])
        total[:active] += factor[:active] * part
        factor[:active] *= powers[:active, -1]
    result = np.empty(zeta.size)
    result[order] = total
    return result


@dataclass(frozen=True, eq=False)
class GapMinima:
    """Local minima of the gap that come near zero.

    Attributes
    ----------
    position, depth : (n,) arrays
        Where, and the gap there (negative: interpenetration), dimensionless.
    gap : (n,) int array
        Index of the patch before the gap.
    """

    position: FloatArray
    depth: FloatArray
    gap: IntArray


def gap_field(elastic: Elastic, state: Evaluation) -> GapField:
    """The gap of a solved state as a function of position."""
    starts = np.concatenate([[0], np.cumsum(state.resolution.modes)[:-1]])
    return GapField(elastic, state, state.pressure(), state.skeleton_nodes(), starts)


def low_minima(field: GapField, threshold: float = SUSPICIOUS_GAP) -> GapMinima:
    """All local minima of the gap below a threshold, refined by a parabola.

    Parameters
    ----------
    field : GapField
    threshold : float
        In units of the rms height.
    """
    patches, profile = field.state.patches, field.elastic.profile
    waves = patches.gap_after * (profile.max_order / (2 * np.pi))
    fine = chebyshev.rounded_up(20 + POINTS_PER_WAVELENGTH * np.pi / 2 * waves, GRID_RATIO)
    classes = [(int(size), np.flatnonzero(fine == size)) for size in np.unique(fine)]
    coarse = [_in_gaps(patches, who, _samples(size)) for size, who in classes]
    owners = np.concatenate([np.repeat(who, x.shape[1]) for (_, who), x in zip(classes, coarse, strict=True)])
    samples = field.displacement(np.concatenate([x.ravel() for x in coarse]), owners)
    grids = [_in_gaps(patches, who, _grid(size)) for size, who in classes]
    heights = profile.height(np.concatenate([x.ravel() for x in grids]))
    places, gaps = [np.empty((3, 0))], [np.empty(0, dtype=np.int64)]
    sampled = _like(samples, coarse)
    for (size, who), part, height, x in zip(classes, sampled, _like(heights, grids), grids, strict=True):
        value = _on_grid(part, size) - (height - profile.max_height + field.state.penetration)
        before, here, after = value[:, :-2], value[:, 1:-1], value[:, 2:]
        sag = np.maximum(before + after - 2 * here, 0.0)
        row, column = np.nonzero((here - sag < threshold) & (here <= before) & (here < after))
        places.append(np.stack([x[row, column], x[row, column + 1], x[row, column + 2]]))
        gaps.append(who[row])
    x, gap = np.concatenate(places, axis=1), np.concatenate(gaps)
    if gap.size == 0:
        return GapMinima(np.empty(0), np.empty(0), gap)
    order = np.lexsort((x[1], gap))
    x, gap = x[:, order], gap[order]
    owner = np.tile(gap, 3)
    vertex, depth = _parabola_vertex(x, field(x.ravel(), owner).reshape(x.shape))
    reach = np.minimum(x[1] - x[0], x[2] - x[1])
    for _ in range(REFINEMENTS):
        reach = reach / REFINEMENT_RATIO
        x = np.stack([vertex - reach, vertex, vertex + reach])
        vertex, depth = _parabola_vertex(x, field(x.ravel(), owner).reshape(x.shape))
    return GapMinima(vertex, depth, gap)


def _grid(size: int) -> FloatArray:
    """Angles of a grid that resolves the profile."""
    return np.asarray((np.arange(size) + 0.5) * np.pi / size)


def _samples(size: int) -> FloatArray:
    """Angles at Chebyshev nodes of [0, pi] that resolve the displacement where a grid of this size does the profile."""
    waves = (size - 20) / (POINTS_PER_WAVELENGTH * np.pi / 2)
    return np.asarray(np.pi / 2 * (1 - chebyshev.basis_nodes(int(np.ceil(8 + 4 * np.sqrt(waves))))))


def _in_gaps(patches: Patches, who: IntArray, angle: FloatArray) -> FloatArray:
    """Points b + g (1 - cos theta)/2 of some gaps, (n_gaps, n_angles)."""
    return np.asarray(patches.right[who, None] + patches.gap_after[who, None] * (0.5 - 0.5 * np.cos(angle)))


def _like(values: FloatArray, arrays: list[FloatArray]) -> list[FloatArray]:
    """Values of the points of some arrays, joined, as arrays of their shapes."""
    ends = np.cumsum([array.size for array in arrays])[:-1]
    return [part.reshape(array.shape) for part, array in zip(np.split(values, ends), arrays, strict=True)]


def _on_grid(samples: FloatArray, size: int) -> FloatArray:
    """Chebyshev series in theta through samples of some gaps, (n_gaps, n), on the grid, (n_gaps, size)."""
    if samples.shape[1] * size <= LARGEST_MATRIX:
        return np.asarray(samples @ _interpolation(samples.shape[1], size))
    series = chebyshev.coefficients(samples)
    return np.asarray(np.polynomial.chebyshev.chebval(1 - 2 / np.pi * _grid(size), series.T))


@lru_cache(maxsize=256)
def _interpolation(nodes: int, size: int) -> FloatArray:
    """Matrix from samples to the grid, applied from the right, (nodes, size)."""
    values = np.polynomial.chebyshev.chebvander(1 - 2 / np.pi * _grid(size), nodes - 1)
    return np.asarray(chebyshev.coefficients(np.eye(nodes)) @ values.T)


def _parabola_vertex(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lowest point of the parabola through three points, (3, n) each; the middle one where it has no vertex."""
    left, right = x[0] - x[1], x[2] - x[1]
    rise_left, rise_right = y[0] - y[1], y[2] - y[1]
    curvature = (rise_right / right - rise_left / left) / (right - left)
    slope = rise_left / left - curvature * left
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = np.where(curvature > 0, -slope / (2 * curvature), 0.0)
    shift = np.clip(shift, left, right)
    depth = y[1] + shift * (slope + curvature * shift)
    return x[1] + shift, depth
