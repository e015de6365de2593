"""Theory correction: the fit finds what made its data, the hold-out stays out, the judge measures, the page reports."""

import json
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from carried import carried, failing
from in_this_process import here

import persson
from persson.corrected_variance import LITERATURE
from validation.harness.provenance import provenance
from validation.harness.verdict import verdict_of
from validation.references.paper_problem import MODULUS
from validation.report.render import render
from validation.studies.theory_correction import page as correction_page
from validation.studies.theory_correction import theory_correction
from validation.studies.theory_correction.correction_members import STRESSES, Group, Observed, mean_of, relative_errors
from validation.studies.theory_correction.fit import NAMES, areas_of, calibrate, correction_from
from validation.studies.theory_correction.hold_out import CALIBRATED, PLAIN, judge, rms
from validation.studies.theory_correction.page import chosen

TRUTH = (0.7, 0.8, 2.0)
DRY, WET = Group("hold-out", "self-affine", 0.6, 12, 0.0, 4), Group("hold-out", "self-affine", 0.6, 12, 0.04, 4)


def ensemble(group, factor=1.0, noise=0.01):
    """An ensemble whose mean is the corrected theory: in the fit its factor with the coefficients `TRUTH`."""
    areas = factor * said(group)
    spread = 1 + noise * np.array([-1.0, 1.0, -1.0, 1.0])[:, None]
    return Observed(
        group,
        areas * spread,
        np.full((4, areas.size), 0.5) * spread,
        areas[:, None] * np.where(STRESSES < 0.1, 1.0, 0.0) * spread[:, :, None],
        0,
        ("abc",),
    )


@cache
def said(group):
    """Areas by the corrected theory."""
    if group.part == "fit":
        return areas_of(group, correction_from(TRUTH))
    given = {"youngs_modulus": 1e6, "poisson_ratio": 0.5, "work_of_adhesion": group.work_of_adhesion}
    states = (persson.corrected.solve(group.lines, load * MODULUS, **given) for load in group.loads)
    return np.array([state.contact_fraction for state in states])


def fit_groups():
    return [Group("fit", "self-affine", h, m, 0.0, 4) for h in (0.4, 0.8) for m in (8, 16)]


@pytest.fixture(scope="module")
def found():
    """The fit to ensembles of which one has no state at a load."""
    made = [ensemble(group) for group in fit_groups()]
    made[1].areas[:, 2] = np.nan
    return calibrate(made)


@pytest.mark.parametrize("name", NAMES)
def test_calibration_finds_the_coefficients_that_made_its_data(found, name):
    # 8e-5 measured, the mesh of the fit being coarser
    assert found.values[name] == pytest.approx(TRUTH[NAMES.index(name)], abs=2e-3)
    assert found.errors[name] < 5e-3


@pytest.mark.parametrize("other", [DRY, replace(fit_groups()[0], theta=0.03)], ids=["hold-out", "with adhesion"])
def test_hold_out_and_adhesion_are_refused_by_the_calibration(other):
    with pytest.raises(ValueError, match="held out or with adhesion"):
        calibrate([ensemble(group) for group in [*fit_groups(), other]])


def test_calibration_needs_two_exponents():
    with pytest.raises(ValueError, match="two Hurst exponents"):
        calibrate([ensemble(group) for group in fit_groups() if group.hurst == 0.4])


def test_small_groups_take_the_scatter_of_those_like_them():
    many = ensemble(DRY, noise=0.1)
    few = replace(ensemble(replace(DRY, harmonics=16)), areas=ensemble(DRY).areas[:1])
    errors = relative_errors([many, few])
    own = np.std(many.areas, axis=0, ddof=1) / many.area
    assert errors[many.group.name] == pytest.approx(own / 2)
    assert errors[few.group.name] == pytest.approx(own)


def test_error_of_a_group_that_stands_alone_is_unknown():
    one = ensemble(DRY)
    with pytest.raises(ValueError, match="unknown"):
        relative_errors([replace(one, areas=one.areas[:1])])


def test_mean_passes_over_what_is_missing():
    assert mean_of(np.array([[1.0, np.nan], [2.0, np.nan]]))[0] == 1.5


