"""The path without adhesion: one solution for each target, whatever came before, at any size of increment."""

import numpy as np
import pytest
from rough_surfaces import rough_scene

from bem.control import LinearControl, PenetrationControl
from bem.convex_path import ContactPoint, ConvexPath
from bem.problem import pose
from bem.solver import _path_for, solve

SCENE = rough_scene([40e-6], 30, 2, None)
PROBLEM = pose(SCENE, SCENE.surface())


def fresh(control=None):
    path = _path_for(SCENE, PROBLEM, _complete())
    assert isinstance(path, ConvexPath)
    return ConvexPath(
        path.elastic, control or PenetrationControl(), path.increments, path.complete, path.crests, path.effort
    )


def _complete():
    from bem.complete_contact import complete_contact

    return complete_contact(PROBLEM)


def reached(path, *values):
    point = ContactPoint("separated", -1.0)
    for value in values:
        *_, point = path.advance(point, value)
    return point


def same(one, other):
    np.testing.assert_allclose(one.state.patches.left, other.state.patches.left, rtol=0, atol=1e-10)
    assert one.state.load == pytest.approx(other.state.load, rel=1e-11)


@pytest.mark.parametrize("way", [(0.3, 1.0), (2.0, 1.0), (0.2, 1.8, 0.5, 1.0)], ids=str)
def test_the_way_does_not_matter(way):
    same(reached(fresh(), 1.0), reached(fresh(), *way))


def test_the_goal_takes_one_increment():
    path = fresh()
    points = list(path.advance(ContactPoint("separated", -1.0), 1.0))
    assert len(points) == 1
    assert (path.effort.accepted, path.effort.rejected) == (1, 0)


def test_first_touch_is_an_event_at_the_highest_crest():
    (event,) = reached(fresh(), 0.5).events
    assert (event.kind, event.value, event.load, event.energy_released) == ("first_touch", 0.0, 0.0, 0.0)
    assert PROBLEM.profile.height(np.array([event.position]))[0] == pytest.approx(PROBLEM.profile.max_height)


def test_later_contacts_are_no_events():
    path = fresh()
    point = reached(path, 0.2)
    (later,) = path.advance(point, 1.5)
    assert later.events == ()


def test_surfaces_part_at_zero():
    path = fresh()
    (apart,) = path.advance(reached(path, 0.5), -0.1)
    assert (apart.status, apart.state) == ("separated", None)


def test_load_control_meets_penetration_control():
    here = reached(fresh(), 1.0)
    same(here, reached(fresh(LinearControl(0.0, 1.0)), here.state.load))


def test_more_than_the_least_load_is_complete_contact():
    path = fresh(LinearControl(0.0, 1.0))
    assert reached(path, 1.01 * path.complete.least_load).status == "complete_contact"
    assert reached(path, 0.99 * path.complete.least_load).status == "converged"


def test_stiffness_is_the_slope_of_the_load():
    path, step = fresh(), 1e-4
    ahead, back = (reached(fresh(), 1.0 + shift).state.load for shift in (step, -step))
    assert path.assess(reached(path, 1.0)).stiffness == pytest.approx((ahead - back) / (2 * step), rel=1e-6)


@pytest.mark.parametrize("largest", [0.01, 0.05, 1.0])
def test_increments_do_not_matter(largest):
    changed = rough_scene([60e-6, 25e-6], 30, 2, None, accuracy={"max_increment": largest})
    usual = solve(rough_scene([60e-6, 25e-6], 30, 2, None)).targets
    assert [state.mean_pressure for state in solve(changed).targets] == [state.mean_pressure for state in usual]
