"""Paths of few digits: the states of the exact path, events as brackets, and errors that say what is uncertain."""

from dataclasses import replace

import numpy as np
import pytest
from rough_surfaces import rough_scene
from scene_tables import rough, tables

from bem.continuation import locating
from bem.scene.scene import parse_scene
from bem.solver import solve

TARGETS = [70e-6, 50e-6, 35e-6, 60e-6, 90e-6]
WIDTHS = {1e-2: 0.05, 1e-3: 0.01, 1e-4: 0.002}  # of brackets, rms heights; 0.001 at 1e-4 but beside targets
SAME = 1e-8  # of two settled states, relative; measured 3e-12


@pytest.fixture(scope="module")
def exact():
    return solve(rough_scene(TARGETS))


@pytest.fixture(scope="module", params=[1e-2, 1e-3, 1e-4])
def leaping(request):
    return solve(rough_scene(TARGETS, accuracy={"tolerance": request.param}))


def test_targets_are_certified_equilibria_of_the_exact_path(exact, leaping):
    assert leaping.status == "converged"
    for state, other in zip(leaping.targets, exact.targets, strict=True):
        assert state.contact_fraction == pytest.approx(other.contact_fraction, rel=SAME)
        assert state.mean_pressure == pytest.approx(other.mean_pressure, rel=SAME)


def test_errors_say_that_the_path_is_uncertain(exact, leaping):
    tolerance = leaping.scene["accuracy"]["tolerance"]
    for state, other in zip(leaping.targets[:4], exact.targets, strict=False):
        assert state.error_estimate.contact_fraction == pytest.approx(tolerance * state.contact_fraction, rel=1e-3)
        assert other.error_estimate.contact_fraction < 1e-6 * state.contact_fraction
    assert any("another branch" in caution.message for caution in leaping.warnings)
    assert not exact.warnings


def test_events_are_brackets_that_hold_those_of_the_exact_path(exact, leaping):
    loading = leaping.targets[2].penetration
    found = [event for event in leaping.events if event.kind == "new_contact" and event.penetration < loading]
    assert len(found) > 5
    widest = 3 * 1.3 * WIDTHS[leaping.scene["accuracy"]["tolerance"]] / 2 * 50e-6  # a leap takes up what is left of two
    for event in found:
        error = event.error_estimate.penetration
        close = [
            other
            for other in exact.events
            if other.kind == event.kind and abs(other.position - event.position) < 0.01 / 40 / 4
        ]
        assert any(abs(other.penetration - event.penetration) < error for other in close)
        assert 0.2 * widest < error <= widest


def test_energy_released_is_that_of_the_exact_path(exact, leaping):
    """Work done at the interface between two targets: the sum over events, each to what its bracket leaves open."""
    sums = [sum(event.energy_released for event in result.events) for result in (exact, leaping)]
    errors = sum(event.error_estimate.energy_released for event in leaping.events)
    assert abs(sums[0] - sums[1]) < errors  # measured 0.14 and 0.03 of it
    assert errors < sums[0]  # 0.78, 0.32


def test_an_interrupted_path_goes_on_as_if_it_had_not_been(leaping):
    scene = rough_scene(TARGETS, accuracy=leaping.scene["accuracy"])
    count = 0

    def stop(record):
        nonlocal count
        count += 1
        if count == 6:
            raise KeyboardInterrupt

    half = solve(scene, on_state=stop)
    assert half.status == "interrupted"
    whole = solve(scene, resume=half)
    assert [state.edges for state in whole.targets] == [state.edges for state in leaping.targets]
    assert [vars(event) for event in whole.events] == [vars(event) for event in leaping.events]


@pytest.mark.parametrize("reach", [0.2, 0.1])
def test_pressures_on_the_way_are_met_where_the_exact_path_meets_them(reach, monkeypatch):
    """Also where Newton does not reach from one end of a leap to a pressure, which the other end has on its branch."""
    monkeypatch.setattr(locating, "LONGEST", reach)
    loading = {
        "control": "separation",
        "targets": [20e-6],
        "at_mean_pressures": [2e3, 5e3],
        "stop_at_mean_pressure": 8e3,
    }
    exact, leaping = (
        solve(rough_scene([], 60, 0, loading=loading, accuracy={"tolerance": tolerance})) for tolerance in (1e-6, 1e-2)
    )
    assert len(leaping.targets) == 3
    for state, other in zip(leaping.targets, exact.targets, strict=True):
        assert state.contact_fraction == pytest.approx(other.contact_fraction, rel=SAME)


def test_contact_closes_and_opens():
    results = [
        solve(rough_scene([20e-6, 0.0, 60e-6], 20, accuracy={"tolerance": tolerance})) for tolerance in (1e-6, 1e-2)
    ]
    fractions = [[state.contact_fraction for state in result.targets] for result in results]
    assert fractions[1] == pytest.approx(fractions[0], rel=SAME)
    assert fractions[1][1] == 1.0


def test_a_layer_driven_by_its_plate():
    changes = {
        "layer": {"thickness": 2e-3},
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.3},
        "loading": {"control": "total_displacement", "targets": [50e-6, 100e-6, 60e-6]},
    }
    exact, leaping = (solve(rough_scene([], 20, accuracy={"tolerance": t}, **changes)) for t in (1e-6, 1e-2))
    for state, other in zip(leaping.targets, exact.targets, strict=True):
        assert state.contact_fraction == pytest.approx(other.contact_fraction, rel=SAME)
        assert state.error_estimate.penetration > 1e-6 * state.penetration


def test_under_a_given_load_the_path_is_exact():
    exact, other = (
        solve(rough_scene([3e3], 20, control="mean_pressure", accuracy={"tolerance": t})) for t in (1e-6, 1e-2)
    )
    assert [replace(event, error_estimate=None) for event in other.events] == [
        replace(event, error_estimate=None) for event in exact.events
    ]
    np.testing.assert_allclose(other.targets[0].edges, exact.targets[0].edges, rtol=1e-8)


def test_a_leap_into_a_higher_minimum_is_an_error_of_its_event():
    """An event gained energy beyond its error, and the target was refused."""
    data = tables(rough(400, 12, hurst=0.8), "separation", [2e-5], 0.05, accuracy={"tolerance": 1e-2})
    result = solve(parse_scene(data))
    assert result.status == "converged"
    gained = [event for event in result.events if event.energy_released < 0]
    assert all(-event.energy_released <= event.error_estimate.energy_released for event in gained)
    assert gained  # 3.2e-4 of 0.05 J/m^2
