"""Figures of one run that do not move: the area beside theories, distributions, a scan and its preparation.

Area: mean pressure against contact fraction.  Lines join states as `joins_of` says; a dashed line joins both ends of a
jump.  Persson's theory and the fitted law of the area follow from the result alone, for a half-space under compression.
The fitted law is drawn inside its domain.

Scan: heights as measured and as solved, each about its own mean, and the power spectrum of the scan with its noise
floor and the wavelengths at which it is cut and should be (bem/scans/noise_floor.py).  The numbers are those that a
result stores (`PeriodicSamples.drawn` in bem/scans): scan_x, scan_h, profile_x, profile_h in m, scan_density over
scan_wavelength.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import persson
from bem.command_line.answer_table import axis_unit, readable
from bem.scans.scan_keys import CUTOFFS
from bem.scene.result import Result
from bem.scene.state import State
from persson import DiscreteSpectrum
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import Figure, Series, drawn, trace
from validation.report.path_states import PathState, joins_of, path_of, profile_of

MOST_LINES = 8
MANY, FEW = 40, 8  # loads, where one takes no time and where it takes some
LEAST, MOST = 0.003, 0.6  # contact fractions of the theory among which the fitted law is tried
SPAN = 50.0  # largest load drawn over the smallest
BRANCHES = {"loading": "l", "unloading": "u", "jumps": "j"}  # line, and its letter in `joins_of`

Point = tuple[float, float]


def figures_of(result: Result, theories: Sequence[Theory]) -> Iterator[Figure]:
    """Yield all figures of a run, in the order of the page."""
    yield from area_of(result, theories)
    yield from distributions_of(result)
    scan = preparation_figure(result.fields), spectrum_figure(result.fields, result.profile_preparation)
    yield from filter(None, scan)


@dataclass(frozen=True)
class Theory:
    """Curve of a theory: loads in Pa and contact fractions."""

    label: str
    loads: list[float]
    fractions: list[float]


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
    loads = np.geomspace(most / SPAN, most, FEW if adhesion else MANY).tolist()
    fractions = [persson.solve(spectrum, load, with_separation=False, **given).contact_fraction for load in loads]
    theories = [Theory("Persson's theory", loads, fractions)]
    partial = [load for load, fraction in zip(loads, fractions, strict=True) if LEAST < fraction < MOST]
    areas = [(load, persson.contact_area(spectrum, load, **given)) for load in partial]
    fitted = [(load, area.contact_fraction) for load, area in areas if area.status == "in_domain"]
    if len(fitted) > 1:
        theories.append(Theory("fitted area", [load for load, _ in fitted], [area for _, area in fitted]))
    return theories


def area_of(result: Result, theories: Sequence[Theory]) -> Iterator[Figure]:
    """Yield mean pressure against contact fraction, theories beside it; nothing where all contact is complete."""
    path = path_of(result)
    if all(point.state.status == "complete_contact" for point in path):
        return  # of which the area is known
    beside = f" Dashed beside it: {' and '.join(theory.label for theory in theories)}." if theories else ""
    beyond = " The fitted law of the area does not apply here." if len(theories) == 1 else ""
    unit, series = _of_area(path, theories)
    caption = f"Mean pressure against contact fraction.{beside}{beyond}"
    yield drawn("area", caption, "contact fraction", f"mean pressure / {unit}", *series)


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


def _of_area(path: list[PathState], theories: Sequence[Theory]) -> tuple[str, list[Series]]:
    """Return the unit of the pressure, and branches, jumps, states at targets with error bars, and theories."""
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
        errors = [_finite(state.error_estimate.mean_pressure) for state in targets]
        low, high = ([lift * (p + sign * e) for p, e in zip(loads, errors, strict=True)] for sign in (-1, 1))
        series.append(trace("states at targets", shares, [lift * load for load in loads], "points", 5))
        series.append(trace("estimated error", shares, low, "bars", 5, high))
    for hue, theory in enumerate(theories):
        loads = [lift * load for load in theory.loads]
        series.append(trace(theory.label, theory.fractions, loads, "dashed", hue=2 + 2 * hue))
    return unit, series or [trace("no state with a pressure", [], [], "points")]


def _finite(error: float | None) -> float:
    """Return an estimated error; zero if it is missing or not finite."""
    return 0.0 if error is None or not math.isfinite(error) else error


def distributions_of(result: Result) -> Iterator[Figure]:
    """Yield the distributions of the pressure that were asked for."""
    fields = result.fields
    states = [(str(state.stored), state) for state in result.states if state.stored is not None][:MOST_LINES]
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
            f"pressure / {unit}",
            f"density / (1/{unit})",
            *series,
        )


def _where(state: State) -> str:
    """Return the place of a state on the path, in words."""
    if math.isnan(state.mean_pressure):
        return f"complete contact, {state.branch}"
    return f"{readable(state.mean_pressure, 'Pa', 3)}, {state.branch}"


def preparation_figure(fields: Mapping[str, FloatArray]) -> Figure | None:
    """Draw the scan and the profile of a result from its fields; None without a scan."""
    if "scan_x" not in fields:
        return None
    lengths, heights = fields["profile_x"] - fields["profile_x"][0], fields["scan_h"] - np.nanmean(fields["scan_h"])
    (length, across), (height, upward) = (axis_unit(float(np.nanmax(np.abs(a))), "m") for a in (lengths, heights))
    series = []
    for name, label, style in (("scan", "as measured", "thin"), ("profile", "as prepared", "line")):
        x, h = length * fields[f"{name}_x"], height * fields[f"{name}_h"]
        y = [float(value) if np.isfinite(value) else None for value in h - np.nanmean(h)]
        series.append(trace(label, x, y, style))
    caption = "Scan as measured and as prepared."
    return drawn("preparation", caption, f"x / {across}", f"height / {upward}", *series)


def spectrum_figure(fields: Mapping[str, FloatArray], steps: Sequence[Mapping[str, Any]]) -> Figure | None:
    """Draw the power spectrum over wavelengths; None for a result without a spectrum, or with equal heights."""
    positive = np.flatnonzero(fields.get("scan_density", np.zeros(0)) > 0)
    if not positive.size:
        return None
    wavelength, density = (fields[name][positive] for name in ("scan_wavelength", "scan_density"))
    length, unit = axis_unit(float(wavelength.min()), "m")
    series = [trace("power spectrum of the scan", length * wavelength, density)]
    facts = {key: value for step in steps for key, value in step.items() if step["step"] == "spectrum"}
    if "noise_density" in facts:
        ends = (wavelength.min(), wavelength.max())
        series.append(trace("noise floor", [length * end for end in ends], [facts["noise_density"]] * 2, "dashed"))
    height = [float(density.min()), float(density.max())]
    series += [trace(f"{name}, {length * at:.3g} {unit}", [length * at] * 2, height) for name, at in _cuts(steps)]
    caption = "Power spectrum of the scan, one-sided."
    return drawn("spectrum", caption, f"wavelength / {unit}", "density / m³", *series, log="xy")


def _cuts(steps: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, float]]:
    """Yield names and wavelengths (m) of the cuts of a scan and of the suggested cut."""
    by_name = {step["step"]: step for step in steps}
    if "period" in by_name.get("periodic", {}) and "cut" in by_name:
        yield "harmonics end", by_name["periodic"]["period"] / by_name["cut"]["harmonics"]
    for key in CUTOFFS:
        if key in by_name.get("filter", {}):
            yield key, by_name["filter"][key]
    if "suggested_cutoff" in by_name.get("spectrum", {}):
        yield "suggested cut", by_name["spectrum"]["suggested_cutoff"]
