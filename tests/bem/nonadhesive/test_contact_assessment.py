"""Stated errors of the smallest contacts, where rounding of the heights is what the edges are known to."""

import numpy as np
import pytest

from bem.scene.scene import parse_scene
from bem.solver import solve

PERIOD, AMPLITUDE, MODULUS = 0.01, 1e-5, 1e6 / 0.75
FULL = np.pi * MODULUS * AMPLITUDE / PERIOD  # Pa, mean pressure of complete contact
SHARES = np.array([1e-16, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9])  # of it


@pytest.mark.parametrize("phase", [0.0, 1.0, 2.5])
def test_the_smallest_contacts_are_in_error_by_what_is_stated(phase):
    """Westergaard (1939): sin^2(pi A / 2 A_0) = p / p*; at 1e-16 the contact is eight times too long, and says so."""
    scene = {
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
        "profile": {
            "kind": "harmonics",
            "period": PERIOD,
            "orders": [1],
            "amplitudes": [AMPLITUDE],
            "phases": [phase],
        },
        "loading": {"control": "mean_pressure", "targets": (FULL * SHARES).tolist()},
    }
    states = solve(parse_scene(scene)).targets
    found = np.array([state.contact_fraction for state in states])
    stated = np.array([state.error_estimate.contact_fraction for state in states])
    error = np.abs(found - 2 / np.pi * np.arcsin(np.sqrt(SHARES)))
    assert np.all(error <= stated)  # measured: 1.9 to 3.9 times it
    assert np.all(stated <= 12 * np.maximum(error, 1e-16 / SHARES * found))
