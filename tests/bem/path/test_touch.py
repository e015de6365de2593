"""Touches: how the gap beside contact opens, against differences, and what Newton finds where it closes."""

from dataclasses import replace

import numpy as np
import pytest

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.descent import descend
from bem.adhesive.equilibrium import System, balance
from bem.adhesive.relaxation import interpenetration
from bem.adhesive.strides import Steps
from bem.adhesive.third_derivatives import with_slopes
from bem.elastic.collocation import Elastic
from bem.elastic.compliance import Compliance
from bem.elastic.far_field import Arc, Charges, far_fields
from bem.elastic.gap import GapMinima, gap_field, minima_near
from bem.elastic.kernel_series import kernel_series
from bem.elastic.layer import LayerEffect
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl, LoadControl
from bem.loading.increments import Accuracy
from bem.path.locating import AtControl, Refused, Start, settle
from bem.path.stand import first_stand
from bem.path.steps import Way, predicted, step_from
from bem.path.touch import GapCloses, locate_touch

TOLERANCE = 1e-9
CONTROLS = {"Delta": DisplacementControl(), "spring": DisplacementControl(0.7), "load": LoadControl()}
LAYERS = {"half-space": None, "layer": Compliance(kernel_series(LayerEffect(0.6, 0.4), 1e-16))}
by_control = pytest.mark.parametrize("control", CONTROLS.values(), ids=CONTROLS)
by_layer = pytest.mark.parametrize("compliance", LAYERS.values(), ids=LAYERS)


def system_of(control, compliance):
    """Two crests, of which the lower is not in contact yet."""
    profile = Profile.from_harmonics(2 * np.pi, [1, 2], [0.5, 1.0])
    return System(Elastic(profile, compliance), UniformLaw(0.2), control)


def assert_rates_are_differences(system, share=0.75):
    """Compare the rates of a gap by edges and by the control with differences, at a place between two probes."""
    start = Patches(np.array([-0.7, 2.0]), np.array([0.6, 2.3]))
    place, beside = 3.3, np.array([1])
    closes = GapCloses(system, GapMinima(np.array([place - 4e-5 * share]), np.zeros(1), beside), np.array([4e-5]))
    here = balance(closes.asked(system), start, 0.4, 0.4, TOLERANCE)

    def gap(step, change=0.0):
        state = balance(system, start.moved(step), 0.4, 0.4 + change, TOLERANCE, here.state.resolution).state
        return float(gap_field(system.elastic, state)(np.array([place]), beside)[0])

    step = 1e-4
    units = step * np.eye(4)
    by_edges, by_value = closes._rates(here, 0, share)
    differences = [(gap(unit) - gap(-unit)) / (2 * step) for unit in units]
    np.testing.assert_allclose(by_edges, differences, rtol=0, atol=3e-8)  # measured 1.1e-8, of differences
    zero = np.zeros(4)
    assert by_value == pytest.approx((gap(zero, step) - gap(zero, -step)) / (2 * step), abs=4e-10)  # measured 1.3e-10


@by_layer
@by_control
def test_a_gap_opens_as_differences_say(control, compliance):
    assert_rates_are_differences(system_of(control, compliance))


def test_a_gap_in_a_window_opens_as_differences_say():
    """The field of patches outside the window changes with the penetration, too: its part is 0.01."""
    system = system_of(DisplacementControl(), None)
    position, charge = np.array([4.9, 5.0]), np.array([0.02, 0.01])
    outside = (Charges(position, charge, 0.4), Charges(position, 3 * charge, 1.4))
    (far,) = far_fields([Arc(-1.2, 4.5, (0.2, 0.3))], *outside)
    assert_rates_are_differences(replace(system, elastic=replace(system.elastic, far=far)))


def resting(system, patches, value):
    """Equilibrium to the tests' tolerance, near given edges."""
    found = settle(system, Start(patches, 0.0, value), AtControl(value), Accuracy(TOLERANCE, 0.1 * TOLERANCE))
    assert not isinstance(found, Refused)
    return found[0]


def gap_beside(system, here):
    """The least gap beside contact, where the lower crest is."""
    return minima_near(gap_field(system.elastic, here.state), np.array([np.pi]), np.array([0]))


def span_with_touch(system):
    """The step along the curve in which the gap closes, and what is closed at its end."""
    start = descend(system, Patches(np.array([-0.9]), np.array([0.9])), 0.0, 0.5, Accuracy(1e-3, 1e-4), Steps(0.2))
    here = with_slopes(system, resting(system, start.balance.state.patches, 0.5), 0.5, TOLERANCE)
    way = Way(1.0, np.inf, 0.1, np.inf, TOLERANCE)
    at = first_stand(system, here, 0.5, 1.0)
    for _ in range(50):
        span = step_from(system, at, predicted(at, 0.1, way), way)
        assert not isinstance(span, Refused)
        found = interpenetration(system, span.last.balance.state, 1e-10)
        if found.position.size:
            return span, found
        at = span.last
    raise AssertionError("no gap closes")


@by_layer
@by_control
def test_a_touch_is_where_the_gap_of_an_equilibrium_vanishes(control, compliance):
    system = system_of(control, compliance)
    span, found = span_with_touch(system)
    counted = system.effort.evaluations
    touch = locate_touch(system, span, (span.last.balance.state, 1.0), found, TOLERANCE)
    assert system.effort.evaluations - counted <= 4
    assert 0 < touch.place < 1
    at = resting(system, touch.at.patches, touch.at.numbers.value)
    assert abs(gap_beside(system, at).depth[0]) <= 1e-11
    reached = (at.state.penetration, at.state.load, at.potential)
    exact = touch.at.numbers.penetration, touch.at.numbers.load, touch.at.numbers.potential
    np.testing.assert_allclose(exact, reached, rtol=0, atol=1e-11)


def test_a_touch_behind_the_piece_is_not_taken():
    system = system_of(DisplacementControl(), None)
    span, found = span_with_touch(system)
    way = Way(1.0, np.inf, 0.1, np.inf, TOLERANCE)
    behind = step_from(system, span.last, predicted(span.last, 0.1, way), way)
    assert isinstance(locate_touch(system, behind, (behind.last.balance.state, 1.0), found, TOLERANCE), Refused)
