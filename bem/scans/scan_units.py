"""Units of a scan: the words for them, and that those of its file and those of the scene agree.

The words are those of words.toml.  Nothing is inferred from the size of the numbers.  An unknown unit
in a file is an error that names it; it is not treated as a missing unit.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any, NamedTuple

from bem.scans.scan_keys import METRES, UNITS
from bem.scans.scan_refusal import Refusal
from bem.scans.scan_words import folded, table


@cache
def _spelt() -> dict[str, str]:
    """Units as scenes spell them, by all ways to spell them."""
    return {word: unit for unit, words in table("units").items() for word in (unit, *words)}


class Statement(NamedTuple):
    """A unit that a line of a file states: of "x", "h" or, if it does not say, ""; enough to go by, or not."""

    axis: str
    unit: str
    line: int
    enough: bool


def unit_of(word: str) -> str | None:
    """The unit that a word means, as scenes spell it.

    Examples
    --------
    >>> unit_of("µm"), unit_of("Millimetres"), unit_of("cm"), unit_of("MM"), unit_of("Å"), unit_of("M"), unit_of("ft")
    ('um', 'mm', 'cm', 'mm', 'angstrom', None, None)
    """
    word = unicodedata.normalize("NFKC", word.strip().rstrip("."))
    if len(word) <= 2 and word != word.casefold() and word != word.upper():
        return None  # Mm, Nm, pM are other units
    return None if word == "M" else _spelt().get(folded(word))


def is_unit(word: str) -> bool:
    """Whether a word is a unit, of a length or of something else."""
    return unit_of(word) is not None or any(folded(word) in words for words in table("others").values())


def stated_unit(text: str) -> str:
    """The unit of a text that names one: as scenes spell it or, if it is none of theirs, the text.

    Examples
    --------
    >>> stated_unit("[µm]"), stated_unit("1 um"), stated_unit("0.5 um"), stated_unit("mm (millimetre)")
    ('um', 'um', '0.5 um', 'mm')
    """
    words = [bare for word in text.split() if (bare := word.strip("[](){}<>\"',;"))]
    if len(words) > 1 and words[0] in ("1", "1.0", "in"):
        words = words[1:]
    units = {unit_of(word) for word in words}
    unit = next(iter(units)) if len(units) == 1 else None
    return " ".join(words) if unit is None else unit


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
            refusals.append(Refusal(key, found, f"a file in one of {UNITS}: convert it, and name the unit there"))
        elif clash is not None and given:
            found = f'= "{given}" contradicts the file, which says "{clash.unit}" in {_place(clash)}'
            refusals.append(Refusal(key, found, f'{key} = "{clash.unit}", or correct the file'))
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
            refusals.append(Refusal(key, f"is missing: {hint}", f"one of {UNITS}"))
    return units, [*refusals, *_unplaced(units, stated, axes)]


def _place(item: Statement) -> str:
    """Where the file says it."""
    return f"line {item.line}" if item.line else "what its instrument wrote"


def _unplaced(units: Mapping[str, str], stated: Sequence[Statement], axes: str) -> Iterator[Refusal]:
    """Units that the file states of no axis and that neither axis has."""
    for item in stated:
        if not item.axis and len(units) == len(axes) and item.unit not in units.values():
            found = f'contradict the file, which says "{item.unit}" in {_place(item)}'
            right = " or ".join(f'unit_{axis} = "{item.unit}"' for axis in axes)
            allowed = (
                f"{right}, or correct the file" if item.unit in METRES else f"a file in one of {UNITS}: convert it"
            )
            yield Refusal(f"unit_{axes[-1]}", found, allowed)
