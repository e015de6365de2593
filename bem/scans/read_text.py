"""Columns of numbers in a text file.

Every line is a row of numbers, or of words for a missing number (`MISSING`), with as many cells as the first.  Empty
lines stand for nothing, and a last column without any number is the delimiter at the end of every line.  Above the
first row may stand a heading that states units (read_units.py), and a line of names above a line of units.  Lines
above them that begin with `#` or `%` are comments: they state no unit, but a number in them may stand for a missing
height (read_map.py).  All other lines are refused with their numbers, unless `skip_lines` skips them.  Lines end with
LF, CR or both, as in editors.

A *reading* is a delimiter (tab, semicolon, comma, blanks) with a decimal mark.  The file must be rows of one length in
some reading; tabs part columns before blanks do.  The scene states `decimal` where the decimal mark is not clear: two
readings give different numbers (`0,5` may be two columns or a decimal comma), or columns of whole numbers between
commas may hold the decimals of the column before (`0,1,25`).  Marks between thousands are not read.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.ranges import MOST, Mistake
from bem.scans.read_units import heading_units
from bem.scans.scan_file_error import ScanFileError, refused

Cells = tuple[float, ...]
NumberedLine = tuple[int, str]  # its number as editors count, and its text

SHOWN = 3  # format: mistakes of one sort that are spelt out
COMMENT = ("#", "%")  # beginnings of a line above a heading that is read over
LINES_LISTED = 12  # format: lines above the numbers that are spelt out
DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma", "": "blanks"}
MISSING = {"", "-", "--", "---", "***", "na", "n/a", "#n/a", "null", "none"}
MISSING |= {"nan", "-nan", "nan(ind)", "-nan(ind)", "1.#qnan", "-1.#ind", "inf", "+inf", "-inf"}
NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
MINUS = re.compile("[\u2010-\u2015\u2212\ufe63\uff0d]")  # hyphens, dashes and minus signs of Unicode
REMEDY = "words that mark heights become numbers, as 1 and 0 in a column that valid_column names"


class Reading(NamedTuple):
    """Delimiter of cells ("" for blanks), and their decimal mark."""

    delimiter: str
    decimal: str

    def cells(self, line: str) -> list[str]:
        """Return the cells of a line, without blanks and quotes around them."""
        if not self.delimiter:
            return re.split("[ \t]+", line.strip(" \t"))
        return [cell.strip(" \t").strip('"').strip(" \t") for cell in line.split(self.delimiter)]

    def row(self, line: str) -> Cells | None:
        """Return the numbers of a line, NaN for a missing one; None if a cell is neither."""
        values = []
        for cell in self.cells(line):
            text = cell if self.decimal == "." else cell.replace(".", "?").replace(",", ".")
            if NUMBER.fullmatch(text) and abs(float(text)) <= MOST:
                values.append(float(text))
            elif cell.lower() in MISSING:
                values.append(math.nan)
            else:
                return None
        return tuple(values)

    def has_number(self, line: str) -> bool:
        """Return whether a line is a row with a number."""
        return not all(map(math.isnan, self.row(line) or ()))


READINGS = tuple(Reading(delimiter, mark) for mark in ".," for delimiter in DELIMITERS if delimiter != mark)


@dataclass(frozen=True, eq=False)
class TextTable:
    """Columns of numbers, and the units in their heading."""

    values: FloatArray  # (n_rows, n_columns); NaN where the file has none
    lines: IntArray  # line of each row, from 1, (n_rows,)
    rows: tuple[str, ...]  # text of each row
    units: tuple[str, ...]  # of each column, "" where none is stated
    heading: int  # line of these units, from 1; 0 without a heading
    reading: Reading
    above: tuple[NumberedLine, ...]  # lines above the first row, skipped or not


def read_table(text: str, skip_lines: int = 0, decimal: str | None = None) -> TextTable:
    """Return the table in a text; the decimal mark, "." or ",", where it is not clear from these.

    ScanFileError for two readings that fit, no table, or lines that are no rows, with their numbers.

    Examples
    --------
    >>> table = read_table("x [mm];h [µm]\\n0,0;1,5\\n0,1;NaN\\n0,2;1,25\\n")
    >>> table.values.tolist(), table.units, table.reading
    ([[0.0, 1.5], [0.1, nan], [0.2, 1.25]], ('mm', 'um'), Reading(delimiter=';', decimal=','))
    """
    whole = re.split("\r\n|\r|\n", text)
    if skip_lines >= len(whole):
        raise refused("skip_lines", f"= {skip_lines}", f"fewer than the {len(whole)} lines of the file")
    filled = [(number, bare) for number, line in enumerate(whole, 1) if (bare := line.strip(" ")).strip("\t ")]
    skipped = [line for line in filled if line[0] <= skip_lines]
    lines = filled[len(skipped) :]
    readings = [reading for reading in READINGS if decimal in (None, reading.decimal)]
    start = next((k for k, line in enumerate(lines) if any(each.has_number(line[1]) for each in readings)), len(lines))
    above, body = lines[:start], lines[start:]
    for line in above:
        _refuse_minus(line, readings)
    if not body:
        told = f": {_quoted(above)} not numbers alone" if above else ""
        raise refused("file", f"holds no line of numbers{told}", f"a text file with lines of numbers; {REMEDY}")
    reading, read = _rows_of(body, readings)
    width = len(reading.cells(body[0][1]))
    units = _heading_of(above, width)
    values = _numbers(body, reading, read, width)
    if reading.delimiter and np.isnan(values[:, -1]).all() and width > 1:
        values = values[:, :-1]
    if decimal is None:
        _refuse_commas(body, reading, values)
    numbers, rows = zip(*body, strict=True)
    heading = above[-1][0] if above else 0
    return TextTable(values, np.array(numbers), rows, units, heading, reading, (*skipped, *above))


def _heading_of(above: Sequence[NumberedLine], width: int) -> tuple[str, ...]:
    """Return the units in the lines above the numbers; ScanFileError for lines that are no heading."""
    if not above:
        return ("",) * width
    heading, count = heading_units(above[-1][1], width), 0
    if heading is not None:
        named, units = heading
        count = 2 if not named and _are_names(above[-2:-1], above[-1][0], width) else 1
        if all(line.startswith(COMMENT) for _, line in above[:-count]):
            return units
    allowed = (
        "columns of numbers, under a heading with a unit for each column, as in x [mm]; h [um]; or, if no samples "
    )
    allowed += f"stand there, skip_lines = {above[-1 - count][0]}, and what the lines say in unit_x, unit_h, spacing, "
    raise refused("file", f"{_quoted(above)} not numbers", f"{allowed}columns, missing_value, valid_column; {REMEDY}")


def _quoted(lines: Sequence[NumberedLine]) -> str:
    """Return the numbers and the texts of lines, as the subject of a sentence with its verb."""
    texts = ", ".join(repr(line[:40]) for _, line in lines[:LINES_LISTED]) + ", .." * (len(lines) > LINES_LISTED)
    first, last = lines[0][0], lines[-1][0]
    return f"line {first} ({texts}) is" if len(lines) == 1 else f"lines {first} to {last} ({texts}) are"


def _are_names(lines: Sequence[NumberedLine], units: int, width: int) -> bool:
    """Return whether a line holds a name for each column and stands right above the line of their units."""
    return any(
        number == units - 1 and len(names) == width and not any(re.match("[-+.]?[0-9]", name) for name in names)
        for number, line in lines
        for names in (line.split(mark or None) for mark in DELIMITERS)
    )


def _rows_of(body: Sequence[NumberedLine], readings: Iterable[Reading]) -> tuple[Reading, list[Cells | None]]:
    """Return the reading in which most lines are rows as long as the first, and the rows, None for other lines.

    ScanFileError for readings with unlike decimal marks that give unlike numbers.
    """
    fits = []
    for reading in readings:
        if reading.has_number(body[0][1]):
            read = [reading.row(line) for _, line in body]
            width = len(reading.cells(body[0][1]))
            rows = [row if row and len(row) == width else None for row in read]
            fits.append(((len(rows) - rows.count(None), -read.count(None)), reading, width, rows))
    most = max(fit[0] for fit in fits)
    (_, reading, width, rows), *others = (fit for fit in fits if fit[0] == most)
    for _, other, columns, values in (fit for fit in others if fit[1].decimal != reading.decimal):
        for (number, line), row, value in zip(body, rows, values, strict=True):
            if repr(row) != repr(value):  # NaN is unequal to NaN
                columns_read = " or ".join(f"{count} column{'s' * (count != 1)}" for count in (width, columns))
                allowed = f'decimal = "{reading.decimal}" for the first, decimal = "{other.decimal}" for the second'
                raise refused("decimal", f"is needed: line {number} ({line[:40]!r}) may be {columns_read}", allowed)
    return reading, rows


def _numbers(body: Sequence[NumberedLine], reading: Reading, rows: Sequence[Cells | None], width: int) -> FloatArray:
    """Return the numbers of all rows, (n_rows, width); ScanFileError for lines that are no rows."""
    wrong = []
    for (number, line), row in zip(body, rows, strict=True):
        if row is None:
            _refuse_minus((number, line), [reading])
            count = len(reading.cells(line))
            parted = f"{count} column{'s' * (count != 1)}, the first row {width}"
            parted = "more than numbers" if count == width else parted
            wrong.append(f"line {number} ({line[:40]!r}) holds {parted}")
    if wrong:
        allowed = f"{width} numbers up to {MOST:g}, or NaN for a missing one, with decimal mark {reading.decimal!r}, "
        allowed += f"and {DELIMITERS[reading.delimiter]} between columns: correct the line; {REMEDY}"
        rest = [f"and {len(wrong) - SHOWN} more lines like that"] * (len(wrong) > SHOWN)
        raise ScanFileError([Mistake("profile.file", text, allowed) for text in (*wrong[:SHOWN], *rest)])
    return np.array(rows, dtype=np.float64)


def _refuse_commas(body: Sequence[NumberedLine], reading: Reading, values: FloatArray) -> None:
    """Raise ScanFileError if commas between columns may be decimal marks of the column before (`0,1,25`)."""
    decimals = reading.delimiter == "," and values.shape[1] > 2 and (values[:, 1:] >= 0).all(axis=0).any()
    if decimals and not any("." in line for _, line in body):
        number, line = body[0]
        problem = f"is needed: line {number} ({line[:40]!r}) has commas that may part columns or decimals"
        allowed = 'decimal = "." if every comma parts columns; otherwise write points, or another mark, in the file'
        raise refused("decimal", problem, allowed)


def _refuse_minus(line: NumberedLine, readings: Iterable[Reading]) -> None:
    """Raise ScanFileError for a line of numbers whose minus signs are another character than "-"."""
    sign = MINUS.search(line[1])
    if sign is not None and any(reading.has_number(MINUS.sub("-", line[1])) for reading in readings):
        problem = f"line {line[0]} ({line[1][:40]!r}) has the minus sign {sign[0]!r} (U+{ord(sign[0]):04X})"
        raise refused("file", problem, 'the hyphen "-" (U+002D) before negative numbers: replace it')
