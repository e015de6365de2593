"""Waves on a patch against sums and samples of their own, and wide patches of thin layers against all modes."""

import numpy as np
import pytest
from scipy.special import jv

from bem.elastic.collocation import Elastic, Resolution, evaluate, resolve
from bem.elastic.compliance import Compliance
from bem.elastic.kernel_series import kernel_series
from bem.elastic.layer import LayerEffect
from bem.elastic.second_sensitivities import EdgeFields
from bem.elastic.sensitivities import stress_intensity_jacobian
from bem.elastic.wave_modes import bessel, patch_waves
from bem.geometry.chebyshev import basis, coefficients
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile

WAVE = Profile.from_harmonics(2 * np.pi, [3], [1.0])
ORDERS = np.arange(1.0, 60.0)


@pytest.mark.parametrize("count", [1, 2, 7, 40])
def test_bessel_functions_of_small_and_large_arguments(count):
    z = np.array([1e-12, 1e-6, 0.01, 1.0, 6.9, 7.0, 30.0, 39.9, 40.0, 500.0])
    # measured 4e-15
    np.testing.assert_allclose(bessel(count, z), jv(np.arange(count)[:, None], z), rtol=0, atol=1e-14)


@pytest.mark.parametrize("modes", [4, 9, 30])
def test_projections_are_the_first_terms_of_the_waves(modes):
    """Against a series from many samples."""
    half_width, order = 0.8, np.arange(modes)
    waves, t = patch_waves(half_width, ORDERS, modes), basis(200).nodes
    projected = waves.at_nodes()
    for found, wave in ((projected.real, np.cos), (projected.imag, np.sin)):
        series = coefficients(wave(half_width * np.multiply.outer(ORDERS, t)))[:, :modes]
        expected = series @ np.cos(np.multiply.outer(order, np.arccos(basis(modes).nodes)))
        # measured 1e-14
        np.testing.assert_allclose(found, expected, rtol=0, atol=3e-14)


@pytest.mark.parametrize("modes", [4, 9, 30])
def test_what_waves_feel_of_the_uncoupled_modes_of_an_edge(modes):
    """Against the sum of Q_n int cos(m x) T_n / sqrt(1 - t^2) dt, Q_n = 2 n / pi^2."""
    half_width, order = 0.8, np.arange(modes, 120)
    waves, z = patch_waves(half_width, ORDERS, modes), half_width * ORDERS
    terms = 2 * order / np.pi * jv(order, z[:, None])
    for odd, found in enumerate(waves.of_edge):
        expected = (terms * np.where(order % 2 == odd, (-1.0) ** (order // 2), 0.0)).sum(axis=1)
        # measured 1e-14, of terms up to 3
        np.testing.assert_allclose(found, expected, rtol=0, atol=3e-14)


@pytest.fixture(scope="module", params=[0.0, 0.5], ids="nu={}".format)
def wide(request):
    """Of a patch 150 times as wide as a layer is thick: its modes, more, all of the kernel."""
    layer = Compliance(kernel_series(LayerEffect(0.04, request.param), 1e-16))
    elastic, patches = Elastic(WAVE, layer, slopes=True), Patches(np.array([-3.0]), np.array([3.0]))
    few, more = (evaluate(elastic, patches, 1.0, tolerance) for tolerance in (1e-10, 1e-13))
    nodes = resolve(elastic, patches, 1e-10).nodes
    modes = elastic.kernel.modes_of_kernel(patches.width, 1e-10).astype(np.int64)
    return few, more, evaluate(elastic, patches, 1.0, 1e-10, Resolution(np.maximum(nodes, modes + 8), modes))


def derivatives(state):
    jacobian = stress_intensity_jacobian(state)
    return jacobian, *EdgeFields(state, jacobian).c


def off(one, other):
    """The largest difference of each derivative, beside the largest entry."""
    pairs = zip(derivatives(one), derivatives(other), strict=True)
    return [np.abs(here - there).max() / np.abs(there).max() for here, there in pairs]


def test_a_wide_patch_on_a_thin_layer_needs_the_modes_of_its_pressure_only(wide):
    few, _, many = wide
    assert 5 * few.unknowns < many.unknowns  # 187 and 1075
    assert few.load == pytest.approx(many.load, rel=1.5e-11)  # measured up to 5e-12, by rounding
    # measured up to 5e-10, by rounding
    np.testing.assert_allclose(few.stress_intensity, many.stress_intensity, rtol=0, atol=1.5e-9)
    jacobian, *slopes = off(few, many)
    # measured 1e-7 and 5e-6, of all modes: their sums cancel as the square and the fourth power of their number
    assert jacobian <= 3e-7 and max(slopes) <= 1.5e-5


def test_derivatives_on_a_wide_patch_are_those_with_more_modes(wide):
    """Without what the waves feel of uncoupled modes they are off by their own size."""
    few, more, _ = wide
    jacobian, *slopes = off(few, more)
    assert jacobian <= 8e-9 and max(slopes) <= 1.5e-7  # measured 3e-9 and 5e-8
