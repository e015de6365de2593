"""The closed form of one patch: with one harmonic that of Johnson, and full contact carries what flattens all."""

import numpy as np
import pytest

from validation.references.closed_forms import Sinusoid
from validation.references.one_patch import OnePatch

AMPLITUDE, PERIOD, MODULUS = 1e-4, 0.01, 1e6 / (1 - 0.5**2)


@pytest.mark.parametrize("alpha", [0.0, 0.1, 0.5])
@pytest.mark.parametrize("fraction", [0.1, 0.5, 0.9])
def test_one_harmonic_is_johnsons_sinusoid(alpha, fraction):
    wave = Sinusoid(AMPLITUDE, PERIOD, 1e6, 0.5, alpha)
    patch, angle, psi = (
        OnePatch(PERIOD, MODULUS, (AMPLITUDE,), wave.work_of_adhesion),
        fraction * np.pi,
        fraction * np.pi / 2,
    )
    expected = float(wave.mean_pressure(psi))
    assert float(patch.mean_pressure(angle)) == pytest.approx(expected, abs=6e-16 * wave.full_contact_pressure)
    assert float(patch.penetration(angle)) == pytest.approx(float(wave.penetration(psi)), rel=1e-12)
    energy = wave.elastic_energy(psi) - wave.work_of_adhesion * fraction
    assert float(patch.energy(angle)) == pytest.approx(energy, rel=1e-12)


def test_full_contact_carries_what_flattens_every_harmonic():
    """At a = pi without adhesion the pressure is zero in the deepest place: the mean is the sum of (-1)^(m+1) P_m."""
    harmonics = (1e-4, -2e-5)
    amplitudes = [np.pi * MODULUS / PERIOD * m * h for m, h in enumerate(harmonics, start=1)]
    mean = float(OnePatch(PERIOD, MODULUS, harmonics, 0.0).mean_pressure(np.pi - 1e-5))
    assert mean == pytest.approx(amplitudes[0] - amplitudes[1], rel=1.1e-10)  # measured 4.3e-11
