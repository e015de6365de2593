"""Estimated memory and unknowns beside those of solved scenes."""

from dataclasses import replace

import pytest

from bem.elastic.layer import Layer
from bem.scene.memory_estimate import memory_estimate
from bem.scene.scene import SceneError, parse_scene
from bem.solver import solve

E_STAR = 5e6 / (1 - 0.49**2)
ROUGH = {"kind": "self_affine", "period": 0.008, "hurst": 0.8, "rms_height": 4.6e-7, "seed": 1}


def scene_of(harmonics, control, target, adhesion=0.0):
    """Target over E* times the rms slope, or over the rms height; adhesion over E* times the rms height's square."""
    data = {
        "solid": {"youngs_modulus": 5e6, "poisson_ratio": 0.49},
        "profile": ROUGH | {"harmonics": harmonics},
        "loading": {"control": control, "targets": [1.0]},
    }
    surface = parse_scene(data).surface()
    unit = E_STAR * surface.rms_slope if control == "mean_pressure" else surface.rms_height
    data["loading"]["targets"] = [target * unit]
    if adhesion:
        data["adhesion"] = {"work_of_adhesion": adhesion * E_STAR * surface.rms_height**2 / 0.008}
    return parse_scene(data)


@pytest.mark.parametrize(
    ("harmonics", "control", "target", "adhesion", "peak"),
    [
        (1000, "mean_pressure", 0.3, 0.0, 103e6),
        (1000, "mean_pressure", 1.2, 0.0, 116e6),
        (2000, "mean_pressure", 1.7, 0.0, 178e6),
        (4000, "mean_pressure", 1.0, 0.0, 202e6),
        (4000, "mean_pressure", 2.0, 0.0, 307e6),
        (8000, "mean_pressure", 1.5, 0.0, 339e6),
        (8000, "mean_pressure", 1.7345, 0.0, 232e6),
        (16000, "separation", 1.5, 0.0, 415e6),
        (20000, "mean_pressure", 0.5, 0.0, 1000e6),
        (2000, "separation", 1e-4, 0.0, 171e6),
        (300, "separation", 0.5, 1.0, 129e6),
        (500, "separation", 1e-5, 0.1, 287e6),
    ],
)
def test_memory_is_within_a_factor_of_two_of_the_peak_that_was_measured(harmonics, control, target, adhesion, peak):
    estimate = memory_estimate(scene_of(harmonics, control, target, adhesion)).bytes
    assert 0.5 < estimate / peak < 2


@pytest.mark.parametrize(("control", "target"), [("mean_pressure", 0.3), ("mean_pressure", 1.0), ("separation", 0.5)])
def test_unknowns_are_within_a_factor_of_two(control, target):
    scene = scene_of(300, control, target)
    solved = max(state.unknowns for state in solve(scene).states)
    assert 0.5 < memory_estimate(scene).unknowns / solved < 2


def test_a_scene_beyond_memory_is_refused_by_name_from_python_too():
    scene = replace(scene_of(200_000, "mean_pressure", 0.5), layer=Layer(1e-3))
    with pytest.raises(SceneError, match=r"profile\.harmonics 200000 need about .* GB of memory; allowed: fewer"):
        solve(scene)
