"""The closed form of a rippled wave: passages of its mean pressure."""

import numpy as np
import pytest

from validation.references.rippled_wave import MOST, WAVE

LOADING, UNLOADING = (0.0, 1e3, 3e3, 6e3, 1e4, 1.4e4), (1.2e4, 1e4, 6e3, 3e3, 0.0, -1e3, -1.6e3)  # Pa


def pressure(angle):
    return float(WAVE.patch.mean_pressure(angle))


@pytest.fixture(scope="module")
def top():
    return WAVE.loaded(LOADING[-1])[1][0]


def test_mean_pressure_is_level_where_it_turns():
    """Maxima and minima alternate, two a ripple."""
    turning = sorted([*WAVE.turning[1.0], *WAVE.turning[-1.0]])
    slope = [(pressure(a + 1e-6) - pressure(a - 1e-6)) / 2e-6 for a in turning]
    assert np.abs(slope).max() <= 1e-6 * pressure(np.pi * MOST)  # measured 3e-7
    assert set(WAVE.turning[1.0]) == set(turning[::2])


@pytest.mark.parametrize("load", LOADING)
def test_contact_spreads_to_the_first_passage(load):
    (a,) = WAVE.loaded(load)[1]
    assert pressure(a) == pytest.approx(load, abs=1e-8)
    assert max(pressure(b) for b in np.linspace(1e-3, a - 1e-6, 500)) < load + 1e-8


@pytest.mark.parametrize("load", UNLOADING)
def test_contact_recedes_to_the_last_passage(top, load):
    (a,) = WAVE.unloaded(top, load)[1]
    assert pressure(a) == pytest.approx(load, abs=1e-8)
    assert min(pressure(b) for b in np.linspace(a + 1e-6, top, 500)) > load


def test_loads_out_of_reach_are_refused(top):
    with pytest.raises(ValueError, match=r"jumps at 23212\.3 Pa does not come to rest"):
        WAVE.loaded(1e6)
    with pytest.raises(ValueError, match=r"jumps at -1669\.54 Pa does not come to rest"):
        WAVE.unloaded(top, -1e6)


def test_jumps_happen_in_order_within_the_loads(top):
    up = [jump.pressure for jump in WAVE.loaded(LOADING[-1])[0][1:]]
    down = [jump.pressure for jump in WAVE.unloaded(top, UNLOADING[-1])[0]]
    assert up == sorted(up)
    assert down == sorted(down, reverse=True)
    assert (len(up), len(down)) == (5, 5)
    assert LOADING[0] < up[0] and up[-1] < LOADING[-1]
