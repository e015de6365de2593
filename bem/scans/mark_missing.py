"""Missing heights of a file: what its scene marks as missing becomes NaN, and what may mark them is asked for.

Missing are heights equal to `missing_value`, and heights beside which `valid_column` holds another number than
`valid_value`; without `valid_value`, heights beside 0, if the column holds one other number.  A column that is not read
may mark heights, unless it is constant or an axis: the scene then states `valid_column`, 0 where no column marks
heights.  A number above the heights that equals a height may mark heights: the scene then states `missing_value`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.read_heading import LINES_LISTED, REMEDY
from bem.scans.read_table import NUMBER, SHOWN, TextTable
from bem.scans.scan_file_error import refused


def without_missing(heights: FloatArray, values: Mapping[str, Any]) -> FloatArray:
    """Return heights, NaN where they are infinite or the missing_value of the scene."""
    missing = values.get("missing_value", "none")
    known = np.isfinite(heights) & (True if missing == "none" else heights != missing)
    return np.where(known, heights, np.nan)


def without_invalid(heights: FloatArray, table: TextTable, values: Mapping[str, Any]) -> FloatArray:
    """Return heights, NaN where the valid_column of the scene does not hold the number of valid heights."""
    column, valid = values.get("valid_column", 0), values.get("valid_value")
    if not column:
        if valid is not None:
            raise refused("valid_value", f"= {valid:g} without a valid_column", "both, or none of them")
        return heights
    marks = table.values[:, column - 1]
    others = np.unique(marks[marks != 0])
    told = f"column {column} holds {_counted(marks)}"
    if valid is None and (others.size > 1 or np.isnan(others).any()):
        allowed = f"0 and one other number; or valid_value = the number that marks a valid height; {REMEDY}"
        raise refused("valid_column", f"= {column}: {told}", allowed)
    if valid is not None and valid not in marks:
        raise refused("valid_value", f"= {valid:g}: {told}", "the one of these numbers that marks a valid height")
    return np.where(marks != 0 if valid is None else marks == valid, heights, np.nan)


def refuse_unread_marks(table: TextTable, unread: Iterable[int]) -> None:
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


def refuse_numbers_above(table: TextTable, heights: FloatArray, values: Mapping[str, Any]) -> None:
    """Raise ScanFileError for heights that equal a number in the lines above them, unless missing_value is stated."""
    if "missing_value" in values:
        return
    equal = []
    for line in table.above:
        for value in {float(text) for mark in ",." for text in NUMBER.findall(line.text.replace(",", mark))}:
            count = np.count_nonzero(heights == value)
            equal += [f"{line}: {value:g}, as {count} heights"] * bool(count)
    if equal:
        told = "; ".join(equal[:LINES_LISTED]) + "; .." * (len(equal) > LINES_LISTED)
        allowed = 'missing_value = the number that stands for a missing height; missing_value = "none" if none does'
        raise refused("missing_value", f"is needed: numbers above the heights equal heights: {told}", allowed)


def _counted(numbers: FloatArray) -> str:
    """Return the most frequent numbers of a column, each with its count."""
    kinds, counts = np.unique(numbers, return_counts=True)
    told = [f"{kinds[k]:g} ({counts[k]} times)" for k in np.argsort(-counts, kind="stable")[:SHOWN]]
    return ", ".join(told) + f", .. ({kinds.size} different)" * (kinds.size > SHOWN)
