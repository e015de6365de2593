"""The paper's profile and material, and its states at the loads that several tests look at."""

import numpy as np
import pytest

from persson import ContinuousSpectrum, DiscreteSpectrum, solve

FIRST_WAVENUMBER = 2 * np.pi / 0.01


@pytest.fixture(scope="session")
def solid():
    return {"youngs_modulus": 1e6, "poisson_ratio": 0.5}


@pytest.fixture(scope="session")
def modulus():
    return 1e6 / 0.75


@pytest.fixture(scope="session")
def spectra():
    """The paper's lines, the fewer and rougher ones, and a power spectrum."""
    return {
        "paper": DiscreteSpectrum.self_affine(FIRST_WAVENUMBER, 0.7, 50e-6, 1000),
        "hurst 0.5": DiscreteSpectrum.self_affine(FIRST_WAVENUMBER, 0.5, 50e-6, 300),
        "continuous": ContinuousSpectrum.self_affine(FIRST_WAVENUMBER, 1000 * FIRST_WAVENUMBER, 0.7, 50e-6),
    }


@pytest.fixture(scope="session")
def adhesive(spectra, solid, modulus):
    """Solve with gamma = 0.03 J/m^2 at a load in units of E*, without the ladder of loads; states are kept."""
    kept = {}

    def state(name, load, **options):
        key = (name, load, *sorted(options.items()))
        if key not in kept:
            kept[key] = solve(
                spectra[name], load * modulus, work_of_adhesion=0.03, with_separation=False, **solid, **options
            )
        return kept[key]

    return state
