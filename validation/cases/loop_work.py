"""The work of loops under every control is what their events release.

With F the force conjugate to the controlled v, and Phi the energy that an equilibrium minimises,

    penetration, separation: v = Delta, F = p, Phi = U;        mean pressure: v = p, F = -Delta, Phi = U - p Delta;
    total displacement: v = Delta + c(0) p, F = p, Phi = U + c(0) p^2 / 2,

dPhi = F dv on branches, and a jump at constant v lowers Phi by what it releases.  So int F dv of a path is the growth
of Phi and the energies of its events.  Between states without events the integral is Hermite's with the stiffness of
the states; beside events the tangent is followed to the first, and from the last the parabola that meets the next state
with its slope.  SI units.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import bem
from bem.result import Event, Result, State
from validation import adapters
from validation.case import Case, Outcome
from validation.cases.fault_gaps import compared
from validation.cases.loading_history import legs
from validation.schema import Reference, Table

POISSON_RATIO, THICKNESS = 0.3, 1e-3
LOOPS: dict[str, tuple[float, float]] = {  # there, back, and there again
    "separation": (40e-6, 88e-6),
    "penetration": (40e-6, -8e-6),
    "mean_pressure": (1.2e4, -450.0),
    "total_displacement": (45e-6, -8e-6),
}
INCREMENTS = {"separation": 0.04, "penetration": 0.04, "mean_pressure": 0.4, "total_displacement": 0.04}
COMPLIANCE = THICKNESS * (1 - 2 * POISSON_RATIO) * (1 + POISSON_RATIO) / (1e6 * (1 - POISSON_RATIO))  # c(0), m/Pa


def _coordinate(control: str, at: State | Event) -> tuple[float, float]:
    """Controlled quantity and its force."""
    if control == "mean_pressure":
        return at.mean_pressure, -at.penetration
    more = COMPLIANCE * at.mean_pressure if control == "total_displacement" else 0.0
    return at.penetration + more, at.mean_pressure


def _force_rate(control: str, state: State) -> float:
    """dF/dv along the branch."""
    stiffness = state.contact_stiffness or 0.0
    if control == "mean_pressure":
        return -1 / stiffness if stiffness else 0.0
    return stiffness / (1 + COMPLIANCE * stiffness) if control == "total_displacement" else stiffness


def _potential(control: str, state: State) -> float:
    pressure = state.mean_pressure
    if control == "mean_pressure":
        return state.total_energy - pressure * state.penetration
    return state.total_energy + (COMPLIANCE * pressure**2 / 2 if control == "total_displacement" else 0.0)


def work(control: str, states: Sequence[State], events: Sequence[Event]) -> float:
    """int F dv along states of one direction and the events between them, J/m^2."""
    total = 0.0
    for first, second in pairwise(states):
        (start, force), (stop, last) = _coordinate(control, first), _coordinate(control, second)
        slope, end = _force_rate(control, first), _force_rate(control, second)
        low, high = sorted((start, stop))
        met = [mark for mark in (_coordinate(control, event) for event in events) if low < mark[0] <= high]
        span = stop - start
        if not met:
            total += span * (force + last) / 2 + span**2 * (slope - end) / 12
            continue
        reach, rest = met[0][0] - start, stop - met[-1][0]
        total += reach * (force + reach * slope / 2)
        total += sum((b[0] - a[0]) * (a[1] + b[1]) / 2 for a, b in pairwise(met))
        total += rest * (met[-1][1] + 2 * last - rest * end / 2) / 3
    return total


def _looped(control: str) -> Result:
    there, back = LOOPS[control]
    changes: dict[str, Any] = {
        "solid": {"poisson_ratio": POISSON_RATIO},
        "layer": {"thickness": THICKNESS},
        "adhesion": {"work_of_adhesion": 0.1},
        "loading": {"control": control, "targets": [there, back, there]},
        "accuracy": {"max_increment": INCREMENTS[control], "tolerance": None},
    }
    return bem.solve(adapters.scene("thin_layer", changes))


def _loops() -> Outcome:
    released: list[float] = []
    table: list[list[str | float | None]] = []
    events = 0
    for control in LOOPS:
        result = _looped(control)
        if result.status != "converged":
            released.append(float("nan"))
            continue
        ways = legs(result)[1:]
        done = sum(work(control, leg.states, leg.events) for leg in ways)
        growth = _potential(control, ways[-1].states[-1]) - _potential(control, ways[0].states[0])
        booked = sum(event.energy_released or 0.0 for leg in ways for event in leg.events)
        released.append(booked / (done - growth))
        met = sum(len(leg.events) for leg in ways)
        events += met
        table.append([control, len(result.states), met, *(float(f"{v:.5g}") for v in (done, growth, booked))])
    rows = (
        compared(
            f"energy released over a loop, over what its work leaves: {', '.join(LOOPS)}",
            "",
            Reference(kind="exact", source="first law under every control"),
            [1.0] * len(LOOPS),
            released,
            2.5 * MEASURED_LOOP,
            MEASURED_LOOP,
        ),
    )
    shown = Table(
        caption="Unloading and loading again; energies in J/m^2 of nominal area.",
        columns=["control", "states", "events", "work", "growth of the potential", "energy released"],
        rows=table,
    )
    return Outcome(rows=rows, tables=(shown,), counts={"events": events})


MEASURED_LOOP = 1.3e-3  # the quadrature of the force beside events, not the states

CASES = (
    Case(
        id="loop-work",
        group="path",
        level="quick",
        question="Is what the work of a loop leaves the energy that its events release, whatever is controlled?",
        equations="int F dv = Phi_2 - Phi_1 + energy released, v and F of the control",
        sources=("carbone2009", "carbone2008"),
        compute=_loops,
        effects=("layer", "adhesion", "slope_term", "load_control", "unloading"),
        scene=adapters.scene_text("thin_layer"),
    ),
)
