"""A flat profile: nothing to solve, every question has an exact answer.

Two flat surfaces are apart (separation > 0) or in complete contact (separation 0) under a uniform pressure, which
only the load, or the mean compression of a layer, shows.  With adhesion complete contact carries any tension, because
no crack is there to grow; without it none.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib import import_module
from typing import Literal

from bem.scene.elastic_tables import elastic_effects
from bem.scene.scene import Scene


@dataclass(frozen=True)
class FlatState:
    """What two flat surfaces do at a target, SI units; the pressure is nan where any would do."""

    status: Literal["separated", "complete_contact", "unreachable"]
    penetration: float
    mean_pressure: float
    total_displacement: float | None


def flat_states(scene: Scene) -> list[FlatState]:
    """The state at each target of a scene with a flat profile."""
    states: list[FlatState] = []
    effects, compliance = elastic_effects(scene), None
    if effects:
        compliance = import_module("bem.elastic.compliance").mean_compliance(effects.values())
    joined = scene.loading.initial == "complete_contact"
    for target in scene.loading.targets:
        state = _flat_state(scene, target, compliance, joined)
        states.append(state)
        if state.status != "unreachable":
            joined = state.status == "complete_contact"
    return states


def _flat_state(scene: Scene, target: float, compliance: float | None, joined: bool) -> FlatState:
    """One target: `joined` says whether the surfaces were in contact before."""
    control = scene.loading.control
    if control == "mean_pressure":
        sticks = scene.adhesion is not None and joined
        if target < 0 and not sticks:
            return FlatState("unreachable", 0.0, math.nan, None)
        total = None if compliance is None else compliance * target
        return FlatState("complete_contact", 0.0, target, total)
    height = -target if control == "separation" else target
    if height < 0 and not (control == "total_displacement" and joined and scene.adhesion is not None):
        return FlatState("separated", height, 0.0, None if compliance is None else height)
    if control == "total_displacement" and compliance:
        return FlatState("complete_contact", 0.0, height / compliance, height)
    if height > 0:
        return FlatState("unreachable", height, math.nan, None)
    return FlatState("complete_contact", 0.0, math.nan, None if compliance is None else 0.0)
