"""Plane-strain elasticity of the layer in mixed displacement-pressure form, element by element.

For every nu in (-1, 1/2] the stress is split into its deviator and the hydrostatic pressure p = -k tr(eps) (k the bulk
modulus; Hughes, The Finite Element Method, 1987, sec. 4.4; Herrmann, AIAA J. 3 (1965) 1896, doi:10.2514/3.3277), and

    int 2 mu (eps : eps(v) - tr(eps) tr(eps(v)) / 3) - p div v = 0,       -int q div u - (1/k) int p q = 0.

Both blocks keep their sign down to nu = -1 and at nu = 1/2, where 1/k = 0. Elements are Taylor-Hood: P4/P3 or P2/P1.
The unknowns are the scalar nodal values of u_x (n), u_y (n) and p (m) in this order. Constraints are imposed by a
sparse matrix T, u = T z + lift: the plate is held, values on both sides of the seam are one, and all contact values
of u_y share one unknown, the plate's displacement, whose equation says what load the contact carries. That row makes
the problem regular for every nu, an incompressible layer in full contact included.

Units: lengths in periods, moduli in E, displacements in any common unit.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from skfem import Basis, ElementTriP1, ElementTriP2, ElementTriP3, ElementTriP4
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from fem_reference.problem import BoolArray, FloatArray, IntArray, InvalidProblemError


@dataclass(frozen=True)
class Spaces:
    """Scalar finite element spaces on a mesh: one for each displacement component, one for the pressure."""

    displacement: Any
    pressure: Any
    order: int

    @property
    def sizes(self) -> tuple[int, int]:
        """Number of nodal values (n, m) of one displacement component and of the pressure."""
        return int(self.displacement.N), int(self.pressure.N)


ELEMENTS = {2: (ElementTriP2, ElementTriP1), 4: (ElementTriP4, ElementTriP3)}


def taylor_hood(triangles: Any, order: int, quadrature_order: int | None = None) -> Spaces:
    """Return P2/P1 (order 2) or P4/P3 (order 4) spaces on a triangle mesh.

    The quadrature is exact for the stiffness by default.
    """
    degree = 2 * order - 2 if quadrature_order is None else quadrature_order
    displacement, pressure = (Basis(triangles, element(), intorder=degree) for element in ELEMENTS[order])
    return Spaces(displacement, pressure, order)


@dataclass(frozen=True)
class Stiffness:
    """Symmetric saddle matrix over (u_x, u_y, p), element by element.

    Parameters
    ----------
    dofs : IntArray, shape (n_elements, k)
        Nodal values of each element, among all 2 n + m.
    elements : FloatArray, shape (n_elements, k, k)
    pressure_mass : FloatArray, shape (n_elements, l, l)
        Mass matrices of the pressures, the last l of each element.
    size : int
        2 n + m.
    """

    dofs: IntArray
    elements: FloatArray
    pressure_mass: FloatArray
    size: int

    def times(self, fields: FloatArray) -> FloatArray:
        """Multiply fields (n_fields, 2 n + m) by the matrix; return an array of their shape."""
        force = (self.elements @ fields.T[self.dofs]).reshape(-1, len(fields))
        return np.array([np.bincount(self.dofs.ravel(), column, self.size) for column in force.T])

    @property
    def matrix(self) -> csr_matrix:
        """The matrix of all nodal values."""
        rows, columns = np.broadcast_arrays(self.dofs[:, :, None], self.dofs[:, None, :])
        entries = self.elements.ravel(), (rows.ravel(), columns.ravel())
        return coo_matrix(entries, shape=(self.size, self.size)).tocsr()


@lru_cache(maxsize=2)
def _reference_integrals(order: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return integrals over the reference triangle.

    They are of products of derivatives, of derivatives times pressures, and of products of pressures.
    """
    points, weights = get_quadrature(RefTri, 2 * order - 2)
    displacement, pressure = (element() for element in ELEMENTS[order])
    gradient = np.array([displacement.lbasis(points, i)[1] for i in range(displacement.doflocs.shape[0])])
    value = np.array([pressure.lbasis(points, i)[0] for i in range(pressure.doflocs.shape[0])])
    return (
        np.einsum("arq,bsq,q->rsab", gradient, gradient, weights),
        np.einsum("arq,bq,q->rab", gradient, value, weights),
        np.einsum("aq,bq,q->ab", value, value, weights),
    )


