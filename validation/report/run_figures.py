"""Figures of one run that do not move: the area, distributions, a scan and its preparation."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.command_line.answer_table import axis_unit, readable
from bem.scene.result import Result
from bem.scene.state import State
from validation.harness.figure_data import axes, drawn, trace
from validation.harness.schema import Figure
from validation.report.run_curves import Theory, curves_of
from validation.report.scan_figure import preparation_figure, spectrum_figure

MOST_LINES = 8

Array = NDArray[Any]


def figures_of(result: Result, theories: Sequence[Theory]) -> Iterator[Figure]:
    """Yield all figures of a run, in the order of the page."""
    yield from curves_of(result, theories)
    yield from distributions_of(result)
    scan = preparation_figure(result.fields), spectrum_figure(result.fields, result.profile_preparation)
    yield from filter(None, scan)


def stored_states(result: Result) -> dict[str, State]:
    """Return the states of which arrays are stored, by the k of these."""
    return {str(state.stored): state for state in result.states if state.stored is not None}


def distributions_of(result: Result) -> Iterator[Figure]:
    """Yield the distributions of the pressure that were asked for."""
    fields, states = result.fields, list(stored_states(result).items())[:MOST_LINES]
    pressures = [(name, state) for name, state in states if f"sigma_{name}" in fields]
    if pressures:
        most = max(float(np.max(fields[f"sigma_{name}"])) for name, _ in pressures)
        factor, unit = axis_unit(abs(most), "Pa")
        series = []
        for name, state in pressures:
            sigma, density = fields[f"sigma_{name}"], fields[f"P_{name}"]
            shown = sigma >= -abs(most)  # the tail of adhesive edges goes on without bound
            series.append(trace(f"at {_where(state)}", factor * sigma[shown], density[shown] / factor))
        yield drawn(
            "pressures",
            "Distribution of the contact pressure over the nominal length, what is open left out.",
            axes(f"pressure / {unit}", f"density / (1/{unit})", *series),
        )


def _where(state: State) -> str:
    """Return the place of a state on the path, in words."""
    if math.isnan(state.mean_pressure):
        return f"complete contact, {state.branch}"
    return f"{readable(state.mean_pressure, 'Pa', 3)}, {state.branch}"
