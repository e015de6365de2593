"""Area with adhesion from the edges: exact for a line, its limits, balances, and the hold-out that it was judged on."""

import numpy as np
import pytest
from scipy.optimize import brentq

import persson
from persson.adhesive_edges import EdgeLaw, contact_area, data
from persson.contact_slope import contact_fractions, period_wavenumber
from persson.mathematics.edge_distribution import edge_distribution
from validation.studies import adhesive_edges
from validation.studies.adhesive_edges import misses, rms

MATERIAL = {"youngs_modulus": 0.75, "poisson_ratio": 0.5}  # E* = 1 Pa
LINES = persson.DiscreteSpectrum.self_affine(2 * np.pi, 0.7, 5e-3, 60)
WORK = 0.03 * LINES.full_contact_energy
LINE = persson.DiscreteSpectrum([7.0], [0.02])
CREST = 7.0 * 0.02 / 2  # p* = E* q h / 2


def johnson(area, work):
    """Load of one line over E*, K. L. Johnson (1995)."""
    return CREST * np.sin(np.pi * area / 2) ** 2 - np.sqrt(work * 7.0 / np.pi * np.tan(np.pi * area / 2))


@pytest.mark.parametrize("theta", [1e-4, 0.01, 0.1, 0.5])
@pytest.mark.parametrize("share", [-0.01, 0.0, 0.1, 0.4])
def test_one_line_is_johnson_at_any_load(theta, share):
    work, load = theta * LINE.full_contact_energy, share * CREST
    areas = np.linspace(1e-4, 0.9999, 20001)
    loads = johnson(areas, work)
    top, least = int(np.argmax(loads)), int(np.argmin(loads[: int(np.argmax(loads)) + 1]))
    given = {"work_of_adhesion": work, **MATERIAL}
    if load < loads[least]:
        with pytest.raises(ValueError, match="pull-off"):
            contact_area(LINE, load, **given)
        return
    found = contact_area(LINE, load, **given)
    expected = brentq(lambda a: johnson(a, work) - load, areas[least], areas[top], xtol=1e-15)
    assert found.contact_fraction == pytest.approx(expected, rel=1e-9)  # 3e-10
    assert found.pull_off == pytest.approx(loads[least], rel=1.3e-6)  # 4e-7: a 50th of a cell, squared
    assert found.edge_density == pytest.approx(7.0 / np.pi, rel=1e-12)


def test_one_line_jumps_into_complete_contact_where_johnson_says():
    work = 0.5 * LINE.full_contact_energy
    top = johnson(np.linspace(0.01, 0.99, 20001), work).max()
    assert EdgeLaw(LINE, work).complete == pytest.approx(top, rel=1.2e-4)  # 4e-5
    assert contact_area(LINE, 1.01 * top, work_of_adhesion=work, **MATERIAL).contact_fraction == 1.0


def test_adhesion_enlarges_the_area_as_the_root_of_its_work_where_it_is_weak():
    dry = contact_fractions(LINES, np.array([0.01]))[0][0]
    one, four = (EdgeLaw(LINES, 1e-6 * f * WORK).at(0.01)[1] - dry for f in (1, 4))
    assert one > 0
    assert four / one == pytest.approx(2.0, rel=1e-4)  # 3e-5


def test_area_grows_with_load_and_work_down_to_the_pull_off():
    areas = np.array([[EdgeLaw(LINES, f * WORK).at(load)[1] for load in (1e-3, 0.01, 0.03)] for f in (1, 3, 9)])
    assert np.all(np.diff(areas, axis=0) > 0) and np.all(np.diff(areas, axis=1) > 0)
    law = EdgeLaw(LINES, 30 * WORK)
    assert law.pull_off < 0
    at_zero, pulled = law.at(0.0)[1], law.at(0.99 * law.pull_off)[1]
    assert 0 < pulled < at_zero < areas[0, 0] * 30


def test_area_depends_on_ratios_alone():
    scaled = persson.DiscreteSpectrum(3 * LINES.wavenumbers, 2 * LINES.amplitudes)
    theta = WORK / LINES.full_contact_energy
    found = EdgeLaw(scaled, theta * scaled.full_contact_energy).at(0.06)[1]
    assert found == pytest.approx(EdgeLaw(LINES, WORK).at(0.01)[1], rel=1e-12)


def test_many_lines_have_the_edges_of_their_power_spectrum():
    """No period there: the two edges of one patch are all that differs."""
    lines = persson.DiscreteSpectrum.self_affine(1.0, 0.6, 1e-3, 3000)
    banded = persson.ContinuousSpectrum(lines.wavenumbers, lines.amplitudes**2 / 4)
    one, other = (EdgeLaw(spectrum, 1e-6).edges(np.array([0.2]))[0][0] for spectrum in (lines, banded))
    assert one - period_wavenumber(lines) / np.pi == pytest.approx(other, rel=4e-3)  # 1.5e-3


