"""Preparation of scans: each step does what it says to lines with known answers, and tells what it did."""

import numpy as np
import pytest

from bem.geometry.profile import Profile
from bem.scans.scan_file import RawScan
from bem.scans.scan_preparation import DRAWN, prepare
from bem.scans.scan_text import ScanFileError

COUNT, SPACING = 200, 1e-5
X = SPACING * np.arange(COUNT)
ROUGH = Profile.self_affine(COUNT * SPACING, 0.7, 1e-6, 60, 3)
H = ROUGH.height(X)
CENTRED = X - X.mean()
TRENDS = {"line": 0.01 * CENTRED, "quadratic": 8 * CENTRED**2, "cubic": 2e4 * CENTRED**3}


def raw(x=X, h=H):
    return RawScan(np.array(x), np.array(h), None, {"unit_x": "m", "unit_h": "m"}, "")


def step_of(scan, name):
    return next(step for step in scan.steps if step["step"] == name)


def test_a_good_line_is_left_as_it_is():
    scan = prepare(raw(), {})
    np.testing.assert_allclose(scan.h, H - H.mean(), rtol=0, atol=1e-20)
    assert [step["step"] for step in scan.preparation(99)] == [
        *("read", "outliers", "missing", "spacing", "detrend", "periodic", "cut")
    ]
    assert (step_of(scan, "outliers")["count"], step_of(scan, "missing")["count"]) == (0, 0)


@pytest.mark.parametrize("method", ["interpolate", "refuse"])
def test_missing_heights(method):
    h = H.copy()
    h[[0, 50, 51, 120, 199]] = np.nan
    if method == "refuse":
        with pytest.raises(
            ScanFileError, match=r"5 of 200 heights are missing \(sample 1, sample 51, sample 52, \.\.\)"
        ):
            prepare(raw(h=h), {})
        return
    scan = prepare(raw(h=h), {"missing": method, "detrend": "none"})
    expected = H.copy()
    expected[50:52] = H[49] + np.array([1, 2]) / 3 * (H[52] - H[49])
    expected[120] = (H[119] + H[121]) / 2
    np.testing.assert_allclose(scan.h, expected[1:-1], rtol=0, atol=1e-20)
    found = step_of(scan, "missing")
    assert (found["count"], found["longest_gap"], found["cut_at_ends"]) == (5, 2, [1, 1])


def test_a_line_that_is_mostly_missing_is_refused():
    with pytest.raises(ScanFileError, match="lacks 101 of 200 heights"):
        prepare(raw(h=np.where(np.arange(COUNT) < 101, np.nan, H)), {"missing": "interpolate"})


@pytest.mark.parametrize("method", ["keep", "replace"])
@pytest.mark.parametrize("places", [[60], [60, 61], [0], [199], [0, 80, 81, 140]], ids=str)
def test_spikes_are_counted_and_replaced_on_request(method, places):
    h = H.copy()
    h[places] += 2e-5
    scan = prepare(raw(h=h), {"outliers": method, "detrend": "none"})
    found = step_of(scan, "outliers")
    assert (found["count"], found["first"]) == (len(places), f"sample {places[0] + 1}")
    if method == "keep":
        np.testing.assert_array_equal(scan.h, h)
    else:
        steps = np.abs(np.diff(H))
        assert np.abs(scan.h - H).max() < 2 * steps.max()  # measured 0.95 times
        np.testing.assert_array_equal(np.delete(scan.h, places), np.delete(H, places))


@pytest.mark.parametrize(
    "h",
    [
        pytest.param(np.random.default_rng(0).normal(size=100_000), id="white"),
        pytest.param(np.cumsum(np.random.default_rng(0).normal(size=100_000)), id="brownian"),
        pytest.param(np.cos(2 * np.pi * X / X[-1]), id="smooth"),
        pytest.param(np.round(20 * np.cos(2 * np.pi * X / X[-1])), id="in steps"),
        pytest.param(np.sign(np.sin(2 * np.pi * (X + 0.3e-5) * 4 / X[-1])), id="grooves"),
        pytest.param(np.zeros(COUNT), id="flat"),
    ],
)
def test_what_is_no_spike_is_none(h):
    assert step_of(prepare(raw(np.arange(h.size) * 1.0, h), {}), "outliers")["count"] == 0


