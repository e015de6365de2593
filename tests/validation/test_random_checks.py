"""The checks of random scenes find what is wrong: results doctored one number at a time, each named."""

import warnings
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.special import ellipe

from bem.scene.scene import SceneError, parse_scene
from bem.solver import solve
from validation.corpus.hard import copies, scene_case
from validation.corpus.hard.any_result import SAFETY, Solved, balances, findings_of
from validation.corpus.hard.hard_case_run import run
from validation.corpus.hard.hard_case_scenes import rough, scene, waves
from validation.corpus.random import random_trial as trial
from validation.corpus.random.random_scenes import Drawn
from validation.references.dense_equilibrium import Interface
from validation.references.waves import Waves

WAVES = waves([1, 3], [40e-6, 15e-6]) | {"phases": [0.3, 1.0]}
PATHS = {
    "separation": scene(WAVES, "separation", [4e-5, 2e-5, 9e-5], 0.02, max_increment=0.08),
    "load": scene(WAVES, "mean_pressure", [8e3, 0.0], 0.02, max_increment=1.0),
    "layer": scene(WAVES, "total_displacement", [1.5e-5, 3e-5, 0.0], 0.02, thickness=1e-3, poisson_ratio=0.3),
    "bare": scene(WAVES, "penetration", [1e-5, 2e-5], max_increment=0.02),
}


@cache
def solved(name):
    posed = parse_scene(PATHS[name])
    return posed, solve(posed)


def taken(posed, result, tables=None, folder=Path()):
    """As copies and checks take it."""
    return Solved(tables, result, posed, folder)


def kinds(findings):
    return {finding.kind for finding in findings}


def changed(result, index, **values):
    """The result with values of one state replaced, numbers multiplied where a factor is given by a function."""
    states = list(result.states)
    index %= len(states)
    values = {name: new(getattr(states[index], name)) if callable(new) else new for name, new in values.items()}
    states[index] = replace(states[index], **values)
    return replace(result, states=tuple(states))


def event_changed(result, index, **values):
    events = list(result.events)
    values = {name: new(getattr(events[index], name)) if callable(new) else new for name, new in values.items()}
    events[index] = replace(events[index], **values)
    return replace(result, events=tuple(events))


def without_event(result, index):
    return replace(result, events=tuple(event for k, event in enumerate(result.events) if k != index))


def more_energy(share):
    """All energies of a state consistently larger."""

    def change(result, index=5):
        state = result.states[index]
        extra = share * abs(state.total_energy)
        return changed(
            result,
            index,
            elastic_energy=state.elastic_energy + extra,
            total_energy=state.total_energy + extra,
        )

    return change


def wider(result, index=-2, part=1e-7):
    """The last right edge of a state moved outward by a part of the period, and its contact fraction with it."""
    state = result.states[index]
    *others, (a, b) = state.edges
    return changed(
        result,
        index,
        edges=(*others, (a, b + part * 0.01)),
        contact_fraction=state.contact_fraction + part,
    )


@pytest.mark.parametrize("name", PATHS)
def test_nothing_is_found_against_a_sound_result(name):
    posed, result = solved(name)
    assert result.status == "converged"
    assert findings_of(taken(posed, result)) == []
    assert list(trial.dense_route(taken(posed, result))) == []


