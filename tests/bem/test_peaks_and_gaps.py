"""The largest pressure and the largest gap of states at targets, against closed forms and exact extrema."""

import numpy as np
import pytest
from rough_scene import ROUGH

import bem
from bem.observables.pressure_distribution import patch_branches
from bem.scene.state import CLOSED

PERIOD, HEIGHT, MODULUS = 0.01, 1e-4, 1e6 / 0.75
WAVE = {
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "profile": {"kind": "harmonics", "period": PERIOD, "orders": [1], "amplitudes": [HEIGHT], "phases": [0.0]},
}


@pytest.mark.parametrize("fraction", [0.05, 0.5, 0.97])
def test_a_wave_has_the_peak_and_the_gap_of_westergaard(fraction):
    share = np.sin(np.pi * fraction / 2)
    pressure = np.pi * MODULUS * HEIGHT / PERIOD * share**2
    (state,) = bem.solve(WAVE | {"loading": {"control": "mean_pressure", "targets": [pressure]}}).targets
    assert state.contact_fraction == pytest.approx(fraction, rel=1e-8)
    assert state.peak_pressure == pytest.approx(2 * pressure / share, rel=1e-11)
    profile = bem.Profile.from_harmonics(PERIOD, [1], [HEIGHT])
    edges = [[-fraction * PERIOD / 2, fraction * PERIOD / 2]]
    alone = bem.ContactState(profile, bem.Solid(1e6, 0.5), edges, state.penetration)
    trough = alone.displacement([PERIOD / 2])[0] + HEIGHT - (state.penetration - HEIGHT)
    assert state.largest_gap == pytest.approx(trough, rel=2e-3)  # measured 8e-4: the highest of 16 points a wave


def test_the_last_gap_is_a_crack_in_a_bending_pressure():
    fraction = 0.9999
    pressure = np.pi * MODULUS * HEIGHT / PERIOD * np.sin(np.pi * fraction / 2) ** 2
    (state,) = bem.solve(WAVE | {"loading": {"control": "mean_pressure", "targets": [pressure]}}).targets
    mean = state.separation / (1 - state.contact_fraction)  # of (1 - t^2)^(3/2), 3 pi / 16 of the largest
    assert state.largest_gap == pytest.approx(mean / (3 * np.pi / 16), rel=2e-3)
    t, gaps = np.linspace(-1, 1, 20001), state.gaps
    shape = (1 - t**2) ** 1.5
    assert gaps.mean_open == pytest.approx(mean, rel=1e-9)
    cubic = np.cbrt(np.mean(shape**3) * (1 - fraction)) / np.mean(shape) * mean
    assert gaps.mean_cubic_root == pytest.approx(cubic, rel=1e-4)
    assert gaps.quantiles.p50 == pytest.approx(np.median(shape) / np.mean(shape) * mean, rel=1e-2)
    assert gaps.widest_channel == pytest.approx((1 - fraction) * PERIOD, rel=1e-6)


def test_surfaces_apart_have_a_gap_and_no_peak():
    (state,) = bem.solve(WAVE | {"loading": {"control": "separation", "targets": [3e-4]}}).targets
    assert state.peak_pressure is None
    assert state.largest_gap == pytest.approx(3e-4 + HEIGHT, rel=1e-12)
    cube = 3e-4**3 + 1.5 * 3e-4 * HEIGHT**2  # the mean of (s + h)^3 over a wave
    assert state.gaps.mean_cubic_root == pytest.approx(np.cbrt(cube), rel=1e-12)
    assert (state.gaps.mean_open, state.gaps.widest_channel, state.gaps.open_fraction) == (3e-4, PERIOD, 1.0)


def test_complete_contact_has_a_peak_and_no_gap():
    (state,) = bem.solve(WAVE | {"loading": {"control": "mean_pressure", "targets": [1e5]}}).targets
    assert state.status == "complete_contact"
    assert state.largest_gap == 0.0
    assert state.gaps == CLOSED
    assert state.peak_pressure == pytest.approx(1e5 + np.pi * MODULUS * HEIGHT / PERIOD, rel=1e-12)


def test_of_a_rough_profile_they_are_those_of_its_edges_and_at_targets_alone():
    scene = bem.parse_scene(ROUGH)
    result = bem.solve(scene)
    assert all(state.peak_pressure is None and state.largest_gap is None for state in result.states if not state.target)
    for state in result.targets:
        if state.edges:
            alone = bem.ContactState(scene.surface(), bem.Solid(1e6, 0.5), state.edges, state.penetration)
            highest = patch_branches(alone.evaluation.pressure()).extrema.max() * alone.scales.stress
            assert state.peak_pressure == pytest.approx(highest, rel=4e-6)  # measured 1.2e-6
            x = np.linspace(0.0, 0.01, 20000, endpoint=False)
            gap = alone.displacement(x) - scene.surface().height(x) + scene.surface().max_height - state.penetration
            assert state.largest_gap == pytest.approx(gap.max(), rel=1.5e-3)  # measured 4.8e-4
            gaps, inside = state.gaps, gap > 1e-12
            assert gaps.mean_open == pytest.approx(gap[inside].mean(), rel=2e-4)
            assert gaps.mean_cubic_root == pytest.approx(np.cbrt(np.mean(gap**3)), rel=1e-5)
            sampled = np.quantile(gap[inside], [0.1, 0.25, 0.5, 0.75, 0.9])
            quantiles = [*vars(gaps.quantiles).values()]
            assert quantiles == pytest.approx(sampled, rel=2e-2)
            left, right = np.transpose(state.edges)
            assert gaps.widest_channel == pytest.approx(max(np.append(left[1:], left[0] + PERIOD) - right), rel=1e-12)
