"""Touch points: how the gap beside contact opens, against differences, and what Newton finds where it closes."""

import numpy as np
import pytest

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.branch import outward_motion
from bem.adhesive.descent import Steps, descend
from bem.adhesive.equilibrium import System, balance, correct
from bem.continuation.touch_points import Bracket, gap_rates, locate_touch, probed
from bem.elastic.collocation import Elastic
from bem.elastic.compliance import Compliance
from bem.elastic.gap import gap_field, minima_near
from bem.elastic.kernel_series import kernel_series
from bem.elastic.layer import LayerEffect
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl, LoadControl
from bem.loading.increments import Accuracy

TOLERANCE = 1e-9
CONTROLS = {"Delta": DisplacementControl(), "spring": DisplacementControl(0.7), "load": LoadControl()}
LAYERS = {"half-space": None, "layer": Compliance(kernel_series(LayerEffect(0.6, 0.4), 1e-16))}
by_control = pytest.mark.parametrize("control", CONTROLS.values(), ids=CONTROLS)
by_layer = pytest.mark.parametrize("compliance", LAYERS.values(), ids=LAYERS)


def system_of(control, compliance):
    """Two crests, of which the lower is not in contact yet."""
    profile = Profile.from_harmonics(2 * np.pi, [1, 2], [0.5, 1.0])
    return System(Elastic(profile, compliance), UniformLaw(0.2), control)


@by_layer
@by_control
def test_a_gap_opens_as_differences_say(control, compliance):
    system, start = system_of(control, compliance), Patches(np.array([-0.7, 2.0]), np.array([0.6, 2.3]))
    place, beside = 3.3, np.array([1])
    here = balance(
        probed(system, np.array([4.0, place - 3e-5]), np.array([4.01, place + 1e-5])), start, 0.4, 0.4, TOLERANCE
    )

    def gap(step, change=0.0):
        state = balance(system, start.moved(step), 0.4, 0.4 + change, TOLERANCE, here.state.resolution).state
        return float(gap_field(system.elastic, state)(np.array([place]), beside)[0])

    step = 1e-4
    units = step * np.eye(4)
    by_edges, by_value = gap_rates(system, here, 1, 0.75)
    differences = [(gap(unit) - gap(-unit)) / (2 * step) for unit in units]
    np.testing.assert_allclose(by_edges, differences, rtol=0, atol=3e-8)  # measured 1.1e-8, of differences
    zero = np.zeros(4)
    assert by_value == pytest.approx((gap(zero, step) - gap(zero, -step)) / (2 * step), abs=4e-10)  # measured 1.3e-10


def resting(system, patches, value):
    """Equilibrium to the tests' tolerance, near given edges."""
    found = correct(system, patches, 0.0, value, Accuracy(TOLERANCE, 0.1 * TOLERANCE))
    assert found.status == "converged"
    return found.balance


def gap_beside(system, here):
    """The least gap beside contact, where the lower crest is."""
    return minima_near(gap_field(system.elastic, here.state), np.array([np.pi]), np.array([0]))


def around_touch(system):
    """Two equilibria an increment apart, with their values of the control, between which the gap closes."""
    start = descend(system, Patches(np.array([-0.9]), np.array([0.9])), 0.0, 0.5, Accuracy(1e-3, 1e-4), Steps(0.2))
    states = [(resting(system, start.balance.state.patches, 0.5), 0.5)]
    while gap_beside(system, states[-1][0]).depth[0] > 0:
        value = states[-1][1] + 0.1
        states.append((resting(system, states[-1][0].state.patches, value), value))
    return states[-2:]


def touch_between(system, ends):
    """The touch that is looked for between two equilibria."""
    (before, first), (behind, last) = ends
    motion = outward_motion(before.state.patches, behind.state.patches)
    found = gap_beside(system, behind)
    bracket = Bracket((first, last), (gap_beside(system, before).depth, found.depth), found, 1e-3)
    return locate_touch(
        system,
        lambda value: before.state.patches.moved((value - first) / (last - first) * motion),
        before.state.penetration,
        bracket,
        (1e-5, TOLERANCE),
    )


@by_layer
@by_control
def test_a_touch_is_where_the_gap_of_an_equilibrium_vanishes(control, compliance):
    system = system_of(control, compliance)
    ends = around_touch(system)
    counted = system.effort.evaluations
    touch = touch_between(system, ends)
    assert system.effort.evaluations - counted <= 3  # measured 2
    at = resting(system, touch.balance.state.patches, touch.exact.value)
    assert abs(gap_beside(system, at).depth[0]) <= 1e-13  # measured 1e-15
    reached = (at.state.penetration, at.state.load, at.potential)
    found = touch.exact.penetration, touch.exact.load, touch.exact.potential
    np.testing.assert_allclose(found, reached, rtol=0, atol=4e-14)  # measured 1.3e-14
    assert 0 < touch.error.value <= 4e-8  # measured up to 1.2e-8


def test_a_touch_behind_the_bracket_is_not_taken():
    system = system_of(DisplacementControl(), None)
    before, behind = around_touch(system)
    short = resting(system, before[0].state.patches, before[1] - 0.1), before[1] - 0.1
    assert touch_between(system, (before, behind)) is not None
    assert touch_between(system, (short, before)) is None
