"""Fitted laws of the contact area: exact for one line, limits, scaling, domain, refusals."""

import numpy as np
import pytest
from scipy.optimize import brentq

import persson
from persson.adhesive_edges import EdgeLaw
from persson.contact_slope import contact_fractions, pair_correlation, period_wavenumber, summit_curvature
from persson.fitted_area import DRY_DOMAIN, DRY_FORBIDDEN, WET_DOMAIN, contact_area, numbers_of, reasons_outside

MATERIAL = {"youngs_modulus": 0.75, "poisson_ratio": 0.5}  # E* = 1 Pa
LINES = persson.DiscreteSpectrum.self_affine(2 * np.pi, 0.7, 5e-3, 60)
WORK = 0.03 * LINES.full_contact_energy
LINE = persson.DiscreteSpectrum([7.0], [0.02])
CREST = 7.0 * 0.02 / 2  # p* = E* q h / 2


def area_of(spectrum, load_over_slope, theta=0.0):
    work = theta * spectrum.full_contact_energy or None
    return contact_area(spectrum, load_over_slope * spectrum.slope_rms, work_of_adhesion=work, **MATERIAL)


@pytest.mark.parametrize("share", [1e-9, 1e-3, 0.2, 0.9, 1.0, 3.0])
def test_one_line_is_westergaard(share):
    area = contact_area(LINE, share * CREST, **MATERIAL)
    # 3e-16 measured
    assert area.contact_fraction == pytest.approx(2 / np.pi * np.arcsin(np.sqrt(min(share, 1.0))), rel=1e-15)


@pytest.mark.parametrize("spectrum", [LINES, persson.ContinuousSpectrum.self_affine(1.0, 1e3, 0.7, 1e-3)])
def test_contact_becomes_complete_and_grows_with_the_load(spectrum):
    areas = contact_fractions(spectrum, np.geomspace(1e-6, 3, 40) * spectrum.slope_rms)
    assert np.all(np.diff(areas) > -1e-12)
    assert areas[-1] == pytest.approx(1.0, abs=1e-6)


def test_rough_contact_grows_as_the_load():
    wide = persson.ContinuousSpectrum.self_affine(1.0, 1e6, 0.6, 1e-3)
    low, high = contact_fractions(wide, np.array([0.004, 0.005]) * wide.slope_rms)
    # 0.03 from D (1 - A), and A_0 = 1e-5: measured 1.018
    assert np.log(high / low) / np.log(1.25) == pytest.approx(1.0, abs=0.04)


def test_few_lines_at_vanishing_load_grow_as_its_root():
    pair = persson.DiscreteSpectrum([1.0, 2.0], [0.1, 0.04])
    low, high = contact_fractions(pair, np.array([1e-8, 4e-8]) * pair.slope_rms)
    assert high / low == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize("theta", [0.0, 0.03])
def test_area_depends_on_ratios_alone(theta):
    scaled = persson.DiscreteSpectrum(3 * LINES.wavenumbers, 2 * LINES.amplitudes)
    areas = [area_of(spectrum, 0.05, theta).contact_fraction for spectrum in (scaled, LINES)]
    assert areas[0] == pytest.approx(areas[1], rel=1e-12)


@pytest.mark.parametrize("place", [0.5, 1e7], ids=["long", "short"])
@pytest.mark.parametrize("theta", [0.0, 0.03])
def test_line_without_power_changes_neither_area_nor_domain(place, theta):
    order = np.argsort(np.append(LINES.wavenumbers, place))
    q, h = np.append(LINES.wavenumbers, place)[order], np.append(LINES.amplitudes, 1e-15)[order]
    more, area = area_of(persson.DiscreteSpectrum(q, h), 0.05, theta), area_of(LINES, 0.05, theta)
    assert more.contact_fraction == pytest.approx(area.contact_fraction, rel=1e-8)
    assert more.status == area.status


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


def johnson(area, work):
    """Load of one line over E*, K. L. Johnson (1995)."""
    return CREST * np.sin(np.pi * area / 2) ** 2 - np.sqrt(work * 7.0 / np.pi * np.tan(np.pi * area / 2))


