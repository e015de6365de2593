"""What headers state: understood, or refused by its name; never passed over, whatever the scene says beside it."""

import numpy as np
import pytest

from bem.scans.scan_file import read_scan
from bem.scans.scan_keys import METRES
from bem.scans.scan_refusal import ScanFileError
from bem.scans.scan_units import unit_of

COUNT = 20
X, H = np.arange(COUNT) * 0.25, np.arange(COUNT) * 7 % 5 - 2.0
LINE = "".join(f"{a},{b}\n" for a, b in zip(X, H, strict=True))
ALONE = "".join(f"{b}\n" for b in H - 0.5)
MAP = "".join("\t".join(map(str, H[:8] + k)) + "\n" for k in range(4))
UNITS = {"unit_x": "mm", "unit_h": "um"}


def scan_of(folder, text, **values):
    path = folder / "scan.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_scan(path, values)


def refusal_of(folder, text, **values):
    with pytest.raises(ScanFileError) as caught:
        scan_of(folder, text, **values)
    return caught.value.refusals[-1]


HEADINGS = (
    *("x [mm],h [{}]", "x (mm),h ({})", "x / mm,h [{}]", "mm,{}", "Unit,mm,{}", "X unit: mm\nZ unit: {}"),
    *('"x unit","mm"\n"Value units","{}"', "x [mm] h [{}]"),
)
SPELT = {
    **{"m": ["m", "metres", "Meter"], "cm": ["cm", "CM"], "mm": ["mm", "MM", "Millimeter", "㎜"]},
    "um": ["um", "µm", "μm", "UM", "micron", "Microns", "micrometre", "㎛", "Âµm", "um."],
    "nm": ["nm", "NM", "nanometers", "㎚"],
    "angstrom": ["Å", "Å", "Å", "angstrom", "Ångström", "Angstroms", "Ang"],
    **{"pm": ["pm", "picometre"], "in": ["in", "inch", "Inches"], "mil": ["mil", "mils", "thou"]},
    "uin": ["uin", "µin", "μin", "microinch", "micro-inches"],
}


@pytest.mark.parametrize(("unit", "word"), [(unit, word) for unit, words in SPELT.items() for word in words])
def test_units_are_known_by_all_their_names(unit, word, tmp_path):
    assert unit_of(word) == unit
    scan = scan_of(tmp_path, f"x [mm],h ({word})\n" + LINE)
    np.testing.assert_allclose(scan.h, H * METRES[unit], rtol=1e-12)


@pytest.mark.parametrize(
    "word", ["ft", "rad", "V", "km", "counts", "px", "deg", "Mm", "furlong", "0.5 um", "10^-6 m", "nm/V"]
)
@pytest.mark.parametrize("heading", HEADINGS)
@pytest.mark.parametrize("given", [{}, UNITS], ids=["", "given"])
def test_other_units_are_refused_by_their_names(word, heading, given, tmp_path):
    """Also where the scene gives a unit: it cannot be the same."""
    refusal = refusal_of(tmp_path, heading.format(word) + "\n" + LINE, **given)
    assert (refusal.key, f"{word!r} in line" in refusal.found) == ("unit_h", True), refusal


