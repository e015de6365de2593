"""Every failure has a name: what cannot be reached, computed or certified ends in a status, never in an exception."""

from dataclasses import replace

import numpy as np
import pytest
from rough_surfaces import rough_scene
from stored_states import stored_state

from bem import certified_states, record, solver
from bem.audit.certificate import Certificate
from bem.elastic.hierarchical import IllConditionedSystemError
from bem.missed import NUMERICAL_FAILURES, no_point, sentence, verdict
from bem.record import Record
from bem.solver import solve

TARGETS = [70e-6, 50e-6, 60e-6]
LAYER = {"thickness": 0.002}


def test_a_plate_cannot_go_beyond_complete_contact_of_an_incompressible_layer():
    """nu = 1/2: the plate moves with the mean gap, which is used up at complete contact."""
    beyond = [5e-5, 3e-4]
    result = solve(rough_scene(beyond, adhesion=None, control="total_displacement", layer=LAYER))
    assert result.status == "unreachable"
    assert [state.status for state in result.states] == ["converged", "unreachable"]
    said = "target 2 of 2, total_displacement = 0.0003 m: this path has no state there: complete contact is at "
    assert result.failure.startswith(said)
    assert "what may help" in result.failure


UNREACHABLE = {  # control, layer and targets of which the last is not there; then remedies, by what is told of them
    "came apart": (
        ("mean_pressure", None, [2e4, -1e6]),
        {"less tension": ("mean_pressure", [2e4, -10.0]), "separation": ("separation", [5e-5, 2e-4])},
    ),
    "carry no tension": (("mean_pressure", None, [-10.0]), {"in compression": ("mean_pressure", [2e4, -10.0])}),
    "complete contact is at": (
        ("total_displacement", LAYER, [5e-5, 3e-4]),
        {"before that": ("total_displacement", [5e-5, 8e-5]), "mean_pressure": ("mean_pressure", [1e5, 1e6])},
    ),
}


@pytest.mark.parametrize("why", UNREACHABLE)
def test_what_may_help_where_no_state_is_there_helps(why):
    (control, layer, targets), remedies = UNREACHABLE[why]
    tables = {} if layer is None else {"layer": layer, "adhesion": None}
    found = solve(rough_scene(targets, control=control, **tables))
    assert (found.status, [why in found.failure, *(remedy in found.failure for remedy in remedies)]) == (
        "unreachable",
        [True] * (1 + len(remedies)),
    )
    for other, followed in remedies.values():
        assert solve(rough_scene(followed, control=other, **tables)).status == "converged"


def test_the_tension_at_which_surfaces_came_apart_is_told():
    """The largest that is held: a state is there at a little less."""
    failure = solve(rough_scene([2e4, -1e6], 12, control="mean_pressure")).failure
    pull_off = float(failure.split("came apart at ")[1].split(" Pa")[0])
    assert solve(rough_scene([2e4, 0.9999 * pull_off], 12, control="mean_pressure")).status == "converged"
    assert solve(rough_scene([2e4, 1.0001 * pull_off], 12, control="mean_pressure")).status == "unreachable"


def test_complete_contact_of_an_incompressible_layer_has_a_total_displacement():
    scene = rough_scene([1e-6, 0.0], adhesion=None, layer=LAYER)
    state = solve(scene).targets[-1]
    assert state.status == "complete_contact"
    assert state.total_displacement == pytest.approx(scene.surface().max_height, rel=1e-12)


@pytest.mark.parametrize(
    ("control", "has_history", "remedies"),
    [
        ("mean_pressure", True, 4),
        ("separation", True, 3),
        ("separation", False, 1),
    ],
)
def test_what_to_try_is_told_in_order(control, has_history, remedies):
    error = no_point("not_converged", 1.0, control, has_history)
    said = sentence(error, "target 1 of 1", control, 1.0)
    marks = [f"({k}) {remedy}" for k, remedy in enumerate(error.remedies, 1)] if remedies > 1 else []
    places = [said.index(mark) for mark in marks]
    assert places == sorted(places)
    assert len(error.remedies) == remedies
    assert said.endswith("fewer profile.harmonics")


@pytest.mark.parametrize("failure", [kind for kind in NUMERICAL_FAILURES if kind is not MemoryError])
def test_numerical_failures_miss_the_target_by_name(failure, monkeypatch):
    described = record.equilibrium_state

    def failing(*arguments):
        state = described(*arguments)
        if state.separation < 55e-6:
            raise failure("reported here")
        return state

    monkeypatch.setattr(record, "equilibrium_state", failing)
    result = solve(rough_scene(TARGETS))
    assert result.status == "not_converged"
    assert f"target 2 of 3, separation = 5e-05 m: {failure.__name__}: reported here" in result.failure
    assert [state.status for state in result.targets] == ["converged", "not_converged", "converged"]
    assert result.events


