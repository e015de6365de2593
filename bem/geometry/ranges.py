"""Ranges of the numbers that a user gives, in scene files and in Python, with the words of their error messages.

A range holds for a number, or for every item of a list; no range holds NaN.  Magnitudes in SI units lie between `LEAST`
and `MOST`, so that no product of them leaves double precision.
"""

from __future__ import annotations

import difflib
import json
import math
import numbers
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

MOST_HARMONICS = 1_000_000  # limit: 15 GB of tables, by 1.5 GB for a tenth of them
MOST_SEED = 2**128 - 1  # format: what NumPy draws where none is given
LEAST, MOST = 1e-60, 1e60  # derived: SI magnitudes: no product of them leaves double precision; the same from above
POSITIVE = f"a finite number > 0, from {LEAST:g} to {MOST:g}"


@dataclass(frozen=True)
class Range:
    """Range of numbers and its words; limits as pydantic names them, none where infinite."""

    words: str
    ge: float = -math.inf
    gt: float = -math.inf
    le: float = math.inf
    lt: float = math.inf
    whole: bool = False

    @property
    def limits(self) -> dict[str, Any]:
        """Limits that are finite, by their names."""
        named = {"ge": self.ge, "gt": self.gt, "le": self.le, "lt": self.lt}
        return {name: limit for name, limit in named.items() if math.isfinite(limit)}

    def holds(self, value: Any) -> bool:
        """Return whether a value is a number in the range; truth values and texts are no numbers."""
        if isinstance(value, bool) or not isinstance(value, numbers.Integral if self.whole else numbers.Real):
            return False
        number: Any = value if isinstance(value, numbers.Integral) else float(value)  # integers may be too large for it
        return bool(-math.inf < number < math.inf and self.ge <= number <= self.le and self.gt < number < self.lt)


RANGES = {
    "solid.youngs_modulus": Range(f"{POSITIVE} (Pa)", ge=LEAST, le=MOST),
    "solid.poisson_ratio": Range("a number > -1 and <= 0.5", gt=-1, le=0.5),
    "profile.period": Range(f"{POSITIVE} (m)", ge=LEAST, le=MOST),
    "profile.hurst": Range("a number > 0 and < 1", gt=0, lt=1),
    "profile.rms_height": Range(f"{POSITIVE} (m)", ge=LEAST, le=MOST),
    "profile.harmonics": Range(f"an integer from 1 to {MOST_HARMONICS}", ge=1, le=MOST_HARMONICS, whole=True),
    "profile.seed": Range("an integer from 0 to 2^128 - 1", ge=0, le=MOST_SEED, whole=True),
    "profile.orders": Range(
        f"a list of distinct integers from 1 to {MOST_HARMONICS}", ge=1, le=MOST_HARMONICS, whole=True
    ),
    "profile.amplitudes": Range("a list of finite numbers (m), as many as orders", ge=-MOST, le=MOST),
    "profile.phases": Range("a list of finite numbers (radians), as many as orders", ge=-MOST, le=MOST),
    "layer.thickness": Range(f"{POSITIVE} (m)", ge=LEAST, le=MOST),
    "adhesion.work_of_adhesion": Range(f"{POSITIVE} (J/m^2)", ge=LEAST, le=MOST),
    "penetration": Range("a finite number (m)", ge=-MOST, le=MOST),
}


@dataclass(frozen=True)
class Mistake:
    """Mistake in a scene: path of the key, wrong content, allowed values.

    Examples
    --------
    >>> print(Mistake("layer.thickness", "= -1.0", "a finite number > 0 (m)"))
    layer.thickness = -1.0; allowed: a finite number > 0 (m)
    """

    path: str
    found: str
    allowed: str

    def __str__(self) -> str:
        return f"{self.path} {self.found}; allowed: {self.allowed}"


