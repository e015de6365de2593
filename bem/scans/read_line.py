"""One measured line out of the columns of a text file: the columns or the row that the scene names.

columns   Positions and heights, `columns` = [x, h], or heights alone, [h], at a given `spacing`; more columns need
          `columns`.  Heights flagged 0 in `valid_column`, and heights equal to `missing_value`, are missing (NaN).  A
          column that is not read may be a flag if it holds few whole numbers: then the scene has to state
          `valid_column`, 0 where no column is a flag.
points    Columns x, y and h, one scan line after another: `row` names one, or the mean of all.
map       A row of heights on each line of the file, at a given `spacing`: `row` names one, or the mean of all.  A first
          line or column of axes is refused: numbers in order where those of the next two lines or columns are not.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.scans.read_text import FEWEST, TextTable
from bem.scans.scan_refusal import refused

MOST_FLAGS = 16  # format: different whole numbers in a column that may be a flag
FEWEST_STEPPED, FEWEST_ORDERED = 4, 8  # format: numbers on an axis, at equal steps or in order; by chance, 1 in 20,000
EQUAL = 0.01  # format: admitted deviation of a step of an axis, in steps

ScanLines = tuple[int, list[slice]]  # of points x y h: the column along the scan lines, from 0, and the rows of each


class TableLine(NamedTuple):
    """Positions, None where `spacing` gives them, and heights of a line, in units of the file."""

    x: FloatArray | None  # (n,)
    h: FloatArray  # (n,); NaN where missing
    lines: IntArray | None = None  # line of the file of each sample, (n,)
    columns: tuple[int | None, int] | None = None  # of positions and heights, from 0; None of a map
    rows: slice = slice(None)  # of the table
    unread: tuple[int, ...] = ()  # columns, from 1


def line_of(table: TextTable, values: Mapping[str, Any]) -> TableLine:
    """Return the line that `values`, the keys of [profile], name; ScanFileError where they do not fit the columns."""
    width, flag, row = table.values.shape[1], values.get("valid_column", 0), values.get("row")
    if flag > width:
        raise refused("valid_column", f"= {flag}", f"0 for none, or a column from 1 to {width}")
    points = None if flag in (1, 2) else scan_lines(table.values)
    if points is None and row is not None:
        return TableLine(None, row_of(without_missing(_map(table, values), values), row))
    x_column, h_column = _columns(width, points, values)
    read = {x_column, h_column, flag - 1} | (set() if points is None else {0, 1})
    unread = tuple(column + 1 for column in range(width) if column not in read)
    if "valid_column" not in values:
        _refuse_flags(table, unread)
    heights, rows = without_missing(table.values[:, h_column], values), slice(None)
    if flag:
        heights = _flagged(heights, table.values[:, flag - 1], flag)
    if points is not None:
        rows, heights = _scan_line(table, points, heights, values["row"])
    elif x_column is None and heights[0] == heights.size - 1:
        found = f"line {table.lines[0]} holds {heights[0]:g}, the number of heights that follow"
        raise refused("file", found, f"heights alone: skip_lines = {table.lines[0]}")
    lines = table.lines[rows]
    x = None if x_column is None else table.values[rows, x_column]
    if x is not None and np.isnan(x).any():
        found = f"line {lines[int(np.argmax(np.isnan(x)))]} has no position"
        raise refused("file", found, "a position in every line: only heights may be missing")
    return TableLine(x, heights, None if row == "mean" else lines, (x_column, h_column), rows, unread)


def _columns(width: int, points: ScanLines | None, values: Mapping[str, Any]) -> tuple[int | None, int]:
    """Return the columns of positions, None where there are none, and of heights, from 0."""
    flag = values.get("valid_column", 0)
    rest = [column for column in range(1, width + 1) if column != flag]
    expected = [1, 2] if points is None else [points[0] + 1, 3]
    if points is not None and "row" not in values:
        found = f"is needed: the file has {len(points[1])} scan lines of points x y h"
        raise refused("row", found, _rows_allowed(len(points[1])))
    used = list(values.get("columns", expected if points is not None and len(rest) == 3 else rest))
    if len(used) > 2:
        allowed = f"columns = {expected} for x and h in these columns; valid_column = {width} for a column whose 0 "
        allowed += 'flags a missing height; row = 0, 1, .. or "mean" for a map of heights'
        raise refused("columns", f"is needed: the file has {width} columns", allowed)
    if max(used) > width or flag in used:
        raise refused("columns", f"= {used}", f"columns of the file, 1 to {width}, other than valid_column")
    if points is not None and (len(used) != 2 or used[0] != expected[0] or used[1] < 3):
        raise refused("columns", f"= {used} of points x y h", f"columns = {expected}: along the lines, and heights")
    if len(used) == 2 and "spacing" in values:
        heights = f"; columns = [{used[1]}] for heights without" if points is None else ""
        allowed = f"leave it out where the file has positions{heights}"
        raise refused("spacing", f"= {values['spacing']:g} beside positions", allowed)
    return (None, used[0] - 1) if len(used) == 1 else (used[0] - 1, used[1] - 1)


def without_missing(heights: FloatArray, values: Mapping[str, Any]) -> FloatArray:
    """Return heights, NaN where they are the missing_value of the scene."""
    return np.where(heights == values["missing_value"], np.nan, heights) if "missing_value" in values else heights


def _flagged(heights: FloatArray, flags: FloatArray, column: int) -> FloatArray:
    """Return heights, NaN where they are flagged 0; ScanFileError for flags that are not 0 and one other number."""
    kinds = np.unique(flags)
    if np.isnan(kinds).any() or (kinds != 0).sum() > 1:
        raise refused("valid_column", f"= {column}: the column holds {_listed(kinds)}", "0 and one other number")
    return np.where(flags == 0, np.nan, heights)


def _refuse_flags(table: TextTable, unread: tuple[int, ...]) -> None:
    """Raise ScanFileError for a column that is not read and may say which heights are valid."""
    for column in unread:
        kinds = np.unique(table.values[:, column - 1])
        if 2 <= kinds.size <= MOST_FLAGS and (kinds == np.round(kinds)).all():
            found = f"is needed: column {column} holds {_listed(kinds)} and may say which heights are valid"
            allowed = f"valid_column = {column}: heights flagged 0 are missing; valid_column = 0 if no column says so"
            raise refused("valid_column", found, allowed)


def _listed(numbers: FloatArray) -> str:
    return ", ".join(f"{number:g}" for number in numbers[:4]) + ", .." * (numbers.size > 4)


def scan_lines(table: FloatArray) -> ScanLines | None:
    """Return the scan lines of points x y h; None for other tables.

    Of the first two columns one is constant along a line, and the other rises or falls.

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


