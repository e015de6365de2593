"""Second route: a Volterra integral equation for the flux through the barrier, no grid in stress.

A path that is beyond the barrier at V must have crossed it at some U <= V; from the crossing point it is beyond at V
with the probability N.  With D = sigma_0 + a the distance of the barrier and dF = -dA the share absorbed,

    N(-D(V) / sqrt V) = int_0^V N(-(D(V) - D(U)) / sqrt(V - U)) dF(U),    N the normal distribution function,

an equation of the first kind whose kernel is 1/2 on the diagonal, hence well posed.  The flux is constant in each cell,
the equation holds at each node (with the barrier just below it), and the kernel of a cell is that of its middle; in the
cells next to the diagonal its argument is scaled so that a barrier of constant speed is integrated exactly to first
order in the square root.  A barrier may jump away from the mean, as it does between lines, but not towards it.

Source: R. Fortet, J. Math. Pures Appl. 22 (1943) 177; G. Peskir, J. Integral Equations Appl. 14 (2002) 397.
Stresses in units of E*, V in E*^2.  Limits: dense, cost n^2.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import ndtr

from persson.mathematics.arrays import FloatArray

OUTRUN = 1e-15  # of the kernel, 1/2 for a barrier at rest: below, the barrier outruns all paths, none is absorbed
NEAR = 12  # cells next to the diagonal whose square root is averaged


def survival(load: float, variance: FloatArray, barrier: FloatArray, barrier_inside: FloatArray) -> FloatArray:
    """Return A/A0 at the nodes for one load.

    Parameters
    ----------
    load : float
        sigma_0 / E* > 0.
    variance : (n + 1,) array
        V at the nodes, increasing from 0.
    barrier : (n + 1,) array
        a just below the nodes.
    barrier_inside : (n,) array
        a in the middle of the cells.

    Examples
    --------
    >>> nodes = np.concatenate([[0.0], np.geomspace(0.01, 1.0, 400)])
    >>> area = survival(1.0, nodes, np.full(401, 0.5), np.full(400, 0.5))
    >>> bool(abs(area[-1] - (2 * ndtr(1.5) - 1)) < 1e-12)
    True
    """
    end, middle = variance[1:], (variance[1:] + variance[:-1]) / 2
    distance = load + barrier[1:]
    lag = end[:, None] - middle[None, :]
    later = lag > 0
    argument = barrier_inside[None, :] - barrier[1:, None]
    argument /= np.sqrt(lag, out=np.ones_like(lag), where=later)
    for offset in range(min(NEAR, end.size)):
        row = np.arange(offset, end.size)
        column = row - offset
        far, near = end[row] - variance[column], end[row] - variance[column + 1]
        near = np.maximum(near, 0.0)
        mean_root = 2 / 3 * (far**1.5 - near**1.5) / (far - near)
        argument[row, column] *= mean_root / np.sqrt((far + near) / 2)
    kernel, beyond = np.tril(ndtr(argument)), ndtr(-distance / np.sqrt(end))
    fled = np.diagonal(kernel) < OUTRUN
    kernel[fled] = np.eye(end.size)[fled]
    absorbed = solve_triangular(kernel, np.where(fled, 0.0, beyond), lower=True, check_finite=False)
    return np.concatenate([[1.0], 1 - np.cumsum(absorbed)])
