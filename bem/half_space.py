"""Periodic half-space kernel log|2 sin((x - x')/2)| between the nodes of all contact patches.

Between patches 2 sin((x - x')/2) = 2 (sin(x/2) cos(x'/2) - cos(x/2) sin(x'/2)) is one matrix product; within a patch
the logarithm is split into its exact Chebyshev moments and the smooth rest log r + log sinc(r (t - t')/2).
Dimensionless (x scaled by 1/q0).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bem.chebyshev import Basis

FloatArray = NDArray[np.float64]


def between_nodes(x: FloatArray) -> FloatArray:
    """log|2 sin((x_i - x_j)/2)| for all pairs, (n, n); the diagonal is zero and has no meaning."""
    sine, cosine = np.sin(x / 2), np.cos(x / 2)
    chord = 2 * np.stack([sine, cosine], axis=1) @ np.stack([cosine, -sine])
    np.fill_diagonal(chord, 1.0)
    np.abs(chord, out=chord)
    return np.asarray(np.log(chord, out=chord))


def within_patch(half_width: FloatArray, table: Basis) -> FloatArray:
    """Kernel blocks of patches that share one basis, acting on nodal charges, (n_patches, n, n)."""
    difference = np.subtract.outer(table.nodes, table.nodes)
    smooth = np.log(np.sinc(half_width[:, None, None] * (difference / (2 * np.pi))))
    return np.asarray(smooth + (np.log(half_width)[:, None, None] + table.log_moments))
