"""Figures of one run that do not move: the area, distributions, a scan and its preparation."""

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.command_line.answer_table import axis_unit, readable
from bem.scene.result import Result
from bem.scene.state import State
from validation.harness.figure_data import axes, drawn, semilogx, trace
from validation.harness.schema import Figure
from validation.report.run_curves import Theory, curves_of
from validation.report.scan_figure import preparation_figure, spectrum_figure

MOST_LINES = 8
FEW = 4  # contacts, of which fewer have no distribution of widths

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
    """Yield distributions: widths of contacts and gaps at targets, and pressures that were asked for."""
    touching = [state for state in result.targets if state.n_patches >= FEW][:MOST_LINES]
    if touching:
        period = result.scene["profile"]["period"]
        widths = [_widths(state, period) for state in touching]
        factor, unit = axis_unit(max(float(of[-1]) for pair in widths for of in pair), "m")
        series = [
            trace(f"{label} at {_where(state)}", factor * of, np.arange(1, of.size + 1) / of.size, style, hue=k)
            for k, (state, pair) in enumerate(zip(touching, widths, strict=True))
            for of, label, style in zip(pair, ("contacts", "gaps"), ("line", "dashed"), strict=True)
        ]
        yield drawn(
            "widths",
            "Share of the contacts and of the gaps that are not wider.",
            semilogx(f"width / {unit}", "share of their number", *series),
        )
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


def _widths(state: State, period: float) -> tuple[Array, Array]:
    """Return the widths of the contacts and of the gaps between them, sorted, m."""
    left, right = np.transpose(state.edges)
    return np.sort(right - left), np.sort(np.append(left[1:], left[0] + period) - right)


def _where(state: State) -> str:
    """Return the place of a state on the path, in words."""
    if math.isnan(state.mean_pressure):
        return f"complete contact, {state.branch}"
    return f"{readable(state.mean_pressure, 'Pa', 3)}, {state.branch}"
