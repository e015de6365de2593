"""Study of the slope over the contact: its profiles, the fit finds what made its data, the plan that is stored."""

import json

import numpy as np
import pytest
from carried import carried, failing
from in_this_process import here

from bem.scene.scene import parse_scene
from persson.contact_slope import contact_fractions, data
from validation.harness.verdict import verdict_of
from validation.studies import contact_slope
from validation.studies.contact_slope import RMS_SLOPE, fitted, lines_of, member, misses, name_of, rms, shape_of

LOADS = np.array([0.016, 0.06, 0.15])
GROUPS = (
    {"spectrum": "self-affine", "parameters": [0.3, 12]},
    {"spectrum": "self-affine", "parameters": [0.8, 40]},
    {"spectrum": "band", "parameters": [6, 9]},
    {"spectrum": "lines", "parameters": [[1, 2, 5], 1.0]},
)
TRUTH = data()["coefficients"] | {"c": 1.07, "D_0": 0.84, "a_0": 0.12}


def made(groups=GROUPS, factor=1.0):
    """Ensembles whose means are the theory with the coefficients `TRUTH`."""
    return {
        name_of(group): (
            group,
            factor * contact_fractions(lines_of(group), LOADS * RMS_SLOPE, TRUTH)[0],
            np.full(3, 0.01),
        )
        for group in groups
    }


def test_fit_finds_the_coefficients_that_made_its_data():
    found = fitted(made(), LOADS)
    # 3e-12 measured
    assert found == pytest.approx(TRUTH, rel=1e-8)


def test_miss_is_the_logarithm_of_the_ratio():
    assert misses(made(factor=1.1), LOADS, TRUTH) == pytest.approx(-np.log(1.1), abs=1e-12)


@pytest.mark.parametrize("part", ["fit", "hold_out"])
def test_profiles_of_the_plan_share_the_slope(part):
    plan = data()[part]
    for group in plan["groups"]:
        if shape_of(group)[0][-1] <= 64:
            surface = parse_scene(member(group, LOADS, plan["seed_roots"][0], 0).scene).surface()
            assert surface.rms_slope == pytest.approx(RMS_SLOPE, rel=1e-12)


def test_nothing_of_the_hold_out_is_fitted():
    fit, held = data()["fit"], data()["hold_out"]
    assert not {name_of(group) for group in fit["groups"]} & {name_of(group) for group in held["groups"]}
    assert not set(fit["seed_roots"]) & set(held["seed_roots"])
    assert not set(fit["loads_over_E*h'"]) & set(held["loads_over_E*h'"])


def test_phases_are_independent_between_groups():
    one, other = (member(group, LOADS, 1, 0).scene["profile"]["phases"][:4] for group in GROUPS[:2])
    assert not np.isclose(one, other).any()


def test_unknown_spectrum_is_refused():
    with pytest.raises(ValueError, match="spectrum"):
        shape_of({"spectrum": "white", "parameters": [1, 2]})


def test_hold_out_is_held_against_what_is_stored():
    row = contact_slope.hold_out_row({"area": 0.05}, [0.04], quick=False)
    assert (verdict_of(row), verdict_of(contact_slope.hold_out_row({"area": 0.042}, [0.04], False))) == (
        "deviates", "agrees")  # fmt: skip
    assert verdict_of(contact_slope.hold_out_row({"area": 0.05}, [0.04], quick=True)) == "not run"


@pytest.mark.slow
def test_quick_study_runs(tmp_path):
    report = carried(contact_slope, tmp_path, opener=here)
    assert failing(report) == []
    content = json.loads((tmp_path / "contact-slope.json").read_text("utf-8"))
    assert set(content["coefficients"]) == set(data()["coefficients"])
    assert rms(np.concatenate([np.array(one["misses"]) for one in content["hold_out"].values()])) < 1
    assert report.cases[0].tables[0].columns[-1] == "in the package"
