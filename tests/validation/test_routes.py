"""Pressure of complete contact, as the challenge asks for it."""

import numpy as np
import pytest

from validation.routes.boundary_elements import solve


def test_pressure_of_complete_contact_with_a_thin_layer_follows_the_profile():
    """A compressible layer much thinner than the wave is a bed of springs, E (1-nu) / ((1+nu) (1-2nu)) / d each.

    What the layer carries over is of the order (q d)^2 = 4e-5; measured 2.8e-6.
    """
    points, layer = [0.0, 2e-4, 5e-4], 1e-6
    wave = {
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.3},
        "profile": {"period": 1e-3, "orders": [1], "amplitudes": [1e-6], "phases": [0.0]},
        "layer": {"thickness": layer},
        "path": {"control": "mean_pressure", "targets": [3e6]},
        "asked": {"contact_fraction": {}, "pressure_at": {"target": 1, "points": points}},
    }
    answers = solve(wave, 1e-6)
    assert answers["contact_fraction"] == [1.0]
    springs = 1e6 * 0.7 / (1.3 * 0.4) / layer
    expected = 3e6 + springs * 1e-6 * np.cos(2 * np.pi * np.array(points) / 1e-3)
    assert answers["pressure_at"] == pytest.approx(expected, abs=8e-6 * springs * 1e-6)
