"""`bem.solve` of a file, a mapping, a scene and objects: the same scene, and one clear refusal of what is none."""

import pickle
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import bem
from bem.scene.scene import parse_scene, scene_of

FILE = """
title = "wave"
[solid]
youngs_modulus = 1e6
poisson_ratio = 0.5
[profile]
kind = "harmonics"
period = 0.01
orders = [1, 3]
amplitudes = [1e-4, 2e-5]
phases = [0.1, 0.2]
[layer]
thickness = 1e-3
[adhesion]
work_of_adhesion = 0.03
slope_term = true
[loading]
control = "separation"
targets = [8e-5, 7e-5]
"""
OBJECTS = {
    "title": "wave",
    "solid": bem.Solid(1e6, 0.5),
    "profile": bem.Profile.from_harmonics(0.01, [1, 3], [1e-4, 2e-5], [0.1, 0.2]),
    "layer": bem.Layer(1e-3),
    "adhesion": bem.Adhesion(0.03, slope_term=True),
    "loading": {"control": "separation", "targets": np.array([8e-5, 7e-5])},
}


@pytest.fixture
def path(tmp_path):
    (tmp_path / "scene.toml").write_text(FILE)
    return tmp_path / "scene.toml"


@pytest.mark.parametrize("kind", [str, lambda path: path, bem.load_scene, lambda path: OBJECTS], ids=range(4))
def test_however_it_is_given_it_is_the_same_scene(path, kind):
    assert scene_of(kind(path), {}).resolved() == bem.load_scene(path).resolved()
    assert scene_of(None, OBJECTS).resolved() == bem.load_scene(path).resolved()


def test_objects_are_solved_like_their_file(path):
    by_file, by_objects = bem.solve(path), bem.solve(**OBJECTS)
    assert by_file.status == "converged"
    assert [state.mean_pressure for state in by_file.states] == [state.mean_pressure for state in by_objects.states]


def test_tables_that_are_none_are_absent():
    scene = scene_of(None, OBJECTS | {"layer": None, "adhesion": None})
    assert (scene.layer, scene.adhesion) == (None, None)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"layers": bem.Layer(1e-3)}, '"layer", by its name'),
        ({"layer": bem.Solid(1e6, 0.5)}, "layer.youngs_modulus .* is unknown"),
        ({"profile": None}, r"\[profile\] is missing"),
        ({"loading": {"control": "separation", "targets": np.array([np.nan])}}, r"loading.targets\[0\] = NaN"),
    ],
    ids=["name", "kind", "missing", "nan"],
)
def test_mistakes_are_those_of_a_scene(changes, said):
    with pytest.raises(bem.SceneError, match=said):
        bem.solve(**OBJECTS | changes)


@pytest.mark.parametrize(
    ("scene", "tables", "said"),
    [
        (None, {}, "nothing given: a scene, its file or its tables"),
        (3, {}, "scene = 3, int: "),
        (OBJECTS, {"profile": OBJECTS["profile"]}, "^profile= beside a whole scene: "),
        (OBJECTS, {"nonsense": 3}, "^nonsense= unknown: "),
        (OBJECTS, {"nonsense": 3, "title": "a"}, "^nonsense= unknown and title= beside a whole scene: "),
    ],
    ids=["nothing", "type", "clash", "unknown", "unknown and clash"],
)
def test_what_is_wrong_is_named(scene, tables, said):
    with pytest.raises(TypeError, match=said):
        bem.solve(scene, **tables)


def scanned(tmp_path, **profile):
    """A scan with a spike and a gap: the tables with its file, and with its arrays."""
    x = 1e-5 * np.arange(200)
    h = 1e-6 * np.cos(2 * np.pi * x / 2e-3) + 1e-7 * np.cos(34 * np.pi * x / 2e-3)
    h[50], h[90] = 3e-5, np.nan
    np.savetxt(tmp_path / "scan.csv", np.column_stack([x, h]), delimiter=",", fmt="%.17g")
    rest = {"solid": bem.Solid(1e6, 0.5), "loading": {"control": "mean_pressure", "targets": [500.0]}}
    by_file = {"kind": "samples", "file": str(tmp_path / "scan.csv"), "unit_x": "m", "unit_h": "m", **profile}
    return rest | {"profile": by_file}, rest | {"profile": {"kind": "samples", "x": x, "h": h, **profile}}


