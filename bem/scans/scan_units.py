"""Units of a scan: those that its file states, those that the scene gives, and that they agree.

A file states units in the heading of its columns (`x [mm]`, `h (µm)`, `x / mm`, `h in nm`, `x_mm`, or a line of units
alone), which is the last line before the numbers, or in lines such as `X unit: mm`, `Height unit = um`.
They are taken where the heading names one for every column used.  `Unit: um` without an axis, and a heading that names
some only, are not enough, but must not contradict the scene.  Nothing is inferred from the size of the numbers.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from bem.scans.scan_keys import METRES
from bem.scans.scan_text import Reading, Refusal, TextTable

ALLOWED = ", ".join(f'"{unit}"' for unit in METRES)
SPELT = {"µm": "um", "μm": "um", "micron": "um", "microns": "um", "mum": "um"}
SPELT |= {
    f"{prefix}{stem}{end}": f"{sign}m"
    for prefix, sign in (("", ""), ("milli", "m"), ("micro", "u"), ("nano", "n"))
    for stem in ("meter", "metre")
    for end in ("", "s")
}
OTHERS = ("pm", "cm", "dm", "km", "å", "angstrom", "inch", "in", "mil", "px", "pixel", "pixels", "v", "mv", "deg")
MARKED = re.compile(r"[\[({<]\s*([^\[\](){}<>\s]+)\s*[\])}>]|/\s*([^\s/;,]+)(?=$|[\s;,])|\b(?:in)\s+([^\s;,]+)")
LAST = re.compile(r"(?:^|[\s_])([^\s_]+)$")
BEFORE = re.compile(
    r"(?:^|[^a-z])(x|lateral|horizontal|z|h|height|vertical)[\s_.-]*(?:axis)?[\s_.-]*units?\b(.*)", re.I
)
BEHIND = re.compile(r"^units?\s*(?:of|for|in)?[\s_.-]*(x|lateral|horizontal|z|h|height|vertical)\b(.*)", re.I)
ALONE = re.compile(r"^units?\b(.*)", re.I)


class Statement(NamedTuple):
    """A unit that a line of a file states: of "x", "h" or, if it does not say, ""; enough to go by, or not."""

    axis: str
    unit: str
    line: int
    enough: bool


def unit_of(word: str) -> str | None:
    """The unit that a word means, as the scene writes it or, where the scene does not know it, as it is.

    Examples
    --------
    >>> unit_of("µm"), unit_of("Millimetres"), unit_of("cm"), unit_of("MM"), unit_of("Gauss")
    ('um', 'mm', 'cm', 'mm', None)
    """
    if word in METRES:
        return word
    lower = word.lower()
    if word.isupper() and lower in METRES and len(word) > 1:
        return lower
    return SPELT.get(lower, word if lower in OTHERS else None)


def statements(table: TextTable, columns: tuple[int | None, int] | None) -> tuple[Statement, ...]:
    """All units that the header of a table states.

    `columns` are those of x (None: there is none) and h, from 0; None where columns have no headings, as in a map.
    """
    found = [item for number, line in table.header for item in _said(number, line)]
    if columns is None:
        return tuple(found)
    for number, line in table.header[-1:]:
        units = _of_columns(line, table.reading, table.values.shape[1])
        named = {
            axis: unit
            for axis, column in zip("xh", columns, strict=True)
            if column is not None and (unit := units[column])
        }
        enough = len(named) == sum(column is not None for column in columns)
        found += [Statement(axis, unit, number, enough) for axis, unit in named.items()]
    return tuple(found)


def resolved(
    values: Mapping[str, Any], stated: Sequence[Statement], axes: str = "xh"
) -> tuple[dict[str, str], list[Refusal]]:
    """The unit of each of the axes that need one, and what is wrong with them; `values` are those of [profile]."""
    units: dict[str, str] = {}
    refusals: list[Refusal] = []
    for axis in axes:
        key = f"unit_{axis}"
        given = values.get(key)
        own = [item for item in stated if item.axis == axis]
        foreign = next((item for item in own if item.unit not in METRES), None)
        sure = {item.unit for item in own if item.enough}
        clash = next((item for item in own if item.unit != (given or next(iter(sure), item.unit))), None)
        if foreign is not None:
            found = f"is {foreign.unit!r} in {_place(foreign)}"
            refusals.append(Refusal(key, found, f"a file in one of {ALLOWED}: convert it"))
        elif clash is not None and given:
            found = f'= "{given}" contradicts the file, which says "{clash.unit}" in {_place(clash)}'
            refusals.append(Refusal(key, found, "one that agrees with the file; correct whichever is wrong"))
        elif clash is not None:
            said = ", ".join(f'"{item.unit}" in {_place(item)}' for item in own)
            refusals.append(Refusal(key, f"has more than one value in the file: {said}", "correct the file"))
        elif given or sure:
            units[axis] = given or sure.pop()
        else:
            loose = next((item for item in stated if item.axis in (axis, "")), None)
            hint = (
                "the file does not state it" if loose is None else f"line {loose.line} says {loose.unit!r} of no axis"
            )
            if loose is not None and loose.axis:
                hint = f"line {loose.line} names {loose.unit!r}, but not all columns have a unit there"
            refusals.append(Refusal(key, f"is missing: {hint}", f"one of {ALLOWED}"))
    return units, [*refusals, *_unplaced(units, stated, axes)]


def _place(item: Statement) -> str:
    """Where the file says it."""
    return f"line {item.line}" if item.line else "what its instrument wrote"


def _unplaced(units: Mapping[str, str], stated: Sequence[Statement], axes: str) -> Iterator[Refusal]:
    """Units that the file states of no axis and that neither axis has."""
    for item in stated:
        if not item.axis and len(units) == len(axes) and item.unit not in units.values():
            found = f'contradict the file, which says "{item.unit}" in {_place(item)}'
            yield Refusal(f"unit_{axes[-1]}", found, "units that agree with the file; correct whichever is wrong")


def _said(number: int, line: str) -> Iterator[Statement]:
    """Units that a line states of an axis by its name, or of none."""
    for pattern in (BEFORE, BEHIND):
        match = pattern.search(line)
        if match is not None:
            unit = _first_unit(match[2])
            if unit is not None:
                yield Statement("x" if match[1][0].lower() in "xl" or match[1].lower() == "horizontal" else "h", unit,
                                number, True)  # fmt: skip
            return
    match = ALONE.search(line)
    if match is not None and (unit := _first_unit(match[1])) is not None:
        yield Statement("", unit, number, False)


def _first_unit(text: str) -> str | None:
    """The first unit among the words of a text."""
    return next((unit for word in re.split(r"[\s:=;,\"'()\[\]]+", text) if word and (unit := unit_of(word))), None)


def _of_columns(line: str, reading: Reading, width: int) -> list[str | None]:
    """The unit of each column that a heading names."""
    cells = reading.cells(line)
    if ALONE.search(line) or "=" in line or ":" in line or any(re.fullmatch(r"[-+.,\d]+", cell) for cell in cells):
        return [None] * width
    if len(cells) == width:
        return [_of_cell(cell) for cell in cells]
    marked = [unit for match in MARKED.finditer(line) if (unit := unit_of(next(filter(None, match.groups()))))]
    return list(marked) if len(marked) == width else [None] * width


def _of_cell(cell: str) -> str | None:
    """The unit in the heading of one column: marked by brackets or a stroke, or its last word."""
    words = [next(filter(None, match.groups())) for match in MARKED.finditer(cell)]
    last = LAST.search(cell)
    found = [unit for word in words if (unit := unit_of(word))]
    if len(found) > 1:
        return None
    unit = found[0] if found else None
    if unit is None and last is not None and (word := unit_of(last[1])) in METRES and (word != "m" or cell == "m"):
        return word  # "x m" and "h_m" may be names
    return unit
