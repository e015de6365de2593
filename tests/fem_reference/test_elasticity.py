"""Patch test, rigid motions, manufactured solution, locking: the elasticity alone, without contact."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, Functional, LinearForm, MeshTri1
from skfem.helpers import ddot, div, sym_grad

from fem_reference.contact import contact_indicator, solve_unit_states
from fem_reference.elasticity import assemble, constrain, taylor_hood
from fem_reference.mesh import LayerMesh, crisscross

MESH = crisscross(np.array([0.0, 0.4, 1.0]), np.array([0.0, 0.3, 0.5]))
RATIOS = [-0.5, 0.3, 0.499999]


def elastic(nu):
    return 1 / (2 * (1 + nu)), 3 * (1 - 2 * nu)


def nodal(spaces, ux, uy, p):
    return np.concatenate(
        [ux(*spaces.displacement.doflocs), uy(*spaces.displacement.doflocs), p(*spaces.pressure.doflocs)]
    )


@pytest.mark.parametrize("nu", RATIOS)
@pytest.mark.parametrize("order", [2, 4])
def test_patch_test(order, nu):
    mu, softness = elastic(nu)
    spaces = taylor_hood(MESH, order)
    pressure = -(0.2 + 0.5) / softness
    field = nodal(spaces, lambda x, y: 0.2 * x - 0.7 * y, lambda x, y: 0.4 * x + 0.5 * y, lambda x, y: pressure + 0 * x)
    residual = assemble(spaces, mu, softness).matrix @ field
    n = spaces.displacement.N
    inner = spaces.displacement.complement_dofs(spaces.displacement.get_dofs())
    inside = np.concatenate([inner, n + inner, np.arange(2 * n, len(field))])
    assert np.max(np.abs(residual[inside])) < 1e-12 * max(1, abs(pressure))  # measured 2e-13 of the pressure


@pytest.mark.parametrize("order", [2, 4])
def test_rigid_motions_store_nothing(order):
    spaces = taylor_hood(MESH, order)
    matrix = assemble(spaces, *elastic(0.3)).matrix
    motion = nodal(spaces, lambda x, y: 1 - 2 * y, lambda x, y: 3 + 2 * x, lambda x, y: 0 * x)
    assert np.max(np.abs(matrix @ motion)) < 3e-13  # measured 5e-14


def test_matrix_is_symmetric():
    matrix = assemble(taylor_hood(MESH, 4), *elastic(0.3)).matrix
    assert abs(matrix - matrix.T).max() < 1e-15  # measured 3e-16


def manufactured_errors(order, nu, cells):
    """L2 errors of displacement and pressure for the plane wave u = A sin(k.x + 0.3), p = p0 cos(k.x + 0.3)."""
    mu, softness = elastic(nu)
    k = np.array([2.0, 3.0])
    A = np.array([1.0, 0.5]) if softness > 0 else np.array([3.0, -2.0])
    p0 = -(A @ k) / softness if softness > 0 else 1.7

    def wave(x, y):
        return np.sin(k[0] * x + k[1] * y + 0.3)

    def cosine(x, y):
        return np.cos(k[0] * x + k[1] * y + 0.3)

    # -div sigma = mu (|k|^2 A + (A.k) k / 3) sin - p0 k sin
    force = mu * ((k @ k) * A + (A @ k) * k / 3) - p0 * k
    grid = np.linspace(0, 1, cells + 1)
    spaces = taylor_hood(crisscross(grid, grid), order, quadrature_order=2 * order + 2)
    V, Q = spaces.displacement, spaces.pressure
    n, m = spaces.sizes
    loads = [LinearForm(lambda v, w, f=f: f * wave(*w.x) * v).assemble(V) for f in force]
    rhs = np.concatenate([*loads, np.zeros(m)])
    exact = nodal(
        spaces, lambda x, y: A[0] * wave(x, y), lambda x, y: A[1] * wave(x, y), lambda x, y: p0 * cosine(x, y)
    )
    edge = V.get_dofs().flatten()
    fixed = np.concatenate([edge, n + edge] + ([[2 * n]] if softness == 0 else []))
    free = np.setdiff1d(np.arange(2 * n + m), fixed)
    matrix = assemble(spaces, mu, softness).matrix
    found = exact.copy()
    found[free] = spsolve(matrix[free][:, free].tocsc(), (rhs - matrix[:, fixed] @ exact[fixed])[free])
    error = 0.0
    for component in range(2):
        u = V.interpolate(found[component * n : (component + 1) * n])
        error += Functional(lambda w, c=component: (w.u - A[c] * wave(*w.x)) ** 2).assemble(V, u=u)
    pressure = Q.interpolate(found[2 * n :])
    shift = 0.0
    if softness == 0:  # fixed only up to the constant the pinned node's error carries
        shift = Functional(lambda w: w.p - p0 * cosine(*w.x)).assemble(Q, p=pressure)
    square = Functional(lambda w: (w.p - shift - p0 * cosine(*w.x)) ** 2).assemble(Q, p=pressure)
    return np.sqrt(error), np.sqrt(square)


@pytest.mark.parametrize("nu", [-0.5, 0.3, 0.499999, 0.5])
@pytest.mark.parametrize(("order", "cells"), [(2, (8, 16)), (4, (3, 6))], ids=["P2/P1", "P4/P3"])
def test_manufactured_solution_converges_at_the_order_of_the_elements(order, cells, nu):
    coarse, fine = (np.array(manufactured_errors(order, nu, n)) for n in cells)
    observed = np.log2(coarse / fine)
    # measured: displacement 3.00 to 3.05 and 5.00 to 5.06, pressure 2.01 to 2.02 and 4.01 to 4.08
    assert observed[0] > order + 1 - 0.05
    assert observed[1] > order - 0.05


@BilinearForm
def displacement_only(u, v, w):
    mu, lame = 1 / (2 * (1 + w.nu)), w.nu / ((1 + w.nu) * (1 - 2 * w.nu))
    return 2 * mu * ddot(sym_grad(u), sym_grad(v)) + lame * div(u) * div(v)


def full_contact_mesh(depth, cells):
    columns, rows = np.linspace(0, 1, cells + 1), np.linspace(0, depth, max(2, round(cells * depth)) + 1)
    triangles = MeshTri1.init_tensor(columns, rows)
    return LayerMesh(triangles, triangles.p, np.zeros((0, 2)), np.zeros((0, 2)), 0.0, depth)


def plain_energy(problem, mesh):
    """Energy of full contact at its mean displacement, displacement elements P2 alone."""
    basis = Basis(mesh.triangles, ElementVector(ElementTriP2()))
    matrix = displacement_only.assemble(basis, nu=problem.poisson_ratio)
    spaces = taylor_hood(mesh.triangles, 2)
    n = spaces.displacement.N
    to_scalar = np.zeros(2 * n, dtype=int)
    for component in range(2):
        scalar = {tuple(np.round(at, 10)): i for i, at in enumerate(spaces.displacement.doflocs.T)}
        dofs = np.concatenate([basis.nodal_dofs[component], basis.facet_dofs[component]])
        to_scalar[dofs] = [component * n + scalar[tuple(np.round(basis.doflocs[:, dof], 10))] for dof in dofs]
    order = np.argsort(to_scalar)
    matrix = matrix[order][:, order]
    constraints = constrain(spaces, mesh.depth, contact_indicator(mesh))
    used = np.flatnonzero(np.diff(constraints.matrix[: 2 * n].tocsc().indptr))
    T = constraints.matrix[: 2 * n][:, used]
    lift = np.zeros(2 * n)
    values = constraints.contact_values
    lift[n + values] = problem.height(spaces.displacement.doflocs[0, values])
    reduced = (T.T @ matrix @ T).tocsc()
    free = spsolve(reduced, -T.T @ (matrix @ lift))
    field = T @ free + lift
    return 0.5 * field @ (matrix @ field)


def locking_errors(problem, compliance):
    mesh = full_contact_mesh(0.25, 8)
    exact = 0.5 / compliance(2 * np.pi, 0.25, problem.poisson_ratio)
    mixed = solve_unit_states(problem, mesh, 2).energy[0, 0]
    return plain_energy(problem, mesh) / exact - 1, mixed / exact - 1


def test_displacement_elements_lock_where_the_mixed_form_does_not(sinusoid, compliance):
    plain, mixed = locking_errors(sinusoid(0.499999, 0.25), compliance)
    assert plain > 0.05  # measured 0.126
    assert abs(mixed) < 5e-3  # measured 2.4e-3


def test_displacement_elements_are_as_good_away_from_incompressibility(sinusoid, compliance):
    plain, mixed = locking_errors(sinusoid(0.3, 0.25), compliance)
    assert 0 < plain < 0.012  # measured 6.0e-3
    assert abs(mixed) < 3e-3  # measured 1.4e-3


def test_pressure_block_vanishes_when_incompressible():
    spaces = taylor_hood(MESH, 2)
    n, _ = spaces.sizes
    block = assemble(spaces, *elastic(0.5)).matrix[2 * n :, 2 * n :]
    assert abs(block).max() == 0.0
