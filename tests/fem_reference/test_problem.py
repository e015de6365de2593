"""Checks of the raw input, and the profile with its derivatives and crests."""

import dataclasses

import numpy as np
import pytest

from fem_reference.problem import InvalidProblemError, Problem

GOOD = {
    "youngs_modulus": 1e6,
    "poisson_ratio": 0.5,
    "thickness": 0.02,
    "period": 0.01,
    "orders": [1, 3],
    "amplitudes": [5e-5, 1e-5],
    "phases": [0.2, 1.0],
    "work_of_adhesion": 0.03,
}


@pytest.mark.parametrize(
    ("change", "argument"),
    [
        ({"youngs_modulus": 0.0}, "youngs_modulus"),
        ({"youngs_modulus": "soft"}, "youngs_modulus"),
        ({"poisson_ratio": 0.51}, "poisson_ratio"),
        ({"poisson_ratio": -1.0}, "poisson_ratio"),
        ({"thickness": 0.0}, "thickness"),
        ({"thickness": float("inf")}, "thickness"),
        ({"period": -1.0}, "period"),
        ({"work_of_adhesion": -0.1}, "work_of_adhesion"),
        ({"orders": [1, 1]}, "harmonics"),
        ({"orders": [0, 1]}, "harmonics"),
        ({"orders": [1, 2.5]}, "harmonics"),
        ({"phases": [0.0]}, "harmonics"),
        ({"amplitudes": [np.nan, 1.0]}, "harmonics"),
    ],
    ids=lambda case: str(case),
)
def test_bad_input_names_the_argument(change, argument):
    with pytest.raises(InvalidProblemError, match=f"^{argument}: ") as caught:
        Problem(**(GOOD | change))
    assert caught.value.argument == argument


def test_slope_is_the_derivative_of_the_height():
    problem, x, step = Problem(**GOOD), np.linspace(0, 1, 7), 1e-6
    difference = (problem.height(x + step) - problem.height(x - step)) / (2 * step)
    np.testing.assert_allclose(problem.slope(x), difference, atol=2e-8)  # measured 8e-9 (third derivative, rounding)


def test_crests_are_the_maxima_highest_first():
    problem = Problem(**GOOD)
    grid = np.linspace(0, 1, 20001)
    assert problem.highest == pytest.approx(problem.height(grid).max(), abs=1e-6)
    assert np.all(np.diff(problem.height(problem.crests)) < 0)
    assert np.all(problem.curvature(problem.crests) < 0)
    np.testing.assert_allclose(problem.slope(problem.crests), 0.0, atol=1e-11)  # measured 2e-13


def test_slope_term_uses_the_true_slope():
    problem = dataclasses.replace(Problem(**GOOD), slope_term=True)
    true_slope = -2 * np.pi / 0.01 * (5e-5 * np.sin(0.2) + 3e-5 * np.sin(1.0))
    expected = 0.03 * np.sqrt(1 + true_slope**2)
    assert problem.work_of_opening(0.0) * problem.unit_release_rate == pytest.approx(expected, rel=1e-14)


def test_a_flat_profile_has_no_crest():
    problem = Problem(**(GOOD | {"amplitudes": [0.0, 0.0]}))
    assert problem.crests.size == 0
    assert problem.highest == 0.0
    assert problem.unit_height == problem.period
