"""Two flat surfaces: every target has an exact answer, for every control, with adhesion and without."""

import math

import pytest
from scene_tables import tables, waves

from bem.elastic.layer import Layer
from bem.geometry.scaling import Solid
from bem.scene.scene import parse_scene
from bem.solver import solve

THICKNESS, SOLID = 0.001, Solid(1e6, 0.3)


def states(control, targets, adhesion=None, layer=False, initial="separated"):
    flawed = initial == "complete_contact" and control == "mean_pressure" and adhesion
    more = {"thickness": THICKNESS if layer else None, "nu": 0.3, "initial": initial, "flaw": 1e-4 if flawed else None}
    result = solve(parse_scene(tables(waves([1], [0.0]), control, targets, adhesion, **more)))
    return result.status, result.targets


def test_surfaces_are_apart_at_any_separation():
    status, (state,) = states("separation", [1e-6])
    assert status == "converged"
    assert (state.status, state.contact_fraction, state.mean_pressure) == ("separated", 0.0, 0.0)


def test_pressure_joins_them():
    _, (state,) = states("mean_pressure", [1e3])
    assert (state.status, state.contact_fraction, state.mean_pressure) == ("complete_contact", 1.0, 1e3)
    assert state.separation == 0.0


def test_adhesion_lends_its_energy_in_contact_only():
    _, (joined,) = states("mean_pressure", [1e3], adhesion=0.05)
    _, (apart,) = states("separation", [1e-6], adhesion=0.05)
    assert joined.adhesion_energy == pytest.approx(-0.05, rel=1e-15)
    assert apart.adhesion_energy == 0.0


def test_no_tension_without_contact_before():
    status, (state,) = states("mean_pressure", [-1e3], adhesion=0.05)
    assert status == "unreachable"
    assert state.status == "unreachable"


def test_tension_holds_once_joined_with_adhesion():
    _, (_, state) = states("mean_pressure", [1e3, -1e9], adhesion=0.05)
    assert (state.status, state.mean_pressure) == ("complete_contact", -1e9)


def test_tension_parts_them_without_adhesion():
    status, found = states("mean_pressure", [1e3, -1.0, 2e3])
    assert status == "unreachable"
    assert [state.status for state in found] == ["complete_contact", "unreachable", "complete_contact"]
    assert [state.mean_pressure for state in found if state.found] == [1e3, 2e3]


def test_plate_moves_by_the_mean_compression():
    _, (state,) = states("mean_pressure", [1e3], layer=True)
    assert state.total_displacement == pytest.approx(Layer(THICKNESS).mean_compliance(SOLID) * 1e3, rel=1e-15)


def test_driven_plate_finds_the_pressure():
    _, (state,) = states("total_displacement", [1e-6], layer=True)
    assert state.mean_pressure == pytest.approx(1e-6 / Layer(THICKNESS).mean_compliance(SOLID), rel=1e-15)


def test_pressure_of_a_prescribed_contact_is_left_open():
    _, (state,) = states("penetration", [0.0])
    assert state.status == "complete_contact"
    assert math.isnan(state.mean_pressure)


def test_surfaces_cannot_overlap():
    status, (state,) = states("penetration", [1e-6])
    assert status == "unreachable"
    assert state.status == "unreachable"
    assert state.penetration == 1e-6
    assert math.isnan(state.separation)
