"""Figures of one run: curves with their estimated errors, these errors, shapes of the contact, a scan prepared."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.scene.result import Result, State
from validation.harness.figure_data import axes, bars, drawn, marks, semilogy, trace
from validation.harness.schema import Figure, Panel, Series
from validation.report.run_words import axis_unit, quantity
from validation.report.scan_figure import preparation_figure, spectrum_figure

MOST_SHAPES = 8
SAME = 1e-6  # relative distance within which a state is one at which a shape is asked for

Array = NDArray[Any]


def figures_of(result: Result) -> Iterator[Figure]:
    """All figures of a run, in the order of the page."""
    if result.states:
        yield drawn("area", "Mean pressure against contact fraction.", _curves(result, "contact_fraction", "", 1.0))
        highest = max(abs(state.separation) for state in result.states)
        factor, unit = axis_unit(highest, "m")
        yield drawn("approach", "Mean pressure against separation.", _curves(result, "separation", unit, factor))
    if any(state.error_estimate.mean_pressure for state in result.states):
        yield drawn("errors", "Estimated errors of all states, in the order of the path.", _errors(result))
    for figure_of in (preparation_figure, spectrum_figure):
        prepared = figure_of(result.fields, result.profile_preparation)
        if prepared is not None:
            yield prepared
    yield from _shapes(result)


def shape_states(result: Result) -> dict[str, State | None]:
    """The names of the stored shapes, each with its state; None where it does not follow from the path."""
    names = sorted((name[2:] for name in result.fields if name.startswith("x_")), key=int)
    control = result.scene["loading"]["control"].replace("penetration", "separation")
    asked = result.scene["output"]["shapes"]
    states = [
        state
        for state in result.targets
        if any(abs(getattr(state, control) - value) <= SAME * abs(value) for value in asked)
    ]
    return dict(zip(names, states, strict=True)) if len(names) == len(states) else dict.fromkeys(names)


def _curves(result: Result, name: str, unit: str, factor: float) -> Panel:
    """Mean pressure against a quantity: branches as lines, states at targets as points with error bars, events."""
    kept = [state for state in result.states if not math.isnan(state.mean_pressure)]
    lift, pressure = axis_unit(max((abs(state.mean_pressure) for state in kept), default=0.0), "Pa")
    series = []
    for hue, branch in enumerate(("loading", "unloading")):
        points = _branch(kept, branch)
        if points:
            x = [None if state is None else factor * getattr(state, name) for state in points]
            y = [None if state is None else lift * state.mean_pressure for state in points]
            series.append(trace(branch, x, y, hue=hue))
    targets = [state for state in kept if state.target]
    if targets:
        places = [factor * getattr(state, name) for state in targets]
        pressures = [lift * state.mean_pressure for state in targets]
        errors = [lift * _finite(state.error_estimate.mean_pressure) for state in targets]
        low, high = ([value + sign * e for value, e in zip(pressures, errors, strict=True)] for sign in (-1, 1))
        series.append(marks("states at targets", places, pressures, hue=5))
        series.append(bars("estimated error", places, low, high, hue=5))
    met = [event for event in result.events if not math.isnan(event.mean_pressure)]
    if name == "separation" and met:
        highest = result.states[0].penetration + result.states[0].separation
        places = [factor * (highest - event.penetration) for event in met]
        series.append(marks("events", places, [lift * event.mean_pressure for event in met], hue=3))
    label = name.replace("_", " ") + (f" / {unit}" if unit else "")
    return axes(label, f"mean pressure / {pressure}", *(series or [marks("no state with a pressure", [], [])]))


def _branch(states: Sequence[State], branch: str) -> list[State | None]:
    """The states of a branch; it begins where the other one ended, with a gap before that."""
    found: list[State | None] = []
    for k, state in enumerate(states):
        if state.branch == branch:
            if k and states[k - 1].branch != branch:
                found += [None, states[k - 1]]
            found.append(state)
    return found


def _errors(result: Result) -> Panel:
    """Estimated errors over the states: of the contact fraction, and of the pressure over its largest value."""
    scale = max((abs(state.mean_pressure) for state in result.states if not math.isnan(state.mean_pressure)), default=0)
    found = {
        "contact fraction": [_finite(state.error_estimate.contact_fraction) for state in result.states],
        "mean pressure over the largest": [
            _finite(state.error_estimate.mean_pressure) / (scale or 1.0) for state in result.states
        ],
    }
    last = len(result.states)
    asked = float(result.scene["accuracy"]["tolerance"])
    series = [trace(name, range(1, last + 1), [value or None for value in errors]) for name, errors in found.items()]
    return semilogy("state", "estimated error", *series, trace("asked for", (1, last), (asked, asked), "dashed"))


def _shapes(result: Result) -> Iterator[Figure]:
    """Rigid profile and deformed surface above, pressure below, for the first shapes."""
    fields = result.fields
    for name, state in list(shape_states(result).items())[:MOST_SHAPES]:
        x, displacement, gap, pressure = (fields[f"{key}_{name}"] for key in ("x", "displacement", "gap", "pressure"))
        lines = {"rigid profile": (f"x_{name}", displacement - gap), "deformed surface": (f"x_{name}", displacement)}
        length, along = axis_unit(float(np.max(np.abs(x))), "m")
        carried = np.nan_to_num(pressure)  # nothing outside contact
        lift, unit = axis_unit(float(np.max(np.abs(carried))), "Pa")
        where = "" if state is None else (
            f" at {quantity(state.mean_pressure, 'Pa')} while {state.branch}, separation "
            f"{quantity(state.separation, 'm')}, contact fraction {state.contact_fraction:.4g}"
        )  # fmt: skip
        below = axes(f"x / {along}", f"pressure / {unit}", _line("pressure", length * x, lift * carried))
        yield drawn(f"shape-{name}", f"Shape {name} of fields.npz{where}.", _heights(lines, fields), below)


def _heights(lines: dict[str, tuple[str, Array]], fields: dict[str, Array]) -> Panel:
    """Heights over positions; each line has the name of its positions in the fields, and its heights (m)."""
    length, along = axis_unit(max(float(np.max(np.abs(fields[x]))) for x, _ in lines.values()), "m")
    lift, unit = axis_unit(max(float(np.nanmax(np.abs(heights))) for _, heights in lines.values()), "m")
    drawings = [_line(label, length * fields[x], lift * heights) for label, (x, heights) in lines.items()]
    return axes(f"x / {along}", f"height / {unit}", *drawings)


def _line(label: str, x: Array, y: Array) -> Series:
    """A curve, broken where there is no number."""
    return trace(label, x.tolist(), [value if math.isfinite(value) else None for value in y.tolist()])


def _finite(error: float | None) -> float:
    """An estimated error; none where there is no finite one."""
    return 0.0 if error is None or not math.isfinite(error) else error
