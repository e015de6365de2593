"""Chebyshev tools: exactness on polynomials, the logarithm's moments, and the two rules for sizes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from bem.geometry import chebyshev


def modes(n, t):
    return np.cos(n * np.arccos(t))


@pytest.mark.parametrize("size", [4, 9, 32])
def test_nodes_integrate_chebyshev_polynomials_exactly(size):
    # int T_n / sqrt(1 - t^2) dt = pi for n = 0, else 0, exact below twice the number of nodes
    table = chebyshev.basis(size)
    sums = [np.sum(modes(n, table.nodes)) * np.pi / size for n in range(2 * size)]
    np.testing.assert_allclose(sums, np.pi * np.eye(2 * size)[0], atol=1e-13)


@pytest.mark.parametrize("order", [0, 1, 2, 7])
@pytest.mark.parametrize("size", [8, 11])
def test_logarithmic_moments(size, order):
    """Against the integral itself, with t' = cos(theta)."""
    table = chebyshev.basis(size)
    charges = np.pi / size * modes(order, table.nodes)
    found = table.log_moments @ charges
    node = 2
    angle = np.arccos(table.nodes[node])

    def integrand(theta):
        return np.log(abs(table.nodes[node] - np.cos(theta))) * np.cos(order * theta)

    parts = [quad(integrand, *ends, epsabs=1e-11, limit=200)[0] for ends in ((0, angle), (angle, np.pi))]
    assert found[node] == pytest.approx(sum(parts), abs=1e-9)  # quadrature of the logarithm: 2e-11


@given(series=st.lists(st.floats(-1, 1), min_size=4, max_size=24))
def test_coefficients_invert_the_series(series):
    series = np.array(series)
    samples = np.polynomial.chebyshev.chebval(chebyshev.basis_nodes(series.size), series)
    np.testing.assert_allclose(chebyshev.coefficients(samples), series, atol=1e-14)


@given(series=st.lists(st.floats(-1, 1), min_size=4, max_size=24))
def test_edge_values_and_slopes_are_those_of_the_series(series):
    series = np.array(series)
    size, order = series.size, np.arange(series.size)
    table = chebyshev.basis(size)
    charges = np.pi / size * np.polynomial.chebyshev.chebval(table.nodes, series)
    ends = np.polynomial.chebyshev.chebval(np.array([-1.0, 1.0]), series)
    np.testing.assert_allclose(table.at_edges @ charges, ends, atol=1e-13)
    slopes = [np.sum((-1.0) ** order * order**2 * series), np.sum(order**2 * series)]
    np.testing.assert_allclose(table.slopes_at_edges @ charges, slopes, atol=1e-13 * size**2)


@pytest.mark.parametrize("size", [16, 200], ids=["matrix", "fast"])
def test_rows_are_transformed_one_by_one(size):
    samples = np.random.default_rng(0).normal(size=(3, size))
    expected = np.stack([chebyshev.coefficients(row) for row in samples])
    # measured 2e-16: a product sums in another order for one row than for three
    np.testing.assert_allclose(chebyshev.coefficients(samples), expected, rtol=0, atol=1e-15)


@pytest.mark.parametrize("max_order", [1, 10, 100, 1000])
@pytest.mark.parametrize("width", [1e-3, 0.1, 1.0, 6.0])
def test_nodes_resolve_the_highest_harmonic(width, max_order):
    """The last coefficients of cos(m x + phase) on the patch must be negligible."""
    size = int(np.ceil(chebyshev.profile_nodes(np.array([width]), max_order)[0]))
    wave = np.cos(max_order * width / 2 * chebyshev.basis_nodes(size) + 0.7)
    # measured 3.5e-9 at worst over all kappa (at 25), 1e-12 below kappa = 2; the highest harmonic is a weak one
    size = np.abs(chebyshev.coefficients(wave))
    assert size[-3:].max() <= 8e-9 * size.max()


@pytest.mark.parametrize("tolerance", [1e-3, 1e-8, 1e-14])
@pytest.mark.parametrize("clearance", [1e-3, 0.1, 3.0])
def test_modes_resolve_the_field_of_a_neighbour(clearance, tolerance):
    """log(t0 - t) at a source beyond the edge has coefficients -(2/n) rho^-n; those dropped are below tolerance."""
    number = chebyshev.coupling_modes(np.array([2.0]), np.array([clearance]), tolerance)[0]
    source = 1 + clearance
    rho = source + np.sqrt(source**2 - 1)
    assert 2 / number * rho**-number <= tolerance
    assert rho ** -(number - 3) >= tolerance  # and not many more than needed


@given(number=st.floats(1, 1e5), ratio=st.sampled_from([1.15, 1.4]))
def test_sizes_are_rounded_up_and_not_far(number, ratio):
    size = int(chebyshev.rounded_up(np.array([number]), ratio)[0])
    assert number <= size <= max(8, number + 2, np.ceil(ratio * number))
