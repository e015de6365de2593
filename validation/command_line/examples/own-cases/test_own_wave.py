"""Your own solver beside the boundary elements: a case is a pytest test.

linecontact verify --cases own-cases --out report        # own-cases/test_*.py and case_*.toml
linecontact challenge judge --solver own_solver:solve --only westergaard --out judged    # in this folder
"""

import pytest
from own_solver import solve

import bem
from validation.plugin.rows import Code, Quantity

PROBLEM = {
    "solid": {"youngs_modulus": 1.0e6, "poisson_ratio": 0.5},
    "profile": {"period": 0.01, "orders": [1], "amplitudes": [1e-4], "phases": [0.0]},
}


@pytest.mark.parametrize("pressure", [2e3, 1e4, 2e4])
def test_one_wave(rows, pressure):
    """Does my solver find the contact fraction of one wave under a load?"""
    path = {"control": "mean_pressure", "targets": [pressure]}
    profile = {"kind": "harmonics"} | PROBLEM["profile"]
    state = bem.solve(solid=PROBLEM["solid"], profile=profile, loading=path).targets[-1]
    mine = solve(PROBLEM | {"path": path})["contact_fraction"][-1]
    rows.compare(
        "contact fraction",
        mine,
        state.contact_fraction,
        of=Code.USER,
        by=Code.BEM,
        quantity=Quantity.AREA,
        uncertainty=(1e-9, state.error_estimate.contact_fraction),
        source="my closed form",
    )
