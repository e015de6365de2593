"""Real over projected area against its defining integrals and limits."""

import numpy as np
import pytest
from scipy.integrate import quad

from persson import gaussian_slope_1d, isotropic_2d

VARIANCES = (1e-6, 0.99e-4, 1.01e-4, 0.01, 0.0742, 1.0, 30.0)


@pytest.mark.parametrize("variance", VARIANCES)
def test_one_dimensional_factor_is_the_mean_length_of_a_gaussian_slope(variance):
    xi = np.sqrt(variance)
    mean, _ = quad(
        lambda t: np.sqrt(1 + variance * t**2) * np.exp(-(t**2) / 2), -12, 12, epsabs=0, epsrel=1e-13, points=[0.0]
    )
    assert gaussian_slope_1d(xi**2) == pytest.approx(mean / np.sqrt(2 * np.pi), rel=1e-13)  # measured 5e-15


@pytest.mark.parametrize("variance", VARIANCES)
def test_two_dimensional_factor_is_the_papers_integral(variance):
    mean, _ = quad(lambda x: np.sqrt(1 + variance * x) * np.exp(-x), 0, 60, epsabs=0, epsrel=1e-13, limit=200)
    assert isotropic_2d(variance) == pytest.approx(mean, rel=1e-13)  # measured 3e-15


@pytest.mark.parametrize("factor", [gaussian_slope_1d, isotropic_2d])
def test_a_smooth_surface_has_its_projected_area(factor):
    assert factor(0.0) == 1.0


@pytest.mark.parametrize("factor", [gaussian_slope_1d, isotropic_2d])
def test_small_slopes_add_half_their_variance(factor):
    assert (factor(1e-7) - 1) / 1e-7 == pytest.approx(0.5, rel=1e-6)


def test_very_steep_slopes_count_by_their_mean_modulus():
    assert gaussian_slope_1d(1e8) / 1e4 == pytest.approx(np.sqrt(2 / np.pi), rel=1e-6)


def test_the_factors_differ_where_slopes_are_not_small():
    # equal to first order; 2 % apart at a slope of one
    assert isotropic_2d(1.0) / gaussian_slope_1d(1.0) == pytest.approx(1.018, abs=1e-3)