DOCTORED = {
    "status": (lambda r: replace(r, status="done"), "vocabulary"),
    "branch": (lambda r: changed(r, 1, branch="up"), "vocabulary"),
    "event kind": (lambda r: event_changed(r, 0, kind="snap"), "vocabulary"),
    "certificate": (lambda r: changed(r, 1, certificate=replace(r.states[1].certificate, ok=False)), "certificate"),
    "target dropped": (lambda r: replace(r, states=r.states[:-1]), "targets"),
    "target missed": (lambda r: changed(r, -1, separation=lambda s: s * (1 + 1e-9)), "targets"),
    "interrupted": (lambda r: replace(r, status="interrupted"), "targets"),
    "needlessly unreachable": (lambda r: replace(r, status="unreachable", states=r.states[:-1]), "unreachable"),
    "estimate is infinite": (
        lambda r: changed(r, 1, error_estimate=replace(r.states[1].error_estimate, mean_pressure=np.inf)),
        "not finite",
    ),
    "event is NaN": (lambda r: event_changed(r, 0, position=np.nan), "not finite"),
    "field is NaN": (lambda r: replace(r, fields={"gap_0": np.array([0.0, np.nan])}), "fields"),
    "area": (lambda r: changed(r, 1, contact_fraction=lambda a: a + 1e-9), "identity"),
    "patches": (lambda r: changed(r, 1, n_patches=7), "identity"),
    "edges in disorder": (lambda r: changed(r, 1, edges=lambda e: tuple((b, a) for a, b in e)), "identity"),
    "penetration": (lambda r: changed(r, 1, penetration=lambda d: d * (1 + 1e-6)), "identity"),
    "total energy": (lambda r: changed(r, 1, total_energy=lambda u: u * (1 + 1e-6)), "identity"),
    "converged without edges": (lambda r: changed(r, 1, edges=(), n_patches=0, contact_fraction=0.0), "identity"),
    "energy taken up": (lambda r: event_changed(r, 0, energy_released=-1e-6), "energy released"),
    "energy of a state": (more_energy(2e-2), "energy balance"),
    "pressure of all states": (
        lambda r: replace(r, states=tuple(replace(s, mean_pressure=s.mean_pressure * 1.05) for s in r.states)),
        "energy balance",
    ),
    "energy released": (lambda r: event_changed(r, 0, energy_released=lambda e: e * 1.01), "energy balance"),
    "event missing": (lambda r: without_event(r, 0), "vocabulary"),
}


@pytest.mark.parametrize("wrong", DOCTORED)
def test_what_is_wrong_with_a_result_is_named(wrong):
    doctor, kind = DOCTORED[wrong]
    posed, result = solved("separation")
    assert kind in kinds(findings_of(taken(posed, doctor(result))))


@pytest.mark.parametrize(("estimate", "found"), [(2e-9, False), (0.5e-9, True)], ids=["within its error", "beyond"])
def test_energy_taken_up_is_judged_with_its_error(estimate, found):
    posed, result = solved("separation")
    error = replace(result.events[0].error_estimate, energy_released=estimate)
    uptaken = event_changed(result, 0, energy_released=-1e-9, error_estimate=error)
    assert ("energy released" in kinds(findings_of(taken(posed, uptaken)))) is found


def test_separation_zero_must_be_complete_contact():
    posed = parse_scene(scene(WAVES, "separation", [4e-5, 0.0], 0.02))
    result = solve(posed)
    partial = solved("separation")[1].states[3]
    wrong = replace(result, states=(*result.states[:-1], replace(partial, separation=0.0, target=True)))
    assert findings_of(taken(posed, result)) == []
    assert "targets" in kinds(findings_of(taken(posed, wrong)))


@pytest.mark.parametrize("name", ["separation", "load", "layer"])
def test_balance_sees_the_energy_of_every_event(name):
    """Under every control: an event that releases a twentieth more is found where the states resolve its interval."""
    posed, result = solved(name)
    seen, resolved = 0, 0
    for part in balances(taken(posed, result)):
        seen += part.events
        event = result.events[seen - 1]
        if part.events and 0.04 * event.energy_released > SAFETY * part.quadrature:
            resolved += 1
            wrong = event_changed(result, seen - 1, energy_released=lambda energy: 1.05 * energy)
            assert "energy balance" in kinds(findings_of(taken(posed, wrong)))
    assert resolved > 0