def test_enthalpy_gives_area_and_separation():
    """-d(U_el + p s)/dw = A and d(U_el - w A + p s)/dp = s, by small differences."""
    step = 1e-3

    def enthalpy(load, work):
        law = EdgeLaw(LINES, work)
        reference, area = law.at(load)
        shift, gained = law.changes(load, reference)
        return gained - work * area + load * shift, area, shift

    low, high = (enthalpy(0.01, WORK * f) for f in (1 - step, 1 + step))
    _, area, shift = enthalpy(0.01, WORK)
    assert -(high[0] - low[0]) / (2 * step * WORK) == pytest.approx(area, rel=1.5e-6)  # 5e-7
    low, high = (enthalpy(0.01 * f, WORK) for f in (1 - step, 1 + step))
    assert (high[0] - low[0]) / (2 * step * 0.01) == pytest.approx(shift, rel=2e-6)  # 6e-7


@pytest.mark.parametrize(("reference", "area", "tension"), [(0.02, 0.2, 0.01), (0.1, 0.55, 0.09), (2e-3, 0.01, 3e-3)])
def test_distribution_carries_area_load_and_tail(reference, area, tension):
    found = edge_distribution(reference, area, tension)
    stress, density = found.stress, found.density
    # 2e-6 measured, the nodes; required is 1 %
    below = found.tail / (2 * stress[0] ** 2)
    assert np.trapezoid(density, stress) + below == pytest.approx(area, rel=6e-6)
    load = np.trapezoid(density * stress, stress) - found.tail / abs(stress[0])
    assert load == pytest.approx(reference - tension, rel=6e-6)
    assert found.tail == pytest.approx(2 * tension**2 / (np.pi * np.tan(np.pi * area / 2)), rel=1e-12)
    assert found.at(np.array([10 * stress[0]]))[0] == pytest.approx(found.at(stress[:1])[0] / 1e3, rel=1e-6)


def test_tail_is_that_of_the_edges_at_their_stress_intensity():
    law = EdgeLaw(LINES, WORK)
    reference, area = law.at(0.01)
    found = edge_distribution(reference, area, reference - 0.01)
    assert found.tail == pytest.approx(2 * law.edge_density(reference, area) * WORK / np.pi, rel=1e-9)


def found_in(part, paired, inside):
    """Misses and their noise of a hold-out by the spectrum and the work of adhesion."""
    return [
        (group["spectrum"], theta, misses(part | {"thetas": [theta], "groups": [one]}, None, paired, inside))
        for group in part["groups"]
        for theta, area in zip(part["thetas"], group["areas"], strict=True)
        for one in [group | {"areas": [area]}]
    ]


def of_row(row, found):
    """Those that a row of the errors is about: all, a spectrum, or a work of adhesion."""
    names = ("all", "inside the domain", f"inside, {found[0]}", f"inside, theta {found[1]:g}")
    return row in names


@pytest.fixture(params=[("ratio", True), ("area", False)], ids=["ratio-True", "area-False"])
def evaluated_once(request, monkeypatch):
    """A kind of error; the theory says the same where all loads count and where those of the domain do."""
    name, known = "paired_areas" if request.param[1] else "areas_of", {}
    evaluate = getattr(adhesive_edges, name)

    def once(lines, *arguments):
        key = tuple(np.asarray(one, float).tobytes() for one in (lines.wavenumbers, lines.amplitudes, *arguments[:-1]))
        if key not in known:
            known[key] = evaluate(lines, *arguments)
        return known[key]

    monkeypatch.setattr(adhesive_edges, name, once)
    return request.param


@pytest.mark.parametrize("part", ["hold_out", "second_hold_out"])
def test_hold_out_is_met_as_it_is_said(evaluated_once, part):
    """The figures of the README and of the data file, within 1e-3."""
    kind, paired = evaluated_once
    said = {row: each for row, each in data()[part]["rms"].items() if "outside" not in row}
    every, inside = (found_in(data()[part], paired, only) for only in (False, True))
    for row, numbers in said.items():
        among = every if row == "all" else inside
        miss, noise = np.concatenate([found[2] for found in among if of_row(row, found)], axis=1)
        expected = numbers[kind], numbers[f"{kind}_noise"]
        assert (rms(miss), rms(noise)) == pytest.approx(expected, abs=1e-3), row
        assert miss.size == numbers["loads"], row


@pytest.mark.parametrize(
    ("words", "load", "work"),
    [("mean_pressure", np.nan, 1e-6), ("mean_pressure", -1.0, 1e-6), ("work_of_adhesion", 0.01, 0.0)],
)
def test_bad_input_is_refused_by_name(words, load, work):
    with pytest.raises(ValueError, match=words):
        contact_area(LINES, load, work_of_adhesion=work, **MATERIAL)
