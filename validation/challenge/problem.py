"""Problems as they are shipped: problem.toml and answers.json of problems/NAME, with answers.csv beside them.

problem.toml holds plain SI numbers; what a solver gets is that file as a dictionary, its lists of numbers as arrays.
answers.json holds the certified answers: values with uncertainties and the scale that errors are divided by, how they
were made, and the second routes beside them; answers.csv one line for each number.  The scale of a quantity is the
largest of its values; that of a count is 1.
"""

import json
import tomllib
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from validation.harness.case import CaseError
from validation.harness.schema import Cells
from validation.report.figures import csv_text

SCHEMA = "linecontact-challenge-answers/1"
CSV_COLUMNS = ("problem", "quantity", "index", "value", "uncertainty", "unit")
COUNTS = ("patches",)
FOLDER = Path(__file__).parent / "problems"
PROBLEM_FILE, ANSWERS_FILE = "problem.toml", "answers.json"
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


@dataclass(frozen=True)
class Check:
    """A second route to a quantity, and how far its values are from the answers, (n,) in the unit of the quantity."""

    route: str
    difference: tuple[float, ...]


@dataclass(frozen=True)
class Certified:
    """The answer to one quantity: values and uncertainties (n,), unit, scale, and what agrees with it."""

    unit: str
    value: tuple[float, ...]
    uncertainty: tuple[float, ...]
    scale: float
    made: str
    second_routes: tuple[Check, ...]


class ChallengeError(CaseError):
    """A problem, solver, submission or baseline that does not exist or cannot be read."""


@dataclass(frozen=True)
class Shipped:
    """A problem: its name, the text of problem.toml, and the certified answers by the names of what is asked."""

    name: str
    text: str
    answers: dict[str, Certified]

    @property
    def data(self) -> dict[str, Any]:
        """problem.toml as plain Python."""
        return tomllib.loads(self.text)

    @property
    def json_text(self) -> str:
        """answers.json."""
        answers = {name: asdict(one) for name, one in self.answers.items()}
        return json.dumps({"schema": SCHEMA, "problem": self.name, "answers": answers}, indent=1) + "\n"

    @property
    def csv_text(self) -> str:
        """answers.csv."""
        lines: Iterator[Cells] = (
            [self.name, name, index, repr(value), f"{uncertainty:.2g}", one.unit]
            for name, one in self.answers.items()
            for index, (value, uncertainty) in enumerate(zip(one.value, one.uncertainty, strict=True))
        )
        return csv_text(CSV_COLUMNS, lines)


def scale_of(quantity: str, values: Sequence[float]) -> float:
    """What errors of a quantity are divided by.

    Examples
    --------
    >>> scale_of("patches", [3.0, 7.0]), scale_of("contact_fraction", [0.1, 0.3])
    (1.0, 0.3)
    """
    return 1.0 if quantity in COUNTS else max(map(abs, values)) or 1.0


def problem(name: str) -> Shipped:
    """A shipped problem; ChallengeError where there is none of this name.

    Examples
    --------
    >>> problem("westergaard").data["solid"]
    {'youngs_modulus': 1000000.0, 'poisson_ratio': 0.5}
    """
    if name not in NAMES:
        raise ChallengeError(f"problem {name!r}: one of {', '.join(NAMES)} is needed")
    content = json.loads((FOLDER / name / ANSWERS_FILE).read_text("utf-8"))
    answers = TypeAdapter(dict[str, Certified]).validate_python(content["answers"])
    return Shipped(name, (FOLDER / name / PROBLEM_FILE).read_text("utf-8"), answers)
