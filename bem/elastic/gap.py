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

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import groupby, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.compiled.kernels import mirrored
from bem.elastic.collocation import Elastic, Evaluation
from bem.elastic.logarithmic_potential import LogarithmicPotential
from bem.geometry import chebyshev
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches
from bem.geometry.profile import Profile

Points = tuple[IntArray, IntArray, FloatArray, FloatArray]  # gap, column in its grid, place in it, and u, (n,) each
Sampled = tuple[int, IntArray, FloatArray, FloatArray]  # size of the grid, gaps, u at the samples and at the edges

SUSPICIOUS_GAP = 1e-3  # of the rms height: interpolated minima below are evaluated again
POINTS_PER_WAVELENGTH = 10
WHOLE = 128  # points: larger grids are looked at in stretches
STRETCH, ENDS = 8, 4  # points of a stretch, and stretches at each end that are looked at in any case
FEW = 1000  # points up to which powers sum a Chebyshev series faster than Clenshaw's rule (measured)
REFINEMENTS, REFINEMENT_RATIO = 3, 5.0  # of a minimum: parabolas on ever shorter bases; the first is a tenth off
DOWNHILL = 10  # grid cells to a minimum that has moved
NEGLIGIBLE = -39.0  # logarithm of what a decaying power may lose
GRID_RATIO = 1.2  # steps of the list of grid sizes, so that equal ones are treated together
LARGEST_MATRIX = 1_000_000  # entries of an interpolation, 8 MB; longer series are summed by Clenshaw's rule
LEAST_TERMS, FEW_POWERS = 8, 4096  # of power series, summed at a time: terms, or terms times points


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
        patches = self.state.patches
        total += near_patches(patches.center, patches.half_width, self._skeletons, self._series, gap, x)
        return total / -np.pi

    @cached_property
    def _skeletons(self) -> tuple[FloatArray, FloatArray, IntArray]:
        """Skeleton charges of the patches and their places in (-1, 1), (L, p) each, filled up; how many, (L,)."""
        modes = self.state.resolution.modes
        filled = np.arange(int(modes.max())) < modes[:, None]
        charges, places = np.zeros((2, *filled.shape))
        charges[filled] = self.state.skeleton
        places[filled] = np.concatenate([chebyshev.basis_nodes(size) for size in modes.tolist()])
        return charges, places, modes

    @cached_property
    def _skeleton_potential(self) -> LogarithmicPotential:
        """Potential of the skeleton charges of all patches, (unknowns,)."""
        patches, (_, places, modes) = self.state.patches, self._skeletons
        positions = patches.center[:, None] + patches.half_width[:, None] * places
        positions = positions[np.arange(places.shape[1]) < modes[:, None]]
        return LogarithmicPotential(positions, self.state.skeleton)

    @cached_property
    def _series(self) -> tuple[FloatArray, IntArray, FloatArray]:
        """c_0 of the patches and number of their other c_n, (L,) each, and c_n / n, (L, n), filled up with zeros."""
        charges = self.state.charges()
        terms = charges[:, 1:] / np.arange(1, charges.shape[1])
        return np.ascontiguousarray(charges[:, 0]), self.state.resolution.nodes - 1, terms


@mirrored
def near_patches(
    center: FloatArray,
    half_width: FloatArray,
    skeletons: tuple[FloatArray, FloatArray, IntArray],
    series: tuple[FloatArray, IntArray, FloatArray],
    gap: IntArray,
    x: FloatArray,
) -> FloatArray:
    """Exact logarithmic part of the two patches beside a gap less that of their skeletons, (n,).

    Each x lies in the gap behind patch `gap`; skeletons and series of the patches are those of `GapField`.
    """
    following, points = (gap + 1) % center.size, x.size
    index, x = np.concatenate([gap, following]), np.concatenate([x, x - np.where(following <= gap, TWO_PI, 0.0)])
    (charges, places, _), (total, count, terms) = skeletons, series
    t = (x - center[index]) / half_width[index]
    outside = np.where(np.abs(t) < 1, np.copysign(1.0, t), t)  # rounding may put a point on the edge into the patch
    zeta = 1 / (outside + np.copysign(np.sqrt((outside - 1) * (outside + 1)), outside))
    exact = np.log(np.abs(2 * zeta)) * total[index] + _power_series(terms, count, index, zeta)
    distance = np.abs(t[:, None] - places[index])
    coarse = np.einsum("nk,nk->n", np.log(distance, out=distance), charges[index])
    beside = -np.pi * exact - coarse
    return np.asarray(beside[:points] + beside[points:])


