"""Shapes, widths and the arrays of fields.npz: exact values, identities of any state, consistency of units."""

import numpy as np
import pytest
from johnson_wave import gap_of, penetration_of, pressure_of
from judges import dense_nodes, evaluate_dense

import bem
from bem.elastic.layer import Layer
from bem.geometry.patches import PatchPressure
from bem.geometry.profile import Profile
from bem.loading.complete_contact import complete_contact
from bem.observables.shapes import OUTSIDE, complete_contact_shape, shape
from bem.problem import Problem, pose
from bem.scene.scene_tables import OUTPUTS
from bem.stored_fields import complete_contact_fields, contact_fields

ALL = OUTPUTS
NOTHING = PatchPressure(np.empty(0), np.empty(0), ())


def johnson(fraction, alpha=0.0):
    """Exact pressure series by as many nodes as resolve it, penetration, and the pressure itself."""
    pressure, sigma = pressure_of(fraction, alpha, 60 + int(200 * fraction**4))
    return pressure, penetration_of(fraction, alpha), sigma


WAVE = Profile.from_harmonics(2 * np.pi, [1], [1.0])
by_case = pytest.mark.parametrize(
    ("fraction", "alpha"), [(0.02, 0.0), (0.4, 0.0), (0.4, 0.3), (0.9, 0.3)], ids=lambda value: f"{value:g}"
)


@pytest.fixture(scope="module")
def rough():
    profile = Profile.self_affine(2 * np.pi, 0.7, 1.0, 40, 0).scaled()
    left, right = np.array([0.5, 1.9, 5.5]), np.array([1.2, 2.2, 6.6])
    nodes = dense_nodes(profile, left, right) + 10
    return profile, evaluate_dense(profile, left, right, 0.0, nodes)


@by_case
def test_pressure_is_johnsons(fraction, alpha):
    pressure, penetration, sigma = johnson(fraction, alpha)
    found = shape(WAVE, pressure, penetration)
    inside = found.patch == 0
    x = np.where(found.x > np.pi, found.x - 2 * np.pi, found.x)[inside]
    # relative: x in [0, 2 pi) cannot tell the distance from an edge better than rounding; measured 1e-12
    np.testing.assert_allclose(found.pressure[inside], sigma(x), rtol=3e-12)


@by_case
def test_gap_is_johnsons(fraction, alpha):
    pressure, penetration, _ = johnson(fraction, alpha)
    found = shape(WAVE, pressure, penetration)
    outside = found.patch == OUTSIDE
    exact = gap_of(found.x[outside], fraction, alpha)
    # measured 9.5e-15 at fraction 0.9, else 1e-15
    np.testing.assert_allclose(found.gap[outside], exact, rtol=0, atol=2.5e-14)
    assert np.all(found.gap[outside] > 0)


def test_gap_opens_like_the_square_root_of_the_distance():
    """Adhesive edge: gap = 4 K sqrt(rho / (2 pi)) / E*, here K sqrt(2 rho / pi) (K unit s* / sqrt(q0))."""
    pressure, penetration, _ = johnson(0.4, 0.3)
    half, charge = pressure.right[0], pressure.charges[0]
    intensity = -np.sqrt(np.pi / half) * np.sum(charge)
    found = shape(WAVE, pressure, penetration)
    nearest = np.flatnonzero((found.patch == OUTSIDE) & (found.x < np.pi))[0]
    rho = found.x[nearest] - half
    assert found.gap[nearest] == pytest.approx(
        intensity * np.sqrt(2 * rho / np.pi), rel=0.012
    )  # measured 4.4e-3 at rho / half = 3e-3


def test_grid_resolves_edges_and_wavelengths(rough):
    profile, state = rough
    x = shape(profile, state.pressure, state.penetration).x
    assert np.all(np.diff(x) > 0)
    assert x[0] >= 0
    assert x[-1] < 2 * np.pi
    assert np.max(np.diff(x)) <= 2 * np.pi / 40 / 10
    edges = np.concatenate([state.pressure.left, state.pressure.right]) % (2 * np.pi)
    assert np.max(np.min(np.abs(x - edges[:, None]), axis=1)) <= 0.01 * 2 * np.pi / 40


def test_patch_and_pressure_tell_the_same(rough):
    profile, state = rough
    found = shape(profile, state.pressure, state.penetration)
    np.testing.assert_array_equal(np.isnan(found.pressure), found.patch == OUTSIDE)
    for i, (left, right) in enumerate(zip(state.pressure.left, state.pressure.right, strict=True)):
        inside = ((found.x > left) & (found.x < right)) | ((found.x + 2 * np.pi > left) & (found.x + 2 * np.pi < right))
        np.testing.assert_array_equal(inside, found.patch == i)


