"""Content of the moving figure: states of a path under a slider, their fields as packed numbers, and their table.

Fields are 16-bit integers in base64, between the least and the largest value of a kind.  The texts of the table are
the only form of the numbers of a state: the figure shows the cells of the row.
"""

from __future__ import annotations

import base64
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from bem.command_line.answer_table import NO_NUMBER, axis_unit, digits, fixed, readable, units_of
from bem.scene.result import Event, Result
from bem.scene.state import State
from validation.harness.arrays import FloatArray
from validation.report.path_states import (
    Fields,
    PathState,
    fields_of,
    joins_of,
    path_of,
    positions,
    profile_of,
    shown_of,
    with_events,
)

NAMES = {  # short name for the slider, name, and 1 where contact is gained, -1 where it is lost
    "first_touch": ("snap-in", "first touch", 1),
    "new_contact": ("snap-in", "a new contact", 1),
    "coalescence": ("closing", "a gap closes", 1),
    "complete_contact": ("complete", "the last gap closes", 1),
    "detachment": ("detachment", "a contact vanishes", -1),
    "pull_off": ("pull-off", "the last contact vanishes", -1),
    "opening": ("opening", "complete contact opens", -1),
    "bifurcation": ("edges jump", "edges jump, no contact comes or goes", 0),
}
TOUCH = "touch"  # short name of a first touch that releases nothing
STATUS = {"separated": "apart", "complete_contact": "complete contact"}
SPELT = 2  # events of a row that are spelt out
CUT = 0.6  # of the largest pressure: tension drawn at adhesive edges, where it has no bound
ROOM = 1.05  # largest pressure drawn, over the largest pressure
MISSING = 65535  # code of a number that does not exist


@dataclass(frozen=True)
class Units:
    """Factors from SI, and units of the page; `height` is that of the surfaces as they are drawn."""

    x: tuple[float, str]
    height: tuple[float, str]
    separation: tuple[float, str]
    open: tuple[float, str]
    load: tuple[float, str]
    pressure: tuple[float, str]


def moving_path(result: Result) -> dict[str, Any] | None:
    """Return the values of moving.jinja; None for a result without a state."""
    path = path_of(result)
    if not path:
        return None
    profile = profile_of(result)
    shown = shown_of(path)
    points = list(with_events(path, shown))
    fields = [fields_of(result, profile, point.state) for point in points]
    height = profile.height(positions(profile))
    adhesive = result.scene["adhesion"] is not None
    complete = [point.state.status == "complete_contact" for point in points]
    gapped = [field for field, whole in zip(fields, complete, strict=True) if not whole]
    closed = [field for field, whole in zip(fields, complete, strict=True) if whole]
    ranges = {"partial": _pressure_range(gapped, adhesive), "complete": _pressure_range(closed, False)}
    heights = float(np.ptp(height)) or max(point.state.separation for point in path)
    shared = units_of(result)
    units = Units(
        x=axis_unit(profile.period, "m"),
        height=axis_unit(heights, "m"),
        separation=shared["separation"],
        open=shared["open_gap_mean"],
        load=shared["mean_pressure"],
        pressure=shared["peak_pressure"],
    )
    tension = result.largest_tension
    cut = min(end for ends in ranges.values() for end in ends)
    pressures = np.maximum(_joined(pressure for field in fields for pressure in field.pressure), cut)
    rows = [_row(point, profile.period, units) for point in points]
    data = {
        "period": profile.period * units.x[0],
        "points": height.size,
        "stretch": units.height[0] / units.x[0],
        "range": [value * units.height[0] for value in _heights(points, fields, height)],
        "pressures": {name: [end * units.pressure[0] for end in ends] for name, ends in ranges.items()},
        "units": {name: unit for name, (_, unit) in vars(units).items()},
        "states": [
            _drawn(point, index, field, units) for point, index, field in zip(points, shown, fields, strict=True)
        ],
        "height": _packed(height * units.height[0]),
        "displacement": _packed(np.concatenate([field.displacement for field in fields]) * units.height[0]),
        "pressure": _packed(
            np.clip(pressures, min(ranges["partial"][0], ranges["complete"][0]), None) * units.pressure[0]
        ),
        "path": _curves(path, units),
        "tension": tension and [tension.separation * units.separation[0], tension.mean_pressure * units.load[0]],
    }
    return {
        "states": rows,
        "units": data["units"],
        "control": result.scene["loading"]["control"].replace("_", " "),
        "left_out": len(path) - len(points),
        "curves": any(point.state.status == "converged" for point in path) or len(path) > len(rows),
        "complete": bool(gapped and closed),
        "adhesive": adhesive,
        "tension": tension is not None,
        "data": Markup(json.dumps(data, separators=(",", ":"), ensure_ascii=True).replace("<", "\\u003c")),
    }


def _known(state: State) -> bool:
    return math.isfinite(state.mean_pressure)


def _joined(arrays: Iterable[FloatArray]) -> FloatArray:
    return np.concatenate([*arrays, np.empty(0)])


