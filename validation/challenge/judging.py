"""Answers judged: for each quantity the digits reached, the error over its scale and over the uncertainty of the key.

With y the certified values, u their uncertainties, c the scale of the quantity and x what was answered,

    error = max |x - y| / c,   digits = -log10 max(error, max u / c),   from 0 to MOST_DIGITS:

digits finer than the key's own uncertainty are not claimed.  A quantity is right when it has the digits asked for.  A
value that is None is one that the solver does not offer: the others are judged, and the quantity counts as missing.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from validation.challenge.problem import Certified, Key, scale_of
from validation.harness.route import Answer

MOST_DIGITS = 15.0
RIGHT = "right"
LOST = 0.5  # digits by which a quantity may fall behind a baseline: rounding moves errors by a factor of two or so


@dataclass(frozen=True)
class Digits:
    """A quantity of a problem, judged; the numbers are those of an answer, where one came.

    A status is "right", "wrong", "missing", "not a number", "wrong shape", "not offered", "crashed", "out of
    memory" or "timed out".
    """

    quantity: str
    status: str
    message: str
    digits: float | None  # None, as the next two, where no value came
    error: float | None
    over_uncertainty: float | None  # None also where the uncertainty is zero
    answered: int  # number of values; likewise `asked`
    asked: int


@dataclass(frozen=True)
class Judged:
    """A problem, judged: a row for each quantity, and how the solver came back."""

    problem: str
    status: str
    message: str
    seconds: float | None
    cpu_seconds: float | None
    rows: tuple[Digits, ...]
    ignored: tuple[str, ...]

    @property
    def passed(self) -> bool:
        """Whether everything is right."""
        return all(row.status == RIGHT for row in self.rows)


def judged(key: Key, returned: Answer, digits: float) -> Judged:
    """What a solver returned for a problem, against its key; `digits` are those that an answer needs to be right."""
    if returned.status == "answered":
        rows = tuple(_row(name, one, returned.values.get(name), digits) for name, one in key.answers.items())
    else:
        rows = tuple(_without(name, one, returned.status, returned.message) for name, one in key.answers.items())
    ignored = tuple(sorted(name for name in returned.values if name not in key.answers))
    return Judged(key.problem, returned.status, returned.message, returned.seconds, returned.cpu_seconds, rows, ignored)


def lost(now: Iterable[Judged], before: Iterable[Judged]) -> Iterator[str]:
    """Quantities with fewer digits than a baseline has, or none where it has some; of the problems that both hold."""
    known = {judged.problem: {row.quantity: row for row in judged.rows} for judged in before}
    for one in now:
        for row in one.rows:
            old = known.get(one.problem, {}).get(row.quantity)
            if old is None or old.digits is None:
                continue
            if row.digits is None or row.answered < old.answered:
                yield f"{one.problem}: {row.quantity}: {row.status}, {old.digits:.1f} digits before"
            elif row.digits < old.digits - LOST:
                yield f"{one.problem}: {row.quantity}: {row.digits:.1f} digits, {old.digits:.1f} before"


def _row(name: str, key: Certified, given: Any, digits: float) -> Digits:
    values = given if isinstance(given, list) else [given]
    if values and all(value is None for value in values):
        return _without(name, key, "missing")
    shown = repr(given) if len(repr(given)) < 60 else repr(given)[:57] + "..."
    if any(isinstance(value, str | bool | dict) for value in values):
        return _without(name, key, "not a number", shown)
    if any(isinstance(value, list) for value in values) or len(values) != len(key.value):
        return _without(name, key, "wrong shape", f"{len(key.value)} numbers are needed, not {shown}")
    if not all(value is None or _finite(value) for value in values):
        return _without(name, key, "not a number", shown)
    return _compared(name, key, values, digits)


def _without(name: str, key: Certified, status: str, message: str = "") -> Digits:
    return Digits(name, status, message, None, None, None, 0, len(key.value))


def _finite(value: float) -> bool:
    """Whether the number fits a double: JSON and Python have integers that do not."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def _compared(name: str, key: Certified, values: Sequence[float | None], digits: float) -> Digits:
    """A row of numbers, of which some may be missing."""
    scale = scale_of(name, key.value)
    known = [
        (abs(value - exact), spread)
        for value, exact, spread in zip(values, key.value, key.uncertainty, strict=True)
        if value is not None
    ]
    error, spread = max(miss for miss, _ in known) / scale, max(u for _, u in known) / scale
    ratios = [miss / u for miss, u in known if u > 0]
    reached = max(0.0, min(MOST_DIGITS, -math.log10(max(error, spread, 10.0**-MOST_DIGITS))))
    status, message = RIGHT if reached >= digits else "wrong", ""
    if len(known) < len(values):
        status, message = "missing", f"{len(values) - len(known)} of {len(values)} values"
    return Digits(name, status, message, reached, error, max(ratios, default=None), len(known), len(values))
