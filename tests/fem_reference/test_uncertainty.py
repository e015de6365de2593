"""Rule of Eca and Hoekstra on sequences whose error is known: exact powers, slow and fast ones, scatter, two meshes."""

import numpy as np
import pytest

from fem_reference.uncertainty import uncertainty

SIZES = [1 / 4, 1 / 6, 1 / 8]
FOUR = [1 / 4, 1 / 5, 1 / 6, 1 / 8]


@pytest.mark.parametrize("order", [0.5, 2.0, 3.7, 4.0])
@pytest.mark.parametrize("sizes", [SIZES, FOUR], ids=["three", "four"])
def test_a_power_in_range_has_the_small_factor(order, sizes):
    values = 1 + np.array(sizes) ** order
    total = uncertainty(values, sizes, 4)
    assert total == pytest.approx(1.25 * sizes[-1] ** order, rel=0.05)


@pytest.mark.parametrize(("order", "sizes"), [(9, SIZES), (0.1, FOUR)])
def test_an_order_out_of_its_range_is_not_believed(order, sizes):
    values = 1 + np.array(sizes) ** order
    assert uncertainty(values, sizes, 4) > 3 * min(sizes[-1] ** order, abs(values[-1] - values[-2]))


def test_scatter_counts_as_its_standard_deviation():
    power = 1 + np.array(FOUR) ** 2
    scattered = 1.0 + np.array([2e-3, -2e-3, 2e-3, -2e-3])
    assert uncertainty(scattered, FOUR, 4) > 4e-3
    assert uncertainty(1e-6 * scattered, FOUR, 4) == pytest.approx(1e-6 * uncertainty(scattered, FOUR, 4))
    assert uncertainty(power + 1e-6 * scattered, FOUR, 4) == pytest.approx(uncertainty(power, FOUR, 4), rel=0.05)


def test_two_meshes_have_three_times_their_difference():
    assert uncertainty([1.0, 1.5], SIZES[:2], 4) == pytest.approx(1.5)


def test_equal_values_leave_rounding():
    assert uncertainty([2.0, 2.0, 2.0], SIZES, 4) == pytest.approx(2e-11)


def test_values_of_an_array_are_judged_one_by_one():
    columns = np.array([[1 + h**2, 1 + h**9, 1.0] for h in FOUR]).reshape(4, 3, 1)
    together = uncertainty(columns, FOUR, 4)
    alone = [uncertainty(columns[:, k, 0], FOUR, 4) for k in range(3)]
    np.testing.assert_allclose(together[:, 0], alone, rtol=1e-9)
