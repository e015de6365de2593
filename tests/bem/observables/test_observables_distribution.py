"""The pressure distribution against exact shares, its tail, its moments, and brute-force sampling."""

import numpy as np
import pytest
from judges import dense_nodes, evaluate_dense

from bem.geometry.patches import PatchPressure
from bem.geometry.profile import Profile
from bem.observables.pressure_distribution import (
    complete_contact_distribution,
    patch_branches,
    pressure_distribution,
    profile_branches,
    share_below,
)

HALF = np.array([1.0])
HERTZ = PatchPressure(-HALF, HALF, (np.array([0.5, 0.0, -0.5]),))  # sqrt(1 - x^2)
JKR = PatchPressure(-HALF, HALF, (np.array([0.5 - 0.3, 0.0, -0.5]),))  # both


@pytest.fixture(scope="module")
def rough():
    profile = Profile.self_affine(2 * np.pi, 0.7, 1.0, 40, 0).scaled()
    left, right = np.array([0.5, 1.9, 5.5]), np.array([1.2, 2.2, 6.6])
    return evaluate_dense(profile, left, right, 0.0, dense_nodes(profile, left, right) + 10)


def share_by_sampling(pressure, levels, points=400_000):
    """Share of the period below levels by counting samples that are equidistant in theta, weighted with |dx|."""
    theta = (np.arange(points) + 0.5) * np.pi / points
    total = np.zeros(levels.size)
    for left, right, charge in zip(pressure.left, pressure.right, pressure.charges, strict=True):
        radius = (right - left) / 2
        sigma = np.polynomial.chebyshev.chebval(np.cos(theta), charge) / (radius * np.sin(theta))
        order = np.argsort(sigma)
        weight = np.concatenate([[0.0], np.cumsum((radius * np.sin(theta) * np.pi / points)[order])])
        total += weight[np.searchsorted(sigma[order], levels)]
    return total / (2 * np.pi)


def tail_share(distribution, level):
    """Share of the period that the tail alone puts below a level < 0."""
    return distribution.tail_coefficient / (2 * level * level)


def hertz_share(s):
    return (1 - np.sqrt(1 - np.clip(s, 0, 1) ** 2)) / np.pi


def jkr_share(s):
    """sigma = (y^2 - 0.3) / y with y = sqrt(1 - x^2) is below s for y below the positive root."""
    y = np.minimum((s + np.sqrt(s * s + 1.2)) / 2, 1.0)
    return (1 - np.sqrt(1 - y * y)) / np.pi


@pytest.mark.parametrize(("pressure", "share"), [(HERTZ, hertz_share), (JKR, jkr_share)], ids=["Hertz", "adhesive"])
def test_shares_are_exact(pressure, share):
    levels = np.concatenate([-np.geomspace(1e3, 1e-3, 60), np.linspace(0, 0.999, 80)])
    found = share_below(patch_branches(pressure), levels)
    # measured 4e-13
    np.testing.assert_allclose(found, share(levels), rtol=0, atol=1.2e-12)


def test_small_shares_in_the_tail_keep_their_digits():
    levels = -np.geomspace(1e4, 10, 20)
    y = 0.6 / (-levels + np.sqrt(levels**2 + 1.2))
    exact = y * y / (1 + np.sqrt(1 - y * y)) / np.pi
    np.testing.assert_allclose(share_below(patch_branches(JKR), levels), exact, rtol=2e-10)  # measured 6e-11


def test_rough_shares_are_those_of_samples(rough):
    levels = np.linspace(-30, 10, 81)
    found = share_below(patch_branches(rough.pressure), levels)
    # measured 7e-7: the sampling, 400000 points a patch
    np.testing.assert_allclose(found, share_by_sampling(rough.pressure, levels), rtol=0, atol=2e-6)


def test_all_of_the_contact_is_accounted_for(rough):
    found = pressure_distribution(rough.pressure)
    total = np.sum(found.density * np.diff(found.levels)) + found.below + found.above
    assert total == pytest.approx(1 - found.outside_contact, abs=1e-15)
    assert abs(found.above) <= 1e-15


@pytest.mark.parametrize("bins", [200, 400, 800], ids=lambda n: f"bins={n}")
def test_bins_share_one_cumulative_function(rough, bins):
    """No binning noise: coarse densities are means of fine ones."""
    levels = np.linspace(-20, 5, bins + 1)
    coarse = pressure_distribution(rough.pressure, levels).density
    fine = pressure_distribution(rough.pressure, np.linspace(-20, 5, 4 * bins + 1)).density
    np.testing.assert_allclose(coarse, fine.reshape(-1, 4).mean(axis=1), rtol=0, atol=1e-14)  # measured 4e-15


def test_tail_coefficient_is_that_of_the_stress_intensities(rough):
    expected = np.sum(rough.stress_intensity**2) / (2 * np.pi**2)
    assert pressure_distribution(rough.pressure).tail_coefficient == pytest.approx(
        expected, rel=3e-14
    )  # measured 9e-15


def test_compressive_edges_have_no_tensile_tail():
    pushed = PatchPressure(-HALF, HALF, (np.array([0.3]),))
    assert pressure_distribution(pushed).tail_coefficient == 0.0


@pytest.mark.parametrize("level", [-1e2, -1e3, -1e4], ids=lambda s: f"level={s:g}")
def test_far_tail_is_the_cubic_law(rough, level):
    found = pressure_distribution(rough.pressure)
    share = share_below(patch_branches(rough.pressure), np.array([level]))[0]
    # the next term of the expansion is of relative order 1/sigma^2 (measured -27 / sigma^2)
    assert share / tail_share(found, level) == pytest.approx(1.0, abs=60 / level**2)


def test_default_levels_without_adhesion_start_at_zero():
    found = pressure_distribution(HERTZ)
    assert found.levels[0] == 0.0
    assert found.levels[-1] == pytest.approx(1.0, abs=1e-12)
    assert found.tail_coefficient == 0.0


def test_sinusoid_in_complete_contact_has_the_arcsine_law():
    wave = Profile.from_harmonics(2 * np.pi, [3], [2.0], [0.4])
    levels = np.linspace(-0.99, 2.99, 50)
    found = share_below(profile_branches(wave, 1.0), levels)
    # measured 6e-12
    np.testing.assert_allclose(found, 1 - np.arccos((levels - 1) / 2) / np.pi, rtol=0, atol=1.8e-11)


def test_constant_pressure_has_no_density():
    with pytest.raises(ValueError, match="constant"):
        complete_contact_distribution(Profile.from_harmonics(2 * np.pi, [1], [0.0]), 1.0)
