"""Tables of numbers in text files as instruments and spreadsheets write them: found out, never guessed.

A line is a row of the table if all its cells are numbers, or words for a missing one; how cells are parted (tab,
semicolon, comma, blanks) and which decimal mark they have is a *reading*.  Of all readings the one with the most rows
of one length is taken; two that explain as many rows by different numbers are refused (`0,5` may be two columns or a
decimal comma; csv.Sniffer takes the likelier one), as is a file whose every comma may part thousands (`12,345`).  What
stands before the first row is the header, of any length; after it every line must be a row.  `#` begins a comment.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.ranges import MOST
from bem.scans.scan_bytes import text_of
from bem.scans.scan_refusal import Refusal, ScanFileError
from bem.scans.scan_units import is_unit

Row = tuple[float | None, ...]

SHOWN = 3  # format: mistakes of one sort that are spelt out
JUDGED = 2000  # format: lines at either end of a file that tell how it is to be read
FEWEST = 3  # derived: samples that carry one harmonic
DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma", "": "blanks"}
MISSING = {"", "-", "--", "---", "***", "na", "n/a", "#n/a", "null", "none", "missing", "bad", "invalid", "void"}
MISSING |= {"nan", "-nan", "nan(ind)", "-nan(ind)", "1.#qnan", "-1.#ind", "inf", "+inf", "-inf"}
COMMENT = re.compile(r"(?:^|\s)#(?!n/a)", re.IGNORECASE)
THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2},\d{3}")  # or a decimal comma
GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}(?:(?:,\d{3})+(?:,\d{3}|\.\d*)|(?:\.\d{3})+(?:\.\d{3}|,\d*))")
FORTRAN = re.compile(r"([+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+))[dD]([+-]?\d+)")
WORDED = re.compile(r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?\s*([^\W\d]{1,12})")
SHAPE = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?")


class Reading(NamedTuple):
    """How cells are parted ("" for blanks), and their decimal mark."""

    delimiter: str
    decimal: str

    def cells(self, line: str) -> list[str]:
        """The cells of a line, bare."""
        if not self.delimiter:
            return line.split()
        return [cell.strip().strip('"').strip() for cell in line.split(self.delimiter)]

    def row(self, line: str) -> Row | None:
        """The numbers of a line, None for a missing one; no row if a cell is neither."""
        cells = self.cells(line)
        values: list[float | None] = []
        for cell in cells:
            if cell.lower() in MISSING:
                values.append(None)
                continue
            text = cell if self.decimal == "." else cell.replace(".", "?").replace(",", ".")
            if not SHAPE.fullmatch(text):
                return None
            values.append(float(text))
        return tuple(values)


READINGS = tuple(Reading(delimiter, mark) for mark in ".," for delimiter in DELIMITERS if delimiter != mark)


@dataclass(frozen=True, eq=False)
class TextTable:
    """A table read from text."""

    values: FloatArray  # (n_rows, n_columns); NaN where the file has none
    lines: IntArray  # line of each row, from 1, (n_rows,)
    # lines before the first row that are not empty, with their numbers; comment signs removed
    header: tuple[tuple[int, str], ...]
    remarks: tuple[tuple[int, str], ...]  # comments behind it, likewise
    rows: tuple[str, ...]  # the text of each row
    encoding: str
    reading: Reading

    def texts(self, column: int) -> list[str]:
        """The cells of a column, from 0, as they are written."""
        return [self.reading.cells(row)[column] for row in self.rows]


def read_table(content: bytes, decimal: str | None = None) -> TextTable:
    """The table in the bytes of a text file; the decimal mark, "." or ",", where it does not follow from these alone.

    ScanFileError for two readings that fit, no table, or lines that are no rows, with their numbers.

    Examples
    --------
    >>> table = read_table("x in mm;h in µm\\n0,0;1,5\\n0,1;NaN\\n0,2;1,25\\n".encode("latin-1"))
    >>> table.values.tolist(), table.encoding, table.reading
    ([[0.0, 1.5], [0.1, nan], [0.2, 1.25]], 'latin-1', Reading(delimiter=';', decimal=','))
    """
    decoded = text_of(content)
    if decoded is None:
        raise ScanFileError([Refusal("file", f"is no text: a zero byte at {content.find(0)}", "a text file")])
    text, encoding = decoded
    whole = text.splitlines()
    lines = [(number, bare) for number, line in enumerate(whole, 1) if (bare := _without_comment(line))]
    reading, width = _reading_of(lines, decimal)
    table, numbers, rows = _rows(lines, reading, width, decimal)
    first = int(numbers[0])
    header = tuple(_bared(enumerate(whole[: first - 1], 1)))
    remarks = tuple(_bared((n, line) for n, line in enumerate(whole[first:], first + 1) if line.lstrip()[:1] == "#"))
    if reading.delimiter and np.isnan(table[:, -1]).all() and width > 1:
        table = table[:, :-1]  # every line ends with the delimiter
    return TextTable(table, numbers, header, remarks, rows, encoding, reading)


def _without_comment(line: str) -> str:
    """A line up to its comment."""
    found = COMMENT.search(line) if "#" in line else None
    return (line if found is None else line[: found.start()]).strip(" \r\n")


def _reading_of(lines: Sequence[tuple[int, str]], decimal: str | None) -> tuple[Reading, int]:
    """How the file is to be read, and its number of columns."""
    judged = _judged(lines)
    found: list[tuple[int, Reading, int, dict[int, Row]]] = []
    for reading in READINGS:
        if decimal is not None and reading.decimal != decimal:
            continue
        rows = {n: row for n, line in judged if (row := reading.row(line)) is not None and _has_number(row)}
        if not rows:
            continue
        width = Counter(map(len, rows.values())).most_common(1)[0][0]
        kept = {n: row for n, row in rows.items() if len(row) == width}
        found.append((len(kept), reading, width, kept))
    most = max((count for count, *_ in found), default=0)
    if most < FEWEST:
        allowed = f"a text file with at least {FEWEST} lines of numbers"
        last = f": line {lines[-1][0]} is {lines[-1][1][:40]!r}" if lines else ""
        raise ScanFileError([*_spelling(judged, decimal), Refusal("file", f"holds {most} samples{last}", allowed)])
    best = [item for item in found if item[0] == most]
    _, reading, width, rows = best[0]
    for _, other, columns, others in best[1:]:
        if others != rows:
            number = next(n for n in rows if rows.get(n) != others.get(n))
            line = dict(lines)[number]
            read = " or ".join(f"{count} column{'s' * (count != 1)}" for count in (width, columns))
            allowed = f'decimal = "{reading.decimal}" for the first, decimal = "{other.decimal}" for the second'
            raise ScanFileError(
                [Refusal("decimal", f"is needed: line {number} ({line[:40]!r}) may be {read}", allowed)]
            )
    if decimal is None and reading.decimal == ",":
        _refuse_thousands([(n, line) for n, line in judged if n in rows], reading)
    return reading, width


def _refuse_thousands(rows: Iterable[tuple[int, str]], reading: Reading) -> None:
    """ScanFileError where every number with a comma may as well have it between thousands (`12,345`)."""
    commas = [(n, line, cell) for n, line in rows for cell in reading.cells(line) if "," in cell]
    if not commas or not all(THOUSANDS.fullmatch(cell) for *_, cell in commas):
        return
    number, line, cell = commas[0]
    whole, rest = cell.split(",")
    found = f"is needed: line {number} ({line[:40]!r}) may mean {whole}.{rest} or {whole}{rest}"
    allowed = 'decimal = "," for the first; for the second remove the commas between thousands from the file'
    raise ScanFileError([Refusal("decimal", found, allowed)])


def _has_number(row: Row) -> bool:
    return any(value is not None for value in row)


def _judged(lines: Sequence[tuple[int, str]]) -> Sequence[tuple[int, str]]:
    """The lines that tell how a file is to be read."""
    return lines if len(lines) <= 2 * JUDGED else [*lines[:JUDGED], *lines[-JUDGED:]]


def _bared(lines: Iterable[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    """Lines that are not empty, comments without their sign."""
    for number, line in lines:
        bare = line.strip().lstrip("#%!;/").strip()
        if bare:
            yield number, bare


def _is_row(row: Row | None, width: int) -> bool:
    return row is not None and len(row) == width and _has_number(row)


def _rows(
    lines: Sequence[tuple[int, str]], reading: Reading, width: int, decimal: str | None
) -> tuple[FloatArray, IntArray, tuple[str, ...]]:
    """Rows from the first one on, (n_rows, width), their lines and texts; every other line is a mistake."""
    start = next(k for k, (_, line) in enumerate(lines) if _is_row(reading.row(line), width))
    ragged: list[str] = []
    invalid: list[str] = []
    wrong: list[tuple[int, str]] = []
    number, line = lines[start - 1]
    if start and number == lines[start][0] - 1 and _half_a_row(line, reading, width):
        invalid.append(f"line {number} ({line[:40]!r}) is no row of {width}")
        wrong.append((number, line))
    body = lines[start:]
    quick = None if invalid else _quick(body, reading)
    if quick is not None and quick.shape == (len(body), width):
        return _ordinary(quick, body)
    values: list[Row] = []
    kept: list[tuple[int, str]] = []
    for number, line in body:
        row = reading.row(line)
        if row is None:
            invalid.append(f"line {number} ({line[:40]!r}) holds more than numbers")
            wrong.append((number, line))
        elif len(row) != width:
            ragged.append(f"line {number} has {len(row)} column{'s' * (len(row) != 1)}, others have {width}")
        else:
            values.append(row)
            kept.append((number, line))
    mistakes = [
        *(Refusal("file", text, "the same number of columns in every line") for text in _shortened(ragged)),
        *(Refusal("file", text, f"numbers, or a word for a missing one such as NaN, {_marks(reading)}: correct the "
                  "line, remove it or begin it with #") for text in _shortened(invalid)),
    ]  # fmt: skip
    if mistakes:
        raise ScanFileError([*_spelling(_judged(wrong), decimal), *mistakes])
    return _ordinary(np.array([[math.nan if value is None else value for value in row] for row in values]), kept)


def _ordinary(table: FloatArray, body: Sequence[tuple[int, str]]) -> tuple[FloatArray, IntArray, tuple[str, ...]]:
    """Rows with their lines and texts; ScanFileError for numbers beyond all magnitudes."""
    beyond = [f"line {body[k][0]} ({body[k][1][:40]!r}) holds a number beyond {MOST:g}"
              for k in np.flatnonzero((np.abs(table) > MOST).any(axis=1)).tolist()]  # fmt: skip
    if beyond:
        allowed = f"numbers up to {MOST:g}, or a word for a missing one such as NaN"
        raise ScanFileError([Refusal("file", text, allowed) for text in _shortened(beyond)])
    return table, np.array([number for number, _ in body]), tuple(line for _, line in body)


def _quick(lines: Sequence[tuple[int, str]], reading: Reading) -> FloatArray | None:
    """All rows at once where every cell is a finite number; None where the lines have to be looked at."""
    text = [line for _, line in lines]
    if reading.decimal == ",":
        if any("." in line for line in text):
            return None
        text = [line.replace(",", ".") for line in text]
    try:
        table = np.loadtxt(text, delimiter=reading.delimiter or None, ndmin=2, comments=None)
    except ValueError:
        return None
    return table if np.isfinite(table).all() else None


def _spelling(lines: Sequence[tuple[int, str]], decimal: str | None) -> list[Refusal]:
    """What makes no row of the first line whose numbers are spelt in a way that is known, but not read."""
    for number, line in lines:
        told = f"line {number} ({line[:40]!r})"
        for reading in READINGS:
            cells = reading.cells(line)
            rest = [cell for cell in cells if reading.row(cell) is None]
            if rest and all(FORTRAN.fullmatch(cell) for cell in rest):
                spelt = FORTRAN.sub(r"\1E\2", rest[0])
                allowed = f"an exponent with E, {spelt}: replace D by E in the file"
                return [Refusal("file", f"{told} has exponents with D", allowed)]
            if rest and all((match := WORDED.fullmatch(cell)) and is_unit(match[1]) for cell in rest):
                allowed = "numbers alone: name their unit in the heading"
                return [Refusal("file", f"{told} has units after its numbers, as in {rest[0][:20]!r}", allowed)]
            if reading.delimiter == "," or len(cells) == 1:
                continue
            if rest and all(GROUPED.fullmatch(c) or (decimal == "." and THOUSANDS.fullmatch(c)) for c in rest):
                allowed = "numbers without marks between thousands: remove them from the file"
                return [Refusal("file", f"{told} has thousands separators", allowed)]
    return []


def _half_a_row(line: str, reading: Reading, width: int) -> bool:
    """Whether the line before the first row may be a damaged one: a number among as many cells, or numbers alone."""
    cells = reading.cells(line)
    if len(cells) == width > 1 and any(_is_row(reading.row(cell), 1) for cell in cells):
        return True
    return any(each.row(line) is not None for each in READINGS)


def _marks(reading: Reading) -> str:
    """A reading in words."""
    return f"decimal mark {reading.decimal!r}, columns parted by {DELIMITERS[reading.delimiter]}"


def _shortened(mistakes: list[str]) -> list[str]:
    """The first mistakes of one sort, and how many more there are."""
    rest = len(mistakes) - SHOWN
    return mistakes if rest <= 0 else [*mistakes[:SHOWN], f"and {rest} more lines like that"]
