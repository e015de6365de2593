"""Positions as printed: rounded ones stand for equal steps, all others are unequal; disorder is told by its kind."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scene_tables import tables

from bem.scans.scan_file import read_scan
from bem.scans.scan_positions import UNIFORMITY
from bem.scans.scan_preparation import prepare
from bem.scans.scan_refusal import ScanFileError
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
    return next(step for step in scan.steps if step["step"] == "spacing")


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
    x[7] += 2 * UNIFORMITY * 0.15625
    with pytest.raises(ScanFileError, match="not uniform in x: line 8"):
        scan_of(tmp_path, [f"{value:.9f}" for value in x])


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
    st.integers(3, 60), st.floats(0.02, 5.0), st.floats(-10, 10), st.integers(0, 3),
    st.lists(st.floats(-3, 3), max_size=3),
)  # fmt: skip
@example(60, 0.15625, 0.0, 1, [])
def test_equal_steps_are_those_that_a_search_finds(tmp_path_factory, count, step, start, decimals, moved):
    """Accepted if one of all lines through two positions, shifted, comes within half a digit of every position."""
    digit = 10.0**-decimals
    x = np.round(start + step * np.arange(count), decimals)
    x[1 : 1 + len(moved)] += np.round(moved, decimals)[: count - 1]
    if not (np.diff(x) > digit / 2).all():
        return
    grid = x[0] + (x[-1] - x[0]) * np.arange(count) / (count - 1)
    if np.abs(x - grid).max() <= 1.1 * UNIFORMITY * (x[-1] - x[0]) / (count - 1):
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


@pytest.mark.parametrize(
    ("x", "order", "remedy"),
    [
        ([2.0, 1.5, 1.0, 0.5, 0.0], "it falls", "reverse the order"),
        ([0.0, 0.1, 0.1, 0.2, 0.2, 0.2, 0.3], "it repeats values", "keep one of the lines"),
        ([0.0, 0.1, 0.2, 0.3, 0.0, 0.1, 0.2, 0.3], "it begins again", "one scan line"),
        ([0.0, 0.3, 0.1, 0.2, 0.05], "it goes to and fro", "increase"),
    ],
)
def test_disorder_is_told_by_its_kind(x, order, remedy, tmp_path):
    with pytest.raises(ScanFileError, match="is not increasing in x: line") as caught:
        scan_of(tmp_path, x, [0.1, 0.3, -0.2, 0.2, 0.0, 0.4, -0.1, 0.2])
    (refusal,) = caught.value.refusals
    assert (refusal.found.endswith(order), remedy in refusal.allowed) == (True, True), refusal
    assert "columns" not in refusal.allowed


def test_columns_that_are_swapped_are_told(tmp_path):
    x = np.arange(8)
    with pytest.raises(ScanFileError, match=r"columns = \[2, 1\] if that is so"):
        scan_of(tmp_path, HEIGHTS[:8], x)
    assert scan_of(tmp_path, HEIGHTS[:8], x, columns=[2, 1], detrend="none").h[1] == pytest.approx(HEIGHTS[1] * 1e-6)


RASTER = [
    (a, b, round(10 * k + float(RNG.normal()), 4)) for k, b in enumerate((0.0, 0.5, 1.0)) for a in np.arange(9) / 4
]


@pytest.mark.parametrize("turned", [False, True], ids=["along x", "along y"])
@pytest.mark.parametrize("more", [(), (7.5,)], ids=["x y h", "x y h and more"])
@pytest.mark.parametrize("row", [0, 2, "mean"])
def test_scan_line_of_a_raster(row, more, turned, tmp_path):
    points = [(b, a, h, *more) if turned else (a, b, h, *more) for a, b, h in RASTER]
    (tmp_path / "scan.txt").write_text("X [mm],Y [mm],Z [um]" + ",q" * len(more) + "\n"
                                       + "\n".join(",".join(map(str, point)) for point in points))  # fmt: skip
    scan = read_scan(tmp_path / "scan.txt", {"row": row})
    heights = np.array([h for *_, h in RASTER]).reshape(3, 9)
    np.testing.assert_allclose(scan.h, (heights.mean(axis=0) if row == "mean" else heights[row]) * 1e-6, rtol=1e-12)
    np.testing.assert_allclose(scan.x, np.arange(9) * 0.25e-3, rtol=1e-12)
    assert row == "mean" or scan.place(0) == f"line {2 + 9 * row}"


@pytest.mark.parametrize(
    ("values", "key", "said"),
    [
        ({}, "row", "3 scan lines, y = 0 to 1"),
        ({"columns": [1, 3]}, "row", "3 scan lines, y = 0 to 1"),
        ({"row": 3}, "row", "= 3"),
        ({"row": 0, "columns": [2, 3]}, "columns", "of points x y h"),
        ({"row": 0, "spacing": 0.25}, "spacing", "beside the positions of 3 scan lines"),
    ],
)
def test_raster_is_told(values, key, said, tmp_path):
    (tmp_path / "scan.txt").write_text("\n".join(" ".join(map(str, point)) for point in RASTER))
    with pytest.raises(ScanFileError) as caught:
        read_scan(tmp_path / "scan.txt", UNITS | values)
    assert (caught.value.refusals[0].key, said in caught.value.refusals[0].found) == (key, True)


def test_mean_of_scan_lines_at_other_positions_is_refused(tmp_path):
    points = [(-a if b == 0.5 else a, b, h) for a, b, h in RASTER]
    (tmp_path / "scan.txt").write_text("\n".join(" ".join(map(str, point)) for point in points))
    with pytest.raises(ScanFileError, match="different positions"):
        read_scan(tmp_path / "scan.txt", UNITS | {"row": "mean"})
    with pytest.raises(ScanFileError, match="it falls"):
        prepare(read_scan(tmp_path / "scan.txt", UNITS | {"row": 1}), {})


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
