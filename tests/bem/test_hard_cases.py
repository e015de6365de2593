"""Hard cases in their reduced forms: each converges as stated beforehand, and is correct, counted apart."""

from dataclasses import replace
from functools import cache

import pytest

from bem.scene.result import Event, EventError
from bem.scene.scene import parse_scene
from bem.solver import solve
from validation.corpus.hard import hard_case_checks as checks
from validation.corpus.hard.hard_case_run import judged, missed, run_case
from validation.corpus.hard.hard_case_scenes import (
    ADHESIVE,
    MODULUS,
    WAVE_WORK,
    HardCase,
    Reached,
    rough,
    scene,
    waves,
)
from validation.corpus.hard.hard_cases import HARD_CASES
from validation.references.paper_problem import PERIOD

MOST_HARMONICS = 125
ids = [case.id for case in HARD_CASES]


def test_ids_are_distinct():
    assert len(set(ids)) == len(ids)


@pytest.mark.parametrize("case", HARD_CASES, ids=ids)
def test_reduced_form_is_small(case):
    profile = case.reduced["profile"]
    assert max(profile.get("orders", [profile.get("harmonics", 0)])) <= MOST_HARMONICS


@pytest.mark.parametrize("case", HARD_CASES, ids=ids)
def test_reduced_form_converges_as_expected_and_is_correct(case):
    found = run_case(case)
    assert found.refused_reason is None
    assert found.observed == found.expected
    assert found.converged
    assert found.findings == ()
    assert found.correct


@pytest.mark.slow
@pytest.mark.parametrize("case", HARD_CASES, ids=ids)
def test_full_form(case):
    found = run_case(case, full=True)
    assert found.converged
    assert found.findings == ()


# The judge itself: what is wrong must be seen.

SMALL = scene(rough(10), "separation", [60e-6, 40e-6], 0.03)


@cache
def small_result():
    return solve(parse_scene(SMALL))


def falsified(**changes):
    """The small result with its last target changed."""
    result = small_result()
    return replace(result, states=(*result.states[:-1], replace(result.states[-1], **changes)))


def test_wrong_expectation_is_not_converged():
    case = HardCase("wrong", "", SMALL, SMALL, ("converged", "separated"), ())
    assert not run_case(case).converged


def test_refusal_is_named_and_neither_converged_nor_correct():
    refused = scene(waves([1], [1e-5]), "total_displacement", [1e-6])
    found = run_case(HardCase("refused", "", refused, refused, ("converged",), ()))
    assert "total_displacement" in found.refused_reason
    assert not found.converged and not found.correct


def test_missing_event_is_found():
    case = HardCase("missing", "", SMALL, SMALL, ("converged",) * 2, (), events=("pull_off",))
    assert run_case(case).findings == ("event pull_off missing",)


@pytest.mark.parametrize(("error", "findings"), [(0.0, 1), (0.9e-6, 1), (1.1e-6, 0)])
def test_negative_release_of_energy_beyond_its_error_is_found(error, findings):
    result = small_result()
    wrong = replace(result, events=(Event("coalescence", 1e-5, 0.0, 0.0, -1e-6, EventError(0.0, 0.0, error)),))
    case = HardCase("negative", "", SMALL, SMALL, ("converged",) * 2)
    found = judged(case, wrong, parse_scene(SMALL))
    assert ["coalescence releases -1.0e-06" in text for text in found] == [True] * findings


def test_certificate_that_is_not_ok_is_found():
    certificate = replace(small_result().states[-1].certificate, ok=False)
    case = HardCase("certificate", "", SMALL, SMALL, ("converged",) * 2)
    assert judged(case, falsified(certificate=certificate), parse_scene(SMALL)) != []


def test_dense_route_sees_a_wrong_pressure():
    pressure = small_result().states[-1].mean_pressure
    unit = checks.pressure_unit(parse_scene(SMALL))
    wrong = falsified(mean_pressure=pressure + 3 * checks.DENSE * max(unit, abs(pressure)))
    assert checks.dense(SMALL, parse_scene(SMALL), small_result()) == []
    assert checks.dense(SMALL, parse_scene(SMALL), wrong) != []


def test_shifted_edges_are_seen_by_the_dense_route():
    state = small_result().states[-1]
    edges = ((state.edges[0][0] + 1e-4 * PERIOD, state.edges[0][1]), *state.edges[1:])
    assert checks.dense(SMALL, parse_scene(SMALL), falsified(edges=edges)) != []


def test_mirrored_profile_sees_a_wrong_area():
    fraction = small_result().states[-1].contact_fraction
    assert checks.mirror(SMALL, parse_scene(SMALL), falsified(contact_fraction=fraction + 1e-8)) != []


