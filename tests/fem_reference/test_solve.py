"""The public entry: prescribed edges, complete contact, controls, energies, fields, outcomes, bad input."""

import numpy as np
import pytest

from fem_reference import InvalidProblemError, Resolution, solve
from fem_reference.face import interpolate

QUICK = Resolution(2, 10, 10)
LAYER = {
    "youngs_modulus": 1e6,
    "poisson_ratio": 0.3,
    "thickness": 5e-3,
    "period": 1e-2,
    "harmonics": ([1, 2], [50e-6, 30e-6], [0.4, -1.0]),
    "resolution": QUICK,
}
EDGES = np.array([[1e-3, 4e-3], [6e-3, 9e-3]])


@pytest.fixture(scope="module")
def prescribed():
    return solve(**LAYER, control="penetration", value=70e-6, edges=EDGES, work_of_adhesion=0.03, slope_term=True)


def test_a_result_is_told_on_a_line(prescribed):
    said = repr(prescribed)
    assert said.startswith(f"<Result {prescribed.status}: mean pressure {prescribed.mean_pressure:.6g} +- ")
    assert "patches 2" in said
    assert len(said) < 200


@pytest.mark.parametrize("control", ["separation", "total_displacement", "mean_pressure"])
def test_the_four_controls_reach_the_same_state(prescribed, control):
    other = solve(**LAYER, control=control, value=getattr(prescribed, control), edges=EDGES)
    assert other.penetration == pytest.approx(70e-6, rel=1e-11)
    np.testing.assert_allclose(other.stress_intensity, prescribed.stress_intensity, rtol=1e-10)


def test_total_displacement_is_penetration_and_uniform_compression(prescribed):
    nu = 0.3
    compression = prescribed.mean_pressure * 5e-3 * (1 - 2 * nu) * (1 + nu) / (1e6 * (1 - nu))
    assert prescribed.total_displacement - prescribed.penetration == pytest.approx(compression, rel=1e-10)
    assert prescribed.strain_energy - prescribed.elastic_energy == pytest.approx(
        0.5 * prescribed.load * compression, rel=1e-9
    )


def test_elastic_energy_is_half_the_work_of_the_pressure(prescribed):
    """U_el = (1/2) int sigma (h - h_max + Delta) dx over the contact, by Gauss points on the facets."""
    face = prescribed.interface
    ends = face.x[::2]
    gauss, weights = np.polynomial.legendre.leggauss(4)
    at = 0.5 * (ends[1:] + ends[:-1])[:, None] + 0.5 * np.diff(ends)[:, None] * gauss
    pressure = interpolate(at, face.x, face.pressure, 2)
    middle = at.mean(axis=1) % 1e-2
    inside = ((middle > 1e-3) & (middle < 4e-3)) | ((middle > 6e-3) & (middle < 9e-3))
    mean = prescribed.total_displacement - prescribed.penetration
    work = np.sum(pressure * (prescribed.displacement(at) - mean) * weights, axis=1) * 0.5 * np.diff(ends)
    assert 0.5 * np.sum(work[inside]) == pytest.approx(prescribed.elastic_energy, rel=1e-9)  # exact but for rounding


def test_penetration_raises_the_energy_by_the_load(prescribed):
    step = 1e-7
    energies = [
        solve(**LAYER, control="penetration", value=70e-6 + sign * step, edges=EDGES).elastic_energy for sign in (-1, 1)
    ]
    assert (energies[1] - energies[0]) / (2 * step) == pytest.approx(prescribed.load, rel=1e-8)


def test_adhesion_energy_is_the_arc_length_of_the_contact(prescribed):
    x = np.concatenate([np.linspace(a, b, 20001)[:-1] + (b - a) / 40000 for a, b in EDGES])
    slope = prescribed.problem.slope(x / 1e-2) * prescribed.problem.unit_height / 1e-2
    expected = -0.03 * np.sum(np.sqrt(1 + slope**2)) * 3e-3 / 20000
    assert prescribed.adhesion_energy == pytest.approx(expected, rel=1e-9)
    assert prescribed.total_energy == pytest.approx(expected + prescribed.elastic_energy, rel=1e-9)


