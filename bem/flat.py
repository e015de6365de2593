"""Flat profiles: two flat surfaces have an exact answer at every target, and nothing is solved.

The surfaces are apart (separation > 0) or in complete contact (separation 0) under a uniform pressure, which only the
load, or the mean compression of a layer, determines.  With adhesion complete contact carries any tension, because no
crack can grow; without adhesion complete contact carries no tension.
"""

from __future__ import annotations

import math
from importlib import import_module
from typing import Any

from bem.certified_states import EXACT, missed_state
from bem.missed import flat_apart, sentence, verdict
from bem.record import Record
from bem.scene.elastic_tables import elastic_effects
from bem.scene.result import Result
from bem.scene.scene import Scene
from bem.scene.state import CLOSED, GapNumbers, GapQuantiles, State


def solve_flat(scene: Scene) -> Result:
    """Return the states of two flat surfaces at all targets."""
    effects, compliance = elastic_effects(scene), None
    if effects:
        compliance = import_module("bem.elastic.compliance").mean_compliance(effects.values())
    record, deepest, loading = Record(scene), -math.inf, scene.loading
    joined = loading.initial == "complete_contact"
    for index, target in enumerate(loading.targets):
        state, branch = _flat_state(scene, target, compliance, joined), "loading"
        if state is not None:
            branch = "loading" if state.penetration >= deepest else "unloading"
        place: dict[str, Any] = {"branch": branch, "target": True, "index": index}
        if state is None:
            reason = sentence(flat_apart(), f"target {index + 1} of {len(loading.targets)}", loading.control, target)
            apart = _apart(scene, 0.0, compliance)
            record.miss(missed_state(loading.control, target, "unreachable", reason, apart), **place)
            continue
        record.add(state, {}, **place)
        deepest, joined = state.penetration, state.status == "complete_contact"
    return record.result(*verdict(record.states))


def _flat_state(scene: Scene, target: float, compliance: float | None, joined: bool) -> State | None:
    """Return the state at a target, None without one; `joined` says whether the surfaces were in contact before."""
    control = scene.loading.control
    sticks = scene.adhesion is not None and joined
    if control == "mean_pressure":
        total = None if compliance is None else compliance * target
        return _complete(scene, target, total) if target >= 0 or sticks else None
    height = -target if control == "separation" else target
    if height < 0 and not (control == "total_displacement" and sticks):
        return _apart(scene, height, compliance)
    if control == "total_displacement" and compliance:
        return _complete(scene, height / compliance, height)
    return None if height > 0 else _complete(scene, math.nan, None if compliance is None else 0.0)


def _apart(scene: Scene, height: float, compliance: float | None) -> State:
    """Return surfaces apart at a penetration `height` <= 0."""
    gap = 0.0 - height
    return State(
        status="separated",
        penetration=height,
        separation=gap,
        total_displacement=None if compliance is None else height,
        largest_gap=gap,
        gaps=GapNumbers(gap, gap, GapQuantiles(*[gap] * 5), scene.surface().period, 1.0),
        error_estimate=EXACT,
    )


def _complete(scene: Scene, mean_pressure: float, total: float | None) -> State:
    """Return complete contact; the pressure is nan where any would do."""
    work = 0.0 if scene.adhesion is None else -scene.adhesion.work_of_adhesion
    return State(
        status="complete_contact",
        penetration=0.0,
        separation=0.0,
        total_displacement=total,
        mean_pressure=mean_pressure,
        contact_fraction=1.0,
        adhesion_energy=work,
        total_energy=work,
        peak_pressure=None if math.isnan(mean_pressure) else mean_pressure,
        largest_gap=0.0,
        gaps=CLOSED,
        error_estimate=EXACT,
    )
