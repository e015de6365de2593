"""Pressure of given contact patches by dense linear algebra: the reference for the compressed evaluation of bem.

On every patch x = c + r t and sigma(x) = q(t) / (r sqrt(1 - t^2)), so that with charges y_k = (pi/N) q(t_k) at N
Gauss-Chebyshev nodes per patch the equation u = h - h_max + Delta becomes A y = b,

    A_kj = -(1/pi) log|2 sin((x_k - x_j)/2)|,       between different patches,
    A_kj = -(1/pi) [log(r sinc(r (t_k - t_j)/2)) + M_kj],   within a patch, sinc(y) = sin(y)/y,

where M takes int log|t - t'| T_n(t')/sqrt(1 - t'^2) dt' = -pi log 2 (n = 0), -(pi/n) T_n(t) (n >= 1) on the N
interpolating polynomials (Mason and Handscomb, Chebyshev Polynomials, 2003, section 9.2).  One factorisation serves
y and all derivatives: an edge moves the nodes by dx, and

    (dA y)_k = -(1/pi) sum_j 1/2 cot((x_k - x_j)/2) (dx_k - dx_j) y_j,    db_k = h'(x_k) dx_k,

with the limit dr/r on the diagonal.  These are derivatives of the discrete system itself, hence exact to rounding.
K at t = +-1 is -sqrt(pi/r) q(+-1).

Source of the problem: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.
Dimensionless: lengths period / 2 pi, heights a, stresses E* q0 a / 2.  A bonded layer adds the smooth kernel

    S(x) = sum_m (1 - ratio(m q0 d)) / m cos(m x),

ratio of closed_forms.py, summed until (1 - ratio) / m is rounding; it is analytic up to 2 q0 d beside the real axis,
which decides how many nodes a patch needs.  Limits: time n^3, memory two n x n matrices for n nodes in all (3000:
0.8 s, 0.2 GB); contact not complete.  Heights, nodes, moments and kernels are the references' own.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from validation.harness.arrays import FloatArray, IntArray
from validation.references.closed_forms import layer_ratio
from validation.references.waves import Harmonics, Waves

NEGLIGIBLE = 1e-18  # (1 - ratio) / m beyond which modes of the layer are those of the half-space
BLOCK = 2048  # modes of a layer that are summed at a time


@dataclass(frozen=True, eq=False)
class LayerKernel:
    """Addition sum_m strength_m cos(m x) of a bonded layer to the kernel log|2 sin(x/2)|."""

    order: FloatArray
    strength: FloatArray

    @classmethod
    def of(cls, depth: float, poisson_ratio: float) -> "LayerKernel":
        """Return the addition of a layer of the depth 2 pi thickness / period."""
        order = np.arange(1.0, 8 + np.ceil(25 / depth))
        strength = (1 - layer_ratio(order * depth, poisson_ratio)) / order
        counts = np.abs(strength) > NEGLIGIBLE
        return cls(order[counts], strength[counts])

    def value(self, x: FloatArray) -> FloatArray:
        """Return S at places (n,)."""
        return np.asarray(np.cos(np.multiply.outer(x, self.order)) @ self.strength)

    def matrices(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return S(x_k - x_j) and dS/dx(x_k - x_j), (n, n) each, as products of the modes at x_k and at x_j."""
        value, slope = np.zeros((x.size, x.size)), np.zeros((x.size, x.size))
        for start in range(0, self.order.size, BLOCK):
            order, strength = self.order[start : start + BLOCK], self.strength[start : start + BLOCK]
            angle = np.multiply.outer(x, order)
            cosine, sine = np.cos(angle), np.sin(angle)
            value += (cosine * strength) @ cosine.T + (sine * strength) @ sine.T
            slope += (cosine * (strength * order)) @ sine.T - (sine * (strength * order)) @ cosine.T
        return value, slope


def layer_nodes(left: FloatArray, right: FloatArray, depth: float, tolerance: float = 1e-14) -> IntArray:
    """Return nodes per patch that resolve the kernel of a layer, (L,): Bernstein's ellipse through 2i depth."""
    return np.asarray(np.ceil(-np.log(tolerance) / np.arcsinh(4 * depth / (right - left))), dtype=np.int64)


@dataclass(frozen=True, eq=False)
class Pressure:
    """Chebyshev series of the pressure: sigma(c + r t) = sum_n charges[i][n] T_n(t) / (r sqrt(1 - t^2)) on patch i."""

    left: FloatArray
    right: FloatArray
    charges: tuple[FloatArray, ...]


