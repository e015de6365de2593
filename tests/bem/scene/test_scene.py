"""The scene contract: what is accepted, what it resolves to, and that every mistake is reported."""

import copy
import math
import os
import pickle
from dataclasses import replace

import numpy as np
import pytest
from stored_states import stored_state

from bem.scene.plausibility import groups_of
from bem.scene.provenance import provenance
from bem.scene.result import Result
from bem.scene.result_file import write_result
from bem.scene.scene import SceneError, load_scene, parse_scene
from bem.scene.scene_file import read_tables

BASE = {
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "profile": {"kind": "self_affine", "period": 0.01, "hurst": 0.7, "rms_height": 50e-6, "harmonics": 20},
    "adhesion": {"work_of_adhesion": 0.03},
    "loading": {"control": "separation", "targets": [60e-6, 30e-6]},
}
WAVE = {"kind": "harmonics", "period": 0.01, "orders": [1, 3], "amplitudes": [1e-5, 2e-6], "phases": [0.0, 1.0]}
PRESSURE = {"control": "mean_pressure", "targets": [1e3]}
METRES = {"unit_x": "m", "unit_h": "m"}
ABSENT = object()
STATE = stored_state(target=False, index=None)


def scene_with(path, value=ABSENT):
    """BASE with one key (or table) set, or removed."""
    data = copy.deepcopy(BASE)
    *tables, key = path.split(".")
    place = data
    for table in tables:
        place = place.setdefault(table, {})
    if value is ABSENT:
        del place[key]
    else:
        place[key] = value
    return data


def mistakes_of(data, base_dir="."):
    with pytest.raises(SceneError) as caught:
        parse_scene(data, base_dir)
    return caught.value.mistakes


def paths_of(data, base_dir="."):
    return [mistake.path for mistake in mistakes_of(data, base_dir)]


@pytest.mark.parametrize(
    ("path", "value", "where"),
    [
        ("solid", ABSENT, "[solid]"),
        ("solid", 3, "solid"),
        ("title", 5, "title"),
        ("solid.youngs_modulus", ABSENT, "solid.youngs_modulus"),
        ("profile.kind", ABSENT, "profile.kind"),
        ("profile.period", ABSENT, "profile.period"),
        ("profile.orders", [1], "profile.orders"),
        ("profile.harmonics", "all", "profile.harmonics"),
        ("profile", {k: v for k, v in WAVE.items() if k != "phases"}, "profile.phases"),
        ("profile", WAVE | {"hurst": 0.5}, "profile.hurst"),
        ("profile", {"kind": "samples"}, "profile.file"),
        ("profile", {"kind": "samples", "file": "nowhere.csv"}, "profile.file"),
        ("profile", {"kind": "samples", "file": "nowhere.csv", "detrend": "parabola"}, "profile.detrend"),
        ("layer", {}, "layer.thickness"),
        ("loading.control", "load", "loading.control"),
        ("loading.control", "total_displacement", "loading.control"),
        ("loading.targets", ABSENT, "loading.targets"),
        ("loading.targets", [60e-6, -1e-6], "loading.targets[1]"),
        ("loading.start", 60e-6, "loading.targets"),
        ("loading", {"control": "separation", "start": 6e-5, "stop": 3e-5}, "loading.count"),
        ("loading", {"control": "separation", "start": 6e-5, "stop": 6e-5, "count": 3}, "loading.stop"),
        ("loading", {"control": "separation", "start": 6e-5, "stop": -3e-5, "count": 3}, "loading.stop"),
        (
            "loading",
            {"control": "separation", "start": 6e-5, "stop": 3e-5, "count": 3, "then_back_to": 1e-5},
            "loading.then_back_to",
        ),
        ("loading.stop_at_mean_pressure", math.nan, "loading.stop_at_mean_pressure"),
        ("loading.at_mean_pressures", [1e3, math.inf], "loading.at_mean_pressures[1]"),
        ("loading.initial", "touching", "loading.initial"),
        ("loading.initial", {"result": "nowhere", "state": 0}, "loading.initial.result"),
        ("loading", PRESSURE | {"initial": "complete_contact"}, "loading.flaw"),
        ("loading.flaw", 0.02, "loading.flaw"),
        ("accuracy", {"tolerance": 1e-13}, "accuracy.tolerance"),
        ("accuracy", {"tolerance": 0.02}, "accuracy.tolerance"),
        ("accuracy", {"max_increment": 0.0}, "accuracy.max_increment"),
        ("output", {"shapes": "all"}, "output.shapes"),
        ("output", {"shapes": [30e-6, math.inf]}, "output.shapes[1]"),
        ("output", {"spectra": [31e-6]}, "output.spectra[0]"),
        ("solid.density", 1e3, "solid.density"),
        ("friction", {}, "friction"),
    ],
)
def test_mistake_is_told_with_its_path(path, value, where, tmp_path):
    assert where in paths_of(scene_with(path, value), tmp_path)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("solid.poisson_ratio", 0.5),
        ("solid.poisson_ratio", -0.999999),
        ("solid.youngs_modulus", 1000000),
        ("profile.hurst", 0.01),
        ("profile", WAVE),
        ("profile", WAVE | {"amplitudes": [0, 0]}),
        ("accuracy", {"tolerance": 1e-12}),
        ("accuracy", {"tolerance": 1e-2}),
        ("loading.targets", [60e-6, 0.0]),
        ("loading", PRESSURE | {"initial": "complete_contact", "flaw": 1e-6}),
        ("loading", PRESSURE | {"targets": [-1e3]}),
        ("adhesion", ABSENT),
        ("output", {"spectra": [30e-6], "pressure_distribution": True}),
    ],
)
def test_edge_of_a_range_is_taken_as_it_is(path, value):
    found = parse_scene(scene_with(path, value)).resolved()
    for name in path.split("."):
        found = found[name]
    if isinstance(value, dict):
        assert {key: found[key] for key in value} == value
    else:
        assert found == (None if value is ABSENT else value)


