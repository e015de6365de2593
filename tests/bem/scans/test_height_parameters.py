"""Ra, Rq and Rz of lines whose values are known, and of what is solved of a scan."""

import numpy as np
import pytest

import bem
from bem.scans.height_parameters import height_parameters
from bem.scans.prepare_scan import prepare
from bem.scans.read_scan import RawScan

COUNT, SPACING = 1000, 1e-6
X = SPACING * np.arange(COUNT)


def test_of_a_wave_they_are_those_of_the_sine():
    h = 3e-6 * np.sin(2 * np.pi * 20 * np.arange(COUNT) / COUNT)
    parameters = height_parameters(h, 499)
    expected = {"Ra": 2 / np.pi * 3e-6, "Rq": 3e-6 / np.sqrt(2), "Rz": 6e-6}
    assert parameters == pytest.approx(expected, rel=2e-4)  # measured 8e-5, of Ra, 200 points a wave


def test_sections_are_fifths_of_the_line():
    """Waves of amplitude 1, 2, 3, 4 and 5 in turn; the mean of 2, 4, .. 10 is 6, and the whole line has 10."""
    turns = np.sin(2 * np.pi * 50 * np.arange(COUNT) / COUNT)
    h = turns * (1 + np.arange(COUNT) // (COUNT // 5))
    assert height_parameters(h, 499)["Rz"] == pytest.approx(6.0, rel=1.2e-3)  # measured 4.4e-4


def test_sections_of_a_mirrored_line_are_of_what_was_measured():
    h = np.sin(2 * np.pi * 50 * np.arange(COUNT) / COUNT) * (1 + np.arange(COUNT) // (COUNT // 5))
    mirrored = height_parameters(np.concatenate([h, h[::-1]]), 999, 2)
    assert mirrored == pytest.approx(height_parameters(h, 499), rel=1.2e-3)  # measured 4.1e-4


@pytest.mark.parametrize("periodic", ["as_is", "mirror"])
def test_they_are_of_what_is_solved(periodic):
    """After the filter and the cut: those of the profile at many points."""
    h = bem.Profile.self_affine(COUNT * SPACING, 0.8, 1e-6, 400, 3).height(X)
    raw = RawScan(X + 0.37, h, None, {"unit_x": "m", "unit_h": "m"}, "")
    scan = prepare(raw, {"periodic": periodic, "cutoff_short": 2e-5})
    surface = bem.Profile.from_samples(scan.x, scan.h, 40)
    heights = surface.height(scan.x[0] + COUNT * SPACING * np.arange(50_000) / 50_000)
    cut = scan.preparation(40)[-1]
    assert cut["Ra"] == pytest.approx(np.mean(np.abs(heights)), rel=1.5e-4)  # measured 4.5e-5
    assert cut["Rq"] == pytest.approx(surface.rms_height, rel=1e-12)
    assert cut["Rq"] == pytest.approx(cut["rms_height"][1], rel=1e-12)
    assert cut["Rz"] == pytest.approx(np.mean(np.ptp(heights.reshape(5, -1), axis=1)), rel=6e-3)  # measured 2.1e-3
