"""Columns of a text file that hold the line: `columns` = [x, h], or heights alone, [h], at a given `spacing`.

A file of more columns needs `columns`, unless `row` names a row of a map (pick_row.py).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bem.geometry.arrays import FloatArray
from bem.scans.find_axes import refuse_axes
from bem.scans.mark_missing import refuse_numbers_above, refuse_unread_marks, without_invalid, without_missing
from bem.scans.pick_row import FEWEST_SAMPLES, TEXT_LINES
from bem.scans.read_table import TextTable
from bem.scans.scan_file_error import refused


def columns_of(table: TextTable, values: Mapping[str, Any]) -> tuple[int | None, int]:
    """Return the columns of positions (None without positions) and of heights, counted from 0."""
    width, flag = table.values.shape[1], values.get("valid_column", 0)
    if flag > width or (flag and width == 1):
        raise refused("valid_column", f"= {flag} of {width}", "0 for none, or a column of the file besides the heights")
    if table.lines.size < FEWEST_SAMPLES:
        problem = f"holds {table.lines.size} sample{'s' * (table.lines.size != 1)}, one on each line"
        allowed = f"at least {FEWEST_SAMPLES} of them; if a line holds many heights, row = 0 and their spacing"
        raise refused("file", problem, allowed)
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


def heights_of(table: TextTable, x_column: int | None, h_column: int, values: Mapping[str, Any]) -> FloatArray:
    """Return the heights of a column, NaN where missing; ScanFileError for an axis, and for marks left unread."""
    refuse_axes(table, ("first line", "last line"))
    if "valid_column" not in values:
        refuse_unread_marks(table, set(range(table.values.shape[1])) - {x_column, h_column})
    heights = table.values[:, h_column]
    refuse_numbers_above(table, heights, values)
    if x_column is None and heights[0] == heights.size - 1:
        problem = f"line {table.lines[0]} holds {heights[0]:g}, the number of heights that follow"
        raise refused("file", problem, f"heights alone: skip_lines = {table.lines[0]}")
    return without_invalid(without_missing(heights, values), table, values)