def assemble(spaces: Spaces, shear_modulus: float, inverse_bulk_modulus: float) -> Stiffness:
    """Return the matrices of all elements.

    Sides are straight, so that each matrix is a sum of those of the reference triangle.

    Parameters
    ----------
    spaces : Spaces
    shear_modulus, inverse_bulk_modulus : float
        In units of E and 1/E.
    """
    V, Q = spaces.displacement, spaces.pressure
    area, x, y = _shapes(V.mesh, slice(None))
    scale, along = area[:, None, None], area[:, None]
    coefficients = Coefficients(
        scale * _outer(x, x), scale * _outer(y, y), scale * _outer(x, y), along * x, along * y, scale
    )
    dofs = np.concatenate([V.element_dofs, V.N + V.element_dofs, 2 * V.N + Q.element_dofs]).T
    return Stiffness(
        np.ascontiguousarray(dofs),
        _combined(spaces.order, shear_modulus, inverse_bulk_modulus, coefficients),
        scale * _reference_integrals(spaces.order)[2],
        2 * V.N + Q.N,
    )


def moved_elements(
    spaces: Spaces, shear_modulus: float, inverse_bulk_modulus: float, chosen: IntArray, motion: FloatArray
) -> FloatArray:
    """Differentiate the matrices of some elements with respect to a motion of the vertices in x, (n_chosen, k, k).

    With X_x and X_y the derivatives of reference coordinates, they are dX_x = -X_x theta_x and dX_y = -X_x theta_y,
    and the area grows by theta_x.

    Parameters
    ----------
    spaces : Spaces
    shear_modulus, inverse_bulk_modulus : float
    chosen : IntArray, shape (n_chosen,)
        Elements.
    motion : FloatArray, shape (n_vertices,)
        theta.
    """
    mesh = spaces.displacement.mesh
    area, x, y = _shapes(mesh, chosen)
    corners = motion[mesh.t[:, chosen]]
    rise = (corners[1:] - corners[0]).T
    along, across = ((area * np.sum(to * rise, axis=1))[:, None] for to in (x, y))  # area times theta_x and theta_y
    stretched, sheared, xx = along[:, :, None], across[:, :, None], _outer(x, x)
    coefficients = Coefficients(
        xx=-stretched * xx,
        yy=stretched * _outer(y, y) - sheared * (_outer(x, y) + _outer(y, x)),
        xy=-sheared * xx,
        x=0.0 * x,
        y=along * y - across * x,
        area=stretched,
    )
    return _combined(spaces.order, shear_modulus, inverse_bulk_modulus, coefficients)


@dataclass(frozen=True)
class Coefficients:
    """Products of the derivatives of reference coordinates by x and y, times the area, or derivatives of all these.

    `xx`, `yy`, `xy` are (n_elements, 2, 2), `x` and `y` (n_elements, 2), `area` (n_elements, 1, 1).
    """

    xx: FloatArray
    yy: FloatArray
    xy: FloatArray
    x: FloatArray
    y: FloatArray
    area: FloatArray


def _shapes(mesh: Any, chosen: IntArray | slice) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return twice the area of elements, (n,), and dX_r / dx and dX_r / dy, (n, 2) each."""
    corners = mesh.p[:, mesh.t[:, chosen]]
    sides = (corners[:, 1:] - corners[:, :1]).transpose(2, 0, 1)  # dx_i / dX_r
    x, y = np.linalg.inv(sides).transpose(2, 0, 1)
    return np.abs(np.linalg.det(sides)), x, y


def _outer(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return products (n, 2, 2) of vectors (n, 2)."""
    return np.asarray(first[:, :, None] * second[:, None, :])


def _combined(order: int, shear_modulus: float, inverse_bulk_modulus: float, given: Coefficients) -> FloatArray:
    """Return the matrices (n_elements, k, k): sums of those of the reference triangle, each times one coefficient."""
    parts = _parts(order, shear_modulus, inverse_bulk_modulus)
    count = len(given.area)
    each = (given.xx, given.yy, given.xy, given.x, given.y, given.area)
    coefficients = np.concatenate([one.reshape(count, -1) for one in each], axis=1)
    return np.asarray((coefficients @ parts.reshape(len(parts), -1)).reshape(count, *parts.shape[1:]))


