"""Folds of the branch and energy release rates by differences of energies, against Johnson's curve."""

import numpy as np
import pytest
from scipy.optimize import brentq

from fem_reference import InvalidProblemError, Resolution, solve
from fem_reference.energy_difference import energy_difference
from fem_reference.fold import fold

QUICK = Resolution(2, 10, 10)
PERIOD, AMPLITUDE, NU, ALPHA = 0.01, 50e-6, 0.3, 0.3
MODULUS = 1e6 / (1 - NU**2)
FULL = np.pi * MODULUS * AMPLITUDE / PERIOD  # pressure of complete contact without adhesion
WORK = (ALPHA * FULL) ** 2 * PERIOD / (2 * MODULUS)
WAVE = {
    "youngs_modulus": 1e6,
    "poisson_ratio": NU,
    "thickness": 2 * PERIOD,
    "period": PERIOD,
    "harmonics": ([1], [AMPLITUDE], [0.7]),
    "work_of_adhesion": WORK,
    "control": "penetration",
    "resolution": QUICK,
}


def load(psi):
    return FULL * (np.sin(psi) ** 2 - ALPHA * np.sqrt(np.tan(psi)))


@pytest.fixture(scope="module")
def state():
    return solve(**WAVE, value=-1.2e-5)


def test_the_fold_under_load_is_johnsons(state):
    found = fold(state, "mean_pressure")
    psi = brentq(lambda at: np.sin(2 * at) - ALPHA / (2 * np.sqrt(np.tan(at)) * np.cos(at) ** 2), 0.01, 1.0)
    errors = {"contact_fraction": 2 * psi / np.pi, "mean_pressure": load(psi)}
    for name, exact in errors.items():
        assert abs(found.values[name] - exact) <= found.uncertainty[name]
    assert abs(found.values["mean_pressure"] / load(psi) - 1) < 3e-5  # measured 1.2e-5


def test_a_state_beyond_its_fold_is_told(state):
    beyond = solve(**WAVE, value=-1.7e-5)
    with pytest.raises(InvalidProblemError, match=r"^state: lies beyond the fold of the mean_pressure"):
        fold(beyond, "mean_pressure")


def test_without_adhesion_there_is_no_fold():
    dry = solve(**WAVE | {"work_of_adhesion": 0.0}, value=1e-5)
    with pytest.raises(InvalidProblemError, match=r"^state: must be a converged closure with adhesion"):
        fold(dry, "penetration")


def test_release_rate_by_energies_is_the_work_of_adhesion(state):
    rate, uncertainty = energy_difference(state)
    assert rate.shape == (1, 2)
    assert np.all(np.abs(rate - WORK) <= uncertainty)
    assert np.all(uncertainty < 0.01 * WORK)  # measured 2e-3


def test_release_rate_by_energies_is_the_domain_integral_off_equilibrium():
    given = solve(**WAVE, value=1e-5, edges=[[-0.0021, 0.0009]])
    rate, uncertainty = energy_difference(given)
    assert np.all(np.abs(rate - given.energy_release_rate) <= uncertainty + given.uncertainty["energy_release_rate"])
    assert rate.max() > 2 * rate.min()  # far from equilibrium: the two edges differ
