"""The compliance of a layer against 60-digit arithmetic, its kernel against the series, the solver on layers."""

from decimal import Decimal, localcontext

import numpy as np
import pytest
from judges import SmoothKernel, dense_nodes, evaluate_dense

from bem.elastic.collocation import Elastic, evaluate
from bem.elastic.compliance import Compliance
from bem.elastic.kernel_series import _BLOCK, kernel_series
from bem.elastic.layer import Layer, LayerEffect, compliance_deficit, compliance_ratio
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.geometry.scaling import Solid

POISSON = [-0.9, 0.0, 0.3, 0.499999, 0.5]
by_poisson = pytest.mark.parametrize("nu", POISSON, ids=lambda nu: f"nu={nu}")
Q_D = np.array([1e-12, 1e-8, 1e-4, 0.01, 0.1257, 0.5, 0.9999999, 1.0, 1.0000001, 3.0, 10.0, 17.0, 40.0, 300.0])
THIN = 2 * np.pi * 0.02


def exact_ratio(q_d, nu):
    """Ratio and 1 - ratio from the textbook formula in 60 digits."""
    with localcontext() as context:
        context.prec = 700  # exp(600) and its neighbours in one number
        y, v = 2 * Decimal(float(q_d)), Decimal(nu)
        sinh, cosh, k = (y.exp() - (-y).exp()) / 2, (y.exp() + (-y).exp()) / 2, 3 - 4 * v
        ratio = (k * sinh - y) / (k * cosh + y * y / 2 + 5 - 12 * v + 8 * v * v)
        return float(ratio), float(1 - ratio)


@by_poisson
def test_ratio_keeps_its_digits(nu):
    exact = [exact_ratio(q_d, nu)[0] for q_d in Q_D]
    # measured 3.4e-16
    np.testing.assert_allclose(compliance_ratio(Q_D, nu), exact, rtol=1e-15)


@by_poisson
def test_deficit_keeps_its_digits(nu):
    exact = [exact_ratio(q_d, nu)[1] for q_d in Q_D]
    # measured 4.5e-16
    np.testing.assert_allclose(compliance_deficit(Q_D, nu), exact, rtol=1.3e-15)


@by_poisson
def test_very_thick_layers_do_not_overflow(nu):
    np.testing.assert_array_equal(compliance_ratio(np.array([1e3, 1e6, 1e200]), nu), 1.0)


@by_poisson
def test_long_waves_have_the_mean_compliance(nu):
    solid, layer = Solid(2e6, nu), Layer(3e-3)
    # c(q) - c(0) is of order (q d)^2, and (q d)^2 / 1e-12 of it at nu = 1/2 where c(0) = 0
    assert layer.compliance(solid, 1e-4) == pytest.approx(layer.mean_compliance(solid), rel=1e-9, abs=1e-20)


def test_thin_incompressible_layers_follow_the_cube():
    assert compliance_ratio(1e-5, 0.5) == pytest.approx(2 / 3 * 1e-15, rel=1e-9)


def test_total_displacement_and_penetration_are_inverse():
    solid, layer = Solid(1e6, 0.3), Layer(1e-3)
    assert layer.penetration(solid, layer.total_displacement(solid, 2e-5, 4e4), 4e4) == pytest.approx(2e-5, rel=1e-14)


@pytest.mark.parametrize("thickness", [0.0, -1.0, np.inf, np.nan], ids=str)
def test_impossible_thickness_is_refused(thickness):
    with pytest.raises(ValueError, match=r"layer.thickness = .*; allowed: a finite number > 0"):
        Layer(thickness)


@pytest.mark.parametrize("tolerance", [0.0, 1.0, -1e-3], ids=str)
def test_impossible_tolerance_is_refused(tolerance):
    with pytest.raises(ValueError, match="between 0 and 1"):
        kernel_series(LayerEffect(0.5, 0.3), tolerance)


@by_poisson
@pytest.mark.parametrize("q_d", [THIN, 0.7, 3.0], ids=lambda d: f"q0d={d:.3g}")
def test_kernel_and_logarithm_make_up_the_compliance(nu, q_d):
    """-(1/pi) int [log|2 sin| + S] cos(m x') dx' must be ratio_m / m cos(m x): coefficients of S by FFT."""
    kernel = kernel_series(LayerEffect(q_d, nu), 1e-16)
    points = 4 * kernel.terms
    m = np.arange(1, kernel.terms + 1)
    coefficients = 2 * np.fft.rfft(kernel.smooth(np.arange(points) * (2 * np.pi / points))).real[m] / points
    # measured 4e-16 of 1 + S(0)
    np.testing.assert_allclose(1 / m - coefficients, kernel.ratio(m) / m, rtol=0, atol=1e-15 * (1 + kernel.smooth(0.0)))


def test_truncation_bounds_what_is_left_out():
    fine, coarse = kernel_series(LayerEffect(THIN, 0.5), 1e-17), kernel_series(LayerEffect(THIN, 0.5), 1e-6)
    left_out = float(fine.smooth(0.0) - coarse.smooth(0.0))
    assert coarse.terms < fine.terms
    assert left_out == pytest.approx(coarse.truncation, rel=1e-6)
    assert coarse.truncation <= 1e-6


