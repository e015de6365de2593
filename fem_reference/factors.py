"""The linear system of the layer: interior unknowns condensed, the rest factorised in an order of nested dissection.

An unknown inside one element is coupled to the others of that element alone.  With i inside and b on its boundary,

    S = K_bb - K_bi K_ii^-1 K_ib,     z_i = K_ii^-1 (r_i - K_ib z_b),

element by element, so that S z_b = r_b - K_bi K_ii^-1 r_i is what is factorised: two thirds of the unknowns of P4/P3,
all of those of P2/P1.  The elements are parted along x or y, about the median of their centres, where fewest unknowns
are common to both parts, and again; those common to two parts are eliminated after both (George, SIAM J. Numer. Anal.
10 (1973) 345, doi:10.1137/0710032).  The matrix is quasi-definite, so it is factorised without pivoting.  A nearly
incompressible layer leaves the pressure block tiny: then a small multiple of the pressure mass matrix is added for the
factorisation alone and the solution is refined iteratively on the true matrix.  So it is with the factors of a mesh
whose edges lie elsewhere by little.

Units: as in `elasticity`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from fem_reference.elasticity import Constraints, Spaces, Stiffness
from fem_reference.problem import FloatArray, IntArray

REGULARISED_BELOW = 1e-2  # inverse bulk modulus (1/E) below which the factorisation needs help
REGULARISATION = 1e-5  # of the pressure mass matrix, for the factorisation only
REFINEMENTS = 8
ROUNDED = 1e-15  # relative residual that is rounding: what refines it further changes it at random
RESIDUAL = 1e-11  # relative residual that must be reached on the true matrix
FEWEST_PARTED = 60  # unknowns of a part that is not parted any more
SHARES = 0.4, 0.5, 0.6  # of the elements before a cut


class SingularSystemError(RuntimeError):
    """The linear system could not be solved to its residual tolerance."""


@dataclass(frozen=True)
class Factors:
    """Factors of one matrix.

    Parameters
    ----------
    inside, boundary : IntArray, shapes (n_elements, n_i) and (n_elements, n_b)
        Free unknowns inside each element, and on its boundary; their number where one is held.
    inverse, response : FloatArray, shapes (n_elements, n_i, n_i) and (n_elements, n_i, n_b)
        K_ii^-1 and K_ii^-1 K_ib.
    order : IntArray
        Unknowns in the order of elimination.
    condensed : Any
        Factors of S in this order.
    """

    inside: IntArray
    boundary: IntArray
    inverse: FloatArray
    response: FloatArray
    order: IntArray
    condensed: Any

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve for right-hand sides (n_free, n_rhs)."""
        padded = np.vstack([rhs, np.zeros((1, rhs.shape[1]))])
        force = padded[self.inside]
        padded -= _summed(self.boundary, self.response.swapaxes(1, 2) @ force, len(rhs))
        solution = np.zeros_like(padded)
        solution[self.order] = self.condensed.solve(np.ascontiguousarray(padded[self.order]))
        solution[self.inside] = self.inverse @ force - self.response @ solution[self.boundary]
        return solution[:-1]


@dataclass(frozen=True)
class Factorised:
    """A constrained system with factors of it, or nearly so; `solve` refines on the true matrix.

    Parameters
    ----------
    elements : FloatArray, shape (n_elements, k, k)
    unknowns : IntArray, shape (n_elements, k)
        Free unknowns of each element; their number where one is held.
    factors : Factors
    """

    elements: FloatArray
    unknowns: IntArray
    factors: Factors

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
        for refinement in range(REFINEMENTS + 1):
            residual = rhs - self._times(solution)
            size = float(np.max(np.abs(residual))) / scale
            done = size <= (ROUNDED if refinement else 0.0)  # one refinement is due to small components
            if done or not np.isfinite(size) or size > 0.5 * previous or refinement == REFINEMENTS:
                break
            previous = size
            solution = solution + self.factors.solve(residual)
        if not size < RESIDUAL:
            raise SingularSystemError(f"relative residual {size:.1e} of the linear system exceeds {RESIDUAL:.0e}")
        return np.asarray(solution)

    def _times(self, z: FloatArray) -> FloatArray:
        padded = np.vstack([z, np.zeros((1, z.shape[1]))])
        return _summed(self.unknowns, self.elements @ padded[self.unknowns], len(z))[:-1]


