"""Arrays of fields.npz: bytes of an npz file and back, with every name, shape and type checked.

Arrays are stored as they are: an archive that is compressed, or whose headers promise more than it holds, is refused
before anything is unpacked.
"""

from __future__ import annotations

import io
import math
import re
import zipfile
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

FIELDS = {  # name without the k of a state: what it runs along, and its unit
    **dict.fromkeys(("x", "displacement", "gap"), ("point_{k}", "m")),
    "pressure": ("point_{k}", "Pa"),
    "patch": ("point_{k}", "1"),
    **dict.fromkeys(("C_h", "C_u"), ("wavenumber", "m^3")),
    "C_sigma": ("wavenumber", "Pa^2 m"),
    "q": ("wavenumber", "rad/m"),
    "sigma": ("level_{k}", "Pa"),
    "P": ("level_{k}", "1/Pa"),
    "sigma_bounds": ("bound_{k}", "Pa"),
    "outside_contact": ("", "1"),
    "tail_coefficient": ("", "Pa^2"),
    **dict.fromkeys(("scan_x", "scan_h"), ("scan_point", "m")),
    **dict.fromkeys(("profile_x", "profile_h"), ("profile_point", "m")),
    "scan_wavelength": ("scan_band", "m"),
    "scan_density": ("scan_band", "m^3"),
    "profile_q": ("profile_line", "rad/m"),
    "profile_amplitude": ("profile_line", "m"),
    "profile_phase": ("profile_line", "1"),
}
GROUPS = (  # arrays that are stored together, those of a state each named with "_k"
    ("x", "displacement", "gap", "pressure", "patch"),
    ("C_u", "C_sigma"),
    ("sigma", "P", "sigma_bounds", "outside_contact", "tail_coefficient"),
    ("q", "C_h"),
    ("scan_x", "scan_h", "profile_x", "profile_h", "scan_wavelength", "scan_density"),
    ("profile_q", "profile_amplitude", "profile_phase"),
)
OF_STATES = GROUPS[:3]
WHOLE, MAYBE_NAN = ("patch",), ("pressure", "scan_h")  # outside contact; where a sample is missing
NUMBERS = "if"  # kinds of arrays that a result holds
LONGEST_NAME = 64  # format: characters of the name of an array


class CorruptArraysError(ValueError):
    """Error of arrays that cannot belong to a result."""


def packed(arrays: Mapping[str, NDArray[Any]]) -> bytes:
    """Return arrays as the bytes of an npz file, not compressed; no bytes without arrays."""
    if not arrays:
        return b""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()


def unpacked(raw: bytes) -> dict[str, NDArray[Any]]:
    """Return the arrays of an npz file, after checking what the archive and the headers of its arrays promise.

    Raises
    ------
    CorruptArraysError
        Not such an archive: which array, and why.
    """
    if not raw:
        return {}
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as archive:
            return {member.filename.removesuffix(".npy"): _array(archive, member) for member in archive.infolist()}
    except (ValueError, EOFError, zipfile.BadZipFile, NotImplementedError, RuntimeError) as error:
        raise CorruptArraysError(str(error)) from error


def check_arrays(arrays: Mapping[str, NDArray[Any]], stored: Iterable[int]) -> None:
    """Raise CorruptArraysError unless arrays belong to the states `stored` and have matching lengths."""
    states, sizes = {str(k) for k in stored}, dict[str, tuple[str, int]]()
    for name, values in arrays.items():
        stem, k = split(name)
        group: tuple[str, ...] = next((names for names in GROUPS if stem in names), ())
        if not group or (k not in states if group in OF_STATES else k):
            raise CorruptArraysError(f"{name} is no array of a state of this result")
        for other in [f"{other}_{k}" if k else other for other in group] + ["q"] * (stem == "C_u"):
            if other not in arrays:
                raise CorruptArraysError(f"holds {name} without {other}")
        dimension = FIELDS[stem][0].format(k=k)
        _check_values(name, stem, values)
        first, size = sizes.setdefault(dimension, (name, values.size))
        if dimension and values.size != size:
            raise CorruptArraysError(f"{name} has {values.size} values, {first} has {size}")
    for k in states - {split(name)[1] for name in arrays}:
        raise CorruptArraysError(f"holds no array of the stored state {k}")


def split(name: str) -> tuple[str, str]:
    """Return the stem of the name of an array, and the index of its state; no index without one.

    Examples
    --------
    >>> split("C_sigma_12"), split("C_h")
    (('C_sigma', '12'), ('C_h', ''))
    """
    match = re.fullmatch(r"(.+)_([0-9]+)", name)
    return (match[1], match[2]) if match else (name, "")


def _check_values(name: str, stem: str, values: NDArray[Any]) -> None:
    """Raise CorruptArraysError where an array is empty, or not of the type and dimension that it should be."""
    if values.dtype.kind != ("i" if stem in WHOLE else "f"):
        raise CorruptArraysError(f"{name} is of type {values.dtype}")
    if stem not in MAYBE_NAN and not np.all(np.isfinite(values)):
        raise CorruptArraysError(f"{name} has values that are not finite")
    if values.ndim != bool(FIELDS[stem][0]):
        raise CorruptArraysError(f"{name} has the shape {values.shape}")
    if values.size == 0:
        raise CorruptArraysError(f"{name} is empty")


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    """Return an array of an archive; ValueError where it is compressed, not named or not as large as it says."""
    name = member.filename.removesuffix(".npy")
    if name == member.filename or not name.isascii() or not name.isidentifier() or len(name) > LONGEST_NAME:
        raise ValueError(f"{member.filename[:LONGEST_NAME]!r} is no name of an array")
    if member.compress_type != zipfile.ZIP_STORED or member.file_size != member.compress_size:
        raise ValueError(f"{member.filename} is compressed")
    raw = archive.read(member)
    stream = io.BytesIO(raw)
    versions = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    version = np.lib.format.read_magic(stream)
    if version not in versions:
        raise ValueError(f"{member.filename} has a format of version {version}")
    shape, _, kind = versions[version](stream)
    if kind.kind not in NUMBERS or math.prod(shape) * kind.itemsize != len(raw) - stream.tell():
        raise ValueError(f"{member.filename}: its bytes are not numbers of shape {shape} and type {kind}")
    stream.seek(0)
    return np.asarray(np.lib.format.read_array(stream, allow_pickle=False))
