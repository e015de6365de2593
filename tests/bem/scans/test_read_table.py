"""Text files of numbers: each way to write the columns gives the line that was measured, or is refused by its line.

The line has x in mm and h in um; another unit, a swapped column or a lost sample changes what is compared.
"""

import random

import numpy as np
import pytest

from bem.geometry.lengths import METRES
from bem.scans.prepare_line import prepare
from bem.scans.read_scan import read_scan
from bem.scans.scan_file_error import ScanFileError

COUNT = 40
X = np.arange(COUNT) * 0.25  # mm
H = np.round(3 * np.cos(2 * np.pi * X / 10) + 0.5 * np.sin(2 * np.pi * X), 3)  # um
UNITS = {"unit_x": "mm", "unit_h": "um"}
SKIPPED = {"skip_lines": 29, "missing_value": "none"}
VENDOR = "".join(f"Parameter {k};{k * 0.5}\n" for k in range(29))


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


def refusal_of(tmp_path, text, **values):
    with pytest.raises(ScanFileError) as caught:
        scan_of(tmp_path, text, **values)
    return caught.value.mistakes[0]


DIALECTS = {
    "metres": (table(x=X * 1e-3, h=H).replace("\n", "e-6\n"), {"unit_x": "m", "unit_h": "m"}),
    "millimetres": (table(h=H * 1e-3, delimiter=","), {"unit_x": "mm", "unit_h": "mm"}),
    "nanometres": (table(h=H * 1e3), {"unit_x": "mm", "unit_h": "nm"}),
    "units in brackets": (table(",", heading="x [mm],h [um]"), {}),
    "units in parentheses, blanks": (table(heading="x (mm)   h (um)"), {}),
    "units in parentheses, commas above blanks": (table(heading="# x (mm), h (um)"), {}),
    "units after a stroke": (table("\t", heading="Weg / mm\tHöhe / µm"), {}),
    "line of units": (table(heading="mm um"), {}),
    "line of units under names": (table(";", heading="distance;height\n[mm];[µm]"), {}),
    "units in the file and the scene": (table(",", heading="x [mm],h [um]"), UNITS),
    "decimal comma": (table(" ", ","), UNITS),
    "decimal comma, semicolons": (table(";", ","), UNITS),
    "decimal comma, tabs": (table("\t", ","), UNITS),
    "semicolons with blanks": (table(" ; "), UNITS),
    "a delimiter at every end": (table(";", heading="x [mm];h [um]", end=";\n"), {}),
    "quoted": ('"x [mm]","h [um]"\n' + "".join(f'"{a}","{b}"\n' for a, b in zip(X, H, strict=True)), {}),
    "latin-1": (table(";", ",", "Länge [mm];Höhe [µm]").encode("latin-1"), {}),
    "byte order mark": (b"\xef\xbb\xbf" + table(";", ",", "x [mm];h [µm]", end="\r\n").encode(), {}),
    "lines that end with CR": (table(end="\r"), UNITS),
    "lines skipped above a heading": (VENDOR + table(";", heading="x [mm];h [um]"), SKIPPED),
    "lines skipped": (VENDOR + table(";"), SKIPPED | UNITS),
    "heights alone": (alone(), {"spacing": 0.25, **UNITS}),
    "heights alone, decimal comma": ("Höhe [µm]\n" + alone(","), {"spacing": 0.25, "decimal": ",", "unit_x": "mm"}),
}