@pytest.mark.parametrize(
    "header",
    [
        "X unit: mm\nZ-Unit = nm",
        "XUnit\tmm\nZUnit\tnm",
        "x-unit: mm\nz-unit: nm",
        "Unit X = mm\nUnit Data = nm",
        "Units of x: mm\nUnits of z: nm",
        "X in mm, Z in nm",
        "Unit;mm;nm",
        "Unit:,mm,nm",
        "Distance (mm)  Height (nm)\n[DATA]",
        "Trace 1\nx,y\nmm,nm",
        "Scan Length,5.000,mm\nLateral mm,Raw nm",
        "Lateral unit: mm\nheights in nm",
        '"X unit","mm"\n"Y unit","nm"',
        "# x [mm]  y [nm]",
        "x_mm,z_nm",
        "Unit: nm\nx [mm],h [nm]",
    ],
)
@pytest.mark.parametrize("given", [{}, {"unit_x": "mm"}, {"unit_h": "um"}, {"unit_x": "um"}], ids=str)
def test_units_of_a_line(header, given, tmp_path):
    text = header + "\n" + LINE
    if given in ({}, {"unit_x": "mm"}):
        scan = scan_of(tmp_path, text, **given)
        np.testing.assert_allclose(scan.h, H * 1e-9, rtol=1e-12)
        np.testing.assert_allclose(scan.x, X * 1e-3, rtol=1e-12, atol=1e-18)
    else:
        assert "contradict" in refusal_of(tmp_path, text, **given).found


@pytest.mark.parametrize(
    ("header", "pitch", "unit"),
    [
        ("# Channel: Z\n# Width: 10.00 µm\n# Height: 10.00 µm\n# Value units: m", 1.25e-6, "m"),
        ("Breite: 10,00 µm\nHöhe: 5 µm\nEinheiten: nm", 1.25e-6, "nm"),
        ("Scan Size: 10 x 5 µm\nUnit: nm", 1.25e-6, "nm"),
        ("Scan size: 10 um x 5 um\nUnit: nm", 1.25e-6, "nm"),
        ("X Amplitude: 100 Å\nZ Amplitude: 20 Å\nUnit: Å", 1.25e-9, "angstrom"),
        ("XY calibration\t1388.0\tnm/pixel\nUnit\tum", 1.388e-6, "um"),
        ('"XY calibration","1388.0","nm"\n"Horizontal","8"\n"Unit","um"\n"Reference data name",""', 1.388e-6, "um"),
        ("Pixel size [nm] = 1388.0\nHeight (nm)", 1.388e-6, "nm"),
        ("\\Scan Size: 10 um\n\\Z data in nm", 1.25e-6, "nm"),
    ],
)
def test_map_with_its_pitch(header, pitch, unit, tmp_path):
    scan = scan_of(tmp_path, header + "\n" + MAP, row=1)
    np.testing.assert_allclose(scan.x, pitch * np.arange(8), rtol=1e-12)
    np.testing.assert_allclose(scan.h, (H[:8] + 1) * METRES[unit], rtol=1e-12)
    assert scan.facts["unit_h_from"] == "file"
    given = {"spacing": pitch * 1e9, "unit_x": "nm"}
    np.testing.assert_allclose(scan_of(tmp_path, header + "\n" + MAP, row=1, **given).x, scan.x, rtol=1e-12)
    wrong = refusal_of(tmp_path, header + "\n" + MAP, row=1, **(given | {"spacing": pitch * 1.3e9}))
    assert (wrong.key, "contradicts line" in wrong.found) == ("spacing", True), wrong
    assert "contradicts the file" in refusal_of(tmp_path, header + "\n" + MAP, row=1, unit_h="mm").found


@pytest.mark.parametrize(
    ("width", "spacing", "agrees"),
    [("4.75", 0.25, True), ("5.00", 0.25, True), ("4.9", 0.25, True), ("5.02", 0.25, False), ("4.6", 0.25, False)],
)
def test_width_is_between_the_first_and_last_sample_and_the_outer_edges(width, spacing, agrees, tmp_path):
    """Of 20 samples: 4.75 to 5 mm, to half a digit."""
    text = f"Unit: um\nTraverse length: {width} mm\n" + ALONE
    if agrees:
        assert scan_of(tmp_path, text, spacing=spacing, unit_x="mm").x[1] == pytest.approx(spacing * 1e-3)
        return
    refusal = refusal_of(tmp_path, text, spacing=spacing, unit_x="mm")
    assert "contradicts line 2" in refusal.found
    assert "5 mm" in refusal.found


