"""The logarithmic potential of charges on the circle: closed form, definition, and both ways of summing."""

import numpy as np
import pytest

from bem.elastic.logarithmic_potential import LogarithmicPotential

FEW, MANY = (30, 60), (1500, 2000)  # charges and points: pair by pair, and by 96 boxes
AMOUNTS = [pytest.param(*FEW, id="pair by pair"), pytest.param(*MANY, id="by boxes")]
BOXES = [*AMOUNTS, pytest.param(400, 600, id="by 27 boxes"), pytest.param(3000, 3000, id="by 166 boxes")]


def random_charges(count, part=1.0, seed=0):
    """Charges of both signs and of total amount one, all over the circle or in a part of it."""
    rng = np.random.default_rng(seed)
    charge = rng.standard_normal(count)
    return LogarithmicPotential(part * rng.uniform(0, 2 * np.pi, count), charge / np.abs(charge).sum())


def check(found, potential, x):
    """Whether potentials are sums of logarithms of chords, to what rounding of the positions leaves of each."""
    chord = np.abs(2 * np.sin(np.subtract.outer(x, potential.position) / 2))
    rounding = (1 / chord) @ np.abs(potential.charge)
    error = np.abs(found - np.log(chord) @ potential.charge)
    assert np.max(error / rounding) <= 1e-15  # measured 5e-16


def turns_of_points(count):
    return np.random.default_rng(1).uniform(-2 * np.pi, 4 * np.pi, count)


@pytest.mark.parametrize(("charges", "points"), AMOUNTS)
def test_evenly_spread_equal_charges_add_up_to_one_logarithm(charges, points):
    """The product of 2 sin((x - 2 pi j/n)/2) over j is 2 sin(n x/2)."""
    position = 2 * np.pi / charges * np.arange(charges)
    x = (np.arange(points) + 0.3) * 2 * np.pi / points
    x = x[np.abs(np.sin(charges * x / 2)) > 1e-2]
    found = LogarithmicPotential(position, np.full(charges, 1 / charges))(x)
    expected = np.log(np.abs(2 * np.sin(charges * x / 2))) / charges
    # measured 1.2e-15 of few, 9.9e-15 of many: rounding of charges x/2
    np.testing.assert_allclose(found, expected, rtol=0, atol=3e-14)


@pytest.mark.parametrize("part", [1.0, 0.02], ids=["all over the circle", "in a part of it"])
@pytest.mark.parametrize(("charges", "points"), BOXES)
def test_potential_is_the_sum_of_logarithms_of_chords(charges, points, part):
    potential, x = random_charges(charges, part), turns_of_points(points)
    check(potential(x), potential, x)


@pytest.mark.parametrize(("charges", "points"), AMOUNTS)
def test_charges_and_points_may_lie_on_any_turn(charges, points):
    potential, x = random_charges(charges), turns_of_points(points)
    turn = 2 * np.pi * np.random.default_rng(2).integers(-2, 3, charges)
    turned = LogarithmicPotential(potential.position + turn, potential.charge)
    np.testing.assert_allclose(
        turned(x), potential(x), rtol=0, atol=1e-12
    )  # measured 3.3e-13: rounding of x over the least distance


@pytest.mark.parametrize("at", [0.0, np.pi / 16, 2 * np.pi - 1e-12], ids=["at the origin", "edge of a box", "end"])
def test_one_charge_is_seen_round_the_whole_circle(at):
    """Every box but three by polynomials, with the charge at the edge of its own."""
    x = (np.arange(250_000) + 0.5) * 2 * np.pi / 250_000
    x = np.delete(x, np.flatnonzero(np.abs(np.sin((x - at) / 2)) < 1e-2))
    found = LogarithmicPotential(np.array([at]), np.ones(1))(x)
    np.testing.assert_allclose(found, np.log(np.abs(2 * np.sin((x - at) / 2))), rtol=0, atol=2e-13)
