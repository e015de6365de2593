"""The path does not depend on its increments: a quarter of the increment changes nothing beyond the tolerance."""

import numpy as np

import bem
from bem.scene.result import Progress, Result
from validation.cases.shared.checks import OVER_STATES, Against, case, column, posed, work
from validation.harness.case import Outcome
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.schema import Table

INCREMENTS = (0.05, 0.0125)
# quantity of events, name, unit, error measured: the largest over the BLAS kernels of four processors
OF_EVENTS = (
    ("penetration", "penetration", "m", 7.2e-13),
    ("mean pressure", "mean_pressure", "Pa", 9.2e-12),
    ("energy released", "energy_released", "J/m^2", 3.1e-13),
)


def _solved(increment: float) -> tuple[Result, tuple[int, int]]:
    """The scene at one largest increment, and the increments accepted and rejected."""
    seen: list[Progress] = []
    result = bem.solve(posed("rough_100", accuracy={"max_increment": increment}), progress=seen.append)
    return result, (seen[-1].increments_accepted, seen[-1].increments_rejected)


def _of_events(result: Result, name: str, count: int | None = None) -> list[float]:
    """What the events of a path say of the states from which it jumps, in order; zeros where they are not so many."""
    values = [value or 0.0 for value in column(result.events, name)]
    return values if count in (None, len(values)) else [0.0] * (count or 0)


def _path_convergence() -> Outcome:
    (first, first_counts), (second, second_counts) = map(_solved, INCREMENTS)
    coarse, fine = first.targets, second.targets
    known = Against("self", f"the same path at increments of {INCREMENTS[1]} rms heights")
    fractions, pressures = column(fine, "contact_fraction"), column(fine, "mean_pressure")
    rows = [  # errors measured: the larger of two processors
        known.row("contact fraction at every target", "", fractions, column(coarse, "contact_fraction"), 7e-13,
                  OVER_STATES, 1.0),
        known.row("mean pressure at every target, over the largest", "Pa", pressures, column(coarse, "mean_pressure"),
                  3.6e-13, OVER_STATES, max(map(abs, pressures))),
        known.count("patches at every target", column(fine, "n_patches"), column(coarse, "n_patches")),
    ]  # fmt: skip
    for words, name, unit, measured in OF_EVENTS:
        values = _of_events(second, name)
        rows.append(known.row(f"{words} of every event, over the largest", unit, values,
                              _of_events(first, name, len(values)), measured, OVER_STATES,
                              max(map(abs, values))))  # fmt: skip
    table = Table(
        caption="Increments along the path, in rms heights; a rejected one is repeated shorter.",
        columns=["largest increment", "accepted", "rejected", "events", "evaluations"],
        rows=[
            [increment, *counts, *work("events evaluations", result).values()]
            for increment, result, counts in zip(
                INCREMENTS, (first, second), (first_counts, second_counts), strict=True
            )
        ],
    )
    at, apart = column(fine, "separation", 1e-6), np.subtract(column(coarse, "contact_fraction"), fractions)
    figure = drawn("path-convergence", "Contact fraction at the targets for two sizes of increment.",
                   axes("separation / um", "contact fraction",
                        marks(f"increment {INCREMENTS[0]}", at, column(coarse, "contact_fraction")),
                        trace(f"increment {INCREMENTS[1]}", at, fractions)),
                   axes("separation / um", "coarse less fine", marks("contact fraction", at, apart)))  # fmt: skip
    return Outcome(rows=tuple(rows), figures=(figure,), tables=(table,), counts=work("evaluations", first, second))


CASES = (
    case("path-convergence", "path", _path_convergence,
         "Is the state at a target independent of the increments on the way, through all events?",
         "increments of 0.05 and 0.0125 rms heights; events are the ends of branches",
         "carbone2009", "half_space adhesion slope_term unloading", scene="rough_100"),
)  # fmt: skip
