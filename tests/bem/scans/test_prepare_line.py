"""Preparation of scans: each step does what it says to lines with known answers, and tells what it did."""

import numpy as np
import pytest

from bem.geometry.lengths import METRES
from bem.geometry.profile import Profile
from bem.scans.measured_line import MeasuredLine
from bem.scans.periodic_samples import DRAWN
from bem.scans.prepare_line import prepare
from bem.scans.read_scan import read_scan
from bem.scans.scan_file_error import ScanFileError

COUNT, SPACING = 200, 1e-5
X = SPACING * np.arange(COUNT)
ROUGH = Profile.self_affine(COUNT * SPACING, 0.7, 1e-6, 60, 3)
H = ROUGH.height(X)
CENTRED = X - X.mean()
TRENDS = {"line": 0.01 * CENTRED, "quadratic": 8 * CENTRED**2, "cubic": 2e4 * CENTRED**3}


def raw(x=X, h=H):
    return MeasuredLine(np.array(x), np.array(h), {"unit_x": "m", "unit_h": "m"})


def step_of(scan, name):
    return scan.step(name)


def test_a_good_line_is_left_as_it_is():
    scan = prepare(raw(), {})
    np.testing.assert_allclose(scan.h, H - H.mean(), rtol=0, atol=1e-20)
    assert [step["step"] for step in scan.preparation(99)] == [
        *("read", "dropouts", "outliers", "missing", "spacing", "detrend", "spectrum", "periodic", "cut")
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
    facts = step_of(scan, "missing")
    assert (facts["count"], facts["longest_gap"], facts["cut_at_ends"]) == (5, 2, [1, 1])


def test_a_line_that_is_mostly_missing_is_refused():
    with pytest.raises(ScanFileError, match="lacks 101 of 200 heights"):
        prepare(raw(h=np.where(np.arange(COUNT) < 101, np.nan, H)), {"missing": "interpolate"})


@pytest.mark.parametrize("method", ["keep", "replace"])
@pytest.mark.parametrize("places", [[60], [60, 61], [0], [199], [0, 80, 81, 140]], ids=str)
def test_spikes_are_counted_and_replaced_on_request(method, places):
    h = H.copy()
    h[places] += 2e-5
    scan = prepare(raw(h=h), {"outliers": method, "detrend": "none"})
    facts = step_of(scan, "outliers")
    assert (facts["count"], facts["first"]) == (len(places), f"sample {places[0] + 1}")
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
        pytest.param(np.arange(COUNT) > 100, id="a step"),
        pytest.param(np.maximum(np.cos(8 * np.pi * X / X[-1]), 0.5), id="cut off"),
    ],
)
def test_what_is_no_spike_and_no_dropout_is_none(h):
    scan = prepare(raw(np.arange(h.size) * 1.0, np.array(h, dtype=float)), {})
    assert (step_of(scan, "outliers")["count"], step_of(scan, "dropouts")["count"]) == (0, 0)


@pytest.mark.parametrize("method", TRENDS)
def test_trend_is_removed(method):
    """Of the trend nothing is left; of the roughness goes what a polynomial of that degree takes of it alone."""
    alone = prepare(raw(), {"detrend": method}).h
    scan = prepare(raw(h=H + TRENDS[method]), {"detrend": method})
    np.testing.assert_allclose(scan.h, alone, rtol=0, atol=1e-19)  # measured 3e-20
    before, after = step_of(scan, "detrend")["rms_height"]
    assert before == pytest.approx(np.std(H + TRENDS[method]), rel=1e-12)
    assert after == pytest.approx(np.std(alone), rel=1e-9)


def test_trend_of_too_few_samples_is_refused():
    with pytest.raises(ScanFileError, match='detrend = "cubic" of 3 samples'):
        prepare(raw(X[:3], H[:3]), {"detrend": "cubic"})


def test_few_heights_are_refused():
    with pytest.raises(ScanFileError, match="holds 2 samples with a height"):
        prepare(raw(X[:3], np.array([1e-6, np.nan, 0.0])), {"missing": "interpolate"})


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


