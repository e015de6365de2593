"""Every failure has a name: what cannot be reached, computed or certified ends in a status, never in an exception."""

from contextlib import nullcontext
from dataclasses import replace

import pytest
from rough_surfaces import rough_scene
from stored_states import stored_state

from bem.audit.certificate import Certificate
from bem.certified_states import event_of
from bem.loading.complete_contact import complete_contact
from bem.loading.path_events import EventNumbers, PathEvent
from bem.missed import NUMERICAL_FAILURES, EnergyGainedError, no_point, sentence, verdict
from bem.path_for import path_for
from bem.problem import pose
from bem.record import Record
from bem.recorder import Recorder
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
    [("mean_pressure", True, 4), ("separation", True, 3), ("separation", False, 1)],
)
def test_what_to_try_is_told_in_order(control, has_history, remedies):
    error = no_point("not_converged", 1.0, control, has_history)
    said = sentence(error, "target 1 of 1", control, 1.0)
    marks = [f"({k}) {remedy}" for k, remedy in enumerate(error.remedies, 1)] if remedies > 1 else []
    places = [said.index(mark) for mark in marks]
    assert places == sorted(places)
    assert len(error.remedies) == remedies
    assert said.endswith("fewer profile.harmonics")


def raising(failure, at):
    """Return a progress function that raises a failure on the way to a target."""

    def progress(report):
        if report.target_index == at:
            raise failure

    return progress


@pytest.mark.parametrize("failure", [kind for kind in NUMERICAL_FAILURES if kind is not MemoryError])
def test_numerical_failures_miss_the_target_by_name(failure):
    result = solve(rough_scene(TARGETS), progress=raising(failure("reported here"), 1))
    assert result.status == "not_converged"
    assert f"target 2 of 3, separation = 5e-05 m: {failure.__name__}: reported here" in result.failure
    assert [state.status for state in result.targets] == ["converged", "not_converged", "converged"]
    assert result.events


def test_a_fault_of_the_program_is_not_called_a_numerical_failure():
    with pytest.raises(IndexError, match="a fault"):
        solve(rough_scene(TARGETS), progress=raising(IndexError("a fault"), 1))


@pytest.fixture
def recorder():
    """Recorder of a path at which nothing is recorded yet."""
    scene = rough_scene(TARGETS)
    problem = pose(scene)
    complete = complete_contact(problem.profile, problem.law, None)
    return Recorder(scene, problem, complete, path_for(scene, problem, complete), Record(scene), None)


@pytest.mark.parametrize(("errors", "ends"), [(0.9, False), (1.1, True)], ids=["within its error", "beyond it"])
def test_a_jump_that_gains_energy_beyond_its_error_is_refused_by_name(errors, ends, recorder):
    at, error = EventNumbers(0.1, 0.2, 0.1, 0.3), EventNumbers(0.0, 0.0, 0.0, 0.0)
    event = PathEvent("detachment", 1.0, at, error, 0.0, 1e-6)
    doubt = event_of(recorder.problem, event).error_estimate.energy_released
    gained = -errors * doubt / recorder.problem.scales.energy_per_area
    with pytest.raises(EnergyGainedError, match="detachment at a penetration of ") if ends else nullcontext():
        recorder.note((replace(event, energy_released=gained),))
    assert len(recorder.record.pending_events) == (not ends)


def test_a_state_between_targets_that_is_not_certified_is_a_warning_and_targets_decide():
    refused = replace(Certificate(), ok=False, reasons=("mean gap less separation 1.13e-10 exceeds 1e-10",))
    between = stored_state(target=False, index=None, certificate=refused, status="not_converged")
    record = Record(rough_scene(TARGETS[:1]))
    record.add(between, {})
    record.add(stored_state(separation=7e-5, penetration=-4e-5), {})
    result = record.result(*verdict(record.states))
    assert (result.status, result.failure) == ("converged", None)
    warning = result.warnings[-1]
    assert warning.about == "states"
    assert "at a separation of 2e-05 m: mean gap less separation 1.13e-10 exceeds 1e-10" in warning.message
    record.add(replace(between, target=True, index=1), {})
    record.add(replace(between, certificate=Certificate()), {})
    status, failure = verdict(record.states)
    assert status == "not_converged"
    assert [caution for caution in record.result(status, failure).warnings if caution.about == "states"] == [warning]
    assert failure.startswith("1 of 2 states at targets are not certified, the first at a separation of 2e-05 m")
