"""Contact without adhesion: Westergaard, the conditions of Signorini, uniqueness, and the dense reference."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from judges import evaluate_dense
from scipy.optimize import brentq

from bem.elastic.collocation import Elastic
from bem.elastic.gap import gap_field, low_minima
from bem.geometry.patches import TWO_PI, PatchPressure
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl, LoadControl
from bem.loading.increments import Accuracy
from bem.nonadhesive.grid_contact import grid_problem
from bem.nonadhesive.nonadhesive import _gaps_under_tension, edge_residual, solve_contact
from bem.nonadhesive.tension import under_tension

WAVE = Profile.from_harmonics(2 * np.pi, [1], [1.0])
FIXED, LOADED = DisplacementControl(), LoadControl()
ACCURACY = Accuracy(1e-10, 1e-11, 1e-10)


def profile_of(seed, harmonics=30):
    return Profile.self_affine(2 * np.pi, 0.7, 1.0, harmonics, seed).scaled()


def solved(profile, target, control=FIXED, start=None, penetration=1.0):
    elastic = Elastic(profile)
    patches = grid_problem(elastic).patches(control, target) if start is None else start
    return solve_contact(elastic, control, patches, penetration, target, ACCURACY)


@pytest.mark.parametrize("fraction", [1e-3, 0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.95])
@pytest.mark.parametrize("control", [FIXED, LOADED], ids=["penetration", "load"])
def test_one_wave_is_westergaards(fraction, control):
    S = np.sin(np.pi * fraction / 2) ** 2
    penetration, load = S * (1 - np.log(S)), 2 * np.pi * S
    target = penetration if control is FIXED else load
    found = solved(WAVE, target, control)
    assert found.status == "converged"
    assert found.state.patches.contact_fraction == pytest.approx(fraction, abs=1e-11)  # measured 4.3e-12, asked 1e-10
    assert found.state.load == pytest.approx(load, rel=1e-10, abs=1e-12)
    assert found.state.penetration == pytest.approx(penetration, abs=1e-12)


@settings(max_examples=15)
@given(seed=st.integers(0, 100), penetration=st.floats(0.1, 2.5))
def test_pressure_is_compressive_and_surfaces_do_not_overlap(seed, penetration):
    profile = profile_of(seed)
    found = solved(profile, min(penetration, 0.95 * profile.max_height))
    assert found.status == "converged"
    assert edge_residual(found.state) <= 1e-9
    pressure = found.state.pressure()
    for q in pressure.charges:
        t = np.cos((np.arange(4 * q.size) + 0.5) * np.pi / (4 * q.size))
        assert np.polynomial.chebyshev.chebval(t, q).min() >= -1e-8 * np.abs(q).max()  # measured 1e-10
    minima = low_minima(gap_field(Elastic(profile), found.state))
    assert np.all(minima.depth >= -1e-9)


@settings(max_examples=10)
@given(seed=st.integers(0, 100), factor=st.floats(0.2, 0.95))
def test_load_grows_with_penetration(seed, factor):
    profile = profile_of(seed)
    deep = 0.6 * profile.max_height
    low, high = solved(profile, factor * deep).state, solved(profile, deep).state
    assert low.load < high.load
    # convex: the slope of the chord lies between the stiffnesses at its ends
    chord = (high.load - low.load) / (high.penetration - low.penetration)
    assert low.load_rate <= chord * (1 + 1e-9)
    assert chord <= high.load_rate * (1 + 1e-9)


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("before", [0.2, 1.4], ids=["from less contact", "from more contact"])
def test_solution_does_not_depend_on_the_start(seed, before):
    profile = profile_of(seed)
    plain, other = solved(profile, 1.0).state, solved(profile, 1.0, start=solved(profile, before).state.patches).state
    left, expected = np.sort(other.patches.left % TWO_PI), np.sort(plain.patches.left % TWO_PI)
    np.testing.assert_allclose(left, expected, atol=1e-9)
    assert other.load == pytest.approx(plain.load, rel=1e-10)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_load_control_finds_the_state_of_penetration_control(seed):
    profile = profile_of(seed)
    plain = solved(profile, 1.0).state
    other = solved(profile, plain.load, LOADED).state
    assert other.penetration == pytest.approx(1.0, abs=1e-10)
    assert other.patches.contact_fraction == pytest.approx(plain.patches.contact_fraction, abs=1e-10)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_dense_reference_agrees_that_nothing_is_singular(seed):
    profile = profile_of(seed)
    state = solved(profile, 1.0).state
    dense = evaluate_dense(profile, state.patches.left, state.patches.right, 1.0)
    assert np.abs(dense.stress_intensity).max() <= 1e-9  # measured 1e-11
    assert dense.load == pytest.approx(state.load, rel=1e-10)


@pytest.mark.parametrize("order", [2, 7])
def test_equal_crests_carry_equal_loads(order):
    """Without adhesion a symmetric profile has a symmetric contact, at any load."""
    wave = Profile.from_harmonics(2 * np.pi, [order], [1.0], [0.4])
    S = np.sin(np.pi * 0.6 / 2) ** 2
    state = solved(wave, S * (1 - np.log(S))).state
    assert state.patches.count == order
    np.testing.assert_allclose(state.patches.width, 2 * np.pi * 0.6 / order, atol=1e-10)
    assert state.load == pytest.approx(2 * np.pi * order * S, rel=1e-10)


def test_a_gap_is_opened_where_pressure_dips_between_nodes_below_a_lower_node():
    """q = ((t - a)^2 + 1e-3)((t - b)^2 - 1e-3), a at one of the 24 nodes and b between two: lowest at a, at nodes."""
    angle = (np.arange(24) + 0.5) * np.pi / 24
    a, b = np.cos(angle[15]), np.cos((angle[7] + angle[8]) / 2)
    series = np.polynomial.chebyshev.poly2cheb(np.polymul([1, -2 * a, a * a + 1e-3], [1, -2 * b, b * b - 1e-3])[::-1])
    pressure = PatchPressure(np.array([1.0]), np.array([3.0]), (np.append(series, np.zeros(12 - series.size)),))
    (gap,), doubtful = _gaps_under_tension(Elastic(profile_of(0)), pressure, 1e-10)
    assert not doubtful
    assert gap.mean() == pytest.approx(2 + b, abs=2e-3)  # measured 1.1e-3: the factor leans
    assert np.ptp(gap) == pytest.approx(2 * np.sqrt(2 * 1e-3), rel=0.02)  # sqrt 2 times as wide as the tension


@pytest.mark.parametrize("size", [20, 300])  # transforms by a matrix, and by FFT
def test_tension_beyond_rounding_is_seen_at_any_number_of_nodes(size):
    """A patch with q = t^2 - lowest."""
    for lowest, seen in ((0.09, set()), (0.11, {0})):
        series = np.append([0.5 - lowest, 0.0, 0.5], np.zeros(size - 3))
        assert set(under_tension(PatchPressure(np.zeros(1), np.ones(1), (series,)), 0.1)) == seen


@pytest.mark.parametrize("roundings", [1, 3, 10, 100, 1000, 1e4, 1e5])
def test_penetrations_near_rounding_of_the_heights_are_one_small_patch(roundings):
    """Westergaard's load to rounding; noise of the heights is no tension, which would split the patch for ever."""
    penetration = roundings * np.finfo(float).eps
    S = brentq(lambda S: S * (1 - np.log(S)) - penetration, 1e-30, 1e-6, xtol=1e-30)
    found = solved(WAVE, penetration)
    assert found.state.patches.count == 1
    assert found.evaluations <= 60  # measured 42
    assert abs(found.state.load - 2 * np.pi * S) <= 1e-14  # measured 4e-15