def test_closed_form_sees_a_wrong_penetration():
    wave = scene(waves([1], [50e-6]), "mean_pressure", [5e3])
    result = solve(parse_scene(wave))
    state = result.states[-1]
    wrong = replace(result, states=(*result.states[:-1], replace(state, penetration=state.penetration * (1 + 1e-7))))
    assert checks.wave(wave, parse_scene(wave), result) == []
    assert checks.wave(wave, parse_scene(wave), wrong) != []


@pytest.mark.parametrize(
    ("wanted", "reported"),
    [
        (Reached(least=1e-3), "contact fraction 0.001 not reached from above"),
        (Reached(largest=0.9), "contact fraction 0.9 not reached from below"),
        (Reached(gap=1e-4), "no gap of 0.0001 periods"),
        (Reached(patch=1e-4), "no patch of 0.0001 periods"),
    ],
    ids=["least", "largest", "gap", "patch"],
)
def test_a_case_less_hard_than_intended_is_found(wanted, reported):
    assert missed(wanted, small_result(), parse_scene(SMALL)) == [reported]


def test_a_case_as_hard_as_intended_is_not():
    state = small_result().targets[-1]
    narrowest = min(b - a for a, b in state.edges) / PERIOD
    wanted = Reached(least=state.contact_fraction, largest=state.contact_fraction, patch=narrowest)
    assert missed(wanted, small_result(), parse_scene(SMALL)) == []


def test_tension_inside_a_patch_is_seen():
    """A gap of 1e-4 periods taken for contact leaves some pressure below zero."""
    split = scene(waves([1, 2], [50e-6, -20e-6]), "mean_pressure", [2356.19387])
    result = solve(parse_scene(split))
    state = result.states[-1]
    (first, last), (following, end) = state.edges
    joined = ((following, last + PERIOD),) if last - following < 0 else ((first, end),)
    wrong = replace(result, states=(replace(state, edges=joined),))
    assert checks.compressive(split, parse_scene(split), result) == []
    assert checks.compressive(split, parse_scene(split), wrong) != []


def test_target_alone_sees_a_wrong_area():
    dry = scene(rough(10), "separation", [60e-6, 40e-6])
    result = solve(parse_scene(dry))
    fraction = result.states[-1].contact_fraction
    wrong = replace(result, states=(*result.states[:-1], replace(result.states[-1], contact_fraction=fraction + 1e-7)))
    assert checks.target_alone(dry, parse_scene(dry), result) == []
    assert checks.target_alone(dry, parse_scene(dry), wrong) != []


def test_shifted_profile_sees_a_moved_edge():
    (a, b), *others = small_result().states[-1].edges
    moved = falsified(edges=((a, b + 1e-9 * PERIOD), *others))
    assert checks.shift(SMALL, parse_scene(SMALL), small_result()) == []
    assert checks.shift(SMALL, parse_scene(SMALL), moved) != []


def test_compression_at_the_end_is_seen():
    assert checks.tension_at_the_end(SMALL, parse_scene(SMALL), small_result()) != []


@cache
def nearly_complete():
    """The last gap of a rough profile, and the scene that opens it from complete contact."""
    tables = scene(rough(8), "separation", [1e-10], 0.03, True, initial="complete_contact")
    return tables, solve(parse_scene(tables))


@pytest.mark.parametrize(
    ("name", "factor"),
    [("mean_pressure", 1 + 1e-5), ("separation", 1 + 1e-5)],
    ids=["pressure", "separation"],
)
def test_isolated_crack_sees_what_is_wrong(name, factor):
    tables, result = nearly_complete()
    state = result.states[-1]
    wrong = replace(result, states=(replace(state, **{name: getattr(state, name) * factor}),))
    assert checks.last_gap(tables, parse_scene(tables), result) == []
    assert checks.last_gap(tables, parse_scene(tables), wrong) != []


def test_isolated_crack_sees_a_moved_edge():
    tables, result = nearly_complete()
    ((a, b),) = result.states[-1].edges
    wrong = replace(result, states=(replace(result.states[-1], edges=((a, b + 1e-9 * PERIOD),)),))
    assert checks.last_gap(tables, parse_scene(tables), wrong) != []


def test_several_gaps_are_no_isolated_crack():
    assert checks.last_gap(SMALL, parse_scene(SMALL), small_result()) != []


def test_unequal_patches_are_seen():
    wave = scene(waves([2], [50e-6]), "penetration", [1e-5], 0.05)
    result = solve(parse_scene(wave))
    state = result.states[-1]
    a, b = state.edges[0]
    wrong = replace(result, states=(*result.states[:-1], replace(state, edges=((a, b + 1e-8), state.edges[1]))))
    assert checks.equal_patches(wave, parse_scene(wave), result) == []
    assert checks.equal_patches(wave, parse_scene(wave), wrong) != []


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
