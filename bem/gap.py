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
        points, sources = np.exp(1j * x), np.exp(1j * self.nodes)
        total = np.zeros(x.size)
        block = max(1, 2_000_000 // self.nodes.size)
        for first in range(0, x.size, block):
            part = slice(first, first + block)
            distance = points[part, None] - sources
            squared = distance.real**2 + distance.imag**2
            total[part] = np.log(squared) @ (0.5 * self.state.skeleton)
        for correction in self.elastic.corrections:
            total += correction.field(x, self.nodes, self.state.skeleton)
        for index in np.unique(gap):
            here = np.flatnonzero(gap == index)
            following = (index + 1) % self.state.patches.count
            wrap = 2 * np.pi if following <= index else 0.0
            total[here] += self._near_patch(int(index), x[here])
            total[here] += self._near_patch(int(following), x[here] - wrap)
        return np.asarray(-total / np.pi)

    def _near_patch(self, index: int, x: FloatArray) -> FloatArray:
        """Exact logarithmic part of one patch less that of its skeleton, for x beside it."""
        patches = self.state.patches
        t = (x - patches.center[index]) / patches.half_width[index]
        zeta = t - np.copysign(np.sqrt(np.maximum(t * t - 1, 0.0)), t)
        charge = self.pressure.charges[index]
        seen = min(charge.size - 1, int(np.ceil(NEGLIGIBLE / np.log(np.abs(zeta).max() - 1e-16))))
        powers = np.repeat(zeta[:, None], seen, axis=1)
        np.multiply.accumulate(powers, axis=1, out=powers)
        series = powers @ (charge[1 : seen + 1] / np.arange(1, seen + 1))
        exact = -np.pi * (np.log(np.abs(2 * zeta)) * charge[0] + series)
        modes = int(self.state.resolution.modes[index])
        start = int(self.starts[index])
        sources = (self.nodes[start : start + modes] - patches.center[index]) / patches.half_width[index]
        coarse = np.log(np.abs(t[:, None] - sources)) @ self.state.skeleton[start : start + modes]
        return np.asarray(exact - coarse)


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
    patches = field.state.patches
    waves = patches.gap_after * (field.elastic.profile.max_order / (2 * np.pi))
    coarse = np.ceil(8 + 4 * np.sqrt(waves)).astype(np.int64)
    fine = np.ceil(20 + POINTS_PER_WAVELENGTH * np.pi / 2 * waves).astype(np.int64)
    sample_gap = np.repeat(np.arange(patches.count), coarse)
    sample_angles = [np.pi / 2 * (1 - chebyshev.basis_nodes(int(n))) for n in coarse]
    samples = field.displacement(_in_gaps(patches, sample_angles), sample_gap)
    angles = [(np.arange(n) + 0.5) * np.pi / n for n in fine]
    position = _in_gaps(patches, angles)
    gap = np.repeat(np.arange(patches.count), fine)
    parts = zip(np.split(samples, np.cumsum(coarse)[:-1]), angles, strict=True)
    displacement = np.concatenate([_at_angles(part, angle) for part, angle in parts])
    profile = field.elastic.profile
    value = displacement - (profile.height(position) - profile.max_height + field.state.penetration)
    before = np.concatenate([[np.inf], value[:-1]])
    after = np.concatenate([value[1:], [np.inf]])
    before[np.flatnonzero(np.diff(gap, prepend=-1))] = np.inf
    after[np.flatnonzero(np.diff(gap, append=-1))] = np.inf
    with np.errstate(invalid="ignore"):
        sag = np.maximum(before + after - 2 * value, 0.0)
    lowest = np.flatnonzero((value - sag < threshold) & (value <= before) & (value < after))
    inner = lowest[np.isfinite(before[lowest]) & np.isfinite(after[lowest])]
    if inner.size == 0:
        return GapMinima(np.empty(0), np.empty(0), np.empty(0, dtype=np.int64))
    triple = np.stack([inner - 1, inner, inner + 1])
    exact = field(position[triple].ravel(), gap[triple].ravel()).reshape(triple.shape)
    x, owner = position[triple], gap[triple]
    vertex, depth = _parabola_vertex(x, exact)
    reach = np.minimum(x[1] - x[0], x[2] - x[1])
    for _ in range(REFINEMENTS):
        reach = reach / REFINEMENT_RATIO
        x = np.stack([vertex - reach, vertex, vertex + reach])
        vertex, depth = _parabola_vertex(x, field(x.ravel(), owner.ravel()).reshape(x.shape))
    return GapMinima(vertex, depth, gap[inner])


def _in_gaps(patches: Patches, angles: list[FloatArray]) -> FloatArray:
    """Points b + g (1 - cos theta)/2 of every gap, joined."""
    return np.concatenate(
        [
            edge + width * (0.5 - 0.5 * np.cos(angle))
            for edge, width, angle in zip(patches.right, patches.gap_after, angles, strict=True)
        ]
    )


def _at_angles(samples: FloatArray, angle: FloatArray) -> FloatArray:
    """Chebyshev series in theta through samples at the nodes of [0, pi], at other angles."""
    return np.asarray(np.polynomial.chebyshev.chebval(1 - 2 * angle / np.pi, chebyshev.coefficients(samples)))


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
