"""report.html of a run: its answer first, then how well it is known and what was asked; from its result alone.

The uncertainty of the input is that of a study of the same scene, where its study.json lies beside the result.
"""

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from bem.command_line.answer_table import Inputs, csv_text, heads, pull_off_words, rows, share
from bem.command_line.console import scene_text
from bem.cut_sensitivity import in_words
from bem.scene.atomic_file import write_atomically
from bem.scene.plausibility import MEANINGS
from bem.scene.result import FINAL_STATUSES, Result, State
from bem.scene.result_file import read_result
from validation.report.figures import svg_of
from validation.report.render import PAGE, ReportError, filled, number
from validation.report.run_figures import MOST_SHAPES, figures_of, shape_states
from validation.report.run_words import outcome, quantity, scene_in_words, succeeded
from validation.report.study_page import DOUBTFUL
from validation.report.study_page import FILE as STUDY

TABLE = "answer.csv"
FRACTION = "contact_fraction"
FEW_EVENTS = 20  # more are folded
SAME = 1e-6  # relative distance of the numbers of a run and of its study
MOST_ROWS = 500  # of a table; all are in result.json
MEASURES = ("closure", "contact_residual", "min_gap", "mean_gap_error", "min_eigenvalue", "truncation",
            "hessian_asymmetry")  # fmt: skip
NOTHING: tuple[str, float | str] = ("–", "")  # in a cell, and to be sorted by
WORST_BELOW = ("min_gap", "min_eigenvalue")  # of which the least is the worst
UNITS = {"min_gap": "m", "mean_gap_error": "m", "rms_height": "m", "pressure_scale": "Pa"}  # of what is no ratio


def write_run_page(folder: Path) -> Result:
    """Render the result of a folder (`read_result`) into report.html and answer.csv beside it; the result."""
    result = read_result(folder)
    write_atomically(folder / PAGE, render_run(result, inputs_of(result, folder)))
    write_atomically(folder / TABLE, csv_text(result))
    return result


def inputs_of(result: Result, folder: Path) -> dict[int, dict[str, float]]:
    """Relative uncertainty of the input by target and quantity, from the study of the same scene in the folder.

    Nothing where there is none, or where it is of another scene or another path.
    """
    try:
        study = json.loads((folder / STUDY).read_text("utf-8"))
        if study["status"] != "done" or study["scene_sha256"] != result.provenance["scene_sha256"]:
            return {}
        met = [k for k, state in enumerate(result.targets) if state.status in FINAL_STATUSES]
        found: dict[int, dict[str, float]] = {}
        for row in study["targets"]:
            name = str(row["quantity"]).replace(" ", "_")
            place = len(found) - (name != FRACTION)
            if abs(row["value"] - getattr(result.targets[met[place]], name)) > SAME * abs(row["value"]):
                return {}
            found.setdefault(met[place], {})[name] = math.nan if row["input"] is None else row["input"]
    except FileNotFoundError:
        return {}
    except (ValueError, KeyError, TypeError, IndexError, AttributeError, RecursionError) as error:
        raise ReportError(f"{folder / STUDY}: not the study of a scene ({error})") from error
    return found


