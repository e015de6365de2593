"""The lower face: its nodes in order, interpolation along it, and the profile carried by its nodes.

The displacement elements are polynomials of degree p on each facet of the face, given at p + 1 equally spaced nodes.
The profile enters through its values at the ends of a facet and its moments inside it,

    int (h_h - h) P_j dx = 0,     j = 0 .. p - 2    (P_j Legendre),

not through its values at the inner nodes: the work of a smooth pressure on what is left over is then of order 2 p
instead of p + 2 (Boole's rule), which is what limits P4 elements on a wide contact. The nodal values are fixed linear
functionals of h on the facet, so that their rate under a motion theta of the mesh is the same functional of h' theta.

Unit of length: the period.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from fem_reference.elasticity import Spaces
from fem_reference.problem import FloatArray, IntArray


@dataclass(frozen=True)
class FaceNodes:
    """Nodal values of the lower face in order of X.

    Parameters
    ----------
    index : IntArray, shape (n_facets * order + 1,)
        Indices among the values of a displacement component.
    x : FloatArray
        Their local coordinates.
    order : int
        Each facet carries order + 1 consecutive, equally spaced nodes.
    """

    index: IntArray
    x: FloatArray
    order: int


def face_nodes(spaces: Spaces) -> FaceNodes:
    """Return the nodes of the lower face, sorted."""
    x, y = spaces.displacement.doflocs
    index = np.flatnonzero(np.abs(y) < 1e-14)
    index = index[np.argsort(x[index])]
    return FaceNodes(index, x[index], spaces.order)


def newton_cotes(order: int) -> FloatArray:
    """Return the weights (order + 1,) of the closed rule on [0, 1] that is exact for the element's polynomials."""
    nodes = np.linspace(0.0, 1.0, order + 1)
    powers = np.arange(order + 1)
    return np.asarray(np.linalg.solve(nodes[None, :] ** powers[:, None], 1.0 / (powers + 1.0)))


def interpolate(x: FloatArray, nodes_x: FloatArray, values: FloatArray, order: int) -> FloatArray:
    """Evaluate a piecewise polynomial given at order + 1 equally spaced nodes per piece, at positions x inside.

    Examples
    --------
    >>> interpolate(np.array([0.25]), np.array([0.0, 0.5, 1.0]), np.array([0.0, 0.25, 1.0]), 2)
    array([0.0625])
    """
    ends = nodes_x[::order]
    piece = np.clip(np.searchsorted(ends, x, side="right") - 1, 0, len(ends) - 2)
    t = (x - ends[piece]) / (ends[piece + 1] - ends[piece]) * order
    result = np.zeros(np.shape(x))
    for k in range(order + 1):
        basis = np.ones(np.shape(x))
        for j in range(order + 1):
            if j != k:
                basis = basis * (t - j) / (k - j)
        result += basis * values[piece * order + k]
    return result


def nodal_profile(nodes: FaceNodes, function: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return the nodal values (n_face,) that carry a function: exact at the ends of each facet, its moments inside.

    Parameters
    ----------
    nodes : FaceNodes
    function : callable
        From local coordinates X of any shape to values of that shape.

    Examples
    --------
    >>> nodes = FaceNodes(np.arange(3), np.array([0.0, 0.5, 1.0]), 2)
    >>> nodal_profile(nodes, lambda x: x**3).round(12)  # the mean of x^3 is 1/4: (0 + 4 v + 1) / 6 = 1/4
    array([0.   , 0.125, 1.   ])
    """
    p = nodes.order
    ends = nodes.x[::p]
    t, shapes, moments = _moments(p)
    at_ends = function(ends)
    inside = function(ends[:-1, None] + np.diff(ends)[:, None] * t)
    rest = inside - at_ends[:-1, None] * shapes[0] - at_ends[1:, None] * shapes[-1]
    inner = np.linalg.solve(moments @ shapes[1:-1].T, moments @ rest.T).T
    values = np.empty(len(nodes.x))
    values[::p] = at_ends
    for k in range(1, p):
        values[k::p] = inner[:, k - 1]
    return values


@cache
def _moments(order: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return Gauss points (n,) on [0, 1], shape functions (order + 1, n), and weights of moments (order - 1, n)."""
    gauss, weights = np.polynomial.legendre.leggauss(order + 4)
    t = 0.5 * (gauss + 1.0)
    shapes = np.array([interpolate(t, np.linspace(0.0, 1.0, order + 1), row, order) for row in np.eye(order + 1)])
    return t, shapes, np.polynomial.legendre.legvander(gauss, order - 2).T * weights
