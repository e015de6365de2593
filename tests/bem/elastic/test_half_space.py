"""The kernel of the half-space between nodes and within patches, against its definition."""

import numpy as np
import pytest

from bem.elastic import half_space
from bem.geometry.chebyshev import basis


def test_kernel_between_nodes_is_the_logarithm_of_the_chord():
    x = np.sort(np.random.default_rng(0).uniform(0, 2 * np.pi, 50))
    distance = np.subtract.outer(x, x) + np.eye(50)
    expected = np.where(np.eye(50) == 1, 0.0, np.log(np.abs(2 * np.sin(distance / 2))))
    # measured 5e-14, rounding of x over the least distance
    np.testing.assert_allclose(half_space.between_nodes(x), expected, rtol=0, atol=2e-13)


@pytest.mark.parametrize("size", [6, 40, 120], ids=["few nodes", "nodes", "more than are tabled"])
@pytest.mark.parametrize("half_width", [1e-4, 0.05, 0.4, 0.41, 3.0])
def test_kernel_within_a_patch_is_its_moments_and_the_smooth_rest(half_width, size):
    table = basis(size)
    half = half_width * np.subtract.outer(table.nodes, table.nodes) / 2 + 1e-300
    expected = np.log(half_width) + table.log_moments + np.log(np.sin(half) / half)
    found = half_space.within_patch(np.array([half_width]), table)
    assert found.shape == (1, size, size)
    np.testing.assert_allclose(found[0], expected, rtol=0, atol=1e-14)  # measured 4e-15


def test_patches_of_one_basis_do_not_see_one_another():
    widths = np.array([0.3, 0.01, 0.6])
    together = half_space.within_patch(widths, basis(10))
    alone = np.concatenate([half_space.within_patch(np.array([w]), basis(10)) for w in widths])
    np.testing.assert_allclose(together, alone, rtol=0, atol=1e-14)  # measured 2e-15
