"""Columns of numbers out of a text.

Every line is a row of numbers, or of words for a missing number (`MISSING`), with as many cells as the first.  Empty
lines stand for nothing, and a last column without any number is the delimiter at the end of every line.  Above the
first row may stand a heading that states units (convert_units.py), and a line of names above a line of units.  Lines
above them that begin with `#` or `%` are comments: they state no unit, but a number in them may stand for a missing
height (mark_missing.py).  All other lines are refused with their numbers, unless `skip_lines` skips them.  Lines end
with LF, CR or both, as in editors.

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
from typing import Any, NamedTuple

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.ranges import MOST, Mistake
from bem.scans.read_heading import COMMENT, DELIMITERS, LINES_LISTED, REMEDY, NumberedLine, quoted, units_above
from bem.scans.scan_file_error import ScanFileError, refused

Cells = tuple[float, ...]

OTHER_MARK = "write decimal points, or semicolons between columns, in the file"
SHOWN = 3  # format: mistakes of one sort that are spelt out
MISSING = {"", "-", "--", "---", "***", "na", "n/a", "#n/a", "null", "none"}
MISSING |= {"nan", "-nan", "nan(ind)", "-nan(ind)", "1.#qnan", "-1.#ind", "inf", "+inf", "-inf"}
NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
MINUS = re.compile("[\u2010-\u2015\u2212\ufe63\uff0d]")  # hyphens, dashes and minus signs of Unicode


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
    facts: dict[str, Any]  # how it was read: plain values

    def half_digits(self, column: int) -> FloatArray:
        """Return half a unit of the last digit of each number of a column, (n_rows,)."""
        return np.array([_half_digit(self.reading.cells(row)[column]) for row in self.rows])


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
    numbered = [NumberedLine(number, line.strip(" ")) for number, line in enumerate(whole, 1)]
    filled = [line for line in numbered if line.text.strip("\t ")]
    skipped = [line for line in filled if line.number <= skip_lines]
    lines = filled[len(skipped) :]
    readings = [reading for reading in READINGS if decimal in (None, reading.decimal)]
    start = next(
        (k for k, line in enumerate(lines) if any(each.has_number(line.text) for each in readings)), len(lines)
    )
    above, body = lines[:start], lines[start:]
    for line in above:
        _refuse_minus(line, readings)
    if not body:
        if decimal == ",":
            _refuse_comma_columns(lines)
        told = f": {quoted(above)} not numbers alone" if above else ""
        raise refused("file", f"holds no line of numbers{told}", f"a text file with lines of numbers; {REMEDY}")
    reading, read = _best_reading(body, readings)
    width = len(reading.cells(body[0].text))
    if decimal is None:
        _refuse_commas(above, body, reading, read)
    elif decimal == ",":
        _refuse_comma_columns([line for line, row in zip(body, read, strict=True) if row is None])
    units = units_above(above, width, width - (not reading.cells(body[0].text)[-1]))
    values = _numbers(body, reading, read, width)
    if reading.delimiter and np.isnan(values[:, -1]).all() and width > 1:
        values = values[:, :-1]
    numbers, rows = zip(*body, strict=True)
    heading = above[-1].number if above else 0
    facts = {"delimiter": DELIMITERS[reading.delimiter], "decimal": reading.decimal, "width": values.shape[1]}
    over = [line for _, line in skipped] + [line for _, line in above[:-1] if line.startswith(COMMENT)]
    if over:
        facts["skipped"] = " | ".join(line[:40] for line in over[:LINES_LISTED])
    return TextTable(values, np.array(numbers), rows, units, heading, reading, (*skipped, *above), facts)


def _half_digit(text: str) -> float:
    """Return half a unit of the last digit of a number as it is written.

    Examples
    --------
    >>> _half_digit("10.0"), _half_digit("1.50e3"), _half_digit("7")
    (0.05, 5.0, 0.5)
    """
    digits, _, power = text.lower().replace(",", ".").partition("e")
    return 0.5 * 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))


def _best_reading(body: Sequence[NumberedLine], readings: Iterable[Reading]) -> tuple[Reading, list[Cells | None]]:
    """Return the reading in which most lines are rows as long as the first, and the rows, None for other lines.

    ScanFileError for readings with unlike decimal marks that give unlike numbers.
    """
    fits = []
    for reading in readings:
        if reading.has_number(body[0].text):
            read = [reading.row(line) for _, line in body]
            width = len(reading.cells(body[0].text))
            rows = [row if row and len(row) == width else None for row in read]
            fits.append(((len(rows) - rows.count(None), -read.count(None)), reading, width, rows))
    most = max(fit[0] for fit in fits)
    (_, reading, width, rows), *others = (fit for fit in fits if fit[0] == most)
    for _, other, columns, values in (fit for fit in others if fit[1].decimal != reading.decimal):
        for line, row, value in zip(body, rows, values, strict=True):
            if repr(row) != repr(value):  # NaN is unequal to NaN
                columns_read = " or ".join(f"{count} column{'s' * (count != 1)}" for count in (width, columns))
                allowed = f'decimal = "{reading.decimal}" for the first, decimal = "{other.decimal}" for the second'
                raise refused("decimal", f"is needed: {line} may be {columns_read}", allowed)
    return reading, rows


def _numbers(body: Sequence[NumberedLine], reading: Reading, rows: Sequence[Cells | None], width: int) -> FloatArray:
    """Return the numbers of all rows, (n_rows, width); ScanFileError for lines that are no rows."""
    wrong = []
    for line, row in zip(body, rows, strict=True):
        if row is None:
            _refuse_minus(line, [reading])
            count = len(reading.cells(line.text))
            parted = f"{count} column{'s' * (count != 1)}, the first row {width}"
            parted = "more than numbers" if count == width else parted
            wrong.append(f"{line} holds {parted}")
    if wrong:
        allowed = f"{width} numbers up to {MOST:g}, or NaN for a missing one, with decimal mark {reading.decimal!r}, "
        allowed += f"and {DELIMITERS[reading.delimiter]} between columns: correct the line; {REMEDY}"
        rest = [f"and {len(wrong) - SHOWN} more lines like that"] * (len(wrong) > SHOWN)
        raise ScanFileError([Mistake("profile.file", text, allowed) for text in (*wrong[:SHOWN], *rest)])
    return np.array(rows, dtype=np.float64)


def _refuse_commas(
    above: Sequence[NumberedLine], body: Sequence[NumberedLine], reading: Reading, rows: Sequence[Cells | None]
) -> None:
    """Raise ScanFileError if commas between columns may be decimal marks of the column before (`0,1,25`).

    Lines of unlike lengths, of 3 or 4 cells, are whole numbers among such decimals (`1,1,25`, `1,50,1,75`).  A heading
    of half as many cells leaves no doubt.
    """
    if reading.delimiter != "," or any("." in line for _, line in body):
        return
    widths = {len(row or reading.row(line) or ()) for (_, line), row in zip(body, rows, strict=True)} - {0}
    known = np.array([row for row in rows if row])
    filled = known[:, 1:][:, ~np.isnan(known[:, 1:]).all(axis=0)]  # without the empty cell behind a comma at the end
    decimals = filled.shape[1] > 1 and (filled >= 0).all(axis=0).any()
    if decimals or (len(widths) > 1 and widths <= {2, 3, 4}):
        if above and not above[-1].text.startswith(COMMENT) and 2 * len(above[-1].text.split(",")) in widths:
            _refuse_comma_columns(body)
        problem = f"is needed: {body[0]} has commas that may part columns or decimals"
        raise refused("decimal", problem, f'decimal = "." if every comma parts columns; otherwise {OTHER_MARK}')


def _refuse_comma_columns(lines: Sequence[NumberedLine]) -> None:
    """Raise ScanFileError for lines whose commas part columns and decimals: no reading with decimal = "," has them."""
    commas = Reading(",", ".")
    rows = [line for line in lines if len(commas.cells(line.text)) > 2 and commas.has_number(line.text)]
    if rows:
        problem = f"{rows[0]} has commas between columns beside decimal commas"
        raise refused("file", problem, f"one meaning of a comma: {OTHER_MARK}")


def _refuse_minus(line: NumberedLine, readings: Iterable[Reading]) -> None:
    """Raise ScanFileError for a line of numbers whose minus signs are another character than "-"."""
    sign = MINUS.search(line.text)
    if sign is not None and any(reading.has_number(MINUS.sub("-", line.text)) for reading in readings):
        problem = f"{line} has the minus sign {sign[0]!r} (U+{ord(sign[0]):04X})"
        raise refused("file", problem, 'the hyphen "-" (U+002D) before negative numbers: replace it')
