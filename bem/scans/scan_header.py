"""What the header of a text file states: units, distances of samples, widths; found in lines, told apart by words.

A line is cut into pairs of a name and what is said of it: at `:` and `=`, at the cells of a row (`"Unit","um"`), behind
the word unit (`X unit mm`), before brackets (`x [mm]`), around "in" (`heights in nm`).  The name tells what it is, if
all its words are in the lists for that (words.toml):

unit        `Value units`, `X unit`, `Unit of heights`; `Unit` alone is of no axis, or of heights that stand alone
spacing     `XY calibration`, `Sampling interval`, `Pixel size`: from sample to sample
width       `Width`, `Scan size`, `X range`: of all samples of a line
factor      `Height conversion factor`, `Bit2nm`: heights are multiples of something
channel     what was measured, which may be no height

The heading of the columns (`x [mm];h [µm]`, `x / mm`, `x_mm`, or a line of units alone) is the last line before the
numbers, whatever its words mean.  A word in the place of a unit is kept even if it is no known unit.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from bem.geometry.ranges import MOST
from bem.scans.scan_keys import METRES, UNITS
from bem.scans.scan_refusal import Refusal, ScanFileError
from bem.scans.scan_text import SHAPE, Reading, TextTable
from bem.scans.scan_units import Statement, is_unit, stated_unit, unit_of
from bem.scans.scan_words import folded, label, table, words_of

LONGEST = 1000  # format: characters of a line that states something
SIGNS = " \t\"'#%!;/\\*"
SETTING = re.compile(r"([^:=]*)[:=](.*)")
BRACKETS = re.compile(r"([^\[\](){}<>]*)[\[({<]([^\[\](){}<>]*)[\])}>]")
STROKES = re.compile(r"/\s*([^\s/;,]+)|\bin\s+([^\s;,]+)")
NUMBERED = re.compile(r"([-+]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][-+]?\d+)?)(.*)")
BARE = re.compile(r"(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][-+]?\d+)?")
SECOND = re.compile(r"^[x×*]\s*[\d.,]+\s*")  # of 10 x 10 um


@dataclass(frozen=True)
class Length:
    """A distance of samples or a width that a line of the file states."""

    kind: str  # "spacing" or "width"
    metres: float
    half_digit: float  # half a unit of its last digit, m
    unit: str
    line: int
    text: str

    def __str__(self) -> str:
        return f"line {self.line} ({self.text[:60]!r})"


@dataclass
class Header:
    """What a header states."""

    units: list[Statement] = field(default_factory=list)
    lengths: list[Length] = field(default_factory=list)
    bare: list[str] = field(default_factory=list)  # lines with a distance or a width in no unit: it may be of pixels


class Axes(NamedTuple):
    """The words for the axes, and whether heights stand alone, without positions beside them."""

    alone: bool
    lateral: frozenset[str]
    vertical: frozenset[str]

    def named(self, words: frozenset[str]) -> list[str]:
        """The axes that a name means by all of its words; none if it is about something else."""
        rest = words - label("unit") - label("beside")
        if not rest:
            return ["h"] if self.alone else [""]
        pairs = (("x", self.lateral), ("h", self.vertical))
        return [axis for axis, known in pairs if rest & known and rest <= self.lateral | self.vertical]


def header_of(text: TextTable, columns: tuple[int | None, int] | None) -> Header:
    """All that the header of a table states.

    `columns` are those of x (None: there is none) and h, from 0; None where columns have no headings, as in a map.
    ScanFileError for a factor, a length or a channel that cannot be used.
    """
    found = Header()
    alone = columns is None or columns[0] is None
    plane = alone or text.values.shape[1] > 2  # y lies in it
    axes = Axes(alone, label("lateral") | ({"y"} if plane else set()), label("vertical") | (set() if plane else {"y"}))
    for number, line in (*text.header, *text.remarks):
        if len(line) > LONGEST:
            continue
        cells = _cells(line, text.reading)
        units = _row_of_units(cells, text.values.shape[1]) if columns is not None else None
        if units is None and columns is not None and text.header and number == text.header[-1][0]:
            found.units += _placed(number, _of_columns(line, text.reading, text.values.shape[1]), columns)
        elif units is None or columns is None:
            found.units += _marked(number, cells, axes)
        else:
            found.units += _placed(number, units, columns)
            continue
        for name, value in _pairs(cells):
            _take(found, number, line, name, value, axes)
    return found


def half_digit(text: str) -> float:
    """Half a unit of the last digit of a number as it is written.

    Examples
    --------
    >>> half_digit("10.0"), half_digit("1.50e3"), half_digit("7")
    (0.05, 5.0, 0.5)
    """
    digits, _, power = text.lower().replace(",", ".").partition("e")
    return 0.5 * 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))


def _cells(line: str, reading: Reading) -> list[str]:
    """The cells of a header line, which may be parted otherwise than the numbers."""
    if reading.delimiter == "," or '","' in line:
        cells = next(csv.reader([line], skipinitialspace=True), [])
        if len(cells) > 1:
            return [cell.strip(SIGNS) for cell in cells]
    return [cell.strip(SIGNS) for cell in re.split(r"[\t;|]|[ ]{2,}", line)]


def _pairs(cells: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Names, and what a line says of them."""
    for k, cell in enumerate(cells):
        rest = " ".join(cells[k + 1 : k + 3])
        setting, words = SETTING.fullmatch(cell), cell.split()
        behind = next((n for n, word in enumerate(words) if words_of(word) & label("unit")), None)
        if setting is not None:
            yield setting[1], setting[2].strip(SIGNS) or rest
        elif behind is not None:
            yield " ".join(words[: behind + 1]), " ".join(words[behind + 1 :]) or rest
        elif len(words) > 2 and words[-2].lower() == "in" and is_unit(words[-1]):
            yield " ".join([*words[:-2], "unit"]), words[-1]
        elif rest:
            yield cell, rest


