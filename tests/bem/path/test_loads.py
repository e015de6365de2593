"""The state between two points at which the load has a given value, and the loads that an event jumps over."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from judges import Sinusoid
from rough_surfaces import rough_scene
from scene_tables import tables, waves

from bem.loading.complete_contact import complete_contact
from bem.loading.points_without_edges import Separated
from bem.path_for import path_for
from bem.problem import pose
from bem.scene.scene import parse_scene
from bem.solver import solve


def start(adhesion, harmonics=20):
    loading = {"control": "separation", "targets": [40e-6], "at_mean_pressures": [1e3]}
    posed = rough_scene([], harmonics, 1, adhesion, loading=loading)
    problem = pose(posed)
    path = path_for(posed, problem, complete_contact(problem.profile, problem.law, problem.elastic.compliance))
    return path, Separated(-1.0)


def points_to(adhesion, value, harmonics=20):
    path, point = start(adhesion, harmonics)
    return path, [p for p in path.advance(point, value) if p.state is not None]


@pytest.fixture(scope="module")
def adhesive():
    return points_to(0.03, 1.2)


def smooth_pair(points):
    return next((a, b) for a, b in pairwise(points[5:]) if not (b.events or b.last))


@pytest.mark.parametrize("share", [0.0, 0.3, 0.999])
def test_the_load_is_met_on_a_smooth_branch(adhesive, share):
    path, points = adhesive
    before, after = smooth_pair(points)
    load = (1 - share) * before.load + share * after.load
    found = path.at_load(before, after, load)
    assert abs(found.state.load - load) <= 1e-9 * max(abs(load), 1e-3)
    assert min(before.value, after.value) <= found.value + 1e-9
    assert found.value <= max(before.value, after.value) + 1e-9


@pytest.mark.parametrize("share", [1e-9, 1e-5, 1 - 1e-5, 1.0])
def test_a_load_next_to_a_point_is_met(adhesive, share):
    """Points are less accurate than the load asked for, which may lie a little beyond them, but not beyond a fold."""
    path, points = adhesive
    for before, after in pairwise(points[5:25]):
        if not after.events and (share < 1 or not after.last):
            load = (1 - share) * before.load + share * after.load
            assert path.at_load(before, after, load).state.load == pytest.approx(load, rel=1e-9)


def test_the_load_is_met_without_adhesion():
    path, point = start(None)
    (there,) = path.advance(point, 1.2)
    found = path.at_load(point, there, 0.5 * there.state.load)
    assert found.state.load == pytest.approx(0.5 * there.state.load, rel=1e-12)
    assert found.value == found.state.penetration < there.value


def test_a_load_outside_is_not_found(adhesive):
    path, points = adhesive
    before, after = smooth_pair(points)
    beyond = max(before.load, after.load) + abs(after.load - before.load)
    assert path.at_load(before, after, beyond) is None


@pytest.mark.parametrize("share", [0.1, 0.9, 0.999, 1 - 1e-6])
def test_loads_are_met_up_to_the_end_of_a_branch(adhesive, share):
    path, points = adhesive
    pairs = [(a, b) for a, b in pairwise(points) if b.last]
    assert len(pairs) > 5
    for before, after in pairs:
        load = (1 - share) * before.load + share * after.load
        found = path.at_load(before, after, load)
        assert found.state.load == pytest.approx(load, rel=1e-9)
        low, high = sorted((before.value, after.value))
        assert low - 2e-10 <= found.value <= high + 2e-10  # measured 6e-11: evaluations of other resolutions


@pytest.mark.parametrize("shift", [-3.0, 3.0], ids=["tension", "compression"])
@pytest.mark.parametrize("sign", [1.0, -1.0], ids=["largest", "least"])
def test_a_load_beyond_both_ends_is_looked_for_twice_as_far_as_the_load_turns(adhesive, shift, sign):
    """It goes from one of two equal ends by 1, and back."""
    loads, ends, rates = adhesive[0].loads, (shift, shift), (4 * sign, -4 * sign)
    asked = [replace(loads, asked=(shift + sign * beyond,)) for beyond in (-0.1, 0.1, 1.9, 2.1)]
    assert [some._may_pass(ends, rates) for some in asked] == [False, True, True, False]


@pytest.mark.parametrize("short", [1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("increment", [0.05, 0.015])
def test_loads_a_little_short_of_their_extremum_are_met(short, increment):
    """On Johnson's branch the tension is largest at penetrations that are stable; it was missed from 1e-3 on."""
    wave = Sinusoid(1e-4, 0.01, 1e6, 0.5, 0.3)
    psi = np.linspace(0.05, 1.2, 400_001)
    most = float(np.min(wave.mean_pressure(psi)))
    wanted = (1 - short) * most
    way = {"at_mean_pressures": [wanted], "accuracy": {"max_increment": increment}}
    scene = tables(waves([1], [1e-4]), "penetration", [3e-5, -3e-5], wave.work_of_adhesion, **way)
    met = [state.mean_pressure for state in solve(parse_scene(scene)).targets]
    assert sum(abs(pressure / wanted - 1) <= 1e-9 for pressure in met) == 1


