"""Measured line out of the columns of a text file.

Positions and heights are `columns` = [x, h], or heights alone, [h], at a given `spacing`; a file of more columns needs
`columns`, unless `row` names a row of a map (read_map.py).  Heights flagged 0 in `valid_column`, and heights equal to
`missing_value`, are missing (NaN).  A column that is not read may be a flag if it holds few whole numbers: then the
scene has to state `valid_column`, 0 where no column is a flag.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.scans.read_map import (
    ScanLines,
    map_of,
    refuse_axes,
    row_of,
    rows_allowed,
    scan_line,
    scan_lines,
    without_missing,
)
from bem.scans.read_text import TextTable
from bem.scans.scan_refusal import refused

MOST_FLAGS = 101  # format: different whole numbers in a column that may be a flag: percentages have 101


class TableLine(NamedTuple):
    """Positions, None where `spacing` gives them, and heights of a line, in units of the file."""

    x: FloatArray | None  # (n,)
    h: FloatArray  # (n,); NaN where missing
    lines: IntArray | None = None  # line of the file of each sample, (n,)
    columns: tuple[int | None, int | None] = (None, None)  # of positions and heights, from 0
    rows: slice = slice(None)  # of the table
    unread: tuple[int, ...] = ()  # columns, from 1


def line_of(table: TextTable, values: Mapping[str, Any]) -> TableLine:
    """Return the line that `values`, the keys of [profile], name; ScanFileError where they do not fit the columns."""
    width, flag, row = table.values.shape[1], values.get("valid_column", 0), values.get("row")
    if flag > width or (flag and width == 1):
        raise refused("valid_column", f"= {flag} of {width}", "0 for none, or a column of the file besides the heights")
    points = None if flag in (1, 2) else scan_lines(table.values)
    if points is None and row is not None:
        return TableLine(None, row_of(map_of(table, values), row))
    x_column, h_column = _columns(width, points, values)
    read = {x_column, h_column, flag - 1} | (set() if points is None else {0, 1})
    unread = tuple(column + 1 for column in range(width) if column not in read)
    refuse_axes(table, ("first line", "last line"))
    if "valid_column" not in values:
        _refuse_flags(table, unread)
    heights, rows = without_missing(table.values[:, h_column], values), slice(None)
    if flag:
        heights = _flagged(heights, table.values[:, flag - 1], flag)
    if points is not None:
        rows, heights = scan_line(table, points, heights, values["row"])
    elif x_column is None and heights[0] == heights.size - 1:
        problem = f"line {table.lines[0]} holds {heights[0]:g}, the number of heights that follow"
        raise refused("file", problem, f"heights alone: skip_lines = {table.lines[0]}")
    lines = table.lines[rows]
    x = None if x_column is None else table.values[rows, x_column]
    if x is not None and np.isnan(x).any():
        problem = f"line {lines[int(np.argmax(np.isnan(x)))]} has no position"
        raise refused("file", problem, "a position in every line: only heights may be missing")
    return TableLine(x, heights, None if row == "mean" else lines, (x_column, h_column), rows, unread)


def _columns(width: int, points: ScanLines | None, values: Mapping[str, Any]) -> tuple[int | None, int]:
    """Return the columns of positions (None without positions) and of heights, counted from 0."""
    flag = values.get("valid_column", 0)
    rest = [column for column in range(1, width + 1) if column != flag]
    expected = [1, 2] if points is None else [points[0] + 1, 3]
    if points is not None and "row" not in values:
        problem = f"is needed: the file has {len(points[1])} scan lines of points x y h"
        raise refused("row", problem, rows_allowed(len(points[1])))
    used = list(values.get("columns", expected if points is not None and len(rest) == 3 else rest))
    if len(used) > 2:
        allowed = f"columns = {expected} for x and h in these columns; valid_column = {width} for a column whose 0 "
        allowed += 'flags a missing height; row = 0, 1, .. or "mean" for a map of heights'
        raise refused("columns", f"is needed: the file has {width} columns", allowed)
    if max(used) > width or flag in used or len(set(used)) < len(used):
        raise refused("columns", f"= {used}", f"columns of the file, 1 to {width}, each once, other than valid_column")
    if points is not None and (len(used) != 2 or used[0] != expected[0] or used[1] < 3):
        raise refused("columns", f"= {used} of points x y h", f"columns = {expected}: along the lines, and heights")
    if len(used) == 2 and "spacing" in values:
        heights = f"; columns = [{used[0]}] or [{used[1]}] for heights alone" if points is None else ""
        allowed = f"leave it out where the file has positions{heights}"
        raise refused("spacing", f"= {values['spacing']:g} beside positions", allowed)
    return (None, used[0] - 1) if len(used) == 1 else (used[0] - 1, used[1] - 1)


def _flagged(heights: FloatArray, flags: FloatArray, column: int) -> FloatArray:
    """Return heights, NaN where they are flagged 0; ScanFileError for flags that are not 0 and one other number."""
    kinds = np.unique(flags)
    if np.isnan(kinds).any() or (kinds != 0).sum() > 1:
        raise refused("valid_column", f"= {column}: the column holds {_listed(kinds)}", "0 and one other number")
    return np.where(flags == 0, np.nan, heights)


def _refuse_flags(table: TextTable, unread: tuple[int, ...]) -> None:
    """Raise ScanFileError for a column that is not read and may say which heights are valid."""
    for column in unread:
        kinds = np.unique(table.values[:, column - 1])  # NaN, the last, where there is no number
        if (
            2 <= kinds.size <= min(MOST_FLAGS, table.lines.size // 2)
            and (np.isnan(kinds) | (kinds == np.round(kinds))).all()
        ):
            problem = f"is needed: column {column} holds {_listed(kinds)} and may say which heights are valid"
            allowed = f"valid_column = {column}: heights flagged 0 are missing; valid_column = 0 if no column says so"
            raise refused("valid_column", problem, allowed)


def _listed(numbers: FloatArray) -> str:
    return ", ".join(f"{number:g}" for number in numbers[:4]) + ", .." * (numbers.size > 4)
