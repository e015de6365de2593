"""Fields along the face and their uncertainty against Westergaard's contact of one sinusoid: pressure, gap."""

import numpy as np
import pytest

from fem_reference import Resolution, solve

HALF, NU, AMPLITUDE = 0.2, 0.3, 0.01
FULL = np.pi * AMPLITUDE / (1 - NU**2)
SINE = np.sin(np.pi * HALF)
MESHES = {"P2/P1": Resolution(2, 10, 10), "P4/P3": Resolution(4, 8, 14)}


def westergaard_pressure(x):
    """p = 2 p* cos(pi x) sqrt(sin^2 psi - sin^2 pi x), lengths in periods (Westergaard 1939)."""
    return 2 * FULL * np.cos(np.pi * x) * np.sqrt(SINE**2 - np.sin(np.pi * x) ** 2)


def exact_middle_pressure():
    t, weights = np.polynomial.legendre.leggauss(60)
    weights = weights * (1 - t**2) ** 4
    return weights @ westergaard_pressure(0.8 * HALF * t) / weights.sum()


def exact_gap(x):
    """Integral of the slope 4 pi D cos(pi x) sqrt(sin^2 pi x - sin^2 psi) of the gap from the edge on."""
    t, weights = np.polynomial.legendre.leggauss(200)
    gaps = []
    for at in np.abs((np.asarray(x) + 0.5) % 1.0 - 0.5):
        # x = a + (at - a) r^2 takes out the root
        r = 0.5 * (t + 1)
        along = HALF + (at - HALF) * r**2
        root = np.sqrt(np.maximum(np.sin(np.pi * along) ** 2 - SINE**2, 0.0))
        gaps.append(weights @ (4 * np.pi * AMPLITUDE * np.cos(np.pi * along) * root * (at - HALF) * r))
    return np.array(gaps)


@pytest.fixture(scope="module", params=MESHES)
def contact(request):
    return solve(
        youngs_modulus=1.0,
        poisson_ratio=NU,
        thickness=2.0,
        period=1.0,
        harmonics=([1], [AMPLITUDE], [0.0]),
        control="mean_pressure",
        value=FULL * SINE**2,
        edges=[[-HALF, HALF]],
        resolution=MESHES[request.param],
    )


def test_middle_pressure_within_its_uncertainty(contact):
    error = contact.middle_pressure[0] - exact_middle_pressure()
    assert abs(error) <= contact.uncertainty["middle_pressure"][0]
    assert (
        contact.uncertainty["middle_pressure"][0] < {2: 3e-3, 4: 2e-6}[contact.resolution.order] * FULL
    )  # measured 1.3e-3 and 6.9e-7 (errors 3.2e-4 and 2.7e-8)


def test_pressure_away_from_the_edges_within_its_uncertainty(contact):
    x = (contact.interface.x + 0.5) % 1.0 - 0.5
    middle = np.abs(x) < 0.8 * HALF
    error = np.abs(contact.interface.pressure[middle] - westergaard_pressure(x[middle]))
    assert np.all(error <= contact.uncertainty["pressure"][middle])  # measured: at most 0.99 and 0.46 of it
    allowed = {2: 5e-2, 4: 1.5e-4}[contact.resolution.order]
    assert np.max(contact.uncertainty["pressure"][middle]) < allowed * FULL  # measured 1.7e-2 and 4.8e-5


def test_gap_away_from_the_edges_within_its_uncertainty(contact):
    x = (contact.interface.x + 0.5) % 1.0 - 0.5
    off = np.abs(x) > 1.1 * HALF
    error = np.abs(contact.interface.gap[off] - exact_gap(x[off]))
    assert np.all(error <= contact.uncertainty["gap"][off])  # measured: at most 0.34 and 0.10 of it
    allowed = {2: 3e-3, 4: 3e-5}[contact.resolution.order]
    assert np.max(contact.uncertainty["gap"][off]) < allowed * AMPLITUDE  # measured 1.2e-3 and 9.4e-6


@pytest.mark.parametrize("field", ["displacement", "gap", "pressure"])
def test_uncertainty_at_a_position_is_that_of_the_nodes_beside_it(contact, field):
    face, spread = contact.interface, contact.uncertainty[field]
    between = 0.5 * (face.x[3] + face.x[4])
    found = contact.uncertainty_at(field, [between, between + 1.0, face.x[0]])
    np.testing.assert_array_equal(found, [max(spread[3:5]), max(spread[3:5]), max(spread[:2])])


def test_gap_at_any_position_within_its_uncertainty(contact):
    x = np.linspace(0.23, 0.77, 101)
    assert np.all(np.abs(contact.gap(x) - exact_gap(x)) <= contact.uncertainty_at("gap", x))