@pytest.mark.parametrize("group", [DRY, WET], ids=["dry", "wet"])
def test_judge_finds_the_error_it_is_given(group):
    made = ensemble(group, factor=1.25)
    one = judge(replace(made, areas=made.areas[:, :6]), np.full(6, 0.01), correction_from(TRUTH), lambda _: None, True)[
        3
    ]
    assert one.area[CALIBRATED] == pytest.approx(0.8 - 1, abs=1e-3)
    plain = persson.solve(
        group.lines,
        one.load * MODULUS,
        youngs_modulus=1e6,
        poisson_ratio=0.5,
        work_of_adhesion=group.work_of_adhesion,
        resolution=0.4,
    )
    assert one.area[PLAIN] == pytest.approx(plain.contact_fraction / one.contact_fraction - 1, rel=1e-9)
    assert one.separations[PLAIN] == pytest.approx(plain.separation / group.lines.h_rms, rel=1e-9)
    assert 0 < one.distribution[CALIBRATED] < 1


def test_judge_tries_the_corrections_of_the_literature():
    one = judge(ensemble(DRY), np.full(6, 0.01), correction_from(TRUTH), lambda _: None)[2]
    assert set(one.area) == {PLAIN, CALIBRATED, *LITERATURE}


@pytest.fixture(scope="module")
def made():
    """What the judge finds where areas are 1.1 times those of the theory."""
    return judge(ensemble(DRY, 1.1), np.full(6, 0.01), correction_from(TRUTH), lambda _: None, True)


@pytest.fixture(scope="module")
def content(found, made):
    return theory_correction.calibration_content(found, [ensemble(g) for g in fit_groups()], made, provenance())


@pytest.fixture
def few_spectra(monkeypatch):
    """The tables of what to expect for two of the spectra alone; the slow test makes all of them."""
    monkeypatch.setattr(correction_page, "SHOWN_HURSTS", (0.7,))
    monkeypatch.setattr(correction_page, "SHOWN_BANDWIDTHS", (30, 1000))


def page_of(content, made, short):
    """The report of the page alone."""

    def cases(bench):
        return [correction_page.case_of(lambda: correction_page.outcome(content, made, 6, short), content["domain"])]

    return cases


def test_page_says_what_was_measured(content, made, few_spectra, tmp_path):
    report = carried(SimpleNamespace(cases=page_of(content, made, short=False)), tmp_path)
    rows = {row.quantity.split(",")[0]: row.computed[0] for row in report.cases[0].rows}
    assert rows["area without adhesion"] == pytest.approx(1 - 1 / 1.1, rel=1e-3)
    assert rows["separation without adhesion"] == pytest.approx(rms([o.error("separation", CALIBRATED) for o in made]))
    page = render(report)
    assert [table.caption.split(",")[0] for table in report.cases[0].tables[:3]] == [
        "Without adhesion",
        "Without adhesion",
        "With adhesion",
    ]
    # boundary elements, 10 realisations: 0.168 +- 0.0014 at p/(E* h'_rms) = 0.08, 0.262 +- 0.0012 at 0.13
    areas = {tuple(row[:2]): row[2:] for row in report.cases[0].tables[0].rows}
    assert areas[0.7, 1000][3] == pytest.approx(0.205, abs=0.006)
    assert "Must not be used for" in page and "landing-correction-without-adhesion" in page


def test_short_form_judges_nothing(content, made, few_spectra):
    rows = correction_page.outcome(content, made, 6, True).rows
    assert {row.status for row in rows} == {"not run"}
    assert len(chosen(made, adhesive=True)) == 0


@pytest.mark.slow
def test_quick_study_runs_and_goes_on_where_it_ended(tmp_path):
    assert failing(carried(theory_correction, tmp_path, opener=here)) == []
    content = json.loads((tmp_path / "theory-correction.json").read_text("utf-8"))["calibration"]
    assert not (tmp_path / "calibration.json").exists()
    assert set(content["coefficients"]) == set(NAMES)
    again = []
    assert failing(carried(theory_correction, tmp_path, say=again.append, opener=here)) == []
    assert "are there already" in again[0].text
    repeated = json.loads((tmp_path / "theory-correction.json").read_text("utf-8"))["calibration"]
    assert repeated["coefficients"] == content["coefficients"]


def test_a_kind_that_was_not_judged_is_an_error(content, few_spectra):
    rows = correction_page.outcome(content, [], 6, False).rows
    assert [verdict_of(row) for row in rows] == ["error"] * 6
