"""The one refiner of minima: positions, values and curvatures against closed forms."""

import numpy as np
import pytest

from bem.geometry.minima import OFFSETS, TO_ROUNDING, refined


def lopsided(x):
    """(x - 0.3)^2 + (x - 0.3)^3 / 2 + 0.1 sin 9 x, whose vertex a first parabola misses."""
    return (x - 0.3) ** 2 + (x - 0.3) ** 3 / 2 + 0.1 * np.sin(9 * x)


def test_several_minima_at_once_each_to_its_own_accuracy():
    """cos(m x) at pi / m, from points a tenth of a wave apart that lean to one side."""
    m = np.array([1.0, 3.0, 40.0, 1000.0])
    minima = refined(lambda x: np.cos(m * x), (np.pi + 0.2 * np.pi * (OFFSETS + 0.37)) / m)
    np.testing.assert_allclose(m * minima.position, np.pi, rtol=0, atol=2e-6)  # measured 6e-7
    np.testing.assert_allclose(minima.value, -1.0, rtol=0, atol=2e-12)  # half the square of that
    np.testing.assert_allclose(minima.curvature / m**2, 1.0, rtol=1e-5)


def test_more_parabolas_reach_rounding():
    x = np.array([[-0.3], [-0.1], [0.1]])
    minima = refined(lopsided, x, refinements=TO_ROUNDING)
    fine = np.linspace(-0.3, 0.1, 400_001)
    assert minima.value[0] <= lopsided(fine).min() + 1e-16
    assert abs(minima.position[0] - fine[np.argmin(lopsided(fine))]) < 1e-6
    rough = refined(lopsided, x, refinements=1)
    assert rough.value[0] > minima.value[0] + 1e-9


def test_a_minimum_at_its_outer_point_stays_between_the_points():
    """x^2 on [1, 3]: the lowest point allowed is 1, and nothing is evaluated beyond."""

    def square(x):
        assert np.all((x >= 1.0) & (x <= 3.0))
        return x**2

    assert refined(square, np.array([[1.0], [2.0], [3.0]])).position[0] == pytest.approx(1.0, abs=0.01)


def test_no_minima_are_none():
    assert refined(np.cos, np.empty((3, 0))).value.size == 0
