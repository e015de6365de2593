"""Controls: reaching a target at fixed edges, and the potential whose second derivative decides stability."""

import numpy as np
import pytest

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.equilibrium import System, balance
from bem.elastic.collocation import Elastic, evaluate
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl, LoadControl

ROUGH = Profile.self_affine(2 * np.pi, 0.7, 1.0, 20, 0).scaled()
ELASTIC = Elastic(ROUGH)
PATCHES = Patches(np.array([0.5, 1.9, 5.5]), np.array([1.2, 2.2, 6.6]))
CONTROLS = {
    "penetration": (DisplacementControl(), 1.3),
    "load": (LoadControl(), 2.0),
    "spring": (DisplacementControl(0.2), 1.5),
}
by_control = pytest.mark.parametrize(("control", "target"), CONTROLS.values(), ids=CONTROLS)


def reached(control, target, patches=PATCHES, start=0.4, resolution=None):
    return control.reach(evaluate(ELASTIC, patches, control.guess(start, target), 1e-12, resolution), target)


def derivative(function, step):
    return (8 * (function(step) - function(-step)) - (function(2 * step) - function(-2 * step))) / (12 * step)


@by_control
def test_target_is_reached(control, target):
    state = reached(control, target)
    assert control.value(state.penetration, state.load) == pytest.approx(target, rel=1e-13)


@by_control
def test_reached_state_is_that_of_its_penetration(control, target):
    state = reached(control, target)
    direct = evaluate(ELASTIC, PATCHES, state.penetration, 1e-12)
    assert state.load == pytest.approx(direct.load, rel=1e-12)
    assert state.elastic_energy == pytest.approx(direct.elastic_energy, rel=1e-11)
    np.testing.assert_allclose(state.stress_intensity, direct.stress_intensity, rtol=0, atol=1e-11)
    slopes = np.abs(direct.edge_slope).max()
    np.testing.assert_allclose(state.edge_slope, direct.edge_slope, rtol=0, atol=1e-10 * slopes)
    for mine, other in zip(state.pressure().charges, direct.pressure().charges, strict=True):
        np.testing.assert_allclose(mine, other, rtol=0, atol=1e-11)


@by_control
def test_rate_is_the_derivative_of_the_penetration_by_the_target(control, target):
    found = derivative(lambda d: reached(control, target + d).penetration, 0.1)
    assert control.rate(reached(control, target)) == pytest.approx(found, rel=1e-12)


@by_control
@pytest.mark.parametrize("change", [0.3, -0.7])
def test_force_does_the_work_that_the_potential_grows_by_at_fixed_edges(control, target, change):
    here, there = reached(control, target), reached(control, target + change)
    growth = control.potential(there.penetration, there.load, there.elastic_energy)
    growth -= control.potential(here.penetration, here.load, here.elastic_energy)
    work = change * (control.force(here) + change / 2 * control.force_rate(here))
    assert work == pytest.approx(growth, rel=1e-11)


@by_control
def test_force_rate_follows_the_load_that_moving_edges_carry(control, target):
    outward = np.linspace(-0.05, 0.08, 6)

    def force(amount):
        state = evaluate(ELASTIC, PATCHES.moved(amount * outward), control.guess(0.4, target + amount), 1e-12)
        return control.force(control.reach(state, target + amount))

    here = balance(System(ELASTIC, UniformLaw(0.05), control), PATCHES, 0.4, target, 1e-12)
    rate = control.force_rate(here.state, float(here.load_gradient @ outward))
    assert rate == pytest.approx(derivative(force, 1e-3), rel=1e-6)


@by_control
@pytest.mark.parametrize("edge", range(6))
def test_gradient_and_hessian_are_derivatives_of_the_potential(control, target, edge):
    """Edges move at fixed target, so that penetration and load follow."""
    system = System(ELASTIC, UniformLaw(0.05), control)
    here = balance(system, PATCHES, 0.4, target, 1e-12)
    sizes, unit = here.state.resolution, np.eye(6)[edge]

    def at(amount):
        return balance(system, PATCHES.moved(amount * unit), 0.4, target, 1e-12, sizes)

    slope = derivative(lambda d: at(d).potential, 3e-4)
    assert here.gradient[edge] == pytest.approx(slope, abs=1e-9 * np.abs(here.gradient).max())  # measured 2e-11
    column = derivative(lambda d: at(d).gradient, 3e-4)
    limit = 1e-8 * np.abs(here.hessian).max()  # measured 2e-10
    np.testing.assert_allclose(here.hessian[:, edge], column, rtol=0, atol=limit)


def test_soft_control_lies_between_penetration_and_load():
    """The harder the control, the larger the smallest eigenvalue."""
    load = reached(*CONTROLS["penetration"]).load
    least = []
    for control in (DisplacementControl(), DisplacementControl(0.2), LoadControl()):
        here = balance(System(ELASTIC, UniformLaw(0.05), control), PATCHES, 1.3, control.value(1.3, load), 1e-12)
        assert here.state.penetration == pytest.approx(1.3, rel=1e-12)
        least.append(np.linalg.eigvalsh((here.hessian + here.hessian.T) / 2)[0])
    assert least[0] > least[1] > least[2]


def test_energies_do_not_feel_how_stiff_the_spring_is():
    """An almost incompressible layer is a spring 1e9 times as stiff as the contact."""
    state = reached(DisplacementControl(), 1.3)
    held, sprung = (
        control.potential(state.penetration, state.load, state.elastic_energy)
        for control in (DisplacementControl(), DisplacementControl(1e-9))
    )
    assert sprung - held == pytest.approx(1e-9 * state.load**2 / 2, rel=3e-7)  # measured 1.1e-7: rounding of the energy