def test_the_state_beside_events_does_not_depend_on_the_increment():
    """Several events lie within an increment here."""
    path, points = points_to(0.03, 1.131, harmonics=300)
    inc = path.increments
    fine = replace(path, increments=replace(inc, largest=inc.largest / 10, deepest=inc.deepest / 10))
    start = next(point for point in points if point.value > 1.12 and not point.last)
    behind = points[points.index(start) :]
    close = [start, *fine.advance(start, points[-1].value)]
    loads = [point.load for point in close]
    for load in np.linspace(min(loads), max(loads), 7)[1:-1]:
        found, expected = (first_met(some, points, load) for some, points in ((path, behind), (fine, close)))
        assert found.state.patches.contact_fraction == pytest.approx(expected.state.patches.contact_fraction, abs=1e-9)


def first_met(path, points, load):
    pairs = [(a, b) for a, b in pairwise(points) if path.may_meet(a, b, load)]
    met = [path.at_load(a, b, load) for a, b in pairs]
    return next(found for found in met if found is not None)


@pytest.mark.parametrize("adhesion", [None, 0.03], ids=["bare", "adhesive"])
def test_a_path_stops_at_a_mean_pressure(adhesion):
    loading = {"control": "separation", "targets": [25e-6], "stop_at_mean_pressure": 3000.0}
    met = solve(rough_scene([], 20, 1, adhesion, loading=loading)).targets
    assert [state.mean_pressure for state in met] == pytest.approx([3000.0], rel=1e-9)


def test_pressures_before_the_first_target_are_met_from_first_touch():
    wanted = [1e-3, 10.0, 3000.0]
    loading = {"control": "separation", "targets": [25e-6], "at_mean_pressures": wanted}
    met = solve(rough_scene([], 20, 1, None, loading=loading)).targets
    held = solve(rough_scene(wanted, 20, 1, None, "mean_pressure")).targets
    assert [state.mean_pressure for state in met[:3]] == pytest.approx(wanted, rel=1e-6)
    for state, other in zip(met, held, strict=False):
        assert abs(state.contact_fraction - other.contact_fraction) <= 1e-9


def test_loads_within_the_last_gap_are_met():
    """Complete contact opens under a tension without bound, and the first increment passes many loads."""
    pressures = [5e4, 2e4]
    loading = {"control": "separation", "initial": "complete_contact", "at_mean_pressures": pressures}
    results = [
        solve(
            rough_scene([40e-6], 5, 1, 0.05, loading=loading | {"targets": [40e-6]}, accuracy={"max_increment": size})
        )
        for size in (0.05, 0.005)
    ]
    for pressure in pressures:
        met = [next(s for s in r.targets if s.mean_pressure == pytest.approx(pressure, rel=1e-9)) for r in results]
        assert met[0].contact_fraction == pytest.approx(met[1].contact_fraction, abs=1e-9)
        assert met[0].contact_fraction > 0.9
