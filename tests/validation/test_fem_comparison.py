"""The comparison with finite elements: raw input only, a wrong constant is reported, a failed code is a named row."""

import numpy as np
import pytest

from validation.cases.finite_elements import fem_comparison, fem_equilibria
from validation.cases.finite_elements.fem_closed_forms import layer_compliance
from validation.cases.finite_elements.fem_equilibria import EDGES, PENETRATION, SCENES
from validation.harness.case import registry
from validation.harness.compare import combined_tolerance, combined_uncertainty
from validation.harness.runner import record_of
from validation.harness.verdict import verdict_of
from validation.references import adapters, fem_adapter
from validation.report.verification.allowances import budget_of
from validation.report.verification.first_screen import place_of
from validation.report.verification.matrix import matrix_of

WAVE = {"adhesion": None, "loading": {"targets": [20e-6]}}


@pytest.fixture(scope="module")
def posed():
    return adapters.scene("layer_two_crests")


def test_raw_constants_are_handed_over(posed):
    arguments = fem_adapter.fem_arguments(posed)
    assert (arguments["youngs_modulus"], arguments["poisson_ratio"]) == (1e6, 0.3)
    assert (arguments["thickness"], arguments["period"]) == (0.005, 0.01)
    assert (arguments["work_of_adhesion"], arguments["slope_term"]) == (0.03, True)
    assert (arguments["control"], arguments["value"]) == ("penetration", 50e-6)
    np.testing.assert_array_equal(arguments["harmonics"][0], [1, 2, 3])


def test_without_adhesion_nothing_is_paid():
    arguments = fem_adapter.fem_arguments(adapters.scene("layer_two_crests", {"adhesion": None}))
    assert (arguments["work_of_adhesion"], arguments["slope_term"]) == (0.0, False)


def test_a_half_space_is_refused():
    with pytest.raises(ValueError, match=r"needs a \[layer\]"):
        fem_adapter.fem_arguments(adapters.scene("layer_two_crests", {"layer": None}))


def test_the_combined_uncertainty_decides_without_a_factor_and_nothing_is_called_measured(given_edges):
    judged = [row for row in fem_comparison.rows(given_edges) if row.reference.uncertainty]
    assert judged
    assert {row.tolerance.measured for row in judged} == {None}
    assert all(row.uncertainty > 0 for row in judged)
    assert {combined_tolerance(row) / combined_uncertainty(row) for row in judged} == {1.0}
    assert {budget_of(row).decides for row in judged} == {"the uncertainty"}


def test_random_scenes_of_the_matrix_are_those_drawn():
    scene = fem_equilibria.posed_of(3)
    assert scene.accuracy.tolerance == 1e-9
    assert scene.loading.control == "total_displacement"
    assert [fem_equilibria.taken(k) for k in (0, 3, 6)] == [False, True, False]  # no layer, one patch, complete contact


def test_middle_pressure_is_the_weighted_mean_of_westergaards():
    half, period, full = 2e-3, 0.01, np.pi * 1e6 / (1 - 0.3**2) * 50e-6 / 0.01
    sine = np.sin(np.pi * half / period) ** 2
    penetration = 50e-6 * sine * (1 - np.log(sine))
    crest = -0.7 / (2 * np.pi) * period
    state = fem_adapter.contact_state(
        adapters.scene("layer_sinusoid", WAVE), [[crest - half, crest + half]], penetration
    )
    t = (np.arange(20000) + 0.5) / 10000 - 1
    weight, at = (1 - t**2) ** 4, np.pi * 0.8 * half * t / period
    exact = 2 * full * np.cos(at) * np.sqrt(sine - np.sin(at) ** 2)
    expected = np.sum(weight * exact) / np.sum(weight)
    np.testing.assert_allclose(fem_adapter.middle_pressure(state), expected, rtol=1e-8)  # measured 3.8e-9: the layer


BY_NAME = {one.id: one for one in registry()}
OF_FEM_ALONE = ("code verification of the finite elements", "finite elements against closed forms")


@pytest.mark.parametrize("name", [one.id for one in BY_NAME.values() if one.group in OF_FEM_ALONE])
def test_a_case_of_the_finite_elements_alone_says_so(name):
    assert BY_NAME[name].code == "fem"