def _pressure_range(fields: Sequence[Fields], adhesive: bool) -> tuple[float, float]:
    """Return the least and the largest pressure drawn, Pa.

    With adhesion tension is drawn as far as the middle half of each patch needs, and `CUT` of the peak.
    """
    patches = [pressure for field in fields for pressure in field.pressure]
    everywhere = _joined(patches)
    inner = _joined(pressure[pressure.size // 3 : pressure.size - pressure.size // 3] for pressure in patches)
    peak = ROOM * max(float(np.max(everywhere, initial=0.0)), 0.0)
    deepest = ROOM * min(float(np.min(inner, initial=0.0)), 0.0)
    least = min(deepest, -CUT * peak) if adhesive else deepest
    return (least, peak) if least < peak else (0.0, 1.0)


def _heights(points: Sequence[PathState], fields: Sequence[Fields], height: FloatArray) -> list[float]:
    """Return the least and the largest height drawn, m: surfaces that are apart may leave the figure."""
    low, top = float(np.min(height)), float(np.max(height))
    for point, field in zip(points, fields, strict=True):
        if point.state.status != "separated":
            top = max(top, point.state.separation + float(np.max(field.displacement)))
    apart = [point.state.separation for point in points if point.state.status == "separated"]
    if apart and (len(apart) == len(points) or top == low):
        top = max(top, min(apart))
    return [low, top if top > low else low + 1.0]


def _row(point: PathState, period: float, units: Units) -> dict[str, Any]:
    """Return the texts of a row of the table."""
    state, error = point.state, point.state.error_estimate
    apart = state.separation / (1 - state.contact_fraction) if state.contact_fraction < 1 else None
    relative = (error.separation or 0.0) / state.separation if state.separation else 0.0
    return {
        "branch": state.branch,
        "separation": _text(state.separation, error.separation, units.separation[0]),
        "mean_pressure": _text(state.mean_pressure, error.mean_pressure, units.load[0]) if _known(state) else "any",
        "contact_fraction": _text(state.contact_fraction, error.contact_fraction, 1.0),
        "open": NO_NUMBER if apart is None else _text(apart, relative * apart, units.open[0]),
        "contacts": "complete" if state.status == "complete_contact" else str(state.n_patches),
        "words": _words(point, period, units),
    }


def _text(value: float, error: float | None, factor: float) -> str:
    """Return a number in the units of the page with the digits that its error allows."""
    relative = abs((error or 0.0) / value) if value and math.isfinite(error or 0.0) else 0.0
    return fixed(value * factor, digits(relative)).replace("-", "\N{MINUS SIGN}")


def _words(point: PathState, period: float, units: Units) -> str:
    """Return what happened since the state before."""
    if point.jump == "before":
        return "just before the jump"
    events = [_event_words(event, period, units) for event in point.events[:SPELT]]
    if len(point.events) > SPELT:
        events.append(f"{len(point.events) - SPELT} more events")
    status = STATUS.get(point.state.status)
    return "; ".join(events) or status or ""


def _event_words(event: Event, period: float, units: Units) -> str:
    short, name = short_name(event), NAMES[event.kind][1]
    words = name if short in name else f"{short}: {name}"
    if event.position is not None:
        factor, unit = units.x
        words += f" at {fixed(event.position % period * factor, 3)} {unit}"
    if event.energy_released:
        error = event.error_estimate.energy_released or 0.0
        words += f", {readable(event.energy_released, 'J/m²', digits(error / abs(event.energy_released)))} released"
    return words


def short_name(event: Event) -> str:
    """Return a name of one word or two."""
    return TOUCH if event.kind == "first_touch" and not event.energy_released else NAMES[event.kind][0]


def _drawn(point: PathState, index: int, fields: Fields, units: Units) -> dict[str, Any]:
    """Return the numbers of a state that its drawing needs; `place` is its index on the path.

    `target`: it is at a target and touches.
    """
    state, (factor, _) = point.state, units.x
    return {
        "place": index,
        "target": state.target and state.contact_fraction > 0,
        "branch": state.branch,
        "status": state.status,
        "separation": state.separation * units.height[0],
        "undetermined": not _known(state),
        "jump": point.jump,
        "edges": [[_short(a * factor), _short(b * factor)] for a, b in state.edges],
        "counts": [pressure.size for pressure in fields.pressure],
        "events": [
            {
                "short": short_name(event),
                "way": NAMES[event.kind][2],
                "x": None if event.position is None else _short(event.position * factor),
            }
            for event in point.events
        ],
    }


def _short(value: float) -> float:
    return float(f"{value:.7g}")


def _curves(path: list[PathState], units: Units) -> dict[str, Any]:
    """Return separation, contact fraction, mean open gap and mean pressure along the path, and its joins."""
    states = [point.state for point in path]
    share = np.array([state.contact_fraction for state in states])
    apart = np.array([state.separation for state in states])
    opened = np.where(share < 1, apart / np.where(share < 1, 1 - share, 1.0), np.nan) * units.open[0]
    load = np.array([state.mean_pressure for state in states]) * units.load[0]
    columns = {"separation": apart * units.separation[0], "fraction": share, "open": opened, "load": load}
    touching = [state.separation for state in states if state.contact_fraction > 0]
    reach = touching if len(set(touching)) > 1 else [state.separation for state in states]
    return {name: _packed(values) for name, values in columns.items()} | {
        "joins": joins_of(path),
        "reach": [min(reach) * units.separation[0], max(reach) * units.separation[0]],
    }


def _packed(values: FloatArray) -> dict[str, Any]:
    """Return numbers as base64 of 16 bits each, with the least value and the step that undo it; nan as `MISSING`."""
    known = values[np.isfinite(values)]
    low, span = (float(np.min(known)), float(np.ptp(known))) if known.size else (0.0, 0.0)
    scaled = np.clip((values - low) * ((MISSING - 1) / span if span else 0.0), 0, MISSING - 1)
    codes = np.where(np.isfinite(values), np.rint(np.nan_to_num(scaled)), MISSING).astype("<u2")
    return {"low": low, "step": span / (MISSING - 1), "codes": base64.b64encode(codes.tobytes()).decode()}