@dataclass(frozen=True, eq=False)
class DenseState:
    """Elastic state of given patches, dimensionless. Edge arrays list all left edges, then all right ones."""

    pressure: Pressure
    penetration: float  # Delta
    stress_intensity: FloatArray  # K, (2 L,)
    stress_intensity_rate: FloatArray  # dK/dDelta, (2 L,)
    stress_intensity_jacobian: FloatArray  # dK_e / d(outward motion of edge f) at [e, f], (2 L, 2 L)
    load: float  # int sigma dx
    load_rate: float  # its derivative by Delta
    load_jacobian: FloatArray  # dload / d(outward motion of an edge), (2 L,)
    elastic_energy: float  # U_el


def dense_nodes(
    profile: Harmonics, left: FloatArray, right: FloatArray, tolerance: float = 1e-13, margin: float = 1.3
) -> IntArray:
    """Return nodes per patch that resolve the profile and the nearest gap, (L,).

    `margin` times Nyquist's kappa = width max_order / 2 in the middle of a Chebyshev grid, plus 20 and 3 kappa^(1/3)
    (the transition of Bessel functions J_n(kappa)); at least log(1/tolerance) / log rho with the Bernstein
    ellipse rho = z + sqrt(z^2 - 1), z = 1 + 2 gap/width, that touches the next patch.

    Examples
    --------
    >>> wave = Waves(2 * np.pi, np.array([10]), np.array([1.0]), np.array([0.0]))
    >>> dense_nodes(wave, np.array([0.0]), np.array([2.0])).tolist()
    [40]
    """
    width = right - left
    behind = np.append(left[1:], left[:1] + 2 * np.pi) - right
    z = 1 + 2 * np.minimum(behind, np.roll(behind, 1)) / width
    kappa = width * int(np.max(profile.orders)) / 2
    for_profile = margin * kappa + 3 * np.cbrt(kappa) + 20
    for_gap = -np.log(tolerance) / np.log(z + np.sqrt(z * z - 1))
    return np.asarray(np.ceil(np.maximum(for_profile, for_gap)), dtype=np.int64)


def evaluate_dense(
    profile: Harmonics,
    left: FloatArray,
    right: FloatArray,
    penetration: float,
    nodes: IntArray | None = None,
    smooth_kernel: LayerKernel | None = None,
) -> DenseState:
    """Solve for the pressure of given patches at given penetration, with all first derivatives.

    Parameters
    ----------
    profile : Harmonics
        Dimensionless (period 2 pi, unit rms height).
    left, right : (L,) arrays
        Edges in order on the circle, disjoint; the last patch may reach beyond 2 pi.
    penetration : float
        Delta, dimensionless.
    nodes : (L,) int array, optional
        Nodes per patch instead of `dense_nodes`; hold them fixed between states whose energies are compared.
    smooth_kernel : LayerKernel, optional
        Kernel that a layer adds to log|2 sin(x/2)|.

    Raises
    ------
    ValueError
        Patches overlap, or are not in order.
    """
    behind = np.append(left[1:], left[:1] + 2 * np.pi) - right
    if not (np.all(right > left) and np.all(behind > 0)):
        raise ValueError("left, right: patches must have positive widths and gaps, in order on the circle")
    waves = Waves.of(profile)
    nodes = dense_nodes(waves, left, right) if nodes is None else nodes
    radius = (right - left) / 2
    blocks = [slice(stop - n, stop) for n, stop in zip(nodes, np.cumsum(nodes), strict=True)]
    grids = [np.cos((np.arange(n) + 0.5) * np.pi / n) for n in nodes]
    x = np.concatenate([(a + b) / 2 + r * t for a, b, r, t in zip(left, right, radius, grids, strict=True)])
    kernel, slope = _kernel_and_slope(x, blocks, grids, radius)
    if smooth_kernel is not None:
        addition, addition_slope = smooth_kernel.matrices(x)
        kernel += addition
        slope += addition_slope
    factor = lu_factor(kernel, overwrite_a=True, check_finite=False)
    height_slope = waves.height(x, 1)
    target = waves.height(x) - waves.highest + penetration
    charges = lu_solve(factor, -np.pi * target, check_finite=False)
    motion, stretch, at_edge = _with_edges(blocks, grids, radius)
    # the matrix is the kernel itself, kernel y = -pi target, hence the factors -pi
    moved = motion * (slope @ charges)[:, None] - slope @ (motion * charges[:, None]) + stretch * charges[:, None]
    rhs = -np.pi * motion * height_slope[:, None] - moved
    solved = lu_solve(factor, np.column_stack([rhs, np.full(x.size, -np.pi)]), check_finite=False)

    scale = -np.sqrt(np.pi / np.tile(radius, 2))
    stress_intensity = scale * (at_edge @ charges)
    rates = scale[:, None] * (at_edge @ solved)
    jacobian = rates[:, :-1]
    same_patch = np.tile(np.eye(radius.size), (2, 2))
    jacobian -= same_patch * (stress_intensity / (4 * np.tile(radius, 2)))[:, None]
    totals = solved.sum(axis=0)
    series = tuple(_coefficients(charges[block] * (block.stop - block.start) / np.pi) for block in blocks)
    return DenseState(
        pressure=Pressure(left, right, series),
        penetration=penetration,
        stress_intensity=stress_intensity,
        stress_intensity_rate=rates[:, -1],
        stress_intensity_jacobian=jacobian,
        load=float(charges.sum()),
        load_rate=float(totals[-1]),
        load_jacobian=totals[:-1],
        elastic_energy=float(charges @ target) / 2,
    )


