"""Answers judged: for each quantity the digits reached, the error over its scale and over the uncertainty of the key.

With y the certified values, u their uncertainties, c the scale of the quantity and x what was answered,

    error = max |x - y| / c,   digits = -log10 max(error, max u / c),   from 0 to MOST_DIGITS:

digits finer than the key's own uncertainty are not claimed.  A quantity is right when it has the digits asked for.  A
value that is None is one that the solver does not offer: the others are judged, and the quantity counts as missing.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from validation.challenge.problem import Certified, Shipped
from validation.harness.route import Answer

MOST_DIGITS = 15.0
RIGHT = "right"
LOST = 0.5  # digits by which a quantity may fall behind a baseline: rounding moves errors by a factor of two or so
SHOWN = 60  # characters of an answer that is no numbers


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

    @property
    def told(self) -> Iterator[str]:
        """What is not right, a line each."""
        if self.status != "answered":
            yield f"{self.problem}: {self.status}, {' '.join(self.message.split())}"
            return
        for row in self.rows:
            if row.status != RIGHT:
                why = f", {row.message}" if row.message else ""
                reached = "" if row.digits is None else f", {row.digits:.1f} digits"
                yield f"{self.problem}: {row.quantity}: {row.status}{reached}{why}"


@dataclass(frozen=True)
class Judgement:
    """Everything of a judgement: who, on what terms, and the problems; `lost` is None without a baseline."""

    solver: str
    digits: float
    problems: tuple[Judged, ...]
    baseline: str | None = None
    lost: tuple[str, ...] | None = None

    @property
    def passed(self) -> bool:
        """No digits lost to the baseline; without one, every answer right."""
        return all(one.passed for one in self.problems) if self.lost is None else not self.lost

    @property
    def outcome(self) -> str:
        """In a sentence."""
        statuses = [row.status for one in self.problems for row in one.rows]
        counts = {status: statuses.count(status) for status in dict.fromkeys(statuses) if status != RIGHT}
        others = "".join(f", {count} {status}" for status, count in counts.items())
        spent = [one.seconds for one in self.problems if one.seconds is not None]
        seconds = f"; {sum(spent):.3g} s" if spent else ""
        held = "" if self.lost is None else f"; {len(self.lost)} quantities lost digits against the baseline"
        right = statuses.count(RIGHT)
        return f"{right} of {len(statuses)} answers right to {self.digits:g} digits{others}{seconds}{held}"


def judged(one: Shipped, found: Answer, digits: float) -> Judged:
    """What a solver answered to a problem; `digits` are those that an answer needs to be right."""
    answered = found.status == "answered"
    rows = tuple(
        _row(name, key, found.values.get(name), digits)
        if answered
        else _without(name, key, found.status, found.message)
        for name, key in one.answers.items()
    )
    ignored = tuple(sorted(found.values.keys() - one.answers.keys()))
    return Judged(one.name, found.status, found.message, found.seconds, found.cpu_seconds, rows, ignored)


def lost(now: Iterable[Judged], before: Iterable[Judged]) -> Iterator[str]:
    """Quantities with fewer digits than a baseline has, or none where it has some; of the problems that both hold."""
    known = {(one.problem, row.quantity): row for one in before for row in one.rows}
    for one in now:
        for row in one.rows:
            old = known.get((one.problem, row.quantity))
            if old is None or old.digits is None:
                continue
            if row.digits is None or row.answered < old.answered:
                yield f"{one.problem}: {row.quantity}: {row.status}, {old.digits:.1f} digits before"
            elif row.digits < old.digits - LOST:
                yield f"{one.problem}: {row.quantity}: {row.digits:.1f} digits, {old.digits:.1f} before"


def _row(name: str, key: Certified, given: Any, digits: float) -> Digits:
    values, needed = given if isinstance(given, list) else [given], len(key.value)
    if values and all(value is None for value in values):
        return _without(name, key, "missing")
    shown = repr(given) if len(repr(given)) < SHOWN else repr(given)[: SHOWN - 3] + "..."
    if any(isinstance(value, str | bool | dict) for value in values):
        return _without(name, key, "not a number", shown)
    if any(isinstance(value, list) for value in values) or len(values) != needed:
        return _without(name, key, "wrong shape", f"{needed} numbers are needed, not {shown}")
    if not all(value is None or _finite(value) for value in values):
        return _without(name, key, "not a number", shown)
    compared = zip(values, key.value, key.uncertainty, strict=True)
    known = [(abs(value - exact), spread) for value, exact, spread in compared if value is not None]
    error, spread = (max(column) / key.scale for column in zip(*known, strict=True))
    over = max((miss / spread for miss, spread in known if spread > 0), default=None)
    reached = max(0.0, min(MOST_DIGITS, -math.log10(max(error, spread, 10.0**-MOST_DIGITS))))
    status, message = RIGHT if reached >= digits else "wrong", ""
    if len(known) < needed:
        status, message = "missing", f"{needed - len(known)} of {needed} values"
    return Digits(name, status, message, reached, error, over, len(known), needed)


def _without(name: str, key: Certified, status: str, message: str = "") -> Digits:
    return Digits(name, status, message, None, None, None, 0, len(key.value))


def _finite(value: float) -> bool:
    """Whether the number fits a double: JSON and Python have integers that do not."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False
