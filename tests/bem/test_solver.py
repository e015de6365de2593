"""Whole scenes: convergence of the path, energy balance, interruption and resumption."""

import json
from dataclasses import asdict, replace
from functools import cache, partial

import numpy as np
import pytest
from rough_surfaces import rough_scene

from bem import Adhesion, Solid, solver
from bem.scene.result import asked_for
from bem.scene.scene_tables import OUTPUTS
from bem.solver import solve

TARGETS = [70e-6, 50e-6, 35e-6, 60e-6, 90e-6]


@pytest.fixture(scope="module")
def rough():
    return solve(rough_scene(TARGETS))


def touching(result):
    return [state for state in result.targets if state.n_patches]


def test_adhesion_makes_unloading_differ_from_loading(rough):
    back = solve(rough_scene([60e-6])).targets[0]
    assert touching(rough)[-1].contact_fraction > 1.05 * back.contact_fraction


def halves(scene, increments, hindered=lambda progress: progress):
    """The result of a path that is interrupted after so many increments, and that of its resumption.

    `hindered` makes another progress function of one.
    """
    seen = []

    def stop(progress):
        seen.append(progress)
        if len(seen) == increments:
            raise KeyboardInterrupt

    half = solve(scene, progress=hindered(stop))
    assert half.status == "interrupted"
    return half, solve(scene, resume=half, progress=hindered(seen.append))


def numbers(state):
    """All of a state but the seconds it took, NaN equal to itself."""
    return json.dumps(asdict(replace(state, cpu_seconds=0.0)))


@pytest.mark.parametrize("name", ["separation", "met pressures", "load"])
def test_every_state_at_a_target_names_it_and_no_other_does(name):
    result = solve(rough_scene([], 12, loading=RESUMED[name]))
    assert [state.index is not None for state in result.states] == [state.target for state in result.states]
    count = len(RESUMED[name]["targets"])
    assert [state.index for state in result.targets if state.index < count] == list(range(count))
    for state in result.targets:
        control, value = asked_for(result.scene["loading"], state.index)
        assert getattr(state, control) == pytest.approx(value, rel=1e-9)
    if name == "met pressures":
        assert {state.index for state in result.targets} == {0, 1, 2, 3}


@pytest.mark.parametrize(
    "loading",
    [
        {"control": "separation", "targets": [60e-6, 30e-6, 80e-6], "at_mean_pressures": [500.0]},
        {"control": "penetration", "targets": [3e-5, 5e-5, 2e-5]},
        {"control": "mean_pressure", "targets": [800.0, 300.0, 500.0]},
    ],
    ids=lambda loading: loading["control"],
)
@pytest.mark.parametrize("adhesion", [None, 0.03], ids=["without adhesion", "with adhesion"])
def test_no_output_changes_the_path(loading, adhesion):
    changes = {"adhesion": adhesion, "loading": loading}
    bare = solve(rough_scene([], 12, **changes))
    for asked in (True, loading["targets"][:2]):
        full = solve(rough_scene([], 12, output=dict.fromkeys(OUTPUTS, asked), **changes))
        assert set(full.fields) >= {"x_0", "C_sigma_1", "sigma_0"}
        assert [numbers(replace(state, stored=None)) for state in full.states] == [*map(numbers, bare.states)]
        assert (full.events, full.largest_tension, full.status) == (bare.events, bare.largest_tension, bare.status)


RESUMED = {
    "separation": {"control": "separation", "targets": TARGETS},
    "met pressures": {"control": "separation", "targets": [30e-6, 60e-6], "at_mean_pressures": [500.0, 3000.0]},
    "load": {"control": "mean_pressure", "targets": [300.0, 800.0, -30.0]},
    "apart": {"control": "separation", "targets": [40e-6, 400e-6, 40e-6]},
    "joined": {"control": "separation", "targets": [20e-6, 0.0, 20e-6, 60e-6]},
}


@pytest.fixture(scope="module")
def unbroken():
    """The path of a scene that is interrupted, without interruption, and its number of increments; solved once."""

    @cache
    def whole(name):
        counts = []
        return solve(resumed_scene(name), progress=counts.append), len(counts)

    return whole


def resumed_scene(name):
    output = {"shapes": RESUMED[name]["targets"][:2], "spectra": True}
    return rough_scene([], harmonics=12, loading=RESUMED[name], output=output)