def test_samples_in_memory_are_prepared_and_warned_of_like_those_of_a_file(tmp_path):
    by_file, by_arrays = (bem.solve(**one) for one in scanned(tmp_path, missing="interpolate", outliers="replace"))
    fractions = [[state.contact_fraction for state in result.states] for result in (by_file, by_arrays)]
    assert fractions[0] == fractions[1]
    heights = [[step.get("rms_height") for step in result.profile_preparation] for result in (by_file, by_arrays)]
    assert heights[0] == heights[1]
    assert by_file.warnings == by_arrays.warnings
    for tables in scanned(tmp_path):
        with pytest.raises(bem.SceneError, match=r"profile\.missing"):
            bem.solve(**tables)


def test_a_map_in_memory_is_solved_like_that_of_a_file(tmp_path):
    """As a trace with a spacing, as a row, as the mean and as all rows, with the tables as keywords."""
    rng = np.random.default_rng(6)
    heights = 1e-6 * np.cos(2 * np.pi * np.arange(64)[:, None] / 64 + rng.uniform(0, 6, 3)) * [1.0, 1.2, 1.4]
    np.save(tmp_path / "map.npy", heights)
    read = {"kind": "samples", "spacing": 1e-5, "harmonics": 5}
    rest = {"solid": bem.Solid(1e6, 0.5), "loading": {"control": "mean_pressure", "targets": [500.0]}}
    by_file = read | {"file": str(tmp_path / "map.npy"), "unit_x": "m", "unit_h": "m"}

    def edges(result):
        return [state.edges for state in result.states]

    for row, trace in ((1, heights[:, 1]), ("mean", heights.mean(axis=1))):
        told = edges(bem.solve(profile=by_file | {"row": row}, **rest))
        assert edges(bem.solve(profile=read | {"h": heights, "row": row}, **rest)) == told
        assert edges(bem.solve(profile=read | {"h": trace}, **rest)) == told
    rows = bem.solve_rows(profile=read | {"h": heights, "row": "all", "every": 2}, **rest)
    assert repr(rows) == "<RowResults: 2 rows of a map answered>"
    assert {row: edges(result) for row, result in rows.results.items()} == {
        row: edges(bem.solve(profile=by_file | {"row": row}, **rest)) for row in (0, 2)
    }
    heights[3, 0] = np.nan
    placed = {"kind": "samples", "harmonics": 5, "h": heights, "x": 1e-5 * np.arange(64)}
    rows = bem.solve_rows(profile=placed | {"row": "all"}, **rest)
    assert (sorted(rows.results), "missing" in rows.failures[0]) == ([1, 2], True)


def masked(h):
    gap = np.isnan(h)
    return np.ma.masked_array(np.where(gap, -9999.0, h), gap)


