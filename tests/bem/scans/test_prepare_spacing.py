"""Positions as printed: rounded ones stand for equal steps, all others are unequal; disorder is told by its kind."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scene_tables import tables

from bem.geometry.profile import EQUAL_STEPS, Profile
from bem.scans.prepare_line import prepare
from bem.scans.read_scan import read_scan
from bem.scans.scan_file_error import ScanFileError
from bem.scene.scene import parse_scene

UNITS = {"unit_x": "um", "unit_h": "um"}
RNG = np.random.default_rng(3)
COUNT = 320
HEIGHTS = np.round(RNG.normal(size=COUNT), 4)


def scan_of(folder, x, h=HEIGHTS, **values):
    path = folder / "scan.csv"
    path.write_text("\n".join(f"{a},{b}" for a, b in zip(x, h, strict=False)))
    return prepare(read_scan(path, UNITS | values), values)


def step_of(scan):
    return scan.step("spacing")


def plain(value, decimals):
    """A number without its last zeros, as spreadsheets write it."""
    return f"{round(value, decimals):.{decimals}f}".rstrip("0").rstrip(".") or "0"


@pytest.mark.parametrize("start", [0.0, 3.217, -40.0])
@pytest.mark.parametrize("step", [0.15625, 0.107, 0.3333333, 12.3456789])
@pytest.mark.parametrize("form", ["{:.1f}", "{:.2e}", "{:.3g}", "plain"])
def test_rounded_positions_are_equal_steps(step, start, form, tmp_path):
    """The step is found to much less than a digit over the length: the ends are not taken for exact."""
    count = 80 if "e" in form or "g" in form else COUNT
    x = start + step * np.arange(count)
    texts = [plain(value, 1) if form == "plain" else form.format(value) for value in x]
    increasing = (np.diff([float(text) for text in texts]) > 0).all()
    if not increasing:
        pytest.skip("two positions in one digit")
    scan = scan_of(tmp_path, texts, unequal_spacing="resample", detrend="none")
    np.testing.assert_allclose(scan.h, HEIGHTS[:count] * 1e-6, rtol=1e-12)  # nothing is resampled
    digit = max(10.0 ** -len(text.partition("e")[0].partition(".")[2]) for text in texts)
    digit *= 10.0 ** max(int(text.partition("e")[2] or 0) for text in texts)
    assert abs(scan.spacing - step * 1e-6) * (count - 1) <= 2 * digit * 1e-6


@pytest.mark.parametrize("far", [0.6, -0.6])
def test_one_position_beyond_half_a_digit_is_unequal(far, tmp_path):
    x = np.round(0.5 * np.arange(COUNT), 1)
    x[100] += far * 0.1 + np.sign(far) * 0.05
    texts = [f"{value:.1f}" if k != 100 else f"{value:.2f}" for k, value in enumerate(x)]
    with pytest.raises(ScanFileError, match=r"line 101 is .* sample distances off"):
        scan_of(tmp_path, texts)


def test_exact_positions_with_many_digits_are_not_rounded_ones(tmp_path):
    x = 0.15625 * np.arange(COUNT)
    x[7] += 2 * EQUAL_STEPS * 0.15625
    with pytest.raises(ScanFileError, match="not uniform in x: line 8"):
        scan_of(tmp_path, [f"{value:.9f}" for value in x])


@pytest.mark.parametrize("kind", ["digits", "single"])
@pytest.mark.parametrize("decimals", [2, 3, 4, 5])
def test_positions_that_count_as_equal_make_a_profile(decimals, kind, tmp_path):
    """Thirds of a micrometre with few digits, and in single precision: the samples are those of exact thirds."""
    exact = np.arange(COUNT) / 3
    x = np.round(exact, decimals) if kind == "digits" else exact.astype(np.float32)
    scan = scan_of(tmp_path, [f"{value:.{decimals}f}" if kind == "digits" else repr(float(value)) for value in x])
    assert np.ptp(np.diff(scan.x)) <= 4 * np.spacing(scan.x[-1])
    surface = Profile.from_samples(scan.x, scan.h, 50)
    reference = Profile.from_samples(exact * 1e-6, HEIGHTS * 1e-6, 50)
    assert surface.rms_slope == pytest.approx(reference.rms_slope, rel=10.0**-decimals)  # a digit over the length


def test_rounding_is_recorded_and_told(tmp_path):
    texts = [f"{value:.1f}" for value in 0.15625 * np.arange(COUNT)]
    scan = scan_of(tmp_path, texts)
    assert step_of(scan)["printed_to"] == pytest.approx(1e-7, rel=1e-12)
    assert scan.spacing == pytest.approx(0.15625e-6, rel=1e-5)  # measured 4e-16: the digits recur
    exact = scan_of(tmp_path, [f"{value:.5f}" for value in 0.15625 * np.arange(COUNT)])
    np.testing.assert_allclose(scan.h, exact.h, rtol=1e-9, atol=1e-18)


def test_gaps_at_the_ends_leave_the_digits_where_they_were(tmp_path):
    texts = [f"{value:.1f}" for value in 0.15625 * np.arange(COUNT)]
    heights = ["NaN", "NaN", *HEIGHTS[2:]]
    scan = scan_of(tmp_path, texts, heights, missing="interpolate", detrend="none")
    assert (scan.h.size, scan.spacing) == (COUNT - 2, pytest.approx(0.15625e-6, rel=1e-5))


@settings(max_examples=60, deadline=None)
@given(
    st.integers(3, 60),
    st.floats(0.02, 5.0),
    st.floats(-10, 10),
    st.integers(0, 3),
    st.lists(st.floats(-3, 3), max_size=3),
)
@example(60, 0.15625, 0.0, 1, [])
def test_equal_steps_are_those_that_a_search_finds(tmp_path_factory, count, step, start, decimals, moved):
    """Accepted if one of all lines through two positions, shifted, comes within half a digit of every position."""
    digit = 10.0**-decimals
    x = np.round(start + step * np.arange(count), decimals)
    x[1 : 1 + len(moved)] += np.round(moved, decimals)[: count - 1]
    if not (np.diff(x) > digit / 2).all():
        return
    grid = x[0] + (x[-1] - x[0]) * np.arange(count) / (count - 1)
    if np.abs(x - grid).max() <= 1.1 * EQUAL_STEPS * (x[-1] - x[0]) / (count - 1):
        return
    room = _most_room(x, digit / 2)
    if abs(room) < 1e-6 * digit:
        return
    folder = tmp_path_factory.mktemp("scan")
    try:
        scan_of(folder, [f"{value:.{decimals}f}" for value in x], RNG.normal(size=count))
    except ScanFileError as error:
        assert (room < 0) == ("not uniform" in str(error))
    else:
        assert room > 0


def _most_room(x, half):
    """How far inside the bars the best line is: that with two positions on one side of it and one on the other."""
    k = np.arange(x.size)
    slopes = {(x[j] - x[i]) / (j - i) for i in k for j in k[:i]}
    return half - min(np.ptp(x - slope * k) / 2 for slope in slopes)


@pytest.mark.parametrize("x", [[2.0, 1.5, 1.0], [0.0, 0.1, 0.1, 0.2], [0.0, 0.1, 0.2, 0.0, 0.1], [0.0, 0.3, 0.1]])
def test_positions_that_do_not_increase_are_refused_with_their_line(x, tmp_path):
    with pytest.raises(ScanFileError, match=f"is not increasing in x: line {np.argmax(np.diff(x) <= 0) + 2} at"):
        scan_of(tmp_path, x, np.arange(len(x)))


def test_scene_with_rounded_positions_has_the_harmonics_of_the_exact_ones(tmp_path):
    x = 0.15625 * np.arange(COUNT)
    surfaces = []
    for name, decimals in (("exact", 5), ("rounded", 1)):
        (tmp_path / name).write_text(
            "\n".join(f"{a:.{decimals}f},{b + 0.05 * a:.5f}" for a, b in zip(x, HEIGHTS, strict=True))
        )
        profile = {"kind": "samples", "file": name, "detrend": "line", "harmonics": "all", **UNITS}
        surfaces.append(parse_scene(tables(profile, "mean_pressure", [1e4]), tmp_path).surface())
    assert surfaces[1].rms_slope == pytest.approx(surfaces[0].rms_slope, rel=1e-9)
