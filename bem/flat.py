"""Flat profiles: two flat surfaces have an exact answer at every target, and nothing is solved.

The surfaces are apart (separation > 0) or in complete contact (separation 0) under a uniform pressure, which only the
load, or the mean compression of a layer, determines.  With adhesion complete contact carries any tension, because no
crack can grow; without adhesion complete contact carries no tension.
"""

from __future__ import annotations

import math
from importlib import import_module
from typing import Any

from bem.audit.certificate import Certificate
from bem.certified_states import EXACT
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
        state = _flat_state(scene, target, compliance, joined)
        place: dict[str, Any] = {
            "branch": "loading" if state.penetration >= deepest else "unloading",
            "target": True,
            "index": index,
        }
        if state.status == "unreachable":
            name = f"target {index + 1} of {len(loading.targets)}"
            reason = sentence(flat_apart(), name, loading.control, target)
            record.miss(state, certificate=Certificate(ok=False, reasons=(reason,)), **place)
            continue
        record.add(state, {}, **place)
        deepest, joined = state.penetration, state.status == "complete_contact"
    return record.result(*verdict(record.states))


def _flat_state(scene: Scene, target: float, compliance: float | None, joined: bool) -> State:
    """Return the state at a target; `joined` says whether the surfaces were in contact before."""
    control = scene.loading.control
    if control == "mean_pressure":
        sticks = scene.adhesion is not None and joined
        if target < 0 and not sticks:
            return _unreachable(0.0)
        return _complete(scene, target, None if compliance is None else compliance * target)
    height = -target if control == "separation" else target
    if height < 0 and not (control == "total_displacement" and joined and scene.adhesion is not None):
        return State(
            status="separated",
            penetration=height,
            separation=-height,
            total_displacement=None if compliance is None else height,
            largest_gap=-height,
            gaps=GapNumbers(-height, -height, GapQuantiles(*[-height] * 5), scene.surface().period, 1.0),
            error_estimate=EXACT,
        )
    if control == "total_displacement" and compliance:
        return _complete(scene, height / compliance, height)
    if height > 0:
        return _unreachable(height)
    return _complete(scene, math.nan, None if compliance is None else 0.0)


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


def _unreachable(penetration: float) -> State:
    """Return the row of a target at which flat surfaces have no state."""
    return State(
        status="unreachable",
        penetration=penetration,
        separation=-penetration,
        mean_pressure=math.nan,
        largest_gap=-penetration,
        error_estimate=EXACT,
    )
