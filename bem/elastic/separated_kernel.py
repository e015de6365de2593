"""The half-space kernel between two arcs of the period as a short sum of products.

Two disjoint arcs are parted by two points beta and delta.  On either arc let u = log|sin((x - beta)/2) /
sin((x - delta)/2)| and m = log sqrt|sin((x - beta)/2) sin((x - delta)/2)|.  For x on the one and x' on the other,

    log|2 sin((x - x')/2)| = m(x) + m(x') + log 2 - log|sin((delta - beta)/2)| + log(2 cosh((u - u')/2)).

The last term is analytic in |Im u| < pi however close the arcs come to beta and delta, which only widens the interval
[-U, U] of u by the logarithm of the clearance.  It is a double Chebyshev series there, and its symmetric matrix of
coefficients has eigenvalues that fall like exp(-pi^2 k / (2 U)): the sum of products sign_k phi_k(u) phi_k(u') is
short.  As it is even in u - u', the phi_k are even or odd.  Addition theorem: of the sine.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.geometry.chebyshev import basis_nodes, coefficients

RANGE_STEP = 1.15  # speed: ratio of the half ranges U for which there are tables


@dataclass(frozen=True, eq=False)
class SeparatedKernel:
    """log|2 sin((x - x')/2)| = columns(x) core columns(x')^T for x and x' on different arcs.

    Attributes
    ----------
    columns : (n, q) array
        At the points of both arcs.
    core : (q, q) array
        Symmetric and its own inverse.
    """

    columns: FloatArray
    core: FloatArray


def separated_kernel(x: FloatArray, beta: float, delta: float, accuracy: float) -> SeparatedKernel:
    """The kernel between points of two arcs.

    Parameters
    ----------
    x : (n,) array
        Points of both arcs, not at beta or delta.
    beta, delta : float
        Points that part the arcs.
    accuracy : float
        Absolute, of the kernel.

    Examples
    --------
    >>> x = np.array([0.2, 0.9, 2.1, 4.0])
    >>> kernel = separated_kernel(x, 1.0, -0.1, 1e-12)
    >>> here, there = kernel.columns[:2], kernel.columns[2:]
    >>> error = here @ kernel.core @ there.T - np.log(np.abs(2 * np.sin(np.subtract.outer(x[:2], x[2:]) / 2)))
    >>> bool(np.abs(error).max() < 3e-12)
    True
    """
    u, m = _coordinates(x, beta, delta)
    low, high = float(u.min()), float(u.max())
    steps = int(np.ceil(np.log((high - low) / 2) / np.log(RANGE_STEP)))
    modes, _, core = modes_and_core(steps, accuracy)
    return SeparatedKernel(_columns(m, (u - (low + high) / 2) / RANGE_STEP**steps, modes), core)


def _coordinates(x: FloatArray, beta: float, delta: float) -> tuple[FloatArray, FloatArray]:
    """u of points of both arcs, and m with half of what is constant, (n,) each."""
    from_beta = np.log(np.abs(np.sin((x - beta) / 2)))
    from_delta = np.log(np.abs(np.sin((x - delta) / 2)))
    constant = np.log(2) - np.log(np.abs(np.sin((delta - beta) / 2)))
    return from_beta - from_delta, (from_beta + from_delta + constant) / 2


def _columns(m: FloatArray, t: FloatArray, modes: FloatArray) -> FloatArray:
    """Columns of m, of 1 and of the phi_k, which are Chebyshev series in t, (n, q)."""
    values = np.empty((m.size, 2 + modes.shape[1]))
    values[:, 0] = m
    values[:, 1] = 1.0
    np.matmul(_polynomials(t, modes.shape[0]).T, modes, out=values[:, 2:])
    return values


def _polynomials(t: FloatArray, count: int) -> FloatArray:
    """T_0 to T_(count - 1) at points of [-1, 1], (count, n): real parts of the powers of exp(i arccos t)."""
    powers = np.empty((count, t.size), dtype=np.complex128)
    powers[0] = 1.0
    powers[1:] = t + 1j * np.sqrt(np.maximum(1 - t * t, 0.0))
    np.multiply.accumulate(powers, axis=0, out=powers)
    return powers.real


@lru_cache(maxsize=256)
def modes_and_core(steps: int, accuracy: float) -> tuple[FloatArray, int, FloatArray]:
    """Chebyshev coefficients of the phi_k on [-U, U], U = RANGE_STEP^steps, (m, q - 2), and the core, (q, q).

    Between them the number of even phi_k, which come first.
    """
    half_range = RANGE_STEP**steps
    pole = np.pi / half_range
    decay = np.log(pole + np.hypot(1.0, pole))
    count = int(np.ceil(-np.log(accuracy) / decay)) + 8
    nodes = half_range * basis_nodes(count)
    difference = np.abs(np.subtract.outer(nodes, nodes))
    series = coefficients(coefficients(difference / 2 + np.log1p(np.exp(-difference))).T)
    modes, signs, sizes = np.zeros((count, count)), [], [0]
    for parity in (0, 1):
        block = series[parity::2, parity::2]
        values, vectors = np.linalg.eigh((block + block.T) / 2)
        kept = np.abs(values) > accuracy
        sizes.append(sizes[-1] + int(kept.sum()))
        modes[parity::2, sizes[-2] : sizes[-1]] = vectors[:, kept] * np.sqrt(np.abs(values[kept]))
        signs.append(np.sign(values[kept]))
    core = np.diag(np.concatenate([[0.0, 0.0], *signs]))
    core[0, 1] = core[1, 0] = 1.0
    return np.ascontiguousarray(modes[:, : sizes[2]]), sizes[1], core
