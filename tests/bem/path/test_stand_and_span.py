"""The curve of equilibria: its derivatives against differences, and spans of it around Johnson's fold."""

import numpy as np
import pytest
from johnson_branch import AMPLITUDE, johnson, lowest, resting, waves

from bem.adhesive.equilibrium import balance
from bem.adhesive.third_derivatives import with_slopes
from bem.loading.control import DisplacementControl, LoadControl
from bem.path.locating import Refused
from bem.path.span import MISFIT, Span
from bem.path.stand import first_stand, stand_near
from bem.path.steps import LONGER, Way, growth, predicted, step_from

TOLERANCE = 1e-12
CONTROLS = {"Delta": DisplacementControl(), "spring": DisplacementControl(0.7), "load": LoadControl()}
by_control = pytest.mark.parametrize("control", CONTROLS.values(), ids=CONTROLS)


def begin(control, value, direction=-1.0, orders=(1,), amplitudes=(AMPLITUDE,)):
    system = waves(control, orders, amplitudes)
    here = with_slopes(system, resting(system, [2 * np.pi], 1.0, value), value, TOLERANCE)
    point = first_stand(system, here, value, direction)
    return system, at_itself(system, at_itself(system, point))


def at_itself(system, point, patches=None, value=None):
    """The point of the curve in the same plane, evaluated next to itself."""
    patches, value = patches or point.patches, point.value if value is None else value
    here = balance(system.sloped, patches, point.numbers.penetration, value, TOLERANCE)
    normal = point.rate / point.unit**2
    return stand_near(system, here, value, normal, float(normal @ point.rate))


@by_control
def test_a_point_has_the_derivatives_that_differences_say(control):
    """Of two waves, which move the edges unevenly: from points in planes a little before and behind it."""
    system, point = begin(control, 0.5, 1.0, (1, 2, 3), (1.2, 0.1, 0.2))
    step = 1e-3 / point.speed
    sides = []
    for s in (-step, step):
        moved = point.patches.moved(s * point.rate)
        there = at_itself(system, point, moved, point.value + s * point.control_rate)
        for _ in range(2):
            there = at_itself(system, point, there.patches, there.value)
        motion = np.concatenate([point.patches.left - there.patches.left, there.patches.right - point.patches.right])
        sides.append(np.append(motion, there.value - point.value))
    first = (sides[1] - sides[0]) / (2 * step)
    second = (sides[1] + sides[0]) / step**2
    size = np.abs(first).max()
    np.testing.assert_allclose(
        np.append(point.rate, point.control_rate), first, rtol=0, atol=3e-6 * size
    )  # measured 1.1e-6, of differences
    bend = np.append(point.bend, point.control_bend)
    np.testing.assert_allclose(bend, second, rtol=0, atol=1e-3 * np.abs(second).max())


@pytest.mark.parametrize("quantity", ["penetration", "load"])
def test_the_control_turns_on_a_piece_around_johnsons_fold(quantity):
    """A quintic in a step of a tenth of the edge scale is off by its sixth power."""
    control = LoadControl() if quantity == "load" else DisplacementControl()
    system, at = begin(control, 0.9 * lowest(quantity))
    way = Way(-1.0, -np.inf, 0.15, np.inf, TOLERANCE)
    for _ in range(30):
        span = step_from(system, at, predicted(at, 0.1, way), way)
        assert not isinstance(span, Refused)
        if span.last.control_rate * way.direction < 0:
            break
        at = span.last
    span = Span.between(at_itself(system, span.first), at_itself(system, span.last))
    (place,) = span.turns()
    start = span.at(float(place))
    patches, value = start.patches, start.value
    assert value == pytest.approx(lowest(quantity), rel=1e-6)
    psi = patches.width[0] / 4
    assert johnson(quantity, psi) == pytest.approx(lowest(quantity), rel=1e-6)
    assert span.last.lowest[0].size == 1
    assert span.holds(patches, value)
    assert not span.holds(patches.moved(0.1 * span.first.unit), value)
    assert not span.holds(patches, value + 0.1 * span.rise)
    for s, within in ((-0.3, False), (0.0, True), (1.0, True), (1.3, False)):
        point = span.at(s)
        assert span.holds(point.patches, point.value) == within


def test_a_piece_fits_the_better_the_shorter_it_is():
    """What both ends say of the chord differs by the fifth power of its length: over the chord 16 for half."""
    system, at = begin(DisplacementControl(), 0.5)
    misfits = []
    for length in (0.15, 0.075):
        way = Way(-1.0, -np.inf, length, np.inf, TOLERANCE)
        there = at_itself(system, step_from(system, at, predicted(at, length, way), way).last)
        misfits.append(Span.between(at, there).misfit)
    assert misfits[0] < 1e-3
    assert misfits[0] / misfits[1] > 10


def test_a_step_is_no_longer_than_asked_and_ends_a_little_beyond_the_goal():
    _, at = begin(DisplacementControl(), 0.5)
    motion, change = predicted(at, 0.1, Way(-1.0, -np.inf, 0.1, np.inf, TOLERANCE))
    assert np.max(np.abs(motion / at.unit)) == pytest.approx(0.1, rel=1e-2)
    _, bounded = predicted(at, 0.1, Way(-1.0, -np.inf, 0.1, 1e-3, TOLERANCE))
    assert change < -1e-3
    assert bounded == pytest.approx(-1e-3, rel=1e-9)
    _, last = predicted(at, 0.1, Way(-1.0, 0.499, 0.1, np.inf, TOLERANCE))
    assert last == pytest.approx((1 + MISFIT) * (0.499 - at.value), rel=1e-9)


def test_the_next_step_grows_with_the_root_of_how_good_the_last_was():
    system, at = begin(DisplacementControl(), 0.5)
    way = Way(-1.0, -np.inf, 0.15, np.inf, TOLERANCE)
    span = step_from(system, at, predicted(at, 0.01, way), way)
    assert growth(span) == pytest.approx(LONGER)


def test_a_step_into_overlap_is_refused_by_name():
    system, at = begin(DisplacementControl(), 0.5)
    way = Way(-1.0, -np.inf, 5.0, np.inf, TOLERANCE)
    assert step_from(system, at, (-3 * at.unit, 0.0), way) is Refused.OVERLAP
