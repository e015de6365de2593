"""Certified answers: values with uncertainties and a scale, how they were made, and the second route beside them.

answers.json holds all of it, answers.csv one line for each number (problem, quantity, index, value, uncertainty, unit).
The scale of a quantity is the largest of its values; that of a count is 1.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from pydantic import TypeAdapter

SCHEMA = "linecontact-challenge-answers/1"
CSV_COLUMNS = ("problem", "quantity", "index", "value", "uncertainty", "unit")
COUNTS = ("patches",)


@dataclass(frozen=True)
class Check:
    """A second route to a quantity, and how far its values are from the answers, (n,) in the unit of the quantity."""

    route: str
    difference: tuple[float, ...]


@dataclass(frozen=True)
class Certified:
    """The answer to one quantity: values and uncertainties (n,), unit, and what agrees with it."""

    unit: str
    value: tuple[float, ...]
    uncertainty: tuple[float, ...]
    made: str
    second_routes: tuple[Check, ...]


@dataclass(frozen=True)
class Key:
    """The answers to a problem, by the names of what is asked."""

    problem: str
    answers: dict[str, Certified]


def scale_of(quantity: str, values: Sequence[float]) -> float:
    """What errors of a quantity are divided by.

    Examples
    --------
    >>> scale_of("patches", [3.0, 7.0]), scale_of("contact_fraction", [0.1, 0.3])
    (1.0, 0.3)
    """
    return 1.0 if quantity in COUNTS else max(map(abs, values)) or 1.0


def json_of(key: Key) -> str:
    """answers.json."""
    answers: dict[str, Any] = {}
    for name, one in key.answers.items():
        answers[name] = {
            "unit": one.unit,
            "value": one.value,
            "uncertainty": one.uncertainty,
            "scale": scale_of(name, one.value),
            "made": one.made,
            "second_routes": [asdict(check) for check in one.second_routes],
        }
    return json.dumps({"schema": SCHEMA, "problem": key.problem, "answers": answers}, indent=1) + "\n"


def csv_of(key: Key) -> str:
    """answers.csv."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(CSV_COLUMNS)
    for name, one in key.answers.items():
        for index, (value, uncertainty) in enumerate(zip(one.value, one.uncertainty, strict=True)):
            writer.writerow((key.problem, name, index, repr(value), f"{uncertainty:.2g}", one.unit))
    return stream.getvalue()


def key_of(content: Mapping[str, Any]) -> Key:
    """What answers.json holds."""
    return Key(content["problem"], TypeAdapter(dict[str, Certified]).validate_python(content["answers"]))