@pytest.mark.parametrize("given", [list, masked, lambda h: np.where(np.isnan(h), -np.inf, h)])
def test_lists_masked_and_infinite_heights_are_those_of_a_file(given, tmp_path):
    by_file, by_arrays = scanned(tmp_path, outliers="replace")
    by_arrays["profile"] |= {"x": list(by_arrays["profile"]["x"]), "h": given(by_arrays["profile"]["h"])}
    told = r"profile\.missing = \"refuse\", and 1 of 200 heights are missing \(%s 91\)"
    for tables, place in ((by_file, "line"), (by_arrays, "sample")):
        with pytest.raises(bem.SceneError, match=told % place):
            bem.solve(**tables)
    scans = []
    for tables in (by_file, by_arrays):
        tables["profile"]["missing"] = "interpolate"
        scans.append(parse_scene(tables).scan)
    np.testing.assert_array_equal(scans[0].h, scans[1].h)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"h": np.ones(200) * 1j}, r"profile\.h holds an array of type complex128; allowed: real numbers"),
        ({"h": ["a"] * 200}, r"profile\.h holds an array of type <U1"),
        ({"x": [[0.0, 1.0], [2.0]]}, r"profile\.x of list: "),
        ({"x": list(range(199))}, r"profile\.x of shape \(199,\) beside h of shape \(200,\)"),
        ({"x": np.append(np.arange(199.0), np.inf)}, "sample 200 has no position"),
        ({"h": np.ones((200, 3))}, r"profile\.row is needed: the file holds a map of 3 rows; allowed: row = 0 to 2"),
        ({"h": np.ones((3, 200)), "row": 0}, r"profile\.x of shape \(200,\) beside h of shape \(3, 200\)"),
        ({"h": np.ones((2, 2, 2))}, r"profile\.h of shape \(2, 2, 2\)"),
        ({"row": 0}, r"profile\.row = 0 of a line scan"),
        ({"spacing": 1e-5}, r"profile\.spacing = 1e-05 beside x; allowed: leave it out"),
    ],
)
def test_arrays_that_are_no_line_are_refused_by_name(changes, said, tmp_path):
    _, tables = scanned(tmp_path)
    tables["profile"] |= changes
    with pytest.raises(bem.SceneError, match=said):
        bem.solve(**tables)


def test_keys_of_files_are_refused_beside_arrays(tmp_path):
    _, tables = scanned(tmp_path, unit_x="mm")
    with pytest.raises(bem.SceneError, match=r"profile\.unit_x = 'mm' is for files, arrays are in m"):
        bem.solve(**tables)


@pytest.mark.parametrize(
    ("samples", "told"),
    [({"h": np.zeros(9)}, "profile.x is missing"), ({"x": [0.0, 1.0], "h": None}, "profile.h is missing")],
    ids=["no x", "no h"],
)
def test_samples_in_memory_that_are_incomplete_are_told_what_they_need(samples, told):
    with pytest.raises(bem.SceneError) as caught:
        bem.solve(**OBJECTS | {"profile": {"kind": "samples", **samples}})
    need = "; allowed: samples in memory need x and h, arrays of equal length in m, or h and its spacing in m"
    assert list(map(str, caught.value.mistakes)) == [told + need]


MASKED = np.ma.masked_equal([0.0, -9999.0, 0.0, 1.0], -9999.0)


@pytest.mark.parametrize(
    ("x", "h"), [([0, 1, 2.5, 3], [0, 1, 0, 1]), ([0, 1, 2, 3], [0, np.nan, 0, 1]), ([0, 1, 2, 3], MASKED)]
)
def test_a_profile_of_samples_that_need_preparation_is_refused(x, h):
    with pytest.raises(ValueError, match="finite heights at equal steps"):
        bem.Profile.from_samples(x, h, 1)


def test_objects_take_values_by_place_and_name_and_refuse_them_in_the_words_of_a_scene():
    assert bem.Solid(np.float32(2.0), poisson_ratio=0) == bem.Solid(2.0, 0.0)
    with pytest.raises(
        ValueError, match=r'solid\.youngs_modulus = "1e6"; .*; solid\.poisson_ratio = 0\.7; allowed: a number'
    ):
        bem.Solid("1e6", 0.7)
    for values, named in [((1e6, 0.5, 1.0), {}), ((1e6, 0.5), {"poisson_ratio": 0.3})]:
        with pytest.raises(TypeError, match="it takes youngs_modulus, poisson_ratio"):
            bem.Solid(*values, **named)


@pytest.mark.parametrize("made", [bem.Solid(1e6, 0.5), bem.Layer(1e-3), bem.Adhesion(0.1, True)], ids=repr)
def test_objects_are_frozen_compared_and_carried(made):
    assert pickle.loads(pickle.dumps(made)) == made
    with pytest.raises(FrozenInstanceError):
        made.other = 1.0
