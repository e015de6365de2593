"""The linear system of the layer: factorised once, refined on the true matrix.

The matrix over displacements and pressures is quasi-definite, so SuperLU factorises it without pivoting, its unknowns
in the order of minimum degree (Vanderbei, SIAM J. Optim. 5 (1995) 100; Liu, ACM Trans. Math. Softw. 11 (1985) 141).
A nearly incompressible layer leaves the pressure block tiny: then a small multiple of the pressure mass matrix is added
for the factorisation alone and the solution is refined iteratively on the true matrix.  So it is with the factors of a
mesh whose edges lie elsewhere by little.

Units: as in `elasticity`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.linalg import splu

from fem_reference.elasticity import Constraints, Stiffness
from fem_reference.problem import FloatArray

REGULARISED_BELOW = 1e-2  # inverse bulk modulus (1/E) below which the factorisation needs help
REGULARISATION = 1e-5  # of the pressure mass matrix, for the factorisation only
REFINEMENTS = 8
ROUNDED = 1e-15  # relative residual that is rounding: what refines it further changes it at random
RESIDUAL = 1e-11  # relative residual that must be reached on the true matrix


class SingularSystemError(RuntimeError):
    """The linear system could not be solved to its residual tolerance."""


@dataclass(frozen=True)
class Factorised:
    """Constrained matrix, element by element, with factors of it or of a similar one; `solve` refines on the matrix.

    Parameters
    ----------
    stiffness : Stiffness
    constraints : Constraints
    factors : SuperLU
    """

    stiffness: Stiffness
    constraints: Constraints
    factors: Any

    def times(self, free: FloatArray) -> FloatArray:
        """Return T^T K T times vectors (n_free, n_rhs) of the free unknowns, without assembling the matrix."""
        T = self.constraints.matrix
        return np.asarray(T.T @ self.stiffness.times((T @ free).T).T)

    def solve(self, rhs: FloatArray) -> FloatArray:
        """Solve for right-hand sides (n_free, n_rhs).

        Raises
        ------
        SingularSystemError
            When the residual on the matrix stays too large.
        """
        solution = self.factors.solve(rhs)
        scale = np.max(np.abs(rhs)) + 1e-300
        previous = np.inf
        for refinement in range(REFINEMENTS + 1):
            residual = rhs - self.times(solution)
            size = float(np.max(np.abs(residual))) / scale
            done = size <= (ROUNDED if refinement else 0.0)  # one refinement is due to small components
            if done or not np.isfinite(size) or size > 0.5 * previous or refinement == REFINEMENTS:
                break
            previous = size
            solution = solution + self.factors.solve(residual)
        if not size < RESIDUAL:
            raise SingularSystemError(f"relative residual {size:.1e} of the linear system exceeds {RESIDUAL:.0e}")
        return np.asarray(solution)


def factorise(
    stiffness: Stiffness, constraints: Constraints, inverse_bulk_modulus: float, factors: Any = None
) -> Factorised:
    """Factorise the constrained matrix, regularised when nearly incompressible; or take `factors` of a similar one.

    Raises
    ------
    SingularSystemError
        When the matrix is singular.
    """
    if factors is not None:
        return Factorised(stiffness, constraints, factors)
    elements = stiffness.elements
    if inverse_bulk_modulus < REGULARISED_BELOW:
        elements, pressures = elements.copy(), stiffness.pressure_mass.shape[1]
        elements[:, -pressures:, -pressures:] -= REGULARISATION * stiffness.pressure_mass
    handed = constrained(stiffness, constraints, elements)
    try:
        found = splu(handed, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SingularSystemError(str(error)) from None
    return Factorised(stiffness, constraints, found)


def constrained(stiffness: Stiffness, constraints: Constraints, elements: FloatArray) -> csc_matrix:
    """Return T^T K T of the free unknowns, (n_free, n_free): a nodal value is one of them, or held."""
    T = constraints.matrix
    free = T.shape[1]
    number = np.full(T.shape[0], free, dtype=np.int32)
    number[np.diff(T.indptr) == 1] = T.indices
    unknowns = number[stiffness.dofs]
    rows, columns = np.repeat(unknowns, unknowns.shape[1], axis=1), np.tile(unknowns, unknowns.shape[1])
    whole = coo_matrix((elements.ravel(), (rows.ravel(), columns.ravel())), shape=(free + 1, free + 1))
    return whole.tocsc()[:free, :free]