@lru_cache(maxsize=4)
def _parts(order: int, shear_modulus: float, inverse_bulk_modulus: float) -> FloatArray:
    """Return the factor of every coefficient of an element, in the order of `Coefficients`, (17, k, k)."""
    products, divergence, masses = _reference_integrals(order)
    v, two_mu = products.shape[2], 2.0 * shear_modulus
    k = 2 * v + len(masses)
    first, second, third = slice(0, v), slice(v, 2 * v), slice(2 * v, None)
    xx, yy, xy = np.zeros((3, 2, 2, k, k))
    xx[:, :, first, first] = yy[:, :, second, second] = two_mu * 2.0 / 3.0 * products
    xx[:, :, second, second] = yy[:, :, first, first] = two_mu * 0.5 * products
    xy[:, :, first, second] = two_mu * (0.5 * products.swapaxes(0, 1) - products / 3.0)
    x, y, area = np.zeros((2, k, k)), np.zeros((2, k, k)), np.zeros((1, k, k))
    x[:, first, third] = y[:, second, third] = -divergence
    for block in (xy, x, y):
        block += block.swapaxes(-1, -2).copy()
    area[0, third, third] = -inverse_bulk_modulus * masses
    return np.concatenate([one.reshape(-1, k, k) for one in (xx, yy, xy, x, y, area)])


def _representatives(basis: Any) -> IntArray:
    """Return the index (n,) of the periodic partner of every nodal value: at X = 1 the one at X = 0, else itself."""
    x, y = basis.doflocs
    left, right = (np.flatnonzero(np.abs(x - end) < 1e-12) for end in (0.0, 1.0))
    left, right = left[np.argsort(y[left])], right[np.argsort(y[right])]
    if len(left) != len(right) or np.max(np.abs(y[left] - y[right])) > 1e-10:
        raise InvalidProblemError("mesh", "the two sides of the seam do not carry the same vertices")
    same = np.arange(basis.N)
    same[right] = left
    return same


@dataclass(frozen=True)
class Constraints:
    """The map u = T z + lift from free unknowns to nodal values.

    Parameters
    ----------
    matrix : csr_matrix, shape (2 n + m, n_free)
        T; its last column is the common displacement of the contact.
    contact : IntArray, shape (n_contact,)
        Indices among the n values of a displacement component on the contact, seam values once.
    contact_values : IntArray
        The same with the far side of the seam included.
    """

    matrix: csr_matrix
    contact: IntArray
    contact_values: IntArray
    same: IntArray


def constrain(spaces: Spaces, depth: float, in_contact: Callable[[FloatArray], BoolArray]) -> Constraints:
    """Hold the plate, join the seam, tie the contact.

    Parameters
    ----------
    spaces : Spaces
    depth : float
        y of the plate.
    in_contact : callable
        From local coordinates X (n,) to booleans (n,).
    """
    V, Q = spaces.displacement, spaces.pressure
    n, m = spaces.sizes
    x, y = V.doflocs
    same, same_pressure = _representatives(V), _representatives(Q)
    plate = np.abs(y - depth) < 1e-10 * max(1.0, depth)
    tied = (np.abs(y) < 1e-14) & in_contact(x)
    tied |= tied[same]
    own = same == np.arange(n)
    kinds = np.concatenate([own & ~plate, own & ~plate & ~tied, same_pressure == np.arange(m)])
    free = np.flatnonzero(kinds)
    number = np.full(2 * n + m, -1)
    number[free] = np.arange(len(free))
    number[:n] = number[:n][same]
    number[n : 2 * n] = number[n : 2 * n][same]
    number[2 * n :] = number[2 * n :][same_pressure]
    number[n : 2 * n][tied] = len(free)
    rows = np.flatnonzero(number >= 0)
    matrix = coo_matrix((np.ones(len(rows)), (rows, number[rows])), shape=(2 * n + m, len(free) + 1)).tocsr()
    contact = np.flatnonzero(tied & own)
    return Constraints(matrix, contact, np.flatnonzero(tied), same)
