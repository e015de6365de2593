"""Measured lines: positions and heights in m out of a text file or an instrument's own, with how they were read.

Text (scan_text.py) has columns x and h, or one column of heights at a given `spacing`, or is an areal map, a row a
line, or points x y h of one scan line after the other; of these two `row` names one line or the mean of all.  Every
other file is read by SurfaceTopography (instrument_file.py).  Units and distances come from the file (scan_header.py)
or the scene, and nowhere else; where both say something it must be the same.  Missing heights are NaN; what is done
about them, and all else that changes a height, is up to scan_preparation.py.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.scans.instrument_file import InstrumentScan, is_instrument_file, read_instrument
from bem.scans.scan_bytes import content_of
from bem.scans.scan_distances import distance_of, refuse_other_distance, unlike_positions
from bem.scans.scan_header import Header, half_digit, header_of
from bem.scans.scan_keys import METRES
from bem.scans.scan_refusal import Refusal, ScanFileError
from bem.scans.scan_text import DELIMITERS, FEWEST, TextTable, read_table
from bem.scans.scan_units import Statement, resolved


@dataclass(frozen=True, eq=False)
class RawScan:
    """A line as measured."""

    x: FloatArray  # positions, m, (n,)
    h: FloatArray  # heights, m, (n,); NaN where missing
    lines: IntArray | None  # line of the file of each sample, (n,); None where there are no lines
    facts: dict[str, Any]  # how it was read: plain values
    sha256: str  # of the file's bytes
    half_digits: Callable[[], FloatArray] | None = None  # half a unit of the last digit of each position, m
    used: tuple[int, int] | None = None  # the columns of positions and heights, from 1

    def place(self, sample: int) -> str:
        """Where a sample (from 0) is to be found."""
        return f"sample {sample + 1}" if self.lines is None else f"line {self.lines[sample]}"

    def stretch(self, first: int, last: int) -> str:
        """Where samples from one to another are to be found."""
        if first == last:
            return self.place(first)
        what, ends = ("samples", (first + 1, last + 1)) if self.lines is None else ("lines", self.lines[[first, last]])
        return f"{what} {ends[0]} to {ends[1]}"


class _Columns(NamedTuple):
    """Positions, None where `spacing` gives them, and heights, in units of the file; which columns of it, from 0."""

    x: FloatArray | None
    h: FloatArray
    lines: IntArray | None
    used: tuple[int | None, int] | None
    half_digits: Callable[[], FloatArray] | None = None  # of positions, in units of the file


def read_scan(path: Path, values: Mapping[str, Any]) -> RawScan:
    """Read a scan.

    `values` are those of [profile]: unit_x, unit_h, decimal, spacing, columns, row, channel, as far as they are given.
    ScanFileError where the file cannot be read or holds no such scan, a unit is missing or contradicts the file, or a
    position is missing.
    """
    content = content_of(path)
    if is_instrument_file(content):
        raw = _from_instrument(read_instrument(path, content, values.get("channel")), values)
    else:
        raw = _from_text(read_table(content, values.get("decimal")), values)
    return replace(raw, sha256=hashlib.sha256(content).hexdigest())


def _from_text(table: TextTable, values: Mapping[str, Any]) -> RawScan:
    """A line of a text file."""
    if "channel" in values:
        raise ScanFileError(
            [Refusal("channel", f"= {values['channel']} is for instrument files", "leave it out: text has none")]
        )
    lines = scan_lines(table.values)
    if lines is not None:
        columns = _scan_line(table, lines, values)
    else:
        columns = _map_row(table, values) if "row" in values else _line(table, values)
    facts = {
        "format": "text",
        "encoding": table.encoding,
        "delimiter": DELIMITERS[table.reading.delimiter],
        "decimal": table.reading.decimal,
        "header_lines": table.header[-1][0] if table.header else 0,
        "columns": table.values.shape[1],
    }
    return _in_metres(columns, header_of(table, columns.used), facts, values)


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
        if heights[0] == heights.size - 1:
            found = f"line {table.lines[0]} holds {heights[0]:g}, the number of heights that follow"
            raise ScanFileError([Refusal("file", found, "heights alone: remove the line, or mark it by #")])
        return _Columns(None, heights, table.lines, (None, used[0] - 1))
    return _placed(table, slice(None), used[0] - 1, used[1] - 1, values)


def _placed(table: TextTable, rows: slice, x_column: int, h_column: int, values: Mapping[str, Any]) -> _Columns:
    """Positions and heights of some rows."""
    if "spacing" in values:
        allowed = f"leave it out where the file has positions; columns = [{h_column + 1}] for heights without"
        raise ScanFileError([Refusal("spacing", f"= {values['spacing']:g}", allowed)])
    x, lines = table.values[rows, x_column], table.lines[rows]
    if np.isnan(x).any():
        line = lines[int(np.argmax(np.isnan(x)))]
        allowed = "a position in every line: only heights may be missing"
        raise ScanFileError([Refusal("file", f"line {line} has no position", allowed)])

    def half_digits() -> FloatArray:
        return np.array([half_digit(text) for text in table.texts(x_column)[rows]])

    return _Columns(x, table.values[rows, h_column], lines, (x_column, h_column), half_digits)


def _map_row(table: TextTable, values: Mapping[str, Any]) -> _Columns:
    """One row of a map of heights, or the mean of all."""
    if table.values.shape[1] <= 2:
        found = f"= {values['row']!r} of a file with {table.values.shape[1]} columns"
        raise ScanFileError([Refusal("row", found, "leave it out: only a map has rows, one on each line of the file")])
    return _Columns(None, _row_of(table.values, values["row"]), None, None)


def scan_lines(table: FloatArray) -> tuple[int, list[slice]] | None:
    """Of points x y h, one scan line after the other: the column along the lines, from 0, and the rows of each line.

    None for other tables.  Of the first two columns one is constant along a line, and the other rises or falls.

    Examples
    --------
    >>> points = np.array([[0, 5, 7], [1, 5, 8], [2, 5, 9], [0, 6, 7], [1, 6, 7], [2, 6, 8.0]])
    >>> scan_lines(points)
    (0, [slice(0, 3, None), slice(3, 6, None)])
    """
    if table.shape[1] < 3:
        return None
    for along, across in ((0, 1), (1, 0)):
        starts = np.flatnonzero(np.diff(table[:, across], prepend=np.nan) != 0)
        ends = np.append(starts[1:], table.shape[0])
        if starts.size < 2 or np.min(ends - starts) < FEWEST or np.unique(table[starts, across]).size < starts.size:
            continue
        lines = [slice(int(start), int(end)) for start, end in zip(starts, ends, strict=True)]
        if all(len(set(np.sign(np.diff(table[line, along])))) == 1 for line in lines):
            return along, lines
    return None


def _scan_line(table: TextTable, found: tuple[int, list[slice]], values: Mapping[str, Any]) -> _Columns:
    """One scan line of points x y h, or the mean of all."""
    along, lines = found
    across = 1 - along
    allowed = f'row = 0 to {len(lines) - 1} in the order of the file, or row = "mean"'
    if "row" not in values:
        first, last = (table.values[lines[k].start, across] for k in (0, -1))
        said = f"is needed: the file has {len(lines)} scan lines, {'xy'[across]} = {first:g} to {last:g}"
        raise ScanFileError([Refusal("row", said, allowed)])
    used = values.get("columns", [along + 1, 3])
    if len(used) != 2 or used[0] != along + 1 or not 3 <= used[1] <= table.values.shape[1]:
        expected = f"columns = [{along + 1}, 3]: positions along the lines, and heights"
        raise ScanFileError([Refusal("columns", f"= {used} of points x y h", expected)])
    if "spacing" in values:
        told = f"= {values['spacing']:g} beside the positions of {len(lines)} scan lines x y h"
        raise ScanFileError([Refusal("spacing", told, "leave it out")])
    row = values["row"]
    if row != "mean" and row >= len(lines):
        raise ScanFileError([Refusal("row", f"= {row}", allowed)])
    one = _placed(table, lines[0 if row == "mean" else row], along, used[1] - 1, values)
    if row != "mean":
        return one
    positions, heights = ([table.values[line, column] for line in lines] for column in (along, used[1] - 1))
    if any(not np.array_equal(each, positions[0]) for each in positions):
        raise ScanFileError([Refusal("row", '= "mean" of scan lines with different positions', allowed.split(",")[0])])
    return one._replace(h=np.asarray(np.mean(heights, axis=0)), lines=None)


def _row_of(heights: FloatArray, row: int | str) -> FloatArray:
    """A row of a map, (n_rows, n), or the mean of all rows; NaN where any of them is missing."""
    if isinstance(row, str):
        return np.asarray(heights.mean(axis=0))
    if row >= heights.shape[0]:
        allowed = f'row = 0 to {heights.shape[0] - 1}, or row = "mean"'
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
    stated = [] if found.unit is None else [Statement(axis, found.unit, 0, True) for axis in "xh"]
    return _in_metres(_Columns(found.x, heights, None, None), Header(stated), dict(found.facts), values)


def _in_metres(columns: _Columns, header: Header, facts: dict[str, Any], values: Mapping[str, Any]) -> RawScan:
    """Positions and heights in m by what the file states or the scene gives."""
    stated = columns.x is None and "spacing" not in values
    units, refusals = resolved(values, header.units, "h" if stated else "xh")
    count = columns.h.size
    if stated:
        try:
            dx, length = distance_of(header.lengths, header.bare, count, columns.used is None)
        except ScanFileError as error:
            raise ScanFileError([*error.refusals, *refusals]) from None
    if refusals:
        raise ScanFileError(refusals)
    half_digits = None
    if stated:
        x = np.arange(count) * np.float64(dx)
        units = {"x": values.get("unit_x", length.unit)} | units
        facts |= {"spacing_from": str(length)}
    elif columns.x is None:
        refuse_other_distance(values["spacing"], units["x"], header.lengths, count)
        x = values["spacing"] * METRES[units["x"]] * np.arange(count)
    else:
        metres = METRES[units["x"]]
        x = columns.x * metres
        half_digits = None if columns.half_digits is None else partial(_scaled, columns.half_digits, metres)
        unlike = unlike_positions(x, units["x"], header.lengths)
        facts |= {"unlike_positions": unlike} if unlike else {}
    facts |= {"unit_x": units["x"], "unit_h": units["h"]}
    facts |= {f"unit_{axis}_from": "scene" if f"unit_{axis}" in values else "file" for axis in "xh"}
    facts |= {key: values[key] for key in ("row", "spacing", "columns") if key in values}
    used = None if columns.used is None or columns.used[0] is None else (columns.used[0] + 1, columns.used[1] + 1)
    return RawScan(x, columns.h * METRES[units["h"]], columns.lines, facts, "", half_digits, used)


def _scaled(digits: Callable[[], FloatArray], metres: float) -> FloatArray:
    return digits() * metres
