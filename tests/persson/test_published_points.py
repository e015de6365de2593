"""The theory at the published points of the paper's case, in its limits, and against its own derivatives."""

import numpy as np
import pytest
from scipy.integrate import quad

from persson import DiscreteSpectrum, solve, solve_nonadhesive

SOLID = {"youngs_modulus": 1e6, "poisson_ratio": 0.5}
MODULUS = 1e6 / 0.75


def self_affine(hurst=0.7, lines=1000, rms=50e-6, period=0.01):
    order = np.arange(1, lines + 1)
    amplitude = order ** -(hurst + 0.5)
    amplitude *= rms / np.sqrt(np.sum(amplitude**2) / 2)
    return DiscreteSpectrum(2 * np.pi / period * order, amplitude)


@pytest.mark.parametrize(("load", "area", "separation"), [(0.005, 0.0292763, 0.85857), (0.02, 0.1167122, 0.15338)])
def test_points_of_the_papers_case(load, area, separation):
    contact = solve_nonadhesive(self_affine(), load * MODULUS, **SOLID)
    assert contact.contact_fraction == pytest.approx(area, abs=6e-8)  # the digits given
    assert contact.separation / 50e-6 == pytest.approx(separation, abs=6e-6)


def test_area_is_linear_at_small_load():
    spectrum = self_affine(hurst=0.5, lines=300)
    contact = solve_nonadhesive(spectrum, 1e-6 * MODULUS, **SOLID)
    assert contact.contact_fraction / 1e-6 == pytest.approx(np.sqrt(8 / np.pi) / spectrum.slope_rms, rel=1e-8)


def test_full_contact_has_the_energy_of_every_line():
    spectrum = self_affine(lines=20)
    contact = solve_nonadhesive(spectrum, 2 * MODULUS, **SOLID)
    energy = MODULUS * np.sum(spectrum.wavenumbers * spectrum.amplitudes**2) / 8
    assert contact.contact_fraction == 1.0
    assert contact.elastic_energy == pytest.approx(energy, rel=1e-12)  # measured 2e-15
    assert abs(contact.separation) <= 1e-12 * spectrum.h_rms


def test_load_is_minus_the_derivative_of_the_energy_by_the_separation():
    spectrum = self_affine(lines=50)
    ahead, here, back = (solve_nonadhesive(spectrum, p * MODULUS, **SOLID) for p in (0.0101, 0.01, 0.0099))
    slope = (ahead.elastic_energy - back.elastic_energy) / (ahead.separation - back.separation)
    assert -slope == pytest.approx(here.mean_pressure, rel=1e-4)  # measured 3e-5, second order in the step


def test_pressure_distribution_carries_the_area_and_the_load():
    contact = solve_nonadhesive(self_affine(lines=100), 0.01 * MODULUS, **SOLID)
    top = 12 * contact.spectrum.slope_rms * MODULUS
    area, _ = quad(contact.pressure_distribution, 0, top, epsabs=1e-13, limit=200)
    load, _ = quad(lambda p: p * contact.pressure_distribution(p), 0, top, epsabs=1e-9, limit=200)
    assert area == pytest.approx(contact.contact_fraction, rel=1e-10)
    assert load == pytest.approx(contact.mean_pressure, rel=1e-10)


@pytest.mark.parametrize("load", [0.0, -1.0, np.nan, np.inf])
def test_loads_without_an_answer_are_refused(load):
    with pytest.raises(ValueError, match="mean_pressure"):
        solve_nonadhesive(self_affine(), load, **SOLID)


@pytest.mark.parametrize(
    ("wavenumbers", "amplitudes", "name"),
    [
        ([2.0, 1.0], [1.0, 1.0], "wavenumbers"),
        ([1.0, 1.0], [1.0, 1.0], "wavenumbers"),
        ([1.0, np.nan], [1.0, 1.0], "wavenumbers"),
        ([1.0, 2.0], [1.0, np.nan], "amplitudes"),
        ([1.0, 2.0], [1.0, -1.0], "amplitudes"),
        ([1.0, 2.0], [0.0, 0.0], "amplitudes"),
    ],
    ids=["unsorted", "duplicate", "nan wavenumber", "nan amplitude", "negative", "flat"],
)
def test_bad_spectra_are_refused_by_name(wavenumbers, amplitudes, name):
    with pytest.raises(ValueError, match=name):
        DiscreteSpectrum(wavenumbers, amplitudes)


@pytest.mark.parametrize("route", ["finite_volumes", "volterra"])
@pytest.mark.parametrize(("load", "area", "separation"), [(0.005, 0.03397, 0.8488), (0.02, 0.13527, 0.1477)])
def test_points_of_the_papers_case_with_adhesion(load, area, separation, route):
    contact = solve(self_affine(), load * MODULUS, work_of_adhesion=0.03, route=route, **SOLID)
    assert contact.contact_fraction == pytest.approx(area, abs=6e-6)  # the digits given; found .0339738, .1352720
    assert contact.separation / 50e-6 == pytest.approx(separation, abs=6e-5)  # found .848833, .147744
