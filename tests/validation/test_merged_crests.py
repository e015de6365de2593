"""The closed form of one patch: with one harmonic that of Johnson, and full contact carries what flattens all."""

import numpy as np
import pytest

from validation.cases.exact.merged_crests import (
    AMPLITUDE,
    PERIOD,
    POISSON_RATIO,
    YOUNGS_MODULUS,
    one_patch_mean_pressure,
)
from validation.references.closed_forms import Sinusoid


@pytest.mark.parametrize("alpha", [0.0, 0.1, 0.5])
@pytest.mark.parametrize("fraction", [0.1, 0.5, 0.9])
def test_one_harmonic_is_johnsons_sinusoid(alpha, fraction):
    wave = Sinusoid(AMPLITUDE, PERIOD, YOUNGS_MODULUS, POISSON_RATIO, alpha)
    expected = float(wave.mean_pressure(fraction * np.pi / 2))
    mean = one_patch_mean_pressure(fraction * np.pi, [AMPLITUDE], wave.work_of_adhesion)
    assert mean == pytest.approx(expected, abs=6e-16 * wave.full_contact_pressure)  # measured 2.2e-16


def test_full_contact_carries_what_flattens_every_harmonic():
    """At a = pi without adhesion the pressure is zero in the deepest place: the mean is the sum of (-1)^(m+1) P_m."""
    harmonics = [1e-4, -2e-5]
    modulus = YOUNGS_MODULUS / (1 - POISSON_RATIO**2)
    amplitudes = [np.pi * modulus / PERIOD * m * h for m, h in enumerate(harmonics, start=1)]
    mean = one_patch_mean_pressure(np.pi - 1e-5, harmonics, 0.0)
    assert mean == pytest.approx(amplitudes[0] - amplitudes[1], rel=1.1e-10)  # measured 4.3e-11