def test_pressure_of_a_rough_patch_is_its_series(rough):
    profile, state = rough
    found = shape(profile, state.pressure, state.penetration)
    for i, charge in enumerate(state.pressure.charges):
        left, right = state.pressure.left[i], state.pressure.right[i]
        x = np.where(found.x < left, found.x + 2 * np.pi, found.x)[found.patch == i]
        t = (2 * x - left - right) / (right - left)
        exact = np.polynomial.chebyshev.chebval(t, charge) / ((right - left) / 2 * np.sqrt(1 - t * t))
        # measured 1e-11: distance from the edges in x
        np.testing.assert_allclose(found.pressure[found.patch == i], exact, rtol=3e-11, atol=1e-12)


def test_displacement_is_continuous_at_the_edges(rough):
    profile, state = rough
    found = shape(profile, state.pressure, state.penetration)
    switch = np.flatnonzero(np.diff(found.patch))
    step = np.abs(np.diff(found.displacement))[switch]
    distance = np.diff(found.x)[switch]
    bound = np.max(np.abs(state.stress_intensity)) * np.sqrt(2 * distance / np.pi)
    assert switch.size == 6
    assert np.all(step <= bound)


def test_complete_contact_follows_the_profile():
    found = complete_contact_shape(WAVE, WAVE, 3.0)
    np.testing.assert_array_equal(found.gap, 0.0)
    np.testing.assert_allclose(found.displacement, np.cos(found.x), atol=1e-14)
    np.testing.assert_allclose(found.pressure, 3.0 + np.cos(found.x), atol=1e-14)


SCENE = """
[solid]
youngs_modulus = 2.0e6
poisson_ratio = 0.4
[profile]
kind = "self_affine"
period = 0.02
hurst = 0.7
rms_height = 3e-5
harmonics = 40
[loading]
control = "separation"
targets = [3e-5]
[layer]
thickness = 0.004
"""


@pytest.fixture(scope="module")
def problem(tmp_path_factory) -> Problem:
    path = tmp_path_factory.mktemp("scene") / "scene.toml"
    path.write_text(SCENE)
    return pose(bem.load_scene(path))


@pytest.fixture(scope="module")
def fields(problem, rough):
    _, state = rough
    return contact_fields(ALL, problem, state.pressure, state.penetration, 3)


def test_mean_pressure_is_in_pascal(problem, rough, fields):
    _, state = rough
    inside = fields["patch_3"] >= 0
    width = np.diff(fields["sigma_bounds_3"])
    mean_pressure = problem.mean_pressure(state.load)
    # bins of singular pressures and the tail below the lowest one; measured -2.7e-3
    found = np.sum(fields["sigma_3"] * fields["P_3"] * width)
    assert found == pytest.approx(mean_pressure, rel=8e-3)
    below = fields["tail_coefficient_3"] / (2 * fields["sigma_bounds_3"][0] ** 2)
    assert np.sum(fields["P_3"] * width) + fields["outside_contact_3"] + below == pytest.approx(
        1.0, abs=5e-11
    )  # measured 1.5e-11
    assert np.min(fields["pressure_3"][inside]) < mean_pressure < np.max(fields["pressure_3"][inside])


def test_displacement_and_pressure_spectra_are_tied_by_the_compliance(fields):
    layer, solid = Layer(0.004), bem.Solid(2.0e6, 0.4)
    expected = layer.compliance(solid, fields["q"]) ** 2 * fields["C_sigma_3"]
    np.testing.assert_allclose(fields["C_u_3"], expected, rtol=3e-15)  # measured 9e-16


def test_profile_spectrum_gives_the_rms_height(fields):
    q0 = 2 * np.pi / 0.02
    assert fields["q"][0] == pytest.approx(q0, rel=1e-14)
    assert np.sqrt(2 * q0 * np.sum(fields["C_h"])) == pytest.approx(3e-5, rel=1e-13)


def test_separated_state_stores_no_pressure(problem):
    stored = contact_fields(ALL, problem, NOTHING, -0.1, 0)
    assert np.all(np.isnan(stored["pressure_0"]))
    assert np.min(stored["gap_0"]) == pytest.approx(
        0.1 * 3e-5, rel=0.02
    )  # the crest lies between points; measured 7e-3
    assert not np.any(stored["C_u_0"])
    assert not np.any(stored["P_0"])
    assert stored["outside_contact_0"] == 1.0


def test_complete_contact_stores_the_closed_form(problem):
    stored = complete_contact_fields(
        ALL, problem, complete_contact(problem.profile, problem.law, problem.elastic.compliance), 2 * np.pi * 50.0, 0
    )
    np.testing.assert_array_equal(stored["C_u_0"], stored["C_h"])
    np.testing.assert_array_equal(stored["gap_0"], 0.0)
    assert np.mean(stored["pressure_0"]) == pytest.approx(50.0 * problem.scales.stress, rel=1e-12)
    assert np.sum(stored["P_0"] * np.diff(stored["sigma_bounds_0"])) == pytest.approx(1.0, abs=1e-12)
