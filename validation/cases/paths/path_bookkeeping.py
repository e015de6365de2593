"""What a path keeps: the first of several states at a load, targets in order, and the same path taken up again.

A load that an event lowers is met twice; the state asked for is the first, which states close to each other enclose.
A path that is interrupted and taken up, or begun from a stored state, goes through the same states and events bit for
bit, also between targets.  SI units.
"""

import tempfile
import tomllib
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import bem
from bem.scene.result import Event, Result, State
from bem.scene.result_file import write_result
from bem.scene.scene import parse_scene
from validation.cases.shared.checks import Against, case, column, solved
from validation.harness.case import Outcome
from validation.references.adapters import scene_text

STOPS = (70e-6, 56e-6, 42e-6)  # separations in m, there and back
MET_TWICE = {1381.208: 61.8e-6, 3558.97: 48.3e-6}  # mean pressures in Pa, and separations in m between their two states
ASKED = (*MET_TWICE, 2000.0, 2002.0)  # the last two within one increment
AROUND, SPACING = 8, 0.05e-6
RESTARTED = (60e-6, 42e-6, 62e-6)
ADHESION = {"work_of_adhesion": 0.05}


def _crossed() -> Outcome:
    there, between, back = STOPS
    ways: dict[str, Any] = {"start": there, "stop": back, "count": 3, "then_back_to": there, "targets": None}
    states = solved("rough_100", adhesion=ADHESION, loading={**ways, "at_mean_pressures": list(ASKED)}).targets
    known = []
    for load, middle in MET_TWICE.items():
        near = (middle + SPACING * np.arange(AROUND, -AROUND - 1, -1)).tolist()
        known.append(_first(solved("rough_100", adhesion=ADHESION, loading={"targets": [there, *near]}).targets, load))
    found = [next((s.contact_fraction for s in states if _is(s, load)), float("nan")) for load in MET_TWICE]
    pressures, separations = (
        column((state for state in states if any(_is(state, load) for load in ASKED) == asked), name)
        for name, asked in (("mean_pressure", True), ("separation", False))
    )
    scene, measured = Against("exact", "the scene"), 8e-13
    loads, places = [*sorted(ASKED), *sorted(ASKED, reverse=True)], [there, between, back, between, there]
    rows = (
        Against("self", "states 0.05 um apart, between which the load is first passed").row(
            "contact fraction at loads that are met twice", "", known, found, 1.2e-4),  # next to a fold
        scene.row("mean pressures asked for, in order", "Pa", loads, _as_many(pressures, loads), measured),
        scene.row("separations asked for, in order", "m", places, _as_many(separations, places), measured),
    )  # fmt: skip
    return Outcome(rows=rows, counts={"evaluations": sum(state.evaluations for state in states)})


def _is(state: State, load: float) -> bool:
    return abs(state.mean_pressure - load) < 1e-6 * load


def _as_many(values: list[float], expected: Sequence[float]) -> list[float]:
    """Values in order; another number of them is as wrong as can be."""
    return values if len(values) == len(expected) else [0.0] * len(expected)


def _first(states: Sequence[State], load: float) -> float:
    """Contact fraction at which a load in Pa is first passed."""
    for first, second in pairwise(states):
        if first.mean_pressure < load <= second.mean_pressure:
            share = (load - first.mean_pressure) / (second.mean_pressure - first.mean_pressure)
            return first.contact_fraction + share * (second.contact_fraction - first.contact_fraction)
    return float("nan")


def _restarted() -> Outcome:
    tables = tomllib.loads(scene_text("rough_100"))
    tables |= {"profile": {**tables["profile"], "harmonics": 40}, "adhesion": {"work_of_adhesion": 0.1}}
    loading: dict[str, Any] = {"control": "separation", "targets": list(RESTARTED)}
    tables |= {"output": {"shapes": list(RESTARTED)}}
    whole_scene, kept = parse_scene({**tables, "loading": loading}), list[Result]()
    whole = bem.solve(whole_scene, on_state=lambda record: kept.append(record.result("interrupted")))
    first = next(index for index, state in enumerate(whole.states) if state.target)
    before = len(kept[first].events)
    taken_up = bem.solve(whole_scene, resume=kept[first])
    with tempfile.TemporaryDirectory() as folder:
        write_result(kept[first], Path(folder) / "stored")
        stored = {"targets": list(RESTARTED[1:]), "initial": {"result": "stored", "state": first}}
        begun = bem.solve(parse_scene({**tables, "loading": {**loading, **stored}}, folder))
    ways: dict[str, tuple[Sequence[State], Sequence[Event]]] = {
        "taken up": (taken_up.states[first + 1 :], taken_up.events[before:]),
        "begun from a stored state": (begun.states, begun.events),
    }
    known, bit_for_bit, rows = Against("self", "the whole path"), (1e-16, 0.0), []
    for way, (states, events) in ways.items():
        for what, apart in (
            ("states", _apart(whole.states[first + 1 :], states, "branch", OF_STATES)),
            ("events", _apart(whole.events[before:], events, "kind", OF_EVENTS)),
        ):
            rows.append(known.row(f"{what} of a path {way}: difference", "", [0.0] * len(apart), apart, bit_for_bit,
                                  "absolute"))  # fmt: skip
    fields = [*_fields_apart(whole, taken_up, 0), *_fields_apart(whole, begun, 1)]
    rows.append(known.row("shapes stored by either: difference", "", [0.0] * len(fields), fields, bit_for_bit,
                          "absolute"))  # fmt: skip
    return Outcome(rows=tuple(rows))


OF_STATES = ("penetration", "mean_pressure", "contact_fraction", "total_energy", "n_patches")
OF_EVENTS = ("penetration", "energy_released")
SHAPES = ("x", "displacement", "gap", "pressure", "patch")


def _apart(known: Sequence[Any], found: Sequence[Any], like: str, names: Sequence[str]) -> list[float]:
    """By how much numbers differ, over the largest of each; others, or of another `like`, are zeros."""
    alike = column(known, like) == column(found, like)
    differences = []
    for name in names:
        values = [value or 0.0 for value in column(known, name)]
        others = [value or 0.0 for value in column(found, name)] if alike else [0.0] * len(values)
        differences += [(other - one) / max(map(abs, values)) for one, other in zip(values, others, strict=True)]
    return differences


def _fields_apart(known: Result, found: Result, before: int) -> list[float]:
    """By how much stored shapes differ, but for so many, over the largest of each; one that is missing is zeros."""
    differences = []
    for index in range(before, sum(name.startswith("x_") for name in known.fields)):
        for name in SHAPES:
            one = np.nan_to_num(known.fields[f"{name}_{index}"])
            other = np.nan_to_num(found.fields.get(f"{name}_{index - before}", np.zeros(one.shape)))
            alike = other if other.shape == one.shape else np.zeros(one.shape)
            differences.append(float(np.max(np.abs(alike - one)) / np.max(np.abs(one))))
    return differences


HISTORY = "half_space adhesion slope_term unloading"
CASES = (
    case("first-crossing", "path", _crossed,
         "Are the states at mean pressures asked for the first on the way, and all targets met in order?",
         r"$p(s) = p_{\text{asked}}$ for the first time since the path turned",
         "carbone2009", HISTORY, scene="rough_100"),
    case("restarted-path", "path", _restarted,
         "Does a path taken up again, or begun from a stored state, go through the same states and events?",
         "a state holds all that its path depends on",
         "carbone2009", HISTORY, scene="rough_100"),
)  # fmt: skip
