"""Closed forms without adhesion: quadrature, limits, and what they say of spectra and distributions."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erf, exp1

from persson import ContinuousSpectrum, DiscreteSpectrum, solve, solve_nonadhesive

LOADS = (1e-4, 0.005, 0.02, 0.1)


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("name", ["paper", "hurst 0.5", "continuous"])
def test_area_is_the_error_function(spectra, solid, modulus, name, load):
    spectrum = spectra[name]
    state = solve_nonadhesive(spectrum, load * modulus, **solid)
    diffusivity = spectrum.total_slope_variance / (8 * load**2)  # the paper's G
    assert state.contact_fraction == pytest.approx(erf(1 / (2 * np.sqrt(diffusivity))), rel=1e-12)


@pytest.mark.parametrize("name", ["paper", "hurst 0.5", "continuous"])
def test_area_at_small_load_has_the_slope_of_the_theory(spectra, solid, modulus, name):
    state = solve_nonadhesive(spectra[name], 1e-8 * modulus, **solid)
    slope = np.sqrt(8 / np.pi) / spectra[name].slope_rms
    assert state.contact_fraction / 1e-8 == pytest.approx(slope, rel=1e-12)


def test_many_narrow_lines_tend_to_the_power_spectrum(spectra, solid, modulus):
    continuous = spectra["continuous"]
    edges = np.geomspace(continuous.wavenumbers[0], continuous.wavenumbers[-1], 20001)
    middle = np.sqrt(edges[1:] * edges[:-1])
    lines = DiscreteSpectrum(middle, np.sqrt(4 * continuous.power_at(middle) * np.diff(edges)))
    states = [solve_nonadhesive(spectrum, 0.01 * modulus, **solid) for spectrum in (lines, continuous)]
    for quantity in ("contact_fraction", "separation", "elastic_energy"):
        values = [getattr(state, quantity) for state in states]
        assert values[0] == pytest.approx(values[1], rel=1e-6), quantity  # measured 2e-7


def test_full_contact_has_the_energy_of_every_wavelength(spectra, solid, modulus):
    for name in ("paper", "continuous"):
        state = solve_nonadhesive(spectra[name], 3 * modulus, **solid)
        assert state.status == "complete_contact"
        assert state.elastic_energy == pytest.approx(modulus * spectra[name].full_contact_energy, rel=1e-12)


@pytest.mark.parametrize(("load", "before", "after"), [(0.005, 0.635, 1.039), (0.02, 0.881, 1.169)])
def test_rule_inside_a_line_decides_the_separation(spectra, solid, modulus, load, before, after):
    lines = spectra["paper"]
    state = solve_nonadhesive(lines, load * modulus, **solid)

    def share_with_area_at(variance):
        s = np.maximum(variance, 1e-300)
        parts = lines.slope_variance_steps / (4 * lines.wavenumbers) * np.sqrt(2 / (np.pi * s))
        return np.sum(parts * exp1(2 * load**2 / s)) / state.separation

    assert share_with_area_at(lines.slope_variance - lines.slope_variance_steps) == pytest.approx(before, abs=1e-3)
    assert share_with_area_at(lines.slope_variance) == pytest.approx(after, abs=1e-3)


@pytest.mark.parametrize("hurst", [0.3, 0.7])
def test_spectra_of_displacement_and_pressure_are_power_laws(solid, modulus, hurst):
    q = 628.0
    spectrum = ContinuousSpectrum.self_affine(q, 1e5 * q, hurst, 50e-6)
    state = solve_nonadhesive(spectrum, 0.005 * modulus, **solid)
    fine = spectrum.wavenumbers > 1e4 * q
    x = np.log(spectrum.wavenumbers[fine])
    displacement = np.polyfit(x, np.log(state.displacement_power()[fine]), 1)[0]
    pressure = np.polyfit(x, np.log(state.pressure_power()[fine]), 1)[0]
    assert displacement == pytest.approx(-(2 + hurst), abs=2e-3)  # measured 6e-4 at most
    assert pressure == pytest.approx(-hurst, abs=2e-3)


def test_pressure_power_is_the_displacement_power_times_the_stiffness(spectra, solid, modulus):
    lines = spectra["paper"]
    state = solve_nonadhesive(lines, 0.02 * modulus, **solid)
    q0 = float(lines.wavenumbers[0])
    np.testing.assert_allclose(
        state.pressure_power(q0), (modulus * lines.wavenumbers / 2) ** 2 * state.displacement_power(q0), rtol=1e-14
    )


@pytest.mark.parametrize("order", [1, 10, 100])
def test_distribution_at_a_magnification_carries_its_area_and_the_load(spectra, solid, modulus, order):
    state = solve_nonadhesive(spectra["paper"], 0.02 * modulus, **solid)
    q = float(spectra["paper"].wavenumbers[order - 1])
    top = (0.02 + 6 * spectra["paper"].slope_rms) * modulus
    area, _ = quad(lambda p: state.pressure_distribution(p, q), 0, top, epsabs=1e-13, limit=400)
    load, _ = quad(lambda p: p * state.pressure_distribution(p, q), 0, top, epsabs=1e-9, limit=400)
    assert area == pytest.approx(state.contact_fraction_at(q), rel=1e-10)
    assert load == pytest.approx(0.02 * modulus, rel=1e-10)


def test_a_magnification_that_resolves_nothing_has_no_density(spectra, solid, modulus):
    state = solve_nonadhesive(spectra["paper"], 0.02 * modulus, **solid)
    with pytest.raises(ValueError, match=r"wavenumber: 1\.0 resolves no roughness"):
        state.pressure_distribution(0.0, 1.0)


def test_no_adhesion_asked_for_is_the_closed_form(spectra, solid, modulus):
    state = solve(spectra["paper"], 0.02 * modulus, **solid)
    assert state.contact_fraction == solve_nonadhesive(spectra["paper"], 0.02 * modulus, **solid).contact_fraction
