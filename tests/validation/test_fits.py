"""Fits of the contact area: hold-outs met as stated, coefficients recovered, fit and hold-out disjoint."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

import bem
from persson.contact_slope import COEFFICIENTS as DRY
from persson.contact_slope import contact_fractions
from validation.fits.areas import Means, fit_dry, fit_wet, means_of
from validation.fits.ensembles import Group, areas_of, read_plan, scene_of
from validation.references.paper_problem import MODULUS, RMS_SLOPE


def rms(values):
    return np.sqrt(np.mean(values**2))


def hold_out(law):
    """Relative errors of contact_area, the noise, and whether a case lies in the domain, from the stored ensembles."""
    cells = []
    with (Path(__file__).parent / f"hold_out_{law}.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            group, numbers = Group(row["spectrum"], json.loads(row["parameters"]), ()), ("load", "area", "error")
            load, area, error = (np.array([float(row[name])]) for name in numbers)
            cells.append(Means(group, float(row["theta"]), load, area, error, area, error).judged())
    return np.concatenate(cells, axis=1)


def test_dry_law_meets_its_hold_out():
    """Errors of fitted_area.py: all contact fractions from 0.02, and inside the domain."""
    error, noise, inside, area = hold_out("dry")
    counted = area > 0.02
    assert (counted.sum(), rms(error[counted]), rms(noise[counted])) == pytest.approx((162, 0.039, 0.022), abs=5e-4)
    inner = counted & (inside > 0)
    assert (rms(error[inner]), rms(noise[inner])) == pytest.approx((0.029, 0.0205), abs=1e-3)
    assert inner.sum() == pytest.approx(144, abs=3)  # near the bounds the law's own area decides


def test_wet_law_meets_its_hold_out():
    """Errors of fitted_area.py at contact fractions from 0.05: all lie inside the domain."""
    error, noise, inside, area = hold_out("wet")
    counted = area > 0.05
    assert (counted.sum(), rms(error[counted]), rms(noise[counted])) == pytest.approx((98, 0.0486, 0.029), abs=5e-4)
    assert inside[counted].sum() >= 96


DRY_GROUPS = (
    Group("self-affine", [0.3, 12], [1]),
    Group("self-affine", [0.8, 40], [1]),
    Group("band", [6, 9], [1]),
    Group("lines", [[1, 2, 5], 1.0], [1]),
)


def test_dry_fit_recovers_the_coefficients_of_its_data():
    loads, truth = np.array([0.016, 0.06, 0.15]), DRY | {"c": 1.07, "D_0": 0.84, "a_0": 0.12}
    areas = [contact_fractions(group.lines, loads * RMS_SLOPE, truth) for group in DRY_GROUPS]
    means = [Means(g, 0.0, loads, a, 0.01 + 0 * a, a, 0 * a) for g, a in zip(DRY_GROUPS, areas, strict=True)]
    assert fit_dry(means) == pytest.approx(truth, rel=1e-8)  # 3e-12


def test_wet_fit_recovers_the_coefficients_whatever_the_dry_area():
    loads, truth, means = np.array([0.03, 0.06, 0.1, 0.15]), {"k": 2.1, "c": 0.6}, []
    for hurst in (0.4, 0.8):
        group = Group("self-affine", [hurst, 40], [3])
        dry = 1.1 * contact_fractions(group.lines, loads * RMS_SLOPE)
        for theta in (0.01, 0.1):
            wet = Means(group, theta, loads, dry, 0 * dry, dry, 0 * dry).wet_law(truth)
            means.append(Means(group, theta, loads, wet, 0 * dry, dry, 0 * dry))
    assert fit_wet(means) == pytest.approx(truth, rel=1e-7)  # 3e-8


def test_jackknife_is_the_standard_error_of_a_mean():
    wet = 1 + 0.01 * np.random.default_rng(1).standard_normal((40, 2))
    means = means_of(DRY_GROUPS[0], 0.1, np.array([0.1, 0.2]), wet, np.ones((40, 2)))
    assert means.error == pytest.approx(wet.std(0, ddof=1) / np.sqrt(40), rel=0.02)
    assert means.ratio_error == pytest.approx(means.error, rel=1e-12)


@pytest.mark.parametrize("law", ["dry", "wet"])
def test_fit_and_hold_out_share_nothing(law):
    fit, held = (read_plan(law, part) for part in ("fit", "hold_out"))
    assert not {group.name for group in fit.groups} & {group.name for group in held.groups}
    assert not set(fit.seed_roots) & set(held.seed_roots)
    assert not set(fit.loads) & set(held.loads)


def test_realisations_share_slope_and_phases_and_adhesion_enlarges_the_contact():
    loads = np.array([0.03, 0.1])
    for group in DRY_GROUPS[1:]:
        dry, wet = (bem.parse_scene(scene_of(group, loads, 1, 0, theta)) for theta in (0.0, 0.04))
        assert dry.surface().rms_slope == pytest.approx(RMS_SLOPE, rel=1e-12)
        assert dry.profile == wet.profile
        energy = group.lines.full_contact_energy * MODULUS
        assert wet.adhesion.work_of_adhesion / energy == pytest.approx(0.04, rel=1e-12)
        assert np.all(areas_of((loads, 0.04), (group, 1, 0)) > areas_of((loads, 0.0), (group, 1, 0)))