def _take(found: Header, number: int, line: str, name: str, value: str, axes: Axes) -> None:
    """What one pair says, if anything."""
    words, unit = words_of(name), stated_unit(value)
    told = f"line {number} ({line[:60]!r})"
    if words & label("unit"):
        if unit and folded(unit) not in label("nothing"):
            found.units += [Statement(axis, unit, number, axis != "") for axis in axes.named(words)]
    elif words & label("factors") and words <= label("factors") | label("vertical") | label("beside") | {"nm", "m"}:
        if unit not in ("1", "1.0"):
            allowed = "heights in a unit of length: multiply them, and remove the line"
            raise ScanFileError([Refusal("file", f"{told} has a factor for the heights, not applied", allowed)])
    elif words & label("channel") and words <= label("channel") and words_of(value) & label("no_heights"):
        raise ScanFileError([Refusal("file", f"{told} names a channel without heights", "a channel of heights")])
    else:
        length = _length(number, line, name, value)
        found.lengths += [] if length is None else [length]
        if length is None and BARE.fullmatch(value.strip(SIGNS)) and _kind(words_of(name)):
            found.bare.append(told)


def _marked(number: int, cells: Sequence[str], axes: Axes) -> list[Statement]:
    """Units in brackets behind names of axes (`x [mm]`), enough if all axes have one."""
    pairs = [pair for cell in cells if SETTING.fullmatch(cell) is None for pair in BRACKETS.findall(cell)]
    named = [(words, unit) for name, text in pairs if (words := words_of(name)) and (unit := _in_brackets(text))]
    units = [(axis, unit) for words, unit in named for axis in axes.named(words) if axis]
    enough = {axis for axis, _ in units} >= set("h" if axes.alone else "xh")
    return [Statement(axis, unit, number, enough) for axis, unit in units]


def _in_brackets(text: str) -> str | None:
    """A unit; none where there is nothing, a number or another name."""
    unit = stated_unit(text)
    return None if not unit or unit.isdecimal() or words_of(unit) <= label("no_units") else unit