@pytest.mark.parametrize("name", DIALECTS)
def test_dialect_gives_the_measured_line(name, tmp_path):
    text, values = DIALECTS[name]
    scan = scan_of(tmp_path, text, **values)
    np.testing.assert_allclose(scan.x, X * 1e-3, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(scan.h, H * 1e-6, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("unit", METRES)
def test_every_unit_is_read_from_a_heading(unit, tmp_path):
    scan = scan_of(tmp_path, table(",", heading=f"x [mm],h [{unit}]"))
    np.testing.assert_allclose(scan.h, H * METRES[unit], rtol=1e-9)
    assert (scan.facts["unit_h"], scan.facts["unit_h_from"]) == (unit, "file")


@pytest.mark.parametrize(("word", "unit"), [("µm", "um"), ("\u03bcm", "um"), ("Å", "angstrom"), ("\u212b", "angstrom")])
def test_signs_of_units_have_one_meaning(word, unit, tmp_path):
    assert scan_of(tmp_path, table(",", heading=f"x [mm],h [{word}]")).facts["unit_h"] == unit


@pytest.mark.parametrize("word", ["NaN", "nan", "N/A", "#N/A", "--", "***", "1.#QNAN", "inf", "null", ""])
def test_words_for_a_missing_height_are_known(word, tmp_path):
    lines = table(";").splitlines()
    lines[7] = f"{X[7]};{word}"
    scan = scan_of(tmp_path, "\n".join(lines), **UNITS)
    assert np.flatnonzero(np.isnan(scan.h)).tolist() == [7]
    np.testing.assert_allclose(scan.x, X * 1e-3, rtol=1e-12)


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


LC = "Lc [mm];Ls [um]"


@pytest.mark.parametrize(
    ("text", "values", "key", "problem"),
    [
        pytest.param("", UNITS, "file", "holds no line of numbers", id="empty"),
        pytest.param("some words\nand more\n", UNITS, "file", "lines 1 to 2 ('some words', 'and more')", id="words"),
        pytest.param("1 2\n3 4\n", UNITS, "file", "holds 2 samples", id="two samples"),
        pytest.param(table() + "4\n", UNITS, "file", "line 41 ('4') holds 1 column", id="ragged"),
        pytest.param(table() + "11 high\n", UNITS, "file", "line 41 ('11 high') holds more", id="text"),
        pytest.param(table() + "10 1e400\n", UNITS, "file", "line 41 ('10 1e400')", id="beyond all magnitudes"),
        pytest.param(table() + "10 1.0D+00\n", UNITS, "file", "line 41 ('10 1.0D+00')", id="exponent with D"),
        pytest.param(table() + "# measured\n", UNITS, "file", "line 41 ('# measured')", id="remark"),
        pytest.param(table(";", ",") + "10,0;1.234,5\n", UNITS, "file", "line 41", id="thousands"),
        pytest.param("O.25 1.5\n" + table(), UNITS, "file", "line 1 ('O.25 1.5') is not", id="a letter O"),
        pytest.param(table(heading="x h"), UNITS, "file", "line 1 ('x h') is not", id="names without units"),
        pytest.param(table(heading="Filter [um]"), UNITS, "file", "line 1 ('Filter", id="one setting with a unit"),
        pytest.param(table(";", heading=f"{LC}\nx [mm];h [um]"), UNITS, "file", "lines 1 to 2", id="settings above"),
        pytest.param(table(heading="NODATA -9999\nmm um"), {}, "file", "lines 1 to 2", id="no data above units"),
        pytest.param(
            f"y/x;{';'.join(map(str, X))}\n" + f"0;{';'.join(map(str, H))}\n" * 4,
            UNITS,
            "file",
            "line 1",
            id="axis that looks like a heading",
        ),
        pytest.param(table(heading="x/y 0.5"), UNITS, "file", "line 1", id="number in a heading"),
        pytest.param("0,1,25\n1,-1,50\n2,0,75\n", UNITS, "decimal", "line 1 ('0,1,25') has", id="commas of both kinds"),
        pytest.param("0,1\n1,2\n2,4\n", UNITS, "decimal", "2 columns or 1 column", id="comma of either kind"),
        pytest.param(table(), UNITS | {"skip_lines": 41}, "skip_lines", "= 41", id="more skipped than there are"),
        pytest.param(table(","), {"unit_x": "mm"}, "unit_h", "is missing", id="no unit"),
        pytest.param(table(",", heading="x [um],h [um]"), UNITS, "unit_x", 'says "um" in line 1', id="contradiction"),
        pytest.param(table(",", heading="x [px],h [um]"), UNITS, "unit_x", "'px' in line 1", id="pixels"),
    ],
)
def test_wrong_file_is_refused(text, values, key, problem, tmp_path):
    refusal = refusal_of(tmp_path, text, **values)
    assert (refusal.path, problem in refusal.found) == (f"profile.{key}", True), refusal


@pytest.mark.parametrize("delimiter", ["\t", "\t\t", "\t \t", " \t"])
@pytest.mark.parametrize("end", ["", "\t", "\t\t", " \t "])
@pytest.mark.parametrize("begin", ["", "\t"])
def test_tabs_part_columns(delimiter, end, begin, tmp_path):
    """A tab more is an empty column, which no key for the decimal mark can name."""
    text = begin + table(delimiter, end=f"{end}\n{begin}").removesuffix(begin)
    x_column = 1 + begin.count("\t")
    columns = [x_column, x_column + delimiter.count("\t")]
    width = columns[1] + end.count("\t")
    if width > 3 or (width == 3 and columns != [1, 2]):
        assert f"the file has {max(width - 1, columns[1])} columns" in refusal_of(tmp_path, text, **UNITS).found
    scan = scan_of(tmp_path, text, columns=columns, **UNITS)
    np.testing.assert_allclose([scan.x, scan.h], [X * 1e-3, H * 1e-6], rtol=1e-9, atol=1e-15)


def test_whole_numbers_between_commas_are_columns_if_the_scene_says_so(tmp_path):
    text = "".join(f"{k},{k * k % 7},{k * k % 5}\n" for k in range(COUNT))
    assert refusal_of(tmp_path, text, columns=[1, 2], **UNITS).path == "profile.decimal"
    scan = scan_of(tmp_path, text, columns=[1, 2], valid_column=0, decimal=".", **UNITS)
    np.testing.assert_allclose(scan.h, np.arange(COUNT) ** 2 % 7 * 1e-6, rtol=1e-12)


@pytest.mark.parametrize("text", ["7777", ".5", "0", "0,5", "-9999.0", "1e3"])
@pytest.mark.parametrize("skipped", [True, False])
def test_number_above_the_heights_that_equals_a_height_is_asked_for(text, skipped, tmp_path):
    if text == "0,5" and not skipped:
        return  # no heading: a comma parts cells
    value, h = float(text.replace(",", ".")), H.copy()
    h[[5, 6, 20]] = value
    name, keys = ("x [mm];n [1];h [um]", {"skip_lines": 2}) if skipped else (f"x [mm];no data {text};h [um]", {})
    lines = f"points 12345;nothing seen {text}\n\n" * skipped + name + "\n"
    lines += "".join(f"{x};{k};{height}\n" for k, (x, height) in enumerate(zip(X, h, strict=True)))
    refusal = refusal_of(tmp_path, lines, columns=[1, 3], **keys)
    assert (refusal.path, f": {value:g}, as {(h == value).sum()} heights" in refusal.found) == (
        "profile.missing_value",
        True,
    )
    for missing in (value, "none", 99.0):
        scan = scan_of(tmp_path, lines, columns=[1, 3], missing_value=missing, **keys)
        np.testing.assert_allclose(scan.h, np.where(h == missing, np.nan, h) * 1e-6, rtol=1e-12)


def test_lines_above_the_numbers_are_shown_with_what_skips_them(tmp_path):
    refusal = refusal_of(tmp_path, "ncols 40\n\nNODATA_value -9999\n" + table(";", heading="x [mm];h [um]"))
    assert refusal.found == "lines 1 to 4 ('ncols 40', 'NODATA_value -9999', 'x [mm];h [um]') are not numbers"
    assert (
        "if no samples stand there, skip_lines = 3, and what the lines say in unit_x, unit_h, spacing, columns, missing"
        in refusal.allowed
    )


@pytest.mark.parametrize("decimal", [".", ","])
def test_what_the_lines_above_a_map_state_is_told_as_keys_that_read_it(decimal, tmp_path):
    heights = np.round(np.random.default_rng(4).normal(size=(6, 16)), 4)
    header = "# Channel: Height\n# Width: 4.000 µm\n# Height: 1.500 µm\n# Value units: nm\n"
    text = (header + "\n".join("\t".join(f"{h:.4f}" for h in line) for line in heights)).replace(".", decimal)
    refusal = refusal_of(tmp_path, text, row=3)
    assert f"lines 1 to 4 ('# Channel: Height', '# Width: 4{decimal}000 µm', '# Height" in refusal.found
    told = 'skip_lines = 4, spacing = 0.25, unit_x = "um" (16 heights on a line are 4 um wide), unit_h = "nm"; and row'
    assert told in refusal.allowed
    scan = scan_of(tmp_path, text, row=3, skip_lines=4, spacing=0.25, unit_x="um", unit_h="nm")
    np.testing.assert_allclose([scan.x, scan.h], [np.arange(16) * 0.25e-6, heights[3] * 1e-9], rtol=1e-12)
    part = refusal_of(tmp_path, text.replace("Width: 4", "Width about 4"), row=3).allowed
    assert "skip_lines = 4, and what the lines say in" in part and ' (unit_h = "nm"); ' in part


@pytest.mark.parametrize("heading", ["", "x [mm],h [um]", "x,h", "x,h\nmm,um"])
@pytest.mark.parametrize("digits", [None, 3])
def test_commas_of_both_kinds_are_the_reason_that_is_told(heading, digits, tmp_path):
    """Also under a heading of two columns, for lines of unlike lengths, and where the scene states the comma."""
    form = "{:g},{:g}" if digits is None else f"{{:.{digits}f}},{{:.{digits}f}}"
    rows = [form.format(x, h).replace(".", ",") for x, h in zip(X, H, strict=True)]
    text = "\n".join([heading, *rows])
    refusal = refusal_of(tmp_path, text)
    doubtful = "has commas that may part columns or decimals" in refusal.found
    sure = "has commas between columns beside decimal commas" in refusal.found
    assert (refusal.path, doubtful, sure) == (
        ("profile.file", False, True) if heading else ("profile.decimal", True, False)
    )
    assert "write decimal points, or semicolons between columns" in refusal.allowed
    refusal = refusal_of(tmp_path, text, decimal=",")
    assert "has commas between columns beside decimal commas" in refusal.found


@pytest.mark.parametrize("heading", ["x [mm];h [um]", "# x [mm];h [um]", "x;h\nmm;um"])
def test_comments_above_a_heading_are_read_over(heading, tmp_path):
    """They state no unit, and are named in the facts; a line that is no comment is still refused."""
    comments = "# Instrument 7\n% x [nm];h [nm]\n"
    scan = scan_of(tmp_path, comments + table(";", heading=heading))
    np.testing.assert_allclose(scan.h, H * 1e-6, rtol=1e-12)
    assert (scan.facts["unit_x"], scan.facts["skipped"]) == ("mm", "# Instrument 7 | % x [nm];h [nm]")
    refusal = refusal_of(tmp_path, comments + "Operator\n" + table(";", heading=heading))
    assert (refusal.path, "'Operator'" in refusal.found) == ("profile.file", True)


def test_number_in_a_comment_that_equals_a_height_is_asked_for(tmp_path):
    lines = "# no data: -9999\nx [mm];h [um]\n" + table(";", h=np.where(H[3] == H, -9999, H))
    refusal = refusal_of(tmp_path, lines)
    assert (refusal.path, "line 1 ('# no data: -9999'): -9999" in refusal.found) == ("profile.missing_value", True)


@pytest.mark.parametrize("sign", "\u2212\u2013\uff0d")
@pytest.mark.parametrize("place", [0, 20])
def test_minus_signs_of_unicode_are_told(sign, place, tmp_path):
    lines = table(h=-np.abs(H) - 1).splitlines()
    lines[place] = lines[place].replace("-", sign)
    refusal = refusal_of(tmp_path, "\n".join(lines), **UNITS)
    assert f"line {place + 1} (" in refusal.found and f"(U+{ord(sign):04X})" in refusal.found
    assert 'the hyphen "-"' in refusal.allowed


def test_lines_are_counted_as_editors_do(tmp_path):
    """A form feed and the byte 0x85 end no line, but are no numbers either."""
    refusal = refusal_of(tmp_path, "a\x0cb\x85c\x1c\u2028d\r\ne\r" + table(), skip_lines=0, **UNITS)
    assert refusal.found.startswith("lines 1 to 2 (")
    assert scan_of(tmp_path, b"a\x0cb\x85c\r\ne\r" + table().encode(), skip_lines=2, **UNITS).place(0) == "line 3"
    assert "line 2 (" in refusal_of(tmp_path, "0 1\n1\x0c2\n" + table(), **UNITS).found


def test_many_bad_lines_are_counted(tmp_path):
    with pytest.raises(ScanFileError) as caught:
        scan_of(tmp_path, table() + "1 high\n" * 10, **UNITS)
    assert [refusal.found for refusal in caught.value.mistakes][-1] == "and 7 more lines like that"


def test_many_points_are_read_at_once(tmp_path):
    count = 300_000
    scan = scan_of(tmp_path, "\n".join(f"{k / 4},{k % 1000 / 8}" for k in range(count)), **UNITS)
    assert scan.h.size == count
    assert (scan.x[-1], scan.h[-1]) == pytest.approx(((count - 1) / 4e3, 999 / 8e6), rel=1e-12)


HEADINGS = ("x [{x}]|h [{h}]", "x ({x})|h ({h})", "x / {x}|h / {h}", "{x}|{h}", "x [{x}]|h", "x|h", "Filter [um]|Gauss")
HEADER = ("Instrument 7", "Points: 1000", "Cutoff;0,8;mm", "1 2 3", "512 512", "Date 1.2.2024", "# comment")
DAMAGE = ("NaN", "bad", "3;4", "x", "1.2.3", "-;4")
FILES = 600


def made_up(rng):
    """A file made up at random, what the scene says of it, and the line that is meant."""
    count = rng.choice([4, 20, 60])
    numbers = np.random.default_rng(rng.randrange(2**31))
    x = np.arange(count) * rng.choice([1, 0.5, 0.25, 0.1])
    h = np.round(numbers.normal(size=count) * rng.choice([1, 10, 1000]), rng.choice([0, 1, 3]))
    single, mark, delimiter = rng.random() < 0.2, rng.choice(".,"), rng.choice([",", ";", "\t", " ", "  ", ", ", " ; "])
    form = [rng.choice(["%g", "%.3f", "%.6e"]) for _ in "xh"]
    texts = [[form[0] % a, form[1] % b][single:] for a, b in zip(x, h, strict=True)]
    rows = [delimiter.join(cell.replace(".", mark) for cell in cells) for cells in texts]
    units = {axis: rng.choice(["m", "mm", "um", "nm"]) for axis in "xh"}
    header = rng.sample(HEADER, rng.randrange(4)) if rng.random() < 0.4 else []
    values = {f"unit_{axis}": unit for axis, unit in units.items() if rng.random() < 0.7}
    values |= {"skip_lines": len(header)} if rng.random() < 0.8 else {}
    if rng.random() < 0.6:
        names = rng.choice(HEADINGS).format(**units).split("|")
        header.append(delimiter.join(names[single:]))
    if rng.random() < 0.15:
        rows[rng.randrange(1, count)] = rng.choice(DAMAGE)
    text = "\n".join([*header, *rows]).encode(rng.choice(["utf-8", "utf-8-sig", "latin-1", "utf-16"]))
    values |= {"spacing": float(x[1])} if single else {}
    values |= {"decimal": mark} if rng.random() < 0.3 else {}
    meant = (x if single else np.array([float(cells[0]) for cells in texts])), np.array([float(c[-1]) for c in texts])
    return text, values, [numbers * METRES[units[axis]] for axis, numbers in zip("xh", meant, strict=True)]


def test_no_file_made_up_at_random_is_misread(tmp_path):
    """Every one is read as it was meant, or refused."""
    rng, right = random.Random(7), 0
    for _ in range(FILES):
        content, values, meant = made_up(rng)
        try:
            line = prepare(scan_of(tmp_path, content, **values), {"missing": "interpolate"}).measured
        except ScanFileError:
            continue
        x, h, right = line.x, line.h, right + 1
        assert h.size == meant[1].size, content
        np.testing.assert_allclose(x, meant[0], rtol=1e-9, err_msg=repr(content))
        known = np.isfinite(h)
        np.testing.assert_allclose(h[known], meant[1][known], rtol=1e-9, err_msg=repr(content))
    assert right > FILES / 4  # measured 252 of 600
