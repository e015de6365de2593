"""Gap outside contact: where the surfaces interpenetrate, and by how much.

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

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from bem.elastic.collocation import Elastic, Evaluation
from bem.elastic.logarithmic_potential import LogarithmicPotential
from bem.geometry import chebyshev
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.minima import OFFSETS, RATIO, refined, vertices
from bem.geometry.patches import TWO_PI
from bem.geometry.profile import Profile
from bem.kernels import gaps

SUSPICIOUS_GAP = 1e-3  # speed: of the rms height: interpolated minima below are evaluated; half and twice it: same
GRID_POINTS_PER_WAVE = 10
DOWNHILL = 10  # limit: grid cells to a minimum that has moved
GRID_RATIO = 1.2  # speed: steps of the list of grid sizes, so that equal ones are treated together
NOT_SEARCHED, WIDE_OPEN = (32, 10), 1e3  # format: points and samples of a gap that is not searched, and u there


@dataclass(frozen=True, eq=False)
class GapField:
    """Gap at points outside contact of a solved state, whose edges need not be in equilibrium."""

    elastic: Elastic
    state: Evaluation

    def __call__(self, x: FloatArray, gap: IntArray) -> FloatArray:
        """Return the gap u - (h - h_max + Delta) at points x, each in the gap behind patch `gap`, (n,)."""
        return self.displacement(x, gap) - self.elastic.profile.height(x) + self.clearance

    @property
    def clearance(self) -> float:
        """Gap where u = h, h_max - Delta."""
        return self.elastic.profile.max_height - self.state.penetration

    def displacement(self, x: FloatArray, gap: IntArray) -> FloatArray:
        """Return the mean-free interface displacement at points x, each in the gap behind patch `gap`, (n,)."""
        total = self._skeleton_potential(x)
        if self.elastic.kernel is not None:
            total += self.elastic.kernel.field(x, self._skeleton_potential.position, self.state.skeleton)
        for background in self.elastic.backgrounds:
            total += background(x)
        if self.elastic.far is not None:
            total += self.elastic.far.at(x, self.state.penetration)[0]
        patches, resolution = self.state.patches, self.state.resolution
        beside = gaps.near_patches(
            patches.center, patches.half_width, resolution.nodes, resolution.modes, *self._beside, gap, x
        )
        return (total + beside) / -np.pi

    @cached_property
    def _beside(self) -> tuple[FloatArray, IntArray, FloatArray, FloatArray]:
        """Tables of the coupled modes, start of the table of each patch, charges Q_n, and nodal charges."""
        tables, at = chebyshev.packed_bases(self.state.resolution.modes)
        return tables, at, self.state.charges(), self.state.skeleton

    @cached_property
    def _skeleton_potential(self) -> LogarithmicPotential:
        """Potential of the skeleton charges of all patches, (unknowns,)."""
        return LogarithmicPotential(self.state.skeleton_nodes(), self.state.skeleton)


@dataclass(frozen=True, eq=False)
class GapMinima:
    """Local minima of the gap that come near zero.

    Attributes
    ----------
    position, depth : (n,) arrays
        Position and value of each minimum (negative: interpenetration), dimensionless.
    gap : (n,) int array
        Index of the patch before the gap.
    """

    position: FloatArray
    depth: FloatArray
    gap: IntArray


def gap_field(elastic: Elastic, state: Evaluation) -> GapField:
    """Return the gap of a solved state as a function of position."""
    return GapField(elastic, state)


def low_minima(field: GapField, threshold: float = SUSPICIOUS_GAP) -> GapMinima:
    """Return all local minima of the gap below a threshold, refined by a parabola.

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
    sizes = chebyshev.rounded_up(20 + GRID_POINTS_PER_WAVE * np.pi / 2 * waves, GRID_RATIO)
    counts = np.ceil(8 + 4 * np.sqrt((sizes - 20) / (GRID_POINTS_PER_WAVE * np.pi / 2))).astype(np.int64)
    outer = -1  # the gap in which the outside of a window lies: others look there
    if field.elastic.far is not None:
        outer = field.elastic.far.arc.outer_gap(patches)
        sizes[outer], counts[outer] = NOT_SEARCHED
    node = np.concatenate([chebyshev.basis_nodes(count) for count in counts.tolist()])
    gap = np.repeat(np.arange(patches.count), counts)
    samples, inner = np.full(gap.size, WIDE_OPEN), gap != outer
    samples[inner] = field.displacement((patches.right[gap] + patches.gap_after[gap] * _place(node))[inner], gap[inner])
    level = threshold - field.clearance
    points = gaps.low_points(
        patches.right, patches.gap_after, sizes, counts, samples, profile.table, _highest(profile), level
    )
    gap, x = points[:, 0].astype(np.int64), points[:, 1:].T
    lowest = refined(_in_gaps(field, gap), x)
    return GapMinima(lowest.position, lowest.value, gap)


def minima_near(field: GapField, position: FloatArray, gap: IntArray) -> GapMinima:
    """Return the minima of the gap near given positions in the gaps, (n,) each.

    Descent on a wide base, then on a short one, then refinement (minima.py).
    """
    patches, function = field.state.patches, _in_gaps(field, gap)
    width = patches.gap_after[gap]
    reach = np.minimum(TWO_PI / (GRID_POINTS_PER_WAVE * field.elastic.profile.max_order), width / 4)
    first, last = patches.right[gap] + 1.01 * reach, patches.right[gap] + width - 1.01 * reach
    for base in (reach, reach / RATIO):
        for _ in range(DOWNHILL):
            middle = np.minimum(np.maximum(position, first), last)
            x = middle + base * OFFSETS
            y = function(x)
            position = vertices(x, y).position
            if np.all(np.abs(position - middle) < 0.5 * base):
                break
    lowest = refined(function, x, y)
    return GapMinima(lowest.position, lowest.value, gap)


def _in_gaps(field: GapField, gap: IntArray) -> Callable[[FloatArray], FloatArray]:
    """Return the gap as a function of three points in each of some gaps, (3, n)."""
    owner = np.tile(gap, 3)
    return lambda x: field(x.ravel(), owner).reshape(x.shape)


@lru_cache(maxsize=8)
def _highest(profile: Profile) -> FloatArray:
    """Return upper bounds of the profile between neighbouring points of its grid, (n_grid,).

    Curvature is 1/cos(pi/16) of its largest value on 16 points per wavelength at most (M. Riesz, Jahresbericht DMV 23
    (1914) 354).
    """
    x, height = profile.grid
    curvature = np.max(np.abs(profile.curvature(x))) / np.cos(np.pi / 16)
    return np.asarray(np.maximum(height, np.roll(height, -1)) + curvature * x[1] ** 2 / 8)


def _place(node: FloatArray) -> FloatArray:
    """Return (1 - cos theta)/2 from 1 - 2 theta/pi."""
    return np.asarray(0.5 - 0.5 * np.sin(np.pi / 2 * node))
