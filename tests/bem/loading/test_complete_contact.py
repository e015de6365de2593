"""Complete contact in closed form: pressures, energies, least load, on half-space and layer, by other quadratures."""

import numpy as np
import pytest
from scene_tables import tables, waves

from bem.elastic.layer import Layer
from bem.geometry.scaling import Solid
from bem.loading.complete_contact import complete_contact
from bem.problem import pose
from bem.scene.scene import parse_scene
from bem.solver import solve

PERIOD, SOLID = 0.01, Solid(1e6, 0.3)
MODULUS = 1e6 / (1 - 0.3**2)
ORDERS, AMPLITUDES, PHASES = [1, 2, 5], [1e-4, 4e-5, 1e-5], [0.0, 1.0, 2.5]
X = np.linspace(0, PERIOD, 4096, endpoint=False)


def scene(thickness=None, control="mean_pressure", targets=(1e9,), adhesion=None, **loading):
    more = {"slope_term": True, "thickness": thickness, "nu": SOLID.poisson_ratio}
    return parse_scene(tables(waves(ORDERS, AMPLITUDES, PHASES), control, targets, adhesion, **more, **loading))


def exact_pressure(thickness):
    """h_m / c(m q0) of every mode, less the mean."""
    q = 2 * np.pi / PERIOD * np.array(ORDERS)
    compliance = 2 / (MODULUS * q) if thickness is None else Layer(thickness).compliance(SOLID, q)
    return np.cos(np.outer(X, q) + PHASES) @ (np.array(AMPLITUDES) / compliance)


def found(thickness=None, adhesion=None):
    posed = scene(thickness, adhesion=adhesion)
    problem = pose(posed)
    return problem, complete_contact(problem.profile, problem.law, problem.elastic.compliance)


by_thickness = pytest.mark.parametrize("thickness", [None, 0.005, 0.001, 2e-4], ids=str)


@by_thickness
def test_every_mode_carries_its_height_over_its_compliance(thickness):
    problem, complete = found(thickness)
    pressure = complete.pressure.height(X / problem.scales.length) * problem.scales.stress
    exact = exact_pressure(thickness)
    np.testing.assert_allclose(pressure, exact, rtol=0, atol=1e-12 * np.abs(exact).max())


@by_thickness
def test_energy_is_the_work_of_that_pressure(thickness):
    problem, complete = found(thickness)
    height = problem.surface.height(X)
    assert complete.elastic_energy * problem.scales.energy_per_area == pytest.approx(
        np.mean(exact_pressure(thickness) * height) / 2, rel=1e-12
    )


@by_thickness
def test_least_load_is_where_the_lowest_pressure_vanishes(thickness):
    problem, complete = found(thickness)
    least = -exact_pressure(thickness).min()
    assert problem.mean_pressure(complete.least_load) == pytest.approx(least, rel=1e-6)  # of 4096 samples


def test_adhesion_energy_is_that_of_the_whole_arc():
    problem, complete = found(adhesion=0.05)
    arc = np.mean(np.sqrt(1 + problem.surface.slope(X) ** 2))
    assert complete.adhesion_energy * problem.scales.energy_per_area == pytest.approx(-0.05 * arc, rel=1e-12)


@by_thickness
def test_contact_without_adhesion_closes_at_the_least_load(thickness):
    problem, complete = found(thickness)
    least = problem.mean_pressure(complete.least_load)
    states = solve(scene(thickness, targets=(0.99 * least, 1.0001 * least))).targets
    assert [state.status for state in states] == ["converged", "complete_contact"]
    assert states[0].contact_fraction < 1


def test_complete_contact_reports_its_closed_form():
    problem, complete = found(0.001)
    state = solve(scene(0.001)).targets[0]
    assert (state.contact_fraction, state.n_patches, state.separation, state.edges) == (1.0, 0, 0.0, ())
    assert state.elastic_energy == complete.elastic_energy * problem.scales.energy_per_area
    compliance = Layer(0.001).mean_compliance(SOLID)
    assert state.total_displacement == pytest.approx(problem.surface.max_height + compliance * 1e9, rel=1e-14)


def test_complete_contact_without_a_flaw_opens_under_no_load_without_adhesion():
    least = found()[0].mean_pressure(found()[1].least_load)
    states = solve(scene(targets=(2 * least, 0.9 * least), initial="complete_contact")).targets
    assert [state.status for state in states] == ["complete_contact", "converged"]
