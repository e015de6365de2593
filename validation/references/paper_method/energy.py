"""Pressure by Gauss-Seidel, energy of given edges, and its exact derivative by every edge.

The pressure of given patches at penetration Delta solves A y = g, g = h - h_max + Delta at the cell centres, by
Gauss-Seidel sweeps: the relaxation y_j <- (g_j - sum_{k != j} A_jk y_k) / A_jj in turn, convergent as A is symmetric
and positive definite.  Then

    U = y.g / 2 - w sum_i int_{a_i}^{b_i} sqrt(1 + h'^2) dx.

An edge moves the cells of its patch by dx_j = (1 -+ t_j)/2 and changes the half width by dr = -+ 1/2, and as y makes
the quadratic form stationary, the discrete energy changes by exactly

    dU = sum_j y_j dx_j [h'(x_j) + (1/pi) F_j] + dr/(2 pi r) sum_j y_j^2 -+ w sqrt(1 + h'^2)(edge),

F of `attraction`.  It tends to -+ (w - G), the energy release rate less the work of adhesion.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.blas import dsymv, dtrsv

from validation.harness.arrays import FloatArray
from validation.references.paper_method.cells import Cells, attraction, compliance
from validation.references.paper_method.surface import Surface

MOST_SWEEPS = 20_000
DIVERGED = 1e6  # times the largest target
GAUSS = np.polynomial.legendre.leggauss(12)


class SweepsError(ArithmeticError):
    """Gauss-Seidel did not reach its tolerance."""


@dataclass(frozen=True, eq=False)
class Energy:
    """Energy of given edges."""

    cells: Cells
    total: float  # U, dimensionless
    elastic: float  # U_el, dimensionless
    # dU by the outward motion of each edge, G - w: the edge gains by moving out where it is negative; (L, 2)
    outward: FloatArray
    charges: FloatArray  # force of each cell, (n,)
    sweeps: int  # of Gauss-Seidel

    @property
    def closing(self) -> NDArray[np.bool_]:
        """Edges whose last cell is compressed, (L, 2): K < 0, where G - w has lost its meaning."""
        stops = np.cumsum(self.cells.counts)
        return np.stack([self.charges[stops - self.cells.counts], self.charges[stops - 1]], axis=1) > 0

    @property
    def load(self) -> float:
        """Force per period."""
        return float(self.charges.sum())


def gauss_seidel(matrix: FloatArray, target: FloatArray, start: FloatArray, tolerance: float) -> tuple[FloatArray, int]:
    """Sweep until the largest residual is below `tolerance` of the largest target; charges and number of sweeps.

    SweepsError where that takes more than MOST_SWEEPS sweeps, or the residual grows: the matrix is not positive
    definite.

    Examples
    --------
    >>> y, _ = gauss_seidel(np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([3.0, 3.0]), np.zeros(2), 1e-14)
    >>> y.round(12).tolist()
    [1.0, 1.0]
    """
    columns = np.asfortranarray(matrix)
    charges, limit = start.copy(), tolerance * float(np.max(np.abs(target)))
    left = np.inf
    for sweep in range(MOST_SWEEPS):
        residual = target - dsymv(1.0, columns, charges)
        left = float(np.max(np.abs(residual)))
        if left <= limit:
            return charges, sweep
        if left > DIVERGED * limit / tolerance:
            break
        charges += dtrsv(columns, residual, lower=1)
    raise SweepsError(f"Gauss-Seidel: residual {left:.1e} after {sweep + 1} sweeps, {limit:.1e} is asked for")


def energy(
    surface: Surface, cells: Cells, penetration: float, tolerance: float, start: FloatArray | None = None
) -> Energy:
    """Compute energy and derivatives at a dimensionless penetration.

    Gauss-Seidel iterates from the charges `start` (n,) to `tolerance`.
    """
    target = surface.height(cells.centre) - surface.highest + penetration
    first = np.zeros(target.size) if start is None else start
    charges, sweeps = gauss_seidel(compliance(surface, cells), target, first, tolerance)
    pull = charges * (surface.slope(cells.centre) + attraction(surface, cells, charges) / np.pi)
    count = cells.counts.size
    self_energy = np.bincount(cells.owner, charges**2, count) / (2 * np.pi * cells.radius) / 2
    at_left = -np.bincount(cells.owner, pull * (1 - cells.place) / 2, count) + self_energy
    at_right = np.bincount(cells.owner, pull * (1 + cells.place) / 2, count) + self_energy
    paid = surface.work * surface.adhesive_length(cells.edges)
    elastic = float(charges @ target) / 2
    total = elastic - surface.work * adhesive_area(surface, cells.edges)
    return Energy(cells, total, elastic, np.stack([at_left, at_right], axis=1) - paid, charges, sweeps)


def adhesive_area(surface: Surface, edges: FloatArray) -> float:
    """Return sum int sqrt(1 + h'^2) dx over the patches, by Gauss's rule on eighths of the shortest wavelength."""
    if not surface.slope_term:
        return float(np.sum(np.diff(edges, axis=1)))
    nodes, weights = GAUSS
    total = 0.0
    for a, b in edges:
        faces = np.linspace(a, b, 1 + int(np.ceil((b - a) * 8 * surface.order.max() / (2 * np.pi))))
        half = np.diff(faces)[:, None] / 2
        x = (faces[1:] + faces[:-1])[:, None] / 2 + half * nodes
        total += float(np.sum(half * weights * surface.adhesive_length(x)))
    return total
