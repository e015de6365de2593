"""report.html of a run: its answer first, then how well it is known and what was asked; from its result alone.

The uncertainty of the input comes from a study of this scene, where study.json lies beside the result.
"""

import json
import math
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

from markupsafe import Markup
from pydantic import ConfigDict, Field, TypeAdapter, ValidationError
from threadpoolctl import threadpool_limits

from bem.command_line.answer_table import (
    PULL_OFF,
    Inputs,
    Unit,
    answer,
    csv_text,
    pull_off_words,
    quantity,
    share,
    slope_words,
    units_of,
)
from bem.command_line.console import scene_text
from bem.command_line.preparation_words import preparation_sentences
from bem.geometry.regular_file import read_regular
from bem.scene.atomic_file import write_atomically
from bem.scene.plausibility import MEANINGS
from bem.scene.result import Result, asked_for
from bem.scene.result_file import read_result
from bem.scene.result_views import UNITS as RESULT_UNITS
from bem.scene.state import LARGEST, State
from bem.scene.stored_json import verified
from validation.report.figures import svg_of
from validation.report.moving_path import moving_path
from validation.report.pages import PAGE, ReportError, asset, filled, judgement, number
from validation.report.run_figures import figures_of, theories_of
from validation.report.run_words import outcome, scene_in_words, succeeded

TABLE = "answer.csv"
STUDY = "study.json"
STUDIED_PULL_OFF = "pull-off"  # answer of a study, of the path
STUDIED = {  # answers of a study, as quantities of the answer
    "contact fraction": "contact_fraction",
    "mean pressure": "mean_pressure",
    "separation": "separation",
    "mean open gap": "open_gap_mean",
    "largest open gap": "open_gap_largest",
    "gap for flow": "mean_cubic_root",
    "widest open channel": "widest_channel",
    "peak pressure": "peak_pressure",
}
DOUBTFUL = 0.1  # relative uncertainty of the input beyond which an answer is no more than a hint
FEW_EVENTS = 20  # more are folded
SAME = 1e-6  # relative distance of the numbers of a run and of its study
MOST_ROWS = 500  # of a table; all are in result.json
MEASURES = {
    "closure": "largest |G/w - 1| at an edge, without adhesion |K| over that of a flat punch: 0 in equilibrium",
    "contact_residual": "how far surface and profile are apart in contact, over the rise of the profile there: 0",
    "min_gap": "smallest gap beside the contacts: none may be negative beyond rounding",
    "mean_gap_error": "mean gap, integrated, less the separation: 0",
    "min_eigenvalue": "smallest resistance of the edges to a motion, scaled: positive in a stable state",
    "truncation": "last coefficients of the pressure of a contact over its largest: 0 where enough are kept",
    "hessian_asymmetry": "difference of two second derivatives of the energy that are equal: 0",
}
Cell = tuple[str, float | str]  # text, and what it is sorted by
NOTHING: Cell = ("–", "")  # in a cell, and to be sorted by
WORST_BELOW = ("min_gap", "min_eigenvalue")  # of which the least is the worst
UNITS = {"min_gap": "m", "mean_gap_error": "m", "rms_height": "m", "pressure_scale": "Pa"}  # of what is no ratio


@dataclass(frozen=True)
class StudiedAnswer:
    """Answer in a study.json; `input` is its uncertainty by the choices of the scene, None where none was varied."""

    quantity: str
    target: int | None
    value: Annotated[float, Field(gt=-LARGEST, lt=LARGEST)]
    input: Annotated[float, Field(ge=0, lt=LARGEST)] | None = None


@dataclass(frozen=True)
class Study:
    """Part of a study.json that a page shows; an unfinished study has no answers."""

    __pydantic_config__ = ConfigDict(strict=True, extra="ignore", allow_inf_nan=False)

    scene_sha256: str
    answers: list[StudiedAnswer] | None = None


def write_run_page(folder: Path) -> Result:
    """Render the result of a folder (`read_result`) into report.html and answer.csv beside it; the result."""
    result = read_result(folder)
    inputs = inputs_of(result, folder)
    with threadpool_limits(limits=1, user_api="blas"):  # two threads are slower for small systems
        page = render_run(result, inputs)
    write_atomically(folder / PAGE, page)
    write_atomically(folder / TABLE, csv_text(result, inputs))
    return result


def inputs_of(result: Result, folder: Path) -> dict[int | None, dict[str, float]]:
    """Return the uncertainty of the input (SI) by target and quantity, from the study of the scene in the folder.

    Nothing where there is no study, or where it is unfinished, of another scene or of another path.
    """
    path = folder / STUDY
    try:
        study = TypeAdapter(Study).validate_json(json.dumps(verified(read_regular(path), str(path))))
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise ReportError(f"{path}: not the study of a scene: {error.strerror}") from error
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(map(str, first["loc"])) or "the file"
        raise ReportError(f"{path}: not the study of a scene: {key}: {first['msg']}") from error
    if study.scene_sha256 != result.provenance["scene_sha256"] or study.answers is None:
        return {}
    places = {state.index: k for k, state in enumerate(result.targets)}
    tension, answers = result.largest_tension, result.to_table("targets")
    inputs: dict[int | None, dict[str, float]] = {}
    for k, row in enumerate(study.answers):
        if row.target is None and row.quantity == STUDIED_PULL_OFF:
            if tension is None or abs(row.value + tension.mean_pressure) > SAME * abs(row.value):
                return {}
            if row.input is not None:
                inputs[None] = {PULL_OFF: row.input}
        if row.quantity not in STUDIED:
            continue
        if row.target not in places:
            raise ReportError(f"{path}: not the study of a scene: answers.{k}.target is {row.target}, no target")
        place, name = places[row.target], STUDIED[row.quantity]
        if abs(row.value - float(answers[name][place])) > SAME * abs(row.value):
            return {}
        if row.input is not None:
            inputs.setdefault(place, {})[name] = row.input
    return inputs


