"""Files of instruments, read by SurfaceTopography (extra `instruments`): Gwyddion, X3P, OPD, SUR, VK, SDF and others.

A file is one of these if it is no text (scan_bytes.py), or begins as the text formats do that hold numbers in units of
their own.  The library is given the path: some formats are known by their name only.  Points are taken as the centres
of pixels, n of them to the length that the file states, as that library does.  The formats: https://contactengineering.github.io/SurfaceTopography/.
"""

from __future__ import annotations

import warnings
from contextlib import ExitStack, closing
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.scan_bytes import text_of
from bem.scans.scan_refusal import Refusal, ScanFileError
from bem.scans.scan_units import unit_of
from bem.scans.scan_words import label, words_of

LIBRARY = "SurfaceTopography"
RASTER_TEXT = (  # SDF (ISO 25178-71), BCR-STM, Wyko
    *(b"aISO-", b"bISO-", b"aBCR-", b"bBCR-", b"fileformat = bcr", b"Wyko ASCII Data File"),
)
TEXT_FORMATS = ("xyz", "asc")  # as the library reads them; what is text to it and not here has lost lines
UNREAD_TEXT = {  # text formats of integers whose factor stands in a header that nobody reads here
    b"Zygo ASCII Data File": "Zygo ASCII",
    b"'ISO 5436": "SMD (ISO 5436-2)",
    b"(ISO 5436": "SMD (ISO 5436-2)",
    b"ISO 5436": "SMD (ISO 5436-2)",
}
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
    >>> is_instrument_file(b"GWYP\\x00\\x01"), is_instrument_file(b"0 1\\n"), is_instrument_file("0 1".encode("utf-16"))
    (True, False, False)
    """
    for first, name in UNREAD_TEXT.items():
        if content.lstrip().startswith(first):
            found = f"is {name}, whose heights are multiples of a factor in its header"
            raise ScanFileError([Refusal("file", found, "heights in a unit of length: export them so")])
    return content.startswith(RASTER_TEXT) or text_of(content) is None


def read_instrument(path: Path, content: bytes, channel: int | None) -> InstrumentScan:
    """Read a channel of heights, counted from 0 among these, from a file and its bytes.

    ScanFileError where the library is not installed, knows no such format, or finds no channel of heights, or more than
    one and none is given.
    """
    try:
        library = import_module(LIBRARY)
    except ImportError as error:
        what = _no_text(content) if text_of(content) is None else "is the file of an instrument"
        refusal = Refusal("file", f"{what}, and {LIBRARY} is not installed", f"text, or {NEEDED}")
        raise ScanFileError([refusal]) from error
    with warnings.catch_warnings(), ExitStack() as opened:
        warnings.simplefilter("ignore")
        try:
            reader = opened.enter_context(closing(library.open_topography(str(path))))
            if reader.format() in TEXT_FORMATS and not content.startswith(RASTER_TEXT):
                raise ScanFileError([Refusal("file", _no_text(content), "text, without the zero byte")])
            channels = [each for each in reader.channels if each.is_height_channel is not False]
            channels = [
                each for each in channels if not words_of(str(each.name)) & label("no_heights")
            ]  # some state no unit
            chosen = _chosen(channels, channel)
            surface = chosen.topography()
            heights: FloatArray = np.ma.filled(np.ma.asarray(surface.heights(), dtype=float), np.nan)
        except ScanFileError:
            raise
        except Exception as error:  # of each of its readers in its own way
            allowed = f"text, or a format that {LIBRARY} reads"
            found = f"cannot be read by {LIBRARY}: {_reason(error)}"
            found += "" if content.startswith(RASTER_TEXT) else f"; {_no_text(content)}"
            raise ScanFileError([Refusal("file", found, allowed)]) from error
    facts = {"format": reader.format(), "channel": str(chosen.name), "points": list(heights.shape)}
    word = chosen.unit
    unit = None if word is None else (unit_of(str(word)) or str(word))
    if heights.ndim == 1:
        placed = not surface.is_uniform or chosen.physical_sizes is not None
        return InstrumentScan(np.asarray(surface.positions()) if placed else None, heights, unit, facts)
    length = chosen.physical_sizes
    x = None if length is None else np.arange(heights.shape[0]) * (float(length[0]) / heights.shape[0])
    return InstrumentScan(x, heights.T, unit, facts)


def _no_text(content: bytes) -> str:
    """Why the bytes of a file are no text."""
    before, zero, _ = content.partition(b"\x00")
    line = before.count(b"\n") + 1
    return f"is no text: a zero byte in line {line}" if zero else "is no text"


def _reason(error: Exception) -> str:
    """In one line what the library says; it lists all readers where none knows the file."""
    text = " ".join(str(error).split())
    return "of none of its formats" if text.startswith("tried ") else text[:80] or type(error).__name__


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
