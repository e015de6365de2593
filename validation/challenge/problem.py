"""Problems as they are shipped: problem.toml and answers.json of problems/NAME.

problem.toml holds plain SI numbers; what a solver gets is that file as a dictionary, its lists of numbers as arrays.
"""

from __future__ import annotations

import json
import tomllib
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from validation.challenge.answers import Key, key_of
from validation.harness.case import CaseError

FOLDER = Path(__file__).parent / "problems"
PROBLEM_FILE = "problem.toml"
NAMES = (
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


def names() -> tuple[str, ...]:
    """All problems, easy ones first."""
    return NAMES


def problem(name: str) -> Shipped:
    """A shipped problem; ChallengeError where there is none of this name.

    Examples
    --------
    >>> problem("westergaard").data["solid"]
    {'youngs_modulus': 1000000.0, 'poisson_ratio': 0.5}
    """
    if name not in names():
        raise ChallengeError(f"problem {name!r}: one of {', '.join(names())} is needed")
    folder = resources.files("validation.challenge").joinpath("problems", name)
    content = json.loads(folder.joinpath("answers.json").read_text("utf-8"))
    return Shipped(name, folder.joinpath(PROBLEM_FILE).read_text("utf-8"), key_of(content))
