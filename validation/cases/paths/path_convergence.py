"""The path does not depend on its increments: a quarter of the increment changes nothing beyond the tolerance."""

from __future__ import annotations

import numpy as np

import bem
from bem.scene.result import Result
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.rows import compared, counted
from validation.harness.schema import Reference, Row, Table
from validation.references import adapters

INCREMENTS = (0.05, 0.0125)


def _solved(increment: float) -> tuple[Result, tuple[int, int]]:
    """The scene at one largest increment, and the increments accepted and rejected."""
    counts = (0, 0)

    def note(progress: bem.scene.result.Progress) -> None:
        nonlocal counts
        counts = (progress.increments_accepted, progress.increments_rejected)

    result = bem.solve(adapters.scene("rough_100", {"accuracy": {"max_increment": increment}}), progress=note)
    return result, counts


def _numbers(result: Result) -> dict[str, list[float]]:
    """What the events of a path say of the states from which it jumps, in order."""
    return {
        "penetration": [event.penetration for event in result.events],
        "mean pressure": [event.mean_pressure for event in result.events],
        "energy released": [event.energy_released or 0.0 for event in result.events],
    }


def _path_convergence() -> Outcome:
    runs = [_solved(increment) for increment in INCREMENTS]
    coarse, fine = (result.targets for result, _ in runs)
    reference = Reference(kind="self", source=f"the same path at increments of {INCREMENTS[1]} rms heights")
    slope = max(abs(state.mean_pressure) for state in fine)
    rows: tuple[Row, ...] = (
        compared("contact fraction at every target", "", reference, [state.contact_fraction for state in fine],
                 [state.contact_fraction for state in coarse], 2.5 * MEASURED[0], MEASURED[0],
                 "maximum over states", 1.0),
        compared("mean pressure at every target, over the largest", "Pa", reference,
                 [state.mean_pressure for state in fine], [state.mean_pressure for state in coarse], 2.5 * MEASURED[1],
                 MEASURED[1], "maximum over states", slope),
        counted("patches at every target", reference, [float(state.n_patches) for state in fine],
                [float(state.n_patches) for state in coarse]),
    )  # fmt: skip
    known, found = (_numbers(result) for result, _ in reversed(runs))
    rows += tuple(
        compared(f"{name} of every event, over the largest", unit, reference, known[name],
                 found[name] if len(found[name]) == len(known[name]) else [0.0] * len(known[name]), 2.5 * measured,
                 measured, "maximum over states", max(map(abs, known[name])))
        for name, unit, measured in MEASURED_EVENTS
    )  # fmt: skip
    table = Table(caption="Increments along the path, in rms heights; a rejected one is repeated shorter.",
                  columns=["largest increment", "accepted", "rejected", "events", "evaluations"],
                  rows=[[increment, *counts, len(result.events), sum(state.evaluations for state in result.states)]
                        for increment, (result, counts) in zip(INCREMENTS, runs, strict=True)])  # fmt: skip
    separation = [state.separation * 1e6 for state in fine]
    error = np.array([state.contact_fraction for state in coarse]) - [state.contact_fraction for state in fine]
    figure = drawn("path-convergence", "Contact fraction at the targets for two sizes of increment.",
                   axes("separation / um", "contact fraction",
                        *(
                            trace(f"increment {increment}", separation,
                                  [state.contact_fraction for state in result.targets], style)
                            for increment, (result, _), style in zip(INCREMENTS, runs, ("points", "line"), strict=True)
                        )),
                   axes("separation / um", "coarse less fine",
                        marks("contact fraction", separation, error)))  # fmt: skip
    counts = {"evaluations": sum(state.evaluations for result, _ in runs for state in result.states)}
    return Outcome(rows=rows, figures=(figure,), tables=(table,), counts=counts)


MEASURED = (7e-13, 3.6e-13)  # of the targets, the larger of two processors

MEASURED_EVENTS = (  # the largest over the BLAS kernels of four processors
    ("penetration", "m", 7.2e-13),
    ("mean pressure", "Pa", 9.2e-12),
    ("energy released", "J/m^2", 3.1e-13),
)

CASES = (
    Case(id="path-convergence", group="path", level="quick",
         question="Is the state at a target independent of the increments on the way, through all events?",
         equations="increments of 0.05 and 0.0125 rms heights; events are the ends of branches",
         sources=("carbone2009",), compute=_path_convergence,
         effects=("half_space", "adhesion", "slope_term", "unloading"), scene=adapters.scene_text("rough_100")),
)  # fmt: skip