def _power_series(terms: FloatArray, count: IntArray, column: IntArray, zeta: FloatArray) -> FloatArray:
    """sum_{n >= 1} terms_n zeta^n, for each zeta the first `count` terms of its column while its powers last, (n,)."""
    step = max(LEAST_TERMS, FEW_POWERS // max(1, zeta.size))
    parts = np.ceil(np.minimum(NEGLIGIBLE / np.log(np.abs(zeta) - 1e-16), count[column]) / step).astype(np.int64)
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
    gap, column, place, u = (np.concatenate(part) for part in zip(*_looked_at(field, sizes, threshold), strict=True))
    x = _in_gaps(patches, gap, place)
    value = u - profile.height(x) + field.clearance
    before, here, after = value[:-2], value[1:-1], value[2:]
    sag = np.maximum(before + after - 2 * here, 0.0)
    adjacent = (gap[2:] == gap[:-2]) & (column[2:] == column[:-2] + 2)
    lowest = np.flatnonzero(adjacent & (here - sag < threshold) & (here <= before) & (here < after)) + 1
    if lowest.size == 0:
        return GapMinima(np.empty(0), np.empty(0), lowest)
    _, first = np.unique(gap[lowest] * (np.max(sizes) + 1) + column[lowest], return_index=True)  # stretches overlap
    around = lowest[first] + np.array([[-1], [0], [1]])
    x, owner = x[around], gap[around].ravel()
    vertex, depth = _lowest(field, x, owner)
    return GapMinima(vertex, depth, gap[lowest[first]])


def minima_near(field: GapField, position: FloatArray, gap: IntArray) -> GapMinima:
    """Minima of the gap near given places in it, (n,) each: downhill on a wide base and a short one, then as above."""
    patches, owner = field.state.patches, np.tile(gap, 3)
    width = patches.gap_after[gap]
    reach = np.minimum(TWO_PI / (POINTS_PER_WAVELENGTH * field.elastic.profile.max_order), width / 4)
    first, last = patches.right[gap] + 1.01 * reach, patches.right[gap] + width - 1.01 * reach
    for base in (reach, reach / REFINEMENT_RATIO):
        for _ in range(DOWNHILL):
            position = np.clip(position, first, last)
            x = position + base * np.array([[-1.0], [0.0], [1.0]])
            vertex, _ = _parabola_vertex(x, field(x.ravel(), owner).reshape(x.shape))
            shift, position = np.max(np.abs(vertex - position) / base, initial=0.0), np.clip(vertex, first, last)
            if shift < 0.5:
                break
    vertex, depth = _lowest(field, position + base * np.array([[-1.0], [0.0], [1.0]]), owner)
    return GapMinima(vertex, depth, gap)


def _lowest(field: GapField, x: FloatArray, owner: IntArray) -> tuple[FloatArray, FloatArray]:
    """Places and depths of minima of the gap between the outer of three points each, (3, n), on ever shorter bases."""
    first, last = x[0], x[2]
    vertex, depth = _parabola_vertex(x, field(x.ravel(), owner).reshape(x.shape))
    reach = np.minimum(x[1] - x[0], x[2] - x[1])
    for _ in range(REFINEMENTS):
        reach = reach / REFINEMENT_RATIO
        middle = np.clip(vertex, first + reach, last - reach)
        x = np.stack([middle - reach, middle, middle + reach])
        vertex, depth = _parabola_vertex(x, field(x.ravel(), owner).reshape(x.shape))
    return vertex, depth


def _looked_at(field: GapField, sizes: IntArray, threshold: float) -> Iterator[Points]:
    """Points of grids of these sizes in all gaps; of large grids without stretches where the gap is not low."""
    gaps = np.argsort(sizes, kind="stable")
    ascending = sizes[gaps].tolist()
    sampled = [_sample_places(size) for size in ascending]
    owner = np.repeat(gaps, [place.size for place in sampled])
    samples = field.displacement(_in_gaps(field.state.patches, owner, np.concatenate(sampled)), owner)
    parts: list[FloatArray] = []
    wide: list[Sampled] = []
    first = start = 0
    for size, alike in groupby(ascending):
        last = first + len(list(alike))
        stop = start + (last - first) * sampled[first].size
        here = samples[start:stop].reshape(last - first, -1)
        u, count = _on_grid(here, size), _columns(size)[0].size
        parts.append(u[:, :count].ravel())
        if count < size:
            wide.append((size, gaps[first:last], here, u[:, count:]))
        first, start = last, stop
    columns, places = [_columns(size)[0] for size in ascending], [_places(size)[0] for size in ascending]
    owner = np.repeat(gaps, [column.size for column in columns])
    yield owner, np.concatenate(columns), np.concatenate(places), np.concatenate(parts)
    if wide:
        yield from _low_stretches(field, wide, threshold)


def _low_stretches(field: GapField, wide: list[Sampled], threshold: float) -> Iterator[Points]:
    """Points of the stretches of wide gaps in which bounds of u and of the profile leave room for a low gap."""
    patches = field.state.patches
    edges = [at_edges.shape[1] for _, gaps, _, at_edges in wide for _ in gaps]
    gap = np.repeat(np.concatenate([gaps for _, gaps, _, _ in wide]), edges)
    place = np.concatenate([_places(size)[1] for size, gaps, _, _ in wide for _ in gaps])
    u = np.concatenate([at_edges.ravel() for _, _, _, at_edges in wide])
    x = (patches.right - np.floor(patches.right / TWO_PI) * TWO_PI)[gap] + patches.gap_after[gap] * place
    room = lower_bounds(gap, x, u, _highest(field.elastic.profile))
    low = np.flatnonzero(room < threshold - field.clearance)
    ends = np.cumsum([at_edges.size for _, _, _, at_edges in wide])
    parts = pairwise([0, *np.searchsorted(low, ends).tolist()])
    for (size, gaps, samples, at_edges), end, (first, last) in zip(wide, ends.tolist(), parts, strict=True):
        if first < last:
            row, stretch = np.divmod(low[first:last] - (end - at_edges.size), at_edges.shape[1])
            column = _columns(size)[1][stretch, None] + np.arange(-1, STRETCH + 2)
            between = chebyshev_sums(chebyshev.coefficients(samples)[row], _node(column, size))
            owner = np.repeat(gaps[row], column.shape[1])
            yield owner, column.ravel(), _place((column.ravel() + 0.5) / size), between.ravel()


@mirrored
def lower_bounds(gap: IntArray, x: FloatArray, u: FloatArray, highest: FloatArray) -> FloatArray:
    """Lower bounds of u less the profile between a point and the next in its gap, inf behind the last one, (n,).

    Points x in two periods, ascending in each gap; between its values u bends by its second differences at most;
    upper bounds of the profile are those of `_highest`.
    """
    same = gap[1:] == gap[:-1]
    bend = np.zeros(u.size)
    bend[1:-1] = np.where(same[1:] & same[:-1], np.abs(np.diff(u, 2)), 0.0)
    least = np.minimum(u[1:], u[:-1]) - bend[1:] - bend[:-1]
    index = (x * (highest.size / (2 * TWO_PI))).astype(np.int64)
    most = np.maximum(np.maximum.reduceat(highest, index)[:-1], highest[index[1:]])
    return np.append(np.where(same, least - most, np.inf), np.inf)


@mirrored
def chebyshev_sums(series: FloatArray, node: FloatArray) -> FloatArray:
    """sum_k series_sk T_k(node_sc), (n_series, n_nodes)."""
    if node.size > FEW:
        return np.asarray(np.polynomial.chebyshev.chebval(node.T, series.T, tensor=False).T)
    waves = _powers(np.exp(1j * np.arccos(node.ravel())), series.shape[1] - 1).real.reshape(-1, *node.shape)
    return np.asarray(series[:, :1] + np.einsum("ksc,sk->sc", waves, series[:, 1:]))


@lru_cache(maxsize=8)
def _highest(profile: Profile) -> FloatArray:
    """Upper bounds of the profile between neighbouring points of its grid, for two periods.

    Curvature is 1/cos(pi/16) of its largest value on 16 points per wavelength at most (M. Riesz, Jahresbericht DMV 23
    (1914) 354).
    """
    x, height = profile.grid
    curvature = np.max(np.abs(profile.curvature(x))) / np.cos(np.pi / 16)
    return np.tile(np.maximum(height, np.roll(height, -1)) + curvature * x[1] ** 2 / 8, 2)


@lru_cache(maxsize=256)
def _columns(size: int) -> tuple[IntArray, IntArray]:
    """Points of a grid that are looked at in any case, and the edges of stretches that may be."""
    if size <= WHOLE:
        return np.arange(size), np.arange(0)
    edges = np.arange(STRETCH * ENDS, size - STRETCH * ENDS, STRETCH)
    return np.concatenate([np.arange(edges[0] + 2), np.arange(edges[-1] - 1, size)]), edges


@lru_cache(maxsize=256)
def _places(size: int) -> tuple[FloatArray, FloatArray]:
    """Places of these points and edges in the gap, in (0, 1)."""
    columns, edges = _columns(size)
    return _place((columns + 0.5) / size), _place((edges + 0.5) / size)


@lru_cache(maxsize=256)
def _sample_places(size: int) -> FloatArray:
    """Chebyshev nodes in theta that resolve the displacement where a grid of this size does the profile."""
    waves = (size - 20) / (POINTS_PER_WAVELENGTH * np.pi / 2)
    return _place((1 - chebyshev.basis_nodes(int(np.ceil(8 + 4 * np.sqrt(waves))))) / 2)


def _place(angle: FloatArray) -> FloatArray:
    """(1 - cos theta)/2 from theta/pi."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * angle))


def _node(column: IntArray, size: int) -> FloatArray:
    """1 - 2 theta/pi of points of a grid."""
    return 1 - (2 * column + 1) / size


def _in_gaps(patches: Patches, gap: IntArray, place: FloatArray) -> FloatArray:
    """Points at places in (0, 1), each in its gap, (n,)."""
    return np.asarray(patches.right[gap] + patches.gap_after[gap] * place)


def _on_grid(samples: FloatArray, size: int) -> FloatArray:
    """Chebyshev series in theta through samples of some gaps, (n_gaps, n), at columns and edges, (n_gaps, m)."""
    if samples.shape[1] * (WHOLE + size / STRETCH) <= LARGEST_MATRIX:
        return np.asarray(samples @ _interpolation(samples.shape[1], size))
    nodes = _node(np.concatenate(_columns(size)), size)
    return chebyshev_sums(chebyshev.coefficients(samples), np.tile(nodes, (len(samples), 1)))


@lru_cache(maxsize=256)
def _interpolation(count: int, size: int) -> FloatArray:
    """Matrix from samples to columns and edges of a grid, applied from the right, (count, m)."""
    values = np.polynomial.chebyshev.chebvander(_node(np.concatenate(_columns(size)), size), count - 1)
    return np.asarray(chebyshev.coefficients(np.eye(count)) @ values.T)


def _parabola_vertex(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lowest point of the parabola through three points, (3, n) each; the middle one where it has no vertex."""
    left, right = x[0] - x[1], x[2] - x[1]
    rise_left, rise_right = y[0] - y[1], y[2] - y[1]
    curvature = (rise_right / right - rise_left / left) / (right - left)
    slope = rise_left / left - curvature * left
    shift = np.divide(-slope, 2 * curvature, out=np.zeros_like(slope), where=curvature > 0)
    shift = np.minimum(np.maximum(shift, left), right)
    depth = y[1] + shift * (slope + curvature * shift)
    return x[1] + shift, depth
