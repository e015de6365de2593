"""The FFT solver as a peer: extrapolation of its grids, and, where it is installed, Westergaard's contact."""

from importlib.util import find_spec

import numpy as np
import pytest

from validation.references.fft_solver import GridContact, extrapolated, grid_contact
from validation.routes.scenes import posed, problem_of

AMPLITUDE, WAVELENGTH, MODULUS = 1e-4, 0.01, 4e6 / 3
needs_peers = pytest.mark.skipif(find_spec("ContactMechanics") is None, reason="needs the extra peers")


def test_extrapolation_removes_the_error_of_the_grid():
    grids = [GridContact(n, 2.0, 0.3 + 1.5 / n, 1) for n in (64, 128, 256)]
    assert extrapolated(grids) == pytest.approx(0.3, abs=1e-15)


@needs_peers
def test_the_peer_finds_westergaards_contact():
    pressure = 0.3 * np.pi * MODULUS * AMPLITUDE / WAVELENGTH
    problem = problem_of(posed("sinusoid", adhesion=None), "the solver on a grid")
    grid = grid_contact(problem, pressure, 1024)
    assert abs(grid.contact_fraction - 2 / np.pi * np.arcsin(np.sqrt(0.3))) <= 2 / 1024
    exact = AMPLITUDE * (1 - 0.3 * (1 - np.log(0.3)))
    assert abs(grid.separation - exact) <= 1e-4 * exact
