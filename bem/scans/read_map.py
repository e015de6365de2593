"""Rows of a map from any file, and detection of axes in text tables.

`row` names a row of heights, or the mean of all.  A first or last line, or column, of a text table counts as an axis,
and is refused, if its numbers only rise or only fall while those of the next two do not.  If all of them do so but a
number at an end, that number is the corner of two axes, and the side that crosses there is refused too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.read_text import LINES_LISTED, NUMBER, TextTable
from bem.scans.scan_file_error import refused

FEWEST_SAMPLES = 3  # derived: samples that carry one harmonic
FEWEST_STEPPED, FEWEST_ORDERED = 4, 8  # format: numbers on an axis, at equal steps or in order; by chance, 1 in 20,000
EQUAL_STEP = 0.01  # format: admitted deviation of a step of an axis, in steps

BESIDE_CORNER = {"first": slice(1, None), "last": slice(None, -1)}  # numbers of an axis, by the end with a corner
TEXT_LINES = "the lines of heights, from the first in the file"
ARRAY_LINES = "the columns a[:, row] of the array"
MAP_LINES = "the lines along x, from the first in the file"


def row_of(heights: FloatArray, row: int | str, lines: str) -> FloatArray:
    """Return a row of a map, (n_rows, n), or the mean of all rows; NaN where a height of the mean is missing."""
    if isinstance(row, str):
        return np.asarray(heights.mean(axis=0))
    return np.asarray(heights[_checked_row(row, heights.shape[0], lines)])


def _checked_row(row: int, count: int, lines: str) -> int:
    """Return the row of a number; raise ScanFileError if the map has no such row."""
    if row >= count:
        raise refused("row", f"= {row}", rows_allowed(count, lines))
    return row


def rows_allowed(count: int, lines: str) -> str:
    """Return the allowed values of `row` in words, with the lines of the file that it counts."""
    return f'row = 0 to {count - 1} for one of {lines}, row = "mean", or row = "all" for each'


def map_of(table: TextTable, values: Mapping[str, Any]) -> FloatArray:
    """Return the heights of a map; ScanFileError for keys and headings of columns, and for axes."""
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


def without_missing(heights: FloatArray, values: Mapping[str, Any]) -> FloatArray:
    """Return heights, NaN where they are infinite or the missing_value of the scene."""
    missing = values.get("missing_value", "none")
    known = np.isfinite(heights) & (True if missing == "none" else heights != missing)
    return np.where(known, heights, np.nan)


def refuse_numbers_above(table: TextTable, heights: FloatArray, values: Mapping[str, Any]) -> None:
    """Raise ScanFileError for heights that equal a number in the lines above them, unless missing_value is stated."""
    if "missing_value" in values:
        return
    equal = []
    for number, line in table.above:
        for value in {float(text) for mark in ",." for text in NUMBER.findall(line.replace(",", mark))}:
            count = np.count_nonzero(heights == value)
            equal += [f"line {number} ({line[:40]!r}): {value:g}, as {count} heights"] * bool(count)
    if equal:
        told = "; ".join(equal[:LINES_LISTED]) + "; .." * (len(equal) > LINES_LISTED)
        allowed = 'missing_value = the number that stands for a missing height; missing_value = "none" if none does'
        raise refused("missing_value", f"is needed: numbers above the heights equal heights: {told}", allowed)


def refuse_axes(table: TextTable, sides: Sequence[str]) -> None:
    """Raise ScanFileError for sides of the table that hold axes; a corner shows that two sides do."""
    turned = {"line": table.values, "column": table.values.T}
    axes = set()
    for side in sides:
        end, direction = side.split()
        axis = _axis(turned[direction][:: 1 if end == "first" else -1])
        if axis is not None:
            crossing = "column" if direction == "line" else "line"
            axes |= {side} | {f"{place} {crossing}" for place, part in BESIDE_CORNER.items() if part == axis}
    told = [side for side in sides if side in axes]
    if told:
        named = " and ".join(f"the {side}" for side in told)
        kinds = [{side.split()[1] for side in group} for group in (sides, told)]
        more = "".join(f" (and a {kind} of positions, if there is one)" for kind in kinds[0] - kinds[1])
        allowed = f"heights alone: remove {named}{more}, and give the step of the axis along the lines as spacing"
        raise refused("file", f"has axes in {named}, which are no heights", allowed)


def _axis(rows: FloatArray) -> slice | None:
    """Return the part of the first row that holds positions: in order where the next two rows are not."""
    parts = (slice(None), *BESIDE_CORNER.values())
    for stepped in (True, False):
        axes = [part for part in parts if _ordered(rows[0, part], stepped)]
        others = any(_ordered(row[part], stepped) for part in parts for row in rows[1:3])
        if axes and not others and rows.shape[0] > 1:
            return axes[0]
    return None


def _ordered(row: FloatArray, stepped: bool) -> bool:
    """Return whether numbers rise or fall, at equal steps or at any."""
    steps = np.diff(row)
    if row.size < (FEWEST_STEPPED if stepped else FEWEST_ORDERED) or not ((steps > 0).all() or (steps < 0).all()):
        return False
    return not stepped or float(np.abs(steps - steps.mean()).max()) <= EQUAL_STEP * abs(float(steps.mean()))
