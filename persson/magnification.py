"""Nodes in slope variance on which the adhesive theory is marched, and the wavenumbers of the spectrum at them.

Both routes of the diffusion need, at nodes S_0 = 0 < S_1 < .. < S_n, the wavenumber q just before and just after each
node, q inside each cell, and the cumulative weight W = int dS / q of the elastic energy.

Lines: q jumps at the edge of a line (narrow-band rule), and the barrier a with it, by J = a dq / 2q; J counts when it
is not small beside sqrt(T), T = dS / 4 the stress variance of the line.  Lines that differ by more than 1 / SHARPNESS
in wavenumber, and lines with J > JUMP_SHARE sqrt(T) for the largest a possible, are resolved: cut into substeps that
crowd behind the jump.  All others are taken together: nodes sit on edges of lines and q is interpolated between
the middles of the lines; what a staircase does beyond its mean is, to second order, a barrier moved inward by

    zeta(3/2) / sqrt(2 pi^3) J^2 / sqrt(T) = 0.33174 J^2 / sqrt(T)

(sawtooth of period T in dP/dV = 1/2 P'': with Fourier coefficients f_n the shift is 2 sum |f_n|^2 sqrt(2 pi n / T)),
bounded by J / 2 where diffusion cannot follow.  W and the non-adhesive energy stay exact.  No cell grows by more than
`growth` in S.

Slope variances are dimensionless; wavenumbers in rad/m.  Limits: a mesh is a discretisation, its error is measured by
refining it (adhesive.py, `resolution`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from persson.mathematics.arrays import FloatArray, IntArray
from persson.spectrum import DiscreteSpectrum, Spectrum

ONSET_REACH, ONSET_FLOOR = 0.1, 1e-5  # of the onset: farthest and nearest node of the crowd around it
ONSET_SHARE = 12.0  # growth of the distance from the onset over growth of S
SHARPNESS = 16.0
JUMP_SHARE = 0.3
CROWDED = (1e-4, 1e-3, 6e-3)  # of a line, besides the squares: the jump itself and the first recovery of the flux
STAIRCASE_SHIFT = 0.33174  # zeta(3/2) / sqrt(2 pi^3)


@dataclass(frozen=True, eq=False)
class MagnificationMesh:
    """Nodes in slope variance.

    Attributes
    ----------
    slope_variance : (n + 1,) array
        S, from 0 to the total.
    weight : (n + 1,) array
        W = int_0^S dS / q, m.
    before, after : (n + 1,) array
        q just below and just above each node, rad/m.
    inside : (n,) array
        q in the middle of each cell, rad/m.
    jump, duration : (n + 1,) array
        Where lines are taken together: dq / 2q and sqrt(T) of the lines there; elsewhere 0 and 1.
    """

    slope_variance: FloatArray
    weight: FloatArray
    before: FloatArray
    after: FloatArray
    inside: FloatArray
    jump: FloatArray
    duration: FloatArray

    def smoothed(self, barrier: FloatArray) -> FloatArray:
        """Return the barrier at the nodes, (.., n + 1), moved inward to replace jumps of lines between two nodes."""
        return _moved_inward(barrier, self.jump, self.duration)

    def smoothed_inside(self, barrier: FloatArray) -> FloatArray:
        """Return the barrier in the middle of the cells, (.., n), moved inward as `smoothed` moves it."""
        return _moved_inward(barrier, self.jump[1:], self.duration[1:])

    @property
    def stress_variance(self) -> FloatArray:
        """V = S / 4 in units of E*^2, (n + 1,)."""
        return self.slope_variance / 4


def magnification_mesh(
    spectrum: Spectrum,
    start: float,
    growth: float,
    *,
    barrier_scale: float = 0.0,
    substeps: int = 6,
    most_resolved: int = 200,
    onsets: tuple[float, ...] = (),
) -> MagnificationMesh:
    """Build the mesh with nodes from S = 0, `start`, .. to the total slope variance.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
    start : float
        First node after zero, below which nothing reaches the barrier; > 0.
    growth : float
        Largest S_{k+1} / S_k, > 1.
    barrier_scale : float
        Largest a / sqrt(q) possible, m^1/2.
    substeps, most_resolved : int
        Substeps of a resolved line; largest number of resolved lines (largest J T first, besides the coarse lines).
    onsets : tuple of float
        Values of S at which cells crowd.

    Examples
    --------
    >>> mesh = magnification_mesh(DiscreteSpectrum([1.0, 2.0], [0.1, 0.05]), 1e-4, 1.5, substeps=2)
    >>> bool(abs(mesh.slope_variance[-1] - 0.01) < 1e-15), float(mesh.before[-1]), float(mesh.after[1])
    (True, 2.0, 1.0)
    """
    total = spectrum.total_slope_variance
    start = min(start, total / 2)
    if isinstance(spectrum, DiscreteSpectrum):
        carries = spectrum.slope_variance_steps > 0
        lines, top = spectrum.wavenumbers[carries], spectrum.slope_variance[carries]
        edges = np.concatenate([[0.0], top])
        jump = np.concatenate([[0.0], np.diff(lines) / (2 * lines[1:])])
        duration = np.sqrt(np.diff(edges) / 4)
        resolved = _resolved(lines, jump, duration, barrier_scale, most_resolved)
        nodes = _lines_to_nodes(edges, resolved, start, growth, substeps)
    else:
        nodes = np.concatenate([[0.0, start], spectrum.slope_variance[1:]])
    nodes = _bounded_growth(np.unique(nodes[(nodes == 0) | (nodes >= start)]), growth)
    for onset in onsets:
        count = int(np.ceil(np.log(ONSET_REACH / ONSET_FLOOR) / np.log1p(ONSET_SHARE * (growth - 1)))) + 1
        steps = onset * np.geomspace(ONSET_REACH, ONSET_FLOOR, count)
        crowd = np.concatenate([onset - steps, [onset], onset + steps])
        nodes = np.union1d(nodes, crowd[(crowd > start) & (crowd < total)])
    middle = (nodes[1:] + nodes[:-1]) / 2
    weight = spectrum.weighted_integral(lambda s: s, np.ones_like, nodes)
    if not isinstance(spectrum, DiscreteSpectrum):
        q = spectrum.wavenumber_at(nodes)
        return MagnificationMesh(
            nodes, weight, q, q, spectrum.wavenumber_at(middle), np.zeros_like(nodes), np.ones_like(nodes)
        )
    before, after, inside = _line_wavenumbers(edges, lines, resolved, nodes, middle)
    below = _line_of(edges, nodes, "left")
    jumps = np.where(resolved[below], 0.0, jump[below])
    return MagnificationMesh(nodes, weight, before, after, inside, jumps, duration[below])


def _resolved(
    lines: FloatArray, jump: FloatArray, duration: FloatArray, barrier_scale: float, most: int
) -> NDArray[np.bool_]:
    coarse = np.concatenate([[True], lines[1:] > lines[:-1] * (1 + 1 / SHARPNESS)])
    height = barrier_scale * np.sqrt(lines) * jump
    felt = np.where((height > JUMP_SHARE * duration) & ~coarse, height * duration**2, 0.0)
    worst = np.argsort(felt)[::-1][:most]
    resolved = coarse.copy()
    resolved[worst[felt[worst] > 0]] = True
    return resolved


def _moved_inward(barrier: FloatArray, jump: FloatArray, duration: FloatArray) -> FloatArray:
    step = barrier * jump
    share = STAIRCASE_SHIFT * step / duration
    return np.asarray(barrier - step * share / (1 + 2 * share))


def _lines_to_nodes(
    edges: FloatArray, resolved: NDArray[np.bool_], start: float, growth: float, substeps: int
) -> FloatArray:
    squares = (np.arange(1, substeps + 1) / substeps) ** 2
    crowding = np.concatenate([[share for share in CROWDED if share < squares[0] / 2], squares])
    low, high = edges[:-1][resolved], edges[1:][resolved]
    fine = (low[:, None] + (high - low)[:, None] * crowding).ravel()
    targets = np.geomspace(start, edges[-1], max(2, int(np.ceil(np.log(edges[-1] / start) / np.log(growth))) + 1))
    snapped = edges[np.clip(np.searchsorted(edges, targets), 1, edges.size - 1)]
    return np.unique(np.concatenate([[0.0, start], low, high, fine, snapped, edges[-1:]]))


def _bounded_growth(nodes: FloatArray, growth: float) -> FloatArray:
    """Cut cells that grow by more than `growth` geometrically, except the first cell, from zero to the start."""
    pieces = np.maximum(1, np.ceil(np.log(nodes[2:] / nodes[1:-1]) / np.log(growth) - 1e-9)).astype(np.int64)
    cell = np.repeat(np.arange(pieces.size), pieces)
    position = np.arange(cell.size) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    low, ratio = nodes[1:-1][cell], (nodes[2:] / nodes[1:-1])[cell]
    return np.unique(np.concatenate([nodes, low * ratio ** (position / pieces[cell])]))


def _line_wavenumbers(
    edges: FloatArray, lines: FloatArray, resolved: NDArray[np.bool_], nodes: FloatArray, middle: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    smooth_at = (edges[1:] + edges[:-1]) / 2
    below, above = _line_of(edges, nodes, "left"), _line_of(edges, nodes, "right")
    within = _line_of(edges, middle, "right")
    smooth = np.interp(nodes, smooth_at, lines)
    smooth[-1] = lines[-1]
    before = np.where(resolved[below], lines[below], smooth)
    after = np.where(resolved[above], lines[above], smooth)
    inside = np.where(resolved[within], lines[within], np.interp(middle, smooth_at, lines))
    return before, after, inside


def _line_of(edges: FloatArray, values: FloatArray, side: Literal["left", "right"]) -> IntArray:
    return np.clip(np.searchsorted(edges, values, side=side) - 1, 0, edges.size - 2)
