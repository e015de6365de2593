"""Arrays of a result as the bytes of an npz file, and back.

Arrays are stored as they are: a compressed archive, which may unpack to any size, is refused, and nothing is unpickled.
"""

from __future__ import annotations

import base64
import io
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.geometry.ranges import shown


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
    """Return the arrays of an npz file; CorruptArraysError says why the bytes are none."""
    if not raw:
        return {}
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as archive:
            for member in archive.infolist():
                if member.compress_type != zipfile.ZIP_STORED or not member.filename.endswith(".npy"):
                    raise CorruptArraysError(f"{shown(member.filename)} is compressed or no array")
        with np.load(io.BytesIO(raw), allow_pickle=False) as stored:
            return {name: np.asarray(stored[name]) for name in stored.files}
    except CorruptArraysError:
        raise
    except Exception as error:  # whatever the parsers of zip and of NumPy's headers meet in foreign bytes
        raise CorruptArraysError(f"no arrays of numbers ({error})") from error


def encoded(arrays: Mapping[str, NDArray[Any]]) -> str:
    """Return arrays as the base64 text of an npz file."""
    return base64.b64encode(packed(arrays)).decode()


def decoded(text: Any) -> dict[str, NDArray[Any]]:
    """Return the arrays of the base64 text of an npz file; ValueError where the text is none."""
    if not isinstance(text, str):
        raise CorruptArraysError("no text of base64")
    return unpacked(base64.b64decode(text, validate=True))
