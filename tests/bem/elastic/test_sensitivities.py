"""Derivatives of stress intensities and energy by the edges: central differences, symmetry, the dense reference."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from judges import evaluate_dense
from rough_surfaces import cut

from bem.elastic.collocation import Elastic, evaluate
from bem.elastic.sensitivities import own_sensitivity, stress_intensity_jacobian
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile

ROUGH = Profile.self_affine(2 * np.pi, 0.7, 1.0, 40, 0).scaled()
ELASTIC = Elastic(ROUGH)
EDGES = 8


@pytest.fixture(scope="module")
def rough():
    patches, penetration = cut(ROUGH, 0.4)
    assert 2 * patches.count == EDGES
    return evaluate(ELASTIC, patches, penetration, 1e-13)


def difference(state, edge, quantity):
    """Fourth-order central difference of a quantity by the outward motion of an edge, sizes held fixed."""
    step = 2e-4 * state.patches.edge_scale[edge]

    def at(amount):
        moved = state.patches.moved(amount * np.eye(2 * state.patches.count)[edge])
        return quantity(evaluate(ELASTIC, moved, state.penetration, 1e-13, state.resolution))

    return (8 * (at(step) - at(-step)) - (at(2 * step) - at(-2 * step))) / (12 * step)


def test_without_compliance_an_edge_feels_what_does_without_it(rough):
    modes = np.tile(rough.resolution.modes, 2)
    rigid = replace(rough, edge_compliance=np.diag(modes * (modes - 1) / np.pi**2))  # Z_ee = 0
    unknown = own_sensitivity(replace(rough, edge_compliance=np.empty((0, 0))))
    np.testing.assert_allclose(unknown, own_sensitivity(rigid), rtol=0, atol=1e-12 * np.abs(unknown).max())
    assert np.abs(unknown - own_sensitivity(rough)).max() > 1e-3 * np.abs(unknown).max()


@pytest.mark.parametrize("edge", range(EDGES))
def test_load_derivative_is_the_mixed_derivative_of_the_energy(rough, edge):
    found = difference(rough, edge, lambda state: state.load)
    exact = rough.stress_intensity * rough.stress_intensity_rate / 2
    assert abs(found - exact[edge]) <= 1e-10 * np.abs(exact).max()  # measured 2e-11


def test_jacobian_is_that_of_the_dense_reference(rough):
    patches = rough.patches
    dense = evaluate_dense(ROUGH, patches.left, patches.right, rough.penetration).stress_intensity_jacobian
    found = stress_intensity_jacobian(rough)
    np.testing.assert_allclose(found, dense, rtol=0, atol=1e-9 * np.abs(dense).max())  # measured 1e-10


@settings(max_examples=25)
@given(seed=st.integers(0, 50), fraction=st.floats(0.05, 0.8), shift=st.floats(-1, 1))
def test_hessian_is_symmetric(seed, fraction, shift):
    profile = Profile.self_affine(2 * np.pi, 0.7, 1.0, 30, seed).scaled()
    patches, penetration = cut(profile, fraction)
    state = evaluate(Elastic(profile), patches, penetration + shift, 1e-12)
    hessian = state.stress_intensity[:, None] / 2 * stress_intensity_jacobian(state)
    assert np.abs(hessian - hessian.T).max() <= 1e-8 * np.abs(hessian).max()  # measured 2e-10


@pytest.mark.parametrize("fraction", [0.02, 0.3, 0.8])
def test_no_edge_moves_another_where_all_stress_intensities_vanish(fraction):
    """Westergaard: at K = 0 the Jacobian is diagonal and its entries are the slope of the pressure's square root."""
    psi = np.pi * fraction / 2
    S = np.sin(psi) ** 2
    wave = Profile.from_harmonics(2 * np.pi, [1], [1.0])
    patches = Patches(np.array([-2 * psi]), np.array([2 * psi]))
    jacobian = stress_intensity_jacobian(evaluate(Elastic(wave), patches, S * (1 - np.log(S)), 1e-13))
    # sigma = 2 cos(x/2) sqrt(sin(psi)^2 - sin(x/2)^2) -> 2 cos(psi) sqrt(rho sin(2 psi)/2), dK/dout = sqrt(pi/2) of it
    expected = np.sqrt(2 * np.pi) * np.cos(psi) * np.sqrt(np.sin(psi) * np.cos(psi))
    np.testing.assert_allclose(jacobian, expected * np.eye(2), rtol=0, atol=4e-11)  # measured 1.6e-11
