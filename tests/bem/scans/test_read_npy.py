"""Arrays: a `.npy` file is as long as its header says and holds real numbers, or is refused by name."""

import numpy as np
import pytest

from bem.scans.read_scan import read_scan
from bem.scans.scan_file_error import ScanFileError

VALUES = {"unit_x": "um", "unit_h": "um", "spacing": 0.5}
H = np.random.default_rng(2).normal(size=64)


def saved(folder, array, name="scan.npy", version=None):
    with (folder / name).open("wb") as file:
        np.lib.format.write_array(file, array, version)
    return folder / name


@pytest.mark.parametrize("kind", ["<f8", ">f8", "<f4", "<f2", ">i2", "u1"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_real_numbers_of_any_type_and_order_come_back(kind, order, tmp_path):
    heights = np.asarray(100 * np.abs(H).reshape(16, 4), order=order).astype(kind, order=order)
    scan = read_scan(saved(tmp_path, heights), {"row": 2, **VALUES})
    np.testing.assert_allclose(scan.h, heights[:, 2].astype(float) * 1e-6, rtol=1e-12)


def test_array_is_known_by_its_signature_whatever_its_name(tmp_path):
    path = saved(tmp_path, H, "scan.hgt", (2, 0))
    np.testing.assert_allclose(read_scan(path, VALUES).h, H * 1e-6, rtol=1e-12)


@pytest.mark.parametrize("change", [-512, -1, 1, 8])
def test_another_length_than_the_header_says_is_refused(change, tmp_path):
    path = saved(tmp_path, H)
    content = path.read_bytes() + bytes(8)
    path.write_bytes(content[: len(content) - 8 + change])
    with pytest.raises(ScanFileError, match=f"{512 + change} bytes of numbers, where its header says 512"):
        read_scan(path, VALUES)


@pytest.mark.parametrize(
    ("array", "problem"),
    [
        (H + 1j, "of type complex128"),
        (H > 0, "of type bool"),
        (np.array(list("abc")), "of type <U1"),
        (np.zeros(4, [("x", float), ("h", float)]), "of type .*'x'"),
        (np.zeros(0), r"of shape \(0,\)"),
        (np.zeros((2, 3, 4)), r"of shape \(2, 3, 4\)"),
        (np.array(1.0), r"of shape \(\)"),
    ],
)
def test_what_is_no_trace_and_no_map_of_real_numbers_is_refused(array, problem, tmp_path):
    with pytest.raises(ScanFileError, match=f"is a .npy file {problem}"):
        read_scan(saved(tmp_path, array), VALUES)


@pytest.mark.parametrize("content", [b"\x93NUMPY", b"\x93NUMPY\x07\x00", b"\x93NUMPY\x01\x00\x04\x00{'a'"])
def test_broken_header_is_refused(content, tmp_path):
    (tmp_path / "scan.npy").write_bytes(content)
    with pytest.raises(ScanFileError, match="header cannot be read"):
        read_scan(tmp_path / "scan.npy", VALUES)


def test_infinite_heights_of_a_file_are_missing(tmp_path):
    scan = read_scan(saved(tmp_path, np.where(np.arange(64) == 3, np.inf, H)), VALUES)
    assert np.flatnonzero(np.isnan(scan.h)).tolist() == [3]
