"""The paper's double Gaussian as a fit: it finds its own parameters, says how badly it fits, and refuses bad input."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erf

from persson import double_gaussian, fit_double_gaussian

STRESS = np.linspace(-0.5, 6.0, 200)


@pytest.mark.parametrize(("detachment", "diffusivity"), [(0.0, 0.4), (0.8, 0.6), (2.5, 3.0)])
def test_fit_finds_the_parameters_of_a_double_gaussian(detachment, diffusivity):
    fit = fit_double_gaussian(STRESS, double_gaussian(STRESS, 1.0, detachment, diffusivity), 1.0)
    assert fit.detachment_stress == pytest.approx(detachment, abs=1e-6)
    assert fit.diffusivity == pytest.approx(diffusivity, rel=1e-6)
    assert fit.residual < 1e-7


def test_without_adhesion_the_theory_is_a_double_gaussian():
    value, _ = quad(lambda p: float(double_gaussian(p, 1.0, 0.0, 0.5)), 0, 30)
    assert value == pytest.approx(erf(1 / (2 * np.sqrt(0.5))), rel=1e-12)


def test_it_vanishes_at_half_its_detachment_stress():
    assert double_gaussian(-0.4, 1.0, 0.8, 0.6) == 0.0
    assert 0 < double_gaussian(-0.4 + 1e-6, 1.0, 0.8, 0.6) < 1e-5


def test_it_is_no_solution_with_a_barrier_at_its_detachment_stress():
    # the image of sigma_0 in a barrier at -sigma_a sits at -sigma_0 - 2 sigma_a
    spread = 4 * 0.6
    image = np.exp(-((-0.8 + 1.0 + 2 * 0.8) ** 2) / spread)
    direct = np.exp(-((-0.8 - 1.0) ** 2) / spread)
    assert direct == pytest.approx(image, rel=1e-12)
    printed = np.exp(-((-0.8 + 1.0 + 0.8) ** 2) / spread)
    assert printed > 2 * direct


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
    assert fit.residual == pytest.approx(0.0303, abs=5e-4)
    assert fit.detachment_stress / adhesive("paper", 0.1).detachment_stress == pytest.approx(1.26, abs=0.01)


def test_no_parameters_near_by_fit_better(fitted):
    fit, stress, density = fitted
    for detachment, diffusivity in ((1.05, 1.0), (0.95, 1.0), (1.0, 1.02), (1.0, 0.98)):
        other = double_gaussian(
            stress, fit.mean_pressure, detachment * fit.detachment_stress, diffusivity * fit.diffusivity
        )
        assert np.mean((other - density) ** 2) > np.mean((fit(stress) - density) ** 2)


def test_half_the_detached_width_brings_the_theory_nearer_to_the_fit(adhesive, fitted):
    # the fit of the whole width asks for more than its sigma_a; sqrt 2 as much is nearer
    whole, half = (adhesive("paper", 0.1, detached_width=width).detachment_stress for width in (1.0, 0.5))
    assert abs(half - fitted[0].detachment_stress) < 0.65 * abs(whole - fitted[0].detachment_stress)  # measured 0.60


@pytest.mark.parametrize(
    ("stress", "density", "mean", "message"),
    [
        ([0.0, 1.0], [1.0, 1.0], 1.0, "pressure, density: shapes"),
        ([0.0, 1.0, 2.0], [1.0, 1.0], 1.0, "pressure, density: shapes"),
        ([0.0, 1.0, 2.0], [1.0, np.nan, 1.0], 1.0, "density: finite values"),
        ([0.0, 1.0, 2.0], [0.0, 0.0, 0.0], 1.0, "density: finite values"),
        ([0.0, 1.0, 2.0], [1.0, 1.0, 1.0], 0.0, r"mean_pressure: 0.0 must be finite and > 0"),
    ],
    ids=["few", "lengths", "nan", "zero", "load"],
)
def test_bad_input_is_refused(stress, density, mean, message):
    with pytest.raises(ValueError, match=message):
        fit_double_gaussian(stress, density, mean)
