"""Curves of one run: mean pressure against contact fraction and separation, jumps as jumps, beside Persson's theory.

A branch ends at the equilibrium from which the contact jumps, and goes on where it arrives; a dashed line joins them.
Of an event the separation is known, but not the contact fraction: there the jump begins at the state before it.

Persson's theory and the fitted law of the area follow from the result alone, for a half-space under compression.  The
fitted law is drawn inside its domain.  Separations with adhesion need a ladder of loads and are left out.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

import persson
from bem.command_line.answer_table import axis_unit
from bem.scene.result import Event, Result, State
from bem.scene.surface import surface_of
from persson import DiscreteSpectrum
from validation.harness.figure_data import axes, bars, drawn, marks, semilogx, trace
from validation.harness.schema import Figure, Panel, Series

NEAR = 0.1  # of the smallest separation of the run: the theory is drawn down to that

Point = tuple[float, float]  # of the quantity and the mean pressure, SI


@dataclass
class Strokes:
    """Strokes of a path, separated by None."""

    branches: dict[str, list[Point | None]] = field(default_factory=lambda: {"loading": [], "unloading": []})
    jumps: list[Point | None] = field(default_factory=list)


def curves_of(result: Result) -> Iterator[Figure]:
    """Yield mean pressure against contact fraction and against separation, of a result that has all its states."""
    if not result.states:
        return
    if all(state.status == "complete_contact" for state in result.states):
        return  # of which area and separation are known
    theories = theories_of(result)
    beyond = " The fitted law of the area does not apply here." if len(theories) == 1 else ""
    for figure, name, known in (
        ("area", "contact_fraction", theories),
        ("approach", "separation", [theory for theory in theories if theory.separations]),
    ):
        beside = f" Dashed beside it: {' and '.join(theory.label for theory in known)}.{beyond}" if known else ""
        words = f"Mean pressure against {name.replace('_', ' ')}.{beside}"
        yield drawn(figure, words, _panel(result, name, known))


def jumps(event: Event) -> bool:
    """Return whether energy is released beyond its error: the contact goes over to another state at once."""
    return event.energy_released is not None and event.energy_released > (event.error_estimate.energy_released or 0.0)


def strokes_of(result: Result, value: Callable[[State], float], place: Callable[[Event], float] | None) -> Strokes:
    """Return the path in strokes; `place` is the quantity of an event, where it is known.

    A stroke ends where complete contact begins or ends: no line joins states that are nothing alike.
    """
    strokes, happened, branch = Strokes(), 0, ""
    before: Point | None = None
    joined: bool | None = None
    for state in result.states:
        events = result.events[happened : state.events]
        happened = state.events
        if math.isnan(state.mean_pressure):
            before = None
            continue
        line, point = strokes.branches[state.branch], (value(state), state.mean_pressure)
        if state.branch != branch and before is not None:
            line += [None, before]
        branch, last = state.branch, before
        for event in events:
            if place is not None and not math.isnan(event.mean_pressure) and last is not None:
                last = place(event), event.mean_pressure
                line.append(last)
            if jumps(event) or event.kind == "pull_off":  # a dead tension pulls the surfaces apart without end
                if last is not None and jumps(event):
                    strokes.jumps += [last, point, None]
                line.append(None)
                break
        complete = state.status == "complete_contact"
        if joined is not None and complete != joined:
            line.append(None)
        line.append(point)
        before, joined = point, complete
    return strokes


def _panel(result: Result, name: str, theories: list[Theory]) -> Panel:
    """Draw branches, jumps, states at targets with error bars, events and pull-off, and the theory beside them."""
    states = [state for state in result.states if not math.isnan(state.mean_pressure)]
    lift, pressure = axis_unit(max((abs(state.mean_pressure) for state in states), default=0.0), "Pa")
    apart = name == "separation"
    factor, unit = axis_unit(max(state.separation for state in result.states), "m") if apart else (1.0, "")
    highest = result.states[0].penetration + result.states[0].separation

    def place(event: Event) -> float:
        return highest - event.penetration

    def line(label: str, points: list[Point | None], style: str, hue: int) -> Iterator[Series]:
        if points:
            x = [None if point is None or (apart and point[0] <= 0) else factor * point[0] for point in points]
            y = [None if point is None else lift * point[1] for point in points]
            yield trace(label, x, y, style, hue=hue)

    strokes = strokes_of(result, lambda state: float(getattr(state, name)), place if apart else None)
    series = [
        curve
        for hue, (branch, points) in enumerate(strokes.branches.items())
        for curve in line(branch, points, "line", hue)
    ]
    series += line("jumps", strokes.jumps, "dashed", 3)
    targets = [state for state in states if state.target and (not apart or state.separation > 0)]
    if targets:
        x, y = [factor * getattr(state, name) for state in targets], [lift * state.mean_pressure for state in targets]
        errors = [lift * finite(state.error_estimate.mean_pressure) for state in targets]
        low, high = ([value + sign * e for value, e in zip(y, errors, strict=True)] for sign in (-1, 1))
        series += [marks("states at targets", x, y, hue=5), bars("estimated error", x, low, high, hue=5)]
    series += _pulled_off(result, factor, lift) if apart else []
    for hue, theory in enumerate(theories):
        places = theory.separations if apart else theory.fractions
        closest = min((state.separation for state in states if state.separation > 0), default=0.0)
        least = NEAR * closest if apart else 0.0
        pairs = [(factor * x, lift * load) for x, load in zip(places, theory.loads, strict=True) if x >= least]
        series.append(trace(theory.label, (x for x, _ in pairs), (y for _, y in pairs), "dashed", hue=2 + 2 * hue))
    shape = semilogx if apart and any(state.separation > 0 for state in states) else axes
    label = name.replace("_", " ") + (f" / {unit}" if unit else "")
    return shape(label, f"mean pressure / {pressure}", *(series or [marks("no state with a pressure", [], [])]))


def _pulled_off(result: Result, factor: float, lift: float) -> Iterator[Series]:
    """Yield marks of the largest tension, where the pressure turns, and of the pull-off, where the separation turns."""
    largest = result.largest_tension
    if largest is not None:
        yield marks("largest tension", [factor * largest.separation], [lift * largest.mean_pressure], hue=4)
    highest = result.states[0].penetration + result.states[0].separation
    ends = [event for event in result.events if event.kind == "pull_off" and not math.isnan(event.mean_pressure)]
    if ends:
        yield marks(
            "pull-off",
            [factor * (highest - end.penetration) for end in ends],
            [lift * end.mean_pressure for end in ends],
            hue=3,
        )


def finite(error: float | None) -> float:
    """Return an estimated error; zero if it is missing or not finite."""
    return 0.0 if error is None or not math.isfinite(error) else error


MANY, FEW = 40, 8  # loads, where one takes no time and where it takes some
LEAST, MOST = 0.003, 0.6  # contact fractions of the theory among which the fitted law is tried
SPAN = 50.0  # largest load drawn over the smallest


@dataclass(frozen=True)
class Theory:
    """Curve of a theory: loads in Pa, contact fractions, and separations in m where they are known."""

    label: str
    loads: list[float]
    fractions: list[float]
    separations: list[float]


def spectrum_of(result: Result) -> DiscreteSpectrum | None:
    """Return the lines of the profile of a result; None of a scan whose result does not hold them."""
    if result.scene["profile"]["kind"] != "samples":
        return DiscreteSpectrum.of_profile(surface_of(result.scene["profile"], None))
    if "profile_q" not in result.fields:
        return None
    return DiscreteSpectrum(result.fields["profile_q"], result.fields["profile_amplitude"])


def theories_of(result: Result) -> list[Theory]:
    """Return the theory and the fitted area; nothing on a layer, without compression, or of two flat surfaces."""
    most = max((state.mean_pressure for state in result.states if state.mean_pressure > 0), default=0.0)
    if result.scene["layer"] is not None or most == 0 or not result.groups.get("rms_slope"):
        return []
    spectrum = spectrum_of(result)
    if spectrum is None:
        return []
    solid, adhesion = result.scene["solid"], result.scene["adhesion"]
    given = {name: solid[name] for name in ("youngs_modulus", "poisson_ratio")}
    if adhesion is not None:
        given["work_of_adhesion"] = adhesion["work_of_adhesion"]
    adhesive = adhesion is not None
    loads = np.geomspace(most / SPAN, most, FEW if adhesive else MANY).tolist()
    states = [persson.solve(spectrum, load, with_separation=not adhesive, **given) for load in loads]
    fractions = [state.contact_fraction for state in states]
    known = [state.separation for state in states if state.separation is not None]
    theories = [Theory("Persson's theory", loads, fractions, known if len(known) == len(states) else [])]
    partial = [load for load, fraction in zip(loads, fractions, strict=True) if LEAST < fraction < MOST]
    areas = [(load, persson.contact_area(spectrum, load, **given)) for load in partial]
    fitted = [(load, area.contact_fraction) for load, area in areas if area.status == "in_domain"]
    if len(fitted) > 1:
        theories.append(Theory("fitted area", [load for load, _ in fitted], [area for _, area in fitted], []))
    return theories
