"""Lines out of the columns of a text file: by columns, flags, missing values, and rows of maps."""

import numpy as np
import pytest

from bem.scans.prepare_line import RIDGE, prepare
from bem.scans.read_scan import read_scan
from bem.scans.scan_file_error import ScanFileError

COUNT = 24
X = np.arange(COUNT) * 0.25
RNG = np.random.default_rng(3)
H = np.round(RNG.normal(size=COUNT), 3)
UNITS = {"unit_x": "mm", "unit_h": "um"}
SPACED = {"spacing": 0.25, **UNITS}
ROWS = np.round(RNG.normal(size=(6, COUNT)), 3)


def rows(*columns, delimiter=","):
    return "".join(delimiter.join(map(str, row)) + "\n" for row in zip(*columns, strict=True))


def scan_of(folder, text, **values):
    (folder / "scan.txt").write_text(text)
    return read_scan(folder / "scan.txt", values)


def refusal_of(folder, text, **values):
    with pytest.raises(ScanFileError) as caught:
        scan_of(folder, text, **values)
    return caught.value.mistakes[0]


def test_columns_are_those_that_are_named(tmp_path):
    text = rows(range(COUNT), X, H, H + 7.3)
    scan = scan_of(tmp_path, text, columns=[2, 3], valid_column=0, **UNITS)
    np.testing.assert_allclose([scan.x, scan.h], [X * 1e-3, H * 1e-6], rtol=1e-12, atol=1e-18)
    assert scan.facts["columns"] == [2, 3]
    np.testing.assert_allclose(
        scan_of(tmp_path, text, columns=[4], valid_column=0, **SPACED).h, (H + 7.3) * 1e-6, rtol=1e-12
    )


def test_units_are_those_of_the_columns_read(tmp_path):
    scan = scan_of(
        tmp_path,
        "n [1];x [mm];t [s];h [nm]\n" + rows(range(COUNT), X, H, H, delimiter=";"),
        columns=[2, 4],
        valid_column=0,
    )
    np.testing.assert_allclose([scan.x, scan.h], [X * 1e-3, H * 1e-9], rtol=1e-12, atol=1e-18)


UNSET = [1.0 if k not in (3, 4) else "" for k in range(COUNT)]
FLAGS = [1.0 if k not in (3, 4, 20) else 0.0 for k in range(COUNT)]


@pytest.mark.parametrize("valid", [1, 255, -1])
@pytest.mark.parametrize("at", [1, 2, 3])
@pytest.mark.parametrize("columns", [True, False])
def test_heights_flagged_0_are_missing(valid, at, columns, tmp_path):
    table = [X, H]
    table.insert(at - 1, np.array(FLAGS) * valid)
    places = [k for k in (1, 2, 3) if k != at]
    values = {"valid_column": at, **({"columns": places} if columns else {}), **UNITS}
    scan = scan_of(tmp_path, rows(*table), **values)
    np.testing.assert_allclose(scan.x, X * 1e-3, rtol=1e-12)
    np.testing.assert_allclose(scan.h, np.where(FLAGS, H, np.nan) * 1e-6, rtol=1e-12)


MARKS = {  # column that marks heights, the number of valid ones
    "1 valid": (FLAGS, 1),
    "1 invalid": (1.0 - np.array(FLAGS), 0),
    "-1 invalid": (2 * np.array(FLAGS) - 1, 1),
    "quality": (0.9 * np.array(FLAGS), 0.9),
    "codes": (np.where(FLAGS, 7, np.arange(COUNT) % 5), 7),
    "empty": (UNSET, 1),
}


@pytest.mark.parametrize("name", MARKS)
def test_heights_beside_other_numbers_than_the_valid_one_are_missing(name, tmp_path):
    """The refusal names the numbers; the scene says which one is valid; without it 0 alone has a meaning."""
    marks, valid = MARKS[name]
    text, known = rows(X, H, marks), np.array([mark == valid for mark in marks])
    refusal = refusal_of(tmp_path, text, columns=[1, 2], **UNITS)
    assert (refusal.path, f"{valid:g} ({known.sum()} times)" in refusal.found) == ("profile.valid_column", True), (
        refusal
    )
    scan = scan_of(tmp_path, text, valid_column=3, valid_value=valid, **UNITS)
    np.testing.assert_allclose(scan.h, np.where(known, H, np.nan) * 1e-6, rtol=1e-12)
    whole = scan_of(tmp_path, text, columns=[1, 2], valid_column=0, **UNITS)
    np.testing.assert_allclose(whole.h, H * 1e-6, rtol=1e-12)
    if name not in ("1 valid", "1 invalid", "quality"):
        assert f"{valid:g} ({known.sum()} times)" in refusal_of(tmp_path, text, valid_column=3, **UNITS).found


