"""Files of instruments, read by SurfaceTopography (extra `instruments`): Gwyddion, X3P, OPD, SUR, VK, SDF and others.

Its answer is passed on: heights, missing points, lengths and unit, of the channels that it takes for heights.  A file
goes to it if it is no text, or begins as one of the text formats with units of their own (`RASTER_TEXT`).
The library is given the path, because some formats are known by their name only (`UNSIGNED`).  Points are the centres
of pixels, n of them to the length that the file states, and the first index of a map runs along x, as in that library.
The formats: https://contactengineering.github.io/SurfaceTopography/.
"""

from __future__ import annotations

import warnings
from contextlib import ExitStack, closing
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.convert_units import unit_of
from bem.scans.read_npy import trace_or_rows
from bem.scans.scan_file_error import ScanFileError, refused

LIBRARY = "SurfaceTopography"
RASTER_TEXT = (  # SDF (ISO 25178-71), BCR-STM, Wyko
    *(b"aISO-", b"bISO-", b"aBCR-", b"bBCR-", b"fileformat = bcr", b"Wyko ASCII Data File"),
)
TEXT_FORMATS = ("xyz", "asc")  # as the library reads them; a file that is text to it alone has lost lines
UNSIGNED = ("hgt",)  # any bytes that are a square of 16-bit integers: known by the extension alone
FORMATS = f"text, .npy, or a format that {LIBRARY} reads"
NEEDED = 'python -m pip install "linecontact[instruments]"'


Channel = tuple[FloatArray, FloatArray | None, str, dict[str, Any]]


def read_instrument(path: Path, content: bytes, channel: int | None) -> Channel:
    """Return heights, positions, unit and facts of a channel of heights; such channels count from 0.

    Heights are (n,) or (n_rows, n), NaN where missing.  Positions are (n,), None where the file states no length.  The
    unit is that of both, "" where the file states none.
    ScanFileError where the library is not installed, knows no such format, or finds no channel of heights, or more than
    one and none is given.
    """
    no_text = "" if content.startswith(RASTER_TEXT) else _no_text(content)
    try:
        library = import_module(LIBRARY)
    except ImportError as error:
        problem = f"{no_text or 'is the file of an instrument'}, and {LIBRARY} is not installed"
        raise refused("file", problem, f"text, or {NEEDED}") from error
    with warnings.catch_warnings(), ExitStack() as opened:
        warnings.simplefilter("ignore")
        warnings.simplefilter("error", np.exceptions.ComplexWarning)  # the library drops imaginary parts of .mat arrays
        try:
            reader = opened.enter_context(closing(library.open_topography(str(path))))
            if no_text and reader.format() in TEXT_FORMATS:
                raise refused("file", no_text, "text, without the zero byte")
            if reader.format() in UNSIGNED and path.suffix.lower() != f".{reader.format()}":
                raise refused("file", f"{no_text}, and of no format that its bytes tell", FORMATS)
            chosen = _chosen([item for item in reader.channels if item.is_height_channel is not False], channel)
            lengths = chosen.physical_sizes
            needed = lengths is None and chosen.is_uniform is not False  # any: positions then come from the scene
            surface = chosen.topography(**({"physical_sizes": tuple(map(float, chosen.nb_grid_pts))} if needed else {}))
            heights: FloatArray = np.ma.filled(np.ma.asarray(surface.heights(), dtype=float), np.nan)
        except ScanFileError:
            raise
        except Exception as error:  # each of its readers has errors of its own
            problem = f"cannot be read by {LIBRARY}: {_reason(error)}{'; ' * bool(no_text)}{no_text}"
            raise refused("file", problem, FORMATS) from error
    facts = {"format": reader.format(), "channel": str(chosen.name), "points": list(heights.shape)}
    facts |= {"missing_points": int(np.count_nonzero(~np.isfinite(heights)))}
    unit = "" if chosen.unit is None else unit_of(str(chosen.unit)) or "no unit"
    if heights.ndim == 2:
        x = None if lengths is None else np.arange(heights.shape[0]) * (float(lengths[0]) / heights.shape[0])
        return (trace_or_rows(heights) if x is None else heights.T), x, unit, facts
    placed = not surface.is_uniform or lengths is not None
    return heights, (np.asarray(surface.positions()) if placed else None), unit, facts


def _no_text(content: bytes) -> str:
    """Return why the bytes of a file are no text."""
    before, zero, _ = content.partition(b"\x00")
    line = before.count(b"\n") + 1
    return f"is no text: a zero byte in line {line}" if zero else "is no text"


def _reason(error: Exception) -> str:
    """Return the message of the library in one line; the library lists all readers if no reader knows the file."""
    text = " ".join(str(error).split())
    return "of none of its formats" if text.startswith("tried ") else text[:80] or type(error).__name__


def _chosen(channels: list[Any], channel: int | None) -> Any:
    """Return the channel asked for, or the only one."""
    names = ", ".join(f"{k} ({each.name})" for k, each in enumerate(channels))
    if not channels:
        raise refused("file", "has no channel of heights", "one that has")
    if channel is None and len(channels) > 1:
        raise refused("channel", f"is needed: {len(channels)} channels of heights", f"one of {names}")
    if channel is not None and channel >= len(channels):
        raise refused("channel", f"= {channel}", f"one of {names}")
    return channels[channel or 0]