def render_run(result: Result, inputs: Inputs | None = None) -> str:
    """The page of a run as text; relative uncertainties of the input are by target and quantity."""
    left_open = max((value for known in (inputs or {}).values() for value in known.values()), default=math.nan)
    found = replace(result, states=tuple(state for state in result.states if state.found))
    shapes = len(shape_states(found))
    banner = ("doubtful", "!") if left_open > DOUBTFUL else ("agrees", "✓")
    if not succeeded(result):
        banner = "deviates", "✗"
    return filled(
        "run_page.jinja",
        title=result.scene["title"] or "A run",
        result=result,
        outcome=outcome(result),
        banner=banner,
        left_open="" if math.isnan(left_open) else share(left_open),
        heads=heads(result),
        answer=list(rows(result, inputs))[:MOST_ROWS],
        pull_off=pull_off_words(result),
        cut=in_words(result.cut_sensitivity) if result.cut_sensitivity else "",
        words=scene_in_words(result.scene),
        toml=scene_text(result.scene),
        groups=[(name, _measure(name, value), MEANINGS.get(name, "")) for name, value in result.groups.items()],
        warnings=result.warnings,
        preparation=[_step(step) for step in result.profile_preparation],
        figures=[(figure, svg_of(figure, f"run-{figure.id}")) for figure in figures_of(found)],
        shapes_left_out=max(0, shapes - MOST_SHAPES),
        targets=[_target(state) for state in result.targets[:MOST_ROWS]],
        events=list(_events(found))[:MOST_ROWS],
        most=MOST_ROWS,
        few=FEW_EVENTS,
        certificate=list(_certificate(result)),
        found=found.states,
        missed=[state for state in result.states if not state.found],
        refused=[state for state in found.states if not state.certificate.ok],
        predicted=sum(effect.seconds for effect in result.effects),
        seconds=sum(state.cpu_seconds for state in result.states),
        evaluations=sum(state.evaluations for state in result.states),
        unknowns=max((state.unknowns for state in result.states), default=0),
    )


def _target(state: State) -> list[tuple[str, float | str]]:
    """Cells of a state: text, and the number or text that it is sorted by."""
    estimate = state.error_estimate
    cells: list[tuple[str, float | str]] = [(state.branch, state.branch)]
    for name in ("separation", "mean_pressure", "contact_fraction"):
        value = getattr(state, name)
        unknown = math.isnan(value) and not state.found
        cells.append(NOTHING if unknown else (_known(value, getattr(estimate, name)), value))
    cells.append((str(state.n_patches), state.n_patches) if state.found else NOTHING)
    judged = "certified" if state.certificate.ok else "refused" if state.found else "–"
    return [*cells, (state.status.replace("_", " "), state.status), (judged, judged)]


def _events(result: Result) -> Iterator[list[tuple[str, float | str]]]:
    highest = result.states[0].penetration + result.states[0].separation if result.states else 0.0
    for event in result.events:
        error, place, energy = event.error_estimate, event.position, event.energy_released
        yield [
            (event.kind.replace("_", " "), event.kind),
            (_known(highest - event.penetration, error.penetration), highest - event.penetration),
            (_known(event.mean_pressure, error.mean_pressure), event.mean_pressure),
            NOTHING if place is None else (f"{place:.6g}", place),
            NOTHING if energy is None else (_known(energy, error.energy_released), energy),
        ]


def _known(value: float, error: float | None) -> str:
    """A number with its estimated error: as many digits as that leaves, nine at most."""
    return f"{value:.9g}" if not error else f"{value:.9g} ± {error:.1g}"


def _certificate(result: Result) -> Iterator[tuple[str, str]]:
    """The worst of each measure over all states."""
    for name in MEASURES:
        values = [value for state in result.states if (value := getattr(state.certificate, name)) is not None]
        if values:
            worst = min(values) if name in WORST_BELOW else max(values)
            yield name.replace("_", " "), _measure(name, worst)


def _measure(name: str, value: float) -> str:
    """A number with its unit, where it has one."""
    return quantity(value, UNITS[name]) if name in UNITS else number(value)


def _step(step: Mapping[str, Any]) -> tuple[str, str]:
    """A step of the preparation of a scan: its name, and what it did."""
    facts = {key: value for key, value in step.items() if key != "step"}
    said = [f"{key.replace('_', ' ')} {_plain(value)}" for key, value in facts.items()]
    return str(step.get("step", "")), ", ".join(said)


def _plain(value: Any) -> str:
    """A number, or one before and one after."""
    return " → ".join(map(_plain, value)) if isinstance(value, list | tuple) else str(number(value))
