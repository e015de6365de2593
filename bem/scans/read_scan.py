"""Positions and heights of a measured line in m, out of a text file or an instrument's file.

Text is read by read_text.py, and read_columns.py takes a line out of it; `.npy` files are read by read_array.py, and
every other file by SurfaceTopography (read_instrument.py).  Units come from the scene or the file (read_units.py).
Missing heights are NaN; prepare_scan.py decides what is done about them, and about all else that changes a height.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.lengths import METRES
from bem.geometry.ranges import Mistake
from bem.scans.read_array import SIGNATURE, read_npy, real_array
from bem.scans.read_bytes import content_of, text_of
from bem.scans.read_columns import TableLine, line_of
from bem.scans.read_instrument import RASTER_TEXT, InstrumentScan, read_instrument
from bem.scans.read_map import ARRAY_LINES, MAP_LINES, row_of, rows_allowed, without_missing
from bem.scans.read_text import COMMENT, DELIMITERS, LINES_LISTED, read_table
from bem.scans.read_units import resolved_units
from bem.scans.scan_file_error import ScanFileError, refused
from bem.scans.scan_keys import SCAN_KEYS, TEXT_KEYS


@dataclass(frozen=True, eq=False)
class RawScan:
    """Line as measured."""

    x: FloatArray  # positions, m, (n,)
    h: FloatArray  # heights, m, (n,); NaN where missing
    lines: IntArray | None  # line of the file of each sample, (n,); None where there are no lines
    facts: dict[str, Any]  # how it was read: plain values
    sha256: str  # of the file's bytes
    half_digits: Callable[[], FloatArray] | None = None  # half a unit of the last digit of each position, m

    def place(self, sample: int) -> str:
        """Return the place of a sample (from 0) in the file."""
        return f"sample {sample + 1}" if self.lines is None else f"line {self.lines[sample]}"

    def stretch(self, first: int, last: int) -> str:
        """Return the place of samples `first` to `last` in the file."""
        if first == last:
            return self.place(first)
        what, ends = ("samples", (first + 1, last + 1)) if self.lines is None else ("lines", self.lines[[first, last]])
        return f"{what} {ends[0]} to {ends[1]}"


def read_scan(path: Path, values: Mapping[str, Any]) -> RawScan:
    """Return the measured line in a file.

    `values` are the keys of [profile] that say how the file is read (SCAN_KEYS), as far as they are given.
    ScanFileError where the file cannot be read or holds no such scan, a unit is missing or contradicts the file, or a
    position is missing.
    """
    content = content_of(path)
    decoded = None if content.startswith((SIGNATURE, *RASTER_TEXT)) else text_of(content)
    if decoded is not None:
        raw = _from_text(*decoded, values)
    elif content.startswith(SIGNATURE):
        heights = read_npy(content)
        raw = _from_rows(InstrumentScan(None, heights, "", {"format": "npy", "points": list(heights.shape)}), values)
    else:
        raw = _from_rows(read_instrument(path, content, values.get("channel")), values)
    return _placed(replace(raw, sha256=hashlib.sha256(content).hexdigest()))


def scan_of_arrays(positions: ArrayLike, heights: ArrayLike, values: Mapping[str, Any]) -> RawScan:
    """Return a measured line that is given as arrays in m; heights are missing where masked, NaN or infinite.

    `values` are the keys of [profile]; ScanFileError for keys that say how a file is read, for unlike arrays, and for a
    position that is missing.
    """
    _refuse_keys(values, SCAN_KEYS, "is for files, arrays are in m")
    x, h = real_array("x", positions), without_missing(real_array("h", heights), {})
    if x.ndim != 1 or x.shape != h.shape:
        raise refused("x", f"of shape {x.shape} beside h of shape {h.shape}", "two arrays of one dimension and length")
    facts = {"format": "arrays", "unit_x": "m", "unit_h": "m", "unit_x_from": "file", "unit_h_from": "file"}
    return _placed(RawScan(x, h, None, facts, hashlib.sha256(x.tobytes() + h.tobytes()).hexdigest()))


def _placed(raw: RawScan) -> RawScan:
    """Return a line; raise ScanFileError if a position is missing or infinite."""
    lost = ~np.isfinite(raw.x)
    if lost.any():
        problem = f"{raw.place(int(np.argmax(lost)))} has no position"
        raise refused("file", problem, "a position of every height: only heights may be missing")
    return raw


def _from_text(text: str, encoding: str, values: Mapping[str, Any]) -> RawScan:
    """Return a line of a text file."""
    _refuse_keys(values, ["channel"], "is for instrument files")
    table = read_table(text, values.get("skip_lines", 0), values.get("decimal"))
    line = line_of(table, values)
    facts: dict[str, Any] = {
        "format": "text",
        "encoding": encoding,
        "delimiter": DELIMITERS[table.reading.delimiter],
        "decimal": table.reading.decimal,
        "width": table.values.shape[1],
    }
    skip_lines = values.get("skip_lines", 0)
    over = [
        line for number, line in table.above if number <= skip_lines or (number < table.heading and line[0] in COMMENT)
    ]
    if over:
        facts["skipped"] = " | ".join(line[:40] for line in over[:LINES_LISTED])
    facts |= {} if line.map_rows is None else {"rows": line.map_rows}
    stated = {axis: table.units[column] for axis, column in zip("xh", line.columns, strict=True) if column is not None}
    raw = _in_metres(line, stated, f"line {table.heading}", facts, values)
    x_column, metres = line.columns[0], METRES[raw.facts["unit_x"]]
    if x_column is None:
        return raw

    def half_digits() -> FloatArray:
        return metres * np.array([_half_digit(table.reading.cells(row)[x_column]) for row in table.rows])

    return replace(raw, half_digits=half_digits)


def _half_digit(text: str) -> float:
    """Return half a unit of the last digit of a number as it is written.

    Examples
    --------
    >>> _half_digit("10.0"), _half_digit("1.50e3"), _half_digit("7")
    (0.05, 5.0, 0.5)
    """
    digits, _, power = text.lower().replace(",", ".").partition("e")
    return 0.5 * 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))


def _from_rows(scan: InstrumentScan, values: Mapping[str, Any]) -> RawScan:
    """Return a line of a trace or map; `spacing` is needed only where the file has no lengths."""
    _refuse_keys(values, TEXT_KEYS, "is for text files")
    heights, lines = without_missing(scan.heights, values), ARRAY_LINES if scan.x is None else MAP_LINES
    if heights.ndim == 1:
        _refuse_keys(values, ["row"], "of a line scan")
    elif "row" not in values:
        count = heights.shape[0]
        raise refused("row", f"is needed: the file holds a map of {count} rows", rows_allowed(count, lines))
    else:
        heights, scan.facts["rows"] = row_of(heights, values["row"], lines), heights.shape[0]
    if scan.x is not None:
        _refuse_keys(values, ["spacing"], "beside the lengths in the file")
    stated = dict.fromkeys("xh" if scan.x is not None else "h", scan.unit)
    return _in_metres(TableLine(scan.x, heights), stated, "what its instrument wrote", scan.facts, values)


def _refuse_keys(values: Mapping[str, Any], keys: Iterable[str], why: str) -> None:
    """Raise ScanFileError for keys that a file of this sort does not use."""
    mistakes = [Mistake(f"profile.{key}", f"= {values[key]!r} {why}", "leave it out") for key in keys if key in values]
    if mistakes:
        raise ScanFileError(mistakes)


def _in_metres(
    line: TableLine, stated: Mapping[str, str], source: str, facts: Mapping[str, Any], values: Mapping[str, Any]
) -> RawScan:
    """Return positions and heights in m, in the units that the source states or the scene gives."""
    missing = []
    if line.x is None and "spacing" not in values:
        problem = "is missing: the file has heights alone, without positions or lengths"
        missing = [Mistake("profile.spacing", problem, "spacing = the distance of two samples, in unit_x")]
    try:
        units = resolved_units(values, stated, source)
    except ScanFileError as error:
        raise ScanFileError([*missing, *error.mistakes]) from None
    if missing:
        raise ScanFileError(missing)
    metres = METRES[units["x"]]
    x = line.x * metres if line.x is not None else values["spacing"] * metres * np.arange(line.h.size)
    read = dict(facts) | {f"unit_{axis}": units[axis] for axis in "xh"}
    read |= {f"unit_{axis}_from": "scene" if f"unit_{axis}" in values else "file" for axis in "xh"}
    read |= {key: values[key] for key in (*TEXT_KEYS, "missing_value", "row", "spacing") if key in values}
    return RawScan(x, line.h * METRES[units["h"]], line.lines, read, "")
