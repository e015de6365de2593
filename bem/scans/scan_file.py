"""Measured lines: positions and heights in m out of a text file or an instrument's own, with how they were read.

Text (scan_text.py) has columns x and h, or one column of heights at a given `spacing`, or is an areal map, a row a
line, of which `row` names one or the mean of all.  Every other file is read by SurfaceTopography
(instrument_file.py).  Units (scan_units.py) come from the file or the scene, and nowhere else.  Missing heights are
NaN; what is done about them, and all else that changes a height, is up to scan_preparation.py.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bem.geometry.arrays import FloatArray
from bem.scans.instrument_file import InstrumentScan, is_instrument_file, read_instrument
from bem.scans.scan_keys import METRES
from bem.scans.scan_text import DELIMITERS, Refusal, ScanFileError, TextTable, read_table
from bem.scans.scan_units import Statement, resolved, statements


@dataclass(frozen=True, eq=False)
class RawScan:
    """A line as measured."""

    x: FloatArray  # positions, m, (n,)
    h: FloatArray  # heights, m, (n,); NaN where missing
    lines: NDArray[np.int64] | None  # line of the file of each sample, (n,); None where there are no lines
    facts: dict[str, Any]  # how it was read: plain values
    sha256: str  # of the file's bytes

    def place(self, sample: int) -> str:
        """Where a sample (from 0) is to be found."""
        return f"sample {sample + 1}" if self.lines is None else f"line {self.lines[sample]}"


class _Columns(NamedTuple):
    """Positions, None where `spacing` gives them, and heights, in units of the file; which columns of it, from 0."""

    x: FloatArray | None
    h: FloatArray
    lines: NDArray[np.int64] | None
    used: tuple[int | None, int] | None


def read_scan(path: Path, values: Mapping[str, Any]) -> RawScan:
    """Read a scan.

    `values` are those of [profile]: unit_x, unit_h, decimal, spacing, columns, row, channel, as far as they are given.
    ScanFileError where the file cannot be read or holds no such scan, a unit is missing or contradicts the file, or a
    position is missing.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        reason = f"cannot be read: {error.strerror or error}"
        raise ScanFileError([Refusal("file", reason, "a text file, or one of an instrument")]) from error
    if is_instrument_file(content):
        raw = _from_instrument(read_instrument(content, values.get("channel")), values)
    else:
        raw = _from_text(read_table(content, values.get("decimal")), values)
    return replace(raw, sha256=hashlib.sha256(content).hexdigest())


def _from_text(table: TextTable, values: Mapping[str, Any]) -> RawScan:
    """A line of a text file."""
    if "channel" in values:
        raise ScanFileError([Refusal("channel", f"= {values['channel']} is for instrument files", "text has none")])
    columns = _map_row(table, values) if "row" in values else _line(table, values)
    stated = statements(table, columns.used)
    facts = {
        "format": "text",
        "encoding": table.encoding,
        "delimiter": DELIMITERS[table.reading.delimiter],
        "decimal": table.reading.decimal,
        "header_lines": table.header[-1][0] if table.header else 0,
        "columns": table.values.shape[1],
    }
    return _in_metres(columns, stated, facts, values)


