"""Heading above the columns of a text file, which states their units.

It stands right above the numbers and has a cell for every column: `x [mm]; h [um]`, `x (mm), h (um)`, `x / mm; h / um`,
or units alone, `mm; um`, perhaps under a line of names.  Lines above it that begin with `#` or `%` are comments.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from bem.geometry.lengths import METRES
from bem.scans.convert_units import unit_of
from bem.scans.scan_file_error import refused

COMMENT = ("#", "%")  # beginnings of a line above a heading that is read over
DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma", "": "blanks"}  # of cells
LINES_LISTED = 12  # format: lines above the numbers that are spelt out
LONGEST = 1000  # format: characters of a heading
CELL = re.compile(r"([^\[\]()/]*)(?:\[([^\[\]]+)\]|\(([^()]+)\)|/\s*([^\s\[\]()/]+))\s*")  # name, unit in one of 3 ways
MOST_COLUMNS = 3  # format: of a text that is no map
LENGTH = re.compile(r"[#%\s]*(width|spacing|pixel size|x step|step)\s*[:=]\s*([0-9.,]*[0-9])\s*([^\s0-9]+)\s*", re.I)
HEIGHT_UNIT = re.compile(r"[#%\s]*(?:value|height|z) units?\s*[:=]\s*(\S+)\s*", re.I)
REMEDY = "words that mark heights become numbers, as 1 and 0 in a column that valid_column names"


class NumberedLine(NamedTuple):
    """Line of a file, with its number as editors count."""

    number: int
    text: str

    def __str__(self) -> str:
        return f"line {self.number} ({self.text[:40]!r})"


def units_above(above: Sequence[NumberedLine], width: int, heights: int = 0) -> tuple[str, ...]:
    """Return the units in the lines above the numbers; ScanFileError for lines that are no heading.

    `heights` is the number of cells of a line that hold a number: if they are a map, `Width` is their length.
    """
    if not above:
        return ("",) * width
    heading, count = _heading(above[-1][1], width), 0
    if heading is not None:
        named, units = heading
        count = 2 if not named and _are_names(above[-2:-1], above[-1][0], width) else 1
        if all(line.startswith(COMMENT) for _, line in above[:-count]):
            return units
    skipped, stated = f"skip_lines = {above[-1 - count][0]}", _stated(above, heights)
    if len(stated) > 1:
        allowed = f"if no samples stand there, these keys, as the lines say: {', '.join([skipped, *stated])}"
        raise refused("file", f"{quoted(above)} not numbers", allowed + "; and row = 0, 1, .. of a map")
    allowed = (
        "columns of numbers, under a heading with a unit for each column, as in x [mm]; h [um]; or, if no samples "
    )
    allowed += f"stand there, {skipped}, and what the lines say in unit_x, unit_h, spacing, columns, missing_value, "
    allowed += f"valid_column{''.join(f' ({words})' for words in stated)}; {REMEDY}"
    raise refused("file", f"{quoted(above)} not numbers", allowed)


def _stated(above: Sequence[NumberedLine], heights: int) -> list[str]:
    """Return the keys that lines such as `# Width: 5 um` and `# Value units: m` state, as they are to be written.

    The width of a map is the length of all its pixels, as Gwyddion writes it: the spacing is a pixel.

    Examples
    --------
    >>> header = ["# Channel: Z", "# Width: 5.00 µm", "# Height: 3.00 µm", "# Value units: m"]
    >>> _stated([NumberedLine(k + 1, line) for k, line in enumerate(header)], 100)
    ['spacing = 0.05, unit_x = "um" (100 heights on a line are 5 um wide)', 'unit_h = "m"']
    >>> _stated([NumberedLine(1, "# Pixel size: 0.5 nm")], 1)
    ['spacing = 0.5, unit_x = "nm"']
    """
    said = {}
    for line in above:
        length, unit = LENGTH.fullmatch(line.text), HEIGHT_UNIT.fullmatch(line.text)
        if length is not None and unit_of(length[3]) in METRES:
            name, number, word = length[1].lower(), float(length[2].replace(",", ".")), unit_of(length[3])
            if name != "width":
                said["spacing"] = f'spacing = {number:g}, unit_x = "{word}"'
            elif heights > MOST_COLUMNS:
                step = f'spacing = {number / heights:.9g}, unit_x = "{word}"'
                said.setdefault("spacing", f"{step} ({heights} heights on a line are {number:g} {word} wide)")
        elif unit is not None and unit_of(unit[1]) in METRES:
            said["unit_h"] = f'unit_h = "{unit_of(unit[1])}"'
    return list(said.values())


def quoted(lines: Sequence[NumberedLine]) -> str:
    """Return the numbers and the texts of lines, as the subject of a sentence with its verb."""
    if len(lines) == 1:
        return f"{lines[0]} is"
    texts = ", ".join(repr(line[:40]) for _, line in lines[:LINES_LISTED]) + ", .." * (len(lines) > LINES_LISTED)
    return f"lines {lines[0].number} to {lines[-1].number} ({texts}) are"


def _are_names(lines: Sequence[NumberedLine], units: int, width: int) -> bool:
    """Return whether a line holds a name for each column and stands right above the line of their units."""
    return any(
        number == units - 1 and len(names) == width and not any(re.match("[-+.]?[0-9]", name) for name in names)
        for number, line in lines
        for names in (line.split(mark or None) for mark in DELIMITERS)
    )


def _heading(line: str, width: int) -> tuple[bool, tuple[str, ...]] | None:
    """Return whether columns are named in a heading, and their units, "" where none is stated.

    None if the line is no heading of `width` columns.

    Examples
    --------
    >>> _heading("# x [mm], h [µm]", 2), _heading("mm;um;n", 3), _heading("Filter [um]", 2)
    ((True, ('mm', 'um')), (False, ('mm', 'um', '')), None)
    """
    line = line.strip(" \t#%")
    if len(line) > LONGEST:
        return None
    cells = re.split("[\t;,]", line)
    if len(cells) == 1 < width:  # between blanks every cell has a unit
        cells, words = [match[0] for match in CELL.finditer(line)], line.split()
        if "".join(cells) != line or len(cells) != width:
            cells = words if all(_named_unit(word)[1] for word in words) else []
    if len(cells) != width or any(re.match(r'[\s"]*[-+.]?\d', cell) for cell in cells):
        return None
    names, units = zip(*map(_named_unit, cells), strict=True)
    return (any(name for name, unit in zip(names, units, strict=True) if unit), units) if any(units) else None


def _named_unit(cell: str) -> tuple[str, str]:
    """Return the name and the unit in a cell of a heading, "" where there is none."""
    cell = cell.strip(" \t\"'")
    match = CELL.fullmatch(cell)
    if match is not None:
        return match[1].strip(), unit_of(match[2] or match[3] or match[4])
    return ("", unit_of(cell)) if unit_of(cell) in METRES else (cell, "")
