"""Both routes of the diffusion against barriers with an exact answer, and against one another where there is none."""

import numpy as np
import pytest
from scipy.special import erf, erfc, ndtr

from persson.diffusion import march
from persson.mathematics.volterra import survival

ROUTES = ("finite_volumes", "volterra")


def nodes(count, first=2e-3, last=1.0):
    return np.concatenate([[0.0], np.geomspace(first, last, count)])


def areas(route, load, variance, barrier, n_cells=800):
    """A/A0 at the nodes under a barrier given as a function of V."""
    at_nodes = barrier(variance)
    if route == "finite_volumes":
        return march(np.array([load]), variance, at_nodes[None, :], n_cells).area[0]
    return survival(load, variance, at_nodes, barrier((variance[1:] + variance[:-1]) / 2))


def survival_under_a_line(distance, speed, variance):
    """P(no crossing of -(distance + speed V) until V) for a Brownian path from zero: Bachelier and Levy."""
    root = np.sqrt(variance)
    above = ndtr((distance + speed * variance) / root)
    return above - np.exp(-2 * distance * speed) * ndtr((speed * variance - distance) / root)


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("height", [0.0, 0.3])
def test_a_barrier_at_rest_gives_an_error_function(route, height):
    variance = nodes(500)
    result = areas(route, 0.5, variance, lambda v: np.full_like(v, height))
    exact = np.concatenate([[1.0], erf((0.5 + height) / np.sqrt(2 * variance[1:]))])
    np.testing.assert_allclose(result, exact, atol=1e-5)  # measured 4e-6; zero where the image is exact


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("speed", [0.5, 2.0])
def test_a_barrier_of_constant_speed_gives_the_closed_form(route, speed):
    variance = nodes(800)
    result = areas(route, 0.5, variance, lambda v: 0.05 + speed * v)
    exact = survival_under_a_line(0.55, speed, variance[1:])
    np.testing.assert_allclose(result[1:], exact, atol=1.5e-5)  # measured 6e-6


@pytest.mark.parametrize("route", ROUTES)
def test_error_falls_with_the_steps(route):
    def error(factor):
        variance = nodes(100 * factor)
        result = areas(route, 0.5, variance, lambda v: 0.05 + 2.0 * v, 100 * factor)
        return abs(result[-1] - survival_under_a_line(0.55, 2.0, 1.0))

    assert np.log2(error(1) / error(2)) > 1.4  # measured 2.0 and 1.7


def test_the_routes_agree_on_a_barrier_that_leaves_zero_like_a_square_root():
    onset = 0.2
    steps = onset * np.geomspace(1e-5, 0.5, 120)
    variance = np.union1d(nodes(600), np.concatenate([onset - steps, [onset], onset + steps]))

    def barrier(v):
        return 0.4 * np.sqrt(np.maximum(v - onset, 0.0))

    one, other = (areas(route, 0.3, variance, barrier)[-1] for route in ROUTES)
    assert one == pytest.approx(other, abs=1e-5)  # measured 3e-6


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("standard_deviations", [4.0, 5.0, 6.0])
def test_no_mass_is_lost_near_complete_contact(route, standard_deviations):
    # 1 - A is 6e-5, 6e-7 and 2e-9; a domain that ends 4 standard deviations out loses 3e-5
    load = standard_deviations - 0.2
    result = areas(route, load, nodes(400, 0.1), lambda v: np.full_like(v, 0.2))
    assert 1 - result[-1] == pytest.approx(erfc(standard_deviations / np.sqrt(2)), rel=0.015)  # measured 6e-3 and 1e-9


@pytest.mark.parametrize("route", ROUTES)
def test_a_barrier_that_runs_away_takes_nothing_with_it(route):
    variance = nodes(600)
    result = areas(route, 0.3, variance, lambda v: np.where(v > 0.25, 40.0 * np.sqrt(np.maximum(v - 0.25, 0)), 0.0))
    reached = np.searchsorted(variance, 0.26)
    assert np.all(np.diff(result[:reached]) <= 2e-8)  # measured 8e-9 in the step of the jump
    assert result[-1] == pytest.approx(result[reached], abs=1e-6)


def test_a_march_that_begins_too_late_is_refused():
    with pytest.raises(ValueError, match=r"variance\[1\]: 1\.0 must be <="):
        march(np.array([1.0]), np.array([0.0, 1.0, 2.0]), np.full((1, 3), 0.5), 50)


def test_loads_of_a_batch_do_not_see_one_another():
    variance = nodes(200, 1e-3)
    barrier = np.sqrt(0.1 * variance)
    together = march(np.array([0.3, 0.5, 2.0]), variance, np.tile(barrier, (3, 1)), 200).area
    alone = np.stack([march(np.array([p]), variance, barrier[None, :], 200).area[0] for p in (0.3, 0.5, 2.0)])
    np.testing.assert_allclose(together, alone, rtol=1e-12)
