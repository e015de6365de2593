"""Paths of few digits: targets and events of the path of many digits, within the errors stated, for no more work."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from rough_surfaces import rough_scene

from bem.scene.scene import parse_scene
from bem.solver import solve

CASES = Path(__file__).parent / "event_cases"
SAME = 1e-9  # of two settled states, relative; measured 1e-12
DIGITS = 1e-6, 1e-4, 1e-3, 1e-2
NAMES = "nearly-repeating-15", "nearly-repeating-71", "two-waves", "pull-off-error"


def rough_tables(tolerance, **changes):
    return rough_scene([70e-6, 50e-6, 35e-6, 60e-6, 90e-6], accuracy={"tolerance": tolerance}, **changes)


def stored(name, tolerance):
    """A stored scene at a tolerance: profiles that nearly repeat, two waves, and one wave with two ripples."""
    return parse_scene(tomllib.loads((CASES / f"{name}.toml").read_text()) | {"accuracy": {"tolerance": tolerance}})


def pushed(tolerance):
    """A rough layer under a given load, through pressures on the way."""
    loading = {"control": "mean_pressure", "targets": [3e3, 6e3, 1e3, -200.0]}
    return rough_scene([], 20, loading=loading, layer={"thickness": 2e-3}, accuracy={"tolerance": tolerance})


def driven(tolerance):
    """A compressible layer driven by its plate, with pressures asked for on the way."""
    loading = {"control": "total_displacement", "targets": [5e-5, 1e-4, 6e-5], "at_mean_pressures": [2e3, 5e3]}
    solid = {"youngs_modulus": 1e6, "poisson_ratio": 0.3}
    return rough_scene(
        [], 20, loading=loading, solid=solid, layer={"thickness": 2e-3}, accuracy={"tolerance": tolerance}
    )


SCENES = {"rough": rough_tables, "pushed": pushed, "driven": driven}
SCENES |= {name: lambda tolerance, name=name: stored(name, tolerance) for name in NAMES}


@pytest.fixture(scope="module", params=SCENES)
def paths(request):
    """The same path at every number of digits."""
    return [solve(SCENES[request.param](tolerance)) for tolerance in DIGITS]


def test_targets_are_those_of_many_digits(paths):
    many, *few = paths
    for result in few:
        assert result.status == many.status
        for state, other in zip(result.targets, many.targets, strict=True):
            assert (state.status, state.n_patches) == (other.status, other.n_patches)
            if other.found:
                assert state.contact_fraction == pytest.approx(other.contact_fraction, rel=SAME)
                assert state.mean_pressure == pytest.approx(other.mean_pressure, rel=SAME, abs=1e-9)


def test_events_are_those_of_many_digits_within_their_errors(paths):
    many, *few = paths
    for result in few:
        assert [event.kind for event in result.events] == [event.kind for event in many.events]
        for event, other in zip(result.events, many.events, strict=True):
            for name in ("penetration", "mean_pressure", "energy_released"):
                value, right = getattr(event, name), getattr(other, name)
                if right is not None:
                    error = getattr(event.error_estimate, name) + getattr(other.error_estimate, name)
                    assert abs(value - right) <= error + 1e-12 * abs(right)


def test_errors_of_events_are_less_than_the_digits_asked_for(paths):
    for result, tolerance in zip(paths, DIGITS, strict=True):
        deepest = max(abs(state.penetration) for state in result.targets if state.found)
        assert all(event.error_estimate.penetration <= 0.3 * tolerance * deepest for event in result.events)


def test_few_digits_take_no_more_work(paths):
    work = [sum(state.evaluations for state in result.states) for result in paths]
    assert max(work[1:]) <= 1.05 * work[0]


def test_contact_closes_and_opens():
    results = [
        solve(rough_scene([20e-6, 0.0, 60e-6], 20, accuracy={"tolerance": tolerance})) for tolerance in (1e-6, 1e-2)
    ]
    fractions = [[state.contact_fraction for state in result.targets] for result in results]
    assert fractions[1] == pytest.approx(fractions[0], rel=SAME)
    assert fractions[1][1] == 1.0


def test_patches_of_a_mirrored_trace_jump_together():
    """Two equal pairs of edges fold at one load: evaluations that break the mirror image find no way past it."""
    orders = np.arange(1, 101)
    amplitudes = (orders**2.0 + 100.0) ** -0.65 * np.random.default_rng(1).standard_normal(100)
    amplitudes *= 0.05 / np.sqrt(np.sum((2 * np.pi / 2.4e-3 * orders * amplitudes) ** 2) / 2)
    profile = {"kind": "harmonics", "period": 2.4e-3, "orders": orders, "amplitudes": amplitudes, "phases": 0 * orders}
    loading = {"control": "mean_pressure", "targets": [4e5]}
    solid, accuracy = {"youngs_modulus": 5e6, "poisson_ratio": 0.49}, {"tolerance": 1e-3}
    result = solve(
        profile=profile, solid=solid, adhesion={"work_of_adhesion": 0.05}, loading=loading, accuracy=accuracy
    )
    assert (result.status, result.targets[0].status) == ("converged", "complete_contact")
    pairs = [event.mean_pressure for event in result.events if event.mean_pressure > 1.5e5]
    assert pairs[::2] == pairs[1::2]


def test_an_interrupted_path_goes_on_as_if_it_had_not_been():
    scene, count = rough_tables(1e-3), 0

    def stop(record):
        nonlocal count
        count += 1
        if count == 3:
            raise KeyboardInterrupt

    half = solve(scene, on_state=stop)
    assert half.status == "interrupted"
    whole, unbroken = solve(scene, resume=half), solve(scene)
    assert [state.edges for state in whole.targets] == [state.edges for state in unbroken.targets]
    assert [vars(event) for event in whole.events] == [vars(event) for event in unbroken.events]
