"""Plane-strain elasticity of the layer in mixed displacement-pressure form, assembled and factorised.

For every nu in (-1, 1/2] the stress is split into its deviator and the hydrostatic pressure p = -k tr(eps) (k the bulk
modulus; Hughes, The Finite Element Method, 1987, sec. 4.4; Herrmann, AIAA J. 3 (1965) 1896, doi:10.2514/3.3277), and

    int 2 mu (eps : eps(v) - tr(eps) tr(eps(v)) / 3) - p div v = 0,       -int q div u - (1/k) int p q = 0.

Both blocks keep their sign down to nu = -1 and at nu = 1/2, where 1/k = 0. Elements are Taylor-Hood: P4/P3 or P2/P1.
The unknowns are the scalar nodal values of u_x (n), u_y (n) and p (m) in this order. Constraints are imposed by a
sparse matrix T, u = T z + lift: the plate is held, values on both sides of the seam are one, and all contact values
of u_y share one unknown, the plate's displacement, whose equation says what load the contact carries. That row makes
the problem regular for every nu, an incompressible layer in full contact included.

The matrix is quasi-definite, so it is factorised without pivoting (symmetric minimum-degree ordering: several times
cheaper). A nearly incompressible layer leaves the pressure block tiny: then a small multiple of the pressure mass
matrix is added for the factorisation alone and the solution is refined iteratively on the true matrix.  So it is with
the factors of a mesh whose edges lie elsewhere by little.

Units: lengths in periods, moduli in E, displacements in any common unit.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import bmat, coo_matrix, csc_matrix, csr_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementTriP1, ElementTriP2, ElementTriP3, ElementTriP4

from fem_reference.problem import BoolArray, FloatArray, IntArray, InvalidProblemError

REGULARISED_BELOW = 1e-2  # inverse bulk modulus (1/E) below which the factorisation needs help
REGULARISATION = 1e-5  # of the pressure mass matrix, for the factorisation only
REFINEMENTS = 8
RESIDUAL = 1e-11  # relative residual that must be reached on the true matrix


class SingularSystemError(RuntimeError):
    """The linear system could not be solved to its residual tolerance."""


@BilinearForm  # type: ignore[untyped-decorator]
def _dxx(u: Any, v: Any, _: Any) -> Any:
    return u.grad[0] * v.grad[0]


@BilinearForm  # type: ignore[untyped-decorator]
def _dyy(u: Any, v: Any, _: Any) -> Any:
    return u.grad[1] * v.grad[1]


@BilinearForm  # type: ignore[untyped-decorator]
def _dxy(u: Any, v: Any, _: Any) -> Any:
    return u.grad[1] * v.grad[0]  # rows: d/dx, columns: d/dy


@BilinearForm  # type: ignore[untyped-decorator]
def _mass(u: Any, v: Any, _: Any) -> Any:
    return u * v


@BilinearForm  # type: ignore[untyped-decorator]
def _divergence_x(u: Any, q: Any, _: Any) -> Any:
    return u.grad[0] * q


@BilinearForm  # type: ignore[untyped-decorator]
def _divergence_y(u: Any, q: Any, _: Any) -> Any:
    return u.grad[1] * q


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


def taylor_hood(triangles: Any, order: int, quadrature_order: int | None = None) -> Spaces:
    """P2/P1 (order 2) or P4/P3 (order 4) spaces on a triangle mesh; quadrature exact for the stiffness by default."""
    elements = {2: (ElementTriP2, ElementTriP1), 4: (ElementTriP4, ElementTriP3)}[order]
    degree = 2 * order - 2 if quadrature_order is None else quadrature_order
    displacement, pressure = (Basis(triangles, element(), intorder=degree) for element in elements)
    return Spaces(displacement, pressure, order)


@dataclass(frozen=True)
class Stiffness:
    """Symmetric saddle matrix over (u_x, u_y, p) and the pressure mass matrix on the same unknowns."""

    matrix: csr_matrix
    pressure_mass: csr_matrix


def assemble(spaces: Spaces, shear_modulus: float, inverse_bulk_modulus: float) -> Stiffness:
    """Assemble the mixed form.

    Parameters
    ----------
    spaces : Spaces
    shear_modulus, inverse_bulk_modulus : float
        In units of E and 1/E.
    """
    V, Q = spaces.displacement, spaces.pressure
    dxx, dyy, dxy = _dxx.assemble(V), _dyy.assemble(V), _dxy.assemble(V)
    mass = _mass.assemble(Q)
    bx, by = _divergence_x.assemble(V, Q), _divergence_y.assemble(V, Q)
    two_mu = 2.0 * shear_modulus
    axx = two_mu * (2.0 / 3.0 * dxx + 0.5 * dyy)
    ayy = two_mu * (2.0 / 3.0 * dyy + 0.5 * dxx)
    axy = two_mu * (0.5 * dxy.T - dxy / 3.0)
    matrix = bmat([[axx, axy, -bx.T], [axy.T, ayy, -by.T], [-bx, -by, -inverse_bulk_modulus * mass]], format="csr")
    n = V.N
    pressure_mass = bmat([[csr_matrix((2 * n, 2 * n)), None], [None, mass]], format="csr")
    return Stiffness(matrix, pressure_mass)


def _representatives(basis: Any) -> IntArray:
    """Index (n,) of the nodal value each one stands for: those at X = 1 by those at X = 0 and the same y."""
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


@dataclass(frozen=True)
class Factorised:
    """A factorised constrained system; `solve` refines on the true matrix."""

    matrix: csc_matrix
    factors: Any

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve for right-hand sides (n_free, n_rhs).

        Raises
        ------
        SingularSystemError
            When the residual on the true matrix stays too large.
        """
        solution = self.factors.solve(rhs)
        scale = np.max(np.abs(rhs)) + 1e-300
        previous = np.inf
        for _ in range(REFINEMENTS):
            residual = rhs - self.matrix @ solution
            size = float(np.max(np.abs(residual))) / scale
            if not np.isfinite(size) or size == 0.0 or size > 0.5 * previous:
                break
            previous = size
            solution = solution + self.factors.solve(residual)
        final = float(np.max(np.abs(rhs - self.matrix @ solution))) / scale
        if not final < RESIDUAL:
            raise SingularSystemError(f"relative residual {final:.1e} of the linear system exceeds {RESIDUAL:.0e}")
        return np.asarray(solution)


def factorise(
    stiffness: Stiffness, constraints: Constraints, inverse_bulk_modulus: float, factors: Any = None
) -> Factorised:
    """Factorise T^T K T, regularised when nearly incompressible; or take `factors` of nearly the same matrix."""
    T = constraints.matrix
    matrix = (T.T @ stiffness.matrix @ T).tocsc()
    if factors is not None:
        return Factorised(matrix, factors)
    handed = matrix
    if inverse_bulk_modulus < REGULARISED_BELOW:
        handed = (matrix - REGULARISATION * (T.T @ stiffness.pressure_mass @ T)).tocsc()
    factors = splu(handed, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return Factorised(matrix, factors)
