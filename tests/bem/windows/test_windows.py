"""Many patches in windows: the same states as of all patches together, at rest and on the way."""

import numpy as np
import pytest
from rough_surfaces import banded_scene, rough_scene

from bem.adhesive.equilibrium import System
from bem.continuation.locating import AtControl, Start, settle
from bem.elastic.far_field import Arc
from bem.geometry.patches import Patches, ordered
from bem.leaps import leaping_path
from bem.leaps.settling import Mixing, Settling
from bem.leaps.windows import Window, in_core, seams, wider, windows_of
from bem.loading.increments import FINE
from bem.problem import pose
from bem.solver import solve

SAME = 1e-8  # of two settled states, relative; measured 4e-10


@pytest.fixture(scope="module")
def both():
    """The same path in windows, and of all patches together."""
    with pytest.MonkeyPatch.context() as patch:
        windows = solve(banded_scene([4e-6, 3e-6, 6e-6]))
        patch.setattr(leaping_path, "WINDOWED", np.inf)
        return windows, solve(banded_scene([4e-6, 3e-6, 6e-6]))


def test_states_are_those_of_all_patches_together(both):
    windows, together = both
    assert windows.status == together.status == "converged"
    assert min(state.n_patches for state in windows.targets) >= leaping_path.WINDOWED
    for state, other in zip(windows.targets, together.targets, strict=True):
        assert state.contact_fraction == pytest.approx(other.contact_fraction, rel=SAME)
        assert state.mean_pressure == pytest.approx(other.mean_pressure, rel=SAME)
        assert state.total_energy == pytest.approx(other.total_energy, rel=SAME)
        assert state.contact_stiffness == pytest.approx(other.contact_stiffness, rel=1e-4)
        assert state.certificate.ok
        assert state.stable_at_fixed_load == other.stable_at_fixed_load


def test_errors_are_those_of_all_patches_together(both):
    for state, other in zip(*(result.targets for result in both), strict=True):
        ours, theirs = (vars(one.error_estimate) for one in (state, other))
        for name in ("contact_fraction", "mean_pressure", "elastic_energy", "adhesion_energy", "stress_intensity_max"):
            assert ours[name] == pytest.approx(theirs[name], rel=1e-3)


def test_events_are_those_of_all_patches_together(both):
    """Nearly all: in which order crests touch within a leap depends on how far patches are led together."""
    windows, together = ({(e.kind, round(e.position / 1e-5)) for e in result.events} for result in both)
    assert len(windows & together) > 0.9 * len(together)


def test_a_path_in_windows_that_was_interrupted_goes_on(both):
    def stop(record):
        if sum(entry.state.target for entry in record.entries) == 2:
            raise KeyboardInterrupt

    scene = banded_scene([4e-6, 3e-6, 6e-6])
    resumed = solve(scene, resume=solve(scene, on_state=stop))
    assert [state.edges for state in resumed.targets] == [state.edges for state in both[0].targets]


@pytest.mark.slow
def test_pressures_are_met_in_windows(both):
    first, second = both[0].targets[:2]
    asked = (first.mean_pressure + second.mean_pressure) / 2
    loading = {"control": "separation", "targets": [4e-6, 3e-6], "at_mean_pressures": [asked]}
    found = solve(banded_scene([], loading=loading)).targets
    assert len(found) == 3
    assert found[1].mean_pressure == pytest.approx(asked, rel=1e-8)
    assert first.contact_fraction < found[1].contact_fraction < second.contact_fraction


def test_an_avalanche_goes_on_in_the_next_window():
    """Detached in one window, patches were still held in the next: the two never fitted, however short the leap."""
    result = solve(rough_scene([10e-6, 50e-6], 1500, 6, slope_term=False, accuracy={"tolerance": 1e-2}))
    assert result.status == "converged"
    assert [state.n_patches for state in result.targets] == [95, 25]
    assert result.targets[1].contact_fraction == pytest.approx(0.0810663682522771, rel=1e-10)  # event by event; 1e-12
    assert len(result.events) == pytest.approx(351, rel=0.02)  # of all patches together; 348: none is told twice


def test_a_soft_mode_of_patches_in_two_windows_comes_to_rest():
    """Each step of the windows leaves nine tenths of it; mixed, n + 1 steps solve a linear problem of n unknowns."""
    left = np.diag([0.9, 0.01, -0.005])
    mixing = Mixing(np.zeros(3))
    for _ in range(4):
        mixing.step(np.ones(3) + left @ mixing.place - mixing.place)
    np.testing.assert_allclose(mixing.place, 1 / (1 - np.diag(left)), rtol=1e-12)  # measured 1e-15; not mixed 0.66


@pytest.mark.slow
def test_narrow_brackets_in_windows(both):
    """At 1e-4: the same states as by leaps at 1e-2, events in brackets some fifty times as narrow."""
    narrow = solve(banded_scene([4e-6, 3e-6], accuracy={"tolerance": 1e-4}))
    for state, other in zip(narrow.targets, both[0].targets, strict=False):
        assert state.contact_fraction == pytest.approx(other.contact_fraction, rel=SAME)
    found, wide = (
        np.median([event.error_estimate.penetration for event in result.events[1:]]) for result in (narrow, both[0])
    )
    assert 0.01 * wide < found < 0.03 * wide  # 0.025: a leap of 0.01 rms heights is halved three times


def test_all_edges_come_to_rest_by_the_jacobians_of_windows(both):
    scene = banded_scene([3e-6])
    problem = pose(scene, scene.surface())
    system = System(problem.elastic, problem.law, problem.control)
    edges = np.array(both[0].targets[1].edges) / problem.scales.length
    patches, value = ordered(edges[:, 0], edges[:, 1]), problem.control_value(3e-6, "separation")
    pushed = patches.moved(0.005 * patches.edge_scale * np.random.default_rng(2).uniform(-1, 1, 2 * patches.count))
    state, _ = Settling(system).settled(pushed, value, FINE)
    dense, _ = settle(system, Start(pushed, value, value), AtControl(value), FINE)
    assert dense.residual <= FINE.residual
    np.testing.assert_allclose(state.patches.left, dense.state.patches.left, atol=1e-10)
    np.testing.assert_allclose(state.stress_intensity, dense.state.stress_intensity, rtol=1e-8)


def patches_of(*ends):
    left, right = np.array(ends, dtype=float).T
    return Patches(left, right)


def test_windows_are_seamed_in_gaps_that_both_have():
    every = np.ones(4, dtype=bool)
    windows = [
        Window(Arc(-0.2, 1.0, (0.01, 0.01)), np.arange(4), -0.1, every),
        Window(Arc(0.255, 0.22 + 2 * np.pi, (0.01, 0.01)), np.arange(4), 0.55, every),
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


def test_every_patch_is_in_one_core():
    left = np.cumsum(np.random.default_rng(3).uniform(0.5, 2.0, 100))
    left *= 6.2 / left[-1]
    patches = Patches(left, left + 0.4 * np.diff(left, append=left[0] + 2 * np.pi))
    for more in (0, 3, 7):
        windows = [wider(patches, k, more) for k in range(len(windows_of(patches)))]
        assert sorted(np.concatenate([w.members[w.core] for w in windows])) == list(range(100))


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
