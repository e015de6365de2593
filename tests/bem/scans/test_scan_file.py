"""Scans as instruments write them: each dialect gives the line that was measured, or a mistake with its remedy.

The line has x in mm and h in um; another unit, a swapped column or a lost sample changes what is compared.
"""

import numpy as np
import pytest

from bem.scans import scan_text
from bem.scans.scan_file import read_scan
from bem.scans.scan_text import ScanFileError

COUNT = 40
X = np.arange(COUNT) * 0.25  # mm
H = np.round(3 * np.cos(2 * np.pi * X / 10) + 0.5 * np.sin(2 * np.pi * X), 3)  # um
UNITS = {"unit_x": "mm", "unit_h": "um"}
VENDOR = [f"Parameter {k};{k * 0.5}" for k in range(20)] + [f"Date: {k}.03.2024" for k in range(9)] + ["# Data"]


def table(delimiter=" ", decimal=".", heading="", x=X, h=H, end="\n"):
    """The line as text."""
    rows = [delimiter.join(f"{value:.6f}" for value in row).replace(".", decimal) for row in zip(x, h, strict=True)]
    return end.join([*([heading] if heading else []), *rows, ""])


def alone(decimal="."):
    """The heights as text."""
    return "".join(f"{value:.4f}\n" for value in H).replace(".", decimal)


def scan_of(tmp_path, text, **values):
    path = tmp_path / "scan.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_scan(path, values)


def refusals_of(tmp_path, text, **values):
    with pytest.raises(ScanFileError) as caught:
        scan_of(tmp_path, text, **values)
    return caught.value.refusals


