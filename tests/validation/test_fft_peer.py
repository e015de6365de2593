"""The FFT solver as a peer: its limits, its absence, and, where it is installed, Westergaard's contact."""

from importlib.util import find_spec

import numpy as np
import pytest

from bem.scene.scene import parse_scene
from validation.cases.rough_profiles import fft_solvers
from validation.harness.verdict import verdict_of
from validation.references.fft_solver import GridContact, extrapolated, grid_contact

AMPLITUDE, WAVELENGTH, MODULUS = 1e-4, 0.01, 4e6 / 3


def sinusoid():
    profile = {"kind": "harmonics", "period": WAVELENGTH, "orders": [1], "amplitudes": [AMPLITUDE], "phases": [0.5]}
    return parse_scene(
        {
            "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
            "profile": profile,
            "loading": {"control": "mean_pressure", "targets": [1.0]},
        }
    )


def test_extrapolation_removes_the_error_of_the_grid():
    grids = [GridContact(n, 2.0, 0.3 + 1.5 / n, 1) for n in (64, 128, 256)]
    assert extrapolated(grids).contact_fraction == pytest.approx(0.3, abs=1e-15)


def test_extrapolation_knows_what_it_does_not_remove():
    grids = [GridContact(n, 2.0, 0.3 + 1.5 / n + 40 / n**2, 1) for n in (64, 128, 256)]
    limit = extrapolated(grids)
    assert abs(limit.contact_fraction - 0.3) <= limit.contact_fraction_error


def test_without_its_package_a_case_takes_stored_grids_and_says_so(monkeypatch):
    monkeypatch.setattr("validation.harness.route.find_spec", lambda name: None)
    outcome = next(case for case in fft_solvers.CASES if case.id == "fft-peer").compute()
    assert [verdict_of(row) for row in outcome.rows] == ["agrees", "agrees"]
    assert all("(stored: ContactMechanics 1.8" in row.reference.source for row in outcome.rows)


def test_stored_grids_of_another_problem_are_refused(monkeypatch):
    monkeypatch.setattr(fft_solvers, "SEED", 2010)
    with pytest.raises(LookupError, match="'seed': 2010"):
        fft_solvers.stored(100)


@pytest.mark.skipif(find_spec("ContactMechanics") is None, reason="needs the extra peers")
def test_stored_grids_are_those_of_the_peer():
    (*_, sequence), _ = fft_solvers.stored(100)
    scene = fft_solvers._posed(100, [share * MODULUS for share in fft_solvers.SHARES])
    found = grid_contact(scene, fft_solvers.SHARES[-1] * MODULUS, sequence[0].points)
    assert found.contact_fraction == pytest.approx(sequence[0].contact_fraction, abs=2 / sequence[0].points)
    assert found.separation == pytest.approx(sequence[0].separation, rel=1e-9)


@pytest.mark.skipif(find_spec("ContactMechanics") is None, reason="needs the extra peers")
def test_the_peer_finds_westergaards_contact():
    pressure = 0.3 * np.pi * MODULUS * AMPLITUDE / WAVELENGTH
    found = grid_contact(sinusoid(), pressure, 1024)
    assert abs(found.contact_fraction - 2 / np.pi * np.arcsin(np.sqrt(0.3))) <= 2 / 1024
    exact = AMPLITUDE * (1 - 0.3 * (1 - np.log(0.3)))
    assert abs(found.separation - exact) <= 1e-4 * exact
