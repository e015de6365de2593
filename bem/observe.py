"""Fields that a scene asks for at a target, by the names of fields.npz; nothing else is imported or computed."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from bem.collocation import Evaluation
from bem.problem import Problem
from bem.scene import Scene


def fields_of(
    scene: Scene, problem: Problem, state: Evaluation | None, target: float, index: int
) -> dict[str, NDArray[Any]]:
    """Arrays of fields.npz for stored shape `index`, SI units; empty when nothing is asked for."""
    return {}
