"""The closed form of a rippled wave: passages of its mean pressure; a path must not leap to branches above."""

import numpy as np
import pytest

import bem
from validation.cases.exact.rippled_wave import (
    LOADING,
    MOST,
    UNLOADING,
    jumps,
    mean_pressure,
    receding,
    spreading,
    turning_points,
)
from validation.references import adapters


@pytest.fixture(scope="module")
def turning():
    return turning_points()


def test_mean_pressure_is_level_where_it_turns(turning):
    """Maxima and minima alternate, two a ripple."""
    slope = [(mean_pressure(f + 1e-6) - mean_pressure(f - 1e-6)) / 2e-6 for f in turning]
    assert np.abs(slope).max() <= 4e-6 * mean_pressure(MOST)  # measured 1.6e-6
    assert turning.size == 14


@pytest.mark.parametrize("load", LOADING)
def test_contact_spreads_to_the_first_passage(turning, load):
    fraction = spreading(turning, load)
    assert mean_pressure(fraction) == pytest.approx(load, abs=1e-8)
    assert max(mean_pressure(f) for f in np.linspace(turning[0], fraction - 1e-6, 500)) < load


@pytest.mark.parametrize("load", UNLOADING)
def test_contact_recedes_to_the_last_passage(turning, load):
    start = spreading(turning, LOADING[-1])
    fraction = receding(turning, load, start)
    assert mean_pressure(fraction) == pytest.approx(load, abs=1e-8)
    assert min(mean_pressure(f) for f in np.linspace(fraction + 1e-6, start, 500)) > load


def test_loads_out_of_reach_are_refused(turning):
    with pytest.raises(ValueError, match="mean pressure: 1e\\+06 Pa is not reached"):
        spreading(turning, 1e6)
    with pytest.raises(ValueError, match="mean pressure: -1e\\+06 Pa lies below"):
        receding(turning, -1e6, 0.4)


def test_jumps_happen_in_order_within_the_loads(turning):
    up, down = jumps(turning)
    assert up == sorted(up)
    assert down == sorted(down, reverse=True)
    assert (len(up), len(down)) == (5, 5)
    assert LOADING[0] < up[0] and up[-1] < LOADING[-1]


def test_large_increments_do_not_leap_to_a_branch_of_higher_potential(turning):
    """Newton once went from one ripple over the next to the one behind it: more energy than the load put in."""
    load = 6e3
    changes = {"loading": {"targets": [0.0, 1e3, 3e3, load]}}
    reached = bem.solve(adapters.scene("rippled_wave", changes)).targets[-1].contact_fraction
    assert reached == pytest.approx(spreading(turning, load), abs=1e-12)  # measured 4e-15; 0.05 too much with the leap
