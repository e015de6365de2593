"""Area from the slope over the contact: exact for a line, its limits, and the hold-out that it was judged on."""

import numpy as np
import pytest

import persson
from persson.contact_slope import contact_area, contact_fractions, data, pair_correlation, summit_curvature
from persson.domain import groups_of, outside
from validation.studies.contact_slope import lines_of

MATERIAL = {"youngs_modulus": 0.75, "poisson_ratio": 0.5}  # E* = 1 Pa
LINES = persson.DiscreteSpectrum.self_affine(2 * np.pi, 0.7, 5e-3, 60)


def area_of(spectrum, load_over_slope):
    return contact_area(spectrum, load_over_slope * spectrum.slope_rms, **MATERIAL).contact_fraction


@pytest.mark.parametrize("share", [1e-9, 1e-3, 0.2, 0.9, 1.0, 3.0])
def test_one_line_is_westergaard(share):
    """p* = E* q h / 2."""
    line = persson.DiscreteSpectrum([7.0], [0.02])
    found = contact_area(line, share * 7.0 * 0.02 / 2, **MATERIAL)
    # 3e-16 measured
    assert found.contact_fraction == pytest.approx(2 / np.pi * np.arcsin(np.sqrt(min(share, 1.0))), rel=1e-15)


@pytest.mark.parametrize("spectrum", [LINES, persson.ContinuousSpectrum.self_affine(1.0, 1e3, 0.7, 1e-3)])
def test_contact_becomes_complete_and_grows_with_the_load(spectrum):
    areas, _ = contact_fractions(spectrum, np.geomspace(1e-6, 3, 40) * spectrum.slope_rms)
    assert np.all(np.diff(areas) > -1e-12)
    assert areas[-1] == pytest.approx(1.0, abs=1e-6)


def test_rough_contact_grows_as_the_load():
    wide = persson.ContinuousSpectrum.self_affine(1.0, 1e6, 0.6, 1e-3)
    low, high = contact_fractions(wide, np.array([0.004, 0.005]) * wide.slope_rms)[0]
    # 0.03 from D (1 - A), and A_0 = 1e-5: measured 1.018
    assert np.log(high / low) / np.log(1.25) == pytest.approx(1.0, abs=0.04)


def test_few_lines_at_vanishing_load_grow_as_its_root():
    pair = persson.DiscreteSpectrum([1.0, 2.0], [0.1, 0.04])
    low, high = contact_fractions(pair, np.array([1e-8, 4e-8]) * pair.slope_rms)[0]
    assert high / low == pytest.approx(2.0, rel=1e-3)


def test_area_depends_on_load_over_slope_and_on_ratios_of_wavenumbers_alone():
    scaled = persson.DiscreteSpectrum(3 * LINES.wavenumbers, 2 * LINES.amplitudes)
    assert area_of(scaled, 0.05) == pytest.approx(area_of(LINES, 0.05), rel=1e-12)


@pytest.mark.parametrize("place", [0.5, 1e7], ids=["long", "short"])
def test_line_without_power_changes_nothing(place):
    order = np.argsort(np.append(LINES.wavenumbers, place))
    more = persson.DiscreteSpectrum(
        np.append(LINES.wavenumbers, place)[order], np.append(LINES.amplitudes, 1e-15)[order]
    )
    assert area_of(more, 0.05) == pytest.approx(area_of(LINES, 0.05), rel=1e-8)


def test_bands_of_many_lines_are_as_good_as_their_pairs():
    many, few = (persson.DiscreteSpectrum.self_affine(1.0, 0.5, 1e-3, n) for n in (1001, 999))
    # 7e-6 measured, the two lines included
    assert pair_correlation(many) == pytest.approx(pair_correlation(few), rel=2e-5)


def test_lines_without_a_common_period_have_no_summit_of_their_own():
    assert summit_curvature(persson.DiscreteSpectrum([1.0, np.sqrt(2.0)], [0.1, 0.1])) is None
    assert summit_curvature(persson.DiscreteSpectrum([2.0, 3.0], [0.1, 0.1])) > np.sqrt(2)


