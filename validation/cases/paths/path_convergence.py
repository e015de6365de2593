"""The path does not depend on its increments: a quarter of the increment changes nothing beyond the tolerance."""

from __future__ import annotations

import numpy as np

import bem
from bem.scene.result import Result
from validation.harness.case import Case, Outcome
from validation.harness.schema import Figure, Panel, Reference, Row, Series, Table, Tolerance
from validation.references import adapters

INCREMENTS = (0.05, 0.0125)
SCENE_TOLERANCE = 1e-6


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
        Row(
            quantity="contact fraction at every target",
            unit="",
            reference=reference,
            norm="maximum over states",
            expected=[state.contact_fraction for state in fine],
            computed=[state.contact_fraction for state in coarse],
            tolerance=Tolerance(value=SCENE_TOLERANCE, measured=MEASURED[0], basis="required"),
        ),
        Row(
            quantity="mean pressure at every target, over the largest",
            unit="Pa",
            reference=reference,
            norm="maximum over states",
            expected=[state.mean_pressure for state in fine],
            computed=[state.mean_pressure for state in coarse],
            scale=slope,
            tolerance=Tolerance(value=SCENE_TOLERANCE, measured=MEASURED[1], basis="required"),
        ),
        Row(
            quantity="patches at every target",
            unit="",
            reference=reference,
            norm="absolute",
            expected=[float(state.n_patches) for state in fine],
            computed=[float(state.n_patches) for state in coarse],
            tolerance=Tolerance(value=0.5, measured=0.0, basis="required"),
            pinned="exact",
        ),
    )
    known, found = (_numbers(result) for result, _ in reversed(runs))
    rows += tuple(
        Row(
            quantity=f"{name} of every event, over the largest",
            unit=unit,
            reference=reference,
            norm="maximum over states",
            expected=known[name],
            computed=found[name] if len(found[name]) == len(known[name]) else [0.0] * len(known[name]),
            scale=max(map(abs, known[name])),
            tolerance=Tolerance(value=2.5 * measured, measured=measured),
        )
        for name, unit, measured in MEASURED_EVENTS
    )
    table = Table(
        caption="Increments along the path, in rms heights; a rejected one is repeated shorter.",
        columns=["largest increment", "accepted", "rejected", "events", "evaluations"],
        rows=[
            [increment, *counts, len(result.events), sum(state.evaluations for state in result.states)]
            for increment, (result, counts) in zip(INCREMENTS, runs, strict=True)
        ],
    )
    separation = [state.separation * 1e6 for state in fine]
    error = np.array([state.contact_fraction for state in coarse]) - [state.contact_fraction for state in fine]
    figure = Figure(
        id="path-convergence",
        caption="Contact fraction at the targets for two sizes of increment.",
        solution=Panel(
            xlabel="separation / um",
            ylabel="contact fraction",
            series=[
                Series(
                    label=f"increment {increment}",
                    x=separation,
                    y=[state.contact_fraction for state in result.targets],
                    style=style,
                )
                for increment, (result, _), style in zip(INCREMENTS, runs, ("points", "line"), strict=True)
            ],
        ),
        error=Panel(
            xlabel="separation / um",
            ylabel="coarse less fine",
            series=[Series(label="contact fraction", x=separation, y=error.tolist(), style="points")],
        ),
    )
    counts = {"evaluations": sum(state.evaluations for result, _ in runs for state in result.states)}
    return Outcome(rows=rows, figures=(figure,), tables=(table,), counts=counts)


MEASURED = (4.9e-13, 3.2e-13)

MEASURED_EVENTS = (  # the largest over the BLAS kernels of four processors
    ("penetration", "m", 7.2e-13),
    ("mean pressure", "Pa", 9.2e-12),
    ("energy released", "J/m^2", 3.1e-13),
)

CASES = (
    Case(
        id="path-convergence",
        group="path",
        level="quick",
        question="Is the state at a target independent of the increments on the way, through all events?",
        equations="increments of 0.05 and 0.0125 rms heights; events are the ends of branches",
        sources=("carbone2009",),
        compute=_path_convergence,
        effects=("half_space", "adhesion", "slope_term", "unloading"),
        scene=adapters.scene_text("rough_100"),
    ),
)
