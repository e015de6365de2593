"""The paper's own method: its matrix, its energy and derivative, its descent, what changes the number of patches."""

import ast
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import dblquad

import validation.references.paper_method
from validation.references.closed_forms import Sinusoid
from validation.references.paper_method import Surface, follow, solve
from validation.references.paper_method.cells import _mean_logarithm, compliance, graded
from validation.references.paper_method.energy import SweepsError, energy, gauss_seidel

WAVE = Sinusoid(1e-4, 0.01, 1e6, 0.5, 0.3)
FRACTION = 0.6
PSI = FRACTION * np.pi / 2
THREE = np.array([[0.3, 1.1], [1.5, 2.2], [4.0, 5.1]])


def johnson():
    return Surface(1e6, 0.5, 0.01, [1], [1e-4], [0.0], WAVE.work_of_adhesion)


def rough(thickness=0.001):
    return Surface(1e6, 0.4, 0.01, [1, 3, 5], [1e-4, 3e-5, 2e-5], [0.3, 1.0, 2.0], 1.0, True, thickness)


def two_crests():
    return Surface(1e6, 0.5, 0.01, [1, 2], [2e-5, 5e-5], [0.0, 0.0], 0.05)


def order(sizes, errors):
    return np.polyfit(np.log(1 / np.asarray(sizes)), np.log(np.abs(errors)), 1)[0]


def test_nothing_of_the_solver_is_imported():
    sources = Path(validation.references.paper_method.__file__).parent.glob("*.py")
    imported = {
        name
        for source in sources
        for node in ast.walk(ast.parse(source.read_text()))
        for name in (
            [node.module] if isinstance(node, ast.ImportFrom) else [a.name for a in getattr(node, "names", [])]
        )
        if isinstance(node, ast.Import | ast.ImportFrom)
    }
    assert not {name for name in imported if name.split(".")[0] in ("bem", "fem_reference", "persson")}


@pytest.mark.parametrize(("j", "k"), [(0, 0), (0, 1), (3, 4), (0, 7), (2, 7)], ids=str)
def test_mean_logarithm_of_two_cells(j, k):
    faces = -np.cos(np.pi * np.arange(9) / 8)
    inside = 1e-9 if j == k else 0.0
    value, _ = dblquad(
        lambda t, s: np.log(abs(t - s) + inside), faces[j], faces[j + 1], faces[k], faces[k + 1], epsabs=1e-9
    )
    mean = value / (faces[j + 1] - faces[j]) / (faces[k + 1] - faces[k])
    # 2e-6 at cells 6 widths apart (Taylor's series), 2e-8 at neighbours (the quadrature)
    assert _mean_logarithm(8)[j, k] == pytest.approx(mean, abs=5e-6)


def test_compliance_is_symmetric_and_positive_definite():
    matrix = compliance(rough(), graded(THREE, np.array([12, 9, 15])))
    assert np.max(np.abs(matrix - matrix.T)) < 1e-14
    assert np.linalg.eigvalsh(matrix).min() > 0


@pytest.mark.parametrize("thickness", [None, 0.001], ids=["half-space", "layer"])
def test_derivative_by_the_edges_is_that_of_the_discrete_energy(thickness):
    surface, counts, step = rough(thickness), np.array([12, 9, 15]), 1e-5

    def at(edges):
        return energy(surface, graded(edges, counts), 1.0, 1e-15)

    found = at(THREE).outward * np.array([-1.0, 1.0])
    for place in np.ndindex(3, 2):
        moved = np.zeros((3, 2))
        moved[place] = step
        difference = (at(THREE + moved).total - at(THREE - moved).total) / (2 * step)
        assert found[place] == pytest.approx(difference, abs=1e-8 * np.abs(found).max())  # 1.4e-10


def test_load_of_given_edges_is_of_second_order():
    surface, sizes = johnson(), [16, 32, 64]
    depth = float(WAVE.penetration(PSI)) / surface.unit_height
    exact = float(WAVE.mean_pressure(PSI))
    errors = []
    for size in sizes:
        cells = graded(np.array([[-2 * PSI, 2 * PSI]]), np.array([size]))
        load = energy(surface, cells, depth, 1e-12).load
        errors.append(load * surface.unit_pressure / (2 * np.pi) - exact)
    assert order(sizes, errors) == pytest.approx(2.0, abs=0.02)  # 1.999
    assert abs(errors[-1]) / WAVE.full_contact_pressure < 1e-3  # 5.4e-4