@pytest.mark.parametrize("stated", ["Scan length: 5.0 {}", "Sampling interval: 0.25 {}", '"Pitch","0.250","{}"'])
def test_distances_are_held_against_positions(stated, tmp_path):
    scan = scan_of(tmp_path, stated.format("mm") + "\n" + LINE, **UNITS)
    assert "unlike_positions" not in scan.facts
    refusal = refusal_of(tmp_path, stated.format("um") + "\n" + LINE, **UNITS)
    assert (refusal.key, 'that in "um"' in refusal.found) == ("unit_x", True)
    longer = scan_of(tmp_path, "Traverse length: 12.5 mm\n" + LINE, **UNITS)
    assert "Traverse length" in longer.facts["unlike_positions"]


@pytest.mark.parametrize(
    "header",
    [
        *("Cutoff: 0.8 mm", "Evaluation length: 4 mm", "Sampling length: 0.8 mm", "Range: 400 um", "Step height: 5 um"),
        *("Stylus radius [um]: 2", "Temperature unit: C", "Speed: 0.5 mm/s", "Line width: 3 um", "Unit No: 7"),
        *("Lc [mm];Ls [um]\nx,h", "Ra = 0.4 um", "Width: 512 px", '"Unit",""', "Image size: 512 x 512"),
    ],
)
def test_what_is_of_something_else_says_nothing(header, tmp_path):
    scan = scan_of(tmp_path, header + "\n" + LINE, **UNITS)
    assert (scan.x[1], scan.h[1]) == pytest.approx((0.25e-3, H[1] * 1e-6))
    with pytest.raises(ScanFileError, match="unit_x: is missing: the file does not state it"):
        scan_of(tmp_path, header + "\n" + LINE)


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("Channel: Phase", "without heights"),
        ("Channel name: Friction", "without heights"),
        ("Height conversion factor (-> m) = 1e-9", "factor"),
        ("Bit2nm = 0.5", "factor"),
        ("Width: 10 ft", "'ft'"),
        ("Pixel size: 3 yd", "'yd'"),
    ],
)
def test_what_cannot_be_used_is_refused(header, said, tmp_path):
    refusal = refusal_of(tmp_path, header + "\n" + LINE, **UNITS)
    assert (refusal.key, said in refusal.found, "line 1" in refusal.found) == ("file", True, True), refusal


@pytest.mark.parametrize("header", ["# Width: 100", "Scan size = 1.5e2", "Pixel size: 2.5", "Width;100"])
def test_a_width_without_a_unit_is_told_where_the_distance_of_samples_is_missing(header, tmp_path):
    refusal = refusal_of(tmp_path, f"{header}\n# Value units: um\n{MAP}", row=0)
    assert (refusal.key, refusal.found.startswith("is missing: line 1"), "no unit" in refusal.found) == (
        "spacing", True, True,
    )  # fmt: skip


def test_two_distances_in_a_file_are_told(tmp_path):
    refusal = refusal_of(tmp_path, "Pixel size: 2.0 um\nWidth: 10.0 um\nUnit: nm\n" + MAP, row=0)
    assert ("line 1" in refusal.found, "line 2" in refusal.found) == (True, True)


def test_channels_one_after_another_are_not_one(tmp_path):
    """Images in one file: what is said of the second is held against the first."""
    text = f"# Channel: Z\n# Value units: m\n{MAP}# Channel: Amplitude\n# Value units: V\n{MAP}"
    assert "line 7" in refusal_of(tmp_path, text, row=0, spacing=1.0, unit_x="um").found


@pytest.mark.parametrize("text", ["Zygo ASCII Data File - Format 2\n1 2 3\n", "'ISO 5436 - 2000'\nCZ M 3 UM 1.0e-3\n"])
def test_formats_with_a_factor_are_named(text, tmp_path):
    assert "multiples of a factor" in refusal_of(tmp_path, text + ALONE, spacing=1.0, **UNITS).found