def render_run(result: Result, inputs: Inputs | None = None) -> str:
    """Return the page of a run as text; uncertainties of the input (SI) are by target and quantity."""
    left_open, words = largest_input(result, inputs or {})
    solved = replace(result, states=tuple(state for state in result.states if state.found))
    theories = theories_of(solved)
    good, units = succeeded(result), units_of(result)
    return filled(
        "run_page.jinja",
        {"measure": _measure},
        heading=result.scene["title"] or "A run",
        result=result,
        outcome=outcome(result),
        verdict=_verdict(good, left_open),
        good=good,
        left_open=words,
        answer=answer(result, inputs),
        units={name: unit for name, (_, unit) in units.items()},
        pull_off=pull_off_words(result, inputs),
        slope=slope_words(result),
        words=scene_in_words(result.scene),
        toml=scene_text(result.scene),
        meanings=defaultdict(str, MEANINGS),
        preparation=preparation_sentences(result.profile_preparation),
        path=moving_path(result),
        moving_style=Markup(asset("moving.css")),
        moving_script=Markup(asset("moving.js")),
        figures=[(figure, svg_of(figure, f"run-{figure.id}")) for figure in figures_of(solved, theories)],
        targets=[_target(state, units) for state in result.targets[:MOST_ROWS]],
        events=list(_events(solved, units))[:MOST_ROWS],
        most=MOST_ROWS,
        few=FEW_EVENTS,
        certificate=list(_certificate(result)),
        found=solved.states,
    )


def largest_input(result: Result, inputs: Inputs) -> tuple[float, str]:
    """Return the largest uncertainty of the input over its number, and words; NaN and no words without a study.

    A number of zero has its uncertainty in the table.
    """
    answers, shares, loading = result.to_table("targets"), [], result.scene["loading"]
    for place, known in inputs.items():
        for name, uncertainty in known.items():
            if place is None:
                value = 0.0 if result.largest_tension is None else -result.largest_tension.mean_pressure
                of = "of the pull-off"
            else:
                value, state = float(answers[name][place]), result.targets[place]
                held, asked = asked_for(loading, state.index or 0)
                of = f"of the {name.replace('_', ' ')} at {quantity(asked, RESULT_UNITS[held])}, {state.branch}"
            if value:
                shares.append((uncertainty / abs(value), of))
    if not shares:
        return math.nan, ""
    largest_share, of = max(shares)
    return largest_share, f"{share(largest_share)} {of}"


def _verdict(good: bool, left_open: float) -> tuple[str, str]:
    """Return class and mark of the banner: neutral without a study, as nothing is known of the input."""
    if not good:
        return judgement(False)
    if math.isnan(left_open):
        return "neutral", ""
    return ("doubtful", "!") if left_open > DOUBTFUL else judgement(True)


def _target(state: State, units: Mapping[str, Unit]) -> list[Cell]:
    """Return the cells of a state."""
    error = state.error_estimate
    numbers = []
    for name in ("separation", "mean_pressure", "contact_fraction"):
        value = getattr(state, name)
        unknown = math.isnan(value) and not state.found
        numbers.append(_cell(None if unknown else value, getattr(error, name), units.get(name)))
    count = "complete" if state.status == "complete_contact" else str(state.n_patches)
    patches = (count, state.n_patches) if state.found else NOTHING
    judged = "certified" if state.certificate.ok else "refused" if state.found else "–"
    return [
        (state.branch, state.branch),
        *numbers,
        patches,
        (state.status.replace("_", " "), state.status),
        (judged, judged),
    ]


def _events(result: Result, units: Mapping[str, Unit]) -> Iterator[list[Cell]]:
    highest = result.states[0].penetration + result.states[0].separation if result.states else 0.0
    for event in result.events:
        error, place = event.error_estimate, event.position
        yield [
            (event.kind.replace("_", " "), event.kind),
            _cell(highest - event.penetration, error.penetration, units["separation"]),
            _cell(event.mean_pressure, error.mean_pressure, units["mean_pressure"]),
            NOTHING if place is None else (f"{place:.6g}", place),
            _cell(event.energy_released, error.energy_released),
        ]


def _cell(value: float | None, error: float | None, unit: Unit | None = None) -> Cell:
    """Return a number with its estimated error, nine digits at most, in a unit or as it is."""
    if value is None:
        return NOTHING
    if unit is not None:
        value, error = value * unit[0], error and error * unit[0]
    return (f"{value:.9g} ± {error:.1g}" if error else f"{value:.9g}"), value


def _certificate(result: Result) -> Iterator[tuple[str, str, str]]:
    """Yield the worst of each measure over all states, and its meaning."""
    for name, meaning in MEASURES.items():
        values = [value for state in result.states if (value := getattr(state.certificate, name)) is not None]
        if values:
            worst = min(values) if name in WORST_BELOW else max(values)
            yield name.replace("_", " "), _measure(worst, name), meaning


def _measure(value: float, name: str) -> str:
    """Return a number with its unit, if it has a unit."""
    return quantity(value, UNITS[name]) if name in UNITS else number(value)