@pytest.mark.parametrize(
    ("h", "share"),
    [
        pytest.param(np.cos(np.pi * np.arange(64)), 0.0, id="alternating"),
        pytest.param(
            2e-3 * np.cos(np.pi * np.arange(64)) + 1e-3 * np.sin(np.pi * np.arange(64) / 32),
            1 / np.hypot(1, 64 * np.sqrt(2)),
            id="in turn",
        ),
        pytest.param(np.cos(2 * np.pi * np.arange(63) / 63), 1.0, id="odd number"),
    ],
)
def test_order_of_half_the_samples_counts_as_slope(h, share):
    """Waves of rms slope 2 pi / 64 1e-3 / sqrt 2 and pi 2e-3: the second has 64 sqrt 2 times that of the first."""
    scan = prepare(raw(np.arange(h.size) * 1e-6, h * 1e-6), {})
    assert scan.slope_share(scan.max_harmonics) == pytest.approx(share, rel=1e-5, abs=1e-12)


NOISE = np.random.default_rng(5).normal(0.0, 1e-8, COUNT)


@pytest.mark.parametrize("value", [-9999e-6, 9999e-6, 0.0, 32767e-6, 12e-6])
@pytest.mark.parametrize(
    ("places", "told"),
    [
        pytest.param(range(60, 70), "samples 61 to 70", id="block"),
        pytest.param(range(5), "samples 1 to 5", id="beginning"),
        pytest.param(range(190, 200), "samples 191 to 200", id="end"),
        pytest.param([20, 21, 60, 61, 62, 64, 66, 67], "samples 21 to 22, samples 61 to 63, sample 65, ..", id="many"),
    ],
)
def test_value_for_nothing_seen_is_a_missing_height(value, places, told):
    h, places = H + NOISE + 5e-5, list(places)
    h[places] = value
    with pytest.raises(ScanFileError) as caught:
        prepare(raw(h=h), {"outliers": "replace"})
    (refusal,) = caught.value.mistakes
    assert (refusal.path, f"dropouts: {value:.9g} m in {told}" in refusal.found) == ("profile.missing", True), refusal
    bridged = prepare(raw(h=h), {"missing": "interpolate", "detrend": "none"})
    gaps = h.copy()
    gaps[places] = np.nan
    expected = prepare(raw(h=gaps), {"missing": "interpolate", "detrend": "none"})
    np.testing.assert_array_equal(bridged.h, expected.h)
    assert (step_of(bridged, "dropouts")["count"], step_of(bridged, "dropouts")["places"]) == (len(places), told)


def test_value_for_nothing_seen_may_be_a_height_on_request():
    h = H + 5e-5
    h[60:70] = 0.0
    kept = prepare(raw(h=h), {"dropouts": "keep", "detrend": "none"})
    np.testing.assert_array_equal(kept.h, h)
    assert step_of(kept, "dropouts")["places"] == "samples 61 to 70"


def test_zeros_amid_heights_about_zero_are_dropouts():
    """The heights cross zero elsewhere: a block that jumps there and back is told apart from these."""
    h = 1e-6 * np.cos(2 * np.pi * np.arange(COUNT) / COUNT) + NOISE / 10
    h[0:20], h[150] = 0.0, 0.0
    assert step_of(prepare(raw(h=h), {"missing": "interpolate"}), "dropouts")["places"] == "samples 1 to 20"


@pytest.mark.parametrize("value", [-9999.0, 65535.0, 32767.0, -3.40282347e38])
@pytest.mark.parametrize("unit", ["m", "um"])
def test_one_sample_of_a_value_that_rasters_have_for_nothing_seen_is_a_dropout(value, unit):
    h = H + NOISE
    h[70] = value * METRES[unit]
    seen = MeasuredLine(X, h, {"unit_x": unit, "unit_h": unit})
    facts = step_of(prepare(seen, {"missing": "interpolate"}), "dropouts")
    assert (facts["count"], facts["places"], facts["values"]) == (1, "sample 71", f"{value:.9g} {unit}")


