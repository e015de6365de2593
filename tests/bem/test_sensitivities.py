"""Exact derivatives of stress intensities and energy by the edges, against differences and symmetry."""

import numpy as np
import pytest

from bem.adhesion import Adhesion
from bem.collocation import Elastic, evaluate
from bem.contact_state import ContactState
from bem.layer import layer_kernel
from bem.scaling import Solid
from bem.sensitivities import stress_intensity_jacobian

from .rough import bearing_cut, rough_profile


def differences(function, count, step):
    """Fourth-order central differences, one column per argument."""
    columns = []
    for index in range(count):
        unit = np.zeros(count)
        unit[index] = step
        near, far = ((function(k * unit) - function(-k * unit)) / 2 for k in (1, 2))
        columns.append((4 * near - far / 2) / (3 * step))
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("corrections", [(), (layer_kernel(0.8, 0.5, 1e-14),)], ids=["half_space", "layer"])
def test_jacobian_agrees_with_central_differences(corrections):
    profile = rough_profile().scaled()
    patches, penetration = bearing_cut(profile, 0.3)
    elastic = Elastic(profile, corrections)
    state = evaluate(elastic, patches, penetration, 1e-12)

    def intensity(outward):
        return evaluate(elastic, patches.moved(outward), penetration, 1e-12, state.resolution).stress_intensity

    step = 1e-3 * patches.edge_room.min()
    expected = differences(intensity, 2 * patches.count, step)
    exact = stress_intensity_jacobian(state)
    assert np.abs(exact - expected).max() <= 1e-7 * np.abs(expected).max()  # measured 3e-9


def test_hessian_of_a_rough_state_is_symmetric():
    profile = rough_profile(harmonics=1000, seed=0)
    patches, penetration = bearing_cut(profile.scaled(), 0.2)
    edges = np.stack([patches.left, patches.right], axis=1) * profile.period / (2 * np.pi)
    state = ContactState(profile, Solid(1e6, 0.5), edges, penetration * profile.rms_height, tolerance=1e-8)
    hessian = state.hessian
    assert np.abs(hessian - hessian.T).max() <= 1e-8 * np.abs(hessian).max()  # measured 1e-15


def test_gradient_and_hessian_are_derivatives_of_the_energy():
    profile, solid = rough_profile(harmonics=20, seed=3), Solid(1e6, 0.3)
    patches, penetration = bearing_cut(profile.scaled(), 0.3)
    edges = np.stack([patches.left, patches.right], axis=1) * profile.period / (2 * np.pi)

    def state(shift):
        return ContactState(
            profile, solid, edges + shift.reshape(edges.shape), penetration * profile.rms_height,
            adhesion=Adhesion(0.05, slope_term=True),
        )  # fmt: skip

    here = state(np.zeros(edges.size))
    step = 1e-3 * (edges[:, 1] - edges[:, 0]).min()
    slope = differences(lambda shift: np.array(state(shift).energy), edges.size, step)
    curvature = differences(lambda shift: state(shift).gradient.ravel(), edges.size, step)
    assert np.abs(here.gradient.ravel() - slope).max() <= 1e-7 * np.abs(slope).max()  # measured 7e-9
    assert np.abs(here.hessian - curvature).max() <= 1e-7 * np.abs(curvature).max()
