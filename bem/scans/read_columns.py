"""Measured line out of the columns of a text file.

Positions and heights are `columns` = [x, h], or heights alone, [h], at a given `spacing`; a file of more columns needs
`columns`, unless `row` names a row of a map (read_map.py).  Missing (NaN) are heights equal to `missing_value`, and
heights beside which `valid_column` holds another number than `valid_value`; without `valid_value`, heights beside 0, if
the column holds one other number.  A column that is not read may mark heights, unless it is constant or an axis: the
scene then states `valid_column`, 0 where no column marks heights.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.scans.read_map import (
    FEWEST_SAMPLES,
    TEXT_LINES,
    map_of,
    refuse_axes,
    refuse_numbers_above,
    row_of,
    without_missing,
)
from bem.scans.read_text import REMEDY, SHOWN, TextTable
from bem.scans.scan_file_error import refused


class TableLine(NamedTuple):
    """Positions, None where `spacing` gives them, and heights of a line, in units of the file."""

    x: FloatArray | None  # (n,)
    h: FloatArray  # (n,); NaN where missing
    lines: IntArray | None = None  # line of the file of each sample, (n,)
    columns: tuple[int | None, int | None] = (None, None)  # of positions and heights, from 0
    map_rows: int | None = None  # rows of the map that holds the line


def line_of(table: TextTable, values: Mapping[str, Any]) -> TableLine:
    """Return the line that `values`, the keys of [profile], name; ScanFileError where they do not fit the columns."""
    width, flag, row = table.values.shape[1], values.get("valid_column", 0), values.get("row")
    if flag > width or (flag and width == 1):
        raise refused("valid_column", f"= {flag} of {width}", "0 for none, or a column of the file besides the heights")
    if row is not None:
        heights = map_of(table, values)
        return TableLine(None, row_of(heights, row, TEXT_LINES), map_rows=heights.shape[0])
    if table.lines.size < FEWEST_SAMPLES:
        problem = f"holds {table.lines.size} sample{'s' * (table.lines.size != 1)}, one on each line"
        allowed = f"at least {FEWEST_SAMPLES} of them; if a line holds many heights, row = 0 and their spacing"
        raise refused("file", problem, allowed)
    x_column, h_column = _columns(table, values)
    refuse_axes(table, ("first line", "last line"))
    if "valid_column" not in values:
        _refuse_marks(table, [column for column in range(width) if column not in (x_column, h_column)])
    refuse_numbers_above(table, table.values[:, h_column], values)
    heights = without_missing(table.values[:, h_column], values)
    if flag:
        heights = _valid(heights, table.values[:, flag - 1], values)
    elif "valid_value" in values:
        raise refused("valid_value", f"= {values['valid_value']:g} without a valid_column", "both, or none of them")
    if x_column is None and heights[0] == heights.size - 1:
        problem = f"line {table.lines[0]} holds {heights[0]:g}, the number of heights that follow"
        raise refused("file", problem, f"heights alone: skip_lines = {table.lines[0]}")
    x = None if x_column is None else table.values[:, x_column]
    return TableLine(x, heights, table.lines, (x_column, h_column))


def _columns(table: TextTable, values: Mapping[str, Any]) -> tuple[int | None, int]:
    """Return the columns of positions (None without positions) and of heights, counted from 0."""
    width, flag = table.values.shape[1], values.get("valid_column", 0)
    used = list(values.get("columns", [column for column in range(1, width + 1) if column != flag]))
    if len(used) > 2:
        allowed = "columns = [1, 2] for x and h in these columns, [1, 3] for one scan line x y h; valid_column for a "
        allowed += f"column that marks missing heights; row = 0, 1, .. for one of {TEXT_LINES}, or row = "
        allowed += '"mean", where they are a map'
        problem = f"is needed: the file has {width} columns, in line {table.lines[0]} {table.rows[0][:40]!r}"
        raise refused("columns", problem, allowed)
    if max(used) > width or flag in used or len(set(used)) < len(used):
        raise refused("columns", f"= {used}", f"columns of the file, 1 to {width}, each once, other than valid_column")
    if len(used) == 2 and "spacing" in values:
        allowed = f"leave it out where the file has positions; columns = [{used[0]}] or [{used[1]}] for heights alone"
        raise refused("spacing", f"= {values['spacing']:g} beside positions", allowed)
    return (None, used[0] - 1) if len(used) == 1 else (used[0] - 1, used[1] - 1)


def _valid(heights: FloatArray, marks: FloatArray, values: Mapping[str, Any]) -> FloatArray:
    """Return heights, NaN where `marks`, the valid_column, does not hold the number of valid heights."""
    column, valid = values["valid_column"], values.get("valid_value")
    others = np.unique(marks[marks != 0])
    told = f"column {column} holds {_counted(marks)}"
    if valid is None and (others.size > 1 or np.isnan(others).any()):
        allowed = f"0 and one other number; or valid_value = the number that marks a valid height; {REMEDY}"
        raise refused("valid_column", f"= {column}: {told}", allowed)
    if valid is not None and valid not in marks:
        raise refused("valid_value", f"= {valid:g}: {told}", "the one of these numbers that marks a valid height")
    return np.where(marks != 0 if valid is None else marks == valid, heights, np.nan)


def _refuse_marks(table: TextTable, unread: list[int]) -> None:
    """Raise ScanFileError for columns that are not read, from 0, and may mark missing heights."""
    marks = []
    for column in unread:
        numbers = table.values[:, column]
        steps = np.diff(numbers)
        if np.unique(numbers).size > 1 and not (steps > 0).all() and not (steps < 0).all():
            marks.append(f"column {column + 1} holds {_counted(numbers)}")
    if marks:
        allowed = (
            "valid_column = the column that marks missing heights, and valid_value = the number in it that marks a "
        )
        allowed += "valid one; valid_column = 0 if no column marks heights"
        raise refused("valid_column", f"is needed: {'; '.join(marks)}, and is not read", allowed)


def _counted(numbers: FloatArray) -> str:
    """Return the most frequent numbers of a column, each with its count."""
    kinds, counts = np.unique(numbers, return_counts=True)
    told = [f"{kinds[k]:g} ({counts[k]} times)" for k in np.argsort(-counts, kind="stable")[:SHOWN]]
    return ", ".join(told) + f", .. ({kinds.size} different)" * (kinds.size > SHOWN)