@pytest.mark.parametrize("theta", [1e-4, 0.01, 0.1, 0.5])
@pytest.mark.parametrize("share", [-0.01, 0.0, 0.1, 0.4])
def test_one_line_with_adhesion_is_johnson_at_any_load(theta, share):
    work, load = theta * LINE.full_contact_energy, share * CREST
    areas = np.linspace(1e-4, 0.9999, 20001)
    loads = johnson(areas, work)
    top, least = int(np.argmax(loads)), int(np.argmin(loads[: int(np.argmax(loads)) + 1]))
    given = {"work_of_adhesion": work, **MATERIAL}
    if load < loads[least]:
        with pytest.raises(ValueError, match="pull-off"):
            contact_area(LINE, load, **given)
        return
    area = contact_area(LINE, load, **given)
    expected = brentq(lambda a: johnson(a, work) - load, areas[least], areas[top], xtol=1e-15)
    assert area.contact_fraction == pytest.approx(expected, rel=1e-9)  # 3e-10
    assert area.pull_off == pytest.approx(loads[least], rel=1.3e-6)  # 4e-7: a 50th of a cell, squared


def test_one_line_jumps_into_complete_contact_where_johnson_says():
    work = 0.5 * LINE.full_contact_energy
    top = johnson(np.linspace(0.01, 0.99, 20001), work).max()
    assert EdgeLaw(LINE, work).complete == pytest.approx(top, rel=1.2e-4)  # 4e-5
    assert contact_area(LINE, 1.01 * top, work_of_adhesion=work, **MATERIAL).contact_fraction == 1.0


def test_adhesion_enlarges_the_area_as_the_root_of_its_work_where_it_is_weak():
    dry = contact_fractions(LINES, np.array([0.01]))[0]
    single, fourfold = (EdgeLaw(LINES, 1e-6 * f * WORK).at(0.01)[1] - dry for f in (1, 4))
    assert single > 0
    assert fourfold / single == pytest.approx(2.0, rel=1e-4)  # 3e-5


def test_area_grows_with_load_and_work_down_to_the_pull_off():
    areas = np.array([[EdgeLaw(LINES, f * WORK).at(load)[1] for load in (1e-3, 0.01, 0.03)] for f in (1, 3, 9)])
    assert np.all(np.diff(areas, axis=0) > 0) and np.all(np.diff(areas, axis=1) > 0)
    law = EdgeLaw(LINES, 30 * WORK)
    assert law.pull_off < 0
    at_zero, pulled = law.at(0.0)[1], law.at(0.99 * law.pull_off)[1]
    assert 0 < pulled < at_zero < areas[0, 0] * 30


def test_many_lines_have_the_edges_of_their_power_spectrum():
    """The two edges of one patch in a period are the whole difference."""
    lines = persson.DiscreteSpectrum.self_affine(1.0, 0.6, 1e-3, 3000)
    banded = persson.ContinuousSpectrum(lines.wavenumbers, lines.amplitudes**2 / 4)
    edges = [EdgeLaw(spectrum, 1e-6).edges(np.array([0.2]))[0][0] for spectrum in (lines, banded)]
    assert edges[0] - period_wavenumber(lines) / np.pi == pytest.approx(edges[1], rel=4e-3)  # 1.5e-3


def lines(orders):
    orders = np.array(orders, dtype=float)
    return persson.DiscreteSpectrum(orders, 0.05 * orders**-1.2)


STEEP = persson.DiscreteSpectrum(LINES.wavenumbers, 10 * LINES.amplitudes)
OUTSIDE = [  # number, spectrum, load over slope, theta
    ("rms_slope", STEEP, 0.05, 0.0),
    ("load_over_slope", LINES, 0.21, 0.0),
    ("bandwidth", persson.ContinuousSpectrum.self_affine(1.0, 1e4, 0.5, 1e-6), 0.05, 0.0),
    ("rms_slope", STEEP, 0.05, 0.03),
    ("load_over_slope", LINES, 0.0079, 0.09),
    ("bandwidth", persson.DiscreteSpectrum.self_affine(1.0, 0.5, 1e-3, 450), 0.05, 0.03),
    ("lines", lines([1, 2, 4, 6, 9, 13, 19, 28, 40]), 0.1, 0.03),
    ("theta", LINES, 0.05, 0.101),
]