def as_said(limit: float) -> float:
    """Return a limit rounded as a message prints it, so that the printed number is itself allowed.

    Examples
    --------
    >>> 1e-5 * 0.01, as_said(1e-5 * 0.01)
    (1.0000000000000001e-07, 1e-07)
    """
    return float(f"{limit:g}")


def shown(value: Any) -> str:
    """Return a value as in the scene file, shortened."""
    try:
        text = json.dumps(value, default=str, ensure_ascii=False)
    except (ValueError, RecursionError):
        text = "a value too long to show"
    return text if len(text) <= 60 else f"{text[:56]} ..."


def unknown_key(name: str, known: Collection[str]) -> str:
    """Return the allowed keys instead of an unknown key: all that begin with it, else the closest one, else all.

    Examples
    --------
    >>> print(unknown_key("cutoff", ["cutoff_short", "cutoff_long", "hurst"]))
    "cutoff_short" or "cutoff_long", by its name
    """
    begun = [key for key in known if name and key.startswith(name)]
    close = begun or difflib.get_close_matches(name, known, n=1, cutoff=0.4)
    return f"{' or '.join(map(json.dumps, close))}, by its name" if close else "one of " + ", ".join(known)


def refuse(*mistakes: Mistake) -> None:
    """Raise ValueError with all mistakes, if there are any."""
    if mistakes:
        raise ValueError("; ".join(map(str, mistakes)))


def check(**values: Any) -> None:
    """Refuse numbers outside their ranges; a table and its key are joined by `__`.

    Raises
    ------
    ValueError
        With every mistake.

    Examples
    --------
    >>> check(profile__hurst=0.7, profile__seed=3)
    >>> check(profile__hurst=1.7)
    Traceback (most recent call last):
    ValueError: profile.hurst = 1.7; allowed: a number > 0 and < 1
    """
    given = {name.replace("__", "."): value for name, value in values.items()}
    refuse(
        *(
            Mistake(path, f"= {shown(value)}", RANGES[path].words)
            for path, value in given.items()
            if not RANGES[path].holds(value)
        )
    )


def check_harmonics(orders: Any, amplitudes: Any, phases: Any) -> None:
    """Refuse lists of harmonics that a scene refuses.

    Raises
    ------
    ValueError
        With the first wrong item of each list, or because the lists do not go together.
    """
    given = {"orders": np.asarray(orders), "amplitudes": np.asarray(amplitudes), "phases": np.asarray(phases)}
    refuse(*(mistake for name, items in given.items() for mistake in _wrong_items(f"profile.{name}", items)))
    refuse(*harmonic_mistakes(given))


def _wrong_items(path: str, items: np.ndarray[Any, Any]) -> Iterator[Mistake]:
    """Yield a mistake for the first item of a list outside its range, if there is one."""
    allowed = RANGES[path]
    if items.ndim != 1 or not items.size or items.dtype.kind not in ("iu" if allowed.whole else "iuf"):
        yield Mistake(path, f"= {shown(items.tolist())}", allowed.words)
        return
    wrong = np.flatnonzero(~((items >= allowed.ge) & (items <= allowed.le)))
    if wrong.size:
        yield Mistake(f"{path}[{wrong[0]}]", f"= {shown(items[wrong[0]].item())}", allowed.words)


def harmonic_mistakes(values: Mapping[str, Any]) -> Iterator[Mistake]:
    """Yield mistakes of orders, amplitudes and phases: lists of different lengths, and orders that repeat."""
    lengths = {key: len(values[key]) for key in ("orders", "amplitudes", "phases") if key in values}
    if len(set(lengths.values())) > 1:
        counted = ", ".join(f"{count} {key}" for key, count in lengths.items())
        yield Mistake("profile.orders", f"and its companions differ in length ({counted})", "lists of equal length")
    distinct, count = np.unique(np.asarray(values.get("orders", ()), dtype=np.int64), return_counts=True)
    if distinct.size < lengths.get("orders", 0):
        yield Mistake("profile.orders", f"repeats {shown(distinct[count > 1].tolist())}", "distinct integers >= 1")
