"""Hysteresis: what a loop dissipates, state by state and event by event, and the symmetry that a path breaks.

Work balance: int sigma_0 dDelta over a closed loop, integrated from loads alone, is the sum of the energies that its
events release (energy_balance.py).

Seven equal waves in equal contact stay equal while the smallest eigenvalue is positive; the bifurcation is an event,
and no wave alone has one.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import bem
from bem.scene.result import Result
from validation.cases.paths.energy_balance import Account, accounts, closed, legs
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.rows import compared, counted
from validation.harness.schema import Figure, Reference, Row, Table
from validation.references import adapters
from validation.references.closed_forms import Sinusoid


def _history() -> Outcome:
    result, ways = accounts(adapters.scene("hysteresis"))
    apart = result.states[-1]
    loops = [closed(ways[1:3]), closed(ways[1:])]  # 30 um, 70 um, 30 um; and on to 160 um, apart
    balance = Reference(kind="exact", source="first law: work = growth of U + energy released")
    least = min((event.energy_released or 0.0) for event in result.events)
    rows = (
        compared("work of a loop (30, 70, 30 um) and of the way apart, over the largest", "J/m^2", balance,
                 [loop.growth + loop.released for loop in loops], [loop.work for loop in loops], 2.5 * MEASURED_WORK,
                 MEASURED_WORK, "maximum over states", max(abs(loop.work) for loop in loops)),
        counted("least energy released by an event is not negative (1: yes)",
                Reference(kind="exact", source="second law"), [1.0], [float(least >= 0)]),
        compared("energy once the surfaces are apart", "J/m^2",
                 Reference(kind="exact", source="nothing touches, nothing is stored"), [0.0, 0.0],
                 [apart.total_energy, apart.contact_fraction], 1e-15, 0.0, "absolute", basis="required",
                 pinned="exact"),
        *_symmetry(),
    )  # fmt: skip
    return Outcome(
        rows=rows,
        figures=(_figure(result),),
        tables=(_table(result), _loops(loops)),
        counts={"events": len(result.events), "evaluations": sum(state.evaluations for state in result.states)},
    )


def _symmetry() -> tuple[Row, Row]:
    """Seven waves, alpha = 0.3: where the symmetric state is lost on loading, and that one wave never loses it."""
    seventh = Sinusoid(1e-4 / 7, 0.01 / 7, 1e6, 0.5, 0.3)
    events = {}
    for order in (1, 7):
        profile = {"orders": [order], "amplitudes": [1e-4 / order]}
        wave = Sinusoid(1e-4 / order, 0.01 / order, 1e6, 0.5, 0.3)
        deepest = float(wave.penetration(0.9 * np.pi / 2))
        changes: dict[str, Any] = {
            "profile": profile,
            "adhesion": {"work_of_adhesion": wave.work_of_adhesion},
            "loading": {"targets": [0.3 * deepest, deepest]},
            "accuracy": {"tolerance": 1e-6},
        }
        result = bem.solve(adapters.scene("sinusoid", changes))
        events[order] = [event for event in result.events if event.kind == "bifurcation"]
    found = [_fraction(seventh, event.penetration) for event in events[7][:1]]
    return (
        compared("contact fraction at which seven equal contacts lose their symmetry on loading", "",
                 Reference(kind="theory", source="dense prototype, two digits: unstable above 0.76", uncertainty=0.005),
                 [0.76], list(found) or [None], 0.01, MEASURED_SYMMETRY, "absolute"),
        counted("bifurcations of one wave alone on loading",
                Reference(kind="exact", source="Johnson 1995: one branch up to complete contact"), [0.0],
                [float(len(events[1]))]),
    )  # fmt: skip


def _fraction(wave: Sinusoid, penetration: float) -> float:
    """Contact fraction of Johnson's stable branch at a penetration."""
    psi = np.linspace(wave.fold(), 0.97 * np.pi / 2, 20001)
    return float(np.interp(penetration, wave.penetration(psi), psi) * 2 / np.pi)


def _loops(loops: list[Account]) -> Table:
    names = ("loop 30, 70, 30 um", "30 um and apart")
    return Table(caption="Dissipation in J/m^2 of nominal area.",
                 columns=["way", "events", "work", "growth of U", "energy released by events"],
                 rows=[[name, loop.events,
                        *(float(f"{value:.5g}") for value in (loop.work, loop.growth, loop.released))]
                       for name, loop in zip(names, loops, strict=True)])  # fmt: skip


def _table(result: Result) -> Table:
    return Table(caption="Events of the path in order.",
                 columns=["event", "position / um", "penetration / um", "mean pressure / kPa",
                          "energy released / (uJ/m^2)"],
                 rows=[[event.kind, None if event.position is None else round(event.position * 1e6, 2),
                        round(event.penetration * 1e6, 4), round(event.mean_pressure / 1e3, 4),
                        None if event.energy_released is None else float(f"{event.energy_released * 1e6:.4g}")]
                       for event in result.events])  # fmt: skip


def _figure(result: Result) -> Figure:
    words = ("loading", "unloading to 70 um", "loading again", "unloading", "apart")
    styles = ("line", "dashed", "line", "dashed", "dashed")
    height = result.states[0].separation + result.states[0].penetration
    series = [
        trace(word, [state.separation * 1e6 for state in states if state.edges],
              [state.mean_pressure / 1e3 for state in states if state.edges], "dashed" if style == "dashed" else "line")
        for word, style, (states, _) in zip(words[:4], styles[:4], legs(result)[:4], strict=True)
    ]  # fmt: skip
    events = marks("events", [(height - event.penetration) * 1e6 for event in result.events],
                   [event.mean_pressure / 1e3 for event in result.events])  # fmt: skip
    return drawn(
        "hysteresis",
        "Mean pressure along two loops of separation: the area between the branches is what events release.",
        axes("separation / um", "mean pressure / kPa", *series, events),
    )


MEASURED_WORK, MEASURED_SYMMETRY = 2.6e-10, 0.006

CASES = (
    Case(id="loading-history", group="path", level="quick",
         question="Is what a loop dissipates the sum of what its events release, and is a lost symmetry an event?",
         equations=r"$\int \sigma_0 \, d\Delta = U_2 - U_1$ + sum of energies released; energy released $\ge 0$",
         sources=("carbone2009", "johnson1995"), compute=_history,
         effects=("half_space", "adhesion", "slope_term", "unloading"), scene=adapters.scene_text("hysteresis")),
)  # fmt: skip