@pytest.mark.parametrize("share", [0.2, pytest.param(0.5, marks=pytest.mark.slow), 0.9])
@pytest.mark.parametrize("name", RESUMED)
def test_resumption_ends_the_same_bit_for_bit(unbroken, name, share):
    whole, increments = unbroken(name)
    half, resumed = halves(resumed_scene(name), max(1, int(share * increments)))
    free = [[numbers(state) for state in result.states] for result in (resumed, whole, half)]
    assert free[0] == free[1]
    assert free[2] == free[1][: len(half.states)]
    assert repr((resumed.events, resumed.status)) == repr((whole.events, whole.status))  # NaN equals itself
    assert sorted(resumed.fields) == sorted(whole.fields)
    for field, values in whole.fields.items():
        np.testing.assert_array_equal(resumed.fields[field], values)


def test_resumption_computes_nothing_up_to_the_last_target_again(rough):
    counts = []
    half, _ = halves(rough_scene(TARGETS), 75)
    assert len(half.targets) >= 3
    solve(rough_scene(TARGETS), progress=lambda progress: counts.append(progress.evaluations), resume=half)
    last = max(k for k, state in enumerate(half.states) if state.target)
    left = sum(state.evaluations for state in rough.states[last + 1 :])
    assert counts[-1] <= left


def test_states_between_two_targets_do_not_grow_in_number_with_shorter_increments():
    """At most 500 are stored of a wave whose range of contact is 1400 or 2800 increments wide."""
    wave = {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [0.0]}
    tables = {"solid": Solid(1e6, 0.5), "adhesion": Adhesion(1e-3), "profile": wave}
    loading = {"control": "separation", "targets": [2e-5, 1e-9]}
    counts = [
        len(solve(loading=loading, accuracy={"max_increment": increment}, **tables).states)
        for increment in (2e-3, 1e-3)
    ]
    assert counts[0] == pytest.approx(counts[1], rel=0.01)
    assert 200 < counts[0] <= solver.MOST_BETWEEN + 2


@pytest.mark.parametrize(("largest", "stored"), [(0.05, 15), (0.5, 7)], ids=["default", "coarse"])
def test_load_control_stores_no_more_states_than_penetration_asks_for(largest, stored):
    """Not one per largest increment of the load, 83 for the default, where the edges hardly move."""
    accuracy = {"max_increment": largest}
    states = solve(rough_scene([2e3, 4e3], harmonics=12, control="mean_pressure", accuracy=accuracy)).states
    deeper = np.diff([state.penetration for state in states])[[not state.target for state in states[1:]]]
    assert abs(len(states) - stored) <= 2
    assert np.abs(deeper).min() >= solver.ALMOST * min(largest, solver.DEEPER) * 50e-6


def test_increments_under_load_grow_where_the_contact_is_stiff():
    """To complete contact in 74 increments, not 2900, and past the same events as in 151."""

    def loaded(largest):
        counts = []
        accuracy = {"max_increment": largest}
        scene = rough_scene([2e5], harmonics=20, control="mean_pressure", accuracy=accuracy)
        result = solve(scene, progress=lambda progress: counts.append(progress.increments_accepted))
        return counts[-1], [(event.kind, event.mean_pressure, event.energy_released) for event in result.events]

    (count, events), (_, shorter) = loaded(0.05), loaded(0.0125)
    assert count < 150
    for event, again in zip(events, shorter, strict=True):
        assert event[0] == again[0]
        assert event[1:] == pytest.approx(again[1:], rel=2e-12, abs=1e-13)  # measured: 2e-8 of 8e4 Pa; 1e-14 J/m^2


def test_a_pressure_on_the_way_becomes_a_target():
    wanted = [1000.0, 3000.0]
    loading = {
        "control": "separation",
        "targets": [30e-6],
        "at_mean_pressures": wanted,
        "stop_at_mean_pressure": 5000.0,
    }
    result = solve(rough_scene([], loading=loading))
    np.testing.assert_allclose([state.mean_pressure for state in result.targets], [*wanted, 5000.0], rtol=1e-9)


@pytest.mark.parametrize(("control", "target"), [("separation", 0.0), ("mean_pressure", 1e7)])
def test_events_beyond_the_pressure_at_which_a_path_stops_do_not_happen(control, target):
    loading = {"control": control, "targets": [target], "at_mean_pressures": [3e3], "stop_at_mean_pressure": 5e3}
    result = solve(rough_scene([], harmonics=20, adhesion=None, loading=loading))
    assert [event.kind for event in result.events] == ["first_touch"]
    assert [state.events for state in result.states] == [1, 1]
    whole = solve(rough_scene([target], harmonics=20, adhesion=None, control=control))
    assert [event.kind for event in whole.events] == ["first_touch", "complete_contact"]


