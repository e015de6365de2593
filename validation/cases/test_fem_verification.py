"""Code verification of the finite elements by manufactured solutions.

A plane wave u = A sin(k x + c), p = p0 cos(k x + c) with the body force it needs, on uniform crisscross meshes of the
unit square: errors in L2 fall as h^(m+1) for displacements of order m and h^m for pressures, any nu.  Orders at
singular edges are in test_convergence.py, stated uncertainties in test_fem_calibration.py.
"""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from fem_reference.elasticity import assemble, taylor_hood
from fem_reference.mesh import crisscross
from validation.plugin.rows import Code, Quantity

WAVE_VECTOR, SHIFT = np.array([2.0, 3.0]), 0.3
CELLS = {2: (8, 16), 4: (3, 6)}


def manufactured_errors(order, nu, cells):
    """Return errors in L2 of displacement and pressure on the unit square, E = 1."""
    mu, softness = 1 / (2 * (1 + nu)), 3 * (1 - 2 * nu)
    k = WAVE_VECTOR
    amplitude = np.array([1.0, 0.5]) if softness > 0 else np.array([3.0, -2.0])  # no change of volume
    p0 = -float(amplitude @ k) / softness if softness > 0 else 1.7

    def phase(x):
        return k[0] * x[0] + k[1] * x[1] + SHIFT

    grid = np.linspace(0, 1, cells + 1)
    spaces = taylor_hood(crisscross(grid, grid), order, quadrature_order=2 * order + 2)
    V, Q = spaces.displacement, spaces.pressure
    n, m = spaces.sizes
    force = mu * ((k @ k) * amplitude + (amplitude @ k) * k / 3) - p0 * k  # times the sine: - div sigma
    sine = np.sin(phase(np.asarray(V.global_coordinates())))
    rhs = np.zeros(2 * n + m)
    for shape, (function, *_) in enumerate(V.basis):
        moments = np.sum(sine * np.asarray(function) * V.dx, axis=1)
        for component in range(2):
            np.add.at(rhs, component * n + V.element_dofs[shape], force[component] * moments)
    u, p = np.sin(phase(V.doflocs)), p0 * np.cos(phase(Q.doflocs))
    solution = np.concatenate([amplitude[0] * u, amplitude[1] * u, p])
    edge = V.get_dofs().flatten()
    pinned = np.array([2 * n] if softness == 0 else [], dtype=edge.dtype)
    held = np.concatenate([edge, n + edge, pinned])  # one pressure where p is up to a constant
    free = np.setdiff1d(np.arange(2 * n + m), held)
    matrix = assemble(spaces, mu, softness).matrix
    solution[free] = spsolve(matrix[free][:, free].tocsc(), (rhs - matrix[:, held] @ solution[held])[free])
    square = 0.0
    for component in range(2):
        off = np.asarray(V.interpolate(solution[component * n : (component + 1) * n])) - amplitude[component] * sine
        square += float(np.sum(off**2 * V.dx))
    off = np.asarray(Q.interpolate(solution[2 * n :])) - p0 * np.cos(phase(np.asarray(Q.global_coordinates())))
    off -= np.sum(off * Q.dx) if softness == 0 else 0.0
    return float(np.sqrt(square)), float(np.sqrt(np.sum(off**2 * Q.dx)))


@pytest.mark.quick
@pytest.mark.parametrize("order", [2, 4])
def test_manufactured_solution(rows, order):
    """Do elements converge at their order on a manufactured plane wave, for any Poisson's ratio?"""
    ratios = (-0.5, 0.3, 0.499999, 0.5)
    errors = np.array([[manufactured_errors(order, nu, count) for count in CELLS[order]] for nu in ratios])
    observed = np.log2(errors[:, 0] / errors[:, 1])  # (nu, displacement and pressure): cells double
    for place, name in enumerate(("displacement", "pressure")):
        rows.compare(f"order of the {name} in L2, nu = -0.5, 0.3, 0.499999, 0.5", observed[:, place],
                     order + 1.0 - place, of=Code.FEM, by=Code.RATE, quantity=Quantity.RATE, uncertainty=0.1,
                     required=0.25, because="a quarter of an order on two meshes; an error of one costs one",
                     source="m + 1 and m on a smooth solution")
