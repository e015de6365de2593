"""Matrices of elements against forms assembled by quadrature, their motion, and factors of the whole."""

import numpy as np
import pytest
from scipy.sparse import bmat
from skfem import BilinearForm

from fem_reference.contact import contact_indicator
from fem_reference.elasticity import assemble, constrain, moved_elements, taylor_hood
from fem_reference.factors import factorise
from fem_reference.mesh import Resolution, layer_mesh, moved

EDGES = np.array([[0.1, 0.35], [0.6, 0.8]])
MU = 0.4
ORDERS = pytest.mark.parametrize("order", [2, 4])
SOFTNESS = pytest.mark.parametrize("softness", [1.2, 0.0], ids=["compressible", "incompressible"])


@pytest.fixture
def layer(order):
    return layer_mesh(0.5, EDGES, Resolution(order, 5, 6))


def derivative(j, i):
    return BilinearForm(lambda u, v, _: u.grad[j] * v.grad[i])


@ORDERS
def test_matrices_are_those_of_the_mixed_form(layer, order):
    spaces = taylor_hood(layer.triangles, order)
    V, Q = spaces.displacement, spaces.pressure
    xx, yy, xy = (derivative(*axes).assemble(V) for axes in ((0, 0), (1, 1), (1, 0)))
    bx, by = (BilinearForm(lambda u, q, _, i=i: u.grad[i] * q).assemble(V, Q) for i in (0, 1))
    mass = BilinearForm(lambda p, q, _: p * q).assemble(Q)
    coupling = 2 * MU * (xy.T / 2 - xy / 3)
    expected = bmat(
        [
            [2 * MU * (2 / 3 * xx + yy / 2), coupling, -bx.T],
            [coupling.T, 2 * MU * (2 / 3 * yy + xx / 2), -by.T],
            [-bx, -by, -0.7 * mass],
        ]
    )
    assert abs(assemble(spaces, MU, 0.7).matrix - expected).max() < 3e-14  # measured 8e-15


@ORDERS
def test_moved_elements_are_the_derivative_of_the_matrices(layer, order):
    spaces = taylor_hood(layer.triangles, order)
    shift = np.array([[0.0, 1e-6], [-2e-6, 0.0]])
    ahead, behind = (
        assemble(taylor_hood(moved(layer, EDGES + sign * shift).triangles, order), MU, 0.7).elements for sign in (1, -1)
    )
    motion = (moved(layer, EDGES + shift).triangles.p - moved(layer, EDGES - shift).triangles.p)[0] / 2
    change = moved_elements(spaces, MU, 0.7, np.arange(len(ahead)), motion)
    np.testing.assert_allclose(change, (ahead - behind) / 2, atol=5e-14)  # measured 1.2e-14; entries up to 1e-4


def constrained(layer, order, softness):
    spaces = taylor_hood(layer.triangles, order)
    return assemble(spaces, MU, softness), constrain(spaces, layer.depth, contact_indicator(layer))


@ORDERS
@SOFTNESS
def test_factors_solve_the_system(layer, order, softness):
    stiffness, constraints = constrained(layer, order, softness)
    T = constraints.matrix
    matrix = (T.T @ stiffness.matrix @ T).tocsc()
    known, unit = np.random.default_rng(3).normal(size=T.shape[1]), np.zeros(T.shape[1])
    unit[-1] = 1.0
    found = factorise(stiffness, constraints, softness).solve(np.stack([matrix @ known, unit], axis=1))
    np.testing.assert_allclose(found[:, 0], known, rtol=0, atol=3e-11)  # measured 1.3e-11; a solve by SuperLU 3e-6
    np.testing.assert_allclose(matrix @ found[:, 1], unit, rtol=0, atol=5e-13)  # measured 1.4e-13


@ORDERS
def test_factors_of_a_mesh_near_by_serve(layer, order):
    factors = factorise(*constrained(layer, order, 1.2), 1.2).factors
    stiffness, constraints = constrained(moved(layer, EDGES + 1e-5), order, 1.2)
    rhs = np.zeros((constraints.matrix.shape[1], 1))
    rhs[-1] = 1.0
    own, other = (factorise(stiffness, constraints, 1.2, known) for known in (None, factors))
    np.testing.assert_allclose(other.solve(rhs), own.solve(rhs), rtol=0, atol=1e-11)  # measured 2e-13
