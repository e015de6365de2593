"""Gaussian filters of a scan: transmission of waves as ISO 16610-21 has it, and cut-offs that a line does not hold."""

import numpy as np
import pytest

import bem
from bem.scans.measured_line import MeasuredLine
from bem.scans.periodic_samples import CARRIED
from bem.scans.prepare_line import prepare
from bem.scene.scene import SceneError, parse_scene

COUNT, SPACING = 600, 1e-6
X = SPACING * np.arange(COUNT)
ALPHA = np.sqrt(np.log(2) / np.pi)
ROUGH = bem.Profile.self_affine(COUNT * SPACING, 0.8, 1e-6, 290, 3)


def prepared(h, **values):
    raw = MeasuredLine(X, np.array(h), {"unit_x": "m", "unit_h": "m"})
    return prepare(raw, {"detrend": "none", **values})


def weighted(x, cutoff):
    """The mean line of the standard as it defines it, by its weighting function on a long line, in the middle."""
    near = np.abs(x[:, None] - x[None, :]) / (ALPHA * cutoff)
    weights = np.exp(-np.pi * near**2)
    return weights / weights.sum(axis=1, keepdims=True)


@pytest.mark.parametrize("periodic", ["as_is", "mirror"])
@pytest.mark.parametrize("order", [4, 30, 60, 150])
@pytest.mark.parametrize("which", ["short", "long"])
def test_wave_is_cut_by_its_wavelength(which, order, periodic):
    """Waves even about the line's ends, so that the mirrored line is the same wave."""
    wave = np.cos(np.pi * 2 * order * (np.arange(COUNT) + 0.5) / COUNT) * 1e-6
    wavelength, cutoff = COUNT * SPACING / order, 2e-5
    passed = np.exp(-np.pi * (ALPHA * cutoff / wavelength) ** 2)
    scan = prepared(wave, periodic=periodic, **{f"cutoff_{which}": cutoff})
    expected = (passed if which == "short" else 1 - passed) * wave
    np.testing.assert_allclose(scan.h[:COUNT], expected, rtol=0, atol=7e-20)  # measured 2.7e-20


def test_filter_is_the_weighted_mean_of_the_standard():
    """Away from the ends, where no weight reaches them."""
    h, cutoff = ROUGH.height(X), 3e-5
    middle = slice(100, 500)
    mean = (weighted(X, cutoff) @ h)[middle]
    np.testing.assert_allclose(prepared(h, cutoff_short=cutoff).h[middle], mean, rtol=0, atol=1e-18)
    np.testing.assert_allclose(prepared(h, cutoff_long=cutoff).h[middle], h[middle] - mean, rtol=0, atol=1e-18)


def test_filters_are_recorded():
    before = prepared(ROUGH.height(X), periodic="mirror")
    scan = prepared(ROUGH.height(X), periodic="mirror", cutoff_short=5e-6, cutoff_long=1e-4)
    step = scan.steps[-1]
    assert (step["step"], step["method"]) == ("filter", "gaussian")
    assert (step["cutoff_short"], step["cutoff_long"]) == (5e-6, 1e-4)
    assert step["rms_height"] == [float(np.std(before.h)), float(np.std(scan.h))]
    assert step["rms_slope"][1] < step["rms_slope"][0]


SCENE = {
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "loading": {"control": "mean_pressure", "targets": [1e4]},
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scans")
    noise = np.random.default_rng(1).normal(0.0, 1e-8, COUNT)
    np.savetxt(folder / "scan.csv", np.column_stack([X, ROUGH.height(X) + noise]), delimiter=",", fmt="%.12g")
    return folder


def scene_of(folder, **profile):
    table = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", **profile}
    return parse_scene({**SCENE, "profile": table}, folder)


@pytest.mark.parametrize("periodic", ["as_is", "mirror"])
def test_harmonics_are_as_many_as_carry_what_is_left(folder, periodic):
    scene = scene_of(folder, cutoff_short=2e-5, periodic=periodic)
    slopes = [
        bem.Profile.from_samples(scene.scan.x, scene.scan.h, count).rms_slope
        for count in (scene.profile.harmonics - 1, scene.profile.harmonics, scene.scan.max_harmonics)
    ]
    assert slopes[0] < (1 - CARRIED) * slopes[2] <= slopes[1] < slopes[2]
    assert 2e-5 / 3.5 < scene.surface().period / scene.profile.harmonics < 2e-5 / 2  # well beyond the cut-off
    assert scene_of(folder, cutoff_short=2e-5, harmonics=7).profile.harmonics == 7
    assert scene_of(folder, cutoff_long=1e-4).profile.harmonics == 299  # a cut of long waves needs no others


@pytest.mark.parametrize(
    ("profile", "told"),
    [
        ({"cutoff_short": 1e-6}, "profile.cutoff_short = 1e-06; allowed: from two sample distances"),
        ({"cutoff_long": 1e-3, "periodic": "mirror"}, "profile.cutoff_long = 0.001; allowed: .* 2e-06 to 0.0006 "),
        ({"cutoff_short": 5e-5, "cutoff_long": 5e-5}, "profile.cutoff_short = 5e-05; .* below cutoff_long = 5e-05"),
    ],
)
def test_cutoffs_that_do_not_fit_are_refused_once(folder, profile, told):
    with pytest.raises(SceneError, match=told) as caught:
        scene_of(folder, **profile)
    assert len(caught.value.mistakes) == 1


def test_filtered_surface_is_what_is_solved(folder):
    scene = scene_of(folder, cutoff_short=2e-5, cutoff_long=2e-4)
    whole = scene_of(folder, harmonics="all").surface()
    surface = scene.surface()
    count = surface.orders.size
    frequency = surface.orders / surface.period
    factor = 2 ** -((2e-5 * frequency) ** 2) - 2 ** -((2e-5**2 + 2e-4**2) * frequency**2)
    np.testing.assert_allclose(surface.amplitudes, factor * whole.amplitudes[:count], rtol=1e-9, atol=1e-20)
    assert scene.resolved()["profile"]["cutoff_long"] == 2e-4
    assert "cutoff_short" not in scene_of(folder).resolved()["profile"]
