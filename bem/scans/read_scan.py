"""Measured line out of a file: its kind of file decides who reads it, and the scene which of its numbers are meant."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bem.geometry.arrays import FloatArray
from bem.geometry.lengths import METRES
from bem.geometry.ranges import Mistake
from bem.scans.convert_units import line_in_metres
from bem.scans.mark_missing import without_missing
from bem.scans.measured_line import MeasuredLine
from bem.scans.pick_columns import columns_of, heights_of
from bem.scans.pick_row import ARRAY_LINES, MAP_LINES, TEXT_LINES, map_of, row_of
from bem.scans.read_bytes import content_of, text_of
from bem.scans.read_instrument import RASTER_TEXT, read_instrument
from bem.scans.read_npy import REAL, REAL_NUMBERS, SIGNATURE, read_npy, trace_or_rows
from bem.scans.read_table import read_table
from bem.scans.scan_file_error import ScanFileError, refused
from bem.scans.scan_keys import ARRAY_KEYS, SCAN_KEYS, TEXT_KEYS


def read_scan(path: Path, values: Mapping[str, Any]) -> MeasuredLine:
    """Return the measured line in a file.

    `values` are the keys of [profile] that say how the file is read (SCAN_KEYS), as far as they are given.
    ScanFileError where the file cannot be read or holds no such line, a unit is missing or contradicts the file, or a
    position is missing.
    """
    content = content_of(path)
    text = None if content.startswith((SIGNATURE, *RASTER_TEXT)) else text_of(content)
    if text is not None:
        line = _line_of_text(*text, values)
    elif content.startswith(SIGNATURE):
        heights = read_npy(content)
        line = _line_of_heights(heights, None, "", {"format": "npy", "points": list(heights.shape)}, values)
    else:
        line = _line_of_heights(*read_instrument(path, content, values.get("channel")), values)
    return _placed(replace(line, sha256=hashlib.sha256(content).hexdigest()))


def line_of_arrays(positions: ArrayLike | None, heights: ArrayLike, values: Mapping[str, Any]) -> MeasuredLine:
    """Return the measured line of arrays in m; heights are missing where masked, NaN or infinite.

    Heights are a trace, or a map like that of a `.npy` file: the first index runs along x.  `values` are the keys of
    [profile]: `spacing` in m where there are no positions, and the `row` of a map.  ScanFileError for keys that say how
    a file is read, for unlike arrays, and for a position that is missing.
    """
    _refuse_keys(values, [key for key in SCAN_KEYS if key not in ARRAY_KEYS], "is for files, arrays are in m")
    if positions is not None:
        _refuse_keys(values, ["spacing"], "beside x")
    given = without_missing(_real_array("h", heights), {})
    if given.ndim not in (1, 2):
        raise refused("h", f"of shape {given.shape}", "heights along one index (a trace) or two (a map)")
    lines = trace_or_rows(given)
    x = values["spacing"] * np.arange(lines.shape[-1]) if positions is None else _real_array("x", positions)
    if x.shape != lines.shape[-1:]:
        allowed = "an array of one index, with a position for each height along the first index of h"
        raise refused("x", f"of shape {x.shape} beside h of shape {given.shape}", allowed)
    facts = {"format": "arrays", "unit_x": "m", "unit_h": "m", "unit_x_from": "arrays", "unit_h_from": "arrays"}
    h, of_row = _trace_or_row(lines, ARRAY_LINES, values)
    facts |= of_row | {key: values[key] for key in ("row", "spacing") if key in values}
    return _placed(MeasuredLine(x, h, facts, hashlib.sha256(x.tobytes() + given.tobytes()).hexdigest()))


def _line_of_text(text: str, encoding: str, values: Mapping[str, Any]) -> MeasuredLine:
    """Return the row or the columns of a text file that the scene names."""
    _refuse_keys(values, ["channel"], "is for instrument files")
    table = read_table(text, values.get("skip_lines", 0), values.get("decimal"))
    facts = {"format": "text", "encoding": encoding} | table.facts
    if "row" in values:
        heights, of_row = row_of(map_of(table, values), values["row"], TEXT_LINES, table.lines)
        return line_in_metres(values, None, heights, {}, "", facts | of_row)
    x_column, h_column = columns_of(table, values)
    heights = heights_of(table, x_column, h_column, values)
    source = f"line {table.heading}"
    if x_column is None:
        line = line_in_metres(values, None, heights, {"h": table.units[h_column]}, source, facts)
        return replace(line, lines=table.lines)
    stated = {"x": table.units[x_column], "h": table.units[h_column]}
    line = line_in_metres(values, table.values[:, x_column], heights, stated, source, facts)
    metres = METRES[facts["unit_x"]]
    return replace(line, lines=table.lines, half_digits=lambda: metres * table.half_digits(x_column))


def _line_of_heights(
    heights: FloatArray, x: FloatArray | None, unit: str, facts: dict[str, Any], values: Mapping[str, Any]
) -> MeasuredLine:
    """Return a trace, (n,), or the row that the scene names of a map, (n_rows, n); x is None without lengths."""
    _refuse_keys(values, TEXT_KEYS, "is for text files")
    heights = without_missing(heights, values)
    heights, of_row = _trace_or_row(heights, ARRAY_LINES if x is None else MAP_LINES, values)
    if x is not None:
        _refuse_keys(values, ["spacing"], "beside the lengths in the file")
    stated = dict.fromkeys("h" if x is None else "xh", unit)
    return line_in_metres(values, x, heights, stated, "what its instrument wrote", facts | of_row)


def _trace_or_row(heights: FloatArray, lines: str, values: Mapping[str, Any]) -> tuple[FloatArray, dict[str, Any]]:
    """Return a trace, (n,), without facts, or the row that the scene names of a map, (n_rows, n), with its facts."""
    if heights.ndim == 2:
        return row_of(heights, values.get("row"), lines)
    _refuse_keys(values, ["row"], "of a line scan")
    return heights, {}


def _real_array(name: str, values: ArrayLike) -> FloatArray:
    """Return values given in Python, NaN where they are masked; ScanFileError for anything but real numbers."""
    try:
        array: np.ma.MaskedArray[tuple[int, ...], np.dtype[Any]] = np.ma.asarray(values)
    except ValueError as error:  # lists of unlike lengths
        raise refused(name, f"of {type(values).__name__}: {error}", REAL_NUMBERS) from error
    if array.dtype.kind not in REAL:
        raise refused(name, f"holds an array of type {array.dtype}", REAL_NUMBERS)
    return np.asarray(np.ma.filled(array.astype(np.float64), np.nan))


def _refuse_keys(values: Mapping[str, Any], keys: Iterable[str], why: str) -> None:
    """Raise ScanFileError for keys that a file of this sort does not use."""
    mistakes = [Mistake(f"profile.{key}", f"= {values[key]!r} {why}", "leave it out") for key in keys if key in values]
    if mistakes:
        raise ScanFileError(mistakes)


def _placed(line: MeasuredLine) -> MeasuredLine:
    """Return a line; raise ScanFileError if a position is missing or infinite."""
    lost = ~np.isfinite(line.x)
    if lost.any():
        problem = f"{line.place(int(np.argmax(lost)))} has no position"
        raise refused("file", problem, "a position of every height: only heights may be missing")
    return line