def test_start_from_complete_contact_without_adhesion_needs_no_flaw():
    data = scene_with("loading", PRESSURE | {"initial": "complete_contact"})
    del data["adhesion"]
    assert parse_scene(data).loading.flaw is None


def test_total_displacement_is_accepted_with_a_layer():
    data = scene_with("layer", {"thickness": 1e-3})
    data["loading"]["control"] = "total_displacement"
    assert parse_scene(data).loading.control == "total_displacement"


def test_all_mistakes_are_told_at_once():
    data = scene_with("solid.poisson_ratio", 0.7)
    data["solid"]["youngs_modulus"] = "soft"
    data["profile"]["hurst"] = 2.0
    del data["profile"]["rms_height"]
    data["loading"]["targets"] = [math.nan, 3e-5, math.inf]
    data["outputs"] = {}
    assert sorted(paths_of(data)) == sorted(
        [
            *("solid.poisson_ratio", "solid.youngs_modulus", "profile.hurst", "profile.rms_height"),
            *("loading.targets[0]", "loading.targets[2]", "outputs"),
        ]
    )


def test_message_holds_path_value_and_what_is_allowed():
    (mistake,) = mistakes_of(scene_with("solid.poisson_ratio", 0.7))
    assert str(mistake) == "solid.poisson_ratio = 0.7; allowed: a number > -1 and <= 0.5"


@pytest.mark.parametrize(
    ("path", "suggested"),
    [("solid.young_modulus", "youngs_modulus"), ("profile.hurts", "hurst"), ("adhesions", "adhesion")],
)
def test_unknown_key_suggests_the_closest(path, suggested):
    (mistake,) = mistakes_of(scene_with(path, 1.0))
    assert mistake.allowed == f'"{suggested}", by its name'


def test_a_removed_key_says_what_to_do_instead():
    (mistake,) = mistakes_of(scene_with("output.cut_sensitivity", True))
    assert str(mistake).startswith("output.cut_sensitivity = true is no longer a key; allowed: leave it out")


def test_defaults():
    scene = parse_scene(BASE)
    assert (scene.profile.seed, scene.adhesion.slope_term, scene.loading.initial) == (0, False, "separated")
    assert (scene.accuracy.tolerance, scene.accuracy.max_increment) == (1e-6, 0.05)
    assert (scene.output.shapes, scene.output.spectra, scene.layer) == (False, False, None)