@pytest.mark.parametrize(
    "column",
    [
        pytest.param(np.linspace(0.95, 1, COUNT) * FLAGS, id="quality"),
        pytest.param(H + 7.3, id="heights"),
        pytest.param(np.sort(FLAGS), id="last ones valid"),
    ],
)
def test_column_that_may_mark_heights_is_not_passed_over(column, tmp_path):
    text = rows(X, H, column)
    assert "column 3 holds" in refusal_of(tmp_path, text, columns=[1, 2], **UNITS).found
    assert scan_of(tmp_path, text, columns=[1, 2], valid_column=0, **UNITS).h.size == COUNT


@pytest.mark.parametrize("column", [range(COUNT), -X, np.ones(COUNT), [""] * COUNT], ids=str)
def test_axes_and_constant_columns_mark_no_heights(column, tmp_path):
    scan = scan_of(tmp_path, rows(column, X, H), columns=[2, 3], **UNITS)
    np.testing.assert_allclose(scan.h, H * 1e-6, rtol=1e-12)


def test_heights_on_one_line_are_a_map_of_one_row(tmp_path):
    text = rows(*ROWS[:1].T, delimiter=" ")
    assert "row = 0" in refusal_of(tmp_path, text, **SPACED).allowed
    np.testing.assert_allclose(scan_of(tmp_path, text, row=0, **SPACED).h, ROWS[0] * 1e-6, rtol=1e-12)


@pytest.mark.parametrize("row", [1, "mean"])
def test_missing_value_is_missing(row, tmp_path):
    heights = ROWS.copy()
    heights[1, 5] = -9999.0
    text = "".join(" ".join(map(str, line)) + "\n" for line in heights)
    scan = scan_of(tmp_path, text, row=row, missing_value=-9999, **SPACED)
    heights[1, 5] = np.nan
    np.testing.assert_allclose(scan.h, (heights[1] if row == 1 else heights.mean(axis=0)) * 1e-6, rtol=1e-12)
    line = scan_of(tmp_path, rows(X, np.where(X == 1.0, 99.5, H)), missing_value=99.5, **UNITS)
    np.testing.assert_allclose(line.h, np.where(X == 1.0, np.nan, H) * 1e-6, rtol=1e-12)


@pytest.mark.parametrize("row", [0, 5, "mean"])
def test_row_of_a_map(row, tmp_path):
    scan = scan_of(tmp_path, rows(*ROWS.T, delimiter="\t"), row=row, **SPACED)
    np.testing.assert_allclose(scan.h, (ROWS.mean(axis=0) if row == "mean" else ROWS[row]) * 1e-6, rtol=1e-12)
    np.testing.assert_allclose(scan.x, X * 1e-3, rtol=1e-12)
    assert {"step": "map", "model": RIDGE} in prepare(scan, {}).steps


AXES = {
    "steps": X,
    "falling": X[::-1],
    "rounded": np.round(X * 1.3, 1),
    "unequal": np.cumsum(RNG.uniform(0.1, 2, COUNT)),
}
DOWN = {"steps": np.arange(6) * 0.5, "falling": -np.arange(6) * 0.5, "counts": np.arange(6)}


@pytest.mark.parametrize("heights", [ROWS, ROWS + 3 * X], ids=["level", "tilted"])
@pytest.mark.parametrize("corner", ["0", "nan", "", "-1.5"])
@pytest.mark.parametrize("along", [None, *AXES])
@pytest.mark.parametrize("down", [None, *DOWN])
@pytest.mark.parametrize("end", [False, True])
def test_axes_of_a_map_are_refused_by_name(heights, along, down, corner, end, tmp_path):
    """Axes of a tilted map are told by their equal steps."""
    if (heights is not ROWS and along in ("unequal", "rounded")) or (along is None and down is None):
        return
    at = COUNT if end else 0
    lines = [list(map(str, line)) for line in heights]
    for k, line in enumerate(lines) if down else ():
        line.insert(at, str(DOWN[down][k]))
    if along:
        axis = list(map(str, AXES[along]))
        axis[at:at] = [corner] * (down is not None)
        lines.insert(len(lines) if end else 0, axis)
    refusal = refusal_of(tmp_path, "".join(",".join(line) + "\n" for line in lines), row=1, **SPACED)
    sides = [f"the {'last' if end else 'first'} {side}" for side, axis in (("line", along), ("column", down)) if axis]
    assert refusal.found == f"has axes in {' and '.join(sides)}, which are no heights"


