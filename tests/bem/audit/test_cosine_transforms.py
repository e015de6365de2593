"""Cosine transforms: the same as those of SciPy, for every number of points."""

import numpy as np
import pytest
from scipy import fft

from bem.audit.cosine_transforms import dct_1, dct_2, dct_3


@pytest.mark.parametrize(("kind", "transform"), [(1, dct_1), (2, dct_2), (3, dct_3)])
@pytest.mark.parametrize("size", [2, 3, 4, 5, 8, 31, 96, 1001])
@pytest.mark.parametrize("rows", [(), (3,), (2, 3)], ids=str)
def test_transforms_are_those_of_scipy(kind, transform, size, rows):
    x = np.random.default_rng(size).normal(size=(*rows, size))
    expected = fft.dct(x, type=kind, axis=-1)
    np.testing.assert_allclose(transform(x), expected, rtol=0, atol=2e-15 * np.abs(expected).max())  # 6.4e-16


@pytest.mark.parametrize(("transform", "value"), [(dct_2, 6.0), (dct_3, 3.0)])
def test_one_point(transform, value):
    assert transform(np.array([3.0])) == value
