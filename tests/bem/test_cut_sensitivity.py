"""What half and twice the cut of a scan change is what scenes with these cuts give, and asked for as the scene says."""

from dataclasses import replace

import numpy as np
import pytest
from scene_tables import rough, tables

import bem
from bem.__main__ import main
from bem.cut_sensitivity import cut_sensitivity, is_asked
from bem.scene.result_file import read_result
from bem.scene.scene import SceneError, parse_scene

COUNT, SPACING = 200, 1e-6
ROUGH = bem.Profile.self_affine(COUNT * SPACING, 0.8, 1e-7, 90, 3)
X = SPACING * np.arange(COUNT)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scans")
    np.savetxt(folder / "scan.csv", np.column_stack([X, ROUGH.height(X)]), delimiter=",", fmt="%.12g")
    return folder


def scene_of(folder, output=None, adhesion=None, **profile):
    scan = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", **profile}
    return parse_scene(tables(scan, "mean_pressure", [1e3, 2e3], adhesion) | {"output": output or {}}, folder)


@pytest.mark.parametrize(
    ("profile", "others"),
    [
        ({"harmonics": 20}, [{"harmonics": 10}, {"harmonics": 40}]),
        ({"harmonics": 60}, [{"harmonics": 30}]),
        ({"cutoff_short": 1e-5}, [{"cutoff_short": 5e-6}, {"cutoff_short": 2e-5}]),
        ({"cutoff_short": 1e-5, "cutoff_long": 1.5e-5}, [{"cutoff_short": 5e-6, "cutoff_long": 1.5e-5}]),
        ({"cutoff_short": 3e-6, "periodic": "mirror"}, [{"cutoff_short": 6e-6, "periodic": "mirror"}]),
    ],
)
def test_changes_are_those_of_scenes_with_the_other_cuts(folder, profile, others):
    scene = scene_of(folder, **profile)
    result = bem.solve(scene)
    found = cut_sensitivity(scene, result)
    assert [{fact["key"]: fact["value"]} for fact in found] == [
        {key: value for key, value in other.items() if key in found[0]["key"]} for other in others
    ]
    for fact, other in zip(found, others, strict=True):
        expected = bem.solve(scene_of(folder, **other)).targets[0].contact_fraction
        assert fact["contact_fraction"] == pytest.approx(expected, rel=1e-9)
        assert fact["change"] == fact["contact_fraction"] - result.targets[0].contact_fraction
        assert fact["status"] == "converged"


def test_it_is_asked_of_scans_without_adhesion_or_as_said(folder):
    asked = [
        is_asked(scene_of(folder, output, adhesion))
        for adhesion in (None, 1e-3)
        for output in ({}, {"cut_sensitivity": True}, {"cut_sensitivity": False})
    ]
    assert asked == [True, True, False, False, True, False]
    assert "cut_sensitivity" not in scene_of(folder).resolved()["output"]
    scene = scene_of(folder, {"cut_sensitivity": False}, harmonics=5)
    assert cut_sensitivity(scene, bem.solve(scene)) == ()


def test_of_a_path_that_did_not_converge_nothing_is_told(folder):
    scene = scene_of(folder, harmonics=5)
    assert cut_sensitivity(scene, replace(bem.solve(scene), status="not_converged")) == ()


def test_other_profiles_have_no_cut():
    scene = tables(rough(9), "mean_pressure", [1e3])
    assert not is_asked(parse_scene(scene))
    with pytest.raises(SceneError, match=r"output\.cut_sensitivity = true; allowed: false; true needs a scan"):
        parse_scene(scene | {"output": {"cut_sensitivity": True}})


def test_a_run_stores_and_says_it(folder, tmp_path, capsys):
    (folder / "scene.toml").write_text(
        '[solid]\nyoungs_modulus = 1e6\npoisson_ratio = 0.5\n[profile]\nkind = "samples"\nfile = "scan.csv"\n'
        'unit_x = "m"\nunit_h = "m"\nharmonics = 20\n[loading]\ncontrol = "mean_pressure"\ntargets = [1e3]\n'
    )
    assert main(["run", str(folder / "scene.toml"), "--out", str(tmp_path / "out")]) == 0
    stored = read_result(tmp_path / "out").cut_sensitivity
    assert [fact["value"] for fact in stored] == [10, 40]
    assert stored[0]["change"] > 0 > stored[1]["change"]
    assert "cut: the contact fraction at the first target is" in capsys.readouterr().err
