"""Hard cases in their reduced forms: each converges as stated beforehand, and is correct, counted apart."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from bem.scene.result import Event, EventError
from bem.scene.scene import parse_scene
from bem.solver import solve
from validation.corpus.hard.any_result import Solved
from validation.corpus.hard.hard_case_checks import CHECKS, DENSE
from validation.corpus.hard.hard_case_run import run
from validation.corpus.hard.hard_case_scenes import ADHESIVE, MODULUS, WAVE_WORK, rough, scene, waves
from validation.corpus.hard.hard_cases import HARD_CASES
from validation.corpus.hard.scene_case import HardCase, missed
from validation.references.paper_problem import PERIOD

MOST_HARMONICS = 125
ids = [case.id for case in HARD_CASES]


def test_ids_are_distinct():
    assert len(set(ids)) == len(ids)


@pytest.mark.parametrize("case", HARD_CASES, ids=ids)
def test_reduced_form_is_small(case):
    profile = case.posed(full=False)["profile"]
    assert max(profile.get("orders", [profile.get("harmonics", 0)])) <= MOST_HARMONICS


@pytest.mark.parametrize("case", HARD_CASES, ids=ids)
def test_reduced_form_converges_as_expected_and_is_correct(case):
    found = run(case)
    assert found.refused_reason is None
    assert found.observed == found.expected
    assert found.converged
    assert found.findings == ()
    assert found.correct


@pytest.mark.slow
@pytest.mark.parametrize("case", HARD_CASES, ids=ids)
def test_full_form(case):
    found = run(case, full=True)
    assert found.converged
    assert found.findings == ()


# The judge itself: what is wrong must be seen.

SCENES = {
    "small": scene(rough(10), "separation", [60e-6, 40e-6], 0.03),
    "dry": scene(rough(10), "separation", [60e-6, 40e-6]),
    "wave": scene(waves([1], [50e-6]), "mean_pressure", [5e3]),
    "two crests": scene(waves([2], [50e-6]), "penetration", [1e-5], 0.05),
    "split": scene(waves([1, 2], [50e-6, -20e-6]), "mean_pressure", [2356.19387]),
    "last gap": scene(rough(8), "separation", [1e-10], 0.03, True, initial="complete_contact"),
}


@cache
def solved(name):
    posed = parse_scene(SCENES[name])
    return Solved(SCENES[name], solve(posed), posed, Path())


def falsified(name, **changes):
    """The result of a scene with its last target changed, by functions of what it is."""
    found = solved(name)
    *others, last = found.result.states
    wrong = replace(last, **{key: change(getattr(last, key)) for key, change in changes.items()})
    return replace(found, result=replace(found.result, states=(*others, wrong)))


def hard(**named):
    return HardCase("small", "", SCENES["small"], **{"checks": ()} | named)


def test_wrong_expectation_is_not_converged():
    assert not run(hard(expected=("converged", "separated"))).converged


def test_refusal_is_named_and_neither_converged_nor_correct():
    found = run(HardCase("refused", "", scene(waves([1], [1e-5]), "total_displacement", [1e-6])))
    assert "total_displacement" in found.refused_reason
    assert not found.converged and not found.correct


def test_missing_event_is_found():
    assert run(hard(events=("pull_off",))).findings == ("event: pull_off missing",)


def test_path_that_does_not_converge_is_not_correct(monkeypatch):
    broken = replace(solved("small").result, status="not_converged")
    monkeypatch.setattr("validation.corpus.hard.scene_case.solve", lambda posed: broken)
    found = run(hard())
    assert (found.converged, found.correct, found.kinds) == (False, False, ("certificate",))


def kinds(found):
    return {finding.kind for finding in hard().findings(found, full=False)}


@pytest.mark.parametrize(("error", "seen"), [(0.0, True), (0.9e-6, True), (1.1e-6, False)])
def test_negative_release_of_energy_beyond_its_error_is_found(error, seen):
    found = solved("small")
    taken = Event("coalescence", 1e-5, 0.0, 0.0, -1e-6, EventError(0.0, 0.0, error))
    wrong = replace(found, result=replace(found.result, events=(taken,)))
    assert ("energy released" in kinds(wrong)) is seen


def test_certificate_that_is_not_ok_is_found():
    assert "certificate" in kinds(falsified("small", certificate=lambda known: replace(known, ok=False)))


def moved(distance, at=0):
    """A right edge moved outwards by so many periods, or a left one of negative ones."""

    def change(edges):
        changed = [list(pair) for pair in edges]
        changed[0][at] += distance * PERIOD
        return tuple(map(tuple, changed))

    return change


def joined(edges):
    """A gap of 1e-4 periods taken for contact, which leaves some pressure below zero."""
    (first, last), (following, end) = edges
    return ((following, last + PERIOD),) if last - following < 0 else ((first, end),)


def more(share=0.0, plus=0.0):
    return lambda value: value * (1 + share) + plus


BY_DENSE = 3 * DENSE * 42.9e3  # Pa, three times what is allowed: the pressure unit of the small scene is 42.9 kPa
WRONG = {
    "dense: pressure": ("dense", "small", {"mean_pressure": more(plus=BY_DENSE)}),
    "dense: edges": ("dense", "small", {"edges": moved(1e-4)}),
    "mirror: area": ("mirror", "small", {"contact_fraction": more(plus=1e-8)}),
    "shift: edge": ("shift", "small", {"edges": moved(1e-9, 1)}),
    "units: area": ("units_up", "small", {"contact_fraction": more(plus=1e-10)}),
    "units: pressure": ("units_down", "small", {"mean_pressure": more(1e-6)}),
    "increments: edge": ("smaller_increments", "small", {"edges": moved(1e-9, 1)}),
    "restart: area": ("restart", "small", {"contact_fraction": more(plus=1e-9)}),
    "nu = 0: patches": ("plane_strain_only", "small", {"n_patches": more(plus=1)}),
    "closed form": ("wave", "wave", {"penetration": more(1e-7)}),
    "tension in a patch": ("compressive", "split", {"edges": joined}),
    "target alone: area": ("target_alone", "dry", {"contact_fraction": more(plus=1e-7)}),
    "crack: pressure": ("last_gap", "last gap", {"mean_pressure": more(1e-5)}),
    "crack: separation": ("last_gap", "last gap", {"separation": more(1e-5)}),
    "crack: edge": ("last_gap", "last gap", {"edges": moved(1e-9, 1)}),
    "unequal patches": ("equal_patches", "two crests", {"edges": moved(1e-6, 1)}),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_check_sees_what_is_wrong_and_nothing_else(wrong, tmp_path):
    check, name, changes = WRONG[wrong]
    assert list(CHECKS[check](replace(solved(name), folder=tmp_path))) == []
    assert list(CHECKS[check](replace(falsified(name, **changes), folder=tmp_path))) != []


@pytest.mark.parametrize("check", ["tension_at_the_end", "last_gap"])
def test_compression_and_several_gaps_at_the_end_are_seen(check):
    assert list(CHECKS[check](solved("small"))) != []


def test_restart_of_a_path_with_one_target_is_found(tmp_path):
    assert list(CHECKS["restart"](replace(solved("wave"), folder=tmp_path))) == ["no target to begin from"]


@pytest.mark.parametrize(
    ("wanted", "reported"),
    [
        ({"least": 1e-3}, "contact fraction 0.001 not reached from above"),
        ({"largest": 0.9}, "contact fraction 0.9 not reached from below"),
        ({"gap": 1e-4}, "no gap of 0.0001 periods"),
        ({"patch": 1e-4}, "no patch of 0.0001 periods"),
    ],
    ids=["least", "largest", "gap", "patch"],
)
def test_a_case_less_hard_than_intended_is_found(wanted, reported):
    assert list(missed(wanted, solved("small"))) == [reported]


def test_a_case_as_hard_as_intended_is_not():
    state = solved("small").result.targets[-1]
    narrowest = min(b - a for a, b in state.edges) / PERIOD
    wanted = {"least": state.contact_fraction, "largest": state.contact_fraction, "patch": narrowest}
    assert list(missed(wanted, solved("small"))) == []


def test_flaw_opens_at_the_tension_of_a_griffith_crack():
    """K = T sqrt(pi g / 2) of a gap g under the local tension T = p* - P at the trough of a wave."""
    flaw, critical = 1e-5, (2 * MODULUS / 0.75 * WAVE_WORK) ** 0.5
    opening = ADHESIVE.full_contact_pressure - critical / (1.5707963267948966 * flaw) ** 0.5
    targets, path = [0.0, 2 * opening], {"initial": "complete_contact", "flaw": flaw, "max_increment": 2.0}
    result = solve(parse_scene(scene(waves([1], [50e-6]), "mean_pressure", targets, WAVE_WORK, **path)))
    assert [state.status for state in result.targets] == ["complete_contact", "unreachable"]
    assert result.events[0].kind == "opening"
    # measured 1e-7: the tension is not uniform over the flaw
    assert result.events[0].mean_pressure == pytest.approx(opening, rel=3e-7)
