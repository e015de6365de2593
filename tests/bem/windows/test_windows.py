"""Windows of a large contact: targets and events of the whole contact, and how windows are cut and joined."""

import numpy as np
import pytest
from rough_surfaces import banded_scene

from bem.elastic.far_field import Arc
from bem.geometry.patches import Patches, ordered
from bem.loading.complete_contact import complete_contact
from bem.loading.crew import Crew
from bem.path_for import path_for
from bem.problem import pose
from bem.scene.result import Result
from bem.solver import solve
from bem.windows.windowed_path import MANY_PATCHES
from bem.windows.windows import Window, in_core, seams, wider, windows_of

SAME = 1e-9  # of two settled states, relative; measured 2e-13
TARGETS = [2.5e-6, 2.25e-6, 2.55e-6]


@pytest.fixture(scope="module")
def in_windows() -> Result:
    return solve(banded_scene(TARGETS))


@pytest.fixture(scope="module")
def as_one() -> Result:
    """The same path, at a tolerance at which the whole contact is followed."""
    return solve(banded_scene(TARGETS, accuracy={"tolerance": 1e-5}))


def test_targets_are_those_of_the_whole_contact(in_windows, as_one):
    assert in_windows.status == as_one.status == "converged"
    assert min(state.n_patches for state in in_windows.targets) > MANY_PATCHES
    for state, other in zip(in_windows.targets, as_one.targets, strict=True):
        assert state.contact_fraction == pytest.approx(other.contact_fraction, rel=SAME)
        assert state.mean_pressure == pytest.approx(other.mean_pressure, rel=SAME)
        assert state.contact_stiffness == pytest.approx(other.contact_stiffness, rel=1e-6)
        assert state.certificate.ok


def test_events_are_those_of_the_whole_contact_within_their_errors(in_windows, as_one):
    """Their loads and energies, too: a window knows of the others by their far field only."""
    ours, theirs = (
        sorted(result.events, key=lambda e: (e.kind, e.position, e.penetration)) for result in (in_windows, as_one)
    )
    assert [event.kind for event in ours] == [event.kind for event in theirs]
    beyond = 0
    for event, other in zip(ours, theirs, strict=True):
        assert event.position == pytest.approx(other.position, abs=1e-6)
        for name in ("penetration", "mean_pressure", "energy_released"):
            error = getattr(event.error_estimate, name) + getattr(other.error_estimate, name) + 1e-15
            apart = abs(getattr(event, name) - getattr(other, name))
            beyond += apart > error
            assert apart < 10 * error
    assert beyond <= 0.01 * len(ours)


def test_a_path_in_windows_that_was_interrupted_goes_on(in_windows):
    def stop(record):
        if sum(entry.state.target for entry in record.entries) == 2:
            raise KeyboardInterrupt

    scene = banded_scene(TARGETS)
    resumed = solve(scene, resume=solve(scene, on_state=stop))
    assert [state.edges for state in resumed.targets] == [state.edges for state in in_windows.targets]


def test_pressures_are_met_between_joined_windows(in_windows):
    first, second = in_windows.targets[:2]
    asked = (first.mean_pressure + second.mean_pressure) / 2
    loading = {"control": "separation", "targets": TARGETS[:2], "at_mean_pressures": [asked]}
    states = solve(banded_scene([], loading=loading)).targets
    assert len(states) == 3
    assert states[1].mean_pressure == pytest.approx(asked, rel=1e-8)
    assert first.contact_fraction < states[1].contact_fraction < second.contact_fraction


class NoWindowLands(Crew):
    """Windows whose paths all fail."""

    def each(self, function, shared, parts):
        return ((None, 0) for _ in parts)


def test_where_windows_fail_the_whole_contact_is_followed(in_windows):
    scene, state = banded_scene(TARGETS), in_windows.targets[0]
    problem = pose(scene)
    path = path_for(scene, problem, complete_contact(problem.profile, problem.law), NoWindowLands())
    left, right = np.array(state.edges).T / problem.scales.length
    value = problem.control_value(state.separation, "separation")
    start = path.restart(ordered(left, right), state.penetration / problem.scales.height, value)
    (*_, last), (*_, other) = (way.advance(start, value - 0.005) for way in (path, path.whole))
    assert path.effort.rejected and last.value == other.value == value - 0.005
    np.testing.assert_allclose(last.patches.left, other.patches.left, rtol=1e-9)


def patches_of(*ends):
    left, right = np.array(ends, dtype=float).T
    return Patches(left, right)


def test_windows_are_seamed_in_gaps_that_both_have():
    windows = [
        Window(Arc(-0.2, 1.0, (0.01, 0.01)), np.arange(4), -0.1),
        Window(Arc(0.255, 0.22 + 2 * np.pi, (0.01, 0.01)), np.arange(4), 0.55),
    ]
    one = patches_of((0.1, 0.2), (0.3, 0.4), (0.6, 0.7), (0.8, 0.9))
    other = patches_of((0.1, 0.2), (0.3, 0.74), (0.8, 0.9), (1.1, 1.2), (6.0, 6.1))  # the gap at 0.5 is closed
    assert seams(windows, [one, other]) == pytest.approx([(6.1 + 0.1 + 2 * np.pi) / 2, 0.75])
    closed = patches_of((0.1, 0.2), (0.26, 0.95), (1.1, 1.2), (6.0, 6.1))
    assert seams(windows, [one, closed]) is None
    detached = patches_of((0.1, 0.2), (0.21, 0.25))  # of the first window nothing is left in the second
    fewer = patches_of((0.1, 0.2), (0.3, 0.5), (1.1, 1.2), (6.0, 6.1))
    assert seams(windows, [detached, fewer]) == pytest.approx([(6.1 + 0.1 + 2 * np.pi) / 2, (0.255 + 1.0) / 2])
    assert in_core(np.array([0.7, 0.8, 6.0]), 0.75, 1.3).tolist() == [False, True, False]


@pytest.mark.parametrize(("count", "more"), [(28, 0), (35, 0), (100, 0), (100, 3), (100, 7)])
def test_every_patch_is_in_one_core(count, more):
    left = np.cumsum(np.random.default_rng(3).uniform(0.5, 2.0, count))
    left *= 6.2 / left[-1]
    patches = Patches(left, left + 0.4 * np.diff(left, append=left[0] + 2 * np.pi))
    windows = [wider(patches, k, more) for k in range(len(windows_of(patches)))]
    starts = seams(windows, [window.of(patches) for window in windows])
    cores = [
        patches.center[in_core(patches.center, a, b)] for a, b in zip(starts, [*starts[1:], starts[0]], strict=True)
    ]
    assert sorted(np.concatenate(cores)) == sorted(patches.center)
    assert all(np.isin(core, window.of(patches).center).all() for core, window in zip(cores, windows, strict=True))


def test_a_window_that_would_leave_no_patches_outside_is_not_made_wider():
    """Of 51 to 70 patches, which leap in windows, a buffer of 12 on either side may hold all."""
    rng = np.random.default_rng(0)
    refused = 0
    for count in range(51, 71):
        ends = np.sort(rng.uniform(0, 2 * np.pi, 2 * count))
        patches = Patches(ends[::2], ends[1::2])
        widest = [wider(patches, k, 7) for k in range(len(windows_of(patches)))]
        refused += widest.count(None)
        assert all(window is None or window.members.size < count for window in widest)
    assert refused
    with pytest.raises(ValueError, match="3 patches are too few"):
        windows_of(patches_of((0.1, 0.2), (0.3, 0.4), (0.6, 0.7)))
