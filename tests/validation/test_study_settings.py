"""What the study of one's own scene varies: of a random profile, without adhesion, of a scan, and why not more."""

import math

import numpy as np
import pytest
from rough_scene import ROUGH

from bem.scene.scene import parse_scene
from validation.studies.own_scene.settings import BASE, NO_SCAN, settings_of


def sources(tables, folder):
    """Settings of a scene by source: names of those that can be solved, reasons of the others."""
    found = {}
    for one in settings_of(parse_scene(tables, folder), tables, (folder, folder / "parts"), 2, quick=False):
        found.setdefault(one.source, []).append(one.why_not or one.name)
    return found


def test_what_is_varied_of_a_random_profile(tmp_path):
    found = sources(ROUGH, tmp_path)
    assert found["tolerance"] == ["0.01", "0.001", "0.0001", "1e-09", "1e-12"]  # 1e-6 is the scene's
    assert found["max_increment"] == ["0.4", "0.2", "0.1", "0.025", "0.0125"]
    assert (found["cut"], found["seed"]) == (["fewer than 3", "4 harmonics", "16 harmonics"], ["2", "3"])
    assert [found[name] for name in ("detrending", "window", "period")] == [[NO_SCAN]] * 3


def test_what_is_varied_without_adhesion(tmp_path):
    found = sources({name: table for name, table in ROUGH.items() if name != "adhesion"}, tmp_path)
    assert "without adhesion" in found["max_increment"][0]
    assert found["slope term"] == ["no adhesion"]


def test_what_is_varied_of_a_scan(tmp_path):
    x = np.arange(64.0)
    rng = np.random.default_rng(0)
    np.savetxt(tmp_path / "scan.csv", np.column_stack([x, rng.normal(size=64)]))
    scan = {"kind": "samples", "file": "scan.csv", "unit_x": "um", "unit_h": "nm", "harmonics": 20, "detrend": "line"}
    tables = ROUGH | {"profile": scan}
    found = sources(tables, tmp_path)
    assert found["detrending"] == ["none", "mean", "quadratic", "cubic"]
    assert found["cut"] == ["5 harmonics", "10 harmonics", "31 harmonics"]  # as many as the scan holds
    settings = settings_of(parse_scene(tables, tmp_path), tables, (tmp_path, tmp_path / "parts"), 2, quick=True)
    whole, *others = (parse_scene(one.tables, tmp_path) for one in settings if one.source in (BASE, "period", "window"))
    for half in others[-2:]:
        assert half.profile.period == pytest.approx(whole.profile.period / 2, rel=1e-12)
    for other in others:  # the shortest wavelength stays
        assert other.profile.period / other.profile.harmonics == pytest.approx(whole.profile.period / 20, rel=1e-12)
    first, second = (parse_scene(one.tables, tmp_path).scan for one in settings if one.source == "period")
    assert np.array_equal(np.concatenate([first.measured[1], second.measured[1]]), whole.scan.measured[1])


def leaning_scan(folder, tilt, **keys):
    """A scene with a rough scan of 0.3 um rms that is tilted by so many um over its length."""
    x = np.arange(256.0)
    rough = np.cos(2 * np.pi * 7 * x / 256) * 0.3 * math.sqrt(2)
    np.savetxt(folder / "scan.csv", np.column_stack([x, rough + tilt * x / 256]))
    scan = {"kind": "samples", "file": "scan.csv", "unit_x": "um", "unit_h": "um", "detrend": "line"} | keys
    return ROUGH | {"profile": scan}


def test_what_the_scan_rules_out_is_no_alternative(tmp_path):
    found = sources(leaning_scan(tmp_path, 7.0, harmonics=20, periodic="mirror"), tmp_path)
    assert found["detrending"][2:] == ["quadratic", "cubic"]
    for why in found["detrending"][:2]:  # "none" and "mean" leave 7 um over sqrt(12)
        assert why == "the scan rules it out: it leaves 2e-06 m rms, of which 3e-07 m is rough"
    assert sources(leaning_scan(tmp_path, 0.5, harmonics=20), tmp_path)["detrending"][0] == "none"


def test_a_scan_whose_ends_do_not_meet_is_not_tried_as_it_is(tmp_path):
    mirrored = sources(leaning_scan(tmp_path, 7.0, harmonics=20, periodic="mirror", detrend="mean"), tmp_path)
    assert mirrored["window"][0].startswith("the scan rules it out: its ends are ")
    assert sources(leaning_scan(tmp_path, 0.0, harmonics=20, periodic="mirror"), tmp_path)["window"][0] == "as_is"


def test_a_scan_that_is_solved_whole_has_no_finer_cut(tmp_path):
    found = sources(leaning_scan(tmp_path, 0.0, harmonics="all"), tmp_path)
    assert found["cut"] == ["32 harmonics", "64 harmonics", "the scan holds no more"]
