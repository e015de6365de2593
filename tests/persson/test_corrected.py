"""Corrected theory: exact at full contact, the plain theory where S = 1, published forms as published, both solvers."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import erf

import persson
from persson import adhesive_edges, contact_slope, corrected
from persson.adhesive import ROUTES
from persson.corrected_data import CalibrationError, calibrated, calibration, correction_of
from persson.corrected_variance import FORMS, LITERATURE, Correction, scales_of
from persson.magnification import magnification_mesh

MATERIAL = {"youngs_modulus": 0.75, "poisson_ratio": 0.5}  # E* = 1 Pa
LINES = persson.DiscreteSpectrum.self_affine(2 * np.pi, 0.7, 5e-3, 60)
NARROW_AND_WINDOW = Correction("both", "slower", (0.77, 0.0, 0.23), breadth=0.8, window=1.5)
ALL = {**LITERATURE, "both": NARROW_AND_WINDOW}
LOADS = (0.002, 0.02)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("form", FORMS)
def test_factor_of_one_is_the_plain_theory(form, load):
    plain = persson.solve(LINES, load, **MATERIAL)
    found = corrected.solve(LINES, load, correction=Correction("one", form, (1.0,)), **MATERIAL)
    # drift, by finite volumes: 8e-5 of the area, 8e-5 h_rms, 1.8e-4 of the energy; others 1e-16, 3e-6, 8e-6
    area, height, energy = (2e-4, 2e-4, 5e-4) if form == "drift" else (1e-14, 1e-5, 2e-5)
    assert found.contact_fraction == pytest.approx(plain.contact_fraction, rel=area)
    assert found.separation == pytest.approx(plain.separation, abs=height * LINES.h_rms)
    assert found.elastic_energy == pytest.approx(plain.elastic_energy, rel=energy)


@pytest.mark.parametrize("name", ["yang_persson_2008", "wang_muser_2017"])
@pytest.mark.parametrize("load", LOADS)
def test_slower_diffusion_is_the_integral_over_the_variance(name, load):
    correction, total = LITERATURE[name], LINES.total_slope_variance / 4

    def rate(_, tau):
        return correction.factor(erf(load / np.sqrt(2 * tau)))

    start = (load / 9) ** 2
    tau = solve_ivp(rate, (start, total), [start], rtol=1e-10, atol=1e-16).y[0, -1]
    # 4.7e-7 measured
    found = corrected.solve(LINES, load, correction=correction, with_separation=False, **MATERIAL)
    assert found.contact_fraction == pytest.approx(erf(load / np.sqrt(2 * tau)), rel=1.5e-6)


@pytest.mark.parametrize("load", LOADS)
def test_total_form_solves_its_equation(load):
    given = {"correction": LITERATURE["xu_2024"], "with_separation": False}
    area = corrected.solve(LINES, load, **given, **MATERIAL).contact_fraction
    total = LINES.total_slope_variance / 4
    assert area == pytest.approx(erf(load / np.sqrt(2 * (0.42 + 0.58 * area) * total)), rel=1e-12)


@pytest.mark.parametrize("name", ALL)
def test_full_contact_is_exact(name):
    load = 6 * LINES.slope_rms / 2
    found = corrected.solve(LINES, load, correction=ALL[name], **MATERIAL)
    assert found.contact_fraction == pytest.approx(1.0, abs=6e-9)  # 2e-9, as the plain theory
    assert found.elastic_energy == pytest.approx(LINES.full_contact_energy, rel=5e-10)  # 1.6e-10


@pytest.mark.parametrize("name", ALL)
def test_less_energy_is_stored_and_more_area_found(name):
    plain = persson.solve(LINES, 0.005, **MATERIAL)
    found = corrected.solve(LINES, 0.005, correction=ALL[name], with_separation=False, **MATERIAL)
    assert found.contact_fraction > 1.2 * plain.contact_fraction
    assert found.elastic_energy < 0.9 * plain.elastic_energy


@pytest.mark.parametrize("name", ALL)
def test_distribution_carries_area_and_load(name):
    found = corrected.solve(LINES, 0.01, correction=ALL[name], with_separation=False, **MATERIAL)
    stress = np.linspace(0, 9 * LINES.slope_rms / 2 + 0.01, 20001)
    density = found.pressure_distribution(stress)
    assert np.trapezoid(density, stress) == pytest.approx(found.contact_fraction, rel=2e-5)  # drift 6e-6
    assert np.trapezoid(density * stress, stress) == pytest.approx(0.01, rel=2e-3)  # drift 7e-4


def test_drift_stores_what_the_factor_allows():
    """<sigma^2> grows by A S dV: the moment of the marched distribution against the sum over the nodes."""
    correction, load = LITERATURE["linear_drift"], 0.01
    found = corrected.solve(LINES, load, correction=correction, with_separation=False, resolution=2, **MATERIAL)
    stress = np.linspace(0, 9 * LINES.slope_rms / 2 + load, 20001)
    second = np.trapezoid(found.pressure_distribution(stress) * stress**2, stress)
    mesh = magnification_mesh(LINES, 4 * (load / 9) ** 2 * 0.99, 1.025)
    area, _, _ = corrected._fields(correction, mesh, np.array([load]), 600)
    stored = np.sum(correction.stored(mesh.stress_variance, area, scales_of(mesh)) * np.diff(mesh.stress_variance))
    assert second == pytest.approx(load**2 + stored, rel=1.3e-3)  # 4.5e-4


@pytest.mark.parametrize("name", ALL)
def test_work_of_the_load_is_the_elastic_energy(name):
    """-p ds = dU, over a step of 2 % in the load."""
    low, high = (corrected.solve(LINES, p, correction=ALL[name], **MATERIAL) for p in (0.0099, 0.0101))
    work = 0.01 * (low.separation - high.separation)
    assert work == pytest.approx(high.elastic_energy - low.elastic_energy, rel=1.5e-4)  # 5e-5 measured


def test_contact_depends_on_load_over_slope_alone():
    scaled = persson.DiscreteSpectrum(LINES.wavenumbers, 3 * LINES.amplitudes)
    given = {"correction": NARROW_AND_WINDOW, "with_separation": False, **MATERIAL}
    one, other = (corrected.solve(lines, at, **given) for lines, at in ((LINES, 0.01), (scaled, 0.03)))
    assert other.contact_fraction == pytest.approx(one.contact_fraction, rel=1e-12)


def test_resolution_is_enough():
    given = {"correction": NARROW_AND_WINDOW, **MATERIAL}
    coarse, fine = (corrected.solve(LINES, 0.005, resolution=r, **given) for r in (1, 2))
    assert coarse.contact_fraction == pytest.approx(fine.contact_fraction, rel=5e-6)  # 1.6e-6
    assert coarse.separation == pytest.approx(fine.separation, abs=2.5e-6 * LINES.h_rms)  # 8e-7


def test_breadth_of_a_power_law_is_the_reciprocal_of_its_exponent():
    """S ~ q^p: ln q - <ln q> = 1/p."""
    spectrum = persson.ContinuousSpectrum.self_affine(1.0, 1e6, 0.6, 1e-3)
    scales = scales_of(magnification_mesh(spectrum, 1e-9 * spectrum.total_slope_variance, 1.01))
    assert scales.breadth[-1] == pytest.approx(1 / 0.8, rel=6e-4)  # 2e-4


@pytest.mark.parametrize("name", ALL)
def test_adhesion_that_vanishes_leaves_the_corrected_theory(name):
    dry = corrected.solve(LINES, 0.01, correction=ALL[name], with_separation=False, **MATERIAL)
    tiny = 1e-7 * LINES.full_contact_energy
    wet = corrected.solve(
        LINES, 0.01, correction=ALL[name], work_of_adhesion=tiny, with_separation=False, resolution=0.5, **MATERIAL
    )
    assert wet.contact_fraction == pytest.approx(dry.contact_fraction, rel=2e-4)  # 7e-5
    assert wet.elastic_energy == pytest.approx(dry.elastic_energy, rel=3e-4)  # 9e-5


@pytest.mark.parametrize("name", ["both", "wang_muser_2017"])
def test_both_routes_of_the_corrected_theory_agree(name):
    work = 0.03 * LINES.full_contact_energy
    given = {"work_of_adhesion": work, "correction": ALL[name], "with_separation": False, **MATERIAL}
    areas = [persson.solve(LINES, 0.01, route=route, **given).contact_fraction for route in ROUTES]
    assert areas[0] == pytest.approx(areas[1], rel=4e-5)  # 1.4e-5


@pytest.mark.parametrize("form", ["slower", "total"])
def test_adhesive_factor_of_one_is_the_plain_theory(form):
    given = {"work_of_adhesion": 0.03 * LINES.full_contact_energy, "resolution": 0.5, **MATERIAL}
    plain = persson.solve(LINES, 0.01, **given)
    found = persson.solve(LINES, 0.01, correction=Correction("one", form, (1.0,)), **given)
    assert (found.contact_fraction, found.separation) == pytest.approx(
        (plain.contact_fraction, plain.separation), rel=1e-9
    )


@pytest.mark.parametrize(
    ("words", "given"),
    [
        ("form", {"form": "faster"}),
        ("sum to 1", {"coefficients": (0.5, 0.4)}),
        ("S\\(A\\) <= 0", {"coefficients": (-0.1, 1.1)}),
        ("breadth", {"breadth": -1.0}),
        ("window", {"window": 0.0}),
        ("'total'", {"form": "total", "window": 1.0}),
        ("detached_width", {"detached_width": 1.5}),
    ],
)
def test_bad_correction_is_refused(words, given):
    with pytest.raises(ValueError, match=words):
        Correction(**({"name": "bad", "form": "slower", "coefficients": (0.5, 0.5)} | given))


def test_correction_without_adhesion_is_sent_to_its_entry():
    with pytest.raises(ValueError, match=r"corrected\.solve"):
        persson.solve(LINES, 0.01, correction=NARROW_AND_WINDOW, **MATERIAL)


WORK = 0.03 * LINES.full_contact_energy


def test_calibrated_correction_is_the_default_and_lies_in_its_file():
    values = calibration()["coefficients"]
    found = corrected.solve(LINES, 0.01, with_separation=False, **MATERIAL)
    assert found.correction == calibrated()
    assert (found.correction.breadth, found.correction.window) == (values["b_0"], values["k"])
    assert found.correction.coefficients == (values["c_0"], 0.0, 1 - values["c_0"])


def test_every_coefficient_has_its_uncertainty_and_the_file_its_provenance():
    content = calibration()
    assert set(content["standard_errors"]) == set(content["coefficients"])
    assert all(error > 0 for error in content["standard_errors"].values())
    assert {"ensembles_made_by_commits", "calibrated_by", "seed_roots", "groups"} <= set(content["provenance"])


def test_calibration_of_another_schema_is_refused():
    with pytest.raises(CalibrationError, match="schema"):
        correction_of(calibration() | {"schema": "linecontact-maps/1"})


def test_area_of_the_calibrated_correction_is_that_of_its_laws():
    dry, wet = (corrected.solve(LINES, 0.01, work_of_adhesion=work, **MATERIAL) for work in (None, WORK))
    assert dry.contact_fraction == contact_slope.contact_area(LINES, 0.01, **MATERIAL).contact_fraction
    edges = adhesive_edges.contact_area(LINES, 0.01, work_of_adhesion=WORK, **MATERIAL)
    assert wet.contact_fraction == edges.contact_fraction


def test_adhesion_that_vanishes_leaves_the_calibrated_correction():
    dry, wet = (corrected.solve(LINES, 0.01, work_of_adhesion=w, **MATERIAL) for w in (None, 1e-12 * WORK))
    for name in ("contact_fraction", "separation", "elastic_energy"):
        assert getattr(wet, name) == pytest.approx(getattr(dry, name), rel=1.2e-6)  # 4e-7, as the root of the work
    stress = np.linspace(0.001, 0.3, 50)
    assert wet.pressure_distribution(stress) == pytest.approx(dry.pressure_distribution(stress), rel=1.7e-4)  # 6e-5


def test_work_of_the_load_is_the_change_of_all_energies():
    """-p ds = d(U_el - w A), over a step of 2 % in the load."""
    low, high = (corrected.solve(LINES, p, work_of_adhesion=WORK, **MATERIAL) for p in (0.0099, 0.0101))
    gained = [state.elastic_energy - WORK * state.contact_fraction for state in (low, high)]
    assert 0.01 * (low.separation - high.separation) == pytest.approx(gained[1] - gained[0], rel=1.5e-4)  # 4.5e-5


def test_complete_contact_by_adhesion_is_full_contact():
    found = corrected.solve(LINES, 0.5 * LINES.slope_rms, work_of_adhesion=50 * WORK, **MATERIAL)
    assert (found.status, found.contact_fraction, found.separation) == ("complete_contact", 1.0, 0.0)
    assert found.elastic_energy == pytest.approx(LINES.full_contact_energy, rel=1e-12)
    stress = np.linspace(-1, 1, 20001)
    density = found.pressure_distribution(stress)
    assert np.trapezoid(density, stress) == pytest.approx(1.0, abs=3e-6)  # 8e-7
    assert np.trapezoid(density * stress, stress) == pytest.approx(0.5 * LINES.slope_rms, rel=3e-6)  # 8e-7
    spread = np.trapezoid(density * (stress - 0.5 * LINES.slope_rms) ** 2, stress)
    assert spread == pytest.approx(LINES.total_slope_variance / 4, rel=6e-6)  # 2e-6


def test_separation_below_zero_is_named():
    found = corrected.solve(LINES, 0.005, work_of_adhesion=60 * WORK, **MATERIAL)
    assert found.separation < 0
    assert found.status == "below_zero"


def test_continuous_spectrum_is_served():
    spectrum = persson.ContinuousSpectrum.self_affine(2 * np.pi, 100 * np.pi, 0.7, 1e-3)
    found = corrected.solve(spectrum, 0.1 * spectrum.slope_rms, work_of_adhesion=WORK, **MATERIAL)
    assert persson.solve(spectrum, 0.1 * spectrum.slope_rms, **MATERIAL).contact_fraction < found.contact_fraction < 1


@pytest.mark.parametrize("work", [0.0, -1.0, np.inf])
def test_bad_work_of_adhesion_is_refused(work):
    with pytest.raises(ValueError, match="work_of_adhesion"):
        corrected.solve(LINES, 0.01, work_of_adhesion=work, **MATERIAL)