def test_range_goes_there_and_back_with_the_turning_point_once():
    loading = {"control": "penetration", "start": 1.0, "stop": 3.0, "count": 3, "then_back_to": 0.0}
    assert parse_scene(scene_with("loading", loading)).loading.targets == (1.0, 2.0, 3.0, 1.5, 0.0)


@pytest.mark.parametrize("control", ["separation", "penetration"])
def test_an_output_at_another_value_than_a_target_is_refused_with_the_list_of_targets(control):
    data = scene_with("output", {"shapes": [30e-6, 45e-6], "spectra": [10e-6]})
    data["loading"] = {"control": control, "targets": [60e-6, 30e-6, 60e-6]}
    with pytest.raises(SceneError) as caught:
        parse_scene(data)
    first, second = caught.value.mistakes
    assert (first.path, second.path) == ("output.shapes[1]", "output.spectra[0]")
    assert "a list of targets (6e-05, 3e-05)" in first.allowed


def test_outputs_are_wanted_at_the_targets_listed():
    scene = parse_scene(scene_with("output", {"spectra": [30e-6], "pressure_distribution": True}))
    assert [scene.wants("spectra", index) for index in (0, 1)] == [False, True]
    assert all(scene.wants("pressure_distribution", index) for index in (0, 1))


def test_resolved_scene_parses_to_itself():
    data = scene_with("output", {"shapes": [30e-6]})
    resolved = parse_scene(data).resolved()
    assert parse_scene(resolved).resolved() == resolved


def write_scan(folder, x, h):
    np.savetxt(folder / "scan.csv", np.column_stack([x, h]), delimiter=",")


def test_scan_next_to_the_scene_is_found(tmp_path):
    x = np.arange(64) * (0.01 / 64)
    write_scan(tmp_path, x, 1e-5 * np.cos(2 * np.pi * x / 0.01))
    (tmp_path / "scene.toml").write_text(
        '[solid]\nyoungs_modulus = 1e6\npoisson_ratio = 0.5\n[profile]\nkind = "samples"\nfile = "scan.csv"\n'
        'unit_x = "m"\nunit_h = "m"\n'
        '[loading]\ncontrol = "separation"\ntargets = [5e-6]\n'
    )
    scene = load_scene(tmp_path / "scene.toml")
    assert (scene.profile.harmonics, scene.profile.detrend) == (31, "mean")
    # measured relative differences 2e-16 and 2e-15 (positions hold 19 digits)
    assert scene.profile.period == pytest.approx(0.01, rel=1e-14)
    assert scene.surface().max_height == pytest.approx(1e-5, rel=1e-13)


def test_resolved_scan_is_told_by_name_and_digest_not_by_folder(tmp_path):
    write_scan(tmp_path, np.arange(8.0), np.cos(np.arange(8.0)))
    data = scene_with("profile", {"kind": "samples", "file": str(tmp_path / "scan.csv"), **METRES})
    profile = parse_scene(data).resolved()["profile"]
    assert profile["file"] == "scan.csv"
    assert len(profile["sha256"]) == 64