@pytest.mark.parametrize(("errors", "ends"), [(0.9, False), (1.1, True)], ids=["within its error", "beyond it"])
def test_a_jump_that_gains_energy_ends_the_path_by_name(errors, ends, monkeypatch):
    described, detachments = record.event_of, []

    def gaining(problem, event):
        found = described(problem, event)
        if found.kind != "detachment" or detachments:
            return found
        detachments.append(replace(found, energy_released=-errors * found.error_estimate.energy_released))
        return detachments[0]

    monkeypatch.setattr(record, "event_of", gaining)
    result = solve(rough_scene(TARGETS))
    assert (detachments[0] in result.events) == (not ends)
    assert result.status == ("not_converged" if ends else "converged")
    if ends:  # what lies behind the jump is not kept
        assert "EnergyGainedError: detachment at a penetration of " in result.failure
        assert [state.found for state in result.targets[:3]] == [True, True, False]


def test_a_fault_of_the_program_is_not_called_a_numerical_failure(monkeypatch):
    def faulty(*_):
        raise IndexError("a fault")

    monkeypatch.setattr(record, "equilibrium_state", faulty)
    with pytest.raises(IndexError, match="a fault"):
        solve(rough_scene(TARGETS))


@pytest.mark.parametrize("adhesion", [None, 0.03])
def test_a_failure_before_the_first_state_has_a_name_too(adhesion, monkeypatch):
    def failing(*_):
        raise IllConditionedSystemError("reported here")

    monkeypatch.setattr(solver, "complete_contact", failing)
    result = solve(rough_scene(TARGETS, adhesion=adhesion))
    assert (result.status, result.states, result.failure) == (
        "not_converged",
        (),
        "IllConditionedSystemError: reported here",
    )


def test_no_state_is_converged_with_nan(monkeypatch):
    judged = certified_states.certificate.certify

    def open_gap(*arguments, **options):
        found = judged(*arguments, **options)
        return replace(found, min_gap=np.nan)

    monkeypatch.setattr(certified_states.certificate, "certify", open_gap)
    result = solve(rough_scene(TARGETS))
    assert result.status == "not_converged"
    assert [state.found for state in result.states] == [False] * len(TARGETS)
    assert result.failure.count("NotFiniteError: certificate.min_gap is nan") == len(TARGETS)


def test_what_is_not_certified_is_not_called_converged(monkeypatch):
    """The path continues, its other states are good; who reads any status sees it."""
    judged = certified_states.certificate.certify

    def strict(profile, pressure, penetration, adhesion, **options):
        closure = 1e-30 if pressure.left.size == 3 else 1e-8
        demands = replace(options.pop("demands"), closure=closure, intensity_rounding=None)
        return judged(profile, pressure, penetration, adhesion, **options, demands=demands)

    monkeypatch.setattr(certified_states.certificate, "certify", strict)
    result = solve(rough_scene(TARGETS))
    assert result.status == "not_converged"
    assert len(result.targets) == len(TARGETS)
    for state in result.states:
        assert state.status == ("not_converged" if state.n_patches == 3 else "converged")
        assert state.certificate.ok == (state.status == "converged")
    assert "states at targets are not certified, the first at a separation of" in result.failure
    assert "exceeds 1e-30 at an edge of patch" in result.failure


def test_a_state_between_targets_that_is_not_certified_is_a_warning_and_targets_decide():
    refused = replace(Certificate(), ok=False, reasons=("mean gap less separation 1.13e-10 exceeds 1e-10",))
    between = stored_state(target=False, index=None, certificate=refused, status="not_converged")
    record = Record(rough_scene(TARGETS))
    record.add(between, {})
    record.add(stored_state(), {})
    result = record.result(*verdict(record.states))
    assert (result.status, result.failure) == ("converged", None)
    warning = result.warnings[-1]
    assert warning.about == "states"
    assert "at a separation of 2e-05 m: mean gap less separation 1.13e-10 exceeds 1e-10" in warning.message
    record.add(replace(between, target=True, index=1), {})
    status, failure = verdict(record.states)
    assert status == "not_converged"
    assert failure.startswith("1 of 2 states at targets are not certified, the first at a separation of 2e-05 m")
