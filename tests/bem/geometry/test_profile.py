"""The periodic profile: its table against the sum of cosines, its moments, crests, and scans of known profiles."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bem.geometry.profile import Profile


@st.composite
def profiles(draw):
    """A few harmonics of any order up to 60, amplitudes of order 1 in the curvature."""
    orders = draw(st.lists(st.integers(1, 60), min_size=1, max_size=6, unique=True))
    phases = [draw(st.floats(-3, 3)) for _ in orders]
    amplitudes = [draw(st.floats(0.1, 1.0)) / m for m in orders]
    return Profile.from_harmonics(draw(st.floats(0.1, 10.0)), orders, amplitudes, phases)


def cosines(profile, x, derivative):
    """The sum of cosines and its derivatives, term by term."""
    q = profile.orders * profile.q0
    angle = np.multiply.outer(x, q) + profile.phases + derivative * np.pi / 2
    return np.cos(angle) @ (profile.amplitudes * q**derivative)


@given(profile=profiles(), places=st.lists(st.floats(-3, 3), min_size=1, max_size=8))
@pytest.mark.parametrize("derivative", [0, 1, 2], ids=["height", "slope", "curvature"])
def test_table_is_the_sum_of_cosines(profile, places, derivative):
    x = np.array(places) * profile.period
    found = (profile.height, profile.slope, profile.curvature)[derivative](x)
    scale = np.sum(profile.amplitudes * (profile.orders * profile.q0) ** derivative)
    # measured 2.3e-13 (three periods away, where the angle itself is rounded)
    np.testing.assert_allclose(found, cosines(profile, x, derivative), rtol=0, atol=6e-13 * scale)


@pytest.mark.parametrize("derivative", [0, 1, 2], ids=["height", "slope", "curvature"])
def test_many_points_have_the_values_of_few(derivative):
    profile = Profile.self_affine(2 * np.pi, 0.7, 1.0, 60, 3)
    values = (profile.height, profile.slope, profile.curvature)[derivative]
    x = np.random.default_rng(4).uniform(-7, 7, (40, 20))
    few = np.stack([values(row) for row in x])
    # measured 9e-16 of the largest
    np.testing.assert_allclose(values(x), few, rtol=0, atol=3e-15 * np.abs(few).max())


def test_values_keep_the_shape_of_the_positions():
    profile = Profile.from_harmonics(1.0, [1, 3], [1.0, 0.5])
    assert profile.height(np.zeros((2, 3, 4))).shape == (2, 3, 4)
    assert profile.curvature(0.2).shape == ()


@given(profile=profiles())
def test_moments_are_those_of_the_samples(profile):
    x = np.arange(256) * (profile.period / 256)
    assert profile.rms_height == pytest.approx(np.sqrt(np.mean(cosines(profile, x, 0) ** 2)), rel=1e-12)
    assert profile.rms_slope == pytest.approx(np.sqrt(np.mean(cosines(profile, x, 1) ** 2)), rel=1e-12)


@given(profile=profiles())
def test_no_sample_is_higher_than_the_highest_crest(profile):
    x = np.arange(20_000) * (profile.period / 20_000)
    highest, scale = cosines(profile, x, 0).max(), np.abs(profile.amplitudes).sum()
    curvature = np.sum(profile.amplitudes * (profile.orders * profile.q0) ** 2)
    sag = curvature * x[1] ** 2 / 8  # what the samples may miss of a crest
    assert -1e-13 * scale <= profile.max_height - highest <= sag + 1e-13 * scale


@given(profile=profiles())
def test_crests_are_flat_maxima(profile):
    position, height = profile.crests
    scale = np.sum(profile.amplitudes * (profile.orders * profile.q0) ** 2)
    assert np.abs(cosines(profile, position, 1)).max() <= 1e-12 * scale * profile.period  # measured 2e-13
    assert cosines(profile, position, 2).max() <= 1e-6 * scale
    np.testing.assert_allclose(height, cosines(profile, position, 0), atol=1e-12)


@pytest.mark.parametrize("phase", [0.0, 3.0, -3.0, 1e-200])
def test_crests_lie_in_the_period(phase):
    position, _ = Profile.from_harmonics(1.0, [1], [1.0], [phase]).crests
    assert 0 <= position[0] < 1.0


def test_crests_ascend_also_where_one_lies_across_the_end_of_the_period():
    position, height = Profile.from_harmonics(2 * np.pi, [1, 2], [0.2, 1.0], [1e-3, 2e-3]).crests
    np.testing.assert_allclose(position, [np.pi - 1e-3, 2 * np.pi - 1e-3], atol=1e-9)
    assert height[0] < height[1]


def test_every_crest_of_a_wave_is_found():
    position, height = Profile.from_harmonics(1.0, [7], [2.0], [0.3]).crests
    expected = np.sort((np.arange(7) - 0.3 / (2 * np.pi)) / 7 % 1)
    np.testing.assert_allclose(np.sort(position), expected, atol=1e-15)
    np.testing.assert_allclose(height, 2.0, rtol=1e-15)


@pytest.mark.parametrize("hurst", [0.01, 0.5, 0.99])
def test_self_affine_law(hurst):
    profile = Profile.self_affine(0.01, hurst, 50e-6, 64, seed=3)
    np.testing.assert_allclose(
        profile.amplitudes / profile.amplitudes[0], np.arange(1.0, 65.0) ** -(hurst + 0.5), rtol=1e-13
    )
    assert profile.rms_height == pytest.approx(50e-6, rel=1e-14)


def test_phases_of_a_seed_are_those_of_numpy():
    profile = Profile.self_affine(1.0, 0.7, 1.0, 5, seed=2009)
    np.testing.assert_array_equal(profile.phases, np.random.default_rng(2009).uniform(-np.pi, np.pi, 5))


@given(profile=profiles())
def test_scaled_profile_has_unit_height_and_period_two_pi(profile):
    scaled = profile.scaled()
    assert scaled.rms_height == pytest.approx(1.0, rel=1e-14)
    x = np.linspace(0, 1, 17)
    expected = cosines(profile, x * profile.period, 0) / profile.rms_height
    np.testing.assert_allclose(scaled.height(x * 2 * np.pi), expected, atol=1e-12)


@pytest.mark.parametrize("offset", [0.0, 0.37], ids=["from zero", "from elsewhere"])
def test_samples_give_the_profile_back(offset):
    profile = Profile.self_affine(2.0, 0.6, 1.0, 20, seed=4)
    x = offset + np.arange(101) * (2.0 / 101)
    found = Profile.from_samples(x, profile.height(x) + 5.0, harmonics=20)
    assert found.period == pytest.approx(2.0, rel=1e-14)
    # measured 4e-15
    np.testing.assert_allclose(found.height(x), profile.height(x), atol=2e-14)


def test_line_is_taken_off():
    x = np.arange(400) / 400
    wave = np.cos(2 * np.pi * 9 * x)
    tilted = Profile.from_samples(x, wave + 3 * x, harmonics=9, detrend="line")
    assert tilted.amplitudes[-1] == pytest.approx(1.0, abs=0.02)  # the line through a wave is not quite level
    assert np.abs(tilted.amplitudes[:-1]).max() < 0.02


def test_cut_of_a_scan_drops_the_short_waves():
    x = np.arange(64) / 64
    found = Profile.from_samples(x, np.cos(2 * np.pi * x) + np.cos(2 * np.pi * 20 * x), harmonics=10)
    np.testing.assert_allclose(found.amplitudes, np.eye(10)[0], atol=1e-14)


def test_equal_parts_are_those_of_a_grating_and_of_a_mirror_image():
    orders, centre = np.arange(2, 400), 1.234
    rough = np.random.default_rng(3).uniform(-np.pi, np.pi, orders.size)
    turned = -centre * orders + np.pi * (orders % 3 == 0)
    nearly = turned + 1e-9 * (orders == 7)
    equal = [Profile(2 * np.pi, orders, orders**-1.2, phases).has_equal_parts for phases in (rough, turned, nearly)]
    assert equal == [False, True, False]
    assert Profile(2 * np.pi, 2 * orders, orders**-1.2, rough).has_equal_parts


def test_flat_profile_knows_it():
    flat = Profile.from_harmonics(1.0, [1, 2], [0.0, 0.0])
    assert flat.is_flat
    assert flat.max_height == 0.0
    with pytest.raises(ValueError, match="flat profile has no height scale"):
        flat.scaled()


@pytest.mark.parametrize("harmonics", [0, 8])
def test_cut_beyond_the_samples_is_refused(harmonics):
    with pytest.raises(ValueError, match=r"must lie in 1\.\.7 for 16 samples"):
        Profile.from_samples(np.arange(16.0), np.zeros(16), harmonics)


@pytest.mark.parametrize(("points", "detrend", "told"), [(15, "mean", "of shapes"), (16, "cubic", "detrend: 'cubic'")])
def test_samples_that_would_give_another_profile_are_refused(points, detrend, told):
    with pytest.raises(ValueError, match=told):
        Profile.from_samples(np.arange(16.0), np.ones(points), 3, detrend)