@pytest.mark.parametrize("adhesion", [None, 0.03], ids=["without adhesion", "with adhesion"])
def test_a_mean_pressure_asked_for_that_is_a_target_has_one_row(adhesion):
    loading = {"control": "mean_pressure", "targets": [300.0, 800.0], "at_mean_pressures": [300.0, 500.0]}
    result = solve(rough_scene([], 12, adhesion=adhesion, loading=loading | {"stop_at_mean_pressure": 800.0}))
    assert [state.index for state in result.targets] == [0, 3, 1]
    assert result.status == "converged"


def test_load_control_meets_the_states_of_separation_control(rough):
    stable = next(state for state in rough.targets if state.stable_at_fixed_load)
    twin = solve(rough_scene([stable.mean_pressure], control="mean_pressure")).targets[0]
    assert abs(twin.mean_pressure - stable.mean_pressure) <= 1e-9 * abs(stable.mean_pressure)
    assert twin.stable_at_fixed_load


def test_a_far_way_up_without_adhesion_is_no_separation():
    """Contact of 0.8 raised at once to where it is 0.19: all of it is in tension, and yet there is contact."""
    direct = solve(rough_scene([30e-6], adhesion=None, seed=0)).targets[0]
    far = solve(rough_scene([1e-6, 30e-6], adhesion=None, seed=0)).targets
    assert far[0].contact_fraction > 0.75
    assert abs(far[1].contact_fraction - direct.contact_fraction) <= 1e-10


def blocked(low, high, progress=lambda report: None):
    """Return a progress function that ends the way at separations between two values, as a failed computation does."""

    def report(report):
        progress(report)
        if low < report.value < high:
            raise FloatingPointError("blocked here")

    return report


def test_without_adhesion_every_other_target_is_solved_as_if_alone():
    whole = solve(rough_scene(TARGETS, adhesion=None))
    found = solve(rough_scene(TARGETS, adhesion=None), progress=blocked(34e-6, 51e-6))
    assert found.status == "not_converged"
    assert [state.found for state in found.targets] == [True, False, False, True, True]
    for here, there in zip(found.targets, whole.targets, strict=True):
        if here.found:
            alike = {"evaluations": 0, "events": 0, "branch": "any"}
            assert numbers(replace(here, **alike)) == numbers(replace(there, **alike))
    assert [event.kind for event in found.events] == ["first_touch"]


def test_with_adhesion_the_path_turns_where_it_stopped():
    """Its states are those of a path that goes to the last state kept, and back."""
    targets = [70e-6, 40e-6, 80e-6]
    found = solve(rough_scene(targets), progress=blocked(-np.inf, 52e-6))
    assert [state.status for state in found.targets] == ["converged", "not_converged", "converged"]
    assert found.targets[1].certificate.reasons == (found.failure,)
    assert found.failure.startswith("target 2 of 3, separation = 4e-05 m: FloatingPointError: blocked here; ")
    turned = found.states[found.states.index(found.targets[1]) - 1]
    assert 52e-6 <= turned.separation < 58e-6  # within two largest increments of 2.5e-6 m, and a step
    other = solve(rough_scene([70e-6, turned.separation, 80e-6]))
    assert found.targets[-1].contact_fraction == pytest.approx(other.targets[-1].contact_fraction, abs=1e-10)
    assert [event.kind for event in found.events] == [event.kind for event in other.events]


@pytest.mark.parametrize("adhesion", [None, 0.03], ids=["without adhesion", "with adhesion"])
@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_resumption_after_a_missed_target_ends_the_same_bit_for_bit(adhesion, share):
    scene = rough_scene(TARGETS, harmonics=12, adhesion=adhesion)
    counts = []
    whole = solve(scene, progress=blocked(-np.inf, 40e-6, counts.append))
    assert [state.found for state in whole.targets] == [True, True, False, True, True]
    _, resumed = halves(scene, max(1, int(share * len(counts))), partial(blocked, -np.inf, 40e-6))
    assert [numbers(state) for state in resumed.states] == [numbers(state) for state in whole.states]
    assert repr((resumed.events, resumed.status, resumed.failure)) == repr((whole.events, whole.status, whole.failure))