def test_the_gap_vanishes_on_the_contact_and_is_its_definition_elsewhere(prescribed):
    x = np.linspace(0, 1e-2, 101)
    gap = prescribed.gap(x)
    touching = ((x >= 1e-3) & (x <= 4e-3)) | ((x >= 6e-3) & (x <= 9e-3))
    assert np.max(np.abs(gap[touching])) < 1e-6  # measured 3.6e-7: P2 interpolation of the profile
    assert np.mean(np.abs(gap[~touching])) > 3e-6


def test_the_interface_agrees_with_evaluation_at_points(prescribed):
    face = prescribed.interface
    np.testing.assert_allclose(prescribed.displacement(face.x), face.displacement, atol=1e-18)
    np.testing.assert_allclose(prescribed.gap(face.x), face.gap, atol=1e-17)


def test_pressure_vanishes_off_the_contact(prescribed):
    at = prescribed.interface.x % 1e-2
    off = ((at < 0.99e-3) | (at > 4.01e-3)) & ((at < 5.99e-3) | (at > 9.01e-3))
    assert np.any(off)
    assert np.all(prescribed.interface.pressure[off] == 0)


def test_every_number_has_an_uncertainty_of_its_shape(prescribed):
    for name, uncertainty in prescribed.uncertainty.items():
        value = prescribed.interface.pressure if name == "pressure" else getattr(prescribed, name)
        assert np.all(np.isfinite(uncertainty)), name
        assert np.all(np.asarray(uncertainty) >= 0), name
        if not callable(value):
            assert np.shape(uncertainty) == np.shape(value), name
    numbers = {n for n in vars(prescribed) if isinstance(getattr(prescribed, n), float)}
    assert numbers - set(prescribed.uncertainty) <= {"closure_residual", "min_eigenvalue"}


@pytest.mark.parametrize("shift", [-1e-2, 1e-2], ids=["back", "on"])
def test_edges_are_taken_modulo_the_period(prescribed, shift):
    other = solve(**LAYER, control="penetration", value=70e-6, edges=EDGES + shift)
    np.testing.assert_allclose(other.edges, EDGES, atol=1e-15)
    assert other.load == pytest.approx(prescribed.load, rel=1e-9)


def test_patches_are_listed_from_the_start_of_the_period(prescribed):
    rolled = np.array([EDGES[1] - 1e-2, EDGES[0]])  # the same contact, begun one patch earlier
    other = solve(**LAYER, control="penetration", value=70e-6, edges=rolled)
    np.testing.assert_allclose(other.edges, EDGES, atol=1e-15)
    np.testing.assert_allclose(other.stress_intensity, prescribed.stress_intensity, rtol=1e-6)
    np.testing.assert_allclose(other.rank_one_defect, prescribed.rank_one_defect, rtol=1e-3)


def test_an_edge_at_the_start_of_the_period_keeps_a_small_uncertainty():
    layer = LAYER | {"harmonics": ([1], [50e-6], [-np.pi / 2])}
    wide = solve(**layer, control="penetration", value=30e-6)
    start = wide.edges[0, 0] / 1e-2 * 2 * np.pi
    moved = layer | {"harmonics": ([1], [50e-6], [-np.pi / 2 + start])}  # now its left edge is at zero, nearly
    there = solve(**moved, control="penetration", value=30e-6)
    assert np.all(there.uncertainty["edges"] < 8e-6)  # measured 3.8e-6, of a period 1e-2
    assert min(there.edges[0, 0], 1e-2 - there.edges[0, 0]) < 1e-5


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_complete_contact_carries_any_load_at_penetration_h_max(nu):
    layer = LAYER | {"poisson_ratio": nu}
    result = solve(**layer, control="mean_pressure", value=-2e3, edges="complete")
    assert result.status == "complete_contact"
    assert result.contact_fraction == 1.0
    assert result.edges.size == 0
    assert result.penetration == pytest.approx(result.problem.highest * result.problem.unit_height, rel=1e-12)