@pytest.mark.parametrize("count", [1, 2, 3, 5, 6])
@pytest.mark.parametrize("corner", ["0", "7", "nan", "-1.5"])
@pytest.mark.parametrize("tilt", [0, 2])
@pytest.mark.parametrize("end", [False, True])
def test_axes_that_meet_in_a_corner_are_both_named_at_any_number_of_lines(count, corner, tilt, end, tmp_path):
    at, positions = (COUNT if end else 0), list(map(str, X))
    heights = [list(map(str, line)) for line in ROWS[:count] + tilt * np.arange(count)[:, None]]
    for k, line in enumerate(heights):
        line.insert(at, str(0.5 * k))
    positions.insert(at, corner)
    text = "".join(",".join(line) + "\n" for line in (positions, *heights))
    refusal = refusal_of(tmp_path, text, row=0, **SPACED)
    assert (
        refusal.found == f"has axes in the first line and the {'last' if end else 'first'} column, which are no heights"
    )


def test_axis_above_columns_is_refused(tmp_path):
    lines = [[-1.0, *np.arange(6) * 0.5], *np.column_stack([X, ROWS.T])]
    text = "".join(",".join(map(str, line)) + "\n" for line in lines)
    assert "the first line" in refusal_of(tmp_path, text, columns=[1, 3], **UNITS).found


@pytest.mark.parametrize("wave", [1, 2.5])
@pytest.mark.parametrize("turn", [0, 1])
def test_smooth_maps_have_no_axes(wave, turn, tmp_path):
    """A row that rises all along is like its neighbours."""
    x, y = np.meshgrid(np.arange(40) / 40, np.arange(30) / 30)
    heights = np.round(np.sin(wave * x + 7 * y) + (0.3 * y if turn else x), 4)
    text = "".join(",".join(map(str, line)) + "\n" for line in heights)
    assert scan_of(tmp_path, text, row=2, **SPACED).h.size == 40


POINTS = [(a, b, round(10 * k + float(RNG.normal()), 4)) for k, b in enumerate((0.0, 0.5)) for a in np.arange(9) / 4]
TABLE, LINE, MAP = rows(X, H, H + 0.3), rows(X, H), rows(*ROWS.T)
RASTER = rows(*zip(*POINTS, strict=True))
ALONE = rows(H)


@pytest.mark.parametrize(
    ("text", "values", "key", "problem"),
    [
        pytest.param(TABLE, UNITS, "columns", "3 columns", id="which columns"),
        pytest.param(LINE, {"columns": [1, 3], **UNITS}, "columns", "= [1, 3]", id="column that is not there"),
        pytest.param(
            TABLE, {"columns": [1, 3], "valid_column": 3, **UNITS}, "columns", "= [1, 3]", id="flag as height"
        ),
        pytest.param(LINE, {"valid_column": 3, **UNITS}, "valid_column", "= 3", id="flag that is not there"),
        pytest.param(ALONE, {"valid_column": 1, **SPACED}, "valid_column", "= 1 of 1", id="flag without heights"),
        pytest.param(TABLE, {"valid_column": 3, **UNITS}, "valid_column", "holds -", id="heights as flags"),
        pytest.param(
            TABLE, {"valid_column": 3, "valid_value": 99, **UNITS}, "valid_value", "= 99: c", id="no such flag"
        ),
        pytest.param(LINE, {"valid_value": 1, **UNITS}, "valid_value", "without", id="valid without a column"),
        pytest.param(MAP, {"row": 0, "valid_value": 1, **SPACED}, "valid_value", "beside row", id="flags of a map"),
        pytest.param(LINE, {"row": 0, **UNITS}, "row", "2 columns", id="row of a line"),
        pytest.param(MAP, {"row": 6, **SPACED}, "row", "= 6", id="row that is not there"),
        pytest.param(MAP, {"row": 0, **UNITS}, "spacing", "is missing", id="map without spacing"),
        pytest.param(MAP, {"row": 0, "columns": [1, 2], **SPACED}, "columns", "beside row", id="columns of a map"),
        pytest.param(
            "[um]," * 23 + "[um]\n" + MAP, {"row": 0, **SPACED}, "file", "line 1 states", id="heading of a map"
        ),
        pytest.param(RASTER, {"row": 0, **UNITS}, "row", "3 columns", id="row of points x y h"),
        pytest.param(LINE, SPACED, "spacing", "= 0.25", id="spacing beside positions"),
        pytest.param(ALONE, UNITS, "spacing", "is missing", id="heights without spacing"),
        pytest.param(f"{COUNT}\n" + ALONE, SPACED, "file", f"line 1 holds {COUNT}", id="their number"),
        pytest.param(LINE + "nan,1.0\n", UNITS, "file", "line 25 has no position", id="position missing"),
        pytest.param(LINE, {"channel": 0, **UNITS}, "channel", "= 0", id="channel of text"),
    ],
)
def test_keys_that_do_not_fit_the_columns_are_refused(text, values, key, problem, tmp_path):
    refusal = refusal_of(tmp_path, text, **values)
    assert (refusal.path, problem in refusal.found) == (f"profile.{key}", True), refusal
