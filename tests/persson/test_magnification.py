"""The mesh over magnification: what it keeps exactly, and lines taken together against lines resolved one by one."""

import numpy as np
import pytest

from persson import ContinuousSpectrum, DiscreteSpectrum, magnification
from persson.diffusion import SAFE, march
from persson.magnification import magnification_mesh


@pytest.mark.parametrize("name", ["paper", "hurst 0.5", "continuous"])
def test_nodes_run_from_nothing_to_everything_with_bounded_growth(spectra, name):
    mesh = magnification_mesh(spectra[name], 1e-6, 1.02)
    nodes = mesh.slope_variance
    assert nodes[0] == 0.0
    assert nodes[-1] == pytest.approx(spectra[name].total_slope_variance, rel=1e-14)
    assert np.all(np.diff(nodes) > 0)
    assert np.all(nodes[2:] / nodes[1:-1] < 1.02 * (1 + 1e-9))


@pytest.mark.parametrize("name", ["paper", "continuous"])
def test_weight_is_the_integral_of_one_over_q(spectra, name):
    # the energy of full contact is W / 4
    mesh = magnification_mesh(spectra[name], 1e-6, 1.05)
    assert mesh.weight[-1] / 4 == pytest.approx(spectra[name].full_contact_energy, rel=1e-12)


def test_wavenumber_jumps_at_the_edge_of_a_resolved_line():
    lines = DiscreteSpectrum([1.0, 2.0, 4.0], [0.1, 0.05, 0.02])
    mesh = magnification_mesh(lines, 1e-4, 1.2, substeps=3)
    at = np.searchsorted(mesh.slope_variance, lines.slope_variance[0] * (1 - 1e-12))
    assert (mesh.before[at], mesh.after[at]) == (1.0, 2.0)
    assert set(mesh.inside) == {1.0, 2.0, 4.0}


def test_wavenumbers_of_a_power_spectrum_follow_its_slope_variance(spectra):
    mesh = magnification_mesh(spectra["continuous"], 1e-6, 1.05)
    q = mesh.before[10]
    assert spectra["continuous"].resolved_variance(float(q)) == pytest.approx(mesh.slope_variance[10], rel=1e-10)


def test_cells_crowd_at_the_onset_of_adhesion():
    spectrum = ContinuousSpectrum([1.0, 10.0], [1e-3, 1e-6])
    onset = spectrum.total_slope_variance / 3
    nodes = magnification_mesh(spectrum, 1e-6, 1.02, onsets=(onset,)).slope_variance
    at = int(np.searchsorted(nodes, onset * (1 - 1e-14)))
    assert nodes[at] == pytest.approx(onset, rel=1e-14)
    assert nodes[at + 1] - nodes[at] < 2e-5 * onset


def test_lines_taken_together_are_worth_their_staircase(monkeypatch):
    # a barrier a = c sqrt(q) on every line: 150 lines resolved one by one, or 2100 nodes on which most are together
    load, scale = 0.05, np.sqrt(2 * 0.1 * 0.75e-6) / np.pi
    lines = DiscreteSpectrum.self_affine(2 * np.pi / 0.01, 0.7, 50e-6, 150)

    def area(smoothed, growth):
        mesh = magnification_mesh(lines, 3.6 * (load / SAFE) ** 2, growth, barrier_scale=scale, substeps=8)
        barrier = scale * np.sqrt(mesh.before)
        path = mesh.smoothed(barrier) if smoothed else barrier
        return march(np.array([load]), mesh.stress_variance, path[None, :], 1200).area[0, -1]

    together, unmoved = area(True, 1.003), area(False, 1.003)
    monkeypatch.setattr(magnification, "SHARPNESS", 1e9)
    resolved = area(False, 1.02)
    assert together == pytest.approx(resolved, abs=5e-6)  # measured 2e-6
    assert abs(unmoved - resolved) > 1e-5  # measured 1.26e-5
