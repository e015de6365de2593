"""The path of a flat profile through its targets: exact answers, as a result like any other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bem.certified_states import flat_state
from bem.flat import flat_states
from bem.missed import flat_apart, said_of, verdict
from bem.record import Record
from bem.scene.result import Result
from bem.scene.scene import Scene


def solve_flat(scene: Scene) -> Result:
    """Two flat surfaces: exact answers."""
    work = 0.0 if scene.adhesion is None else scene.adhesion.work_of_adhesion
    record, last, loading = Record(scene), -np.inf, scene.loading
    for index, flat in enumerate(flat_states(scene)):
        branch = "loading" if flat.penetration >= last else "unloading"
        if flat.status == "unreachable":
            target = loading.targets[index]
            reason = said_of(flat_apart(), f"target {index + 1} of {len(loading.targets)}", loading.control, target)
            state = flat_state(flat, -work, branch)
            record.miss(replace(state, certificate=replace(state.certificate, reasons=(reason,))))
            continue
        record.add(flat_state(flat, -work, branch), {})
        last = flat.penetration
    return record.result(*verdict(record.states))
