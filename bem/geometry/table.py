"""Frozen tables of a scene, such as `Solid` or `Layer`: types and ranges are checked where a table is made.

A table is a pydantic dataclass.  Types are strict: no text or truth value passes for a number.  Numbers and arrays of
NumPy count as numbers and lists.  `TableError` lists every mistake with the key, the value and the allowed values in
words of bem/scene/keys.toml.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import lru_cache, wraps
from pathlib import Path
from typing import Any, TypeVar, dataclass_transform

import numpy as np
from pydantic import ConfigDict, Field, ValidationError
from pydantic.dataclasses import dataclass as checked_dataclass

from bem.geometry.lengths import LENGTH_UNITS
from bem.geometry.ranges import RANGES, Mistake, shown, unknown_key

WORDS = Path(__file__).parents[1] / "scene" / "keys.toml"
REMOVED = {
    "output.cut_sensitivity": "leave it out: `linecontact study scene` solves the scene with other cuts",
    "output.width_distributions": "leave it out: widths are differences of `edges`, which every state has",
    "output.contact_slopes": "leave it out: slopes of the profile between `edges`, which every state has",
}
CONFIG = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)

Kind = TypeVar("Kind")


class TableError(ValueError):
    """Error of a table that cannot be made: `mistakes` of its keys, `valid` values of the other keys."""

    def __init__(self, mistakes: list[Mistake], valid: dict[str, Any]) -> None:
        self.mistakes, self.valid = mistakes, valid
        super().__init__("; ".join(map(str, mistakes)))


@dataclass_transform(frozen_default=True)
def table(name: str) -> Callable[[type[Kind]], type[Kind]]:
    """Return the decorator of the frozen, checked class of the table [name]."""

    def decorate(plain_class: type[Kind]) -> type[Kind]:
        made: Any = checked_dataclass(plain_class, frozen=True, config=CONFIG)
        unchecked = made.__init__

        @wraps(unchecked)
        def checked(self: Any, *values: Any, **named: Any) -> None:
            keys = [item.name for item in fields(made)]
            twice = [key for key in keys[: len(values)] if key in named]
            if len(values) > len(keys) or twice:
                fault = f"{', '.join(twice)} given twice" if twice else f"{len(values)} values given"
                raise TypeError(f"{made.__name__}: {fault}; it takes {', '.join(keys)}")
            given = {key: plain(value) for key, value in (*zip(keys, values, strict=False), *named.items())}
            try:
                unchecked(self, **given)
            except ValidationError as error:
                raise _table_error(name, keys, given, error) from None

        made.__init__ = checked
        return made  # type: ignore[no-any-return]

    return decorate


def limits(path: str) -> Any:
    """Return the limits of a number of `RANGES` as pydantic takes them."""
    return Field(**RANGES[path].limits)


def plain(value: Any) -> Any:
    """Return a value as in a TOML file: lists, numbers and tables instead of arrays, tuples and objects."""
    if is_dataclass(value) and not isinstance(value, type):
        items = {item.name: plain(getattr(value, item.name)) for item in fields(value)}
        return {key: item for key, item in items.items() if item is not None}
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


@lru_cache(maxsize=1)
def words() -> dict[str, dict[str, Any]]:
    """Return the words of all tables and keys."""
    return tomllib.loads(WORDS.read_text("utf-8").replace("LENGTH_UNITS", LENGTH_UNITS))


def allowed(path: str) -> str:
    """Return the allowed values of a key in words.

    Examples
    --------
    >>> allowed("solid.poisson_ratio"), allowed("adhesion.slope_term")
    ('a number > -1 and <= 0.5', 'true or false')
    """
    name, key = path.split(".")
    return str(words()[name][key].get("allowed") or RANGES[path].words)


def _table_error(name: str, keys: list[str], given: dict[str, Any], error: ValidationError) -> TableError:
    """Return the mistakes of a table, one for each wrong key or item of a list."""
    items: dict[str, set[int]] = {}
    for mistake in error.errors():
        key, *rest = mistake["loc"]
        items.setdefault(str(key), set()).update(part for part in rest if isinstance(part, int))
    mistakes: list[Mistake] = []
    for key, wrong in items.items():
        path = f"{name}.{key}"
        if path in REMOVED:
            mistakes.append(Mistake(path, f"= {shown(given[key])} is no longer a key", REMOVED[path]))
        elif key not in keys:
            mistakes.append(Mistake(path, f"= {shown(given[key])} is unknown", unknown_key(key, keys)))
        elif key not in given:
            mistakes.append(Mistake(path, "is missing", allowed(path)))
        elif wrong:
            mistakes += [Mistake(f"{path}[{k}]", f"= {shown(given[key][k])}", allowed(path)) for k in sorted(wrong)]
        else:
            mistakes.append(Mistake(path, f"= {shown(given[key])}", allowed(path)))
    return TableError(mistakes, {key: value for key, value in given.items() if key not in items})
