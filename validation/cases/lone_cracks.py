"""The last gaps without adhesion, just below the load of complete contact: each a lone crack in closed form.

A gap is held open by the tension -p_0 - q(x) that complete contact would have there (hard_case_crack.py), without
stress intensity at its ends: about the lowest pressure -Q of q its half width is 2 sqrt((Q - p_0)/q'').  Tension that
the solver takes for contact closes it.  Two gaps of equal depth, on the way to them, and after them complete contact.
SI units.  Limits: gaps as narrow as the row of cracks allows, (c/period)^2 = 3e-5 at the lowest load here.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

import bem
from bem.result import State
from validation import adapters
from validation.case import Case, Outcome
from validation.cases.fault_gaps import compared
from validation.cases.hard_case_crack import crack
from validation.schema import Reference, Row

PERIOD, MODULUS = 0.01, 1e6 / 0.75
ORDERS, AMPLITUDES = (1, 2), (1e-4, 1e-4)
BELOW = (1e-3, 1e-4, 1e-5, 1.3e-6, -1e-6)  # of the load of complete contact
MEASURED_SEPARATION_FROM = 1e-5  # nearer to complete contact the separation is a difference of rounded heights


def _pressure(x: float) -> float:
    """Pressure of complete contact in Pa less its mean."""
    return sum(
        MODULUS * np.pi * m * h / PERIOD * float(np.cos(2 * np.pi * m * x / PERIOD))
        for m, h in zip(ORDERS, AMPLITUDES, strict=True)
    )


def _gaps(state: State) -> list[tuple[float, float]]:
    """Where the gaps of a state begin and end, m."""
    left = [a for a, _ in state.edges]
    return [(b, a) for (_, b), a in zip(state.edges, [*left[1:], left[0] + PERIOD], strict=True)]


def _lone_cracks() -> Outcome:
    lowest = minimize_scalar(_pressure, bounds=(0.0, PERIOD / 2), method="bounded", options={"xatol": 1e-14})
    complete = -float(lowest.fun)
    loads = [complete * (1 - below) for below in BELOW]
    changes: dict[str, Any] = {
        "adhesion": None,
        "profile": {"orders": list(ORDERS), "amplitudes": list(AMPLITUDES), "phases": [0.0, 0.0]},
        "loading": {"control": "mean_pressure", "targets": loads},
    }
    posed = adapters.scene("sinusoid", changes)
    states = bem.solve(posed).targets
    exact = Reference(kind="exact", source="a lone crack at each of two equal minima of the pressure")
    tension, opened, separation, summed = [], [], [], []
    for below, load, state in zip(BELOW, loads, states, strict=False):
        if not state.edges:
            continue
        cracks = [crack(posed.surface(), MODULUS, 0.0, *ends) for ends in _gaps(state)]
        tension += [1.0] * len(cracks)
        opened += [(complete - pressure) / (complete - load) for pressure, _ in cracks]
        if below >= MEASURED_SEPARATION_FROM:
            separation.append(1.0)
            summed.append(state.separation / sum(opening for _, opening in cracks))
    rows: tuple[Row, ...] = (
        compared(
            "patches, and contact fraction 1 behind the load of complete contact",
            "",
            exact,
            [2.0, 2.0, 2.0, 2.0, 0.0, 1.0],
            [*(float(state.n_patches) for state in states), float(states[-1].contact_fraction)],
            0.1,
            0.0,
        ).model_copy(update={"pinned": "exact"}),
        compared(
            "load that is missing to complete contact, from the ends of every gap, over that of the target",
            "",
            exact,
            tension,
            opened,
            *MEASURED_TENSION,
        ),
        compared(
            "separation, over what the gaps hold",
            "",
            exact,
            separation,
            summed,
            *MEASURED_SEPARATION,
        ),
    )
    return Outcome(rows=rows, counts={"evaluations": sum(state.evaluations for state in states)})


MEASURED_TENSION, MEASURED_SEPARATION = (2.2e-4, 8.8e-5), (1.4e-3, 5.4e-4)

CASES = (
    Case(
        id="lone-cracks",
        group="closed forms",
        level="quick",
        question="Do the last gaps without adhesion stay open as long as contact would be in tension there?",
        equations="K(+-c) = 0 under the tension -p_0 - q(x);  c = 2 sqrt((Q - p_0) / q'')",
        sources=("johnson1995",),
        compute=_lone_cracks,
        effects=("half_space", "load_control"),
        scene=adapters.scene_text("sinusoid"),
    ),
)
