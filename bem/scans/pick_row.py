"""Row of a map that is the line: row `row` of its heights, or the mean of all."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.scans.find_axes import refuse_axes
from bem.scans.mark_missing import refuse_numbers_above, without_missing
from bem.scans.read_table import TextTable
from bem.scans.scan_file_error import refused

FEWEST_SAMPLES = 3  # derived: samples that carry one harmonic
TEXT_LINES = "the lines of heights, from the first in the file"
ARRAY_LINES = "the columns a[:, row] of the array"
MAP_LINES = "the lines along x, from the first in the file"
TAKEN = {ARRAY_LINES: "the column a[:, {}] of the array", MAP_LINES: "line {} along x, counted from 0"}  # of one row


def map_of(table: TextTable, values: Mapping[str, Any]) -> FloatArray:
    """Return the heights of a map in a text file; ScanFileError for keys and headings of columns, and for axes."""
    width = table.values.shape[1]
    if width <= FEWEST_SAMPLES:
        allowed = f"leave it out: only a map has rows, of more than {FEWEST_SAMPLES} heights, one on each line of the "
        allowed += "file; of scan lines x y h keep one, with columns = [1, 3], or [2, 3] along y"
        raise refused("row", f"= {values['row']!r} of a file with {width} columns", allowed)
    for key in ("columns", "valid_column", "valid_value"):
        if key in values:
            raise refused(key, f"= {values[key]!r} beside row", "leave it out: the row of a map is all of a line")
    if table.heading:
        problem = f"line {table.heading} states units of columns, which a map does not have"
        raise refused("file", problem, f"skip_lines = {table.heading}, with unit_h and unit_x")
    refuse_axes(table, ("first line", "last line", "first column", "last column"))
    refuse_numbers_above(table, table.values, values)
    return without_missing(table.values, values)


def row_of(
    heights: FloatArray, row: int | str | None, lines: str, numbers: IntArray | None = None
) -> tuple[FloatArray, dict[str, Any]]:
    """Return a row of a map, (n_rows, n), or the mean of all rows; NaN where a height of the mean is missing.

    `lines` says what of the file is a row, `numbers` are the numbers of the rows in a text file, (n_rows,).
    The second value are the facts of the row: the number of rows, and in words which line was taken.
    ScanFileError if no row is named, or one that the map does not have.

    Examples
    --------
    >>> heights, facts = row_of(np.arange(8.0).reshape(2, 4), 1, ARRAY_LINES)
    >>> heights.tolist(), facts
    ([4.0, 5.0, 6.0, 7.0], {'rows': 2, 'taken': 'the column a[:, 1] of the array'})
    """
    count = heights.shape[0]
    if isinstance(row, str):
        return np.asarray(heights.mean(axis=0)), {"rows": count, "taken": f"the mean of {lines}"}
    if row is None or row >= count:
        problem = f"is needed: the file holds a map of {count} rows" if row is None else f"= {row}"
        raise refused(
            "row", problem, f'row = 0 to {count - 1} for one of {lines}, row = "mean", or row = "all" for each'
        )
    taken = TAKEN[lines].format(row) if numbers is None else f"line {numbers[row]} of the file"
    return np.asarray(heights[row]), {"rows": count, "taken": taken}