def test_its_own_edges_tend_to_johnsons():
    surface, sizes = johnson(), [8, 16, 32]
    found = [solve(surface, float(WAVE.penetration(PSI)), [[-0.002, 0.003]], n, 1e-9) for n in sizes]
    assert [state.status for state in found] == ["converged"] * 3
    errors = [state.contact_fraction - FRACTION for state in found]
    assert order(sizes, errors) == pytest.approx(2.0, abs=0.15)  # 2.05
    assert abs(errors[-1]) < 5e-4  # 2e-4


def test_minimum_does_not_depend_on_the_start():
    surface = johnson()
    starts = ([[-0.001, 0.001]], [[-0.0015, 0.0045]])
    first, second = (solve(surface, 5e-5, start, 10, 1e-8) for start in starts)
    assert first.contact_fraction == pytest.approx(second.contact_fraction, rel=1e-7)  # 2e-9


def test_contact_that_is_missing_is_made():
    found = solve(two_crests(), 4e-5, [[-0.001, 0.001]], 10)
    assert (found.status, len(found.edges)) == ("converged", 2)


def test_contact_that_cannot_be_vanishes():
    # over the valley at x = 0.0025
    found = solve(two_crests(), 3e-5, [[-0.001, 0.001], [0.0024, 0.0026], [0.004, 0.006]], 10)
    assert (found.status, len(found.edges)) == ("converged", 2)
    assert found.edges[1] == pytest.approx([0.005 - (found.edges[1, 1] - 0.005), found.edges[1, 1]], rel=1e-5)


def test_path_from_first_touch_makes_its_contacts_on_the_way():
    states = follow(two_crests(), np.linspace(0, 4e-5, 9), 10)
    assert [len(state.edges) for state in states] == sorted(len(state.edges) for state in states)
    direct = solve(two_crests(), 4e-5, [[-0.001, 0.001], [0.0045, 0.0055]], 10)
    assert states[-1].contact_fraction == pytest.approx(direct.contact_fraction, rel=1e-6)  # 1e-9


def test_path_ends_with_the_first_state_that_is_none():
    states = follow(two_crests(), [1e-5, -3e-4, 1e-5], 10)
    assert [state.status for state in states] == ["converged", "separated"]


def test_everything_detaches_under_tension():
    assert solve(two_crests(), -2e-4, [[-0.0005, 0.0005]], 10).status == "separated"


def test_gauss_seidel_tells_a_matrix_that_is_not_positive_definite():
    with pytest.raises(SweepsError, match="residual"):
        gauss_seidel(np.array([[1.0, 2.0], [2.0, 1.0]]), np.array([1.0, 0.0]), np.zeros(2), 1e-10)


@pytest.mark.parametrize(
    ("work", "edges", "message"),
    [(0.0, [[0.0, 0.001]], "needs adhesion"), (1.0, [[0.001, 0.0]], "in order"), (1.0, [0.0, 1.0], "pairs")],
    ids=["no-adhesion", "order", "shape"],
)
def test_what_cannot_be_solved_is_refused(work, edges, message):
    surface = Surface(1e6, 0.5, 0.01, [1], [1e-4], [0.0], work)
    with pytest.raises(ValueError, match=message):
        solve(surface, 1e-5, edges, 8)


def test_layer_modes_are_those_of_the_compliance():
    k = 2 * np.pi / 0.01 * 0.001 * np.arange(1, 4)
    nu = 0.4
    ratio = ((3 - 4 * nu) * np.sinh(2 * k) - 2 * k) / (
        (3 - 4 * nu) * np.cosh(2 * k) + 2 * k**2 + 5 - 12 * nu + 8 * nu**2
    )
    assert rough().layer_modes[:3] == pytest.approx((ratio - 1) / np.arange(1, 4), rel=1e-13)
