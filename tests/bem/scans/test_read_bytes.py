"""Bytes that are text, in any encoding; bytes and files that are none are refused; no line takes long."""

import os
import time

import numpy as np
import pytest
from scene_tables import tables

from bem.scans.read_scan import read_scan
from bem.scans.scan_file_error import ScanFileError
from bem.scene.scene import SceneError, load_scene, parse_scene

UNITS = {"unit_x": "mm", "unit_h": "um"}
ROWS = "".join(f"{k * 0.25},{k * 7 % 5 - 2}\n" for k in range(20))
H = (np.arange(20) * 7 % 5 - 2.0) * 1e-6
SECONDS = 1.3  # of lines that took a minute and more; measured 0.44 at most


def scan_of(folder, content, **values):
    path = folder / "scan.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_scan(path, values)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "cp1252", "utf-16", "utf-32"])
def test_encodings(encoding, tmp_path):
    scan = scan_of(tmp_path, ("x (mm),h (µm)\n" + ROWS).encode(encoding))
    np.testing.assert_allclose(scan.h, H, rtol=1e-12)
    assert scan.facts["unit_h"] == "um"


@pytest.mark.parametrize("place", [5, 60, 90])
def test_zero_byte_amid_text_is_told_by_its_line(place, tmp_path):
    """SurfaceTopography reads such files without the lines in question."""
    text = ROWS[:place] + "\0" + ROWS[place:]
    with pytest.raises(ScanFileError, match=f"is no text: a zero byte in line {ROWS[:place].count(chr(10)) + 1}"):
        scan_of(tmp_path, text, **UNITS)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("/dev/zero", "a pipe or a device"),
        ("pipe", "a pipe or a device"),
        (".", "is a folder, "),
        ("a\0b", "is no name of a file"),
        ("nowhere", "cannot be read"),
    ],
)
def test_path_that_is_no_file_is_refused(name, reason, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    scene = tables({"kind": "samples", "file": name, **UNITS}, "mean_pressure", [1e5])
    with pytest.raises(SceneError) as caught:
        parse_scene(scene, tmp_path)
    (mistake,) = caught.value.mistakes
    assert (mistake.path, reason in mistake.found) == ("profile.file", True)


@pytest.mark.parametrize("name", ["C:\\Users\\me\\scan.csv", "C:\\data.csv", "C:\\temp\\new.csv"])
def test_backslashes_in_a_name_are_told(name, tmp_path):
    text = '[solid]\nyoungs_modulus = 1e9\npoisson_ratio = 0.3\n[loading]\ncontrol = "mean_pressure"\ntargets = [1e5]\n'
    text += f'[profile]\nkind = "samples"\nunit_x = "mm"\nunit_h = "um"\nfile = "{name}"\n'
    (tmp_path / "scene.toml").write_text(text)
    with pytest.raises(SceneError, match=r"in single quotes, 'C:\\Users"):
        load_scene(tmp_path / "scene.toml")


LONG = {
    "digits": "1" * 200_000 + "x 2",
    "digits with commas": ",".join(["123"] * 50_000) + "x",
    "points": "1." * 100_000,
    "brackets": "[" * 200_000,
    "open brackets": "x [mm],h [um]" + "[a" * 100_000,
    "a quoted cell": '"' + "a" * 200_000 + '","um"',
    "blanks": " " * 200_000 + "x",
    "strokes": "x / " * 50_000,
}


@pytest.mark.parametrize("name", LONG)
@pytest.mark.parametrize("where", ["before", "amid"])
def test_long_lines_take_no_time(name, where, tmp_path):
    """Lines above the numbers and amid them are refused in a time that grows as their length."""
    text = LONG[name] + "\n" + ROWS if where == "before" else ROWS + LONG[name] + "\n" + ROWS
    start = time.process_time()
    with pytest.raises(ScanFileError, match="line 1 " if where == "before" else "line 21 "):
        scan_of(tmp_path, text, **UNITS)
    assert time.process_time() - start < SECONDS
