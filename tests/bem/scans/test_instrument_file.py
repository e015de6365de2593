"""Files of instruments: lines and maps come back with their lengths and units, and what is not clear is refused."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest

from bem.scans import instrument_file
from bem.scans.scan_file import read_scan
from bem.scans.scan_text import ScanFileError

RNG = np.random.default_rng(2)
MAP = np.round(RNG.normal(size=(8, 3)), 3)  # (along x, along y), um
UNITS = {"unit_x": "um", "unit_h": "um"}


@pytest.fixture
def topography():
    return pytest.importorskip("SurfaceTopography")


def written(folder, surface, ending):
    path = folder / f"scan.{ending}"
    getattr(surface, {"nc": "to_netcdf", "gwy": "to_gwy", "x3p": "to_x3p"}[ending])(str(path))
    return path


@pytest.mark.parametrize("ending", ["nc", "gwy", "x3p"])
@pytest.mark.parametrize("row", [0, 2, "mean"])
def test_row_of_a_map(ending, row, topography, tmp_path):
    path = written(tmp_path, topography.Topography(MAP, (4.0, 3.0), unit="um"), ending)
    scan = read_scan(path, {"row": row})
    expected = MAP.mean(axis=1) if row == "mean" else MAP[:, row]
    np.testing.assert_allclose(scan.h, expected * 1e-6, rtol=1e-9, atol=1e-18)
    np.testing.assert_allclose(scan.x, 0.5e-6 * np.arange(8), rtol=1e-9)
    assert (scan.facts["format"], scan.facts["unit_h_from"]) == (ending, "file")


def test_line_scan(topography, tmp_path):
    path = written(tmp_path, topography.UniformLineScan(MAP[:, 0], 4.0, unit="um"), "nc")
    scan = read_scan(path, {})
    np.testing.assert_allclose(scan.h, MAP[:, 0] * 1e-6, rtol=1e-9)
    np.testing.assert_allclose(scan.x, 0.5e-6 * np.arange(8), rtol=1e-9)


def test_line_scan_of_unequal_steps(topography, tmp_path):
    x = np.array([0.0, 1.0, 3.0, 4.0])
    path = written(tmp_path, topography.NonuniformLineScan(x, MAP[:4, 0], unit="mm"), "nc")
    np.testing.assert_allclose(read_scan(path, {}).x, x * 1e-3, rtol=1e-9)


def test_undefined_heights_are_missing(topography, tmp_path):
    heights = np.ma.masked_array(MAP, mask=np.zeros_like(MAP, dtype=bool))
    heights[5, 1] = np.ma.masked
    path = written(tmp_path, topography.Topography(heights, (4.0, 3.0), unit="um"), "nc")
    assert np.flatnonzero(np.isnan(read_scan(path, {"row": 1}).h)).tolist() == [5]
    assert np.isnan(read_scan(path, {"row": "mean"}).h[5])


@pytest.mark.parametrize(
    ("unit", "values", "key", "said"),
    [
        ("um", {}, "row", "a map of 3 rows"),
        ("um", {"row": 3}, "row", "= 3"),
        ("um", {"row": 0, "unit_x": "mm"}, "unit_x", 'says "um" in what its instrument wrote'),
        ("um", {"row": 0, "channel": 1}, "channel", "= 1"),
        ("um", {"row": 0, "decimal": "."}, "decimal", "text files"),
        ("um", {"row": 0, "spacing": 1.0}, "spacing", "is in the file"),
        (None, {"row": 0}, "unit_x", "does not state it"),
        ("ft", {"row": 0, **UNITS}, "unit_x", "'ft'"),
    ],
)
def test_what_is_not_clear_is_refused(unit, values, key, said, topography, tmp_path):
    path = written(tmp_path, topography.Topography(MAP, (4.0, 3.0), **({} if unit is None else {"unit": unit})), "nc")
    with pytest.raises(ScanFileError) as caught:
        read_scan(path, values)
    assert caught.value.refusals[0].key == key
    assert said in caught.value.refusals[0].found


def test_file_of_no_known_format_is_told(topography, tmp_path):
    (tmp_path / "scan.bin").write_bytes(b"\x00\x01\x02" * 100)
    with pytest.raises(ScanFileError, match="cannot be read by SurfaceTopography"):
        read_scan(tmp_path / "scan.bin", UNITS)


def test_library_that_is_not_there_is_named_with_the_remedy(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, instrument_file.LIBRARY, None)
    (tmp_path / "scan.opd").write_bytes(b"\x00\x01\x02" * 100)
    with pytest.raises(ScanFileError, match=r"linecontact\[instruments\]"):
        read_scan(tmp_path / "scan.opd", UNITS)


def channel(name, unit="µm"):
    surface = SimpleNamespace(heights=lambda: MAP[:, 0] + len(name), is_uniform=True)
    surface.positions = lambda: np.arange(8.0)
    return SimpleNamespace(
        name=name, unit=unit, is_height_channel=True, physical_sizes=(8.0,), topography=lambda: surface
    )


def test_one_of_several_channels_has_to_be_named(monkeypatch, tmp_path):
    reader = SimpleNamespace(
        channels=[channel("trace"), channel("retrace")], format=lambda: "made up", close=lambda: None
    )
    library = SimpleNamespace(open_topography=lambda path: reader)
    monkeypatch.setitem(sys.modules, instrument_file.LIBRARY, library)
    (tmp_path / "scan.bin").write_bytes(b"\x00")
    with pytest.raises(ScanFileError, match=r"2 channels of heights; allowed: one of 0 \(trace\), 1 \(retrace\)"):
        read_scan(tmp_path / "scan.bin", {})
    assert read_scan(tmp_path / "scan.bin", {"channel": 1}).facts["channel"] == "retrace"


def library_of(opened, *channels):
    def open_topography(path):
        opened.append(path)
        return SimpleNamespace(channels=channels, format=lambda: "made up", close=lambda: opened.append("closed"))

    return SimpleNamespace(open_topography=open_topography)


def test_library_is_given_the_path_and_the_file_is_closed(monkeypatch, tmp_path):
    """Some formats are known by their file names only."""
    opened = []
    monkeypatch.setitem(sys.modules, instrument_file.LIBRARY, library_of(opened, channel("Topography", "Å")))
    (tmp_path / "scan.nms").write_bytes(b"\x00\x01\x02" * 100)
    scan = read_scan(tmp_path / "scan.nms", {})
    assert opened == [str(tmp_path / "scan.nms"), "closed"]
    np.testing.assert_allclose(scan.x, np.arange(8) * 1e-10, rtol=1e-12)
    assert (scan.facts["unit_x"], scan.facts["unit_h"]) == ("angstrom", "angstrom")


@pytest.mark.parametrize("name", ["Phase", "Phase [Fwd]", "Amplitude_error", "Lateral friction"])
def test_channel_that_is_no_height_is_not_taken(name, monkeypatch, tmp_path):
    (tmp_path / "scan.bin").write_bytes(b"\x00\x01\x02" * 100)
    monkeypatch.setitem(sys.modules, instrument_file.LIBRARY, library_of([], channel(name)))
    with pytest.raises(ScanFileError, match="no channel of heights"):
        read_scan(tmp_path / "scan.bin", {})
    monkeypatch.setitem(sys.modules, instrument_file.LIBRARY, library_of([], channel(name), channel("ZSensor")))
    assert read_scan(tmp_path / "scan.bin", {}).facts["channel"] == "ZSensor"


@pytest.mark.parametrize("unit", ["deg", "V", "ft", ""])
def test_unit_of_another_kind_is_refused_by_its_name(unit, monkeypatch, tmp_path):
    (tmp_path / "scan.bin").write_bytes(b"\x00\x01\x02" * 100)
    monkeypatch.setitem(sys.modules, instrument_file.LIBRARY, library_of([], channel("Z", unit)))
    with pytest.raises(ScanFileError, match=f"unit_h: is '{unit}' in what its instrument wrote"):
        read_scan(tmp_path / "scan.bin", UNITS)
