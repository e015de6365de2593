"""A contact state from given edges, in SI units: load, K, U, gradient, Hessian, pressure and displacement."""

import numpy as np
import pytest

import bem

PERIOD, SOLID = 0.01, bem.Solid(1e6, 0.3)
MODULUS = 1e6 / (1 - 0.3**2)
WAVE = bem.Profile.from_harmonics(PERIOD, [1], [1e-4], [0.0])
ROUGH = bem.Profile.self_affine(PERIOD, 0.7, 50e-6, 20, 3)
EDGES = np.array([[0.001, 0.0025], [0.004, 0.0045], [0.007, 0.0102]])
ADHESION = bem.Adhesion(0.05, True)


def rough(edges=EDGES, depth=60e-6, **options):
    return bem.ContactState(ROUGH, SOLID, edges, depth, adhesion=ADHESION, **options)


def westergaard(fraction):
    share = np.sin(np.pi * fraction / 2) ** 2
    half = fraction * PERIOD / 2
    state = bem.ContactState(WAVE, SOLID, [[-half, half]], 1e-4 * share * (1 - np.log(share)))
    return state, share


@pytest.mark.parametrize("fraction", [0.02, 0.5, 0.95])
def test_load_is_westergaards(fraction):
    state, share = westergaard(fraction)
    exact = np.pi * MODULUS * 1e-4 / PERIOD * share
    assert state.mean_pressure == pytest.approx(exact, rel=1e-12)
    assert state.load == pytest.approx(exact * PERIOD, rel=1e-12)


def test_a_layer_too_thick_to_be_felt_is_a_half_space():
    """It changes the approach of the bodies only; S has no terms, which was a ValueError of a reshape."""
    layered, half_space = rough(layer=bem.Layer(0.04)), rough()
    assert layered.mean_pressure == half_space.mean_pressure
    np.testing.assert_array_equal(layered.stress_intensity, half_space.stress_intensity)


def test_pressure_is_westergaards():
    state, _ = westergaard(0.5)
    x = np.linspace(-0.0024, 0.0024, 25)
    q = np.pi / PERIOD
    exact = 2 * np.pi * MODULUS * 1e-4 / PERIOD * np.cos(q * x) * np.sqrt(0.5 - np.sin(q * x) ** 2)
    np.testing.assert_allclose(state.pressure(x), exact, rtol=1e-11)


def test_pressure_outside_is_no_number():
    assert np.isnan(rough().pressure(0.003))


def test_hessian_is_the_difference_of_the_gradient():
    state, step = rough(), 2e-4 * float(np.min(np.diff(EDGES)))
    columns = []
    for index in np.ndindex(EDGES.shape):
        moved = np.zeros(EDGES.shape)
        moved[index] = step
        near, far = (rough(EDGES + k * moved).gradient - rough(EDGES - k * moved).gradient for k in (1, 2))
        columns.append(((8 * near - far) / (12 * step)).ravel())
    np.testing.assert_allclose(state.hessian, np.array(columns).T, rtol=0, atol=1e-9 * np.abs(state.hessian).max())


def test_displacement_follows_the_profile_in_contact():
    x = np.linspace(0.0011, 0.0024, 9)
    np.testing.assert_allclose(
        rough().displacement(x), ROUGH.height(x) - ROUGH.max_height + 60e-6, rtol=0, atol=1e-15 * 1e-4
    )


def test_displacement_is_periodic():
    x = np.array([0.0005, 0.0031, 0.006])
    np.testing.assert_allclose(rough().displacement(x), rough().displacement(x + PERIOD), rtol=0, atol=1e-17)


@pytest.mark.parametrize(
    ("edges", "said"),
    [
        ([[0.0, 0.002], [0.001, 0.003]], "disjoint"),
        ([[0.002, 0.001]], "increasing"),
        ([[0.0, 0.011]], "shorter than the period"),
        ([0.0, 0.001], "pairs"),
        ([[0.0, 0.001], [0.002, np.nan]], r"^edges\[1, 1\] = nan: a finite number"),
        (np.empty((0, 2)), "pairs"),
    ],
    ids=["overlap", "reversed", "beyond the period", "no pairs", "not a number", "none"],
)
def test_bad_edges_are_refused(edges, said):
    with pytest.raises(ValueError, match=said):
        bem.ContactState(WAVE, SOLID, edges, 1e-5)


def test_a_flat_profile_is_refused():
    with pytest.raises(ValueError):
        bem.ContactState(bem.Profile.from_harmonics(PERIOD, [1], [0.0]), SOLID, [[0.0, 0.001]], 0.0)
