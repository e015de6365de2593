"""The preparation of a scan in sentences: each step of each method, with lengths that a person reads."""

import itertools

import numpy as np
import pytest

import bem
from bem.command_line.preparation_words import preparation_sentences

PERIOD, COUNT = 1e-3, 400
GAUSSIAN = {"cutoff_short": 1e-5, "cutoff_long": 5e-4}


def sentences(folder, spoilt=(), **keys):
    """Sentences on a wave with spikes or gaps, by the keys of [profile]."""
    x = np.arange(COUNT) * PERIOD / COUNT
    h = 1e-6 * np.cos(2 * np.pi * 3 * x / PERIOD) + 1e-3 * x + np.random.default_rng(3).normal(0, 1e-9, COUNT)
    for place, height in spoilt:
        h[place] = height
    np.savetxt(folder / "scan.csv", np.column_stack([x, h]))
    profile = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", "harmonics": 50, **keys}
    tables = {
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
        "profile": profile,
        "loading": {"control": "mean_pressure", "targets": [1e3]},
    }
    return preparation_sentences(bem.parse_scene(tables, folder).preparation())


def test_lengths_are_in_units_of_their_size_and_changes_are_told(tmp_path):
    told = sentences(tmp_path, detrend="line", periodic="mirror", **GAUSSIAN)
    (trend,) = [sentence for sentence in told if "least-squares line" in sentence]
    assert trend.startswith("The least-squares line is subtracted, ") and "rms height 7" in trend
    assert "The trace is followed by its mirror image: the period is 2 mm" in " ".join(told)
    assert "A Gaussian filter dampens waves shorter than 10 µm and longer than 500 µm; rms height" in " ".join(told)
    assert told[-1].startswith("The first 50 of 399 harmonics are kept, with ")
    assert not any(dump in " ".join(told) for dump in ("e-0", "_", "+-", "^", "None"))


@pytest.mark.parametrize(
    ("detrend", "periodic"),
    list(itertools.product(["none", "mean", "line", "quadratic", "cubic"], ["as_is", "mirror", "window"])),
)
def test_every_method_has_a_sentence(detrend, periodic, tmp_path):
    told = sentences(tmp_path, detrend=detrend, periodic=periodic)
    assert all(sentence[0].isupper() and sentence.endswith(".") for sentence in told)
    assert len(set(told)) == len(told)
