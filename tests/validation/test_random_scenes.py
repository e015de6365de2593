"""Scenes drawn at random: each by its own seed, all of the contract among them; solved in validation/cases."""

from functools import cache

import pytest

from bem.scene.scene import load_scene, parse_scene
from validation.corpus.random_scenes import draw

MANY = 800


@cache
def drawn():
    return [draw(1, index) for index in range(MANY)]


def plain(scene):
    return scene.tables, None if scene.scan is None else scene.scan.tolist()


def test_a_scene_does_not_depend_on_those_drawn_before_it():
    backwards = [draw(1, index) for index in reversed(range(20))][::-1]
    assert [plain(scene) for scene in backwards] == [plain(scene) for scene in drawn()[:20]]


LOADING = ("targets", "start", "then_back_to", "stop_at_mean_pressure", "at_mean_pressures", "initial", "flaw")
SEEN = {
    "profile.kind": ("self_affine", "harmonics", "samples"),
    "profile.detrend": ("mean", "line"),
    "loading.control": ("separation", "penetration", "mean_pressure", "total_displacement"),
    "adhesion.slope_term": (True, False),
    "solid.poisson_ratio": (0.0, 0.499999, 0.5),
    "accuracy.tolerance": (1e-12, 1e-2),
}


@pytest.mark.parametrize("key", SEEN)
def test_every_choice_of_a_key_is_drawn(key):
    table, name = key.split(".")
    found = {scene.tables.get(table, {}).get(name) for scene in drawn()}
    assert found >= set(SEEN[key])


@pytest.mark.parametrize("key", LOADING)
def test_every_way_to_load_is_drawn(key):
    assert any(key in scene.tables["loading"] for scene in drawn())


def written(scene, folder):
    """A scene as it is read from its file."""
    return load_scene(scene.write(folder)).resolved() | {"title": ""}


def test_written_scenes_are_the_scenes(tmp_path):
    pairs = ((written(scene, tmp_path), parse_scene(scene.tables, tmp_path).resolved()) for scene in drawn()[:120])
    assert [(read, meant) for read, meant in pairs if read != meant] == []
