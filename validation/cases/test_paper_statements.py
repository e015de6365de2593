"""Statements of the paper that need no contact solved: its theory, and the heights of its profiles.

`linecontact replicate` judges all statements on the ensemble; these stand on the first screen of the standard level.
Profiles: the eleven of the ensemble, 1000 harmonics, H = 0.7 (validation/paper/members.py).  Moments of heights under
random phases are derived in validation/paper/profiles.py.
"""

from dataclasses import asdict

import numpy as np
import pytest

from bem.geometry.profile import Profile
from persson import DiscreteSpectrum
from validation.paper import load_curves, profiles, spectra
from validation.paper.ensemble import estimate, theory_with_adhesion
from validation.paper.members import PAPER, SPECTRA_AT
from validation.plugin.rows import Code, Quantity
from validation.references.paper_problem import HURST, PERIOD, RMS_HEIGHT

PHASES = 400


def drawn(seeds, harmonics=PAPER.harmonics):
    """Return profiles of the paper's spectrum."""
    return [Profile.self_affine(PERIOD, HURST, RMS_HEIGHT, harmonics, seed) for seed in range(seeds)]


@pytest.mark.standard
def test_statements_without_contacts(rows):
    """Which statements on theory and heights of profiles hold, and are the heights as their spectrum says?"""
    ensemble = drawn(PAPER.seeds)
    lines = DiscreteSpectrum.of_profile(ensemble[0])
    wet = {load: theory_with_adhesion(lines, load) for load in SPECTRA_AT}
    measured = (load_curves.of_theory(lines) | spectra.of_theory(wet, ensemble[0].q0) | profiles.of_heights(ensemble))
    rows.statements |= {name: asdict(number) for name, number in measured.items()}
    many = drawn(PHASES, 100)
    heights = np.array([profile.grid[1] / RMS_HEIGHT for profile in many])
    third, fourth = profiles.expected_moments(many[0].amplitudes)
    expected = rows.between(Code.BEM, Code.EXACT, f"{PHASES} profiles of 100 harmonics", quantity=Quantity.POINTS)
    for name, power, exact in (("square of the skewness", 3, third**2), ("fourth moment", 4, fourth)):
        moments = np.mean(heights**power, axis=1)
        mean, error = estimate(moments**2 if power == 3 else moments)
        expected.compare(f"{name} of heights, mean over phases", mean, exact, uncertainty=(2 * error, 0.0))
