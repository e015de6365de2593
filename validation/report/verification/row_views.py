"""A row as a reader meets it: its name, and the place where it is judged."""

from __future__ import annotations

import math
import re

from validation.harness.schema import Row


def worst_place(row: Row) -> int:
    """Index of the value that the error is of: the farthest off, or the ratio farthest from the middle of its band."""
    middle = None if row.band is None else (row.band.low + row.band.high) / 2

    def miss(a: float | None, b: float | None) -> float:
        if a is None or b is None or math.isnan(a - b) or (middle is not None and b == 0):
            return math.inf
        return abs(a - b) if middle is None else abs(a / b - middle)

    misses = [miss(a, b) for a, b in zip(row.computed, row.expected, strict=True)]
    return misses.index(max(misses))


def named(quantity: str, unit: str) -> tuple[str, str]:
    """The name of a quantity with a unit, and what its error is scaled with: "load over p*" holds a load in Pa.

    Examples
    --------
    >>> named("load over p*, two grids", "Pa"), named("load over p*", ""), named("load, over all shifts", "Pa")
    (('load, two grids', 'p*'), ('load over p*', ''), ('load, over all shifts', ''))
    """
    found = re.fullmatch(r"(.*?),? over (?!all\b)([^,]*)(,.*)?", quantity) if unit else None
    return (quantity, "") if found is None else (found[1] + (found[3] or ""), found[2])