def test_curvature_of_the_highest_summit_is_that_of_a_fine_search():
    orders, heights = np.array([1.0, 2.0, 3.0]), np.array([1.0, 0.5, 1 / 3])
    x = np.linspace(0, 2 * np.pi, 200001)
    draw, roots = np.random.default_rng(0), []
    for _ in range(64):
        wave = np.cos(np.multiply.outer(x, orders) + draw.uniform(-np.pi, np.pi, 3))
        roots.append((wave[np.argmax(wave @ heights)] @ (orders**2 * heights)) ** -0.5)
    expected = np.mean(roots) ** -2 / np.sqrt(np.sum((orders * heights) ** 2) / 2)
    # 7.5e-6 measured, in proportion to the grid of the search
    assert summit_curvature(persson.DiscreteSpectrum(orders, heights)) == pytest.approx(expected, rel=2e-5)


def errors_on_the_hold_out(kinds=("self-affine", "roll-off", "band", "gaussian", "lines"), inside=False):
    """Relative errors and those of the ensembles, at contact fractions from .02."""
    stored, found, noise = data()["hold_out"], [], []
    loads = np.array(stored["loads_over_E*h'"])
    for group in stored["groups"]:
        if group["spectrum"] not in kinds:
            continue
        spectrum, areas = lines_of(group), np.array(group["areas"])
        kept = areas > 0.02
        if inside:
            cases = (groups_of(spectrum, p * spectrum.slope_rms, a) for p, a in zip(loads, areas, strict=True))
            kept = np.array([not outside(data()["domain"], case) for case in cases])
        error = np.log(contact_fractions(spectrum, loads * spectrum.slope_rms)[0] / areas)
        found.append(error[kept])
        noise.append(np.array(group["relative_errors"])[kept])
    return np.concatenate(found), np.concatenate(noise)


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("name", ["all", "self-affine", "band", "lines"])
def test_hold_out_is_met_as_it_is_said(name):
    """The figures of the README and of the data file, within 2e-3."""
    found, noise = errors_on_the_hold_out() if name == "all" else errors_on_the_hold_out((name,))
    said = data()["hold_out"]["rms"][name]
    assert (rms(found), rms(noise)) == pytest.approx((said["error"], said["noise"]), abs=2e-3)


def test_errors_inside_the_domain_are_those_said():
    found, _ = errors_on_the_hold_out(inside=True)
    assert rms(found) == pytest.approx(data()["hold_out"]["rms"]["inside the domain"]["error"], abs=2e-3)


OUTSIDE = {
    "rms_slope": (persson.DiscreteSpectrum(LINES.wavenumbers, 10 * LINES.amplitudes), 0.05),
    "load_over_slope": (LINES, 0.21),
    "bandwidth": (persson.ContinuousSpectrum.self_affine(1.0, 1e4, 0.5, 1e-6), 0.05),
}


@pytest.mark.parametrize("name", OUTSIDE)
def test_region_outside_is_named(name):
    spectrum, load = OUTSIDE[name]
    found = contact_area(spectrum, load * spectrum.slope_rms, **MATERIAL)
    assert [words.split()[0] for words in found.outside] == [name]
    assert {*OUTSIDE, "contact_fraction"} == set(data()["domain"]["between"])


@pytest.mark.parametrize("fraction", [0.019, 0.56])
def test_contact_fraction_outside_is_named(fraction):
    said = outside(data()["domain"], groups_of(LINES, 0.05 * LINES.slope_rms, fraction))
    assert [words.split()[0] for words in said] == ["contact_fraction"]


def test_few_lines_far_apart_are_forbidden_at_small_contact():
    order = np.array([1.0, 2, 4, 8, 16, 32, 64])
    found = contact_area(persson.DiscreteSpectrum(order, 1e-3 * order**-1.2), 0.024 * 1e-3 * 2, **MATERIAL)
    assert any("too small" in words for words in found.outside)


@pytest.mark.parametrize("load", [0.0, -1.0, np.nan, np.inf, 1e-90, 1e90])
def test_bad_load_is_refused_by_name(load):
    with pytest.raises(ValueError, match="mean_pressure"):
        contact_area(LINES, load, **MATERIAL)
