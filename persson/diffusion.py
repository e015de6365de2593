"""First route: stress diffusing towards a moving absorbing barrier, by conservative finite volumes.

    dP/dV = 1/2 d2P/dsigma2,  P(-a(V), V) = 0,  P(sigma, 0) = delta(sigma - sigma_0),  dA/dV = -1/2 dP/dsigma at -a.

No term injects at the barrier: P = 0 there, so a barrier that moves away takes nothing with it and A is monotone.  The
cells follow the domain [-a, sigma_0 + REACH sqrt V]: their faces are -a + R(V) y_f with fixed y_f, and the flux through
a face is 1/2 dP/dsigma + w P with w the speed of the face.  In time the three-stage singly diagonally implicit
Runge-Kutta method of third order (L-stable); all loads of a batch are solved as one tridiagonal system.

The march begins where an exact solution ends: as long as the barrier is at zero, P is the difference of two Gaussians
and A = erf(sigma_0 / sqrt(2 V)); as long as the barrier is SAFE standard deviations away, P is one Gaussian and A = 1.

Source of the equation: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601;
time integration: R. Alexander, SIAM J. Numer. Anal. 14 (1977) 1006, doi:10.1137/0714068.  Stresses in units of E*, V in
E*^2.  Limits: sigma_0 > 0; mass beyond REACH standard deviations, 1e-20, is not represented.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgtsv
from scipy.special import erf, erfc

from persson.mathematics.arrays import FloatArray, IntArray

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


def exact_until(loads: FloatArray, variance: FloatArray, barrier: FloatArray) -> tuple[IntArray, NDArray[np.bool_]]:
    """Return the last node up to which an exact solution holds, and if that solution has an image, (n_loads,) each.

    Parameters
    ----------
    loads : (n_loads,) array
        sigma_0 / E*.
    variance : (n + 1,) array
        V at the nodes, from 0.
    barrier : (n_loads, n + 1) array
        a at the nodes.
    """
    still = np.cumsum(barrier > 0, axis=1) == 0
    image_end = np.maximum(np.sum(still, axis=1) - 1, 0)
    distance = loads[:, None] + np.minimum.accumulate(barrier, axis=1)
    free_end = np.sum(np.cumsum(distance < SAFE * np.sqrt(variance), axis=1) == 0, axis=1) - 1
    return np.maximum(image_end, free_end), image_end >= free_end


def steps_of(variance: FloatArray, barrier: FloatArray) -> IntArray:
    """Return the Runge-Kutta steps in each cell, (n,): no barrier of `march` jumps by more than LARGEST_JUMP."""
    jump = np.abs(np.diff(barrier, axis=1)) / (LARGEST_JUMP * np.sqrt(variance[..., 1:]))
    return np.asarray(np.maximum(np.ceil(np.max(jump, axis=0)), 1).astype(np.int64))


def march(
    loads: FloatArray,
    variance: FloatArray,
    barrier: FloatArray,
    n_cells: int,
    n_steps: IntArray | None = None,
) -> March:
    """Diffuse from delta functions to the last node, with a^2 linear in V between the nodes.

    Parameters
    ----------
    loads : (n_loads,) array
        sigma_0 / E* > 0.
    variance : (n + 1,) array
        V at the nodes, increasing from 0.
    barrier : (n_loads, n + 1) array
        a at the nodes, >= 0; the value just below the node where it jumps.
    n_cells : int
        Cells across the domain.
    n_steps : (n,) array, optional
        Runge-Kutta steps in each cell; None calls `steps_of`.

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
    first, has_image = exact_until(loads, variance, barrier)
    if not first.all():
        raise ValueError(
            f"variance[1]: {variance[..., 1].max()} must be <= (distance of the barrier / {SAFE})^2 for every load"
        )
    with np.errstate(divide="ignore"):
        exact = erf(loads[:, None] / np.sqrt(2 * variance))
    area = np.where(has_image[:, None], exact, 1.0)
    grid = _grid(n_cells)
    extent = loads[:, None] + barrier + REACH * np.sqrt(variance)
    content = np.zeros((loads.size, n_cells))

    def begin_at(node: int) -> None:
        for load in np.flatnonzero(first == node):
            faces = grid.faces * extent[load, node] - barrier[load, node]
            content[load] = _exact_contents(loads[load], variance[load, node], faces, bool(has_image[load]))

    start, beginnings = int(first.min()), set(first.tolist())
    begin_at(start)
    n_steps = steps_of(variance, barrier) if n_steps is None else n_steps
    steps = _steps(extent[:, start:], barrier[:, start:], variance[:, start:], n_steps[start:])
    for step, cell in enumerate(steps.cell + start):
        content = _advance(grid, content, steps.terms[step])
        if steps.reaches[step]:
            np.copyto(area[:, cell + 1], content.sum(axis=1), where=first <= cell)
            if cell + 1 in beginnings:
                begin_at(cell + 1)
    faces = grid.faces * extent[:, -1:] - barrier[:, -1:]
    return March(area, StressDistribution(faces, content / np.diff(faces, axis=1)))


