"""Profiles of real size without adhesion: thousands of gaps of all widths, on a half-space and on layers."""

import numpy as np
import pytest

import bem
from bem.elastic.compliance import compliance_of
from bem.elastic.layer import Layer
from bem.nonadhesive.completed_body import CompletedBody

RUBBER = {"youngs_modulus": 5e7, "poisson_ratio": 0.49}


def solved(profile, targets, **tables):
    return bem.solve(profile=profile, loading={"control": "mean_pressure", "targets": targets}, **tables)


def rms_slope(profile):
    return float(np.sqrt(np.sum((profile.q0 * profile.orders * profile.amplitudes) ** 2) / 2))


def plane_strain_modulus(solid):
    return solid["youngs_modulus"] / (1 - solid["poisson_ratio"] ** 2)


def ground_surface(points=4000, seed=3):
    """A ground surface as a stylus leaves it: a flat spectrum up to order 15, grooves, and noise on every sample."""
    rng = np.random.default_rng(seed)
    orders = np.arange(1, points // 2)
    spectrum = np.zeros(points // 2 + 1, dtype=complex)
    spectrum[1:-1] = np.maximum(orders, 15.0) ** -1.3 * np.exp(2j * np.pi * rng.random(orders.size))
    heights = np.fft.irfft(spectrum, points)
    heights *= 0.5e-6 / heights.std()
    x = np.arange(points) * (4e-3 / points)
    for _ in range(60):
        center, width, depth = rng.uniform(0, 4e-3), rng.uniform(3e-6, 2e-5), rng.exponential(6e-7)
        heights -= depth * np.exp(-(((x - center) / width) ** 2))
    return bem.Profile.from_samples(x, heights + 4e-9 * rng.standard_normal(points), points // 2 - 1)


def test_a_noisy_scan_is_solved_with_all_its_harmonics():
    """From a quarter of the period in contact to 99 %; a load that grows, and a separation that falls."""
    solid = {"youngs_modulus": 8e6, "poisson_ratio": 0.49}
    result = solved(ground_surface(2000), [5e4, 2e5, 1.2e6], solid=solid)
    assert [state.status for state in result.targets] == ["converged"] * 3
    fractions = [state.contact_fraction for state in result.targets]
    assert fractions[0] < 0.3
    assert fractions[-1] > 0.98
    assert np.all(np.diff(fractions) > 0)
    assert np.all(np.diff([state.separation for state in result.targets]) < 0)
    assert max(state.n_patches for state in result.targets) > 180  # measured 200


def test_hundreds_of_gaps_of_all_widths():
    """An active set on a grid gives .9364, .9338, .9326 at 8, 16, 32 points a wave: it falls as the cells do."""
    profile = bem.Profile.self_affine(period=3e-3, hurst=0.7, rms_height=9.4e-8, harmonics=4500, seed=2)
    state, beside = solved(profile, [1.5e5, 1.5e5 * (1 + 1e-7)], solid=RUBBER).targets
    assert state.status == beside.status == "converged"  # rounding is 2e-14 and 1e-14 of the load
    assert state.contact_fraction == pytest.approx(0.9312, abs=3e-4)
    assert state.separation == pytest.approx(1.412e-11, rel=1e-3)  # the grid: 1.4123e-11, 1.4116e-11, 1.4119e-11


@pytest.mark.slow
def test_a_gap_that_opens_a_thousandth_of_a_wave_stays_open():
    """A coarse evaluation lost it again, for ever."""
    profile = bem.Profile.self_affine(period=0.01, hurst=0.5, rms_height=1e-6, harmonics=4000, seed=1)
    solid = {"youngs_modulus": 1e7, "poisson_ratio": 0.49}
    (state,) = solved(profile, [0.65 * plane_strain_modulus(solid) * rms_slope(profile)], solid=solid).targets
    assert state.status == "converged"
    assert state.evaluations <= 60  # measured 19; without, 400 were not enough


@pytest.mark.slow
def test_a_small_patch_of_a_steep_profile_is_certified_to_rounding():
    """2114 patches, the smallest 1e-5 / 2 pi periods wide: rounding was 4.7e-8 of the variation of its heights."""
    profile = bem.Profile.self_affine(period=0.01, hurst=0.3, rms_height=1e-6, harmonics=4000, seed=3)
    solid = {"youngs_modulus": 1e7, "poisson_ratio": 0.49}
    (state,) = solved(profile, [0.2 * plane_strain_modulus(solid) * rms_slope(profile)], solid=solid).targets
    assert state.certificate.ok, state.certificate.reasons


@pytest.mark.parametrize(("poisson_ratio", "thickness"), [(0.5, 0.25), pytest.param(0.3, 0.05, marks=pytest.mark.slow)])
def test_many_contacts_of_a_layer(poisson_ratio, thickness):
    """A layer stiffens the contact: less area at the same load; and a scan on it is no matter of minutes."""
    profile = bem.Profile.self_affine(period=0.01, hurst=0.7, rms_height=1e-6, harmonics=1000, seed=20)
    solid = {"youngs_modulus": 1e7, "poisson_ratio": poisson_ratio}
    loads = [f * plane_strain_modulus(solid) * rms_slope(profile) for f in (0.1, 0.6, 1.3)]
    plain = solved(profile, loads, solid=solid).targets
    layered = solved(profile, loads, solid=solid, layer={"thickness": thickness * 0.01}).targets
    for free, bonded in zip(plain, layered, strict=True):
        assert bonded.status == "converged"
        assert bonded.contact_fraction < free.contact_fraction


def test_a_wide_gap_of_a_thin_layer_is_no_isolated_crack():
    """One sine, incompressible, .008 periods thick, 8 % in contact: by its gap it took 1743 unknowns and 15 s."""
    wave = bem.Profile.from_harmonics(1.0, [1], [0.01])
    solid, layer = {"youngs_modulus": 1e6, "poisson_ratio": 0.5}, {"thickness": 0.008}
    loading = {"control": "penetration", "targets": [0.0001645]}
    (state,) = bem.solve(profile=wave, solid=solid, layer=layer, loading=loading).targets
    assert state.status == "converged"
    assert state.contact_fraction == pytest.approx(0.0826734261932, abs=1e-12)  # by its gap: 2e-15 from this
    assert state.unknowns <= 100  # measured 63


def test_orders_that_a_layer_stiffens_count_for_isolated_cracks():
    class Complete:
        pressure = bem.Profile.from_harmonics(2 * np.pi, [2], [1.0])

    layer = compliance_of([Layer(0.01).effect(bem.Solid(1e6, 0.5), 1.0)])
    thin = CompletedBody(Complete(), 1.0, layer.kernel.ratio)
    assert CompletedBody(Complete(), 1.0).highest_order == 2
    assert thin.highest_order == pytest.approx(1.3 / (2 * np.pi * 0.01), rel=0.3)  # modes shorter than it is thick


@pytest.mark.slow
def test_a_layer_of_three_ten_thousandths_of_the_period():
    """Its contact of a quarter of the period resolves the thickness: thousands of unknowns, and no narrow gap."""
    wave = bem.Profile.from_harmonics(1.0, [1], [0.01])
    solid, layer = {"youngs_modulus": 1e6, "poisson_ratio": 0.0}, {"thickness": 3e-4}
    loading = {"control": "total_displacement", "targets": [0.003]}
    (state,) = bem.solve(profile=wave, solid=solid, layer=layer, loading=loading).targets
    assert state.status == "converged"
    overlap = np.arccos(1 - 0.003 / 0.01) / np.pi  # a bed of springs touches where the profile is above the plane
    assert state.contact_fraction == pytest.approx(overlap, abs=3e-4)  # measured 1.1e-4


def test_surfaces_do_not_overlap_at_the_edge_of_a_patch_that_is_wide_for_its_layer():
    """Heights there are as right as on the patch: pressures of a thin incompressible layer are hundreds of its."""
    profile = bem.Profile.self_affine(period=1.0, hurst=0.3, rms_height=1e-3, harmonics=300, seed=23)
    solid = {"youngs_modulus": 7.5e5, "poisson_ratio": 0.5}
    pressure = 0.6 * plane_strain_modulus(solid) * rms_slope(profile)
    (state,) = solved(profile, [pressure], solid=solid, layer={"thickness": 0.01}).targets
    assert state.certificate.ok
    assert state.certificate.min_gap >= -1.5e-10 * 1e-3  # m; measured 5e-11 of the rms height