def factorise(
    spaces: Spaces,
    stiffness: Stiffness,
    constraints: Constraints,
    inverse_bulk_modulus: float,
    factors: Factors | None = None,
) -> Factorised:
    """Factorise the constrained matrix, regularised when nearly incompressible; or take `factors` of nearly the same.

    Raises
    ------
    SingularSystemError
        When the matrix is singular.
    """
    T = constraints.matrix
    free = T.shape[1]
    number = np.full(T.shape[0], free)
    number[np.diff(T.indptr) == 1] = T.indices
    unknowns = number[stiffness.dofs]
    if factors is not None:
        return Factorised(stiffness.elements, unknowns, factors)
    handed = stiffness.elements
    if inverse_bulk_modulus < REGULARISED_BELOW:
        handed = handed.copy()
        pressures = stiffness.pressure_mass.shape[1]
        handed[:, -pressures:, -pressures:] -= REGULARISATION * stiffness.pressure_mass
    inner, outer = np.flatnonzero(spaces.inner), np.flatnonzero(~spaces.inner)
    inside, boundary = unknowns[:, inner], unknowns[:, outer]
    across, around = handed.take(inner, axis=1), handed.take(outer, axis=1)
    inverse = np.asarray(np.linalg.inv(across.take(inner, axis=2)), dtype=np.float64)
    response: FloatArray = inverse @ across.take(outer, axis=2)
    condensed = around.take(outer, axis=2)
    condensed -= around.take(inner, axis=2) @ response
    order = dissected(boundary, spaces.displacement.mesh, free)
    place = np.full(free + 1, len(order), dtype=np.int32)
    place[order] = np.arange(len(order))
    rows = np.repeat(place[boundary], boundary.shape[1], axis=1).ravel()
    columns = np.tile(place[boundary], boundary.shape[1]).ravel()
    matrix = coo_matrix((condensed.ravel(), (rows, columns)), shape=(len(order) + 1,) * 2).tocsc()
    matrix = matrix[: len(order), : len(order)]
    try:
        found = splu(matrix, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SingularSystemError(str(error)) from None
    return Factorised(stiffness.elements, unknowns, Factors(inside, boundary, inverse, response, order, found))


def dissected(unknowns: IntArray, mesh: Any, free: int) -> IntArray:
    """Unknowns (n,) of the elements in an order of nested dissection; the last of all, which many share, last.

    Parameters
    ----------
    unknowns : IntArray, shape (n_elements, k)
        `free` where there is none.
    mesh : skfem.MeshTri1
    free : int
        Number of unknowns.
    """
    centre = mesh.p[:, mesh.t].mean(axis=1)
    order: list[IntArray] = []
    marks = np.zeros((2, free + 1), dtype=bool)

    def eliminate(elements: IntArray, own: IntArray) -> None:
        if len(own) <= FEWEST_PARTED or len(elements) == 1:
            order.append(own)
            return
        fewest = len(own) + 1
        for along in centre:
            ranked = elements[np.argsort(along[elements], kind="stable")]
            for share in SHARES:
                cut_at = max(1, int(share * len(ranked)))
                before, behind = ranked[:cut_at], ranked[cut_at:]
                for seen, part in zip(marks, (before, behind), strict=True):
                    seen[own] = False
                    seen[unknowns[part]] = True
                member = marks[:, own]
                if (count := int(np.count_nonzero(member[0] & member[1]))) < fewest:
                    cut, fewest = (before, behind, member), count
        before, behind, member = cut
        eliminate(before, own[member[0] & ~member[1]])
        eliminate(behind, own[member[1] & ~member[0]])
        order.append(own[member[0] & member[1]])

    used = np.unique(unknowns)
    eliminate(np.arange(len(unknowns)), used[used < free - 1])
    return np.concatenate([*order, [free - 1]])


def _summed(unknowns: IntArray, values: FloatArray, free: int) -> FloatArray:
    """Sums (free + 1, n_rhs) of the values (n_elements, k, n_rhs) at the same unknown."""
    index = unknowns.ravel()
    columns = values.reshape(len(index), -1).T
    return np.stack([np.bincount(index, column, free + 1) for column in columns], axis=1)
