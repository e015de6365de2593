"""Mean pressure of one run against contact fraction, jumps as jumps, beside Persson's theory.

Lines join states as `joins_of` says; a dashed line joins both ends of a jump.

Persson's theory and the fitted law of the area follow from the result alone, for a half-space under compression.  The
fitted law is drawn inside its domain.  Separations with adhesion need a ladder of loads and are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

import persson
from bem.command_line.answer_table import axis_unit
from bem.scene.result import Result
from persson import DiscreteSpectrum
from validation.harness.figure_data import axes, bars, drawn, marks, trace
from validation.harness.schema import Figure, Panel, Series
from validation.report.path_states import PathState, joins_of, path_of, profile_of

Point = tuple[float, float]
BRANCHES = {"loading": "l", "unloading": "u", "jumps": "j"}  # line, and its letter in `joins_of`


def curves_of(result: Result, theories: Sequence[Theory]) -> Iterator[Figure]:
    """Yield mean pressure against contact fraction, theories beside it; nothing where all contact is complete."""
    path = path_of(result)
    if all(point.state.status == "complete_contact" for point in path):
        return  # of which the area is known
    beside = f" Dashed beside it: {' and '.join(theory.label for theory in theories)}." if theories else ""
    beyond = " The fitted law of the area does not apply here." if len(theories) == 1 else ""
    yield drawn("area", f"Mean pressure against contact fraction.{beside}{beyond}", _panel(path, theories))


def lines_of(path: list[PathState]) -> dict[str, list[Point | None]]:
    """Return contact fraction and mean pressure (Pa) along each line of `BRANCHES`, with None where it is broken."""
    points: list[Point | None] = [
        None if math.isnan(point.state.mean_pressure) else (point.state.contact_fraction, point.state.mean_pressure)
        for point in path
    ]
    lines: dict[str, list[Point | None]] = {name: [] for name in BRANCHES}
    letters = joins_of(path)
    for name, letter in BRANCHES.items():
        for k in (k for k, own in enumerate(letters) if own == letter):
            goes_on = letters[k - 1] == letter != "j"
            lines[name] += [points[k]] if goes_on else [None, points[k - 1], points[k]]
    return lines


def _panel(path: list[PathState], theories: Sequence[Theory]) -> Panel:
    """Draw branches, jumps, states at targets with error bars, and the theory beside them."""
    states = [point.state for point in path if not math.isnan(point.state.mean_pressure)]
    lift, unit = axis_unit(max((abs(state.mean_pressure) for state in states), default=0.0), "Pa")
    series: list[Series] = []
    for (label, points), hue, style in zip(lines_of(path).items(), (0, 1, 3), ("line", "line", "dashed"), strict=True):
        if points:
            x = [None if point is None else point[0] for point in points]
            y = [None if point is None else lift * point[1] for point in points]
            series.append(trace(label, x, y, style, hue=hue))
    targets = [state for state in states if state.target]
    if targets:
        shares, loads = ([getattr(state, name) for state in targets] for name in ("contact_fraction", "mean_pressure"))
        errors = [finite(state.error_estimate.mean_pressure) for state in targets]
        low, high = ([lift * (p + sign * e) for p, e in zip(loads, errors, strict=True)] for sign in (-1, 1))
        series.append(marks("states at targets", shares, [lift * load for load in loads], hue=5))
        series.append(bars("estimated error", shares, low, high, hue=5))
    for hue, theory in enumerate(theories):
        loads = [lift * load for load in theory.loads]
        series.append(trace(theory.label, theory.fractions, loads, "dashed", hue=2 + 2 * hue))
    return axes("contact fraction", f"mean pressure / {unit}", *(series or [marks("no state with a pressure", [], [])]))


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


def theories_of(result: Result) -> list[Theory]:
    """Return the theory and the fitted area; nothing on a layer, without compression, or of two flat surfaces."""
    most = max((state.mean_pressure for state in result.states if state.mean_pressure > 0), default=0.0)
    if result.scene["layer"] is not None or most == 0 or not result.groups.get("rms_slope"):
        return []
    spectrum = DiscreteSpectrum.of_profile(profile_of(result))
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