@pytest.mark.parametrize(("name", "largest"), [("separation", 0.08), ("load", 0.2), ("layer", 0.05)])
def test_quadrature_of_the_work_converges(name, largest):
    """Where nothing happens the balance closes by the order of Hermite's rule; measured 21 to 78 times better.

    The median, because next to a fold, where slopes have no bound, no rule has its order.
    """
    missing = []
    for part in (1.0, 0.5):
        posed = parse_scene(PATHS[name] | {"accuracy": {"max_increment": part * largest}})
        result = solve(posed)
        smooth = [b for b in balances(taken(posed, result)) if not b.events and b.state > 0]
        missing.append(float(np.median([abs(b.missing) / b.energies for b in smooth])))
    assert missing[1] < missing[0] / 8


# Dense algebra at the stored edges

DENSE = {
    "edge moved": wider,
    "pressure": lambda r: changed(r, -1, mean_pressure=lambda p: p + 1e-6 * 1e4),
    "elastic energy": lambda r: changed(r, -1, elastic_energy=lambda u: u + 1e-8 * 0.2),
    "adhesion energy": lambda r: changed(r, -1, adhesion_energy=lambda u: u * (1 + 1e-6)),
    "stress intensity": lambda r: changed(r, -1, stress_intensity_max=lambda k: k * (1 + 1e-6)),
}


@pytest.mark.parametrize("wrong", DENSE)
@pytest.mark.parametrize("name", ["separation", "layer"])
def test_dense_route_sees_what_is_wrong(name, wrong):
    posed, result = solved(name)
    last = max(k for k, state in enumerate(result.states) if state.target and state.edges)
    short = replace(result, states=result.states[: last + 1])
    doctored = DENSE[wrong](short, -1) if wrong == "edge moved" else DENSE[wrong](short)
    assert kinds(trial.dense_route(taken(posed, doctored))) == {"dense route"}


@pytest.mark.parametrize("steepness", [0.1, 20.0, 400.0])
def test_adhesion_energy_of_the_reference_holds_its_digits_on_steep_crests(steepness):
    """int sqrt(1 + s^2 sin^2 x) dx over a period is 4 E(-s^2), the complete elliptic integral."""
    wave = Interface(1.0, Waves(2 * np.pi, np.array([1]), np.ones(1), np.zeros(1)), steepness)
    energy = wave.energy(np.array([0.3]), np.array([0.3 + 2 * np.pi]))
    assert energy == pytest.approx(-4 * ellipe(-(steepness**2)), rel=1e-13)  # measured 2e-16; 5e-9 on panels of a wave


def test_edges_far_from_equilibrium_are_no_reference():
    posed, result = solved("separation")
    last = max(k for k, state in enumerate(result.states) if state.target and state.edges)
    wrong = wider(replace(result, states=result.states[: last + 1]), -1, 0.05)
    assert kinds(trial.dense_route(taken(posed, wrong))) == {"dense route"}


# Copies

MAKERS = {
    "increment": copies.smaller_increment,
    "scale": copies.scaled,
    "shift": copies.shifted,
    "mirror": copies.mirrored,
    "restart": copies.restarted,
}


@pytest.fixture(scope="module")
def asked_again(tmp_path_factory):
    """The copies of a scene and their results, each solved once."""
    known = {}

    def again(name, kind):
        if (name, kind) not in known:
            posed, result = solved(name)
            made = MAKERS[kind](taken(posed, result, PATHS[name], tmp_path_factory.mktemp("copy")))
            known[name, kind] = made, solve(made.scene)
        return known[name, kind]

    return again


# of the path by loads every kind of copy always runs, and each path has two kinds or more that do
COSTLY = [("layer", kind) for kind in ("increment", "shift", "mirror")] + [("separation", "increment")]


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        pytest.param(*pair, id="-".join(pair), marks=pytest.mark.slow if pair in COSTLY else ())
        for pair in product(PATHS, MAKERS)
    ],
)
def test_copies_of_a_sound_scene_agree(name, kind, asked_again):
    made, other = asked_again(name, kind)
    assert made.kind == kind
    assert copies.compared(made, taken(*solved(name)), other) == []


