"""Half-space kernel between two arcs of the period as a short sum of products.

Two disjoint arcs are parted by two points beta and delta.  On either arc let u = log|sin((x - beta)/2) /
sin((x - delta)/2)| and m = log sqrt|sin((x - beta)/2) sin((x - delta)/2)|.  For x on the one and x' on the other,

    log|2 sin((x - x')/2)| = m(x) + m(x') + log 2 - log|sin((delta - beta)/2)| + log(2 cosh((u - u')/2)).

The last term is analytic in |Im u| < pi however close the arcs come to beta and delta, which only widens the interval
[-U, U] of u by the logarithm of the clearance.  It is a double Chebyshev series there, and its symmetric matrix of
coefficients has eigenvalues that fall like exp(-pi^2 k / (2 U)): the sum of products sign_k phi_k(u) phi_k(u') is
short.  As it is even in u - u', the phi_k are even or odd.  The columns m, 1 and phi_k(u), and the cut in two arcs,
stand in bem/kernels/clusters.pyx.  Addition theorem: of the sine.  Dimensionless.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.geometry.chebyshev import basis_nodes, coefficients

RANGE_STEP = 1.15  # speed: ratio of the half ranges U for which there are tables


def range_steps(half_range: float) -> int:
    """Return the least power of RANGE_STEP that is not below a half range of u."""
    return math.ceil(math.log(half_range) / math.log(RANGE_STEP))


@lru_cache(maxsize=256)
def modes_and_core(steps: int, accuracy: float) -> tuple[FloatArray, int, FloatArray]:
    """Return Chebyshev coefficients of the phi_k on [-U, U], (m, q - 2), the number of even ones, and the core, (q, q).

    U = RANGE_STEP^steps.  The even phi_k come first.
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
        large = np.abs(values) > accuracy
        sizes.append(sizes[-1] + int(large.sum()))
        modes[parity::2, sizes[-2] : sizes[-1]] = vectors[:, large] * np.sqrt(np.abs(values[large]))
        signs.append(np.sign(values[large]))
    core = np.diag(np.concatenate([[0.0, 0.0], *signs]))
    core[0, 1] = core[1, 0] = 1.0
    return np.ascontiguousarray(modes[:, : sizes[2]]), sizes[1], core
