"""The path without adhesion: one solution for each target, whatever came before, at any size of increment."""

from dataclasses import replace

import numpy as np
import pytest
from rough_surfaces import rough_scene

from bem.loading.complete_contact import complete_contact
from bem.loading.control import DisplacementControl, LoadControl
from bem.loading.points_without_edges import Separated
from bem.nonadhesive.convex_path import ConvexPath
from bem.path_for import path_for
from bem.problem import pose
from bem.solver import solve

SCENE = rough_scene([40e-6], 30, 2, None)
PROBLEM = pose(SCENE)


def fresh(control=None):
    path = path_for(SCENE, PROBLEM, _complete())
    assert isinstance(path, ConvexPath)
    return ConvexPath(
        path.elastic, control or DisplacementControl(), path.increments, path.body, path.crests, None, path.effort
    )


def _complete():
    return complete_contact(PROBLEM.profile, PROBLEM.law, PROBLEM.elastic.compliance)


def reached(path, *values):
    point = Separated(-1.0)
    for value in values:
        *_, point = path.advance(point, value)
    return point


def test_first_touch_is_an_event_at_the_highest_crest():
    (event,) = reached(fresh(), 0.5).events
    assert (event.kind, event.at.value, event.at.load, event.energy_released) == ("first_touch", 0.0, 0.0, 0.0)
    assert PROBLEM.profile.height(np.array([event.position]))[0] == pytest.approx(PROBLEM.profile.max_height)


@pytest.mark.parametrize("control", [DisplacementControl(), LoadControl()], ids=["penetration", "load"])
@pytest.mark.parametrize("stops", [(), (0.3, 0.9)], ids=["at once", "in steps"])
def test_complete_contact_is_an_event_where_the_last_gap_closes(control, stops):
    """Westergaard's last gap closes at the mean pressure and the penetration of complete contact, at the trough."""
    scene = rough_scene([0.0], 1, 2, None)
    problem = pose(scene)
    path = replace(
        path_for(scene, problem, complete_contact(problem.profile, problem.law, problem.elastic.compliance)),
        control=control,
    )
    highest = problem.profile.max_height
    last = control.value(highest, 2 * np.pi * highest)
    point, events = Separated(-1.0), []
    for value in (*(stop * last for stop in stops), last * 1.5 if control.load_weight else last):
        *_, point = path.advance(point, value)
        events += point.events
    assert [event.kind for event in events] == ["first_touch", "complete_contact"]
    at = events[1].at
    assert (at.value, at.penetration, at.load) == pytest.approx((last, highest, 2 * np.pi * highest), rel=1e-14)
    trough = (np.pi - problem.profile.phases[0]) % (2 * np.pi)
    assert events[1].position == pytest.approx(trough, abs=1e-9)
    assert events[1].energy_released == 0


@pytest.mark.parametrize("roundings", [-3, -1, 0, 1])
def test_penetration_of_complete_contact_is_that_whatever_rounding_does(roundings):
    highest = PROBLEM.profile.max_height
    value = highest * (1 + roundings * np.finfo(float).eps)
    assert fresh().at(value).status == "complete_contact"
    assert fresh().at(value, 1e-30).status == "converged"  # a separation is known to its last digit


def test_stiffness_is_the_slope_of_the_load():
    path, step = fresh(), 1e-4
    ahead, back = (reached(fresh(), 1.0 + shift).state.load for shift in (step, -step))
    assert path.assess(reached(path, 1.0)).stiffness == pytest.approx((ahead - back) / (2 * step), rel=1e-6)


@pytest.mark.parametrize("largest", [0.01, 0.05, 1.0])
def test_increments_do_not_matter(largest):
    changed = rough_scene([60e-6, 25e-6], 30, 2, None, accuracy={"max_increment": largest})
    usual = solve(rough_scene([60e-6, 25e-6], 30, 2, None)).targets
    assert [state.mean_pressure for state in solve(changed).targets] == [state.mean_pressure for state in usual]


# Mean pressures on the way: the same curve forth and back


def met(targets, pressures, **changes):
    loading = {"control": "separation", "targets": targets, "at_mean_pressures": pressures} | changes
    return solve(rough_scene([], 30, 2, None, loading=loading))


@pytest.mark.parametrize("last", [60e-6, 1.0], ids=["still in contact", "apart"])
def test_pressures_are_met_on_the_way_back_in_the_same_states(last):
    states = met([25e-6, last], [6000.0, 3000.0]).targets
    pressures, branches = zip(*((state.mean_pressure, state.branch) for state in states), strict=True)
    assert pressures[:2] == pytest.approx((3000.0, 6000.0), rel=1e-12)
    assert pressures[3:5] == pytest.approx((6000.0, 3000.0), rel=1e-12)
    assert branches == ("loading",) * 3 + ("unloading",) * 3
    forth, back = states[:2], states[3:5][::-1]
    assert [state.edges for state in forth] == [state.edges for state in back]
    assert [state.separation for state in forth] == [state.separation for state in back]


def test_every_leg_meets_a_pressure_once():
    states = met([40e-6, 25e-6, 60e-6, 25e-6], [3000.0]).targets
    assert sum(state.mean_pressure == pytest.approx(3000.0, rel=1e-12) for state in states) == 3


def test_pressures_up_to_complete_contact_are_met():
    """The last state before contact is complete carries next to the least load that completes it."""
    below = 0.99 * PROBLEM.mean_pressure(_complete().least_load)
    states = met([25e-6, 0.0, 25e-6], [below]).targets
    assert [state.status for state in states] == ["converged"] * 2 + ["complete_contact"] + ["converged"] * 2
    assert states[1].mean_pressure == pytest.approx(below, rel=1e-12)
    assert states[1].edges == states[3].edges


@pytest.mark.parametrize("kept", [1, 2, 3, 4, 5])
def test_resumption_knows_which_pressures_were_met(kept):
    loading = {"control": "separation", "targets": [25e-6, 60e-6], "at_mean_pressures": [3000.0, 6000.0]}
    scene = rough_scene([], 30, 2, None, loading=loading)
    whole = solve(scene)
    half = replace(whole, states=whole.states[:kept], status="interrupted")
    again = solve(scene, resume=half)
    assert [state.edges for state in again.states] == [state.edges for state in whole.states]


@pytest.mark.parametrize(
    ("initial", "goal", "pressures"),
    [("separated", 1e-6, [1500.0, 3000.0]), ("complete_contact", 85e-6, [3000.0, 1500.0])],
    ids=["on", "off"],
)
def test_what_lies_behind_the_pressure_at_which_a_path_stops_is_not_solved(initial, goal, pressures):
    loading = {"control": "separation", "targets": [goal], "initial": initial, "at_mean_pressures": [1500.0, 3000.0]}
    through = solve(rough_scene([], 30, 2, None, loading=loading))
    solved = []
    stop = loading | {"stop_at_mean_pressure": pressures[1]}
    stopped = solve(rough_scene([], 30, 2, None, loading=stop), progress=solved.append)
    assert [state.mean_pressure for state in stopped.states] == pytest.approx(pressures, rel=1e-12)
    assert [state.edges for state in stopped.states] == [state.edges for state in through.states[:2]]
    assert [point.mean_pressure for point in solved] == [stopped.states[1].mean_pressure]