def _line(table: TextTable, values: Mapping[str, Any]) -> _Columns:
    """Columns x and h, or h alone where a spacing is given."""
    width = table.values.shape[1]
    used = values.get("columns", [1, 2] if width == 2 else [1] if width == 1 else None)
    if used is None:
        allowed = 'columns = [1, 2] for x and h in columns 1 and 2; row = 0, 1, .. or "mean" for a map of heights'
        raise ScanFileError([Refusal("columns", f"is needed: the file has {width} columns", allowed)])
    if max(used) > width:
        raise ScanFileError([Refusal("columns", f"= {used}", f"numbers from 1 to {width}, the columns of the file")])
    heights = table.values[:, used[-1] - 1]
    if len(used) == 1:
        if "spacing" not in values:
            allowed = "the distance of two samples in unit_x: the file has heights alone"
            raise ScanFileError([Refusal("spacing", "is missing", allowed)])
        if heights[0] == heights.size - 1:
            found = f"line {table.lines[0]} holds {heights[0]:g}, the number of heights that follow"
            raise ScanFileError([Refusal("file", found, "heights alone: remove the line, or mark it by #")])
        return _Columns(None, heights, table.lines, (None, used[0] - 1))
    if "spacing" in values:
        allowed = "no spacing where the file has positions; columns = [k] where column k holds the heights"
        raise ScanFileError([Refusal("spacing", f"= {values['spacing']:g}", allowed)])
    x = table.values[:, used[0] - 1]
    if np.isnan(x).any():
        line = table.lines[int(np.argmax(np.isnan(x)))]
        allowed = "a position in every line: only heights may be missing"
        raise ScanFileError([Refusal("file", f"line {line} has no position", allowed)])
    return _Columns(x, heights, table.lines, (used[0] - 1, used[1] - 1))


def _map_row(table: TextTable, values: Mapping[str, Any]) -> _Columns:
    """One row of a map of heights, or the mean of all."""
    if table.values.shape[1] <= 2:
        found = f"= {values['row']!r} of a file with {table.values.shape[1]} columns"
        raise ScanFileError([Refusal("row", found, "a map of heights, one row a line; a line has no rows")])
    if "spacing" not in values:
        allowed = "the distance of two samples of a row in unit_x"
        raise ScanFileError([Refusal("spacing", "is missing", allowed)])
    return _Columns(None, _row_of(table.values, values["row"]), None, None)


def _row_of(heights: FloatArray, row: int | str) -> FloatArray:
    """A row of a map, (n_rows, n), or the mean of all rows; NaN where any of them is missing."""
    if isinstance(row, str):
        return np.asarray(heights.mean(axis=0))
    if row >= heights.shape[0]:
        allowed = f'an integer from 0 to {heights.shape[0] - 1}, or "mean"'
        raise ScanFileError([Refusal("row", f"= {row}", allowed)])
    return np.asarray(heights[row])


def _from_instrument(found: InstrumentScan, values: Mapping[str, Any]) -> RawScan:
    """A line of an instrument's file; `spacing` only where the file has no lengths."""
    for key in ("decimal", "columns"):
        if key in values:
            raise ScanFileError([Refusal(key, f"= {values[key]!r} is for text files", "leave it out")])
    heights, is_map = found.heights, found.heights.ndim == 2
    if is_map != ("row" in values):
        rows = heights.shape[0]
        what = f"is needed: the file holds a map of {rows} rows" if is_map else f"= {values['row']!r} of a line scan"
        raise ScanFileError([Refusal("row", what, f'0 to {rows - 1}, or "mean"' if is_map else "leave it out")])
    if (found.x is None) != ("spacing" in values):
        what = "is missing: the file has no lengths" if found.x is None else "is in the file"
        raise ScanFileError([Refusal("spacing", what, "a length in unit_x, or none where the file has it")])
    if is_map:
        heights = _row_of(heights, values["row"])
    stated = () if found.unit is None else tuple(Statement(axis, found.unit, 0, True) for axis in "xh")
    return _in_metres(_Columns(found.x, heights, None, None), stated, dict(found.facts), values)


def _in_metres(
    columns: _Columns, stated: tuple[Statement, ...], facts: dict[str, Any], values: Mapping[str, Any]
) -> RawScan:
    """Positions and heights in m by the units that the file states or the scene gives."""
    units, refusals = resolved(values, stated)
    if refusals:
        raise ScanFileError(refusals)
    x = columns.x if columns.x is not None else values["spacing"] * np.arange(columns.h.size)
    facts |= {"unit_x": units["x"], "unit_h": units["h"]}
    facts |= {f"unit_{axis}_from": "scene" if f"unit_{axis}" in values else "file" for axis in "xh"}
    facts |= {key: values[key] for key in ("row", "spacing", "columns") if key in values}
    return RawScan(x * METRES[units["x"]], columns.h * METRES[units["h"]], columns.lines, facts, "")
