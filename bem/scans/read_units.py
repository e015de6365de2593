"""Units of a scan: stated by the heading of a text file's columns or by an instrument's file, or given by the scene.

A heading stands right above the numbers and has a cell for every column: `x [mm]; h [um]`, `x (mm), h (um)`,
`x / mm; h / um`, or units alone, `mm; um`.  It counts if it states a unit for every column that is used.  Where scene
and file both state a unit, the two must be equal.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping
from typing import Any

from bem.geometry.lengths import LENGTH_UNITS, METRES
from bem.geometry.ranges import Mistake
from bem.scans.scan_file_error import ScanFileError

SYMBOLS = {"μm": "um", "μin": "uin", "Å": "angstrom"}  # after NFKC, which has one micro sign and one angstrom sign
LONGEST = 1000  # format: characters of a heading
CELL = re.compile(r"([^\[\]()/]*)(?:\[([^\[\]]+)\]|\(([^()]+)\)|/\s*([^\s\[\]()/]+))\s*")  # name, unit in one of 3 ways


def unit_of(word: str) -> str:
    """Return the unit that a word means, as scenes spell it; other words unchanged.

    Examples
    --------
    >>> unit_of("µm"), unit_of("Å"), unit_of("mm"), unit_of("V")
    ('um', 'angstrom', 'mm', 'V')
    """
    word = unicodedata.normalize("NFKC", word.strip())
    return SYMBOLS.get(word, word)


def heading_units(line: str, width: int) -> tuple[bool, tuple[str, ...]] | None:
    """Return whether columns are named in a heading, and their units, "" where none is stated.

    None if the line is no heading of `width` columns.

    Examples
    --------
    >>> heading_units("# x [mm], h [µm]", 2), heading_units("mm;um;n", 3), heading_units("Filter [um]", 2)
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


def resolved_units(values: Mapping[str, Any], stated: Mapping[str, str], source: str) -> dict[str, str]:
    """Return the units of positions and heights by axis, "x" and "h".

    `values` are the keys of [profile], `stated` the units that `source` (a line of a text file, or an instrument)
    states by axis: "" for an axis without one.  ScanFileError for units that are missing, unknown or contradictory.
    """
    units: dict[str, str] = {}
    mistakes = []
    for axis in "xh":
        key, own = f"unit_{axis}", stated.get(axis, "")
        path, given = f"profile.{key}", values.get(key)
        if own and own not in METRES:
            allowed = f"one of {LENGTH_UNITS} there: spell the unit so, or convert the numbers"
            mistakes.append(Mistake(path, f"is {own!r} in {source}", allowed))
        elif own and given and own != given:
            problem = f'= "{given}" contradicts the file, which says "{own}" in {source}'
            mistakes.append(Mistake(path, problem, f'{key} = "{own}", or correct the file'))
        elif given or (own and all(stated.values())):
            units[axis] = given or own
        else:
            reason = f"{source} states a unit for one column alone" if own else "the file does not state it"
            mistakes.append(Mistake(path, f"is missing: {reason}", f"one of {LENGTH_UNITS}"))
    if mistakes:
        raise ScanFileError(mistakes)
    return units
