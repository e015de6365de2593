"""Largest tension of a path: turns of the load, folds and jumps, whatever steps, digits, outputs and controls are."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from johnson_branch import ALPHA, johnson, lowest
from scene_tables import PERIOD, tables, waves

from bem.scene.scene import parse_scene
from bem.solver import solve

CASES = Path(__file__).parent / "event_cases"
STEPS = {"default": {}, "long": {"max_increment": 0.2}, "short": {"max_increment": 0.017}}
DIGITS = {str(tolerance): {"tolerance": tolerance} for tolerance in (1e-9, 1e-4, 1e-2)}
ACCURACY = STEPS | DIGITS


def stored(name, accuracy, **changes):
    return solve(parse_scene(tomllib.loads((CASES / f"{name}.toml").read_text()) | {"accuracy": accuracy} | changes))


def assert_within(tension, right):
    assert abs(tension.mean_pressure - right) <= tension.error_estimate.mean_pressure + 1e-10 * abs(right)


@pytest.mark.parametrize("accuracy", ACCURACY.values(), ids=ACCURACY)
@pytest.mark.parametrize(("name", "right"), [("layer-34-waves", -83.318334551662), ("twenty-waves", -1917.004626317)])
def test_a_turn_of_the_load_does_not_depend_on_the_steps(name, right, accuracy):
    """The largest of the stored states missed them: 73.36 Pa, and 1913.4 to 1916.9 Pa by the increment."""
    tension = stored(name, accuracy).largest_tension
    assert tension.kind == "turn"
    assert_within(tension, right)
    assert tension.error_estimate.mean_pressure <= 0.1 * accuracy.get("tolerance", 1e-6) * abs(right) + 3e-6


def test_outputs_do_not_move_it():
    plain, drawn = (stored("twenty-waves", {}, **more) for more in ({}, {"output": {"spectra": True}}))
    assert drawn.largest_tension == plain.largest_tension


def test_contact_that_cannot_open_has_no_tension():
    assert stored("no-flaw", {}).largest_tension is None


def wave(control, targets, **accuracy):
    """One wave of Johnson's closed form; in SI units, pressures over those of the closed form."""
    amplitude, modulus = 1e-4, 1e6 / 0.75
    full = np.pi * modulus * amplitude / PERIOD
    work = (ALPHA * full) ** 2 * PERIOD / (2 * modulus)
    scale = full / (2 * np.pi * np.sqrt(2.0))
    targets = [target * (scale if control == "mean_pressure" else 1.0) for target in targets]
    profile = waves([1], [amplitude])
    return solve(parse_scene(tables(profile, control, targets, work, accuracy=accuracy or None))), scale


@pytest.mark.parametrize("tolerance", [1e-6, 1e-3])
def test_of_one_wave_it_is_that_of_the_closed_form(tolerance):
    """A turn at a given separation, the fold at a given load."""
    right = lowest("load")
    result, scale = wave("separation", [8e-5, 2.5e-4], tolerance=tolerance)
    assert result.largest_tension.kind == "turn"
    assert_within(result.largest_tension, right * scale)
    result, scale = wave("mean_pressure", [0.5, 2 * right], tolerance=tolerance)
    assert result.largest_tension.kind == "fold"
    assert_within(result.largest_tension, right * scale)


def test_loading_alone_has_none():
    result, _ = wave("separation", [1.2e-4, 8e-5])
    assert min(state.mean_pressure for state in result.states) < 0
    assert result.largest_tension is None


def test_the_edges_of_the_closed_form_are_those_of_the_turn():
    psi = np.linspace(0.01, 0.8, 20001)
    depth = johnson("penetration", psi[np.argmin(johnson("load", psi))])
    result, _ = wave("separation", [8e-5, 2.5e-4])
    assert result.largest_tension.penetration == pytest.approx(depth * 1e-4 / np.sqrt(2.0), rel=1e-3)