@pytest.mark.parametrize("order", [1, 2], ids=["slope", "curvature"])
def test_derivatives_are_those_of_the_kernel(order):
    kernel, step = kernel_series(LayerEffect(0.4, 0.3), 1e-16), 1e-3
    x = np.linspace(-3, 3, 41)
    function = kernel.smooth if order == 1 else kernel.slope
    difference = 8 * (function(x + step) - function(x - step)) - (function(x + 2 * step) - function(x - 2 * step))
    exact = kernel.slope(x) if order == 1 else kernel.curvature(x)
    # measured 2.4e-11 and 5.3e-11 of the largest
    np.testing.assert_allclose(difference / (12 * step), exact, rtol=0, atol=1.5e-10 * np.max(np.abs(exact)))


def test_kernel_is_the_sum_of_its_waves():
    kernel = kernel_series(LayerEffect(THIN, 0.5), 1e-14)
    x = np.random.default_rng(1).uniform(-7, 7, 30)
    direct = kernel.weights @ np.cos(
        np.multiply.outer(kernel.orders, np.subtract.outer(x, x)).reshape(kernel.terms, -1)
    )
    # measured 5e-15
    np.testing.assert_allclose(kernel.smooth(np.subtract.outer(x, x)), direct.reshape(30, 30), rtol=0, atol=1.5e-14)


def test_kernel_at_many_places_in_blocks_is_the_kernel_at_few():
    kernel = kernel_series(LayerEffect(THIN, 0.5), 1e-14)
    x = np.random.default_rng(1).uniform(-7, 7, (150, 150))
    assert 150 * kernel.terms < _BLOCK < x.size * kernel.terms
    np.testing.assert_allclose(kernel.smooth(x), [kernel.smooth(row) for row in x], rtol=0, atol=1.5e-14)


def test_field_is_the_kernel_times_charges():
    kernel = kernel_series(LayerEffect(THIN, 0.3), 1e-14)
    rng = np.random.default_rng(2)
    x, charges = rng.uniform(0, 6, 40), rng.normal(size=40)
    # measured 1.1e-14
    matrix = kernel.smooth(np.subtract.outer(x, x))
    np.testing.assert_allclose(kernel.field(x, x, charges), matrix @ charges, rtol=0, atol=3e-14)


def test_deficit_is_largest_for_the_longest_wave():
    orders = np.arange(1, 2000)
    assert all(np.all(np.diff(compliance_deficit(orders * 0.01, nu)) < 0) for nu in POISSON)


@pytest.fixture(scope="module")
def rough():
    profile = Profile.self_affine(2 * np.pi, 0.7, 1.0, 40, 0).scaled()
    return profile, Patches(np.array([0.5, 1.9, 4.0]), np.array([1.2, 2.2, 5.5]))


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8], ids=lambda t: f"tolerance={t:g}")
@pytest.mark.parametrize("q_d", [THIN, 0.6], ids=lambda d: f"q0d={d:.3g}")
@pytest.mark.parametrize("nu", [0.3, 0.5], ids=lambda nu: f"nu={nu}")
def test_compressed_evaluation_on_a_layer_is_the_dense_one(rough, nu, q_d, tolerance):
    profile, patches = rough
    kernel = kernel_series(LayerEffect(q_d, nu), 1e-16)
    state = evaluate(Elastic(profile, Compliance(kernel)), patches, 1.0, tolerance)
    nodes = np.maximum(
        dense_nodes(profile, patches.left, patches.right), kernel.modes_of_kernel(patches.width, 1e-14).astype(np.int64)
    )
    smooth = SmoothKernel(kernel.smooth, kernel.slope)
    dense = evaluate_dense(profile, patches.left, patches.right, 1.0, nodes, smooth)
    error = np.max(np.abs(state.stress_intensity - dense.stress_intensity)) / np.max(np.abs(dense.stress_intensity))
    # measured at most 0.02 tolerance
    assert error <= 0.05 * tolerance


@pytest.mark.parametrize("nu", [0.3, 0.5], ids=lambda nu: f"nu={nu}")
def test_thin_layer_converges_to_closed_form_near_complete_contact(nu):
    """A vanishing gap at the trough of cos x opens where the mean pressure falls below sigma_1 = 1/ratio."""
    profile = Profile.from_harmonics(2 * np.pi, [1], [1.0])
    kernel = kernel_series(LayerEffect(THIN, nu), 1e-16)
    half = np.pi * (1 - 1e-4)
    patches = Patches(np.array([-half]), np.array([half]))
    whole = evaluate(Elastic(profile, Compliance(kernel)), patches, 0.0, 1e-13)
    # K = 0 fixes the penetration; the load is then that of sigma_0 = sigma_1 but for -0.0042 (gap / thickness)^2
    penetration = -whole.stress_intensity[0] / whole.stress_intensity_rate[0]
    load = whole.load + penetration * whole.load_rate
    gap_over_thickness = 1e-4 * np.pi / THIN
    assert load / (2 * np.pi) == pytest.approx(1 / float(kernel.ratio(1)), rel=0.012 * gap_over_thickness**2)


def test_thin_incompressible_layer_is_resolved_to_ten_digits():
    profile = Profile.from_harmonics(2 * np.pi, [1], [1.0])
    patches = Patches(np.array([-1.2]), np.array([1.2]))
    kernel = kernel_series(LayerEffect(THIN, 0.5), 1e-17)
    elastic = Elastic(profile, Compliance(kernel))
    state, finer = (evaluate(elastic, patches, 0.6, tolerance) for tolerance in (1e-12, 1e-15))
    # measured 2e-14 in load, 8e-13 in K
    assert state.load == pytest.approx(finer.load, rel=6e-14)
    np.testing.assert_allclose(state.stress_intensity, finer.stress_intensity, rtol=2.5e-12)