def test_complete_contact_by_total_displacement():
    result = solve(**LAYER, control="total_displacement", value=1e-4, edges="complete")
    assert result.total_displacement == pytest.approx(1e-4, rel=1e-12)


def test_a_flat_layer_is_uniformly_compressed():
    flat = LAYER | {"harmonics": ([], [], [])}
    result = solve(**flat, control="mean_pressure", value=1e3, edges="complete")
    np.testing.assert_allclose(result.interface.pressure, 1e3, rtol=1e-9)


def test_a_flat_punch_has_edges_that_close():
    result = solve(**(LAYER | {"harmonics": ([], [], [])}), control="mean_pressure", value=1e3, edges=[[2e-3, 6e-3]])
    assert result.status == "negative_stress_intensity"
    assert result.interface.gap.min() < 0
    assert np.all(np.isfinite(result.rank_one_defect))


def test_an_edge_too_far_out_of_its_contact_opens(prescribed):
    pressed = solve(**LAYER, control="penetration", value=300e-6, edges=EDGES)
    assert pressed.status == "negative_stress_intensity"


GOOD = {"control": "penetration", "value": 7e-5, "edges": EDGES}


@pytest.mark.parametrize(
    ("resolution", "told"),
    [
        (Resolution(2, 8, 8), "at least 10 cells with elements of order 2, got 8"),
        (Resolution(4, 5, 12), "at least 8 cells with elements of order 4, got 5"),
        (Resolution(2, 10, 6), "at least 8 tip levels with elements of order 2, got 6"),
        (Resolution(4, 10, 9), "at least 12 tip levels with elements of order 4, got 9"),
    ],
    ids=["P2 cells", "P4 cells", "P2 tips", "P4 tips"],
)
def test_a_resolution_too_coarse_to_tell_its_error_is_refused(resolution, told):
    with pytest.raises(InvalidProblemError, match=f"^resolution: needs {told}"):
        solve(**LAYER | {"resolution": resolution}, control="penetration", value=7e-5, edges=EDGES)


def test_a_start_says_which_equilibrium_is_meant():
    adhesive = LAYER | {"work_of_adhesion": 0.03, "control": "separation", "value": 50e-6, "resolution": QUICK}
    both = solve(**adhesive, patches=2)
    again = solve(**adhesive, start=both.edges + 2e-4 * np.array([-1, 1]))
    assert np.all(np.abs(again.edges - both.edges) <= again.uncertainty["edges"] + both.uncertainty["edges"])


def test_a_bad_start_is_named():
    with pytest.raises(InvalidProblemError, match=r"^start: every patch needs a < b"):
        solve(**LAYER, control="penetration", value=7e-5, start=[[3e-3, 1e-3]])


@pytest.mark.parametrize(
    ("change", "argument"),
    [
        ({"edges": EDGES[::-1]}, "edges"),
        ({"edges": [[1e-3, 5e-3], [4e-3, 6e-3]]}, "edges"),
        ({"edges": [[1e-3, 1e-3 + 1e-9]]}, "edges"),
        ({"edges": "everywhere"}, "edges"),
        ({"edges": [["a", "b"]]}, "edges"),
        ({"edges": []}, "edges"),
        ({"poisson_ratio": 0.6}, "poisson_ratio"),
        ({"thickness": 0.0}, "thickness"),
        ({"control": "force"}, "control"),
        ({"edges": "complete"}, "control"),
        ({"edges": "complete", "control": "total_displacement", "poisson_ratio": 0.5}, "control"),
        ({"value": float("nan")}, "value"),
        ({"value": "deep"}, "value"),
        ({"harmonics": [1, 2]}, "harmonics"),
        ({"harmonics": ([], [], []), "edges": None}, "patches"),
    ],
    ids=lambda case: case if isinstance(case, str) else "-".join(case),
)
def test_bad_input_names_the_argument(change, argument):
    with pytest.raises(InvalidProblemError, match=rf"^{argument}: "):
        solve(**(LAYER | GOOD | change))