@pytest.mark.parametrize("name", ["layer-two-patches-fem", "fem-fold-coarse"])
def test_rows_that_do_not_hold_both_codes_are_of_the_code_that_was_computed(name):
    rows = BY_NAME[name].compute().rows
    others = [row for row in rows if row.reference.kind != "FEM"]
    assert len(others) >= 1
    assert {row.code for row in others} == {"fem"}
    assert {row.code or "bem" for row in rows if row.reference.kind == "FEM"} == {"bem"}


def test_all_three_codes_meet_on_one_line_and_one_realisation_judges_no_theory():
    rough = BY_NAME["fem-rough-coarse"]
    record = record_of(rough, rough.compute(), 0.0)
    (line,) = matrix_of([record]).lines
    assert line.pairs == {"BF", "BT"}
    assert {row.code for row in record.rows if row.reference.kind == "theory"} == {None}
    assert all(not row.band.low <= 1 <= row.band.high for row in record.rows if row.band)
    assert BY_NAME["fem-rough"].problem == rough.problem
    assert [figure.id for figure in record.figures if place_of(figure) == "centre"] == ["centre-rough"]


def test_order_and_asymptotic_range_on_graded_meshes_are_bounded_within_a_tenth():
    order, asymptotic, *_ = BY_NAME["fem-richardson-coarse"].compute().rows
    assert {verdict_of(row) for row in (order, asymptotic)} == {"agrees"}
    assert max(row.tolerance.value for row in (order, asymptotic)) < 0.1
    assert verdict_of(order.model_copy(update={"computed": [3.5]})) == "deviates"


@pytest.fixture(scope="module")
def given_edges(posed):
    return fem_comparison.compare_prescribed("", posed, "P2/P1", EDGES, PENETRATION)


def test_both_codes_agree_at_given_edges(given_edges):
    assert {verdict_of(row) for row in fem_comparison.rows(given_edges)} == {"agrees"}


@pytest.mark.parametrize(
    ("name", "wrong"),
    [("poisson_ratio", 0.31), ("youngs_modulus", 1.01e6), ("thickness", 4.9e-3), ("value", 50.5e-6)],
)
def test_one_per_cent_wrong_in_one_code_is_told(posed, monkeypatch, name, wrong):
    right = fem_adapter.fem_arguments
    monkeypatch.setattr(fem_adapter, "fem_arguments", lambda scene: right(scene) | {name: wrong})
    found = fem_comparison.compare_prescribed("", posed, "P2/P1", EDGES, PENETRATION)
    assert "deviates" in {verdict_of(row) for row in fem_comparison.rows(found)}


def test_a_state_that_is_no_equilibrium_is_a_named_row(posed):
    (row,) = fem_comparison.rows(fem_comparison.compare_equilibria("", posed, "P2/P1", 1))
    assert verdict_of(row) == "not converged"
    assert "finite elements: interpenetration" in row.message


def test_displacements_are_compared_away_from_the_edges(given_edges):
    x = fem_comparison.away_from_edges(given_edges.fem)
    period, knots = 0.01, np.append(EDGES.ravel(), EDGES[0, 0] + 0.01)
    beside = np.minimum(np.diff(knots), np.roll(np.diff(knots), 1))  # of the four edges
    apart = (x[:, None] - knots[:-1] + period / 2) % period - period / 2
    assert x.size > 0.7 * fem_comparison.POINTS
    assert np.all(np.abs(apart) > 0.09 * beside)


def test_every_scene_of_the_cases_is_one_the_reference_takes():
    for scene, _, changes in SCENES.values():
        assert fem_adapter.fem_arguments(adapters.scene(scene, changes))["period"] == 0.01


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_compliance_of_a_thin_layer_is_the_uniform_one(nu):
    thickness = 1e-3
    uniform = thickness * (1 - 2 * nu) * (1 + nu) / (1 - nu) or thickness**3  # incompressible: 4/3 (1 - nu^2) q^2 t^3
    assert layer_compliance(1.0, thickness, 1.0, nu) == pytest.approx(uniform, rel=5e-6)  # measured 1.8e-6, at 0.5
