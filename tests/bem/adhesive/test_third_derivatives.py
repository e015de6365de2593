"""How the Hessian changes along motions of edges and control, and how branches bend: against differences."""

import numpy as np
import pytest

from bem.adhesive.adhesion import SlopeLaw, true_length
from bem.adhesive.equilibrium import System, balance
from bem.adhesive.third_derivatives import hessian_change_times
from bem.elastic.collocation import Elastic
from bem.elastic.compliance import Compliance
from bem.elastic.kernel_series import kernel_series
from bem.elastic.layer import LayerEffect
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl, LoadControl

TOLERANCE = 1e-12
PROFILE = Profile.from_harmonics(2 * np.pi, [1, 2, 5], [0.5, 1.0, 0.2], [0.1, 0.2, 0.5])
CONTROLS = {"Delta": DisplacementControl(), "spring": DisplacementControl(0.7), "load": LoadControl()}
LAYERS = {"half-space": None, "layer": Compliance(kernel_series(LayerEffect(0.6, 0.4), 1e-16))}
PATCHES = {
    "three": Patches(np.array([-0.7, 2.0, 3.4]), np.array([0.6, 2.3, 4.5])),
    "one": Patches(np.array([-0.7]), np.array([0.6])),
    "narrow gaps": Patches(np.array([-0.7, 0.65, 2.9]), np.array([0.6, 2.8, 5.5])),
    "thirty": Patches(np.linspace(0.0, 6.1, 30), np.linspace(0.0, 6.1, 30) + np.linspace(0.04, 0.16, 30)),
}
by_control = pytest.mark.parametrize("control", CONTROLS.values(), ids=CONTROLS)
by_layer = pytest.mark.parametrize("compliance", LAYERS.values(), ids=LAYERS)


def slope_law(profile):
    return SlopeLaw(0.2, profile, 0.8, true_length(profile, 0.8))


def difference(of, step):
    """Of fourth order."""
    return (8 * (of(step) - of(-step)) - (of(2 * step) - of(-2 * step))) / (12 * step)


@by_layer
@by_control
@pytest.mark.parametrize("patches", PATCHES.values(), ids=PATCHES)
def test_the_hessian_changes_as_differences_say(control, compliance, patches):
    system = System(Elastic(PROFILE, compliance), slope_law(PROFILE), control)
    here = balance(system.sloped, patches, 0.4, 0.4, TOLERANCE)
    rng = np.random.default_rng(1)
    outward, change = rng.normal(size=2 * patches.count) * patches.edge_scale, 0.3

    def hessian(part):
        moved = patches.moved(part * outward)
        return balance(system, moved, 0.4, 0.4 + part * change, TOLERANCE, here.state.resolution).hessian

    found = np.stack([hessian_change_times(system, here, outward, change, x) for x in np.eye(outward.size)], axis=1)
    size = np.abs(found).max()
    np.testing.assert_allclose(
        found, difference(hessian, 1e-3), rtol=0, atol=1e-6 * size
    )  # rounding of the differences, measured on six kinds of kernels: up to 3.7e-7
    np.testing.assert_allclose(found, found.T, rtol=0, atol=1e-13 * size)  # measured, on the six, up to 3.5e-14


@by_layer
@by_control
def test_without_a_motion_of_the_edges_no_slopes_are_needed(control, compliance):
    system, patches = System(Elastic(PROFILE, compliance), slope_law(PROFILE), control), PATCHES["three"]
    here = balance(system, patches, 0.4, 0.4, TOLERANCE)
    assert here.state.slope_compliance.size == 0

    def hessian(part):
        return balance(system, patches, 0.4, 0.4 + part, TOLERANCE).hessian

    # the Hessian is quadratic in the control, so that a long step has no error but rounding; measured up to 9e-11
    found = np.stack([hessian_change_times(system, here, None, 1.0, x) for x in np.eye(6)])
    np.testing.assert_allclose(found, difference(hessian, 1.0), rtol=0, atol=3e-10)
