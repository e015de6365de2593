"""Files of instruments, read by SurfaceTopography (extra `instruments`): Gwyddion, X3P, OPD, SUR, VK, SDF and others.

A file is one of these if it is no text (it holds a zero byte, and no mark of UTF-16), or SDF, which is text with
raster data.  Points are taken as the centres of pixels, n of them to the length that the file states, as that library
does.  The formats: https://contactengineering.github.io/SurfaceTopography/.
"""

from __future__ import annotations

import codecs
import io
import warnings
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.scan_text import Refusal, ScanFileError
from bem.scans.scan_units import unit_of

LIBRARY = "SurfaceTopography"
RASTER_TEXT = (b"aISO-", b"aBCR-")  # SDF, ISO 25178-71
NEEDED = 'python -m pip install "linecontact[instruments]"'


@dataclass(frozen=True, eq=False)
class InstrumentScan:
    """A line scan or a map."""

    x: FloatArray | None  # positions in units of the file, (n,); None where it states no length
    heights: FloatArray  # in units of the file, (n,) or (n_rows, n); NaN where missing
    unit: str | None  # that the file states, of positions and heights alike
    facts: dict[str, Any]  # how it was read: plain values


def is_instrument_file(content: bytes) -> bool:
    """Whether the bytes of a file are not a table in text.

    Examples
    --------
    >>> is_instrument_file(b"GWYP\\x00"), is_instrument_file(b"0 1\\n"), is_instrument_file("0 1".encode("utf-16"))
    (True, False, False)
    """
    if content.startswith(RASTER_TEXT):
        return True
    return b"\x00" in content and not content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))


def read_instrument(content: bytes, channel: int | None) -> InstrumentScan:
    """Read a channel of heights, counted from 0 among these, from the bytes of a file.

    ScanFileError where the library is not installed, knows no such format, or finds no channel of heights, or more than
    one and none is given.
    """
    try:
        library = import_module(LIBRARY)
    except ImportError as error:
        refusal = Refusal("file", f"is no text, and {LIBRARY} is not installed", f"text, or {NEEDED}")
        raise ScanFileError([refusal]) from error
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            reader = library.open_topography(io.BytesIO(content))
            channels = [each for each in reader.channels if each.is_height_channel is not False]
            chosen = _chosen(channels, channel)
            surface = chosen.topography()
            heights: FloatArray = np.ma.filled(np.ma.asarray(surface.heights(), dtype=float), np.nan)
        except ScanFileError:
            raise
        except Exception as error:  # of each of its readers in its own way
            first = str(error).strip().partition("\n")[0][:80]
            allowed = f"text, or a format that {LIBRARY} reads"
            raise ScanFileError([Refusal("file", f"cannot be read by {LIBRARY}: {first}", allowed)]) from error
    facts = {"format": reader.format(), "channel": str(chosen.name), "points": list(heights.shape)}
    word = chosen.unit
    unit = None if word is None else (unit_of(str(word)) or str(word))
    if heights.ndim == 1:
        placed = not surface.is_uniform or chosen.physical_sizes is not None
        return InstrumentScan(np.asarray(surface.positions()) if placed else None, heights, unit, facts)
    length = chosen.physical_sizes
    x = None if length is None else np.arange(heights.shape[0]) * (float(length[0]) / heights.shape[0])
    return InstrumentScan(x, heights.T, unit, facts)


def _chosen(channels: list[Any], channel: int | None) -> Any:
    """The channel asked for, or the only one."""
    names = ", ".join(f"{k} ({each.name})" for k, each in enumerate(channels))
    if not channels:
        raise ScanFileError([Refusal("file", "has no channel of heights", "one that has")])
    if channel is None and len(channels) > 1:
        raise ScanFileError([Refusal("channel", f"is needed: {len(channels)} channels of heights", f"one of {names}")])
    if channel is not None and channel >= len(channels):
        raise ScanFileError([Refusal("channel", f"= {channel}", f"one of {names}")])
    return channels[channel or 0]
