"""Waves short and steep enough to pin an edge."""

import numpy as np
import pytest

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.equilibrium import System, balance
from bem.adhesive.pinning import PINS, PinningWaves
from bem.elastic.collocation import Elastic
from bem.geometry.patches import TWO_PI, Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl


def intensity(order, phase):
    """K at the right edge of a wide patch on a single wave of height 1."""
    profile = Profile.from_harmonics(TWO_PI, [order], [1.0], [phase])
    system = System(Elastic(profile), UniformLaw(1.0), DisplacementControl())
    patches = Patches(np.array([1.0]), np.array([4.0]))
    return balance(system, patches, 0.0, 0.0, 1e-10).state.stress_intensity[1]


@pytest.mark.parametrize(("order", "off"), [(50, 1.5e-2), (200, 6e-3)])  # measured 6.2e-3, 2.2e-3
def test_what_a_wave_adds_to_the_stress_intensity(order, off):
    """h sqrt(2 q) at the end of a contact without other ends; the other one is 3 away."""
    swing = [intensity(order, k * np.pi / 2) for k in range(4)]
    amplitude = np.hypot(swing[0] - swing[2], swing[1] - swing[3]) / 2
    assert amplitude == pytest.approx(np.sqrt(2 * order), rel=off)


def strengths(orders, amplitudes):
    return PinningWaves.of(Profile.from_harmonics(TWO_PI, orders, amplitudes))


def test_the_shortest_wave_that_pins_is_the_last_one_strong_enough():
    """A wave alone pins from a work of adhesion on that is its strength, over PINS, in edge scales, squared."""
    waves = strengths([40, 1], [1e-3, 1.0])
    strength, scale = 1e-3 * 40 * np.sqrt(2 * 40), 0.1
    weakest = (strength * scale / PINS) ** 2
    work = weakest * np.array([0.999, 1.001])
    np.testing.assert_allclose(waves.shortest(work, np.full(2, scale)), [TWO_PI / 40, TWO_PI], rtol=1e-15)


def test_waves_act_together_and_too_weak_ones_pin_nothing():
    many = strengths(np.arange(40, 80), np.full(40, 1e-3))
    squares = 2e-6 * np.arange(40.0, 80) ** 3
    np.testing.assert_allclose(many.strength**2, np.cumsum(squares[::-1])[::-1], rtol=1e-14)
    assert np.all(np.isinf(many.shortest(np.full(4, 1e9), np.full(4, 0.1))))
