"""What a path keeps: the first of several states at a load, targets in order, and the same path taken up again.

A load that an event lowers is met twice; the state asked for is the first, which states close to each other enclose.
A path that is interrupted and taken up, or begun from a stored state, goes through the same states and events bit for
bit, also between targets.  SI units.
"""

from __future__ import annotations

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
from validation.harness.case import Case, Outcome
from validation.harness.rows import compared
from validation.harness.schema import Reference, Row
from validation.references import adapters

STOPS = (70e-6, 56e-6, 42e-6)  # separations in m, there and back
MET_TWICE = {1381.208: 61.8e-6, 3558.97: 48.3e-6}  # mean pressures in Pa, and separations in m between their two states
ASKED = (*MET_TWICE, 2000.0, 2002.0)  # the last two within one increment
AROUND, SPACING = 8, 0.05e-6
RESTARTED = (60e-6, 42e-6, 62e-6)


def _crossed() -> Outcome:
    there, between, back = STOPS
    adhesion: Any = {"work_of_adhesion": 0.05}
    ways = {"start": there, "stop": back, "count": 3, "then_back_to": there, "targets": None}
    asked: dict[str, Any] = {"adhesion": adhesion, "loading": {**ways, "at_mean_pressures": list(ASKED)}}
    states = bem.solve(adapters.scene("rough_100", asked)).targets
    known = []
    for load, middle in MET_TWICE.items():
        near = (middle + SPACING * np.arange(AROUND, -AROUND - 1, -1)).tolist()
        close: dict[str, Any] = {"adhesion": adhesion, "loading": {"targets": [there, *near]}}
        known.append(_first(bem.solve(adapters.scene("rough_100", close)).targets, load))
    found = [next((s.contact_fraction for s in states if _is(s, load)), float("nan")) for load in MET_TWICE]
    pressures = [state.mean_pressure for state in states if _asked(state)]
    separations = [state.separation for state in states if not _asked(state)]
    rows = (
        compared("contact fraction at loads that are met twice", "",
                 Reference(kind="self", source="states 0.05 um apart, between which the load is first passed"), known,
                 found, 2.5 * MEASURED_FIRST, MEASURED_FIRST),
        _listed("mean pressures asked for, in order", "Pa", [*sorted(ASKED), *sorted(ASKED, reverse=True)], pressures),
        _listed("separations asked for, in order", "m", [there, between, back, between, there], separations),
    )  # fmt: skip
    return Outcome(rows=rows, counts={"evaluations": sum(state.evaluations for state in states)})


def _is(state: State, load: float) -> bool:
    return abs(state.mean_pressure - load) < 1e-6 * load


def _asked(state: State) -> bool:
    return any(_is(state, load) for load in ASKED)


def _first(states: Sequence[State], load: float) -> float:
    """Contact fraction at which a load in Pa is first passed."""
    for first, second in pairwise(states):
        if first.mean_pressure < load <= second.mean_pressure:
            share = (load - first.mean_pressure) / (second.mean_pressure - first.mean_pressure)
            return first.contact_fraction + share * (second.contact_fraction - first.contact_fraction)
    return float("nan")


def _listed(quantity: str, unit: str, expected: Sequence[float], computed: Sequence[float]) -> Row:
    """Values in order; another number of them is as wrong as can be."""
    found = computed if len(computed) == len(expected) else [0.0] * len(expected)
    source = Reference(kind="exact", source="the scene")
    return compared(quantity, unit, source, expected, found, 2.5 * MEASURED_LISTED, MEASURED_LISTED)


def _restarted() -> Outcome:
    posed = tomllib.loads(adapters.scene_text("rough_100"))
    posed |= {"profile": {**posed["profile"], "harmonics": 40}, "adhesion": {"work_of_adhesion": 0.1}}
    loading: dict[str, Any] = {"control": "separation", "targets": list(RESTARTED)}
    whole_scene = parse_scene({**posed, "loading": loading})
    kept: list[Result] = []
    whole = bem.solve(whole_scene, on_state=lambda record: kept.append(record.result("interrupted")))
    first = next(index for index, state in enumerate(whole.states) if state.target)
    before = len(kept[first].events)
    taken_up = bem.solve(whole_scene, resume=kept[first])
    with tempfile.TemporaryDirectory() as folder:
        write_result(kept[first], Path(folder) / "stored")
        stored = {"targets": list(RESTARTED[1:]), "initial": {"result": "stored", "state": first}}
        begun = bem.solve(parse_scene({**posed, "loading": {**loading, **stored}}, folder))
    ways = {
        "taken up": (taken_up.states[first + 1 :], taken_up.events[before:]),
        "begun from a stored state": (begun.states, begun.events),
    }
    same = Reference(kind="self", source="the whole path")
    rows = []
    for name, (states, events) in ways.items():
        later, happened = _of_states(whole.states[first + 1 :], states), _of_events(whole.events[before:], events)
        rows += [
            compared(f"{what} of a path {name}: difference", "", same, [0.0] * len(apart), apart, SAME, 0.0, "absolute")
            for what, apart in (("states", later), ("events", happened))
        ]
    return Outcome(rows=tuple(rows))


def _of_states(known: Sequence[State], found: Sequence[State]) -> list[float]:
    """By how much quantities of states differ, over the largest of each; fewer or more of them are zeros."""
    alike = [state.branch for state in known] == [state.branch for state in found]

    def values(states: Sequence[State]) -> list[list[float]]:
        quantities = ("penetration", "mean_pressure", "contact_fraction", "total_energy")
        return [[getattr(state, name) for state in states] for name in quantities]

    return _apart(values(known), values(found) if alike else [[0.0] * len(known)] * 4)


def _of_events(known: Sequence[Event], found: Sequence[Event]) -> list[float]:
    """By how much penetrations and energies of events differ, over the largest of each; other events are zeros."""
    alike = [event.kind for event in known] == [event.kind for event in found]

    def values(events: Sequence[Event]) -> list[list[float]]:
        return [[e.penetration for e in events], [e.energy_released or 0.0 for e in events]]

    return _apart(values(known), values(found) if alike else [[0.0] * len(known)] * 2)


def _apart(known: list[list[float]], found: list[list[float]]) -> list[float]:
    largest = [max(map(abs, values)) for values in known]
    return [
        (other - one) / top
        for ones, others, top in zip(known, found, largest, strict=True)
        for one, other in zip(ones, others, strict=True)
    ]


MEASURED_FIRST = 1.2e-4  # of states 0.05 um apart, next to a fold
MEASURED_LISTED = 8e-13
SAME = 1e-16  # bit for bit

CASES = (
    Case(id="first-crossing", group="path", level="quick",
         question="Are the states at mean pressures asked for the first on the way, and all targets met in order?",
         equations=r"$p(s) = p_{\text{asked}}$ for the first time since the path turned",
         sources=("carbone2009",), compute=_crossed, effects=("half_space", "adhesion", "slope_term", "unloading"),
         scene=adapters.scene_text("rough_100")),
    Case(id="restarted-path", group="path", level="quick",
         question="Does a path taken up again, or begun from a stored state, go through the same states and events?",
         equations="a state holds all that its path depends on",
         sources=("carbone2009",), compute=_restarted, effects=("half_space", "adhesion", "slope_term", "unloading"),
         scene=adapters.scene_text("rough_100")),
)  # fmt: skip
