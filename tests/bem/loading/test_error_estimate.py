"""Corrections behind the error estimates, and their least value: rounding.  True errors: case test_error_estimate."""

from dataclasses import asdict

import numpy as np
import pytest

from bem.elastic.collocation import Elastic, evaluate
from bem.geometry.profile import Profile
from bem.loading.assessment import quantities_of
from bem.loading.control import DisplacementControl, LoadControl
from bem.loading.increments import Accuracy
from bem.nonadhesive.contact_assessment import assess_contact
from bem.nonadhesive.grid_contact import grid_problem
from bem.nonadhesive.nonadhesive import solve_contact
from bem.solver import solve

CONTROLS = {
    "penetration": (DisplacementControl(), 1.0),
    "load": (LoadControl(), 3.0),
    "total displacement": (DisplacementControl(0.3), 2.0),
}


@pytest.mark.parametrize("control", CONTROLS)
@pytest.mark.parametrize("quantity", ["penetration", "load", "contact_length", "elastic_energy", "stiffness"])
def test_wrong_edges_without_adhesion_are_corrected_to_second_order(control, quantity):
    """Edges moved by 1e-4 of the widths: what comes of it is foreseen from one evaluation, but for the next order."""
    condition, target = CONTROLS[control]
    elastic = Elastic(Profile.self_affine(2 * np.pi, 0.7, 1.0, 20, 3).scaled())
    start = grid_problem(elastic).patches(condition, target)
    exact = solve_contact(elastic, condition, start, 1.0, target, Accuracy(1e-12, 1e-12, 1e-10)).state
    off = 1e-4 * np.tile(exact.patches.width, 2) * np.cos(np.arange(2 * exact.patches.count))
    state = evaluate(elastic, exact.patches.moved(off), condition.guess(exact.penetration, target), 1e-12)
    state = condition.reach(state, target)
    correction = getattr(assess_contact(elastic, condition, state, target, 1e-13).correction, quantity)
    needed = getattr(quantities_of(exact).minus(quantities_of(state)), quantity)
    # measured 2e-4
    assert correction == pytest.approx(needed, rel=5e-4, abs=1e-13)


@pytest.mark.parametrize("amplitude", [1e-12, 1e-5], ids=["complete", "partial"])
def test_no_estimate_is_below_the_rounding_of_its_number(amplitude):
    wave = Profile.from_harmonics(0.01, [1], [amplitude], [0.0])
    result = solve(
        profile=wave,
        solid={"youngs_modulus": 1e9, "poisson_ratio": 0.5},
        adhesion={"work_of_adhesion": 1e-3},
        loading={"control": "mean_pressure", "targets": [2e6 / 3]},
    )
    (state,) = result.targets
    estimates = {name: error for name, error in asdict(state.error_estimate).items() if error is not None}
    assert estimates["mean_pressure"] > 0
    for name, error in estimates.items():
        assert error >= np.spacing(abs(getattr(state, name) or 0.0)) or getattr(state, name) == 0, name
