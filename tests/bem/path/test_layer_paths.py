"""Paths on layers: thin incompressible ones to ten digits of doubled resolution, thick ones left out, plates driven."""

from functools import lru_cache

import numpy as np
import pytest
import scene_tables
from rough_surfaces import rough_scene
from scene_tables import tables, waves

from bem.elastic.layer import compliance_ratio
from bem.geometry.profile import Profile
from bem.scene.scene import parse_scene
from bem.solver import solve

PERIOD, AMPLITUDE, MODULUS = 0.01, 1e-4, 1e6
THIN = 0.02 * PERIOD
LOOP = (5e-6, 9e-5, 5e-5, 2e-6)


def wave(control, targets, adhesion=None, nu=0.5, thickness=THIN, tolerance=1e-10):
    more = {"slope_term": True, "thickness": thickness, "nu": nu, "accuracy": {"tolerance": tolerance}}
    return parse_scene(tables(waves([1], [AMPLITUDE], [0.3]), control, targets, adhesion, **more))


def rough(adhesion, nu, thickness=THIN):
    return rough_scene(
        [60e-6, 25e-6, 50e-6],
        12,
        1,
        adhesion,
        solid={"youngs_modulus": MODULUS, "poisson_ratio": nu},
        layer={"thickness": thickness},
        accuracy={"tolerance": 1e-10},
    )


SCENES = {
    "one wave, nu=0.5": lambda: wave("penetration", LOOP),
    "one wave, nu=0.5, adhesion": lambda: wave("penetration", LOOP, 0.03),
    "one wave, nu=0.3, adhesion": lambda: wave("penetration", LOOP, 0.03, 0.3),
    "rough, nu=0.5": lambda: rough(None, 0.5),
    "rough, nu=0.5, adhesion": lambda: rough(0.03, 0.5),
    "rough, nu=-0.5, adhesion": lambda: rough(0.03, -0.5),
    "rough, nu=0.499999": lambda: rough(None, 0.499999),
}
SLOW = ("rough, nu=-0.5, adhesion",)  # nu < 0 runs here only; adhesion on rough layers and nu = 0.3 always run
by_scene = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in SCENES]
)


@lru_cache(maxsize=16)
def solved(name):
    posed = SCENES[name]()
    return posed, solve(posed)


@by_scene
def test_path_is_converged_and_certified(name):
    _, result = solved(name)
    assert result.status == "converged"
    assert all(state.certificate.ok for state in result.states)


def test_a_thin_incompressible_layer_is_stiff_and_a_compressible_one_less():
    half_space = solve(wave("penetration", LOOP[:2], thickness=None)).targets[-1]
    soft = solve(wave("penetration", LOOP[:2], nu=0.3)).targets[-1]
    stiff = solved("one wave, nu=0.5")[1].targets[1]
    assert stiff.mean_pressure > 5 * soft.mean_pressure > 5 * half_space.mean_pressure


@pytest.mark.parametrize("adhesion", [None, 0.03], ids=["bare", "adhesive"])
def test_a_driven_plate_meets_the_states_of_fixed_penetration(adhesion):
    here = solve(wave("penetration", LOOP[:3], adhesion, 0.3)).targets
    driven = solve(wave("total_displacement", [state.total_displacement for state in here], adhesion, 0.3)).targets
    for state, twin in zip(here, driven, strict=True):
        assert abs(state.contact_fraction - twin.contact_fraction) <= 1e-10  # measured 1e-12
        assert abs(state.mean_pressure - twin.mean_pressure) <= 1e-10 * abs(state.mean_pressure)


def test_closing_gaps_of_a_very_thin_layer_release_energy():
    """Within an increment of 2e-3 rms heights pressures change by more than adhesion can hold: -4e-3 J/m^2 once."""
    events = solve(rough_scene([42e-6], 40, 2595332252, 2.9e-3, "penetration", layer={"thickness": 1e-4})).events
    assert sum(event.kind == "coalescence" for event in events) == 6  # at a tenth of the increment as well
    assert all(0 <= event.energy_released <= 6e-5 for event in events)  # J/m^2; measured 8.5e-6 to 3e-5


def test_plate_moves_by_penetration_and_mean_compression():
    states = solve(wave("penetration", LOOP, nu=0.3)).targets
    compliance = THIN * 0.4 * 1.3 / (MODULUS * 0.7)  # d (1 - 2 nu)(1 + nu) / (E (1 - nu))
    for state in states:
        assert state.total_displacement == pytest.approx(
            state.penetration + compliance * state.mean_pressure, rel=1e-14
        )


def test_a_layer_that_matters_little_changes_little_but_is_kept():
    """A layer of 2.5 periods changes the compliance by 3e-12; a tolerance of 1e-12 keeps it, without overflow."""
    thickness, q = 2.5 * PERIOD, 2 * np.pi / PERIOD
    deficit = 1 - float(compliance_ratio(q * thickness, 0.3))
    result = solve(wave("penetration", LOOP[:2], nu=0.3, thickness=thickness, tolerance=1e-12))
    none = solve(wave("penetration", LOOP[:2], nu=0.3, thickness=None, tolerance=1e-12))
    assert next(effect for effect in result.effects if effect.name == "layer").active
    for state, other in zip(result.targets, none.targets, strict=True):
        assert abs(state.mean_pressure / other.mean_pressure - 1) <= 100 * deficit


@pytest.mark.parametrize("q_d", [1e-4, 1.0, 400.0, 1e6], ids=lambda value: f"q0d={value:g}")
def test_no_thickness_overflows(q_d):
    ratio = compliance_ratio(q_d * np.array([1.0, 10.0, 1e4]), 0.5)
    assert np.all((ratio > 0) & (ratio <= 1))


@pytest.mark.parametrize(
    ("thickness", "theta", "targets"),
    [
        pytest.param(3e-4, 0.3, [2.5e-5, 4e-5], id="a jump that releases nothing"),
        pytest.param(1e-4, 0.003, [2.8e-5, 3e-5], id="back to the fold it left, weak adhesion", marks=pytest.mark.slow),
    ],
)
def test_path_on_a_thin_layer_does_not_jump_from_the_same_place_again(thickness, theta, targets):
    wave = Profile.self_affine(0.01, 0.7, 5e-5, 100, 1436176144)
    full = MODULUS / 0.75 * float(np.sum(wave.q0 * wave.orders * wave.amplitudes**2)) / 8
    profile = scene_tables.rough(100, 1436176144)
    result = solve(parse_scene(tables(profile, "separation", targets, theta * full, thickness=thickness)))
    assert result.status == "converged"
    places = [(event.kind, round(event.penetration, 14), round(event.position, 9)) for event in result.events]
    assert len(set(places)) == len(places)
