"""First route: stress diffusing towards a moving absorbing barrier, by conservative finite volumes.

    dP/dV = 1/2 d2P/dsigma2,  P(-a(V), V) = 0,  P(sigma, 0) = delta(sigma - sigma_0),  dA/dV = -1/2 dP/dsigma at -a.

No term injects at the barrier: P = 0 there, so a barrier that moves away takes nothing with it and A is monotone.  The
cells follow the domain [-a, sigma_0 + REACH sqrt V]: their faces are -a + R(V) y_f with fixed y_f, and the flux through
a face is 1/2 dP/dsigma + w P with w the speed of the face.  In time the three-stage singly diagonally implicit
Runge-Kutta method of third order (L-stable); all loads of a batch are solved as one tridiagonal system.

The march begins where an exact solution ends: as long as the barrier is at zero, P is the difference of two Gaussians
and A = erf(sigma_0 / sqrt(2 V)); as long as the barrier is SAFE standard deviations away, P is one Gaussian and A = 1.

With a relaxation (corrected_variance.py) the stress also drifts to its mean over the contact, -beta (sigma - m); S
and the moments are means of those at both ends of a step, predicted by a step before.

Source of the equation: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601;
time integration: R. Alexander, SIAM J. Numer. Anal. 14 (1977) 1006, doi:10.1137/0714068.  Stresses in units of E*, V in
E*^2.  Limits: sigma_0 > 0; mass beyond REACH standard deviations, 1e-20, is not represented.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgtsv
from scipy.special import erf, erfc

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
EnergyFactor = Callable[[int, FloatArray], FloatArray]

REACH = 9.5  # standard deviations beyond sigma_0
SAFE = 9.0  # standard deviations between the mean and the barrier: 1e-19 has arrived
LARGEST_JUMP = 0.03  # of the barrier in one Runge-Kutta step, in standard deviations
CROWDING = 0.6  # of the mapping y = (1 - c) x + c x^2: cells at the barrier are (1 - c) of the mean
GAMMA = 0.435866521508459  # root of 6 g^3 - 18 g^2 + 9 g - 1
STAGE_TIMES = (GAMMA, (1 + GAMMA) / 2, 1.0)
STAGE_WEIGHTS: tuple[tuple[float, ...], ...] = (
    (),
    ((1 - GAMMA) / 2,),
    (-(6 * GAMMA**2 - 16 * GAMMA + 1) / 4, (6 * GAMMA**2 - 20 * GAMMA + 5) / 4),
)


@dataclass(frozen=True, eq=False)
class StressDistribution:
    """Cell averages of P at the end of a march, dimensionless, per load.

    Attributes
    ----------
    faces : (n_loads, n_cells + 1) array
        sigma / E* of the faces; the first is the barrier.
    density : (n_loads, n_cells) array
        P E* per nominal area.
    """

    faces: FloatArray
    density: FloatArray

    @property
    def area(self) -> FloatArray:
        """A/A0, (n_loads,)."""
        return np.asarray(np.sum(self.density * np.diff(self.faces, axis=1), axis=1))

    @property
    def load(self) -> FloatArray:
        """int sigma P dsigma, (n_loads,), P linear in each cell: not conserved once the barrier moves."""
        width, centre = np.diff(self.faces, axis=1), (self.faces[:, 1:] + self.faces[:, :-1]) / 2
        slope = np.empty_like(self.density)
        for row, (points, values) in enumerate(zip(centre, self.density, strict=True)):
            from_barrier = np.gradient(np.append(0.0, values), np.append(self.faces[row, 0], points))
            slope[row] = from_barrier[1:]
        return np.asarray(np.sum(self.density * centre * width + slope * width**3 / 12, axis=1))


@dataclass(frozen=True, eq=False)
class March:
    """A(V) of each load on the nodes, (n_loads, n + 1), and the distribution at the last node."""

    area: FloatArray
    distribution: StressDistribution


def exact_until(
    loads: FloatArray, variance: FloatArray, barrier: FloatArray, drifts: bool = False
) -> tuple[IntArray, NDArray[np.bool_]]:
    """Last node up to which an exact solution holds, and whether it is the one with the image, (n_loads,) each.

    Parameters
    ----------
    loads : (n_loads,) array
        sigma_0 / E*.
    variance : (n + 1,) or (n_loads, n + 1) array
        V at the nodes, from 0.
    barrier : (n_loads, n + 1) array
        a at the nodes.
    drifts : bool
        Then the solution with the image does not hold.
    """
    still = (np.cumsum(barrier > 0, axis=1) == 0) & (not drifts)
    image_end = np.maximum(np.sum(still, axis=1) - 1, 0)
    distance = loads[:, None] + np.minimum.accumulate(barrier, axis=1)
    free_end = np.sum(np.cumsum(distance < SAFE * np.sqrt(variance), axis=1) == 0, axis=1) - 1
    return np.maximum(image_end, free_end), image_end >= free_end


def march(
    loads: FloatArray,
    variance: FloatArray,
    barrier: FloatArray,
    n_cells: int,
    energy_factor: EnergyFactor | None = None,
) -> March:
    """Diffuse from delta functions to the last node, with a^2 linear in V between the nodes.

    Parameters
    ----------
    loads : (n_loads,) array
        sigma_0 / E* > 0.
    variance : (n + 1,) or (n_loads, n + 1) array
        V at the nodes, increasing from 0.
    barrier : (n_loads, n + 1) array
        a at the nodes, >= 0; the value just below the node where it jumps.
    n_cells : int
        Cells across the domain.
    energy_factor : callable, optional
        S of the step between nodes k and k + 1 at contact fractions (n_loads,): the stress drifts to its mean over the
        contact as S asks; None for no drift.

    Raises
    ------
    ValueError
        If the barrier is felt before the first node.

    Examples
    --------
    >>> nodes = np.concatenate([[0.0], np.geomspace(1e-3, 1.0, 200)])
    >>> result = march(np.array([1.0]), nodes, np.full((1, 201), 0.5), 400)
    >>> bool(abs(result.area[0, -1] - erf(1.5 / np.sqrt(2))) < 2e-5)
    True
    """
    variance = np.broadcast_to(variance, barrier.shape)
    first, has_image = exact_until(loads, variance, barrier, energy_factor is not None)
    if not first.all():
        raise ValueError(
            f"variance[1]: {variance[..., 1].max()} must be <= (distance of the barrier / {SAFE})^2 for every load"
        )
    last = variance.shape[1] - 1
    with np.errstate(divide="ignore"):
        exact = erf(loads[:, None] / np.sqrt(2 * variance))
    area = np.where(has_image[:, None], exact, 1.0)
    grid = _grid(n_cells)
    extent = loads[:, None] + barrier + REACH * np.sqrt(variance)
    content = np.zeros((loads.size, n_cells))
    for node in range(int(first.min()), last + 1):
        if node > first.min():
            step = np.diff(variance[:, node - 1 : node + 1], axis=1)
            for ends in _pieces(extent[:, node - 1 : node + 1], barrier[:, node - 1 : node + 1], variance[:, node]):
                if energy_factor is None:
                    content = _step(grid, content, step, *ends)
                    continue
                factor = partial(energy_factor, node - 1)
                begin = _relaxation(grid, content, ends, factor, 0)
                end = _relaxation(grid, _step(grid, content, step, *ends, begin), ends, factor, 1)
                content = _step(grid, content, step, *ends, ((begin[0] + end[0]) / 2, (begin[1] + end[1]) / 2))
            marching = node > first
            area[marching, node] = content[marching].sum(axis=1)
        for load in np.flatnonzero(first == node):
            faces = grid.faces * extent[load, node] - barrier[load, node]
            content[load] = _exact_contents(loads[load], variance[load, node], faces, bool(has_image[load]))
    faces = grid.faces * extent[:, -1:] - barrier[:, -1:]
    return March(area, StressDistribution(faces, content / np.diff(faces, axis=1)))


@dataclass(frozen=True, eq=False)
class _Grid:
    """Faces y_f in [0, 1] and the three constant operators, bands (below, diagonal, above) acting on cell contents."""

    faces: FloatArray
    diffusion: FloatArray
    shift: FloatArray
    stretch: FloatArray


@cache
def _grid(n_cells: int) -> _Grid:
    even = np.linspace(0.0, 1.0, n_cells + 1)
    faces = (1 - CROWDING) * even + CROWDING * even**2
    width, centre = np.diff(faces), (faces[1:] + faces[:-1]) / 2
    gap = np.diff(centre)
    # flux through inner face k = 1 .. n-1, from the contents of the cells below (k-1) and above (k)
    slope_low, slope_high = -0.5 / gap / width[:-1], 0.5 / gap / width[1:]
    # P at a face weighted by the widths: cells that move then carry int sigma P exactly
    mean = 0.5 / gap
    diffusion = _divergence(slope_low, slope_high)
    # the barrier: the slope to the first centre; what leaves then carries the stress of the barrier itself
    diffusion[1, 0] -= 0.5 / centre[0] / width[0]
    inner = faces[1:-1]
    return _Grid(faces, diffusion, _divergence(mean, mean), _divergence(inner * mean, inner * mean))


def _divergence(low: FloatArray, high: FloatArray) -> FloatArray:
    """Bands of flux above minus flux below, for fluxes low Q_{k-1} + high Q_k through the inner faces."""
    bands = np.zeros((3, low.size + 1))
    bands[1, :-1] += low
    bands[2, :-1] += high
    bands[1, 1:] -= high
    bands[0, 1:] -= low
    return bands


def _pieces(
    extent: FloatArray, barrier: FloatArray, variance: FloatArray
) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
    """A step cut so that no barrier jumps by more than LARGEST_JUMP: shares of V, extents and barriers of each piece.

    The barrier moves evenly; with a^2 linear in V a piece takes the share of V that it has of the change of a^2.
    """
    jump = np.abs(np.diff(barrier, axis=1))
    count = int(np.ceil(np.max(jump[:, 0] / (LARGEST_JUMP * np.sqrt(variance))))) or 1
    squares = np.diff(barrier**2, axis=1)
    cuts = [barrier[:, :1] + k / count * np.diff(barrier, axis=1) for k in range(count + 1)]
    sizes = [extent[:, :1] + k / count * np.diff(extent, axis=1) for k in range(count + 1)]
    pieces = []
    for k in range(count):
        share = np.divide(cuts[k + 1] ** 2 - cuts[k] ** 2, squares, out=np.full_like(jump, 1 / count), where=jump > 0)
        pieces.append((share, np.hstack(sizes[k : k + 2]), np.hstack(cuts[k : k + 2])))
    return pieces


def _relaxation(
    grid: _Grid,
    content: FloatArray,
    ends: tuple[FloatArray, FloatArray, FloatArray],
    energy_factor: Callable[[FloatArray], FloatArray],
    side: int,
) -> tuple[FloatArray, FloatArray]:
    """beta = (1 - S) / (2 var) and m at a side of a step, (n_loads, 1) each; no drift before the march begins."""
    _, extent, barrier = ends
    centre = (grid.faces[1:] + grid.faces[:-1]) / 2 * extent[:, side, None] - barrier[:, side, None]
    area = content.sum(axis=1)
    begun = area > 0
    norm = np.where(begun, area, 1.0)
    mean = np.sum(content * centre, axis=1) / norm
    spread = np.sum(content * (centre - mean[:, None]) ** 2, axis=1) / norm
    rate = np.where(begun, (1 - energy_factor(area)) / (2 * np.where(begun, spread, 1.0)), 0.0)
    return rate[:, None], mean[:, None]


def _step(
    grid: _Grid,
    content: FloatArray,
    step: FloatArray,
    share: FloatArray,
    extent: FloatArray,
    barrier: FloatArray,
    pull: tuple[FloatArray, FloatArray] | None = None,
) -> FloatArray:
    """One Runge-Kutta step between extents and barriers (n_loads, 2), in a time tau in which the faces move evenly.

    a^2, not a, is nearly linear in V (it leaves zero like a square root); a linear in tau and a^2 linear in V give
    dV/dtau = share * step * 2 a / (a_0 + a_1), and the displacement of the faces is summed exactly.
    """
    stretch, shift = np.diff(extent, axis=1), -np.diff(barrier, axis=1)
    sum_of_ends = np.sum(barrier, axis=1, keepdims=True)

    def bands(part: float) -> FloatArray:
        size = extent[:, :1] - part * (extent[:, :1] - extent[:, 1:])
        position = barrier[:, :1] - part * shift
        pace = np.divide(2 * position, sum_of_ends, out=np.ones_like(position), where=sum_of_ends > 0)
        spread, moved, stretched = share * step * pace, shift, stretch
        if pull is not None:  # the faces move against the stress that drifts
            rate, mean = pull
            moved = shift - rate * spread * (position + mean)
            stretched = stretch + rate * spread * size
        return np.asarray(
            grid.diffusion[:, None, :] * (spread / size**2)
            + grid.shift[:, None, :] * (moved / size)
            + grid.stretch[:, None, :] * (stretched / size)
        )

    slopes: list[FloatArray] = []
    for time, weights in zip(STAGE_TIMES, STAGE_WEIGHTS, strict=True):
        right = content + sum((weight * slope for weight, slope in zip(weights, slopes, strict=True)), 0.0)
        stage = _solve(bands(time), right)
        slopes.append((stage - right) / GAMMA)
    return stage


def _solve(bands: FloatArray, right: FloatArray) -> FloatArray:
    """(1 - GAMMA L) Q = right, all loads as one tridiagonal system (the bands between loads are zero)."""
    scaled = -GAMMA * bands
    below, diagonal, above = scaled[0].ravel()[1:], 1 + scaled[1].ravel(), scaled[2].ravel()[:-1]
    *_, solution, info = dgtsv(below, diagonal, above, right.ravel())
    if info != 0:
        raise ArithmeticError(f"singular diffusion step (LAPACK dgtsv info {info})")
    return np.asarray(solution).reshape(right.shape)


def _exact_contents(load: float, variance: float, faces: FloatArray, image: bool) -> FloatArray:
    """int P over the cells: a Gaussian about sigma_0, less its mirror image behind a barrier at zero."""
    root = np.sqrt(2 * variance)
    # differences of the tail on the nearer side keep their digits
    upper = -np.diff(erfc((faces - load) / root)) / 2
    lower = np.diff(erfc((load - faces) / root)) / 2
    direct = np.where(faces[1:] > load, upper, lower)
    if not image:
        return np.asarray(direct)
    return np.asarray(direct + np.diff(erfc((faces + load) / root)) / 2)