@pytest.mark.parametrize("method", TRENDS)
def test_trend_is_removed(method):
    """Of the trend nothing is left; of the roughness goes what a polynomial of that degree takes of it alone."""
    alone = prepare(raw(), {"detrend": method}).h
    scan = prepare(raw(h=H + TRENDS[method]), {"detrend": method})
    np.testing.assert_allclose(scan.h, alone, rtol=0, atol=1e-19)  # measured 3e-20
    before, after = step_of(scan, "detrend")["rms_height"]
    assert before == pytest.approx(np.std(H + TRENDS[method]), rel=1e-12)
    assert after == pytest.approx(np.std(alone), rel=1e-9)


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_lower_detrending_leaves_the_trend(degree):
    names = ["mean", "line", "quadratic", "cubic"]
    scan = prepare(raw(h=H + TRENDS[names[degree]]), {"detrend": names[degree - 1]})
    assert np.std(scan.h) > 1.5 * np.std(H)


def test_mirrored_line_is_even_and_has_twice_the_period():
    scan = prepare(raw(h=H + TRENDS["line"]), {"periodic": "mirror", "detrend": "none"})
    assert scan.period == pytest.approx(2 * COUNT * SPACING, rel=1e-12)
    np.testing.assert_array_equal(scan.h, scan.h[::-1])
    assert scan.end_jump == 0.0
    np.testing.assert_allclose(np.diff(scan.x), SPACING, rtol=1e-9)


def test_window_goes_to_zero_at_the_ends_and_leaves_the_middle():
    scan = prepare(raw(), {"periodic": "window"})
    np.testing.assert_array_equal(scan.h[20:180], (H - H.mean())[20:180])
    assert abs(scan.h[0]) + abs(scan.h[-1]) == 0.0
    assert scan.h[10] / (H[10] - H.mean()) == pytest.approx(0.5, abs=0.01)  # a cosine: half way at half of the taper
    assert step_of(scan, "periodic")["taper"] == 0.1


def test_unequal_spacing_is_refused():
    x = X.copy()
    x[70] += 0.01 * SPACING
    with pytest.raises(ScanFileError, match=r'sample 71 is 0\.01 sample distances .*unequal_spacing = "resample"'):
        prepare(raw(x), {})


def test_unequal_spacing_is_resampled_on_request():
    wave = np.cos(2 * np.pi * X / X[-1])
    x = X + 0.4 * SPACING * np.sin(40 * X / X[-1]) * np.sin(np.pi * X / X[-1])
    scan = prepare(raw(x, np.cos(2 * np.pi * x / X[-1])), {"unequal_spacing": "resample", "detrend": "none"})
    np.testing.assert_allclose(np.diff(scan.x), SPACING, rtol=1e-9)
    np.testing.assert_allclose(scan.h, wave, rtol=0, atol=1.5e-4)  # measured 6e-5; without resampling 1e-2
    found = step_of(scan, "spacing")
    assert found["least"] < SPACING < found["most"]


@pytest.mark.parametrize("step", [0.0, -1.0])
def test_positions_that_do_not_increase_are_refused(step):
    x = X.copy()
    x[31] = x[30] + step * SPACING
    with pytest.raises(ScanFileError, match="not increasing in x: sample 32"):
        prepare(raw(x), {"unequal_spacing": "resample"})


@pytest.mark.parametrize("harmonics", [1, 20, 60, 99])
def test_share_of_the_slope_is_that_of_the_profile(harmonics):
    noise = np.random.default_rng(4).normal(0.0, 1e-7, COUNT)
    scan = prepare(raw(h=H + noise), {})
    slopes = [Profile.from_samples(scan.x, scan.h, cut).rms_slope for cut in (harmonics, scan.max_harmonics)]
    cut = scan.preparation(harmonics)[-1]
    assert scan.slope_share(harmonics) == pytest.approx(slopes[0] / slopes[1], rel=1e-9)
    assert (cut["slope_share_kept"], cut["rms_slope"][1]) == pytest.approx((slopes[0] / slopes[1], slopes[0]), rel=1e-9)


def test_end_jump_is_that_of_a_tilted_line():
    scan = prepare(raw(h=3.0 * np.arange(COUNT)), {})
    assert scan.end_jump == pytest.approx(COUNT - 1, rel=1e-12)


def test_what_is_drawn_is_short_and_keeps_the_extremes():
    count = 100_000
    h = np.random.default_rng(1).normal(size=count)
    h[777], h[50_000] = 30.0, np.nan
    drawn = prepare(raw(np.arange(count) * 1.0, h), {"missing": "interpolate"}).drawn()
    assert {values.size for values in drawn.values()} == {DRAWN}
    assert np.nanmax(drawn["scan_h"]) == 30.0
    assert np.nanmin(drawn["scan_h"]) == np.nanmin(h)
    assert (np.diff(drawn["profile_x"]) >= 0).all()
