"""What a path keeps: the first of several states at a load, targets in order, the same path in steps or taken up again.

A quarter of the increment changes nothing beyond the tolerance.
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
from bem.scene.result import Event, Progress, Result, State
from bem.scene.result_file import write_result
from bem.scene.scene import parse_scene
from validation.cases.shared.checks import OVER_STATES, Against, Found, as_many, case, column, posed, solved, work
from validation.harness.figure_data import axes, drawn, marks, table, trace
from validation.references.adapters import scene_text

INCREMENTS = (0.05, 0.0125)
# quantity of events, its name, unit, error measured: the largest over the BLAS kernels of four processors
TOLD_OF_EVENTS = (
    ("penetration", "penetration", "m", 7.2e-13),
    ("mean pressure", "mean_pressure", "Pa", 9.2e-12),
    ("energy released", "energy_released", "J/m^2", 3.1e-13),
)
STOPS = (70e-6, 56e-6, 42e-6)  # separations in m, there and back
MET_TWICE = {1381.208: 61.8e-6, 3558.97: 48.3e-6}  # mean pressures in Pa, and separations in m between their two states
ASKED = (*MET_TWICE, 2000.0, 2002.0)  # the last two within one increment
AROUND, SPACING = 8, 0.05e-6
RESTARTED = (60e-6, 42e-6, 62e-6)
ADHESION = {"work_of_adhesion": 0.05}


def _in_increments(increment: float) -> tuple[Result, dict[str, int]]:
    """The scene at one largest increment, and the increments accepted and rejected."""
    seen: list[Progress] = []
    result = bem.solve(posed("rough_100", accuracy={"max_increment": increment}), progress=seen.append)
    return result, {"accepted": seen[-1].increments_accepted, "rejected": seen[-1].increments_rejected}


def _path_convergence() -> Found:
    (first, first_counts), (second, second_counts) = map(_in_increments, INCREMENTS)
    coarse, fine = first.targets, second.targets
    known = Against("self", f"the same path at increments of {INCREMENTS[1]} rms heights")
    fractions, pressures = column(fine, "contact_fraction"), column(fine, "mean_pressure")
    yield known.row("contact fraction at every target", "", fractions, column(coarse, "contact_fraction"), 7e-13,
                    OVER_STATES, 1.0)  # fmt: skip
    yield known.row("mean pressure at every target, over the largest", "Pa", pressures, column(coarse, "mean_pressure"),
                    3.6e-13, OVER_STATES, max(map(abs, pressures)))  # fmt: skip
    yield known.count("patches at every target", column(fine, "n_patches"), column(coarse, "n_patches"))
    for words, name, unit, measured in TOLD_OF_EVENTS:
        values, others = ([value or 0.0 for value in column(result.events, name)] for result in (second, first))
        yield known.row(f"{words} of every event, over the largest", unit, values, as_many(others, values), measured,
                        OVER_STATES, max(map(abs, values)))  # fmt: skip
    counts = [first_counts | work("events evaluations", first), second_counts | work("events evaluations", second)]
    yield table("Increments along the path, in rms heights; a rejected one is repeated shorter.",
                {"largest increment": INCREMENTS}
                | {name: [count[name] for count in counts] for name in counts[0]})  # fmt: skip
    at, apart = column(fine, "separation", 1e-6), np.subtract(column(coarse, "contact_fraction"), fractions)
    yield drawn("path-convergence", "Contact fraction at the targets for two sizes of increment.",
                axes("separation / um", "contact fraction",
                     marks(f"increment {INCREMENTS[0]}", at, column(coarse, "contact_fraction")),
                     trace(f"increment {INCREMENTS[1]}", at, fractions)),
                axes("separation / um", "coarse less fine", marks("contact fraction", at, apart)))  # fmt: skip
    yield work("evaluations", first, second)


def _crossed() -> Found:
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
    # next to a fold
    yield Against("self", "states 0.05 um apart, between which the load is first passed").row(
        "contact fraction at loads that are met twice", "", known, found, 1.2e-4)  # fmt: skip
    yield scene.row("mean pressures asked for, in order", "Pa", loads, as_many(pressures, loads), measured)
    yield scene.row("separations asked for, in order", "m", places, as_many(separations, places), measured)
    yield {"evaluations": sum(state.evaluations for state in states)}


def _is(state: State, load: float) -> bool:
    return abs(state.mean_pressure - load) < 1e-6 * load


def _first(states: Sequence[State], load: float) -> float:
    """Contact fraction at which a load in Pa is first passed."""
    for first, second in pairwise(states):
        if first.mean_pressure < load <= second.mean_pressure:
            share = (load - first.mean_pressure) / (second.mean_pressure - first.mean_pressure)
            return first.contact_fraction + share * (second.contact_fraction - first.contact_fraction)
    return float("nan")


def _restarted() -> Found:
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
    known, bit_for_bit = Against("self", "the whole path"), (1e-16, 0.0)
    for way, (states, events) in ways.items():
        for what, apart in (
            ("states", _apart(whole.states[first + 1 :], states, "branch", OF_STATES)),
            ("events", _apart(whole.events[before:], events, "kind", OF_EVENTS)),
        ):
            yield known.row(f"{what} of a path {way}: difference", "", [0.0] * len(apart), apart, bit_for_bit,
                            "absolute")  # fmt: skip
    fields = [*_fields_apart(whole, taken_up, 0), *_fields_apart(whole, begun, 1)]
    yield known.row("shapes stored by either: difference", "", [0.0] * len(fields), fields, bit_for_bit, "absolute")


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
    case("path-convergence", "path", _path_convergence,
         "Is the state at a target independent of the increments on the way, through all events?",
         "increments of 0.05 and 0.0125 rms heights; events are the ends of branches",
         "carbone2009", "half_space adhesion slope_term unloading", scene="rough_100"),
    case("first-crossing", "path", _crossed,
         "Are the states at mean pressures asked for the first on the way, and all targets met in order?",
         r"$p(s) = p_{\text{asked}}$ for the first time since the path turned",
         "carbone2009", HISTORY, scene="rough_100"),
    case("restarted-path", "path", _restarted,
         "Does a path taken up again, or begun from a stored state, go through the same states and events?",
         "a state holds all that its path depends on",
         "carbone2009", HISTORY, scene="rough_100"),
)  # fmt: skip
