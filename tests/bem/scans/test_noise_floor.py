"""The noise floor of scans whose noise is known, the cut that follows from it, and what is said of mostly noise."""

import numpy as np
import pytest
from scene_tables import tables

import bem
from bem.scans.gaussian_filter import GaussianFilter
from bem.scans.noise_floor import Spectrum
from bem.scene.plausibility import cautions_of, groups_of
from bem.scene.scene import parse_scene

PERIOD, HURST, RMS = 8e-3, 0.8, 5e-7
SEEDS = range(4)


def line(count, noise, seed=0, trend=0.0):
    """A piece of a self-affine line, which is not periodic, with white noise of an rms height."""
    h = bem.Profile.self_affine(PERIOD, HURST, RMS, count // 2 - 1, seed).height(PERIOD / count * np.arange(count))
    h = h[: round(0.7 * count)] + trend * np.linspace(-1, 1, round(0.7 * count))
    return h + noise * np.random.default_rng(seed + 100).normal(size=h.size)


def spectrum_of(count, noise, seed=0, trend=0.0):
    return Spectrum(line(count, noise, seed, trend), PERIOD / count)


def true_crossing(count, noise):
    """Wavelength at which the amplitudes of the profile, h_m ~ m^-(H + 1/2), have the density of the noise."""
    orders = np.arange(1, count // 2)
    density = orders ** -(2 * HURST + 1) / np.sum(orders ** -(2 * HURST + 1.0)) * RMS**2 * PERIOD
    return PERIOD / orders[np.flatnonzero(density < 2 * noise**2 * PERIOD / count)[0]]


def test_sum_of_the_density_is_the_mean_square():
    h = line(2000, 1e-8)
    f, density = Spectrum(h, 1e-6).modes
    assert density.sum() * (f[1] - f[0]) == pytest.approx(np.var(h), rel=1e-12)


def test_bands_keep_the_sum():
    spectrum = spectrum_of(2000, 1e-8)
    _, density, counts = spectrum.bands
    assert density @ counts == pytest.approx(spectrum.modes[1].sum(), rel=1e-12)
    assert counts.sum() == spectrum.h.size - 1


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("trend", [0.0, 1e-5], ids=["level", "tilted"])
@pytest.mark.parametrize(
    ("count", "noise", "off"),  # "off" is of the logarithm of the crossing: 1.5 times what was measured
    [(2000, 5e-8, 0.6), (8000, 4e-9, 0.2), (8000, 2e-8, 0.25), (16000, 4e-9, 0.08)],
)
def test_floor_and_crossing_are_those_put_in(count, noise, off, seed, trend):
    spectrum = spectrum_of(count, noise, seed, trend)
    assert spectrum.noise_rms == pytest.approx(noise, rel=0.12)  # measured 0.052
    assert np.log(spectrum.crossing / true_crossing(count, noise)) == pytest.approx(0.0, abs=off)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(
    "make",
    [
        pytest.param(lambda seed: spectrum_of(8000, 0.0, seed), id="no noise"),
        pytest.param(lambda seed: spectrum_of(8000, 1e-10, seed), id="noise below all"),
        pytest.param(lambda seed: spectrum_of(800, 1e-7, seed), id="too few samples to tell"),
        pytest.param(lambda seed: Spectrum(np.diff(line(8000, 1e-7, seed)), 1e-6), id="rising tail"),
        pytest.param(
            lambda seed: Spectrum(GaussianFilter(short=5e-6).applied(line(8000, 1e-7, seed), 1e-6), 1e-6),
            id="filtered by the instrument",
        ),
        pytest.param(lambda seed: Spectrum(np.full(8000, 3e-6), 1e-6), id="flat line"),
        pytest.param(lambda seed: Spectrum(np.array([0.0, 1e-6, 0.0]), 1e-6), id="three samples"),
    ],
)
def test_no_floor_where_the_tail_is_not_flat(make, seed):
    spectrum = make(seed)
    assert (spectrum.floor, spectrum.noise_rms, spectrum.crossing) == (0.0, 0.0, None)
    assert spectrum.facts()["noise"].startswith("no floor: ")
    assert spectrum.noise_share(1, PERIOD, GaussianFilter()) == 0.0


def test_plateau_of_long_waves_is_no_floor():
    """Level up to 100 waves, falling beyond: a surface with a roll-off and no noise."""
    orders = np.arange(1, 3999)
    phases = np.random.default_rng(2).uniform(-np.pi, np.pi, orders.size)
    surface = bem.Profile.from_harmonics(PERIOD, orders, 1e-8 * np.maximum(orders, 100.0) ** -1.3, phases)
    assert Spectrum(surface.height(1e-6 * np.arange(6000)), 1e-6).floor == 0.0


def test_white_noise_is_all_noise():
    """A floor, but nothing above it that could be cut out."""
    spectrum = Spectrum(np.random.default_rng(1).normal(0.0, 3e-9, 8000), 1e-6)
    assert spectrum.crossing is None
    assert spectrum.noise_rms == pytest.approx(3e-9, rel=0.02)  # measured 0.008
    assert spectrum.noise_share(8000, 16e-3, GaussianFilter()) == pytest.approx(1.0, abs=0.04)  # measured 0.015


@pytest.mark.parametrize("gaussian", [GaussianFilter(), GaussianFilter(short=1e-5), GaussianFilter(1e-5, 2e-4)])
@pytest.mark.parametrize("harmonics", [200, 1000, 5599])
def test_share_of_noise_is_that_of_its_slopes(harmonics, gaussian):
    """Against the mean square slopes of such noise alone, of 20 lines, and of the line, filtered and cut, mirrored."""

    def squared(heights):
        mirrored = np.concatenate([heights, heights[::-1]])
        x = 1e-6 * np.arange(mirrored.size)
        return bem.Profile.from_samples(x, gaussian.applied(mirrored, 1e-6), harmonics).rms_slope ** 2

    h, rng = line(8000, 2e-8), np.random.default_rng(7)
    alone = np.mean([squared(2e-8 * rng.normal(size=h.size)) for _ in range(20)])
    share = Spectrum(h, 1e-6).noise_share(harmonics, 11.2e-3, gaussian)
    assert share == pytest.approx(alone / squared(h), rel=0.06)  # measured 0.023


def scene_of(folder, noise, **profile):
    h = line(8000, noise)
    (folder / "scan.csv").write_text("\n".join(f"{1e-6 * k:.9g},{value:.12g}" for k, value in enumerate(h)))
    scan = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m"}
    scan |= {"detrend": "line", "periodic": "mirror"}
    return parse_scene(tables(scan | profile, "mean_pressure", [1e3]), folder)


def said(scene):
    return {caution.about: caution.message for caution in cautions_of(scene, groups_of(scene))}


def test_cut_that_keeps_mostly_noise_is_named_and_the_cut_suggested_is_not(tmp_path):
    scene = scene_of(tmp_path, 2e-8, harmonics="all")
    told = said(scene)["profile.cutoff_short"]
    suggested = scene.scan.spectrum.crossing
    assert groups_of(scene)["noise_share_of_slope"] > 0.9
    assert "of the mean square slope is noise, of 2e-08 m rms in the scan" in told
    assert (
        f"cutoff_short = {suggested:.3g} ({suggested * 1e6:.3g} um), there the profile falls below the noise floor"
        in told
    )
    step = next(step for step in scene.preparation() if step["step"] == "spectrum")
    assert step["suggested_cutoff"] == suggested
    followed = scene_of(tmp_path, 2e-8, cutoff_short=float(f"{suggested:.3g}"))
    assert "profile.cutoff_short" not in said(followed)
    assert groups_of(followed)["noise_share_of_slope"] < 0.2
    assert followed.scan.spectrum.crossing == suggested  # of the scan, not of what is left of it