DIALECTS = {
    "metres": (table(x=X * 1e-3, h=H).replace("\n", "e-6\n"), {"unit_x": "m", "unit_h": "m"}),
    "millimetres": (table(h=H * 1e-3, delimiter=","), {"unit_x": "mm", "unit_h": "mm"}),
    "micrometres": (table(x=X * 1e3), {"unit_x": "um", "unit_h": "um"}),
    "nanometres": (table(h=H * 1e3), {"unit_x": "mm", "unit_h": "nm"}),
    "units in brackets": (table(",", heading="x [mm],h [um]"), {}),
    "units in parentheses, blanks": (table(heading="x (mm)   h (um)"), {}),
    "units after a stroke": (table("\t", heading="Weg / mm\tHöhe / µm"), {}),
    "units behind names": (table(",", heading="x_mm,height_um"), {}),
    "units in words": (table(",", heading="x in millimetres,h in microns"), {}),
    "units on a line of their own": (table(";", heading="distance;height\nmm;µm"), {}),
    "units of axes": (table(heading="X unit: mm\nZ-Unit = um\nx h"), {}),
    "units in the file and the scene": (table(",", heading="x [mm],h [um]"), UNITS),
    "decimal comma": (table(" ", ","), UNITS),
    "decimal comma, semicolons": (table(";", ","), UNITS),
    "decimal comma, tabs": (table("\t", ","), UNITS),
    "semicolons with blanks": (table(" ; "), UNITS),
    "tabs": (table("\t"), UNITS),
    "a delimiter at every end": (table(";", end=";\n"), UNITS),
    "quoted": ('"x","h"\n' + "".join(f'"{a}","{b}"\n' for a, b in zip(X, H, strict=True)), UNITS),
    "latin-1": (table(";", ",", "Länge [mm];Höhe [µm]").encode("latin-1"), {}),
    "byte order mark": (b"\xef\xbb\xbf" + table(";", ",", "x [mm];h [µm]", end="\r\n").encode(), {}),
    "byte order mark and no heading": (b"\xef\xbb\xbf" + table(";").encode(), UNITS),
    "utf-16": (table("\t", heading="x [mm]\th [µm]").encode("utf-16"), {}),
    "vendor header of 30 lines": (table("\t", ",", "\n".join([*VENDOR, "X [mm]\tZ [µm]"])), {}),
    "comments": ("# sample 7\n" + table(heading="# x [mm] h [um]", end="  # measured\n\n"), {}),
    "heights alone": (alone(), {"spacing": 0.25, **UNITS}),
    "heights alone, decimal comma": ("Höhe µm\n" + alone(","), {"spacing": 0.25, "decimal": ",", "unit_x": "mm"}),
    "three columns": (
        "".join(f"{k};{a};{b}\n" for k, (a, b) in enumerate(zip(X, H, strict=True))),
        {"columns": [2, 3], **UNITS},
    ),
    "number and height": (
        "".join(f"{k};{b}\n" for k, b in enumerate(H)),
        {"columns": [2], "spacing": 0.25, **UNITS},
    ),
    "row of a map": (
        "\n".join("\t".join(map(str, row)) for row in (H + 1, H, H + 2)),
        {"row": 1, "spacing": 0.25, **UNITS},
    ),
    "mean of a map": (
        "\n".join(",".join(map(str, row)) for row in (H + 1, H - 3, H + 2)),
        {"row": "mean", "spacing": 0.25, **UNITS},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", DIALECTS)
def test_dialect_gives_the_measured_line(name, tmp_path):
    text, values = DIALECTS[name]
    scan = scan_of(tmp_path, text, **values)
    np.testing.assert_allclose(scan.x, X * 1e-3, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(scan.h, H * 1e-6, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("word", ["NaN", "nan", "N/A", "#N/A", "--", "***", "bad", "1.#QNAN", "inf", "null"])
def test_words_for_a_missing_height_are_known(word, tmp_path):
    lines = table(";").splitlines()
    lines[7] = f"{X[7]};{word}"
    scan = scan_of(tmp_path, "\n".join(lines), **UNITS)
    assert np.flatnonzero(np.isnan(scan.h)).tolist() == [7]
    np.testing.assert_allclose(scan.x, X * 1e-3, rtol=1e-12)


def test_empty_cell_is_a_missing_height(tmp_path):
    scan = scan_of(tmp_path, table(",").replace(f"{H[3]:.6f}\n", "\n", 1), **UNITS)
    assert np.isnan(scan.h[3])
    assert np.isfinite(np.delete(scan.h, 3)).all()


@pytest.mark.parametrize("delimiter", [",", ";", "\t", " "])
@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("digits", [0, 3])
def test_no_pair_of_marks_is_misread(delimiter, decimal, digits, tmp_path):
    """All pairs of delimiter and decimal mark, also with whole numbers: the line, or a refusal; nothing else."""
    x, h = np.arange(COUNT) * 1.0, np.round(H, digits)
    rows = (delimiter.join(f"{value:.{digits}f}" for value in row) for row in zip(x, h, strict=True))
    try:
        scan = scan_of(tmp_path, "\n".join(rows).replace(".", decimal), **UNITS)
    except ScanFileError as error:
        assert (delimiter, decimal) == (",", ",") or (delimiter == "," and digits == 0), error
        return
    np.testing.assert_allclose(scan.h, h * 1e-6, rtol=1e-12, atol=1e-18)


@pytest.mark.parametrize(
    ("text", "values", "key", "said"),
    [
        pytest.param("", UNITS, "file", "holds 0 samples", id="empty"),
        pytest.param("0.0 1\n1 2\n", UNITS, "file", "holds 2 samples", id="too short"),
        pytest.param("some words\nand more\n", UNITS, "file", "holds 0 samples", id="no numbers"),
        pytest.param(table() + "4\n", UNITS, "file", "line 41 has 1 column", id="ragged"),
        pytest.param(table() + "4 5 6\n", UNITS, "file", "line 41 has 3 columns", id="a third column"),
        pytest.param(table() + "11 high\n", UNITS, "file", "line 41 ('11 high')", id="text"),
        pytest.param("-1 high\n" + table(), UNITS, "file", "line 1 ('-1 high')", id="text at the beginning"),
        pytest.param("O.25 1.5\n" + table(), UNITS, "file", "line 1 ('O.25 1.5')", id="a letter O at the beginning"),
        pytest.param("1.5\n" + table(), UNITS, "file", "line 1 ('1.5') is no row of 2", id="one number before"),
        pytest.param(table(heading="x h") + "end of data\n", UNITS, "file", "line 42", id="footer"),
        pytest.param(table(";", ",") + "10,0;1.234,5\n", UNITS, "file", "line 41", id="thousands"),
        pytest.param(table(";", ",") + "10,0;1.5\n", UNITS, "file", "line 41", id="another decimal mark"),
        pytest.param(table() + "10.0 1_000\n", UNITS, "file", "line 41", id="underscore"),
        pytest.param(table() + "nan 1.0\n", UNITS, "file", "line 41 has no position", id="position missing"),
        pytest.param("0,1\n1,2\n2,4\n", UNITS, "decimal", "2 columns or 1 column", id="comma of either kind"),
        pytest.param(table(","), {"unit_x": "mm"}, "unit_h", "is missing", id="no unit"),
        pytest.param(table(";", heading="x [mm];h"), {}, "unit_x", "not all columns", id="one unit of two"),
        pytest.param(table(heading="Unit: um"), {}, "unit_x", "of no axis", id="unit of no axis"),
        pytest.param(table(heading="Unit: nm"), UNITS, "unit_h", "line 1", id="contradicts the unit of no axis"),
        pytest.param(table(",", heading="x [um],h [um]"), UNITS, "unit_x", 'says "um" in line 1', id="contradiction"),
        pytest.param(table(",", heading="x [px],h [um]"), UNITS, "unit_x", "'px' in line 1", id="pixels"),
        pytest.param(table(";", heading="X unit: nm\nx [mm];h [um]"), {}, "unit_x", "more than one", id="two units"),
        pytest.param(table(";", heading="x_m;h_m"), {}, "unit_x", "is missing", id="names that end like units"),
        pytest.param(
            table(";", heading="Length [mm] = 5;Filter [um] = 8"), {}, "unit_x", "is missing", id="settings with units"
        ),
        pytest.param(
            table(heading="Lc [mm] Ls [um]\nx h"), {}, "unit_x", "is missing", id="units above another heading"
        ),
        pytest.param(
            "Lc [mm];Ls [um]\n" + alone(), {"spacing": 0.25, "unit_x": "mm"}, "unit_h", "is missing", id="units of two"
        ),
        pytest.param("bad\n" + table(), UNITS, "file", "line 1 ('bad') is no row of 2", id="missing at the beginning"),
        pytest.param(f"{COUNT}\n" + alone(), {"spacing": 0.25, **UNITS}, "file", "line 1 holds 40", id="their number"),
        pytest.param(alone(), UNITS, "spacing", "is missing", id="heights without spacing"),
        pytest.param(table(), {"spacing": 0.25, **UNITS}, "spacing", "= 0.25", id="spacing beside positions"),
        pytest.param("1 2 3\n4 5 6\n7 8 9\n", UNITS, "columns", "3 columns", id="which columns"),
        pytest.param(table(), {"columns": [1, 3], **UNITS}, "columns", "= [1, 3]", id="column that is not there"),
        pytest.param(table(), {"row": 0, **UNITS}, "row", "2 columns", id="row of a line"),
        pytest.param("1 2 3\n4 5 6\n7 8 9\n", {"row": 0, **UNITS}, "spacing", "is missing", id="map without spacing"),
        pytest.param(
            "1 2 3\n4 5 6\n7 8 9\n", {"row": 3, "spacing": 1.0, **UNITS}, "row", "= 3", id="row that is not there"
        ),
        pytest.param(table(), {"channel": 0, **UNITS}, "channel", "= 0", id="channel of text"),
    ],
)
def test_wrong_file_is_told(text, values, key, said, tmp_path):
    refusals = refusals_of(tmp_path, text, **values)
    assert refusals[0].key == key
    assert said in refusals[0].found
    assert refusals[0].allowed


@pytest.mark.parametrize("delimiter", ["\t", ";", " "])
def test_commas_that_may_part_thousands_are_not_guessed(delimiter, tmp_path):
    """All commas before three decimals: told; read as stated; one number that can have no thousands settles it."""
    cells = ["1,200", "-12,345", "950"]
    text = "".join(f"{k}{delimiter}{cell}\n" for k, cell in enumerate(cells))
    (refusal,) = refusals_of(tmp_path, text, **UNITS)
    assert refusal.key == "decimal"
    assert "line 1" in refusal.found
    assert "1.200 or 1200" in refusal.found
    np.testing.assert_allclose(scan_of(tmp_path, text, decimal=",", **UNITS).h, np.array([1.2, -12.345, 950]) * 1e-6)
    for settled in ("0,123", "1,25", "1234,500"):
        assert scan_of(tmp_path, f"{text}3{delimiter}{settled}\n", **UNITS).h[0] == pytest.approx(1.2e-6)


@pytest.mark.parametrize(
    ("rows", "values", "line", "remedy"),
    [
        ("0.0D+00 1.0D-06|1.0D-05 2.5D-06|2.0D-05 3.0D-06", {}, 2, "0.0E+00: replace D by E"),
        ("0.0,1.0e-6|1.0,2.5e-6|2.0,3.0d-06|3.0,1e-6", {}, 4, "3.0E-06: replace D by E"),
        ("0\t1,200,000|1\t1,200,113|2\t1,200,224", {}, 2, "remove them"),
        ("0\t1,200.0|1\t998.5|2\t997.0|3\t990.0", {}, 2, "remove them"),
        ("0;1.200,5|1;1.313,0|2;1.424,0", {}, 2, "remove them"),
        ("0;1,200|1;1,313|2;1,424", {"decimal": "."}, 2, "remove them"),
    ],
)
def test_spelling_of_numbers_is_told_with_its_remedy(rows, values, line, remedy, tmp_path):
    first = refusals_of(tmp_path, "x h\n" + rows.replace("|", "\n"), **UNITS, **values)[0]
    assert f"line {line} (" in first.found
    assert remedy in first.allowed


def test_missing_file_is_told(tmp_path):
    with pytest.raises(ScanFileError, match="cannot be read"):
        read_scan(tmp_path / "nowhere.csv", UNITS)


def test_all_sorts_of_mistakes_are_told_at_once(tmp_path):
    assert len(refusals_of(tmp_path, table() + "4\n5 high\n", **UNITS)) == 2


def test_many_bad_lines_are_counted(tmp_path):
    last = refusals_of(tmp_path, table() + "1 high\n" * 10, **UNITS)[-1]
    assert last.found == "and 7 more lines like that"


def test_how_it_was_read_is_recorded(tmp_path):
    text, _ = DIALECTS["vendor header of 30 lines"]
    facts = scan_of(tmp_path, text).facts
    assert facts == {
        **{"format": "text", "encoding": "utf-8", "delimiter": "tab", "decimal": ",", "header_lines": 31, "columns": 2},
        **{"unit_x": "mm", "unit_h": "um", "unit_x_from": "file", "unit_h_from": "file"},
    }


def test_a_million_points_are_looked_at_once(tmp_path, monkeypatch):
    """One by one only the lines at the ends are tried, as often as there are readings; the rest is read in one go."""
    looked = []
    row = scan_text.Reading.row

    def counted(self, line):
        looked.append(None)
        return row(self, line)

    monkeypatch.setattr(scan_text.Reading, "row", counted)
    count = 1_000_000
    rows = "\n".join(f"{k / 4},{k % 1000 / 8}" for k in range(count))
    scan = scan_of(tmp_path, rows, **UNITS)
    assert scan.h.size == count
    assert (scan.x[-1], scan.h[-1]) == pytest.approx(((count - 1) / 4e3, 999 / 8e6), rel=1e-12)
    assert len(looked) <= len(scan_text.READINGS) * (2 * scan_text.JUDGED + 2)