def _with_edges(
    blocks: list[slice], grids: list[FloatArray], radius: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return three matrices that link nodes and edges, (n, 2 L), (n, 2 L) and (2 L, n).

    The first holds the motion dx of every node as an edge moves outward by one, the second dr/r, the limit of the slope
    term on the diagonal.  The third gives q(-1) and q(+1) of every patch from the charges.
    """
    size, count = blocks[-1].stop, radius.size
    motion, stretch, at_edge = np.zeros((size, 2 * count)), np.zeros((size, 2 * count)), np.zeros((2 * count, size))
    for i, (block, t, r) in enumerate(zip(blocks, grids, radius, strict=True)):
        motion[block, i], motion[block, count + i] = (t - 1) / 2, (t + 1) / 2
        stretch[block, [i, count + i]] = 0.5 / r
        at_edge[i, block], at_edge[count + i, block] = _edge_rows(t.size)
    return motion, stretch, at_edge


def _kernel_and_slope(
    x: FloatArray, blocks: list[slice], grids: list[FloatArray], radius: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return log|2 sin((x_k - x_j)/2)| for charges, and 1/2 cot((x_k - x_j)/2) with a zero diagonal, (n, n) each."""
    half = np.subtract.outer(x, x) / 2
    np.fill_diagonal(half, np.pi / 2)
    slope = 0.5 / np.tan(half)
    kernel = np.log(np.abs(2 * np.sin(half)))
    np.fill_diagonal(slope, 0.0)
    for block, t, r in zip(blocks, grids, radius, strict=True):
        smooth = np.sinc(r * np.subtract.outer(t, t) / (2 * np.pi))
        kernel[block, block] = np.log(r * smooth) + _log_moments(t.size)
    return kernel, slope


def _log_moments(n: int) -> FloatArray:
    """Return int log|t_k - t'| (interpolant of charges) dt', (n, n): Chebyshev moments -pi log 2, -pi/m."""
    order = np.arange(n)
    values = np.cos(np.outer((order + 0.5) * np.pi / n, order))
    moment = np.full(n, -np.log(2.0))
    moment[1:] = -2.0 / order[1:]
    return np.asarray((values * moment) @ values.T)


def _coefficients(samples: FloatArray) -> FloatArray:
    """Return Chebyshev coefficients of samples at the n nodes, (n,), by the discrete orthogonality sum."""
    n = samples.size
    series = np.cos(np.outer(np.arange(n), (np.arange(n) + 0.5) * np.pi / n)) @ samples * (2 / n)
    series[0] /= 2
    return np.asarray(series)


def _edge_rows(n: int) -> FloatArray:
    """Return q(-1) and q(+1) of the interpolating polynomial from charges at n nodes, (2, n).

    Barycentric form: q(1) = (1/n) sum_k (-1)^k cot(theta_k / 2) q(t_k), charges are pi/n times q.
    """
    theta = (np.arange(n) + 0.5) * np.pi / n
    sign = (-1.0) ** np.arange(n)
    plus = sign / np.tan(theta / 2) / np.pi
    minus = plus[::-1]
    return np.stack([minus, plus])
