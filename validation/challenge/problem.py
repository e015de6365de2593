"""Problems as they are shipped: problem.toml and answers.json of problems/NAME, and how problem.toml is written.

problem.toml holds plain SI numbers; what a solver gets is that file as a dictionary, its lists of numbers as arrays.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from validation.challenge.answers import Key, key_of
from validation.challenge.posing import LEAST_SAMPLES, MEANINGS, PERIOD, Harmonics, Pose, poses
from validation.harness.arrays import FloatArray
from validation.harness.case import CaseError
from validation.references.fft_solver import on_grid

FOLDER = Path(__file__).parent / "problems"
PROBLEM_FILE = "problem.toml"


class ChallengeError(CaseError):
    """A problem, solver, submission or baseline that does not exist or cannot be read."""


@dataclass(frozen=True)
class Problem:
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
    return tuple(poses())


def problem(name: str) -> Problem:
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
    return Problem(name, folder.joinpath(PROBLEM_FILE).read_text("utf-8"), key_of(content))


def heights(harmonics: Harmonics) -> FloatArray:
    """At x = k period / n, n the least power of two that is more than twice the highest order, (n,) in m."""
    count = max(LEAST_SAMPLES, 2 ** int(np.ceil(np.log2(2 * harmonics[0].max() + 1))))
    return on_grid(PERIOD, harmonics, count)[0]


def toml_of(pose: Pose) -> str:
    """problem.toml of a problem."""
    orders, amplitudes, phases = pose.harmonics
    lines = [
        f"name = {json.dumps(pose.name)}",
        f"title = {json.dumps(pose.title)}",
        f"difficulty = {json.dumps(pose.difficulty)}",
        f"what_is_hard = {json.dumps(pose.hard_part)}",
        "",
        "[solid]  # elastic, plane strain, frictionless, pressed on a rigid profile",
        f"youngs_modulus = {pose.youngs_modulus!r}  # Pa",
        f"poisson_ratio = {pose.poisson_ratio!r}",
    ]
    if pose.thickness is not None:
        lines += [
            "",
            "[layer]  # bonded to a rigid plate; absent: a half-space",
            f"thickness = {pose.thickness!r}  # m",
        ]
    if pose.work_of_adhesion is not None:
        lines += [
            "",
            "[adhesion]  # of infinitely short range (JKR); absent: none",
            f"work_of_adhesion = {pose.work_of_adhesion!r}  # J/m^2",
            f"slope_term = {json.dumps(pose.slope_term)}  # whether a slope h' multiplies it by sqrt(1 + h'^2)",
        ]
    lines += [
        "",
        "[path]  # quasi-static, from surfaces apart through the targets in this order",
        f'control = "{pose.control}"  # penetration: highest point of the profile less separation (mean gap)',
        f"targets = {_listed(pose.targets)}  # {'Pa' if pose.control == 'mean_pressure' else 'm'}",
    ]
    for name, at in _asked(pose):
        unit, meaning = MEANINGS[name]
        lines += ["", f"[asked.{name}]", f"unit = {json.dumps(unit)}", f"meaning = {json.dumps(meaning)}"]
        lines += [f"{word} = {_listed(value) if isinstance(value, list) else value}" for word, value in at.items()]
    lines += [
        "",
        "[profile]  # h(x) = sum of amplitudes * cos(2 pi orders x / period + phases); samples: h at x = k period / n",
        f"period = {PERIOD!r}  # m",
        f"orders = {_listed(orders.tolist())}",
        f"amplitudes = {_listed(amplitudes.tolist())}  # m",
        f"phases = {_listed(phases.tolist())}",
        f"samples = {_listed(heights(pose.harmonics).tolist())}  # m",
    ]
    return "\n".join(lines) + "\n"


def _asked(pose: Pose) -> Iterable[tuple[str, dict[str, Any]]]:
    for asked in pose.asked:
        yield asked if isinstance(asked, tuple) else (asked, {})


def _listed(values: Iterable[float]) -> str:
    return "[" + ", ".join(repr(value) for value in values) + "]"
