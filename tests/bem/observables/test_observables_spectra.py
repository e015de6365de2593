"""Spectra against the Bessel series, adaptive quadrature, Parseval's sum and the limit of complete contact."""

import numpy as np
import pytest
from johnson_wave import pressure_of
from judges import SmoothKernel, dense_nodes, evaluate_dense
from scipy.integrate import quad
from scipy.special import jv

from bem.audit.displacement import DisplacementField, GapPoints
from bem.elastic.kernel_series import kernel_series
from bem.elastic.layer import LayerEffect
from bem.geometry.profile import Profile
from bem.observables.spectra import complete_contact_spectra, pressure_modes, spectra, spectral_orders

WAVE = Profile.from_harmonics(2 * np.pi, [1], [1.0])


@pytest.fixture(scope="module")
def rough():
    profile = Profile.self_affine(2 * np.pi, 0.7, 1.0, 40, 0).scaled()
    left, right = np.array([0.5, 1.9, 5.5]), np.array([1.2, 2.2, 6.6])
    return profile, evaluate_dense(profile, left, right, 1.3, dense_nodes(profile, left, right) + 10)


@pytest.mark.parametrize("order", [0, 1, 2, 17, 150, 999, 4000], ids=lambda m: f"m={m}")
def test_modes_are_the_bessel_series(rough, order):
    pressure = rough[1].pressure
    exact = 0.0
    for left, right, charge in zip(pressure.left, pressure.right, pressure.charges, strict=True):
        n = np.arange(charge.size)
        series = np.sum(charge * (-1j) ** n * jv(n, order * (right - left) / 2))
        exact += 0.5 * np.exp(-0.5j * order * (left + right)) * series
    scale = np.max(np.abs(pressure_modes(pressure, 10)))
    # measured 3e-14 at m = 4000, the rounding of m x
    assert abs(pressure_modes(pressure, 4000)[order] - exact) <= 1e-13 * scale


@pytest.mark.parametrize("order", [0, 1, 5, 40], ids=lambda m: f"m={m}")
def test_modes_are_the_integral_of_the_pressure(order):
    pressure, sigma = pressure_of(0.6)
    half = float(pressure.right[0])
    exact = quad(
        lambda a: sigma(half * np.sin(a)) * np.cos(order * half * np.sin(a)) * half * np.cos(a),
        -np.pi / 2,
        np.pi / 2,
        epsabs=1e-13,
        limit=200,
    )[0] / (2 * np.pi)
    assert pressure_modes(pressure, 40)[order].real == pytest.approx(exact, abs=1e-13)  # measured 2e-15


@pytest.mark.parametrize("layer", [None, kernel_series(LayerEffect(0.5, 0.5), 1e-16)], ids=["half-space", "layer"])
def test_displacement_has_the_mean_square_of_its_spectrum(rough, layer):
    """Parseval: 2 sum C_u = <u^2>; u is the profile in contact, and integrated from the pressure in gaps."""
    profile, state = rough
    if layer is not None:
        pressure = state.pressure
        nodes = np.array([charge.size for charge in pressure.charges])
        kernel = SmoothKernel(layer.smooth, layer.slope)
        state = evaluate_dense(profile, pressure.left, pressure.right, 1.3, nodes, kernel)
    pressure, ratio, highest = state.pressure, None if layer is None else layer.ratio, 20_000
    field = DisplacementField(pressure, ratio)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    theta = (nodes + 1) * np.pi / 2
    gaps = np.append(pressure.left[1:], pressure.left[0] + 2 * np.pi) - pressure.right
    square = 0.0
    for i, (left, right) in enumerate(zip(pressure.left, pressure.right, strict=True)):
        inside = profile.height((left + right) / 2 + (right - left) / 2 * nodes) - profile.max_height + 1.3
        square += (right - left) / 2 * np.sum(weights * inside**2)
        points = GapPoints(np.full(200, i), gaps[i] * np.sin(theta / 2) ** 2, gaps[i] * np.cos(theta / 2) ** 2)
        square += gaps[i] * np.pi / 4 * np.sum(weights * np.sin(theta) * field.in_gaps(points) ** 2)
    found = 2 * np.sum(spectra(profile, pressure, highest, ratio).displacement)
    # beyond the highest order the edges alone: |sigma_m|^2 = sum K^2 / (8 pi^2 m)
    found += np.sum(state.stress_intensity**2) / (8 * np.pi**2 * highest**2)
    assert found == pytest.approx(square / (2 * np.pi), rel=1e-10)


@pytest.mark.parametrize("fraction", [0.02, 0.5, 0.9, 0.99, 0.9999], ids=lambda f: f"fraction={f}")
def test_spectrum_tends_to_that_of_complete_contact(fraction):
    """Westergaard's first mode: C_u(1) = (1 - cos^4(psi))^2 C_h(1), psi = pi/2 contact fraction."""
    found = spectra(WAVE, pressure_of(fraction)[0], 8)
    left_open = np.cos(np.pi * fraction / 2) ** 2
    assert found.displacement[0] / found.profile[0] == pytest.approx((1 - left_open**2) ** 2, rel=1e-12)


@pytest.mark.parametrize("layer", [None, LayerEffect(0.2, 0.5)], ids=["half-space", "layer"])
def test_complete_contact_has_the_spectrum_of_the_profile(layer):
    profile = Profile.self_affine(2 * np.pi, 0.8, 1.0, 30, 1).scaled()
    found = complete_contact_spectra(profile, None, None if layer is None else layer.ratio)
    m = np.arange(1, 31)
    ratio = np.ones(30) if layer is None else layer.ratio(m)
    np.testing.assert_array_equal(found.displacement, found.profile)
    np.testing.assert_allclose(found.pressure[:30], (m / ratio) ** 2 * profile.amplitudes**2 / 4, rtol=1e-14)


def test_orders_reach_twice_those_of_the_profile():
    assert spectral_orders(Profile.from_harmonics(1.0, [1, 300], [1.0, 0.1])) == 600
    assert spectral_orders(WAVE) == 128
