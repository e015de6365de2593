"""The smallest contacts: right to what positions are known to, stated errors that hold, and a refusal by name."""

import numpy as np
import pytest
import scene_tables

from bem.scene.scene import parse_scene
from bem.solver import solve

PERIOD, AMPLITUDE, MODULUS = 0.01, 1e-5, 1e6 / 0.75
FULL = np.pi * MODULUS * AMPLITUDE / PERIOD  # Pa, mean pressure of complete contact
SHARES = np.array([1e-24, 1e-20, 1.2e-19, 1.6e-18, 1.4e-16, 1e-15, 3e-15, 1e-14, 3e-14, 1e-13, 1e-12, 1e-10, 1e-9])


def waves(phase, shares):
    """States of one wave at shares of the mean pressure of complete contact."""
    targets = (FULL * np.asarray(shares)).tolist()
    return solve(
        parse_scene(scene_tables.tables(scene_tables.waves([1], [AMPLITUDE], [phase]), "mean_pressure", targets))
    )


@pytest.mark.parametrize("phase", [-1.0, -0.3, -0.18, 0.0, 1.0, 2.5])
def test_the_smallest_contacts_are_right_to_the_rounding_of_their_place(phase):
    """Westergaard (1939): sin^2(pi A / 2 A_0) = p / p*; the profile varies by less than its rounding below 1e-16."""
    states = waves(phase, SHARES).targets
    found = np.array([state.contact_fraction for state in states])
    stated = np.array([state.error_estimate.contact_fraction for state in states])
    error = np.abs(found - 2 / np.pi * np.arcsin(np.sqrt(SHARES)))
    assert np.all(error <= 3e-16)  # an ulp or two of an edge over the period; measured 1.4e-16
    assert np.all(error <= stated)  # measured at least 100 times it


@pytest.mark.parametrize("phase", np.linspace(-3, 3, 13))
def test_contacts_narrower_than_their_place_is_known_to_say_so(phase):
    """By their stated error or, where an edge falls onto the other one, by a refusal; the next target is met."""
    smallest, small = waves(phase, [1e-35, 0.1]).targets
    refused = "narrower than double precision" in " ".join(smallest.certificate.reasons)
    assert refused or smallest.contact_fraction <= smallest.error_estimate.contact_fraction  # measured up to a quarter
    assert small.contact_fraction == pytest.approx(2 / np.pi * np.arcsin(np.sqrt(0.1)), rel=1e-9)