COPIED = {
    "status": lambda r: replace(r, status="unreachable"),
    "target missing": lambda r: replace(r, states=r.states[:-1]),
    "pressure": lambda r: changed(r, -1, mean_pressure=lambda p: p + 1e-8 * 1e4),
    "area": lambda r: changed(r, -1, contact_fraction=lambda a: a + 1e-9),
    "energy": lambda r: changed(r, -1, elastic_energy=lambda u: u + 1e-8),
    "edge": lambda r: changed(r, -1, edges=lambda e: tuple((a, b + 1e-11) for a, b in e)),
    "patches": lambda r: changed(r, -1, n_patches=5),
}


@pytest.mark.parametrize("wrong", COPIED)
@pytest.mark.parametrize("kind", MAKERS)
def test_another_state_is_found(kind, wrong, asked_again):
    made, other = asked_again("load", kind)
    assert kinds(copies.compared(made, taken(*solved("load")), COPIED[wrong](other))) == {kind}


HAPPENED = {
    "missing": lambda r: without_event(r, 1),
    "another kind": lambda r: event_changed(r, 1, kind="bifurcation"),
    "order": lambda r: replace(r, events=r.events[::-1]),
    "place": lambda r: event_changed(r, 1, penetration=lambda d: d + 1e-5),
    "no pressure": lambda r: event_changed(r, 1, mean_pressure=np.nan),
    "energy": lambda r: event_changed(r, 1, energy_released=lambda e: 2 * e),
    "position": lambda r: event_changed(r, 1, position=lambda x: x + 5e-4),
}


@pytest.mark.parametrize("wrong", HAPPENED)
@pytest.mark.parametrize("kind", ["increment", "scale", "shift", "mirror"])
def test_other_events_are_found(kind, wrong, asked_again):
    made, other = asked_again("separation", kind)
    reported = copies.compared(made, taken(*solved("separation")), HAPPENED[wrong](other))
    assert kinds(reported) == {"events at a smaller increment" if kind == "increment" else kind}


@pytest.mark.parametrize("kind", ["scale", "shift", "mirror"])
def test_a_copy_taken_for_the_original_is_found(kind, asked_again):
    made, other = asked_again("separation", kind)
    wrong = replace(made, length=1.0, modulus=1.0, turned=0.0, mirrored=False)
    assert kinds(copies.compared(wrong, taken(*solved("separation")), other)) == {kind}


def test_events_of_one_avalanche_may_come_in_any_order(asked_again):
    made, other = asked_again("separation", "mirror")
    posed, result = solved("separation")
    twins = [replace(result.events[0], position=x, energy_released=0.0) for x in (1e-3, 2e-3)]
    ours = replace(result, events=(*twins, *result.events))
    placed = [replace(other.events[0], position=x, energy_released=0.0) for x in (0.01 - 2e-3, 0.01 - 1e-3)]
    theirs = replace(other, events=(*placed, *other.events))
    assert copies.compared(made, taken(posed, ours), theirs) == []


# One scene from end to end


def trial_of(tables, expected="an answer", special=""):
    return run(trial.asked(Drawn(0, 0, tables, None, expected, special)))


QUICK = scene(rough(3), "separation", [9e-5, 6e-5], 0.01, max_increment=0.2)


def test_sound_scene_is_correct():
    outcome = trial_of(QUICK)
    assert (outcome.converged, outcome.correct, outcome.findings) == (True, True, ())


def test_exception_leaves_the_trial(monkeypatch):
    def broken(posed):
        raise ZeroDivisionError("the matrix is singular")

    monkeypatch.setattr(scene_case, "solve", broken)
    with pytest.raises(ZeroDivisionError):
        trial_of(QUICK)


def test_warning_is_a_finding(monkeypatch):
    def warned(posed):
        warnings.warn("overflow", RuntimeWarning, stacklevel=1)
        return solve(posed)

    monkeypatch.setattr(scene_case, "solve", warned)
    assert trial_of(QUICK).kinds == ("warning",)


def test_exception_of_a_copy_is_a_finding(monkeypatch):
    def broken(made, found, again):
        raise IndexError("no such state")

    monkeypatch.setattr(trial, "compared", broken)
    assert trial_of(QUICK).kinds == ("increment", "scale")