@pytest.mark.parametrize(
    ("extra", "where"),
    [({"period": 7.0}, "profile.period"), ({"harmonics": 4}, "profile.harmonics")],
    ids=["end point included", "beyond half the samples"],
)
def test_scan_bounds_period_and_harmonics(extra, where, tmp_path):
    write_scan(tmp_path, np.arange(8.0), np.cos(np.arange(8.0)))
    data = scene_with("profile", {"kind": "samples", "file": "scan.csv", **METRES, **extra})
    assert paths_of(data, tmp_path) == [where]


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(b"[solid\n", id="syntax"),
        pytest.param(b"title = '\xff'", id="encoding"),
        pytest.param(b"[output]\nshapes = " + b"[" * 100_000 + b"]" * 100_000, id="nested"),
        None,
    ],
)
def test_file_that_is_no_scene_is_told(content, tmp_path):
    path = tmp_path / "scene.toml"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(SceneError, match=r"scene\.toml"):
        load_scene(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes of POSIX")
def test_a_scene_that_is_no_file_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe.toml")
    for path in (tmp_path / "pipe.toml", "/dev/zero", tmp_path):
        with pytest.raises(SceneError, match=r"a pipe or a device\); allowed: a TOML file"):
            load_scene(path)


def test_a_byte_order_mark_is_no_part_of_a_scene(tmp_path):
    (tmp_path / "scene.toml").write_bytes(b"\xef\xbb\xbf" + b'title = "marked"')
    assert read_tables(tmp_path / "scene.toml") == {"title": "marked"}


def stored_result(folder, tables=None, **changes):
    """An interrupted result of BASE and more tables with one state, in folder/before."""
    parsed, state = parse_scene(BASE | (tables or {})), replace(STATE, **changes)
    scene, groups = parsed.resolved(), groups_of(parsed)
    write_result(Result(scene, (), provenance(scene), (state,), (), "interrupted", groups=groups), folder / "before")
    return scene_with("loading.initial", {"result": "before", "state": 0})


def test_path_from_a_stored_state_begins_there(tmp_path):
    scene = parse_scene(stored_result(tmp_path, separation=20e-6), tmp_path)
    assert (scene.origin, scene.start_state.separation) == (20e-6, 20e-6)


REFUSED = {"status": "not_converged", "certificate": replace(STATE.certificate, ok=False, reasons=("a gap",))}


@pytest.mark.parametrize(
    ("state", "changes", "where"),
    [
        pytest.param(1, {}, "loading.initial.state", id="beyond the last"),
        pytest.param(0, REFUSED, "loading.initial.state", id="not converged"),
    ],
)
def test_stored_state_that_cannot_be_used_is_told(state, changes, where, tmp_path):
    data = stored_result(tmp_path, **changes)
    data["loading"]["initial"]["state"] = state
    assert paths_of(data, tmp_path) == [where]


LAYER = {"thickness": 1e-3}


@pytest.mark.parametrize(("before", "now"), [(None, LAYER), (LAYER, None), (LAYER, {"thickness": 2e-3})], ids=str)
def test_stored_state_of_another_layer_is_told(before, now, tmp_path):
    data = stored_result(tmp_path, {"layer": before} if before else {})
    (mistake,) = mistakes_of(data | ({"layer": now} if now else {}), tmp_path)
    assert "another [layer]" in str(mistake)


def test_stored_state_of_the_same_tables_is_taken(tmp_path):
    data = stored_result(tmp_path, {"layer": LAYER}) | {"layer": LAYER}
    assert parse_scene(data | {"accuracy": {"tolerance": 1e-3}}, tmp_path).start_state == STATE


def test_corrupt_stored_result_is_told(tmp_path):
    data = stored_result(tmp_path)
    path = tmp_path / "before" / "result.json"
    path.write_text(path.read_text().replace('"n_patches": 2', '"n_patches": 3'))
    (mistake,) = mistakes_of(data, tmp_path)
    assert "checksum" in str(mistake)


def test_error_survives_the_way_between_processes():
    with pytest.raises(SceneError) as caught:
        parse_scene({})
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.mistakes) == (str(caught.value), caught.value.mistakes)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("profile.seed", 10**399),
        ("solid.youngs_modulus", 10**399),
        ("profile", {"kind": "samples", "file": "a\0b.csv", **METRES}),
        ("loading.initial", {"result": "a\0b", "state": 0}),
        ("loading.targets", [10**399]),
    ],
)
def test_a_value_that_no_number_or_file_can_be_is_one_mistake(path, value):
    (mistake,) = mistakes_of(scene_with(path, value))
    assert mistake.path.startswith(path)


@pytest.mark.parametrize("share", [1.0, 0.99, 1e-7 / (6e-5 * 0.01)])
def test_the_thinnest_layer_that_is_said_to_be_allowed_is(share):
    thickness = share * 6e-7
    data = scene_with("layer", {"thickness": thickness})
    if share == 1.0:
        assert parse_scene(data).layer.thickness == 6e-7
        return
    (mistake,) = mistakes_of(data)
    assert mistake.found == f"= {thickness!r}"
    assert mistake.allowed.startswith("a number from 6e-07 to ")


@pytest.mark.parametrize("sign", "−–‐")
def test_a_minus_sign_of_unicode_is_named(tmp_path, sign):
    (tmp_path / "scene.toml").write_text(f"[profile]\nharmonics = {sign}12\n", "utf-8")
    with pytest.raises(SceneError, match=f"- before numbers, not {sign}"):
        load_scene(tmp_path / "scene.toml")
