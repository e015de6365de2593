"""The tables of words.toml, and the words of a text."""

from __future__ import annotations

import re
import tomllib
import unicodedata
from functools import cache
from pathlib import Path

PARTING = re.compile(r"[\s_\-./\\()\[\]{}<>,'\"]+")
OF_AXIS = {f"{axis}{unit}": (axis, "unit") for axis in "xyzh" for unit in ("unit", "units")}
OF_AXIS |= {f"unit{axis}": (axis, "unit") for axis in "xyzh"}


@cache
def table(name: str) -> dict[str, frozenset[str]]:
    """A table of words."""
    found = tomllib.loads(Path(__file__).with_name("words.toml").read_text("utf-8"))[name]
    return {key: frozenset(words) for key, words in found.items()}


def label(name: str) -> frozenset[str]:
    """The words of one kind that stand before a unit or a number."""
    return table("labels")[name]


def folded(text: str) -> str:
    """A text in small letters, with one micro sign, one angstrom sign and no letters that are two."""
    return unicodedata.normalize("NFKC", text).casefold()


def words_of(text: str) -> frozenset[str]:
    """The words of a label.

    Examples
    --------
    >>> sorted(words_of("Z-Unit [Heights]")), sorted(words_of("xUnit"))
    (['heights', 'unit', 'z'], ['unit', 'x'])
    """
    words = PARTING.split(folded(text))
    return frozenset(part for word in words if word for part in OF_AXIS.get(word, (word,)))
