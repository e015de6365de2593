"""States stored before and after a jump: equilibria at a value of the control, which differ by the energy released."""

import numpy as np
import pytest
from rough_scene import ROUGH

import bem

SOLID, ADHESION = bem.Solid(1e6, 0.5), bem.Adhesion(0.03)
PROFILE = bem.Profile.self_affine(0.01, 0.7, 5e-5, 8, 1)
UNDER_LOAD = {"control": "mean_pressure", "targets": [2000.0, -1000.0]}


def solved(loading):
    return bem.solve(profile=PROFILE, solid=SOLID, adhesion=ADHESION, loading=loading)


@pytest.fixture(scope="module")
def results():
    return {"separation": solved(ROUGH["loading"]), "mean_pressure": solved(UNDER_LOAD)}


def ends_of(result):
    return [(event, end) for event in result.events for end in (event.before, event.after) if end is not None]


@pytest.mark.parametrize("control", ["separation", "mean_pressure"])
def test_both_ends_of_every_jump_are_equilibria(results, control):
    checked = 0
    for _, end in ends_of(results[control]):
        if not end.edges:
            assert (end.status, end.mean_pressure) == ("separated", 0.0)
            continue
        state = bem.ContactState(PROFILE, SOLID, end.edges, end.penetration)
        assert state.energy_release_rate == pytest.approx(np.full((len(end.edges), 2), 0.03), rel=1e-3)
        assert state.mean_pressure == pytest.approx(end.mean_pressure, rel=1e-5, abs=1e-6)
        checked += 1
    assert checked >= 6


def test_a_jump_keeps_the_control_and_begins_in_the_state_of_its_event(results):
    for control, name in (("separation", "penetration"), ("mean_pressure", "mean_pressure")):
        for event in results[control].events:
            if event.before is None or event.after is None:
                continue
            assert event.before.penetration == event.penetration
            assert event.before.mean_pressure == event.mean_pressure
            if event.kind != "pull_off" or control == "separation":
                assert getattr(event.after, name) == pytest.approx(getattr(event, name), rel=1e-6, abs=1e-15)


def test_the_energy_released_is_the_difference_of_both_ends(results):
    checked = 0
    for event, _ in ends_of(results["separation"]):
        energy = [
            bem.ContactState(PROFILE, SOLID, end.edges, end.penetration, adhesion=ADHESION).energy if end.edges else 0.0
            for end in (event.before, event.after)
        ]
        released = (energy[0] - energy[1]) / PROFILE.period
        assert released == pytest.approx(event.energy_released, rel=1e-4)
        checked += 1
    assert checked >= 8


def test_a_path_without_adhesion_jumps_nowhere():
    loading = {"control": "mean_pressure", "targets": [1e3, 1e6]}
    result = bem.solve(profile=PROFILE, solid=SOLID, loading=loading)
    assert [event.kind for event in result.events] == ["first_touch", "complete_contact"]
    assert ends_of(result) == []
