"""Scenes drawn at random: each by its own seed, all of the contract among them; solved in validation/cases."""

from functools import cache

import numpy as np
import pytest

from bem.scene.scene import SceneError, load_scene, parse_scene
from validation.corpus.random_scenes import EXTREMES, MISTAKES, draw

MANY = 800


@cache
def drawn():
    return [draw(1, index) for index in range(MANY)]


def plain(scene):
    return scene.tables, None if scene.scan is None else scene.scan.tolist()


def test_a_scene_does_not_depend_on_those_drawn_before_it():
    backwards = [draw(1, index) for index in reversed(range(20))][::-1]
    assert [plain(scene) for scene in backwards] == [plain(scene) for scene in drawn()[:20]]


def test_seeds_differ():
    assert plain(draw(0, 3)) != plain(draw(1, 3))


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
    found = {scene.tables.get(table, {}).get(name) for scene in drawn() if not scene.special}
    assert found >= set(SEEN[key])


@pytest.mark.parametrize("key", LOADING)
def test_every_way_to_load_is_drawn(key):
    assert any(key in scene.tables["loading"] for scene in drawn())


@pytest.mark.parametrize("table", ["layer", "adhesion", "output"])
def test_tables_are_there_and_absent(table):
    share = np.mean([table in scene.tables for scene in drawn()])
    assert 0.2 < share < 0.8


@pytest.mark.parametrize(
    ("expected", "changes"), [("an answer or a refusal", EXTREMES), ("a refusal", MISTAKES)], ids=["extreme", "mistake"]
)
def test_every_change_fits_some_scene(expected, changes):
    """Each entry of the tables can be drawn; drawn more often than here it would be."""
    places = {(table, key) for table, keys in changes.items() for key in keys}
    found = {tuple(scene.special.split(" ")[0].split(".")) for scene in drawn() if scene.expected == expected}
    assert found <= places
    assert len(found) >= 0.6 * len(places)


def written(scene, folder):
    """A scene as it is read from its file."""
    return load_scene(scene.write(folder)).resolved() | {"title": ""}


def test_written_scenes_are_the_scenes(tmp_path):
    scenes = [scene for scene in drawn()[:120] if scene.expected == "an answer"]
    pairs = ((written(scene, tmp_path), parse_scene(scene.tables, tmp_path).resolved()) for scene in scenes)
    assert [(read, meant) for read, meant in pairs if read != meant] == []


def refused(scene, folder):
    """The keys by which a scene is refused."""
    scene.write_scan(folder)
    try:
        parse_scene(scene.tables, folder)
    except SceneError as error:
        return [mistake.path for mistake in error.mistakes]
    return []


def test_what_is_out_of_range_is_refused_by_its_name(tmp_path):
    told = [(scene.special, refused(scene, tmp_path)) for scene in drawn() if scene.expected == "a refusal"]
    assert [(what, keys) for what, keys in told if not any(what.split(" ")[0] in key for key in keys)] == []
    assert len(told) > 20