def _kind(words: frozenset[str]) -> str | None:
    """Whether a name is that of the distance of samples, or of a width."""
    extended = label("lateral") | label("extended")
    around = extended | label("beside") | label("extents") | label("around")
    if (
        {"pixel", "size"} <= words <= around
        or words == {"sampling"}
        or {"calibration"} < words <= extended | {"calibration"}
    ):
        return "spacing"
    if words & label("steps") and words <= label("steps") | around:
        return "spacing"
    if "sampling" in words:  # a sampling length is a cutoff
        return None
    of_it = words & label("widths") or words == {"length"} or (words & label("extents") and words & extended)
    return "width" if of_it and words <= label("widths") | around else None


def _length(number: int, line: str, name: str, value: str) -> Length | None:
    """A distance of samples or a width; ScanFileError for one in another unit."""
    kind = _kind(words_of(BRACKETS.sub(r"\1", name)))
    match = None if kind is None else NUMBERED.match(value.strip(SIGNS))
    if kind is None or match is None:
        return None
    bracketed = next((unit for _, unit in BRACKETS.findall(name)), "")
    behind = re.split(r"\s[x×*]\s|/", SECOND.sub("", match[2].strip()))[0]
    unit = stated_unit(behind or bracketed)
    if folded(unit) in table("others")["lengths"]:
        text = f"line {number} ({line[:60]!r}) has a length in {unit!r}"
        raise ScanFileError([Refusal("file", text, f"one of {UNITS}: convert it, or remove the line")])
    size = float(match[1].replace(",", "."))
    if unit not in METRES or not 0 < size < MOST:
        return None
    return Length(kind, size * METRES[unit], half_digit(match[1]) * METRES[unit], unit, number, line)


def _placed(number: int, units: Sequence[str | None], columns: tuple[int | None, int]) -> list[Statement]:
    """The units of the columns used, of those of all columns; enough if all used have one."""
    used = [(axis, column) for axis, column in zip("xh", columns, strict=True) if column is not None]
    named = {axis: unit for axis, column in used if (unit := units[column])}
    return [Statement(axis, unit, number, len(named) == len(used)) for axis, unit in named.items()]


def _row_of_units(cells: Sequence[str], width: int) -> list[str | None] | None:
    """The units of all columns behind the word unit (`Unit;mm;um`, `Unit: mm;um`); None for other lines."""
    name, value = cells[0], ""
    if (setting := SETTING.fullmatch(name)) is not None:
        name, value = setting[1], setting[2].strip(SIGNS)
    row = [value, *cells[1:]] if value else cells[1:]
    return _units(row) if words_of(name) and words_of(name) <= label("unit") and len(row) == width > 1 else None


def _units(cells: Sequence[str]) -> list[str | None]:
    """Cells that are units."""
    return [unit_of(cell) or cell or None for cell in (cell.strip("[](){}<>") for cell in cells)]


def _of_columns(line: str, reading: Reading, width: int) -> Sequence[str | None]:
    """The unit of each column that a heading names."""
    cells = reading.cells(line)
    if words_of(line) & label("unit") or "=" in line or ":" in line or any(map(SHAPE.fullmatch, cells)):
        return [None] * width
    if len(cells) == width:
        units = _units(cells)  # of a line of units alone
        return units if any(unit in METRES for unit in units) else [_of_cell(cell) for cell in cells]
    marked = [stated_unit(unit) for _, unit in BRACKETS.findall(line)]
    marked = marked or [stated_unit(next(filter(None, pair))) for pair in STROKES.findall(line)]
    return marked if len(marked) == width else [None] * width


def _of_cell(cell: str) -> str | None:
    """The unit in the heading of one column: in brackets, behind a stroke or "in", or its last word."""
    marked = [unit for _, text in BRACKETS.findall(cell) if (unit := _in_brackets(text))]
    known = [unit for unit in marked if unit in METRES]
    if marked:
        return known[0] if len(known) == 1 else None if known else " ".join(marked)
    words = [next(filter(None, pair)) for pair in STROKES.findall(cell)]
    last = re.split(r"[\s_]", cell)[-1]
    by_name = last == cell or folded(last) == "in" or (len(last) == 1 and unit_of(last) in (None, "m"))
    words += [] if by_name else [last]  # "x m", "h_m" may be names
    return next((unit_of(word) or word for word in words if is_unit(word)), None)
