"""The gap outside contact: where the surfaces interpenetrate, and by how much.

The displacement u(x) = -(1/pi) int log|2 sin((x - x')/2)| sigma dx' in a gap is sampled at points that cluster at
the edges, x = b + g (1 - cos theta)/2, where it is a smooth function of theta, and interpolated to a grid that
resolves the profile, far from the edges of a wide gap only where bounds of u and of the profile leave room for a low
gap; minima that come near zero are evaluated again at their own place and refined by a parabola.  The two patches
beside a gap contribute through the outer form of the logarithmic moments,

    int log|t - t'| T_n / sqrt(1 - t'^2) dt' = -(pi/n) zeta^n (n >= 1),  -pi log|2 zeta| (n = 0),
    zeta = t - sgn(t) sqrt(t^2 - 1),

all others through their skeleton charges (logarithmic_potential.py).  Dimensionless; the skeleton limits the accuracy
to that of the state.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.compiled.kernels import mirrored
from bem.elastic.collocation import Elastic, Evaluation, Resolution
from bem.elastic.logarithmic_potential import LogarithmicPotential
from bem.geometry import chebyshev
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches
from bem.geometry.profile import Profile

SUSPICIOUS_GAP = 1e-3  # of the rms height: interpolated minima below are evaluated again
POINTS_PER_WAVELENGTH = 10
# Of the grids, as in compiled/gap.c: larger ones are looked at in stretches, at the ends in any case; a stretch is the
# longer the larger the grid, one for every so many points.
WHOLE = 128  # speed: points: larger grids are looked at in stretches
STRETCH, ENDS, LONGER = 8, 32, 512  # speed: points of a stretch; at each end that are always looked at; for each length
REFINEMENTS, REFINEMENT_RATIO = 3, 5.0  # of a minimum: parabolas on ever shorter bases; the first is a tenth off
DOWNHILL = 10  # limit: grid cells to a minimum that has moved
BESIDE = np.array([[-1.0], [0.0], [1.0]])  # of three points
NEGLIGIBLE = -39.0  # derived: logarithm of what a decaying power may lose
GRID_RATIO = 1.2  # speed: steps of the list of grid sizes, so that equal ones are treated together
NOT_SEARCHED, WIDE_OPEN = (32, 10), 1e3  # format: points and samples of a gap that is not searched, and u there
LEAST_TERMS, FEW_POWERS = 8, 4096  # speed: of power series, summed at a time: terms, or terms times points


@dataclass(frozen=True, eq=False)
class GapField:
    """Gap at points outside contact of a solved state, whose edges need not be in equilibrium."""

    elastic: Elastic
    state: Evaluation

    def __call__(self, x: FloatArray, gap: IntArray) -> FloatArray:
        """Gap u - (h - h_max + Delta) at points x, each lying in the gap behind patch `gap`, (n,)."""
        return self.displacement(x, gap) - self.elastic.profile.height(x) + self.clearance

    @property
    def clearance(self) -> float:
        """What the gap is where u = h."""
        return self.elastic.profile.max_height - self.state.penetration

    def displacement(self, x: FloatArray, gap: IntArray) -> FloatArray:
        """Mean-free interface displacement at points x, each lying in the gap behind patch `gap`, (n,)."""
        total = self._skeleton_potential(x)
        if self.elastic.kernel is not None:
            total += self.elastic.kernel.field(x, self._skeleton_potential.position, self.state.skeleton)
        for background in self.elastic.backgrounds:
            total += background(x)
        if self.elastic.far is not None:
            total += self.elastic.far.at(x, self.state.penetration)[0]
        return (total + near_patches(self.state.patches, *self._charges, gap, x)) / -np.pi

    @cached_property
    def _charges(self) -> tuple[Resolution, FloatArray, FloatArray]:
        """What `near_patches` is given of the state."""
        state = self.state
        return state.resolution, state.charges(), state.skeleton

    @cached_property
    def _skeleton_potential(self) -> LogarithmicPotential:
        """Potential of the skeleton charges of all patches, (unknowns,)."""
        return LogarithmicPotential(self.state.skeleton_nodes(), self.state.skeleton)


@mirrored
def near_patches(
    patches: Patches,
    resolution: Resolution,
    charges: FloatArray,
    skeleton: FloatArray,
    gap: IntArray,
    x: FloatArray,
) -> FloatArray:
    """Exact logarithmic part of the two patches beside a gap less that of their skeletons, (n,).

    Parameters
    ----------
    patches : Patches
    resolution : Resolution
        How many coupled modes and Q_n each has.
    charges : (L, max N_i) array
        Q_n of the patches, filled up with zeros.
    skeleton : (unknowns,) array
        Nodal charges of the coupled modes.
    gap, x : (n,) arrays
        Points, each in the gap behind patch `gap`.
    """
    following, points = (gap + 1) % patches.count, x.size
    index, x = np.concatenate([gap, following]), np.concatenate([x, x - np.where(following <= gap, TWO_PI, 0.0)])
    t = (x - patches.center[index]) / patches.half_width[index]
    outside = np.where(np.abs(t) < 1, np.copysign(1.0, t), t)  # rounding may put a point on the edge into the patch
    zeta = 1 / (outside + np.copysign(np.sqrt((outside - 1) * (outside + 1)), outside))
    terms = charges[:, 1:] / np.arange(1, charges.shape[1])
    exact = np.log(np.abs(2 * zeta)) * charges[index, 0] + _power_series(terms, resolution.nodes - 1, index, zeta)
    modes = resolution.modes
    size, start = modes[index], (np.cumsum(modes) - modes)[index]
    first = np.cumsum(size) - size
    which = np.arange(size.sum()) + np.repeat(start - first, size)
    distance = np.abs(np.repeat(t, size) - chebyshev.nodes_of(modes)[which])
    coarse = np.add.reduceat(np.log(distance) * skeleton[which], first)
    beside = -np.pi * exact - coarse
    return np.asarray(beside[:points] + beside[points:])


def _power_series(terms: FloatArray, count: IntArray, column: IntArray, zeta: FloatArray) -> FloatArray:
    """sum_{n >= 1} terms_n zeta^n, for each zeta the first `count` terms of its column while its powers last, (n,)."""
    step = max(LEAST_TERMS, FEW_POWERS // max(1, zeta.size))
    parts = np.ceil(np.minimum(NEGLIGIBLE / np.minimum(np.log(np.abs(zeta)), -1e-16), count[column]) / step).astype(
        np.int64
    )
    order = np.argsort(-parts, kind="stable")
    reach = parts.size - np.cumsum(np.bincount(parts))[:-1]  # points that see more than 0, 1, ... parts of the terms
    column, powers = column[order], _powers(zeta[order], min(step, terms.shape[1]))
    factor, total = np.ones(zeta.size), np.zeros(zeta.size)
    for part, active in enumerate(reach.tolist()):
        here = terms[:, part * step : (part + 1) * step][column[:active]]
        total[:active] += factor[:active] * np.einsum("kn,nk->n", powers[: here.shape[1], :active], here)
        factor[:active] *= powers[-1, :active]
    result = np.empty(zeta.size)
    result[order] = total
    return result


def _powers(base: NDArray[Any], count: int) -> NDArray[Any]:
    """base^1 ... base^count, (count, n), by doubling."""
    powers = np.empty((count, base.size), dtype=base.dtype)
    powers[:1] = base
    done = 1
    while done < count:
        more = min(done, count - done)
        np.multiply(powers[:more], powers[done - 1], out=powers[done : done + more])
        done += more
    return powers


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
    return GapField(elastic, state)


def low_minima(field: GapField, threshold: float = SUSPICIOUS_GAP) -> GapMinima:
    """All local minima of the gap below a threshold, refined by a parabola.

    Parameters
    ----------
    field : GapField
    threshold : float
        In units of the rms height.

    Returns
    -------
    GapMinima
        In the order of the gaps and of the positions in them; empty when the gap is nowhere so low.
    """
    patches, profile = field.state.patches, field.elastic.profile
    waves = patches.gap_after * (profile.max_order / TWO_PI)
    sizes = chebyshev.rounded_up(20 + POINTS_PER_WAVELENGTH * np.pi / 2 * waves, GRID_RATIO)
    counts = np.ceil(8 + 4 * np.sqrt((sizes - 20) / (POINTS_PER_WAVELENGTH * np.pi / 2))).astype(np.int64)
    outer = -1  # the gap in which the outside of a window lies: others look there
    if field.elastic.far is not None:
        outer = field.elastic.far.arc.outer_gap(patches)
        sizes[outer], counts[outer] = NOT_SEARCHED
    node = np.concatenate([chebyshev.basis_nodes(count) for count in counts.tolist()])
    gap = np.repeat(np.arange(patches.count), counts)
    samples, inner = np.full(gap.size, WIDE_OPEN), gap != outer
    samples[inner] = field.displacement((patches.right[gap] + patches.gap_after[gap] * _place(node))[inner], gap[inner])
    found = low_points(patches, profile, (sizes, counts), samples, _highest(profile), threshold - field.clearance)
    gap, x = found[:, 0].astype(np.int64), found[:, 1:].T
    vertex, depth = _lowest(field, x, field(x.ravel(), np.tile(gap, 3)).reshape(x.shape), gap)
    return GapMinima(vertex, depth, gap)


def minima_near(field: GapField, position: FloatArray, gap: IntArray) -> GapMinima:
    """Minima of the gap near given places in it, (n,) each: downhill on a wide base and a short one, then as above."""
    patches, owner = field.state.patches, np.tile(gap, 3)
    width = patches.gap_after[gap]
    reach = np.minimum(TWO_PI / (POINTS_PER_WAVELENGTH * field.elastic.profile.max_order), width / 4)
    first, last = patches.right[gap] + 1.01 * reach, patches.right[gap] + width - 1.01 * reach
    for base in (reach, reach / REFINEMENT_RATIO):
        for _ in range(DOWNHILL):
            middle = np.minimum(np.maximum(position, first), last)
            x = middle + base * BESIDE
            y = field(x.ravel(), owner).reshape(x.shape)
            position, _ = _parabola_vertex(x, y)
            if np.all(np.abs(position - middle) < 0.5 * base):
                break
    vertex, depth = _lowest(field, x, y, gap)
    return GapMinima(vertex, depth, gap)


def _lowest(field: GapField, x: FloatArray, y: FloatArray, gap: IntArray) -> tuple[FloatArray, FloatArray]:
    """Places and depths of minima of the gap between the outer of three points each, (3, n), on ever shorter bases."""
    first, last, owner = x[0], x[2], np.tile(gap, 3)
    reach = np.minimum(x[1] - x[0], x[2] - x[1])
    vertex, depth = _parabola_vertex(x, y)
    for _ in range(REFINEMENTS if gap.size else 0):
        reach = reach / REFINEMENT_RATIO
        x = np.minimum(np.maximum(vertex, first + reach), last - reach) + reach * BESIDE
        vertex, depth = _parabola_vertex(x, field(x.ravel(), owner).reshape(x.shape))
    return vertex, depth


@mirrored
def low_points(
    patches: Patches,
    profile: Profile,
    grids: tuple[IntArray, IntArray],
    samples: FloatArray,
    highest: FloatArray,
    level: float,
) -> FloatArray:
    """Points of grids in the gaps where u less the profile is lower than beside, and may come below a level between.

    Parameters
    ----------
    patches, profile
    grids : ((L,) int array, (L,) int array)
        Points of the grid in each gap, and samples of u there.
    samples : (sum of counts,) array
        u at Chebyshev nodes in theta of one gap after the other.
    highest : (n,) array
        Upper bounds of the profile, `_highest`.
    level : float

    Returns
    -------
    (n, 4) array
        Gap, and the points before, there and behind.
    """
    sizes, counts = grids
    parts = []
    for k, (size, u) in enumerate(zip(sizes.tolist(), np.split(samples, np.cumsum(counts)[:-1]), strict=True)):
        grid = _Grid(patches.right[k], patches.gap_after[k], size, chebyshev.coefficients(u))
        column = _looked_at(grid, highest, level)
        parts.append((np.full(column.size, k), column, *grid(column)))
    gap, column, x, u = (np.concatenate(part) for part in zip(*parts, strict=True))
    value = u - profile.height(x)
    before, here, after = value[:-2], value[1:-1], value[2:]
    adjacent = (gap[2:] == gap[:-2]) & (column[2:] == column[:-2] + 2)
    sag = before + after - 2 * here
    first = np.flatnonzero(adjacent & (here <= before) & (here < after) & (here - sag < level))
    return np.stack([gap[first], x[first], x[first + 1], x[first + 2]], axis=1)


@dataclass(frozen=True, eq=False)
class _Grid:
    """Points x of one gap at equal steps in theta, and the Chebyshev series of u in 1 - 2 theta/pi."""

    right: float
    width: float
    size: int
    series: FloatArray

    def __call__(self, column: IntArray) -> tuple[FloatArray, FloatArray]:
        """Points and u there, (n,) each."""
        node = 1 - (2 * column + 1) / self.size
        u = self.series @ np.cos(np.outer(np.arange(self.series.size), np.arccos(node)))
        return self.right + self.width * _place(node), u


def _looked_at(grid: _Grid, highest: FloatArray, level: float) -> IntArray:
    """Points that are looked at: of a large grid the ends, and stretches where bounds leave room below a level, (n,).

    Bounds of long stretches say where those of the short ones in them are needed.
    """
    if grid.size <= WHOLE:
        return np.arange(grid.size)
    step = STRETCH * max(1, grid.size // LONGER)
    edge = np.arange(ENDS, grid.size - ENDS, step)
    x, u = grid(edge)
    bend = np.zeros(edge.size)
    bend[1:-1] = np.abs(np.diff(u, 2))
    long = edge[:-1][_has_room(x, u, bend, highest, level)]
    inner = long[:, None] + np.arange(-STRETCH, step + STRETCH + 1, STRETCH)
    x, u = (values.reshape(inner.shape) for values in grid(inner.ravel()))
    bend = np.abs(np.diff(u, 2, axis=1))
    looked_at = np.zeros(grid.size, dtype=bool)
    looked_at[: edge[0] + 2] = looked_at[edge[-1] - 1 :] = True
    for row in range(long.size):
        room = _has_room(x[row, 1:-1], u[row, 1:-1], bend[row], highest, level)
        looked_at[inner[row, 1:-2][room, None] + np.arange(-1, STRETCH + 2)] = True
    return np.flatnonzero(looked_at)


def _has_room(x: FloatArray, u: FloatArray, bend: FloatArray, highest: FloatArray, level: float) -> NDArray[np.bool_]:
    """Stretches in which u less the profile may come below a level, (n - 1,), from places, u and its bends there, (n,).

    Between the ends of a stretch u bends by its second differences at most.
    """
    index = np.floor(x * (highest.size / TWO_PI)).astype(np.int64)
    covered = highest.take(np.arange(index[0], index[-1] + 1), mode="wrap")
    index -= index[0]
    most = np.maximum(np.maximum.reduceat(covered, index)[:-1], covered[index[1:]])
    return np.asarray(np.minimum(u[1:], u[:-1]) - bend[1:] - bend[:-1] - most < level)


@lru_cache(maxsize=8)
def _highest(profile: Profile) -> FloatArray:
    """Upper bounds of the profile between neighbouring points of its grid, (n_grid,).

    Curvature is 1/cos(pi/16) of its largest value on 16 points per wavelength at most (M. Riesz, Jahresbericht DMV 23
    (1914) 354).
    """
    x, height = profile.grid
    curvature = np.max(np.abs(profile.curvature(x))) / np.cos(np.pi / 16)
    return np.asarray(np.maximum(height, np.roll(height, -1)) + curvature * x[1] ** 2 / 8)


def _place(node: FloatArray) -> FloatArray:
    """(1 - cos theta)/2 from 1 - 2 theta/pi."""
    return np.asarray(0.5 - 0.5 * np.sin(np.pi / 2 * node))


def _parabola_vertex(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lowest point of the parabola through three points, (3, n) each; the middle one where it has no vertex."""
    (left, _, right), (rise_left, _, rise_right) = x - x[1], y - y[1]
    slope_left, slope_right = rise_left / left, rise_right / right
    curvature = (slope_right - slope_left) / (right - left)
    slope = slope_left - curvature * left
    shift = np.divide(-slope, 2 * curvature, out=np.zeros(slope.size), where=curvature > 0)
    shift = np.minimum(np.maximum(shift, left), right)
    return x[1] + shift, y[1] + shift * (slope + curvature * shift)
