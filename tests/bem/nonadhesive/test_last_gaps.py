"""The last gaps before complete contact: closed form, both discretisations, every control, gaps that close in turn."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import scene_tables
from scene_tables import rough

from bem.geometry.gaps import Gaps, gaps_of
from bem.geometry.profile import Profile
from bem.loading.complete_contact import CompleteContact, complete_contact
from bem.nonadhesive.completed_body import CompletedBody, LinearControl
from bem.nonadhesive.last_gaps import isolated_cracks, solve_gaps
from bem.path_for import path_for
from bem.problem import pose
from bem.scene.scene import parse_scene
from bem.solver import solve

PERIOD, AMPLITUDE, MODULUS = 0.01, 1e-4, 1e6 / 0.75
HIGHEST = np.pi * MODULUS * AMPLITUDE / PERIOD  # Westergaard's p*, Pa


def scene_of(profile, control="mean_pressure", targets=(1.0,), layer=None, nu=0.5):
    return parse_scene(scene_tables.tables(profile, control, targets, thickness=layer, nu=nu))


def waves(orders, phases):
    return scene_tables.waves(orders, [AMPLITUDE] * len(orders), phases)


def body_of(scene):
    problem = pose(scene)
    complete = complete_contact(problem.profile, problem.law, problem.elastic.compliance)
    return problem, CompletedBody(complete, problem.profile.max_height, problem.compliance_ratio)


def found_at(body, deficit):
    condition = LinearControl(0.0, 1.0, 2 * np.pi * deficit)
    return solve_gaps(body, condition, isolated_cracks(body, condition))


ONE = waves([1], [0.4])
SCENES = {
    "equal gaps": (waves([1, 2], [0.0, 0.0]), None, 0.5),
    "different gaps": (waves([1, 2], [0.0, 0.7]), None, 0.5),
    "orders 2 and 3": (waves([2, 3], [0.0, 0.0]), None, 0.5),
    "10 harmonics": (rough(10, 0), None, 0.5),
    "100 harmonics": (rough(100, 1), None, 0.5),
    "thin layer": (waves([1, 2], [0.0, 0.7]), 0.05 * PERIOD, 0.5),
    "thin compressible layer": (waves([1, 2], [0.0, 0.0]), 0.05 * PERIOD, 0.3),
    "layer": (rough(10, 0), PERIOD, 0.3),
}
BY_SCENE = pytest.mark.parametrize("name", SCENES, ids=lambda name: name.replace(" ", "_"))


@pytest.mark.parametrize("deficit", [0.3, 1e-2, 1e-4, 1e-8, 1e-12], ids=str)
def test_one_wave_is_westergaards(deficit):
    """p = p* cos^2(b/2), s = D (1 - S + S ln S), b half the gap; S = 1 - deficit, and as a series where it is small."""
    body = body_of(scene_of(ONE))[1]
    state = found_at(body, deficit * np.sqrt(2)).state
    k = np.arange(2, 60)
    separation = np.sqrt(2) * float(np.sum(deficit**k / (k * (k - 1.0))))
    assert state.gaps.half_width[0] == pytest.approx(2 * np.arcsin(np.sqrt(deficit)), rel=3e-15)  # measured 6e-16
    assert state.separation == pytest.approx(separation, rel=5e-14)  # measured 1.4e-14


@BY_SCENE
@pytest.mark.parametrize("deficit", [0.3, 0.03], ids=str)
def test_unknowns_in_gaps_and_on_patches_agree(name, deficit):
    profile, layer, nu = SCENES[name]
    scene = scene_of(profile, layer=layer, nu=nu)
    problem, body = body_of(scene)
    path = path_for(scene, problem, body.complete)
    by_patches = path.at(2 * np.pi * body.lowest * (1 - deficit)).state
    by_gaps = solve_gaps(body, LinearControl(0.0, 1.0, 2 * np.pi * body.lowest * deficit), gaps_of(by_patches.patches))
    state = by_gaps.state
    assert not hasattr(by_patches, "gaps")
    assert state.patches.count == by_patches.patches.count
    fraction = by_patches.patches.contact_fraction
    assert state.patches.contact_fraction == pytest.approx(fraction, abs=5e-11)  # measured 2.1e-11, of the patches
    assert state.penetration == pytest.approx(by_patches.penetration, abs=5e-13)  # measured 1.4e-13, of the patches
    assert state.elastic_energy == pytest.approx(by_patches.elastic_energy, rel=2e-12)  # measured 4e-13
    assert state.load_rate == pytest.approx(by_patches.load_rate, rel=1e-8)  # measured 3.7e-9


@pytest.mark.parametrize("deficit", [1e-4, 1e-8, 1e-12], ids=str)
@BY_SCENE
def test_next_to_complete_contact_every_gap_is_an_isolated_crack(name, deficit):
    profile, layer, nu = SCENES[name]
    body = body_of(scene_of(profile, layer=layer, nu=nu))[1]
    condition = LinearControl(0.0, 1.0, 2 * np.pi * body.lowest * deficit)
    cracks = isolated_cracks(body, condition)
    state = found_at(body, body.lowest * deficit).state
    assert state.gaps.count == cracks.count
    # terms left out: a^2 times the fourth derivative over the curvature, measured 150 times the deficit at most
    np.testing.assert_allclose(state.gaps.half_width, cracks.half_width, rtol=400 * deficit + 1e-13)


@BY_SCENE
def test_loads_and_separations_lead_to_the_same_states_down_to_the_last_digits(name):
    profile, layer, nu = SCENES[name]
    scene = scene_of(profile, layer=layer, nu=nu)
    problem, body = body_of(scene)
    complete = problem.mean_pressure(body.complete.least_load)
    deficits = np.array([1e-3, 1e-6, 1e-9, 1e-12])
    by_load = solve(scene_of(profile, "mean_pressure", complete * (1 - deficits), layer, nu))
    separations = [state.separation for state in by_load.targets]
    by_separation = solve(scene_of(profile, "separation", separations, layer, nu))
    for one, other, deficit in zip(by_load.targets, by_separation.targets, deficits, strict=True):
        assert (one.status, other.status) == ("converged", "converged")
        assert one.certificate.ok and other.certificate.ok
        assert one.n_patches == other.n_patches
        assert other.mean_pressure == pytest.approx(
            one.mean_pressure, abs=1e-12 * deficit * complete + 2e-16 * complete
        )
        assert other.separation == pytest.approx(one.separation, rel=1e-15)
        assert other.branch == "loading"


def test_separations_that_are_the_same_penetration_are_told_apart():
    targets = [1e-24, 1e-27, 1e-24]
    states = solve(scene_of(ONE, "separation", targets)).targets
    assert [state.separation for state in states] == pytest.approx(targets, rel=1e-15)
    assert states[0].contact_fraction < states[1].contact_fraction
    assert [state.branch for state in states] == ["loading", "loading", "unloading"]
    assert states[0].edges == states[2].edges


@pytest.mark.parametrize("deficit", [1e-4, 1e-8, 1e-12], ids=str)
@pytest.mark.parametrize("control", ["mean_pressure", "penetration"])
def test_estimated_errors_hold_the_true_ones(control, deficit):
    share = 1 - deficit
    k = np.arange(2, 60)
    separation = AMPLITUDE * float(np.sum(deficit**k / (k * (k - 1.0))))
    target = HIGHEST * share if control == "mean_pressure" else AMPLITUDE - separation
    state = solve(scene_of(ONE, control, [target])).targets[0]
    if state.status == "complete_contact":  # a penetration that is rounded to complete contact
        assert control == "penetration" and separation < 1e-16 * AMPLITUDE
        return
    estimate = state.error_estimate
    gap = 4 * np.arcsin(np.sqrt(deficit)) / (2 * np.pi)
    assert abs(1 - state.contact_fraction - gap) <= estimate.contact_fraction
    assert abs(state.separation - separation) <= estimate.separation
    assert abs(state.mean_pressure - HIGHEST * share) <= estimate.mean_pressure
    assert estimate.contact_fraction <= (0.02 if control == "mean_pressure" else 1e9) * gap


@pytest.mark.parametrize("share", [1e-4, 1e-7, 1e-9, 1e-10], ids=str)
def test_a_gap_that_closes_beside_wider_ones_is_kept_to_its_end(share):
    """Of two gaps of orders 1 and 2 one closes first; its width grows with the root of the load that is missing."""
    scene = scene_of(waves([1, 2], [0.0, 0.7]))
    problem, body = body_of(scene)
    path = path_for(scene, problem, body.complete)
    closes = 0.7219628239302337 * 2 * np.pi * body.lowest
    point = path.at(closes * (1 - share))
    assert point.status == "converged"
    assert point.state.patches.count == 2
    assert point.state.patches.gap_after.min() == pytest.approx(1.9637 * np.sqrt(share), rel=1e-3)  # measured 2e-4
    assert path.at(closes * (1 + share)).state.patches.count == 1


def test_a_gap_is_added_where_contact_is_under_tension():
    body = body_of(scene_of(waves([1, 2], [0.0, 0.0])))[1]
    condition = LinearControl(0.0, 1.0, 2 * np.pi * body.lowest * 1e-9)
    cracks = isolated_cracks(body, condition)
    first = cracks.kept(np.array([True, False]))
    state = solve_gaps(body, condition, first).state
    np.testing.assert_allclose(
        state.gaps.half_width, found_at(body, body.lowest * 1e-9).state.gaps.half_width, rtol=1e-6
    )


def test_gaps_across_a_crest_are_cut_and_gaps_that_nothing_opens_vanish():
    body = body_of(scene_of(waves([1, 2], [0.0, 0.0])))[1]
    condition = LinearControl(0.0, 1.0, 2 * np.pi * body.lowest * 0.02)
    expected = found_at(body, body.lowest * 0.02).state.gaps
    middle = float(expected.center.mean())
    across = Gaps(np.array([middle]), np.zeros(1), np.array([np.ptp(expected.center) / 2 + 0.05]))
    beside = Gaps(np.array([0.0]), np.zeros(1), np.array([0.01]))
    for start in (across, expected.joined(beside)):
        found = solve_gaps(body, condition, start).state.gaps
        np.testing.assert_allclose(found.half_width, expected.half_width, rtol=1e-9)


def test_work_and_stiffness_are_derivatives_of_the_energy():
    """dU/ds = -2 pi p_0 at K = 0, and d(load)/dDelta by differences of states."""
    body = body_of(scene_of(rough(10, 0)))[1]
    at, step = 0.05 * body.lowest, 1e-4 * body.lowest
    back, here, ahead = (found_at(body, at + shift).state for shift in (-step, 0.0, step))
    energy, apart = ahead.elastic_energy - back.elastic_energy, ahead.separation - back.separation
    assert energy / apart == pytest.approx(-2 * np.pi * here.mean_pressure, rel=1e-6)  # measured 2e-7
    assert (back.load - ahead.load) / apart == pytest.approx(here.load_rate, rel=1e-4)  # measured 3e-5


def test_the_pressure_as_series_on_patches_is_the_same():
    body = body_of(scene_of(waves([1, 2], [0.0, 0.7])))[1]
    state = found_at(body, 1e-6 * body.lowest).state
    pressure = state.pressure()
    assert pressure.load == pytest.approx(state.load, rel=1e-13)
    t = 0.3
    x = (pressure.left[0] + pressure.right[0]) / 2 + t * (pressure.right[0] - pressure.left[0]) / 2
    series = np.polynomial.chebyshev.chebval(t, pressure.charges[0]) / np.sqrt(1 - t * t)
    expected = state.mean_pressure + body.pressure.height(x) + state.added(0, np.array([np.arccos(-t)]))[0]
    assert series / ((pressure.right[0] - pressure.left[0]) / 2) == pytest.approx(expected, rel=1e-12)


def test_gaps_too_many_to_resolve_are_named():
    """A wave of order 600 has as many equal gaps, of a dozen unknowns at least."""
    scene = scene_of(waves([600], [0.0]))
    problem, body = body_of(scene)
    path = path_for(scene, problem, body.complete)
    assert path.at(2 * np.pi * body.lowest * (1 - 1e-9)).status == "ill_conditioned"


def test_no_deficit_is_no_gap():
    body = body_of(scene_of(ONE))[1]
    assert found_at(body, 0.0).status == "closed"


def test_a_path_resumes_at_the_last_gap():
    scene = scene_of(ONE, "separation", [1e-20, 1e-24, 1e-26])
    whole = solve(scene)
    half = replace(whole, states=whole.states[:2], status="interrupted")
    assert [state.edges for state in solve(scene, resume=half).states] == [state.edges for state in whole.states]


def test_the_pressure_of_complete_contact_is_summed_without_rounding_of_its_phases():
    """Order 500,001: the reference reduces the phase with rational numbers, 2 pi to 40 digits."""
    turn = 2 * Fraction("3.141592653589793238462643383279502884197")
    order, phase, x = 500_001, 0.7, np.array([1.2345678, 5.4321])
    pressure = Profile.from_harmonics(2 * np.pi, [order], [1.0], [phase])
    body = CompletedBody(CompleteContact(pressure, 0.0, 0.0, 0.0), 1.0)
    expected = [math.cos(float((order * Fraction(at) + Fraction(phase)) % turn)) for at in x.tolist()]
    np.testing.assert_allclose(body.at_anchor(x), expected, rtol=0, atol=1e-15)  # measured 2e-16; plain products 3e-10


@pytest.mark.parametrize("turn", [0.0, -1.1], ids=["within", "across the ends of the period"])
def test_gaps_that_overlap_become_one_and_others_stay(turn):
    one, overlapping, apart = (
        Gaps(np.array([place + turn]) % (2 * np.pi), np.zeros(1), np.array([0.2])) for place in (1.0, 1.3, 3.0)
    )
    found = one.joined(apart).joined(overlapping)
    united = np.argmax(found.half_width)
    assert found.half_width[united] == pytest.approx(0.35, rel=1e-14)
    assert found.center[united] % (2 * np.pi) == pytest.approx((1.15 + turn) % (2 * np.pi), rel=1e-14)
    assert np.delete(found.half_width, united).tolist() == [0.2]