@pytest.mark.parametrize(("name", "spectrum", "load", "theta"), OUTSIDE)
def test_case_outside_of_the_domain_is_named(name, spectrum, load, theta):
    area = area_of(spectrum, load, theta)
    assert area.status == "out_of_domain"
    assert [reason.split()[0] for reason in area.reasons] == [name]


@pytest.mark.parametrize("theta", [0.0, 0.03, 0.1], ids=["dry", "papers", "on the bound"])
def test_case_inside_the_domain_has_no_reason(theta):
    area = area_of(LINES, 0.05, theta)
    assert (area.status, area.reasons) == ("in_domain", ())


@pytest.mark.parametrize(
    ("domain", "fraction"), [(DRY_DOMAIN, 0.019), (DRY_DOMAIN, 0.56), (WET_DOMAIN, 0.049), (WET_DOMAIN, 0.61)]
)
def test_contact_fraction_outside_is_named(domain, fraction):
    reasons = reasons_outside(domain, numbers_of(LINES, 0.05 * LINES.slope_rms, fraction))
    assert [reason.split()[0] for reason in reasons] == ["contact_fraction"]


def test_few_lines_far_apart_are_forbidden_at_small_contact():
    order = np.array([1.0, 2, 4, 8, 16, 32, 64])
    spectrum = persson.DiscreteSpectrum(order, 1e-3 * order**-1.2)
    numbers = numbers_of(spectrum, 0.05 * spectrum.slope_rms, 0.1)
    assert reasons_outside(DRY_DOMAIN, numbers) == ()
    assert "too small" in reasons_outside(DRY_DOMAIN, numbers, DRY_FORBIDDEN)[0]


def test_continuous_spectrum_has_the_bandwidth_of_its_power_law():
    """C ~ q^-(1 + 2 H): <ln q>_slope = ln q_N - 1/(2 - 2 H), <ln q>_height = ln q_1 + 1/(2 H), far from both ends."""
    spectrum = persson.ContinuousSpectrum.self_affine(1.0, 1e6, 0.4, 1e-3)
    bandwidth = numbers_of(spectrum, 0.01, 0.1)["bandwidth"]
    assert np.log(bandwidth) == pytest.approx(np.log(1e6) - 1 / 1.2 - 1 / 0.8, abs=6e-4)  # 2e-4


@pytest.mark.parametrize(
    ("words", "spectrum", "load", "work"),
    [
        ("mean_pressure", LINES, 0.0, None),
        ("mean_pressure", LINES, np.nan, None),
        ("mean_pressure", LINES, np.nan, 1e-6),
        ("mean_pressure: -1 .*pull-off", LINES, -1.0, 1e-6),
        ("mean_pressure: 1e-50", LINES, 1e-50, 1e-50),
        ("work_of_adhesion", LINES, 0.01, 0.0),
        ("work_of_adhesion", LINES, 0.01, 1e100),
        ("mean_pressure", LINES, 1e100, None),
        ("rms slope", persson.DiscreteSpectrum([1.0], [1e-80]), 0.01, None),
    ],
)
def test_bad_input_is_refused_by_name(words, spectrum, load, work):
    with pytest.raises(ValueError, match=words):
        contact_area(spectrum, load, work_of_adhesion=work, **MATERIAL)


@pytest.mark.parametrize(
    ("load", "work"), [(1e-50, None), (1e-50, 1e50), (1e50, None), (1e50, 1e-50), (1e50, 1e50), (1e-4, 1e-50)]
)
def test_extreme_input_that_is_represented_is_answered(load, work):
    area = contact_area(LINES, load, work_of_adhesion=work, **MATERIAL)
    assert 0 <= area.contact_fraction <= 1
