"""Domain of the correction: each region that it leaves out is seen, by its name alone; extremes are refused by name."""

import numpy as np
import pytest

import persson
from persson import adhesive_edges, corrected
from persson.corrected_data import calibration
from persson.domain import groups_of, in_words, outside
from validation.studies.theory_correction.theory_correction import DOMAIN

MATERIAL = {"youngs_modulus": 0.75, "poisson_ratio": 0.5}  # E* = 1 Pa
LINES = persson.DiscreteSpectrum.self_affine(2 * np.pi, 0.7, 5e-3, 60)
TABLE = calibration()["domain"]
EDGES = adhesive_edges.data()["domain"]


def named(spectrum, load_over_slope, theta=0.0):
    """Regions that the guard of a solved case names."""
    work = theta * spectrum.full_contact_energy or None
    load = load_over_slope * spectrum.slope_rms
    found = corrected.solve(spectrum, load, work_of_adhesion=work, with_separation=False, **MATERIAL)
    return found.outside_calibration


def scaled(factor):
    return persson.DiscreteSpectrum(LINES.wavenumbers, factor * LINES.amplitudes)


def lines(orders):
    orders = np.array(orders, dtype=float)
    return persson.DiscreteSpectrum(orders, 0.05 * orders**-1.2)


@pytest.mark.parametrize("theta", [0.0, 0.03, 0.1], ids=["dry", "papers", "on the bound"])
def test_inside_nothing_is_named(theta):
    assert named(LINES, 0.05, theta) == ()


OUTSIDE = {
    "rms_slope": (scaled(10), 0.05),
    "load_over_slope": (LINES, 0.16),
    "bandwidth": (lines(range(20, 61)), 0.05),
    "lines": (lines([1, 3, 9, 27, 81]), 0.05),
}
WITH_ADHESION = {
    "rms_slope": (scaled(10), 0.05, 0.03),
    "load_over_slope": (LINES, 0.0079, 0.09),
    "bandwidth": (persson.DiscreteSpectrum.self_affine(1.0, 0.5, 1e-3, 450), 0.05, 0.03),
    "lines": (lines([1, 2, 4, 6, 9, 13, 19, 28, 40]), 0.1, 0.03),
    "theta": (LINES, 0.05, 0.101),
}


@pytest.mark.parametrize("name", OUTSIDE)
def test_region_outside_is_named(name):
    assert [words.split()[0] for words in named(*OUTSIDE[name])] == [name]


@pytest.mark.parametrize("name", WITH_ADHESION)
def test_region_outside_with_adhesion_is_named(name):
    assert [words.split()[0] for words in named(*WITH_ADHESION[name])] == [name]


@pytest.mark.parametrize(("table", "fraction"), [(TABLE, 0.019), (TABLE, 0.51), (EDGES, 0.049), (EDGES, 0.61)])
def test_contact_fraction_outside_is_named(table, fraction):
    said = outside(table, groups_of(LINES, 0.05 * LINES.slope_rms, fraction))
    assert [words.split()[0] for words in said] == ["contact_fraction"]


def test_every_interval_has_its_test():
    assert {*OUTSIDE, "contact_fraction"} == set(TABLE["between"])
    assert {*WITH_ADHESION, "contact_fraction"} == set(EDGES["between"])
    assert TABLE["forbidden"] == EDGES["forbidden"] == []


@pytest.mark.parametrize("wavenumber", [1e-6, 1e6], ids=["long", "short"])
def test_line_without_power_does_not_silence_the_guard(wavenumber):
    narrow = lines(range(20, 61))
    order = np.argsort(np.append(narrow.wavenumbers, wavenumber))
    q, h = np.append(narrow.wavenumbers, wavenumber)[order], np.append(narrow.amplitudes, 1e-12)[order]
    said = outside(TABLE, groups_of(persson.DiscreteSpectrum(q, h), 0.05 * narrow.slope_rms, 0.2))
    assert [words.split()[0] for words in said] == ["bandwidth"]


def test_continuous_spectrum_has_the_bandwidth_of_its_power_law():
    """C ~ q^-(1 + 2 H): <ln q>_slope = ln q_N - 1/(2 - 2 H), <ln q>_height = ln q_1 + 1/(2 H), far from both ends."""
    spectrum = persson.ContinuousSpectrum.self_affine(1.0, 1e6, 0.4, 1e-3)
    found = groups_of(spectrum, 0.01, 0.1)["bandwidth"]
    assert np.log(found) == pytest.approx(np.log(1e6) - 1 / 1.2 - 1 / 0.8, abs=6e-4)  # 2e-4


def test_page_has_the_domain_of_the_package():
    assert TABLE == DOMAIN
    assert "2.5 to 102" in in_words(TABLE)
    boxed = TABLE | {"forbidden": [{"lines": [4, 10], "why": "too few"}]}
    assert in_words(boxed).endswith("4 to 10 (too few).")


@pytest.mark.parametrize(
    ("words", "spectrum", "load", "work"),
    [
        ("rms slope", scaled(1e70), 1.0, None),
        ("rms slope", scaled(1e-70), 1e-5, None),
        ("mean_pressure", LINES, 1e-100, None),
        ("mean_pressure", LINES, 1e100, None),
        ("work_of_adhesion", LINES, 0.01, 1e100),
        ("work_of_adhesion", LINES, 0.01, 1e-100),
    ],
)
def test_extremes_are_refused_by_name(words, spectrum, load, work):
    with pytest.raises(ValueError, match=words):
        corrected.solve(spectrum, load, work_of_adhesion=work, **MATERIAL)


def test_least_load_with_next_to_no_adhesion_is_refused_by_name():
    with pytest.raises(ValueError, match="mean_pressure: 1e-50"):
        corrected.solve(LINES, 1e-50, work_of_adhesion=1e-50, **MATERIAL)


@pytest.mark.parametrize(
    ("load", "work"), [(1e-50, None), (1e-50, 1e50), (1e50, None), (1e50, 1e-50), (1e50, 1e50), (1e-4, 1e-50)]
)
def test_what_is_not_refused_is_answered(load, work):
    found = corrected.solve(LINES, load, work_of_adhesion=work, **MATERIAL)
    assert 0 <= found.contact_fraction <= 1
    assert np.isfinite([found.separation, found.elastic_energy]).all()
