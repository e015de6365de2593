"""The adhesive path: Johnson's loop with its jumps under either control, work balance, and points on the way."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from rough_surfaces import rough_scene
from scene_tables import tables, waves
from scipy.integrate import quad
from scipy.optimize import brentq, minimize_scalar

from bem.adhesive.equilibrium import System
from bem.loading.complete_contact import complete_contact
from bem.loading.increments import Accuracy, Increments
from bem.loading.points_without_edges import Separated
from bem.path.jump import Jumps
from bem.path.path import Path
from bem.path.points_with_edges import Equilibrium
from bem.problem import pose
from bem.scene.scene import parse_scene
from bem.solver import solve

PERIOD, AMPLITUDE, MODULUS = 0.01, 1e-4, 4e6 / 3
FULL = np.pi * MODULUS * AMPLITUDE / PERIOD  # pressure p* of complete contact
FOLD = 1e-8  # relative; measured 4e-12 and, where it is to first order in psi, 3e-9, of the closed form's minimum
QUADRATURE = 1e-9  # of the closed form's energy


@dataclass(frozen=True)
class Johnson:
    """Johnson (1995): pressure, penetration and energy per area on the branch, psi = pi/2 contact fraction."""

    alpha: float

    @property
    def work_of_adhesion(self):
        return (self.alpha * FULL) ** 2 * PERIOD / (2 * MODULUS)

    def pressure(self, psi):
        return FULL * (np.sin(psi) ** 2 - self.alpha * np.sqrt(np.tan(psi)))

    def penetration(self, psi):
        S = np.sin(psi) ** 2
        return AMPLITUDE * (S * (1 - np.log(S)) + self.alpha * np.sqrt(np.tan(psi)) * np.log(S))

    def energy(self, psi):
        """Work of the load along the equilibrium branch from no contact, its first part being unstable."""

        def slope(u):  # dDelta/dpsi, with psi = u^2 to take the square root off
            p = u * u
            S, t = np.sin(p) ** 2, np.sqrt(np.tan(p))
            along = -np.sin(2 * p) * np.log(S)
            along += self.alpha * (np.log(S) / (2 * t * np.cos(p) ** 2) + 2 * t / np.tan(p))
            return self.pressure(p) * AMPLITUDE * along * 2 * u

        return quad(slope, 0, np.sqrt(psi), epsabs=0, epsrel=1e-11, limit=200)[0]

    def lowest(self, quantity):
        psi = np.linspace(1e-3, 1.2, 401)
        near = psi[np.argmin(quantity(psi))]
        return float(minimize_scalar(quantity, (near - 3e-3, near, near + 3e-3), options={"xtol": 1e-12}).x)

    def tables(self, targets, control="penetration", tolerance=1e-10, increment=0.05):
        accuracy = {"tolerance": tolerance, "max_increment": increment}
        return tables(waves([1], [AMPLITUDE]), control, map(float, targets), self.work_of_adhesion, accuracy=accuracy)

    def scene(self, *arguments, **named):
        return parse_scene(self.tables(*arguments, **named))


@pytest.fixture(scope="module", params=[0.1, 0.3, 0.5], ids=lambda alpha: f"alpha={alpha}")
def loop(request):
    """From first touch to contact fraction 0.95 and back beyond pull-off."""
    exact = Johnson(request.param)
    top, bottom = exact.penetration(0.95 * np.pi / 2), exact.penetration(exact.lowest(exact.penetration))
    back = np.linspace(top, bottom, 9)[1:-1]
    last = [bottom + 1e-3 * (top - bottom), bottom - 0.05 * top]
    return exact, solve(exact.scene([*np.linspace(0.02 * top, top, 8), *back, *last]))


def touching(result):
    states = [state for state in result.states if state.n_patches]
    return states, np.array([state.contact_fraction for state in states]) * np.pi / 2


def test_pressure_is_johnsons_on_the_whole_loop(loop):
    exact, result = loop
    states, psi = touching(result)
    error = np.abs([state.mean_pressure for state in states] - exact.pressure(psi)).max()
    assert error <= 1.5e-12 * FULL  # measured 6.3e-13 at alpha = 0.1; asked 1e-11


def test_penetration_is_johnsons_on_the_whole_loop(loop):
    exact, result = loop
    states, psi = touching(result)
    error = np.abs([state.penetration for state in states] - exact.penetration(psi)).max()
    assert error <= 6e-13 * AMPLITUDE  # measured 2.2e-13 at alpha = 0.5; asked 1e-11


def test_loop_reaches_far_with_few_unknowns(loop):
    exact, result = loop
    states, psi = touching(result)
    assert psi.max() * 2 / np.pi == pytest.approx(0.95, abs=1e-9)
    assert psi.min() < 1.3 * exact.lowest(exact.penetration)
    assert max(state.unknowns for state in states) <= 64  # 63


def test_loop_is_certified_and_ends_apart(loop):
    _, result = loop
    assert result.status == "converged"
    assert all(state.certificate.ok for state in result.states)
    assert result.targets[-1].status == "separated"
    assert [state.status for state in result.targets[:-1]] == ["converged"] * (len(result.targets) - 1)


def test_energy_is_johnsons_on_the_whole_loop(loop):
    exact, result = loop
    states, psi = touching(result)
    expected = [exact.energy(value) for value in psi]
    largest = np.abs(expected).max()
    found = [state.total_energy for state in states]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * largest)  # measured 1e-11, of the quadrature


def test_jumps_are_first_touch_and_pull_off_at_the_fold(loop):
    exact, result = loop
    assert [event.kind for event in result.events] == ["first_touch", "pull_off"]
    touch, pull_off = result.events
    assert touch.penetration == 0
    fold = exact.penetration(exact.lowest(exact.penetration))
    assert pull_off.penetration == pytest.approx(fold, rel=FOLD)
    assert pull_off.mean_pressure == pytest.approx(exact.pressure(exact.lowest(exact.penetration)), rel=FOLD)
    assert abs(pull_off.penetration - fold) <= pull_off.error_estimate.penetration + 1e-12 * AMPLITUDE


def test_jumps_release_johnsons_energy(loop):
    exact, result = loop
    touch, pull_off = result.events
    psi = brentq(exact.penetration, exact.lowest(exact.penetration), 1.2, xtol=1e-15)
    assert touch.energy_released == pytest.approx(-exact.energy(psi), rel=QUADRATURE)
    assert pull_off.energy_released == pytest.approx(exact.energy(exact.lowest(exact.penetration)), rel=QUADRATURE)


def test_pull_off_under_load_is_at_the_maximum_tension():
    exact = Johnson(0.3)
    most = exact.pressure(exact.lowest(exact.pressure))
    path, point = path_of(exact.scene([0.0], "mean_pressure"), 0.05)
    *_, loaded = path.advance(point, 0.5)
    points = list(path.advance(loaded, 2.0 * problem_of(exact).load_of(most)))
    assert points[-1].status == "separated"
    (event,) = [event for point in points for event in point.events]
    assert event.kind == "pull_off"
    assert event.at.value == pytest.approx(problem_of(exact).load_of(most), rel=FOLD)


def test_a_tension_beyond_the_maximum_is_unreachable():
    exact = Johnson(0.3)
    most = exact.pressure(exact.lowest(exact.pressure))
    result = solve(exact.scene([0.2 * FULL, 0.99 * most, 1.05 * most], "mean_pressure", 1e-6, increment=2.0))
    assert result.status == "unreachable"
    assert [state.status for state in result.targets] == ["converged", "converged", "unreachable"]
    psi = result.targets[1].contact_fraction * np.pi / 2
    assert result.targets[1].penetration == pytest.approx(exact.penetration(psi), abs=1e-9 * AMPLITUDE)


def test_load_control_jumps_to_complete_contact_at_the_maximum_pressure():
    exact = Johnson(0.3)
    psi = np.linspace(0.1, 1.57, 400_001)
    most = exact.pressure(psi).max()
    path, point = path_of(exact.scene([0.0], "mean_pressure"), 0.05)
    points = list(path.advance(point, 2.0 * problem_of(exact).load_of(most)))
    assert points[-1].status == "complete_contact"
    event = next(event for point in points for event in point.events if event.kind == "complete_contact")
    assert event.at.value == pytest.approx(problem_of(exact).load_of(most), rel=1e-9)  # of `most`
    assert event.energy_released > 0


@pytest.mark.parametrize(("control", "layer"), [("mean_pressure", None), ("total_displacement", 0.005)])
def test_adhesion_so_strong_that_first_touch_leads_into_complete_contact(control, layer):
    """Contact stays complete to the target; the jump releases all that complete contact has less energy."""
    exact = Johnson(30.0)
    targets = [0.1 * FULL, 0.2 * FULL] if layer is None else [1e-5, 2e-5]
    solid = {"youngs_modulus": 1e6, "poisson_ratio": 0.5 if layer is None else 0.3}
    tables = exact.tables(targets, control) | {"solid": solid}
    result = solve(parse_scene(tables | ({} if layer is None else {"layer": {"thickness": layer}})))
    assert result.status == "converged"
    assert [state.status for state in result.targets] == ["complete_contact"] * 2
    assert [getattr(state, control) for state in result.targets] == pytest.approx(targets, rel=1e-14)
    assert [event.kind for event in result.events] == ["first_touch", "complete_contact"]
    assert all((event.penetration, event.mean_pressure) == (0, 0) for event in result.events)
    state = result.targets[0]
    energy = state.total_energy
    if layer is None:
        assert energy == pytest.approx(FULL * AMPLITUDE / 4 - exact.work_of_adhesion, rel=1e-12)
    else:  # at no total displacement the layer is stretched by the penetration
        compliance = (state.total_displacement - state.penetration) / state.mean_pressure
        energy += AMPLITUDE**2 / (2 * compliance)
    assert result.events[0].energy_released == pytest.approx(-energy, rel=1e-12)


@pytest.mark.parametrize("slope_term", [False, True])
def test_the_last_gap_closes_at_one_place_at_any_increment(slope_term):
    """Where the pressure of complete contact is lowest; with the slope term in a trough, where least work closes it."""
    tables = Johnson(0.3).tables([AMPLITUDE])
    tables["profile"] |= {"orders": [1, 2], "amplitudes": [0.8 * AMPLITUDE, 0.1 * AMPLITUDE], "phases": [0.0, 1.0]}
    tables["adhesion"]["slope_term"] = slope_term
    x = np.linspace(0.0, 2 * np.pi, 1_000_001)
    sums = np.cos(x) * 0.8 + np.cos(2 * x + 1.0) * 0.1 * (1 if slope_term else 2)
    tables["loading"]["targets"] = [parse_scene(tables).surface().max_height]
    for increment in (0.2, 0.05):
        result = solve(parse_scene(tables | {"accuracy": {"max_increment": increment}}))
        (event,) = [event for event in result.events if event.kind == "complete_contact"]
        assert event.position == pytest.approx(x[np.argmin(sums)] / (2 * np.pi) * PERIOD, abs=2e-6 * PERIOD)


def problem_of(exact):
    scene = exact.scene([0.0])
    return pose(scene)


def test_first_touch_under_load_relaxes_at_zero_load():
    exact = Johnson(0.3)
    result = solve(exact.scene([0.0, 0.1 * FULL], "mean_pressure"))
    psi = result.targets[0].contact_fraction * np.pi / 2
    assert abs(exact.pressure(psi)) <= 1e-11 * FULL
    assert psi > exact.lowest(exact.pressure)
    assert result.targets[0].stable_at_fixed_load


@pytest.mark.parametrize("increment", [0.5, pytest.param(0.0125, marks=pytest.mark.slow)])
def test_increments_do_not_matter_on_johnsons_loop(increment):
    exact = Johnson(0.3)
    targets = exact.penetration(np.array([0.3, 0.9, 0.15]) * np.pi / 2)
    for state in solve(exact.scene(targets, increment=increment)).targets:
        psi = state.contact_fraction * np.pi / 2
        assert abs(state.penetration - exact.penetration(psi)) <= 1e-11 * AMPLITUDE


def path_of(scene, largest):
    """A path with accurate points in between, at its very beginning."""
    problem = pose(scene)
    positions, heights = problem.profile.crests
    path = Path(
        System(problem.elastic, problem.law, problem.control),
        Increments(
            largest, largest / 25, largest, Accuracy(1e-9, 1e-10), *2 * (Accuracy(1e-11, 1e-11),), deepest=largest
        ),
        positions[[np.argmax(heights)]],
        complete_contact(problem.profile, problem.law, problem.elastic.compliance),
    )
    return path, Separated(-1.0)


def rough_path(largest=0.01):
    return path_of(rough_scene([0.0], harmonics=30), largest)


@pytest.fixture(scope="module")
def rough_points():
    """Loading to 1.2 rms heights and back until apart."""
    path, point = rough_path()
    points = list(path.advance(point, 1.2))
    points += list(path.advance(points[-1], -1.0))
    return path, points


def hermite(first, second):
    """Work of the load between two points of a branch, with the exact slopes."""
    h = second.state.penetration - first.state.penetration
    bend = h * (first.balance.stiffness - second.balance.stiffness) / 12
    return h * ((first.state.load + second.state.load) / 2 + bend)


def test_path_has_events_of_all_kinds(rough_points):
    _, points = rough_points
    kinds = {event.kind for point in points for event in point.events}
    assert kinds >= {"first_touch", "new_contact", "detachment", "pull_off"}
    assert points[-1].status == "separated"


def test_work_of_the_load_is_the_growth_of_energy_between_events(rough_points):
    path, points = rough_points
    settled = [path.refine(p, 1.0) if p.state and not p.last else p for p in points]
    smooth = [
        (a, b)
        for a, b, q in zip(settled, settled[1:], points[1:], strict=False)
        if a.state and b.state and not (q.events or a.last or b.last) and far_from_a_fold(a, b)
    ]
    assert len(smooth) >= 50
    for first, second in smooth:
        growth = second.balance.energy - first.balance.energy
        bound = 6e-5 * abs(second.state.penetration - first.state.penetration)
        assert abs(growth - hermite(first, second)) <= bound  # measured 2.4e-5; loads are of order 1


def far_from_a_fold(first, second):
    """Whether the stiffness, which diverges at a fold, hardly changes between two points."""
    return abs(first.balance.stiffness - second.balance.stiffness) <= 0.1 * abs(first.balance.stiffness)


def test_events_release_energy(rough_points):
    _, points = rough_points
    released = [event.energy_released for point in points for event in point.events]
    assert min(released) >= 0
    assert max(released) > 0


def test_every_point_is_a_stable_equilibrium(rough_points):
    path, points = rough_points
    for point in points:
        if point.state is not None:
            assert point.balance.all_tensile
            if not point.last:
                refined = path.refine(point, 1.0)
                assert refined.balance.is_equilibrium(1e-10)
                assert refined.balance.smallest_eigenvalue > 0
                assert np.max(np.abs(refined.patches.left - point.patches.left)) <= 1e-3


def test_energy_before_an_event_is_above_that_after_it(rough_points):
    """U + work of the control - U after = released, from the two points themselves."""
    _, points = rough_points
    for first, second in pairwise(points):
        if second.events and first.state and second.state:
            before = first.balance.energy + (second.value - first.value) * first.state.load
            assert before - second.balance.energy >= -1e-3 * abs(second.value - first.value) * abs(first.state.load)


def test_restart_stands_where_the_path_stood(rough_points):
    path, points = rough_points
    point = path.refine(
        next(p for p in points if isinstance(p, Equilibrium) and p.state.patches.count >= 3 and not p.events), 1.0
    )
    again = path.restart(point.state.patches, point.state.penetration, point.value)
    np.testing.assert_allclose(again.state.patches.left, point.state.patches.left, atol=1e-11)


def test_restart_refuses_edges_that_are_no_equilibrium(rough_points):
    path, points = rough_points
    point = next(p for p in points if p.state and p.state.patches.count >= 3)
    wider = point.state.patches.moved(0.25 * point.state.patches.edge_scale)
    assert path.restart(wider, point.state.penetration, point.value).status == "not_converged"


def test_steps_are_counted(rough_points):
    path, points = rough_points
    assert path.effort.accepted >= sum(not (point.events or point.last) for point in points) - 1
    assert path.effort.rejected <= 0.05 * path.effort.accepted


def test_jumps_that_lead_back_for_ever_are_a_named_failure(monkeypatch):
    monkeypatch.setattr(
        Jumps, "from_touch", lambda jumps, touch: Equilibrium.of(touch.at.numbers.value, touch.at.balance)
    )
    result = solve(rough_scene([60e-6, 5e-6], 12, 1, 0.03))
    assert result.status == "not_converged"
    assert "the contact jumps again and again at" in result.failure or "no equilibrium was found" in result.failure


def test_no_end_of_a_branch_is_left_unlocated(rough_points):
    path, _ = rough_points
    assert path.effort.unlocated == 0


@pytest.mark.parametrize("work", [1e-2, 1e-8, 1e-14])
def test_faint_adhesion_takes_no_more_than_twice_the_steps(work):
    """K is as small as its root: steps whose predicted edges are not tensile are corrected like others."""
    scene = tables(waves([1, 3], [5e-5, 5e-6], [0.0, 1.0]), "separation", [2e-5, 5e-5], work)
    counts = []
    result = solve(parse_scene(scene), progress=lambda now: counts.append(now.evaluations))
    assert result.status == "converged"
    assert max(counts) < 400  # measured 147, 186, 245; 5395 where edges had to be tensile


def test_a_state_stored_beside_a_fold_is_a_stable_one():
    """A Newton step of 0.01 from it stiffness is .36, and at the point itself it is -.03: the step is tried again."""
    scene = rough_scene([6e-5, 2e-5, 8e-5, 1.5e-4], 60, seed=0)
    assert [state.status for state in solve(scene).targets] == ["converged"] * 3 + ["separated"]
