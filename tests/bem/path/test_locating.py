"""States that meet a condition: convergence of Newton, Johnson's contact at Delta and load, errors of what is found."""

from dataclasses import replace

import numpy as np
import pytest
from johnson_branch import johnson, lowest, resting, waves

from bem.geometry.patches import Patches
from bem.loading.control import DisplacementControl, LoadControl
from bem.loading.increments import Accuracy, Effort
from bem.path.fold import NeutralMode
from bem.path.locating import AtControl, AtLoad, InPlane, Refused, Start, locate, settle

SYSTEM, UNDER_LOAD = waves(DisplacementControl()), waves(LoadControl())
FINE = Accuracy(1e-13, 1e-12)


def patch(psi):
    return Patches(np.array([-2 * psi]), np.array([2 * psi]))


def started(psi, offset, value, penetration=0.5):
    patches = patch(psi)
    return Start(patches.moved(offset * patches.edge_scale), penetration, value)


@pytest.mark.parametrize("psi", [0.2, 0.5, 0.9, 1.4, 1.5])
@pytest.mark.parametrize("offset", [-0.03, 0.03])
def test_newton_finds_johnsons_contact(psi, offset):
    value = float(johnson("penetration", psi))
    here, at = settle(SYSTEM, started(psi, offset, value), AtControl(value), FINE)
    assert at == value
    assert here.state.patches.width[0] / 4 == pytest.approx(psi, abs=1e-12)
    assert here.state.load == pytest.approx(float(johnson("load", psi)), abs=3e-12)


def test_newton_finds_johnsons_contact_under_load():
    value = float(johnson("load", 0.6))
    here, _ = settle(UNDER_LOAD, started(0.61, 0.0, value), AtControl(value), FINE)
    assert here.state.patches.width[0] / 4 == pytest.approx(0.6, abs=1e-12)
    assert here.state.penetration == pytest.approx(float(johnson("penetration", 0.6)), abs=2e-12)


@pytest.mark.parametrize("psi", [0.3, 0.6, 1.2])
def test_a_load_is_found_under_penetration_control(psi):
    """Also where the load falls as the penetration grows."""
    value, load = float(johnson("penetration", 1.01 * psi)), float(johnson("load", psi))
    here, at = settle(SYSTEM, started(1.01 * psi, 0.0, value), AtLoad(SYSTEM, load, 1e-12), FINE)
    assert at == pytest.approx(float(johnson("penetration", psi)), abs=1e-11)
    assert here.state.load == pytest.approx(load, abs=1e-11)


def test_newton_converges_quadratically():
    value = float(johnson("penetration", 0.6))
    systems = [replace(SYSTEM, effort=Effort()) for _ in range(3)]
    for system, residual in zip(systems, (1e-3, 1e-6, 1e-12), strict=True):
        found = settle(system, started(0.6, 0.05, value), AtControl(value), Accuracy(1e-13, residual))
        assert not isinstance(found, Refused)
    counts = [system.effort.evaluations for system in systems]
    assert counts[2] - counts[1] <= 1
    assert counts[2] <= 6


def test_newton_refuses_to_go_far():
    value = float(johnson("penetration", 0.7))
    assert settle(SYSTEM, started(1.0, 0.0, value), AtControl(value), FINE) is Refused.FAR


def test_newton_says_when_it_stands_on_no_branch():
    """Beyond pull-off there is no equilibrium."""
    psi = np.linspace(0.01, 0.8, 100_001)
    turn = float(psi[np.argmin(johnson("penetration", psi))])
    value = lowest("penetration") - 0.02
    assert isinstance(settle(SYSTEM, started(turn, 0.0, value), AtControl(value), FINE), Refused)


@pytest.mark.parametrize(("system", "quantity"), [(SYSTEM, "penetration"), (UNDER_LOAD, "load")], ids=["Delta", "load"])
def test_a_fold_is_where_johnsons_branch_turns(system, quantity):
    """Located by few evaluations, with an error that bounds its distance from the closed form."""
    exact = lowest(quantity)
    here = resting(system, [0.0], 0.8, 0.95 * exact)
    scale, before = here.scale, system.effort.evaluations
    on = NeutralMode(system, scale, np.ones(2) / np.sqrt(2))
    found = locate(system, Start(here.state.patches, here.state.penetration, 0.95 * exact), on, 1e-8)
    assert found.numbers.value == pytest.approx(exact, rel=1e-11)
    assert abs(found.numbers.value - exact) <= 3 * found.error.value + 1e-13
    assert found.error.value < 1e-4
    assert system.effort.evaluations - before <= 8
    assert np.all(on.others > 0)


def test_edges_in_a_plane_are_of_the_branch():
    value = float(johnson("penetration", 0.6))
    patches = patch(0.65)
    normal = np.ones(2)
    found = locate(SYSTEM, Start(patches, 0.5, value), InPlane(patches, normal), 1e-12)
    assert found.patches.width[0] / 4 == pytest.approx(0.65, abs=1e-11)
    assert found.numbers.value == pytest.approx(float(johnson("penetration", 0.65)), abs=1e-11)


def test_overlapping_edges_are_refused_by_name():
    crossed = Patches(np.array([1.0]), np.array([0.5]))
    assert settle(SYSTEM, Start(crossed, 0.5, 0.5), AtControl(0.5), FINE) is Refused.OVERLAP


def test_edges_under_compression_are_refused_by_name():
    narrow = patch(0.1)
    assert settle(SYSTEM, Start(narrow, 0.9, 0.9), AtControl(0.9), FINE) is Refused.COMPRESSED
