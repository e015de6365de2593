"""Problems as they are shipped: problem.toml and answers.json of problems/NAME, with answers.csv beside them.

problem.toml holds plain SI numbers; what a solver gets is that file as a dictionary, its lists of numbers as arrays.
answers.json holds the certified answers: values with uncertainties and a scale, how they were made, and the second
routes beside them; answers.csv one line for each number.  The scale of a quantity is the largest of its values; that of
a count is 1.
"""

import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from validation.harness.case import CaseError
from validation.harness.schema import Cells
from validation.report.figures import csv_text

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
    order = ("unit", "value", "uncertainty", "scale", "made", "second_routes")
    answers = {}
    for name, one in key.answers.items():
        content = asdict(one) | {"scale": scale_of(name, one.value)}
        answers[name] = {field: content[field] for field in order}
    return json.dumps({"schema": SCHEMA, "problem": key.problem, "answers": answers}, indent=1) + "\n"


def csv_of(key: Key) -> str:
    """answers.csv."""
    lines: Iterator[Cells] = (
        [key.problem, name, index, repr(value), f"{uncertainty:.2g}", one.unit]
        for name, one in key.answers.items()
        for index, (value, uncertainty) in enumerate(zip(one.value, one.uncertainty, strict=True))
    )
    return csv_text(CSV_COLUMNS, lines)


def key_of(content: Mapping[str, Any]) -> Key:
    """What answers.json holds."""
    return Key(content["problem"], TypeAdapter(dict[str, Certified]).validate_python(content["answers"]))


FOLDER = Path(__file__).parent / "problems"
PROBLEM_FILE = "problem.toml"
NAMES = (  # easy ones first
    "westergaard",
    "complete-contact",
    "johnson-loop",
    "rippled-wave",
    "two-crests-thick",
    "three-crests",
    "two-crests-thin",
    "rough-100",
    "rough-1000",
    "near-complete",
    "rough-adhesion",
    "scan",
    "thin-incompressible",
    "steep",
    "paper-profile",
)


class ChallengeError(CaseError):
    """A problem, solver, submission or baseline that does not exist or cannot be read."""


@dataclass(frozen=True)
class Shipped:
    """A problem: its name, the text of problem.toml, and the certified answers."""

    name: str
    text: str
    key: Key

    @property
    def data(self) -> dict[str, Any]:
        """problem.toml as plain Python."""
        return tomllib.loads(self.text)


def problem(name: str) -> Shipped:
    """A shipped problem; ChallengeError where there is none of this name.

    Examples
    --------
    >>> problem("westergaard").data["solid"]
    {'youngs_modulus': 1000000.0, 'poisson_ratio': 0.5}
    """
    if name not in NAMES:
        raise ChallengeError(f"problem {name!r}: one of {', '.join(NAMES)} is needed")
    folder = resources.files("validation.challenge").joinpath("problems", name)
    content = json.loads(folder.joinpath("answers.json").read_text("utf-8"))
    return Shipped(name, folder.joinpath(PROBLEM_FILE).read_text("utf-8"), key_of(content))
