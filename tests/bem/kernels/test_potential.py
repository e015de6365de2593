"""The logarithm of the kernels is that of the C library."""

import math

import numpy as np

from bem.kernels.potential import pair_by_pair


def logarithms(sizes):
    return pair_by_pair(np.stack([sizes, np.zeros(sizes.size)]), np.array([[1.0], [0.0]]), np.ones(1))


def test_logarithm():
    random = np.random.default_rng(6)
    x = np.concatenate([random.uniform(0.5, 2, 20_000), 10 ** random.uniform(-300, 300, 20_000)])
    expected = np.array([math.log(size) for size in x])
    assert np.abs(logarithms(x) / expected - 1).max() < 6e-16  # measured: 2.3e-16


def test_logarithm_of_nothing_and_of_what_is_no_number():
    logarithm = logarithms(np.array([0.0, np.nan, np.inf, 1.0, -1e300, 5e-324]))
    assert logarithm[0] == logarithm[5] == -np.inf  # numbers below the smallest normal one are as good as zero
    assert np.isnan(logarithm[1])
    assert logarithm[2] == np.inf
    np.testing.assert_allclose(logarithm[3:5], [0.0, math.log(1e300)], rtol=2e-16)