def _scan_line(table: TextTable, points: ScanLines, heights: FloatArray, row: int | str) -> tuple[slice, FloatArray]:
    """Return the rows and heights of a scan line of points x y h; for the mean, rows of the first line."""
    along, lines = points
    if isinstance(row, int):
        rows = lines[_checked_row(row, len(lines))]
        return rows, heights[rows]
    first = table.values[lines[0], along]
    if any(not np.array_equal(table.values[line, along], first) for line in lines):
        allowed = f"row = 0 to {len(lines) - 1} in the order of the file"
        raise refused("row", '= "mean" of scan lines with different positions', allowed)
    return lines[0], np.asarray(np.mean([heights[line] for line in lines], axis=0))


def row_of(heights: FloatArray, row: int | str) -> FloatArray:
    """Return a row of a map, (n_rows, n), or the mean of all rows; NaN where any of them is missing."""
    return np.asarray(heights.mean(axis=0) if isinstance(row, str) else heights[_checked_row(row, heights.shape[0])])


def _checked_row(row: int, count: int) -> int:
    """Return the row if there is one of this number; else raise ScanFileError."""
    if row >= count:
        raise refused("row", f"= {row}", _rows_allowed(count))
    return row


def _rows_allowed(count: int) -> str:
    return f'row = 0 to {count - 1} in the order of the file, or row = "mean"'


def _map(table: TextTable, values: Mapping[str, Any]) -> FloatArray:
    """Return the numbers of a map; ScanFileError for keys and headings of columns, and for axes."""
    width = table.values.shape[1]
    if width <= 2:
        found = f"= {values['row']!r} of a file with {width} columns"
        raise refused("row", found, "leave it out: only a map has rows, one on each line of the file")
    for key in ("columns", "valid_column"):
        if key in values:
            raise refused(key, f"= {values[key]!r} beside row", "leave it out: the row of a map is all of a line")
    if table.heading:
        found = f"line {table.heading} states units of columns, which a map does not have"
        raise refused("file", found, f"skip_lines = {table.heading}, with unit_h and unit_x")
    axes = [f"the first line (line {table.lines[0]})"] * _has_axis(table.values)
    axes += ["the first column"] * _has_axis(table.values.T)
    if axes:
        named = " and ".join(axes)
        allowed = f"heights alone: remove {named}, and give the step of the axis along the lines as spacing"
        raise refused("file", f"has axes in {named}, which are no heights", allowed)
    return table.values


def _has_axis(rows: FloatArray) -> bool:
    """Return whether the first row holds positions: in order where the next two rows are not."""
    return any(
        any(_ordered(row, stepped) for row in (rows[0], rows[0, 1:]))
        and not any(_ordered(row, stepped) for row in (*rows[1:3], *rows[1:3, 1:]))
        for stepped in (True, False)
    )


def _ordered(row: FloatArray, stepped: bool) -> bool:
    """Return whether numbers rise or fall, at equal steps or at any."""
    steps = np.diff(row)
    if row.size < (FEWEST_STEPPED if stepped else FEWEST_ORDERED) or not ((steps > 0).all() or (steps < 0).all()):
        return False
    return not stepped or float(np.abs(steps - steps.mean()).max()) <= EQUAL * abs(float(steps.mean()))