@dataclass(frozen=True, eq=False)
class _Grid:
    """Faces y_f in [0, 1], (n_cells + 1,), their centres, and the operators that the terms of a step multiply.

    `operators`, (3, 4, n_cells), has the bands (below, diagonal, above) of -GAMMA times diffusion, shift and stretch,
    and of the identity, acting on cell contents.
    """

    faces: FloatArray
    centre: FloatArray
    operators: FloatArray


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
    moving = [diffusion, _divergence(mean, mean), _divergence(inner * mean, inner * mean)]
    identity = np.zeros((3, n_cells))
    identity[1] = 1.0
    return _Grid(faces, centre, np.stack([*(-GAMMA * bands for bands in moving), identity], axis=1))


def _divergence(low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the bands of flux above minus flux below, for fluxes low Q_{k-1} + high Q_k through the inner faces."""
    bands = np.zeros((3, low.size + 1))
    bands[1, :-1] += low
    bands[2, :-1] += high
    bands[1, 1:] -= high
    bands[0, 1:] -= low
    return bands


@dataclass(frozen=True, eq=False)
class _Steps:
    """Runge-Kutta steps from node to node.

    In the time tau of a step the faces move evenly.  a^2, not a, is nearly linear in V (it leaves zero like a square
    root); a linear in tau and a^2 linear in V give dV/dtau = share * dV * 2 a / (a_0 + a_1), share the part that a step
    has of the change of a^2 over its cell; the displacement of the faces is summed exactly.

    Attributes
    ----------
    cell : (n_steps,) array
        Index of the mesh cell in which a step lies.
    reaches : (n_steps,) array
        True if the step ends at the node above the cell.
    terms : (n_steps, 3, n_loads, 4) array
        Factors of the operators of the grid.
    """

    cell: IntArray
    reaches: NDArray[np.bool_]
    terms: FloatArray


def _steps(extent: FloatArray, barrier: FloatArray, variance: FloatArray, n_steps: IntArray) -> _Steps:
    """Return the steps between nodes, from arrays (n_loads, n_nodes), with `n_steps` (n_nodes - 1,) in each cell."""
    extent, barrier, variance = extent.T, barrier.T, variance.T
    jump, squares = np.diff(barrier, axis=0), np.diff(barrier**2, axis=0)
    cell = np.repeat(np.arange(n_steps.size), n_steps)
    count = n_steps[cell][:, None]
    piece = (np.arange(cell.size) - np.searchsorted(cell, cell))[:, None]
    sizes = [extent[cell] + (piece + end) / count * np.diff(extent, axis=0)[cell] for end in (0, 1)]
    barriers = [barrier[cell] + (piece + end) / count * jump[cell] for end in (0, 1)]
    moves = jump[cell] != 0
    share = np.divide(barriers[1] ** 2 - barriers[0] ** 2, squares[cell], out=1 / count + 0.0 * moves, where=moves)
    step = (share * np.diff(variance, axis=0)[cell])[:, None]
    both = np.stack([*sizes, *barriers])[:, :, None]
    time = np.array(STAGE_TIMES)[:, None]
    size, position = both[0] + time * (both[1] - both[0]), both[2] + time * (both[3] - both[2])
    total = both[2] + both[3]
    spread = step * np.divide(2 * position, total, out=np.ones_like(position), where=total > 0)
    terms = [spread / size**2, (both[3] - both[2]) / -size, (both[1] - both[0]) / size, np.ones_like(size)]
    return _Steps(cell, (piece == count - 1)[:, 0], np.stack(terms, axis=-1))


def _advance(grid: _Grid, content: FloatArray, terms: FloatArray) -> FloatArray:
    """Advance the cell contents (n_loads, n_cells) by one Runge-Kutta step; `terms` (3, n_loads, 4) of the stages."""
    bands = np.matmul(terms[:, None], grid.operators)
    changes: list[FloatArray] = []
    for stage, weights in enumerate(STAGE_WEIGHTS):
        right = content
        for weight, change in zip(weights, changes, strict=True):
            right = right + weight / GAMMA * change
        solution = _solve(bands[stage], right)
        changes.append(solution - right)
    return solution


def _solve(bands: FloatArray, right: FloatArray) -> FloatArray:
    """Solve (1 - GAMMA L) Q = right for all loads as one tridiagonal system (no band reaches from load to load)."""
    *_, solution, info = dgtsv(
        bands[0].ravel()[1:],
        bands[1].ravel(),
        bands[2].ravel()[:-1],
        right.ravel(),
        overwrite_dl=True,
        overwrite_d=True,
        overwrite_du=True,
    )
    if info != 0:
        raise ArithmeticError(f"singular diffusion step (LAPACK dgtsv info {info})")
    return np.asarray(solution).reshape(right.shape)


def _exact_contents(load: float, variance: float, faces: FloatArray, image: bool) -> FloatArray:
    """Return int P over the cells: a Gaussian about sigma_0, less its mirror image behind a barrier at zero."""
    root = np.sqrt(2 * variance)
    # differences of the tail on the nearer side keep their digits
    upper = -np.diff(erfc((faces - load) / root)) / 2
    lower = np.diff(erfc((load - faces) / root)) / 2
    direct = np.where(faces[1:] > load, upper, lower)
    if not image:
        return np.asarray(direct)
    return np.asarray(direct + np.diff(erfc((faces + load) / root)) / 2)
