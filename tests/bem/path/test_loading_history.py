"""Sequences of targets: hysteresis and its dissipation, bifurcations, controls, initial states, unreachable targets."""

from functools import lru_cache

import numpy as np
import pytest
from judges import Sinusoid
from rough_surfaces import rough_scene
from scene_tables import tables, waves

from bem.scene.result_file import write_result
from bem.scene.scene import parse_scene
from bem.solver import solve

WAVE = Sinusoid(1e-4, 0.01, 1e6, 0.5, 0.3)


def scene(control, targets, order=1, initial=None, flaw=None, alpha=0.3, base_dir=None):
    """Waves of one order with Johnson's alpha; amplitudes fall with the order, so that the slopes are equal."""
    wave = Sinusoid(1e-4 / order, 0.01 / order, 1e6, 0.5, alpha)
    more = {"accuracy": {"max_increment": 0.2}, "initial": initial, "flaw": flaw}
    return parse_scene(
        tables(waves([order], [wave.amplitude]), control, targets, wave.work_of_adhesion, **more), base_dir or "."
    )


@lru_cache(maxsize=4)
def loop():
    return solve(rough_scene([40e-6, 75e-6, 40e-6, 160e-6], 12, 5, 0.05))


def test_targets_are_visited_in_order():
    np.testing.assert_allclose([state.separation for state in loop().targets], [40e-6, 75e-6, 40e-6, 160e-6])
    assert [state.branch for state in loop().targets] == ["loading", "unloading", "loading", "unloading"]


def test_events_have_positions_and_release_energy():
    for event in loop().events:
        assert event.energy_released >= 0
        assert event.position is not None or event.kind == "bifurcation"
        assert event.position is None or 0 <= event.position < 0.01


def test_seven_equal_contacts_without_adhesion_stay_equal():
    result = solve(scene("penetration", [0.9 * 1e-4 / 7], order=7, alpha=0))
    assert np.ptp([b - a for a, b in result.targets[0].edges]) <= 1e-10 * 0.01


@pytest.mark.parametrize("control", ["separation", "penetration", "mean_pressure", "total_displacement"])
def test_every_control_finds_the_same_state(control):
    layer = {"layer": {"thickness": 0.002}, "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.3}}
    coarse = {"accuracy": {"max_increment": 0.5}}
    here = solve(rough_scene([40e-6], 4, 2, 0.01, **layer)).targets[0]
    twin = solve(rough_scene([getattr(here, control)], 4, 2, 0.01, control, **layer, **coarse)).targets[0]
    assert here.stable_at_fixed_load
    assert abs(twin.contact_fraction - here.contact_fraction) <= 1e-9
    assert abs(twin.mean_pressure - here.mean_pressure) <= 1e-8 * abs(here.mean_pressure)


def test_a_flaw_opens_complete_contact_and_releases_energy():
    pressures = [share * WAVE.full_contact_pressure for share in (2.0, 0.1)]
    result = solve(scene("mean_pressure", pressures, initial="complete_contact", flaw=1e-3))
    opening = [event for event in result.events if event.kind == "opening"]
    assert result.targets[0].status == "complete_contact"
    assert len(opening) == 1
    assert opening[0].energy_released > 0
    assert opening[0].position == pytest.approx(0.005)
    critical = WAVE.alpha / np.sqrt(np.pi * 1e-3 / (2 * 0.01))  # K = T sqrt(pi g/2), T = p* - p, of a short flaw
    assert opening[0].mean_pressure / WAVE.full_contact_pressure == pytest.approx(1 - critical, abs=0.05)


def test_a_stored_state_is_a_start(tmp_path):
    targets = [float(WAVE.penetration(share * np.pi / 2)) for share in (0.5, 0.7)]
    whole = solve(scene("penetration", targets))
    write_result(whole, tmp_path / "first")
    index = [state.target for state in whole.states].index(True)
    start = {"result": "first", "state": index}
    again = solve(scene("penetration", targets[1:], initial=start, base_dir=tmp_path))
    assert abs(again.targets[-1].contact_fraction - whole.targets[-1].contact_fraction) <= 1e-10
    assert again.events == ()


def test_a_tension_no_branch_carries_keeps_the_states_before_it():
    """And those behind: the surfaces came apart, touch again without a load, and are pressed together again."""
    pressed = 0.2 * WAVE.full_contact_pressure
    result = solve(scene("mean_pressure", [pressed, -5 * WAVE.full_contact_pressure, pressed]))
    assert result.status == "unreachable"
    assert [state.status for state in result.targets] == ["converged", "unreachable", "converged"]
    assert [event.kind for event in result.events] == ["first_touch", "pull_off", "first_touch"]
    first, missed, again = result.targets
    assert first.certificate.ok
    assert (missed.mean_pressure, missed.contact_fraction, missed.found) == (0.0, 0.0, False)
    assert result.states[result.states.index(missed) - 1].status == "separated"
    assert again.contact_fraction == pytest.approx(first.contact_fraction, abs=1e-10)


def test_a_tension_at_the_start_is_unreachable():
    result = solve(scene("mean_pressure", [-100.0]))
    assert result.status == "unreachable"
    assert [(state.status, state.mean_pressure, state.found) for state in result.states] == [
        ("unreachable", 0.0, False)
    ]


def test_a_penetration_beyond_complete_contact_is_unreachable():
    result = solve(scene("penetration", [5e-5, 1.5e-4, 4e-5]))
    assert result.status == "unreachable"
    assert [state.status for state in result.targets] == ["converged", "unreachable", "converged"]
    assert "target 2 of 3, penetration = 0.00015 m" in result.failure
