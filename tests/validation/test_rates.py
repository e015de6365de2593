"""Fits of rates: manufactured errors give back their rate, on the right axis, and what cannot be fitted is reported."""

import numpy as np
import pytest

from validation.studies.own_scene.rates import RateError, geometric


@pytest.mark.parametrize("rate", [1.6, 2.5, 10.0], ids=str)
def test_geometric_rate_is_a_factor_per_unit_of_size(rate):
    sizes = np.arange(4, 41, 4)
    errors = np.maximum(5e-3 * rate ** -(sizes - 4.0), 1e-14)
    found = geometric(sizes.tolist(), errors.tolist())
    assert found.value == pytest.approx(rate, rel=1e-12)
    assert found.plateau == errors.min()


def test_geometric_fit_ends_at_the_plateau_and_begins_where_errors_fall():
    errors = [1.0, 0.5, 1e-3, 1e-5, 1e-7, 1e-9, 2e-15, 1e-18, 5e-14]  # 1e-18 by chance
    found = geometric(list(range(1, 10)), errors)
    assert (found.used, found.value) == ((2, 3, 4, 5), pytest.approx(100.0, rel=1e-12))


def test_power_law_is_not_taken_for_geometric():
    sizes = [2.0**k for k in range(2, 9)]
    rates = geometric(sizes, [1e-3 * n**-4.0 for n in sizes]).pairwise
    assert rates[0] > 1.5 * rates[-2]


@pytest.mark.parametrize(
    ("sizes", "errors"),
    [
        ([1.0, 2.0], [0.1, 0.01]),
        ([1.0, 2.0, 2.0], [0.1, 0.01, 0.001]),
        ([1.0, 2.0, 3.0], [0.1, float("nan"), 0.001]),
        ([1.0, 2.0, 3.0], [0.1, 0.0, 0.001]),
    ],
    ids=["two-points", "sizes-repeat", "nan", "zero"],
)
def test_what_cannot_be_fitted_is_told(sizes, errors):
    with pytest.raises(RateError):
        geometric(sizes, errors)


def test_too_few_points_before_the_plateau_are_told():
    with pytest.raises(RateError, match="only 1"):
        geometric([1.0, 2.0, 3.0, 4.0], [0.5, 1e-3, 1e-15, 1e-15])
