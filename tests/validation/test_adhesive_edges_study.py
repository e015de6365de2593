"""Study of the edges with adhesion: pairs share their profile, the fit finds what made its data, the plan is stored."""

import json

import numpy as np
import pytest
from carried import carried, failing
from in_this_process import here

from bem.scene.scene import parse_scene
from persson.adhesive_edges import data
from persson.contact_slope import contact_fractions
from validation.studies import adhesive_edges
from validation.studies.adhesive_edges import areas_of, fitted, member, misses, paired_areas, summary_of
from validation.studies.contact_slope import RMS_SLOPE, lines_of, name_of

LOADS = np.array([0.03, 0.06, 0.1, 0.15])
GROUP = {"spectrum": "self-affine", "parameters": [0.6, 40], "realisations": 3}
TRUTH = {"k": 2.1, "c": 0.6}


def part(dry_factor=1.0):
    """A part of the data file whose areas are those of the theory with the coefficients `TRUTH`."""
    groups = []
    for hurst in (0.4, 0.8):
        lines = lines_of(GROUP | {"parameters": [hurst, 40]})
        dry = dry_factor * contact_fractions(lines, LOADS * RMS_SLOPE)[0]
        each = [
            {"dry": dry, "wet": paired_areas(lines, LOADS, dry, t, TRUTH), "ratio_error": dry * 0, "wet_error": dry * 0}
            for t in (0.01, 0.1)
        ]
        groups.append(GROUP | {"parameters": [hurst, 40], "areas": each})
    return {"loads_over_E*h'": LOADS, "thetas": (0.01, 0.1), "groups": groups}


@pytest.mark.parametrize("factor", [pytest.param(1.0, marks=pytest.mark.slow), 1.1])
def test_fit_finds_the_coefficients_whatever_the_area_without_adhesion(factor):
    # 3e-8 measured
    assert fitted(part(factor)) == pytest.approx(TRUTH, rel=1e-7)


def test_pairs_on_the_law_itself_are_the_law():
    lines = lines_of(GROUP)
    dry = contact_fractions(lines, LOADS * RMS_SLOPE)[0]
    # 2.5e-7 measured, the grid of p_d
    assert paired_areas(lines, LOADS, dry, 0.05) == pytest.approx(areas_of(lines, LOADS, 0.05), rel=8e-7)


def test_only_cases_inside_the_domain_count():
    few = part() | {"groups": [one | {"spectrum": "lines", "parameters": [[1, 2, 4], 1.0]} for one in part()["groups"]]}
    assert misses(few, None, paired=False).shape[1] == 0
    assert misses(few, None, paired=False, inside=False).shape[1] > 0


def test_jackknife_is_the_standard_error_of_a_mean():
    draw = np.random.default_rng(1)
    wet = 1 + 0.01 * draw.standard_normal((40, 2))
    found = summary_of(np.ones((40, 2)), wet)
    assert found["wet_error"] == pytest.approx(wet.std(0, ddof=1) / np.sqrt(40), rel=0.02)
    assert found["ratio_error"] == found["wet_error"]


def test_load_without_a_state_is_none():
    wet = np.array([[0.1, np.nan], [0.2, 0.5]])
    assert summary_of(np.full((2, 2), 0.1), wet)["wet"] == [0.15, None]


def test_pairs_share_their_profile_and_differ_in_adhesion():
    dry, wet = (parse_scene(member(GROUP, LOADS, 5, 1, theta).scene) for theta in (0.0, 0.03))
    assert dry.profile == wet.profile
    assert (dry.adhesion, wet.adhesion.work_of_adhesion > 0) == (None, True)


@pytest.mark.parametrize("part", ["hold_out", "second_hold_out"])
def test_nothing_of_a_hold_out_is_fitted(part):
    fit, held = data()["fit"], data()[part]
    assert not {name_of(group) for group in fit["groups"]} & {name_of(group) for group in held["groups"]}
    assert fit["seed_root"] != held["seed_root"]
    assert not set(fit["loads_over_E*h'"]) & set(held["loads_over_E*h'"])


@pytest.mark.slow
def test_quick_study_runs(tmp_path):
    report = carried(adhesive_edges, tmp_path, opener=here)
    assert failing(report) == []
    content = json.loads((tmp_path / "adhesive-edges.json").read_text("utf-8"))
    assert set(content["coefficients"]) == set(data()["coefficients"])
    assert content["hold_out_rms"]["hold_out, ratio"]["error"] < 1
    assert report.cases[0].tables[0].columns[-1] == "in the package"
