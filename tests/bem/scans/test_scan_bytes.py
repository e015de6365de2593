"""Bytes that are text, in any encoding; all others, and files that are none, are told; nothing takes long."""

import bz2
import gzip
import lzma
import os
import time

import numpy as np
import pytest
from scene_tables import tables

from bem.scans.scan_file import read_scan
from bem.scans.scan_refusal import ScanFileError
from bem.scene.scene import SceneError, load_scene, parse_scene

UNITS = {"unit_x": "mm", "unit_h": "um"}
ROWS = "".join(f"{k * 0.25},{k * 7 % 5 - 2}\n" for k in range(20))
HEADED = "x (mm),h (µm)\n" + ROWS
H = (np.arange(20) * 7 % 5 - 2.0) * 1e-6
SECONDS = 1.3  # of lines that took a minute and more; measured 0.44 at most


def scan_of(folder, content, **values):
    path = folder / "scan.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_scan(path, values)


ENCODINGS = ["utf-8", "utf-8-sig", "latin-1", "cp1252", "utf-16", "utf-16-le", "utf-16-be", "utf-32"]


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("tail", ["", "\0" * 200, "\x1a", "\x1a\0\0"], ids=["", "zeros", "end of file", "both"])
def test_encodings(encoding, tail, tmp_path):
    scan = scan_of(tmp_path, (HEADED + tail).encode(encoding))
    np.testing.assert_allclose(scan.h, H, rtol=1e-12)
    assert scan.facts["unit_h"] == "um"


@pytest.mark.parametrize("pack", [gzip.compress, bz2.compress, lzma.compress])
def test_compressed_files_are_named(pack, tmp_path):
    with pytest.raises(ScanFileError, match="is compressed"):
        scan_of(tmp_path, pack(ROWS.encode()), **UNITS)


@pytest.mark.parametrize("place", [5, 60, 90])
def test_zero_byte_amid_text_is_told_by_its_line(place, tmp_path):
    """SurfaceTopography reads such files without the lines in question."""
    text = ROWS[:place] + "\0" + ROWS[place:]
    with pytest.raises(ScanFileError, match=f"is no text: a zero byte in line {ROWS[:place].count(chr(10)) + 1}"):
        scan_of(tmp_path, text, **UNITS)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("/dev/zero", "is a device or a pipe"),
        ("pipe", "is a device or a pipe"),
        (".", "is a folder"),
        ("a\0b", "is no name of a file"),
        ("nowhere", "cannot be read"),
        ("n" * 5000, "cannot be read"),
    ],
)
def test_what_is_no_file_is_told(name, said, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    scene = tables({"kind": "samples", "file": name, **UNITS}, "mean_pressure", [1e5])
    with pytest.raises(SceneError) as caught:
        parse_scene(scene, tmp_path)
    (mistake,) = caught.value.mistakes
    assert (mistake.path, said in mistake.found) == ("profile.file", True)


@pytest.mark.parametrize("number", ["1e400", "-1e300", "9" * 400])
@pytest.mark.parametrize("column", [0, 1])
def test_numbers_beyond_all_magnitudes_are_refused_with_their_line(number, column, tmp_path):
    row = ["5.0", "1.0"]
    row[column] = number
    with pytest.raises(ScanFileError, match=r"line 21 \(.* holds a number beyond 1e\+60"):
        scan_of(tmp_path, ROWS + ",".join(row) + "\n", **UNITS)


LONG = {
    "digits": "1" * 2000 + "x 2",
    "many digits": "1" * 200_000 + "x 2",
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
    """Before the rows they are a header, amid them a mistake; both in a time that grows as their length."""
    text = LONG[name] + "\nx,h\n" + ROWS if where == "before" else ROWS + LONG[name] + "\n" + ROWS
    start = time.process_time()
    try:
        assert scan_of(tmp_path, text, **UNITS).h.size == 20
    except ScanFileError as error:
        assert where == "amid" or "line 1" in str(error)
    assert time.process_time() - start < SECONDS


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
def test_scene_with_a_mark_of_its_encoding(encoding, tmp_path):
    text = (
        "[solid]\nyoungs_modulus = 1e9\npoisson_ratio = 0.3\n"
        '[profile]\nkind = "harmonics"\nperiod = 1e-3\norders = [1]\namplitudes = [1e-6]\nphases = [0.0]\n'
        '[loading]\ncontrol = "mean_pressure"\ntargets = [1e5]\n'
    )
    (tmp_path / "scene.toml").write_text(text, encoding)
    assert load_scene(tmp_path / "scene.toml").loading.targets == (1e5,)
