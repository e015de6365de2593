"""Effects: which ones a scene calls for, and why."""

import copy

import numpy as np
import pytest

from bem.scene.effects import EFFECTS, effects_of
from bem.scene.scene import parse_scene

BASE = {
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "profile": {"kind": "self_affine", "period": 0.01, "hurst": 0.7, "rms_height": 50e-6, "harmonics": 1000},
    "adhesion": {"work_of_adhesion": 0.03},
    "loading": {"control": "separation", "targets": [60e-6, 30e-6]},
}


def scene_with(**tables):
    data = copy.deepcopy(BASE) | tables
    return parse_scene({name: table for name, table in data.items() if table is not None})


def loading(**keys):
    return {"loading": BASE["loading"] | keys}


def active(scene):
    return {effect.name for effect in effects_of(scene) if effect.active}


def reason(scene, name):
    return next(effect.reason for effect in effects_of(scene) if effect.name == name)


def test_every_effect_is_listed_once_with_a_reason():
    listed = effects_of(parse_scene(BASE))
    assert tuple(effect.name for effect in listed) == EFFECTS
    assert all(effect.reason for effect in listed)


@pytest.mark.parametrize(
    ("tables", "names"),
    [
        pytest.param({}, {"half_space", "adhesion"}, id="bare"),
        pytest.param({"adhesion": None}, {"half_space"}, id="no adhesion"),
        pytest.param({"layer": {"thickness": 1e-3}}, {"layer", "adhesion"}, id="layer"),
        pytest.param({"layer": {"thickness": 1.0}}, {"half_space", "adhesion"}, id="thick layer"),
        pytest.param(
            {"adhesion": {"work_of_adhesion": 1.0, "slope_term": True}},
            {"half_space", "adhesion", "slope_term"},
            id="slope",
        ),
        pytest.param(loading(targets=[6e-5, 3e-5, 4e-5]), {"half_space", "adhesion", "unloading"}, id="back"),
        pytest.param(
            loading(targets=[3e-5], initial="complete_contact"), {"half_space", "adhesion", "unloading"}, id="from full"
        ),
        pytest.param(loading(control="penetration"), {"half_space", "adhesion", "unloading"}, id="penetration falls"),
        pytest.param(
            loading(control="mean_pressure", targets=[1e3, 2e3]), {"half_space", "adhesion", "load_control"}, id="load"
        ),
        pytest.param({"output": {"shapes": [3e-5]}}, {"half_space", "adhesion", "shapes"}, id="shapes"),
        pytest.param(
            {"output": {"spectra": True, "pressure_distribution": [3e-5]}},
            {"half_space", "adhesion", "spectra", "pressure_distribution"},
            id="observables",
        ),
    ],
)
def test_effects_a_scene_calls_for(tables, names):
    assert active(scene_with(**tables)) == names


def test_thick_layer_left_out_is_explained():
    assert "left out" in reason(scene_with(layer={"thickness": 1.0}), "layer")


def test_default_cut_of_a_scan_is_noted(tmp_path):
    x = np.arange(16.0)
    np.savetxt(tmp_path / "scan.txt", np.column_stack([x, np.cos(x)]))
    data = BASE | {"profile": {"kind": "samples", "file": "scan.txt", "unit_x": "m", "unit_h": "m"}}
    assert "profile.harmonics = 7 by default for 16 samples" in reason(parse_scene(data, tmp_path), "half_space")
