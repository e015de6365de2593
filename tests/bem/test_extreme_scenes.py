"""No exception but a bad scene's leaves `solve`, whatever the scene: values at the ends of every range, and beyond."""

import gc
import math
import signal
import warnings

import pytest
from extreme_scenes import extreme_scenes, parsed
from rough_surfaces import rough_scene

from bem.scene.scene import SceneError
from bem.scene.state import FINAL_STATUSES, STATUSES
from bem.solver import solve

SECONDS = 0.3  # after which a scene is interrupted, as by Ctrl-C: some take long, none may crash
CHUNKS = 6


def interrupted(number, frame):
    raise KeyboardInterrupt


def hurried(scene):
    """The result, None where the interrupt came before the path began or after its end.

    No garbage is collected meanwhile: what others have asked to be called then would swallow the interrupt.
    """
    before = signal.signal(signal.SIGALRM, interrupted)
    gc.disable()
    try:
        try:
            signal.setitimer(signal.ITIMER_REAL, SECONDS)
            return solve(scene)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
    except KeyboardInterrupt:
        return None
    finally:
        gc.enable()
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_every_scene_is_refused_or_ends_by_name(chunk):
    ended = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        for data in extreme_scenes(25, seed=100 + chunk):
            scene = parsed(data)
            if scene is None:
                continue
            result = hurried(scene)
            if result is None:
                continue
            ended.append(result.status)
            assert (result.failure is None) == (result.status in ("converged", "interrupted"))
            for state in result.states:
                assert state.certificate.ok == (state.status in FINAL_STATUSES)
    assert set(ended) <= set(STATUSES)
    assert len(ended) >= 4


def scene_with(table, **values):
    """A usual scene on a layer, one table changed."""
    tables = {
        "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
        "profile": {"kind": "self_affine", "period": 0.01, "hurst": 0.7, "rms_height": 5e-5, "harmonics": 10},
        "layer": {"thickness": 0.002},
        "adhesion": {"work_of_adhesion": 0.03},
        "accuracy": {},
    }
    tables[table] |= values
    return rough_scene([5e-5], adhesion=tables.pop("adhesion")["work_of_adhesion"], **tables)


@pytest.mark.parametrize(
    ("table", "key", "value", "allowed"),
    [
        ("solid", "youngs_modulus", 1e-300, "from 1e-60 to 1e.60"),
        ("adhesion", "work_of_adhesion", 1e50, "1e.50 times E"),
        ("layer", "thickness", 1e-12, "a number from 6e-07 to 1e.10"),
        ("accuracy", "max_increment", 1e-9, "a number from 1e-5"),
    ],
)
def test_a_value_beyond_sense_is_refused_with_what_is_allowed(table, key, value, allowed):
    with pytest.raises(SceneError, match=rf"{table}.{key} = .*; allowed: .*{allowed}"):
        scene_with(table, **{key: value})


def test_complete_contact_that_strong_adhesion_holds_opens_at_an_open_load():
    """Under a prescribed separation no load belongs to complete contact: the event is told without it, not a crash."""
    wave = {"kind": "harmonics", "period": 0.01, "orders": [1], "amplitudes": [1e-5], "phases": [1.0]}
    loading = {"control": "separation", "targets": [0.0, 0.1], "initial": "complete_contact"}
    result = solve(rough_scene([], profile=wave, loading=loading, layer={"thickness": 0.002}))
    assert result.status == "converged"
    assert [(event.kind, math.isnan(event.mean_pressure)) for event in result.events] == [
        ("opening", True),
        ("pull_off", False),
    ]


def test_a_separation_below_rounding_is_a_separation_of_zero():
    """Separation and penetration add up to the crest, of which 1e-300 m is nothing: an answer, not a refusal."""
    wave = {"kind": "harmonics", "period": 0.5, "orders": [1, 3], "amplitudes": [-1.4e-3, 1.2e-3], "phases": [-3.1, -3]}
    loading = {"control": "separation", "targets": [1e-300]}
    result = solve(rough_scene([], profile=wave, loading=loading, adhesion=None))
    assert result.status == "converged"
    assert result.targets[0].separation == 0


def test_a_plate_that_returns_to_its_first_place_has_moved_by_nothing_but_rounding():
    """Displacement and mean compression cancel in complete contact: what is left is rounding of the heights."""
    loading = {"control": "total_displacement", "initial": "complete_contact", "targets": [1.5e-5, 1.5e-6, 0.0]}
    profile = {"kind": "self_affine", "period": 0.012, "hurst": 0.1, "rms_height": 1.4e-7, "harmonics": 8, "seed": 3}
    tables = {"solid": {"youngs_modulus": 15e3, "poisson_ratio": 0.26}, "layer": {"thickness": 0.05}}
    result = solve(profile=profile, loading=loading, adhesion={"work_of_adhesion": 1.9e-10}, **tables)
    assert result.status == "converged"
    assert abs(result.targets[-1].total_displacement) < 1e-9 * 1.4e-7
