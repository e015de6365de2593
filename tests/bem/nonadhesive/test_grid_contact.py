"""The grid on which contact without adhesion is looked for first: Westergaard, the mirror of gaps, narrow patches."""

import numpy as np
import pytest

from bem.elastic.collocation import Elastic
from bem.elastic.compliance import Compliance
from bem.elastic.layer import Layer
from bem.geometry.profile import Profile
from bem.geometry.scaling import Solid
from bem.loading.control import DisplacementControl, LoadControl
from bem.loading.increments import Accuracy
from bem.nonadhesive.grid_contact import _intervals, grid_problem
from bem.nonadhesive.nonadhesive import solve_contact

FIXED, LOADED = DisplacementControl(), LoadControl()
BOTH = pytest.mark.parametrize("control", [FIXED, LOADED], ids=["penetration", "load"])


def wave_at(fraction, control, phase=0.4):
    """One wave at Westergaard's contact fraction: the problem and its target."""
    share = np.sin(np.pi * fraction / 2) ** 2
    wave = Profile.from_harmonics(2 * np.pi, [1], [1.0], [phase])
    return Elastic(wave), (share * (1 - np.log(share)) if control is FIXED else 2 * np.pi * share)


@BOTH
@pytest.mark.parametrize("fraction", [0.1, 0.3, 0.45, 0.6, 0.9])
def test_one_wave_to_a_fraction_of_a_cell(control, fraction):
    elastic, target = wave_at(fraction, control)
    patches = grid_problem(elastic).patches(control, target)
    assert patches.count == 1
    cells = elastic.profile.grid[0].size
    # measured 0.36 cells
    assert abs(patches.contact_fraction - fraction) * cells <= 0.8


@BOTH
@pytest.mark.parametrize("fraction", [1e-6, 1 - 1e-4], ids=["patch", "gap"])
def test_what_is_narrower_than_a_cell_is_put_in_its_place(control, fraction):
    elastic, target = wave_at(fraction, control)
    patches = grid_problem(elastic).patches(control, target)
    crest, cell = 2 * np.pi - 0.4, 2 * np.pi / elastic.profile.grid[0].size
    assert patches.count == 1
    # measured 0.003 cells: the next term of the parabola
    assert abs((patches.center[0] - crest + np.pi) % (2 * np.pi) - np.pi) <= 0.01 * cell


def test_narrow_intervals_that_lean_towards_one_another_do_not_overlap():
    """Two points and one point, a single one between them, and a drive that is almost as high there."""
    values, drive = np.zeros(64), np.zeros(64)
    values[[10, 11, 13]] = drive[[11, 13]] = 1.0
    drive[12] = 0.9
    intervals = _intervals(values, drive, 2.0)
    assert intervals.count == 2
    assert intervals.is_ordered


@BOTH
@pytest.mark.parametrize("share", [0.02, 0.3, 0.9, 0.999])
@pytest.mark.parametrize("seed", [0, 1])
def test_a_rough_contact_needs_few_steps_from_there(control, share, seed):
    elastic = Elastic(Profile.self_affine(2 * np.pi, 0.7, 1.0, 60, seed).scaled())
    target = share * (elastic.profile.max_height if control is FIXED else 60.0)
    start = grid_problem(elastic).patches(control, target)
    found = solve_contact(elastic, control, start, 1.0, target, Accuracy(1e-8, 1e-9, 1e-10))
    assert found.status == "converged"
    assert found.evaluations <= 16  # measured 8 at most
    assert abs(start.contact_fraction - found.state.patches.contact_fraction) <= 0.006  # measured 0.003


@pytest.mark.parametrize("thickness", [1e-3, 0.02, 1.0], ids=str)
def test_a_layer_is_seen(thickness):
    solid, layer = Solid(1.0, 0.5), Layer(thickness * 2 * np.pi)
    kernel = layer.kernel(solid, 2 * np.pi, 1e-14)
    elastic = Elastic(Profile.from_harmonics(2 * np.pi, [1, 3], [1.0, 0.2]), Compliance(kernel))
    problem = grid_problem(elastic)
    orders = np.array([1.0, 5.0, 20.0])
    np.testing.assert_allclose(problem.compliance[[1, 5, 20]], kernel.ratio(orders) / orders, atol=1e-9)


@pytest.mark.parametrize("compliance", [1e-6, 0.3, 5.0, 50.0, 500.0], ids=str)
def test_few_steps_under_total_displacement(compliance):
    elastic, control = (
        Elastic(Profile.self_affine(2 * np.pi, 0.7, 1.0, 30, 3).scaled()),
        DisplacementControl(compliance),
    )
    fixed = reached(elastic, FIXED, 1.3).state
    found = reached(elastic, control, control.value(1.3, fixed.load))
    assert found.state.penetration == pytest.approx(1.3, abs=1e-9)
    assert found.evaluations <= 12  # measured 6, where the start is worst


def reached(elastic, control, target):
    """The contact from its start on the grid."""
    start = grid_problem(elastic).patches(control, target)
    return solve_contact(elastic, control, start, 1.0, target, Accuracy(1e-8, 1e-9, 1e-10))
