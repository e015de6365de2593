"""The paper's double Gaussian as a fit: it finds its own parameters, says how badly it fits, and refuses bad input."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erf

from persson import DoubleGaussian, double_gaussian, fit_double_gaussian

STRESS = np.linspace(-0.5, 6.0, 200)


@pytest.mark.parametrize("logarithmic", [False, True])
@pytest.mark.parametrize(("detachment", "diffusivity"), [(0.0, 0.4), (0.4, 0.6), (0.3, 3.0)])
def test_fit_finds_the_parameters_of_a_double_gaussian(detachment, diffusivity, logarithmic):
    density = double_gaussian(STRESS, 1.0, detachment, diffusivity)
    fit = fit_double_gaussian(STRESS, density, 1.0, logarithmic=logarithmic)
    assert fit.detachment_stress == pytest.approx(detachment, abs=1e-6)
    assert fit.diffusivity == pytest.approx(diffusivity, rel=1e-6)
    assert fit.residual < 1e-7


def test_without_adhesion_the_theory_is_a_double_gaussian():
    value, _ = quad(lambda p: float(double_gaussian(p, 1.0, 0.0, 0.5)), 0, 30)
    assert value == pytest.approx(erf(1 / (2 * np.sqrt(0.5))), rel=1e-12)


def test_it_ends_at_its_detachment_stress():
    assert double_gaussian(-0.8, 1.0, 0.8, 0.6) == 0.0
    assert 0 < double_gaussian(-0.8 + 1e-6, 1.0, 0.8, 0.6) < 1e-5


def test_it_solves_the_diffusion_equation_above_a_barrier():
    # G grows with the variance V of the stress: P(V) = double_gaussian(G = V / 2 sigma_0^2), dP/dV = d2P/dsigma2 / 2
    sigma, step = np.linspace(-0.7, 3.0, 75), 1e-3
    value = lambda stress, variance: double_gaussian(stress, 1.0, 0.8, variance / 2)  # noqa: E731
    rise = (value(sigma, 1.2 + step) - value(sigma, 1.2 - step)) / (2 * step)
    bend = (value(sigma + step, 1.2) - 2 * value(sigma, 1.2) + value(sigma - step, 1.2)) / step**2
    np.testing.assert_allclose(rise, bend / 2, atol=1e-6)  # measured 2e-7


def test_its_load_is_what_the_barrier_leaves():
    fit = DoubleGaussian(1.0, 0.8, 0.6, 0.0)
    area, load = (quad(lambda p, k=k: p**k * float(fit(p)), -0.8, 30)[0] for k in (0, 1))
    assert load == pytest.approx(1.0 - 0.8 * area, rel=1e-9)
    assert fit.load == pytest.approx(load, rel=1e-9)


def test_scaling_the_stresses_scales_the_fit(adhesive, modulus):
    state = adhesive("paper", 0.1)
    stress = np.linspace(-0.05, 0.6, 300)
    density = state.pressure_distribution(stress * modulus)
    in_pascals = fit_double_gaussian(stress * modulus, density, 0.1 * modulus)
    scaled = fit_double_gaussian(stress, density * modulus, 0.1)
    assert in_pascals.detachment_stress == pytest.approx(scaled.detachment_stress * modulus, rel=1e-6)
    assert in_pascals.diffusivity == pytest.approx(scaled.diffusivity, rel=1e-6)


@pytest.fixture
def fitted(adhesive, modulus):
    """Fit of the theory at 0.1 E*, from its barrier to five standard deviations, and the points it was made from."""
    state = adhesive("paper", 0.1)
    stress = np.linspace(-state.detachment_stress, (0.1 + 2.5 * state.spectrum.slope_rms) * modulus, 600)
    density = state.pressure_distribution(stress)
    return fit_double_gaussian(stress, density, 0.1 * modulus), stress, density


def test_fit_to_the_theory_states_its_residual_and_another_detachment_stress(adhesive, fitted):
    fit, stress, density = fitted
    assert fit.residual == pytest.approx(np.sqrt(np.mean((fit(stress) - density) ** 2)) / np.max(density), rel=1e-9)
    assert fit.residual == pytest.approx(0.0559, abs=5e-4)
    assert fit.detachment_stress / adhesive("paper", 0.1).detachment_stress == pytest.approx(0.33, abs=0.01)


def test_no_parameters_near_by_fit_better(fitted):
    fit, stress, density = fitted
    for detachment, diffusivity in ((1.05, 1.0), (0.95, 1.0), (1.0, 1.02), (1.0, 0.98)):
        other = double_gaussian(
            stress, fit.mean_pressure, detachment * fit.detachment_stress, diffusivity * fit.diffusivity
        )
        assert np.mean((other - density) ** 2) > np.mean((fit(stress) - density) ** 2)


@pytest.mark.parametrize(
    ("stress", "density", "mean", "message"),
    [
        ([0.0, 1.0, 2.0], [1.0, 1.0, 1.0], 1.0, "pressure, density: shapes"),
        ([0.0, 1.0, 2.0, 3.0], [1.0, 1.0], 1.0, "pressure, density: shapes"),
        ([0.0, 1.0, 2.0, 3.0], [1.0, np.nan, 1.0, 1.0], 1.0, "density: finite values"),
        ([0.0, 1.0, 2.0, 3.0], [0.0, 0.0, 0.0, 0.0], 1.0, "density: finite values"),
        ([0.0, 1.0, 2.0, 3.0], [1.0, 1.0, 1.0, 1.0], 0.0, r"mean_pressure: 0.0 must be finite and > 0"),
    ],
    ids=["few", "lengths", "nan", "zero", "load"],
)
def test_bad_input_is_refused(stress, density, mean, message):
    with pytest.raises(ValueError, match=message):
        fit_double_gaussian(stress, density, mean)
