"""Full contact and prescribed edges against closed forms; balance, symmetry and invariance for any profile."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest

from fem_reference.contact import KeptFactors, projected_pressure, solve_unit_states
from fem_reference.energy_release import edge_states
from fem_reference.face import face_nodes, interpolate, newton_cotes
from fem_reference.mesh import Resolution, layer_mesh, moved

COMPLETE = np.zeros((0, 2))


def energy_error(problem, compliance, resolution):
    mesh = layer_mesh(problem.depth, COMPLETE, resolution)
    exact = 0.5 / compliance(2 * np.pi, problem.depth, problem.poisson_ratio)
    return solve_unit_states(problem, mesh, resolution.order).energy[0, 0] / exact - 1


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.499999, 0.5])
@pytest.mark.parametrize("depth", [0.05, 0.3, 2.0])
def test_full_contact_energy(sinusoid, compliance, depth, nu):
    # measured 1e-14 (thin layer) to 1.7e-7
    assert abs(energy_error(sinusoid(nu, depth), compliance, Resolution(4, 8, 10))) < 5e-7


DOUBLING = 0.35 * np.expm1(1.0)  # the depth whose rows of triangles double exactly with the columns


@pytest.mark.parametrize(("order", "cells", "asked"), [(2, (8, 16), 3.8), (4, (8, 16), 5.5)], ids=["P2/P1", "P4/P3"])
@pytest.mark.parametrize("nu", [-0.5, 0.3, 0.499999, 0.5])
def test_full_contact_order(sinusoid, compliance, order, cells, asked, nu):
    problem = sinusoid(nu, DOUBLING)
    errors = [abs(energy_error(problem, compliance, Resolution(order, n, 10))) for n in cells]
    assert (
        np.log2(errors[0] / errors[1]) > asked
    )  # measured 3.97 to 5.6 and 6.7 to 7.9 (signs of the error agree there)


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_full_contact_pressure_is_the_profile_over_the_compliance(sinusoid, compliance, nu):
    problem = sinusoid(nu, 0.3)
    states = solve_unit_states(problem, layer_mesh(0.3, COMPLETE, Resolution(4, 16, 10)), 4)
    exact = problem.height(face_nodes(states.spaces).x) / compliance(2 * np.pi, 0.3, nu) + 0.7
    found = projected_pressure(states, 0.7)
    assert np.max(np.abs(found - exact)) < 4e-5  # measured 1.6e-5 of an amplitude 6.7


@pytest.mark.parametrize("nu", [-0.5, 0.3, 0.5])
def test_uniform_state_is_the_uniform_compliance(sinusoid, nu):
    problem = sinusoid(nu, 0.3)
    states = solve_unit_states(problem, layer_mesh(0.3, COMPLETE, Resolution(4, 8, 10)), 4)
    # measured 1e-14
    assert states.displacement_of_plate[1] == pytest.approx(problem.uniform_compliance, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(
    ("half_width", "nu"), [(0.02, 0.3), (0.15, 0.5), pytest.param(0.4, 0.45, marks=pytest.mark.slow)]
)
def test_prescribed_edges_against_the_closed_form(sinusoid, johnson, half_width, nu):
    problem, exact = sinusoid(nu), johnson(half_width, nu)
    mesh = layer_mesh(2.0, np.array([[-half_width, half_width]]), Resolution(4, 10, 22))
    states = solve_unit_states(problem, mesh, 4)
    load = (1.3 - states.penetration[0]) / states.penetration[1]
    # measured, relative to p* = pi E* D / lambda: 2e-9 to 2.9e-8; asked 1e-7
    full = np.pi * np.sqrt(2) * exact.modulus
    assert load == pytest.approx(exact.load(1.3), abs=6e-8 * full)
    found = edge_states(states).at_load(load)
    # measured 5e-9 to 2.0e-7 (where K is a fortieth of p*); asked 1e-6
    np.testing.assert_allclose(found.stress_intensity, exact.stress_intensity(1.3), rtol=5e-7)


def test_prescribed_edges_on_the_quick_mesh(sinusoid, johnson):
    mesh = layer_mesh(2.0, np.array([[-0.15, 0.15]]), Resolution(2, 8, 8))
    states = solve_unit_states(sinusoid(), mesh, 2)
    load = (1.3 - states.penetration[0]) / states.penetration[1]
    assert load == pytest.approx(johnson(0.15, 0.3).load(1.3), rel=7e-4)  # measured 3.3e-4
    # measured 2.5e-4
    np.testing.assert_allclose(
        edge_states(states).at_load(load).stress_intensity, johnson(0.15, 0.3).stress_intensity(1.3), rtol=5e-4
    )


TWO = np.array([[0.05, 0.2], [0.45, 0.7]])
QUICK = Resolution(2, 8, 8)


@pytest.fixture(scope="module")
def solved():
    cache = {}

    def solve(problem, edges=TWO, resolution=QUICK):
        key = (repr(problem), edges.tobytes(), resolution)
        if key not in cache:
            cache[key] = solve_unit_states(problem, layer_mesh(problem.depth, edges, resolution), resolution.order)
        return cache[key]

    return solve


def test_reactions_sum_to_the_load(solved, two_crests):
    totals = solved(two_crests()).reactions.sum(axis=1)
    np.testing.assert_allclose(totals, [0.0, 1.0], atol=1e-11)  # measured 3e-13


def test_mean_displacement_is_that_of_the_uniform_compression(solved, two_crests):
    states = solved(two_crests())
    # Betti with the uniform state, which the elements contain: measured 4e-13
    np.testing.assert_allclose(
        states.mean_displacement, [0.0, states.problem.uniform_compliance], rtol=1e-11, atol=1e-11
    )


def test_work_of_the_reactions_is_the_energy_of_the_matrix(solved, two_crests):
    states = solved(two_crests())
    stored = 0.5 * states.fields @ (states.stiffness.matrix @ states.fields.T)
    np.testing.assert_allclose(states.energy, stored, rtol=1e-9, atol=1e-9)  # measured 1e-12


def test_pressure_integrates_to_the_load(solved, two_crests):
    states = solved(two_crests())
    nodes = face_nodes(states.spaces)
    pressure = projected_pressure(states, 0.4)
    lengths, p = np.diff(nodes.x[::2]), 2
    inside = np.flatnonzero((pressure[:-1:p] != 0) & (pressure[1::p] != 0) & (pressure[p::p] != 0))
    cells = inside[:, None] * p + np.arange(p + 1)
    # measured 2e-15: the projection tests with one, and no contact facet is adjacent to a free one with pressure
    assert np.sum(lengths[inside] * (pressure[cells] @ newton_cotes(2))) == pytest.approx(0.4, abs=1e-10)


def test_mirror_image(solved, two_crests):
    problem = two_crests()
    mirrored = dataclasses.replace(problem, phases=-np.asarray(problem.phases))
    there, back = solved(problem), solved(mirrored, 1 - TWO[::-1, ::-1])
    # measured 6e-7: the meshes of the two images are not mirror images of one another
    np.testing.assert_allclose(back.energy, there.energy, rtol=2e-6, atol=1e-9)


def test_shift_along_the_period(solved, two_crests):
    problem = two_crests()
    moved = dataclasses.replace(
        problem, phases=np.asarray(problem.phases) - 2 * np.pi * np.asarray(problem.orders) * 0.5
    )
    there, back = solved(problem), solved(moved, TWO + 0.5)
    np.testing.assert_allclose(back.energy, there.energy, rtol=1e-9, atol=1e-9)  # measured 1e-12


def test_unit_system_does_not_matter(two_crests):
    problem = two_crests()
    other = dataclasses.replace(
        problem,
        youngs_modulus=1e6,
        thickness=problem.thickness * 1e-2,
        period=1e-2,
        amplitudes=np.asarray(problem.amplitudes) * 1e-2,
    )
    mesh = layer_mesh(problem.depth, TWO, QUICK)
    one, two = (solve_unit_states(p, mesh, 2).energy for p in (problem, other))
    np.testing.assert_allclose(two, one, rtol=1e-11, atol=1e-12)


def test_interpolation_reproduces_the_elements_polynomials():
    ends = np.array([0.0, 0.3, 1.0])
    x = np.concatenate([np.linspace(a, b, 5)[: 5 if b == 1 else 4] for a, b in pairwise(ends)])
    at = np.linspace(0, 1, 17)
    np.testing.assert_allclose(interpolate(at, x, x**4 - x, 4), at**4 - at, atol=1e-15)


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_factors_of_a_mesh_nearly_the_same_give_the_same_states(nu, two_crests):
    """An edge moved by 9e-4 of its patch; that states without load and under a flat face share no energy is Betti's."""
    problem, kept = two_crests(nu), KeptFactors()
    mesh = layer_mesh(problem.depth, TWO, Resolution(2, 8, 8))
    solve_unit_states(problem, mesh, 2, kept)
    there, farther = (moved(mesh, TWO + np.array([[0.0, shift], [0.0, 0.0]])) for shift in (1.3e-4, 2e-3))
    assert kept.near(there) is not None
    assert kept.near(farther) is None
    assert kept.near(layer_mesh(problem.depth, TWO, Resolution(2, 8, 8))) is None
    shared, own = (solve_unit_states(problem, there, 2, given).energy for given in (kept, None))
    np.testing.assert_allclose(shared.diagonal(), own.diagonal(), rtol=1.5e-13)  # measured 4.8e-14
    assert max(abs(shared[0, 1]), abs(own[0, 1])) <= 1e-13  # rounding; of energies 1.04 and .26; measured 3.9e-14
