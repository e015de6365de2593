"""The theory at the published points of the paper's case, and its load against its own energy and separation."""

import pytest

from persson import DiscreteSpectrum, solve, solve_nonadhesive


@pytest.mark.parametrize(("load", "area", "separation"), [(0.005, 0.0292763, 0.85857), (0.02, 0.1167122, 0.15338)])
def test_points_of_the_papers_case(spectra, solid, modulus, load, area, separation):
    contact = solve_nonadhesive(spectra["paper"], load * modulus, **solid)
    assert contact.contact_fraction == pytest.approx(area, abs=6e-8)  # the digits given
    assert contact.separation / 50e-6 == pytest.approx(separation, abs=6e-6)


@pytest.mark.parametrize("route", ["finite_volumes", "volterra"])
@pytest.mark.parametrize(("load", "area", "separation"), [(0.005, 0.03397, 0.8488), (0.02, 0.13527, 0.1477)])
def test_points_of_the_papers_case_with_adhesion(spectra, solid, modulus, load, area, separation, route):
    contact = solve(spectra["paper"], load * modulus, work_of_adhesion=0.03, route=route, **solid)
    assert contact.contact_fraction == pytest.approx(area, abs=6e-6)  # the digits given; found .0339738, .1352720
    assert contact.separation / 50e-6 == pytest.approx(separation, abs=6e-5)  # found .848833, .147744


def test_load_is_minus_the_derivative_of_the_energy_by_the_separation(solid, modulus):
    lines = DiscreteSpectrum.self_affine(628.0, 0.7, 50e-6, 50)
    less, load, more = (solve_nonadhesive(lines, p * modulus, **solid) for p in (0.0099, 0.01, 0.0101))
    slope = (more.elastic_energy - less.elastic_energy) / (more.separation - less.separation)
    assert -slope == pytest.approx(load.mean_pressure, rel=1e-4)  # measured 3e-5, second order in the step
