"""A row as a reader meets it: its name, the place where it is judged, and its uncertainty budget after ASME V&V 20.

With S what was computed and D what was expected, the comparison error is E = S - D and the validation uncertainty

    u_val = (u_num^2 + u_input^2 + u_D^2)^(1/2),

u_num as the code estimates it of itself, u_D that of the reference.  Both sides are given the same numbers, so that
u_input = 0.  |E| within 2 u_val (the factor of `combined_tolerance`) is no difference that these codes could resolve;
beyond it, E +- 2 u_val is left to model or discretisation.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from validation.harness.schema import Row

FACTOR = 2.0


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


@dataclass(frozen=True)
class Budget:
    """Errors and uncertainties in the unit of the row; None where a side states no uncertainty of itself."""

    name: str
    unit: str
    error: float
    numerical: float | None
    data: float | None
    validation: float | None
    says: str


def budget_of(row: Row) -> Budget | None:
    """The budget of a row where its two sides differ most; None where it has no numbers.

    Examples
    --------
    >>> from validation.harness.schema import Reference, Row, Tolerance
    >>> row = Row(quantity="load", unit="N/m", reference=Reference(kind="FEM", source="mesh 4", uncertainty=0.4),
    ...           norm="absolute", expected=[1.0], computed=[1.5], uncertainty=0.3,
    ...           tolerance=Tolerance(value=1.0, measured=0.5))
    >>> found = budget_of(row)
    >>> found.error, found.validation, found.says
    (0.5, 0.5, 'within 2 u_val')
    """
    k = worst_place(row)
    expected, computed = row.expected[k], row.computed[k]
    if row.status != "run" or expected is None or computed is None or math.isnan(computed - expected):
        return None
    name, _ = named(row.quantity, row.unit)
    unstated = 0.0 if row.reference.kind == "exact" else None
    numerical, data = row.uncertainty or None, row.reference.uncertainty or unstated
    error = computed - expected
    if not (numerical or data):
        says = "equal" if error == 0 else "no uncertainty stated: judged by the tolerance"
        return Budget(name, row.unit, error, numerical, data, None, says)
    validation = math.hypot(numerical or 0.0, data or 0.0)
    says = "within 2 u_val" if abs(error) <= FACTOR * validation else "beyond 2 u_val: left to model or discretisation"
    return Budget(name, row.unit, error, numerical, data, validation, says)