@pytest.mark.parametrize("tilt", [0.0, 0.01, -0.3])
def test_tilt_is_looked_for(tilt):
    facts = step_of(prepare(raw(h=tilt * X + np.cos(16 * np.pi * X / (COUNT * SPACING)) * 1e-6), {}), "detrend")
    assert facts["tilt"] == pytest.approx(tilt, abs=4e-5)  # measured 1.5e-5, of the wave
    assert facts["rms_without_tilt"] == pytest.approx(1e-6 / np.sqrt(2), rel=2e-4)  # measured 7.5e-5


def test_unequal_spacing_is_resampled_on_request():
    wave = np.cos(2 * np.pi * X / X[-1])
    x = X + 0.4 * SPACING * np.sin(40 * X / X[-1]) * np.sin(np.pi * X / X[-1])
    scan = prepare(raw(x, np.cos(2 * np.pi * x / X[-1])), {"unequal_spacing": "resample", "detrend": "none"})
    np.testing.assert_allclose(np.diff(scan.x), SPACING, rtol=1e-9)
    np.testing.assert_allclose(scan.h, wave, rtol=0, atol=1.5e-4)  # measured 6e-5; without resampling 1e-2
    facts = step_of(scan, "spacing")
    assert facts["least"] < SPACING < facts["most"]


@pytest.mark.parametrize("harmonics", [1, 20, 60, 99])
def test_share_of_the_slope_is_that_of_the_profile(harmonics):
    noise = np.random.default_rng(4).normal(0.0, 1e-7, COUNT)
    scan = prepare(raw(h=H + noise), {})
    slopes = [Profile.from_samples(scan.x, scan.h, cut).rms_slope for cut in (harmonics, scan.max_harmonics)]
    last = np.mean(scan.h * np.cos(np.pi * np.arange(COUNT)))  # of cos(pi x / dx), which no harmonic kept has
    slopes[1] = np.hypot(slopes[1], np.pi / scan.spacing * last)
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
    assert {drawn[f"{name}_{axis}"].size for name in ("scan", "profile") for axis in "xh"} == {DRAWN}
    assert drawn["scan_wavelength"].size == drawn["scan_density"].size < 200
    assert np.nanmax(drawn["scan_h"]) == 30.0
    assert np.nanmin(drawn["scan_h"]) == np.nanmin(h)
    assert (np.diff(drawn["profile_x"]) >= 0).all()


def test_trace_of_a_stylus_is_prepared_as_it_was_ground(tmp_path):
    """8000 points with noise, tilt, gaps and a spike: what is left is the line, but where it was not seen."""
    count, touched = 8000, [1200, 1201, 1202, 3000, 4555, 6001]
    x, rng = np.arange(count) * 5e-4, np.random.default_rng(3)
    ground = 1e6 * Profile.self_affine(count * 5e-7, 0.8, 5e-7, 2000, 1).height(x * 1e-3)
    h = ground + 0.35 + 1.8 * x + 0.004 * rng.standard_normal(count)
    lines = [f"{a:.4f}\t{b:.4f}" for a, b in zip(x, h, strict=True)]
    for k in touched:
        lines[k] = f"{x[k]:.4f}\t" + ("99.9" if k == 3000 else "")
    (tmp_path / "steel.txt").write_text("X [mm]\tZ [um]\n" + "\n".join(lines) + "\n")
    values = {"missing": "interpolate", "outliers": "replace", "detrend": "line"}
    scan = prepare(read_scan(tmp_path / "steel.txt", values), values)
    counts = [step_of(scan, name)["count"] for name in ("dropouts", "outliers", "missing")]
    assert (counts, step_of(scan, "outliers")["first"]) == ([0, 1, 5], "line 3002")
    expected = prepare(raw(x * 1e-3, h * 1e-6), {"detrend": "line"})
    assert scan.spacing == pytest.approx(5e-7, rel=1e-12)
    np.testing.assert_allclose(
        np.delete(scan.h, touched), np.delete(expected.h, touched), rtol=0, atol=1.2e-10
    )  # measured 5.4e-11, half a digit
    assert np.abs(scan.h - expected.h).max() < 4e-8  # measured 1.4e-8, at the samples filled
