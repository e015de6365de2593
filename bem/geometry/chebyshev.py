"""Chebyshev tools on [-1, 1]: nodes, transforms, logarithmic moments, and how many nodes are enough.

The pressure on a patch is q(t) / sqrt(1 - t^2) with q = sum_n Q_n T_n.  The logarithm is diagonal in T_n:

    int log|t - t'| T_n(t') / sqrt(1 - t'^2) dt' = -pi log 2 (n = 0),  -(pi/n) T_n(t) (n >= 1),

(Mason and Handscomb, Chebyshev Polynomials, 2003, theorem 9.2 integrated once).  Nodes are those of the
first kind, t_k = cos((k + 1/2) pi / n), with equal weights pi/n.

The two rules at the end are empirical beyond their leading terms: the leading term is Nyquist's density in
the middle of a Chebyshev grid, or the decay rate of a Bernstein ellipse; the rest was measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray

SMALL_TRANSFORM = 256  # speed: nodes up to which a matrix is the faster transform (measured)


@dataclass(frozen=True, eq=False)
class Basis:
    """Tables for n Gauss-Chebyshev nodes.

    Attributes
    ----------
    nodes : (n,) array
        t_k, decreasing.
    values : (n, n) array
        T_j(t_k) as values[k, j].
    log_moments : (n, n) array
        Logarithmic moment matrix for nodal charges y_k = (pi/n) q(t_k), truncated to n modes:
        int log|t - t'| q(t') / sqrt(1 - t'^2) dt' at t_k is (log_moments @ y)_k.
    at_edges, slopes_at_edges : (2, n) arrays
        Rows give q(-1) and q(+1), and sum n^2 (+-1)^n Q_n, from nodal charges.
    packed : (5 n + 2 n^2,) array
        nodes, at_edges, slopes_at_edges, values and log_moments, which are views of it.
    """

    nodes: FloatArray
    values: FloatArray
    log_moments: FloatArray
    at_edges: FloatArray
    slopes_at_edges: FloatArray
    packed: FloatArray


@lru_cache(maxsize=256)
def basis(n: int) -> Basis:
    """Return the tables for n nodes; computed once for each n.

    Examples
    --------
    >>> table = basis(4)
    >>> charges = np.pi / 4 * table.values[:, 2]            # q = T_2
    >>> bool(np.allclose(table.log_moments @ charges, -np.pi / 2 * table.values[:, 2]))
    True
    """
    angle = (np.arange(n) + 0.5) * np.pi / n
    order = np.arange(n)
    values = _polynomials(n)
    weight = np.where(order == 0, 1.0, 2.0) / np.pi
    moment = np.concatenate([[-np.pi * np.log(2)], -np.pi / order[1:]])
    signs = np.stack([(-1.0) ** order, np.ones(n)])
    at_edges = (signs * weight) @ values.T
    slopes = (signs * weight * order**2) @ values.T
    moments = (values * (weight * moment)) @ values.T
    packed = np.concatenate([np.cos(angle), at_edges.ravel(), slopes.ravel(), values.ravel(), moments.ravel()])
    nodes, at_edges, slopes, values, moments = np.split(packed, [n, 3 * n, 5 * n, (5 + n) * n])
    square, rows = (n, n), (2, n)
    return Basis(
        nodes, values.reshape(square), moments.reshape(square), at_edges.reshape(rows), slopes.reshape(rows), packed
    )


@lru_cache(maxsize=512)
def basis_nodes(n: int) -> FloatArray:
    """Return the n nodes alone, (n,), for sizes at which the tables of `basis` are not needed."""
    return np.cos((np.arange(n) + 0.5) * np.pi / n)


def coefficients(samples: FloatArray) -> FloatArray:
    """Return the Chebyshev coefficients of samples at the nodes along the last axis, shape of `samples`.

    Examples
    --------
    >>> bool(np.allclose(coefficients(basis(4).nodes), [0, 1, 0, 0]))
    True
    """
    n = samples.shape[-1]
    if n <= SMALL_TRANSFORM:
        return np.asarray(samples @ _transform(n))
    from scipy.fft import dct  # loaded where a patch has that many nodes

    series: FloatArray = dct(samples, type=2, axis=-1) / n
    series[..., 0] /= 2
    return series


@lru_cache(maxsize=SMALL_TRANSFORM)
def _transform(n: int) -> FloatArray:
    """Return the matrix of `coefficients`, applied from the right, (n, n): faster than FFT where n is small."""
    return _polynomials(n) * (np.where(np.arange(n) == 0, 1, 2) / n)


def _polynomials(n: int) -> FloatArray:
    """Return T_j(t_k) as [k, j], (n, n), to 1.1e-16: cos(i pi / (2 n)), i whole, by the sine of the rest to pi/2."""
    order = np.arange(n)
    i = np.multiply.outer(2 * order + 1, order) % (4 * n)
    return np.asarray(np.sin((n - np.minimum(i, 4 * n - i)) * (np.pi / (2 * n))))


def profile_nodes(width: FloatArray, max_order: int) -> FloatArray:
    """Return the number of nodes that resolve harmonics up to `max_order` on patches of width `width`, (L,).

    Widths are dimensionless.  With kappa = width * max_order / 2 the number is 1.15 kappa + 3 kappa^(1/3) + 12.
    kappa is Nyquist's limit, kappa^(1/3) the width of the transition of the Bessel functions J_n(kappa) to zero.
    """
    kappa = width * (max_order / 2)
    return np.asarray(1.15 * kappa + 3.0 * np.cbrt(kappa) + 12.0)


def coupling_modes(width: FloatArray, clearance: FloatArray, tolerance: float) -> FloatArray:
    """Return the number of modes of a patch that feel the other patches to `tolerance`, (L,).

    The field of a neighbour at distance `clearance` is analytic in the Bernstein ellipse with
    rho = 1 + z + sqrt(z (2 + z)), z = 2 clearance / width, and its coefficients decay as rho^-n.
    """
    z = 2 * clearance / width
    return np.asarray(-np.log(tolerance) / np.log1p(z + np.sqrt(z * (2 + z))) + 2.0)


@lru_cache(maxsize=4)
def size_ladder(ratio: float) -> IntArray:
    """Return the sizes that numbers are rounded up to, in steps of at most `ratio` above 16."""
    sizes = [4, 6, 8]
    while sizes[-1] < 1_000_000_000:
        sizes.append(max(sizes[-1] + 2, int(sizes[-1] * ratio)))
    return np.array(sizes)


def rounded_up(number: FloatArray, ratio: float) -> IntArray:
    """Round sizes up to a short list, in steps of at most `ratio` (above 16), so that equal sizes can be batched."""
    ladder = size_ladder(ratio)
    return ladder[np.searchsorted(ladder, number)]


def nodes_of(sizes: IntArray) -> FloatArray:
    """Return the Chebyshev nodes of patches of given sizes, (L,), one after the other, (sum of sizes,)."""
    return np.concatenate([basis_nodes(size) for size in sizes.tolist()])


@lru_cache(maxsize=512)
def _packed_nodes(n: int) -> FloatArray:
    """Return the nodes and, up to `SMALL_TRANSFORM` of them, the matrix of `coefficients`, (n,) or (n + n^2,)."""
    matrix = _transform(n).ravel() if n <= SMALL_TRANSFORM else np.empty(0)
    return np.concatenate([basis_nodes(n), matrix])


def packed_bases(sizes: IntArray) -> tuple[FloatArray, IntArray]:
    """Return the tables of `basis` for all sizes in one array, and the start of the table of each patch, (L,).

    A table is nodes, edge values, edge slopes, values and logarithmic moments, one behind the other, (5 n + 2 n^2,).
    """
    return _packed(sizes.tobytes(), True)


def packed_nodes(sizes: IntArray) -> tuple[FloatArray, IntArray]:
    """Return nodes and matrices of `coefficients` for all sizes in one array, and the start of each patch."""
    return _packed(sizes.tobytes(), False)


@lru_cache(maxsize=64)  # of one state these tables are asked for three times
def _packed(sizes: bytes, whole: bool) -> tuple[FloatArray, IntArray]:
    every = np.frombuffer(sizes, np.int64).tolist()
    tables, places = _joined(tuple(sorted(set(every))), whole)
    return tables, np.array([places[size] for size in every])


@lru_cache(maxsize=16)
def _joined(sizes: tuple[int, ...], whole: bool) -> tuple[FloatArray, dict[int, int]]:
    """Return the tables of given sizes in one array, and the start of each."""
    tables = [basis(size).packed if whole else _packed_nodes(size) for size in sizes]
    starts = np.cumsum([0, *(table.size for table in tables[:-1])])
    return np.concatenate(tables), dict(zip(sizes, starts.tolist(), strict=True))