def test_path_that_does_not_converge_is_not_correct(monkeypatch):
    monkeypatch.setattr(scene_case, "solve", lambda posed: replace(solve(posed), status="not_converged"))
    outcome = trial_of(QUICK)
    assert (outcome.converged, outcome.correct) == (False, False)


def test_unreachable_target_is_told_by_name():
    outcome = trial_of(scene(WAVES, "penetration", [1e-5, 1e-3], max_increment=0.2))
    assert (outcome.converged, outcome.correct) == (False, True)
    assert outcome.refused_reason == "unreachable after 1 targets"


@pytest.mark.parametrize(
    ("expected", "special", "correct"),
    [
        ("a refusal", "solid.youngs_modulus = 0.0", True),
        ("a refusal", "solid.poisson_ratio = 9", False),
        ("an answer", "", False),
    ],
    ids=["named", "another key named", "not expected"],
)
def test_refusal_is_judged_by_what_was_expected(expected, special, correct):
    wrong = QUICK | {"solid": {"youngs_modulus": 0.0, "poisson_ratio": 0.3}}
    with pytest.raises(SceneError):
        parse_scene(wrong)
    assert trial_of(wrong, expected, special).correct is correct


def test_accepted_mistake_is_a_finding():
    assert trial_of(QUICK, "a refusal", "solid.density = 1").kinds == ("refusal",)


# Symmetries of the profile

TWINS = scene(waves([2, 4], [40e-6, 10e-6]), "penetration", [1e-5, 2e-5], 0.02, max_increment=0.2)


@pytest.mark.parametrize(
    ("orders", "phases", "count"),
    [([1, 2], [0.3, 1.0], 1), ([3], [0.7], 6), ([2, 4], [0.0, 0.0], 4), ([1, 2], [0.3, 0.6], 2), ([2, 3], [0.1, 0], 1)],
    ids=["none", "wave", "equal crests", "mirror", "common order 1"],
)
def test_symmetries_of_a_profile_are_found(orders, phases, count):
    """A wave of order m has m translations and m reflections that leave it as it is."""
    surface = parse_scene(
        scene(waves(orders, [1e-5] * len(orders)) | {"phases": phases}, "separation", [1e-5])
    ).surface()
    ways = list(copies._ways(copies.Copy("shift", None, turned=0.2), surface))
    assert len({(way.mirrored, round(way.turned % 1.0, 9) % 1.0) for way in ways}) == count
    x = np.linspace(0.0, 0.01, 200)
    for way in ways:
        assert surface.height(0.01 * way.placed(x, 0.01)) == pytest.approx(surface.height(x + 0.002), abs=1e-18)


def test_the_other_of_two_equal_crests_is_as_good():
    """A state with one patch of two equal ones, and the same on the other crest."""
    posed = parse_scene(TWINS)
    result = solve(posed)
    states = [replace(s, edges=s.edges[:1], n_patches=1) if s.edges else s for s in result.states]
    alone = replace(result, states=tuple(states), events=())
    moved = [replace(s, edges=tuple((a + 0.005, b + 0.005) for a, b in s.edges)) for s in states]
    other = replace(alone, states=tuple(moved))
    same = copies.Copy("increment", posed)
    assert copies.compared(same, taken(posed, alone), other) == []
    mixed = replace(alone, states=(*states[:-1], moved[-1]))  # each state chooses anew
    assert copies.compared(same, taken(posed, alone), mixed) == []
    wrong = [replace(s, edges=tuple((a + 0.004, b + 0.004) for a, b in s.edges)) for s in states]
    assert kinds(copies.compared(same, taken(posed, alone), replace(alone, states=tuple(wrong)))) == {"increment"}


def test_nothing_is_found_against_a_flat_profile():
    flat = scene(waves([1], [0.0]), "total_displacement", [1e-6, 2e-6], 0.03, thickness=1e-3, poisson_ratio=0.3)
    posed = parse_scene(flat)
    assert findings_of(taken(posed, solve(posed))) == []
