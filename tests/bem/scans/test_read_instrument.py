"""Files of instruments: lines and maps come back with their lengths and units, and what is not clear is refused."""

import subprocess
import sys

import numpy as np
import pytest
import scipy.io

from bem.scans.read_scan import read_scan
from bem.scans.scan_file_error import ScanFileError

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
    scan = read_scan(path, {"row": 1})
    assert (np.flatnonzero(np.isnan(scan.h)).tolist(), scan.facts["missing_points"]) == ([5], 1)
    assert np.isnan(read_scan(path, {"row": "mean"}).h[5])


@pytest.mark.parametrize(
    ("unit", "values", "key", "said"),
    [
        ("um", {}, "row", "a map of 3 rows"),
        ("um", {"row": 3}, "row", "= 3"),
        ("um", {"row": 0, "unit_x": "mm"}, "unit_x", 'says "um" in what its instrument wrote'),
        ("um", {"row": 0, "channel": 1}, "channel", "= 1"),
        ("um", {"row": 0, "decimal": "."}, "decimal", "text files"),
        ("um", {"row": 0, "spacing": 1.0}, "spacing", "beside the lengths in the file"),
        (None, {"row": 0}, "unit_x", "does not state it"),
        ("ft", {"row": 0, **UNITS}, "unit_x", "'ft'"),
    ],
)
def test_what_is_not_clear_is_refused(unit, values, key, said, topography, tmp_path):
    path = written(tmp_path, topography.Topography(MAP, (4.0, 3.0), **({} if unit is None else {"unit": unit})), "nc")
    with pytest.raises(ScanFileError) as caught:
        read_scan(path, values)
    assert caught.value.mistakes[0].path == f"profile.{key}"
    assert said in caught.value.mistakes[0].found


def test_file_of_no_known_format_is_told(topography, tmp_path):
    (tmp_path / "scan.bin").write_bytes(b"\x00\x01\x02" * 100)
    with pytest.raises(ScanFileError, match="cannot be read by SurfaceTopography"):
        read_scan(tmp_path / "scan.bin", UNITS)


def test_library_that_is_not_installed_is_named_with_the_remedy(tmp_path):
    (tmp_path / "scan.opd").write_bytes(b"\x00\x01\x02" * 100)
    code = "import sys; sys.modules['SurfaceTopography'] = None\n"
    code += "from pathlib import Path; from bem.scans.read_scan import read_scan; read_scan(Path('scan.opd'), {})"
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert 'python -m pip install "linecontact[instruments]"' in run.stderr


def test_one_of_several_channels_has_to_be_named(topography, tmp_path):
    path = tmp_path / "scan.mat"
    scipy.io.savemat(path, {"trace": MAP, "retrace": MAP + 1})
    with pytest.raises(ScanFileError, match=r"2 channels of heights; allowed: one of 0 \(trace\), 1 \(retrace\)"):
        read_scan(path, UNITS)
    scan = read_scan(path, {"channel": 1, "row": 2, "spacing": 0.5, **UNITS})
    np.testing.assert_allclose(scan.h, (MAP[:, 2] + 1) * 1e-6, rtol=1e-12)
    assert scan.facts["channel"] == "retrace"


@pytest.mark.parametrize("ending", ["npy", "mat"])
@pytest.mark.parametrize("row", [1, "mean", None])
@pytest.mark.parametrize("along", [0, 1])
def test_arrays_without_lengths_take_the_spacing(ending, row, along, topography, tmp_path):
    """The first index runs along x, as in SurfaceTopography; an array with one sample along an index is a line."""
    heights = MAP if row is not None else np.expand_dims(MAP[:, 0], 1 - along)
    if ending == "mat":
        scipy.io.savemat(tmp_path / "scan.mat", {"h": heights})
    else:
        np.save(tmp_path / "scan.npy", heights)
    values = dict(UNITS) if row is None else {"row": row, **UNITS}
    with pytest.raises(ScanFileError, match="spacing is missing: the file has heights alone"):
        read_scan(tmp_path / f"scan.{ending}", values)
    with pytest.raises(ScanFileError) as caught:
        read_scan(tmp_path / f"scan.{ending}", {} if row is None else {"row": row})
    assert [refusal.path for refusal in caught.value.mistakes] == [
        f"profile.{key}" for key in ("spacing", "unit_x", "unit_h")
    ]
    scan = read_scan(tmp_path / f"scan.{ending}", {"spacing": 0.5, "missing_value": MAP[3, 0], **values})
    expected = np.where(heights == MAP[3, 0], np.nan, heights).squeeze()
    expected = {1: expected[..., -2], "mean": np.mean(expected, axis=-1), None: expected}[row] if row else expected
    np.testing.assert_allclose(scan.h, expected * 1e-6, rtol=1e-12)
    np.testing.assert_allclose(scan.x, 0.5e-6 * np.arange(8), rtol=1e-12)
    with pytest.raises(ScanFileError, match="unit_h is missing"):
        read_scan(
            tmp_path / f"scan.{ending}", {"spacing": 0.5, "unit_x": "um", **({} if row is None else {"row": row})}
        )


def square_of_noise(folder, name):
    (folder / name).write_bytes(RNG.integers(0, 256, 2 * 24 * 24, dtype=np.uint8).tobytes())
    return folder / name


def test_format_without_a_signature_is_read_by_its_extension_alone(topography, tmp_path):
    values = {"row": 0, "spacing": 0.5, **UNITS}
    assert read_scan(square_of_noise(tmp_path, "N46E008.hgt"), values).h.size == 24
    with pytest.raises(ScanFileError, match="of no format that its bytes tell"):
        read_scan(square_of_noise(tmp_path, "rnd.dat"), values)


def test_complex_array_is_refused(topography, tmp_path):
    scipy.io.savemat(tmp_path / "scan.mat", {"h": MAP + 1j})
    with pytest.raises(ScanFileError, match="Casting complex values to real"):
        read_scan(tmp_path / "scan.mat", {"row": 0, "spacing": 0.5, **UNITS})
