"""The kernel between two arcs as a sum of products: the logarithm to the accuracy asked for, by few terms."""

import numpy as np
import pytest

from bem.elastic.separated_kernel import RANGE_STEP, modes_and_core, range_steps

ARCS = {
    "half the period each, meeting at both ends": ((0.0, np.pi), 1e-4),
    "neighbours far from the rest": ((1.0, 1.2), 1e-3),
    "ends that nearly touch": ((0.5, 4.0), 1e-8),
    "one short, one long": ((0.1, 0.11), 1e-5),
}


def parted(bounds, clearance):
    """200 points on either side of beta, down to the clearance from it and from delta, with what parts them."""
    delta, beta = bounds[0], (bounds[0] + bounds[1]) / 2
    inward = np.geomspace(clearance, 0.99, 100)
    inward = np.concatenate([inward, 1 - np.geomspace(clearance, 0.5, 100)])
    left = beta - (beta - delta) * inward * (1 - clearance)
    reach = delta + 2 * np.pi - beta if bounds[1] - bounds[0] > 3 else bounds[1] - beta
    return left, beta + reach * inward * (1 - clearance), beta, delta


def rounding(here, there, beta, delta):
    """Positions of order 1 know their distance to what parts the arcs to 4e-16 over it; 1e-13 where they are far."""
    unknown = [4e-16 / np.minimum(np.abs(x - beta), np.abs(np.sin((x - delta) / 2))) for x in (here, there)]
    return 1e-13 + np.add.outer(*unknown)


def kernel_between(here, there, beta, delta, accuracy):
    """Sum of products between points of two arcs, and the core, by numpy.polynomial."""
    x = np.concatenate([here, there])
    from_beta, from_delta = (np.log(np.abs(np.sin((x - end) / 2))) for end in (beta, delta))
    u, constant = from_beta - from_delta, np.log(2) - np.log(np.abs(np.sin((delta - beta) / 2)))
    steps = range_steps((u.max() - u.min()) / 2)
    modes, _, core = modes_and_core(steps, accuracy)
    t = (u - (u.min() + u.max()) / 2) / RANGE_STEP**steps
    phi = np.polynomial.chebyshev.chebvander(t, modes.shape[0] - 1) @ modes
    columns = np.concatenate([[(from_beta + from_delta + constant) / 2, np.ones(x.size)], phi.T]).T
    return columns[: here.size] @ core @ columns[here.size :].T, core


@pytest.mark.parametrize("accuracy", [1e-4, 1e-8, 1e-12, 1e-14])
@pytest.mark.parametrize(("bounds", "clearance"), ARCS.values(), ids=ARCS)
def test_it_is_the_logarithm_of_the_chord(bounds, clearance, accuracy):
    here, there, beta, delta = parted(bounds, clearance)
    found, _ = kernel_between(here, there, beta, delta, accuracy)
    expected = np.log(np.abs(2 * np.sin(np.subtract.outer(here, there) / 2)))
    assert np.all(
        np.abs(found - expected) <= 6 * accuracy + 4 * rounding(here, there, beta, delta)
    )  # measured 2.9, 1.3


@pytest.mark.parametrize(("accuracy", "most"), [(1e-8, 50), (1e-14, 90)])
def test_few_terms_are_enough_for_clearances_of_a_millionth(accuracy, most):
    here, there, beta, delta = parted((0.0, np.pi), 1e-6)
    _, core = kernel_between(here, there, beta, delta, accuracy)
    assert core.shape[0] <= most
    np.testing.assert_array_equal(core, core.T)
    np.testing.assert_allclose(core @ core, np.eye(core.shape[0]), atol=1e-15)
