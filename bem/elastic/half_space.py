"""Periodic half-space kernel log|2 sin((x - x')/2)| between the nodes of all contact patches.

Between patches 2 sin((x - x')/2) = 2 (sin(x/2) cos(x'/2) - cos(x/2) sin(x'/2)) is one matrix product; within a patch
the logarithm is split into its exact Chebyshev moments and the smooth rest log r + log sinc(r (t - t')/2).
Dimensionless (x scaled by 1/q0).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.geometry.chebyshev import Basis, basis_nodes

TERMS, WIDEST_SERIES = 8, 0.4  # derived: of log sinc; (0.4 / pi)^18 / 9 = 1e-17
LARGEST_SERIES = 96  # speed: nodes; tables of more are not kept


def log_chord(x: FloatArray, sources: FloatArray) -> FloatArray:
    """log|2 sin((x_i - x'_j)/2)|, (n, m); -inf where a point is a source."""
    points = 2 * np.stack([np.sin(x / 2), np.cos(x / 2)], axis=1)
    chord = points @ np.stack([np.cos(sources / 2), -np.sin(sources / 2)])
    np.abs(chord, out=chord)
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(chord, out=chord))


def between_nodes(x: FloatArray) -> FloatArray:
    """log|2 sin((x_i - x_j)/2)| for all pairs, (n, n); the diagonal is zero and has no meaning."""
    kernel = log_chord(x, x)
    np.fill_diagonal(kernel, 0.0)
    return kernel


def within_patch(half_width: FloatArray, table: Basis) -> FloatArray:
    """Kernel blocks of patches that share one basis, acting on nodal charges, (n_patches, n, n).

    log sinc(r (t - t')/2) is a power series in r^2 for narrow patches, so that all blocks are one matrix product.
    """
    size = table.nodes.size
    if size <= LARGEST_SERIES and half_width.max() <= WIDEST_SERIES:
        powers = half_width[:, None] ** (2.0 * np.arange(1, TERMS + 1))
        blocks = powers @ _log_sinc_terms(size)
    else:
        difference = np.subtract.outer(table.nodes, table.nodes)
        blocks = np.log(np.sinc(half_width[:, None] * (difference.ravel() / (2 * np.pi))))
    blocks += np.log(half_width)[:, None]
    blocks += table.log_moments.ravel()
    return np.asarray(blocks.reshape(-1, size, size))


@lru_cache(maxsize=64)
def _log_sinc_terms(size: int) -> FloatArray:
    """Terms of log(sin y / y) = -sum_k zeta(2 k) (y / pi)^(2 k) / k, y = r (t - t')/2, less r^(2 k): one a row."""
    from scipy.special import zeta  # which the kernels in C do without

    nodes = basis_nodes(size)
    square = (np.subtract.outer(nodes, nodes).ravel() / (2 * np.pi)) ** 2
    order = np.arange(1, TERMS + 1)
    return np.asarray(-(zeta(2.0 * order) / order)[:, None] * square ** order[:, None])
