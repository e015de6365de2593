"""The work-precision study: errors and floors, failures that stay, files; its scenes, methods and references."""

import json
import pickle
from dataclasses import replace

import example_methods as example
import numpy as np
import pytest
from carried import carried, failing, lines
from scipy.integrate import quad

from validation.references.closed_forms import Sinusoid
from validation.references.posed_contacts import QUANTITIES, exact_sinusoid, highest, numbers_of, scenes
from validation.routes import finite_elements
from validation.routes.persson_theory import by_separation
from validation.studies.work_precision import work_precision
from validation.studies.work_precision.methods import METHODS, MethodPoint, Timed
from validation.studies.work_precision.references import SOURCES, source_for
from validation.studies.work_precision.work_precision import Sweep, measured, point_of

SINUSOID = scenes()["sinusoid"]


def study(folder, methods, sources):
    return carried(work_precision, folder, methods=methods, sources=sources, with_prices=False)


def test_study_writes_points_conclusion_and_figure(here, tmp_path):
    report = study(tmp_path, [example.method()], example.TRUTH)
    assert failing(report) == []
    stored = json.loads((tmp_path / "work-precision.json").read_text())
    assert [point["error"] for point in stored["points"]] == pytest.approx([0.1, None, 1e-4, 1e-12], abs=1e-15)
    assert [point["within_uncertainty"] for point in stored["points"]] == [False, False, False, True]
    told = lines(report)
    assert any(line.startswith("sinusoid: 4 digits cost least with halving at 0.0001") for line in told)
    assert "halving not run on theory: it is no theory" in told
    _, points, grey, shade = report.cases[0].figures[0].solution.series
    assert points.notes == ["10", "10000", "1000000000000"]
    assert (grey.style, len(grey.x), shade.x[1]) == ("grey", 1, pytest.approx(1e-9))


def test_setting_that_fails_stays_with_its_message(here, tmp_path):
    report = study(tmp_path, [example.method()], example.TRUTH)
    failed = json.loads((tmp_path / "work-precision.json").read_text())["points"][1]["timed"]
    assert (failed["setting"], failed["status"]) == ("0.25", "ArithmeticError: the matrix is singular")
    assert any(line.endswith("the matrix is singular") for line in lines(report))
    assert "Failed: halving at 0.25: ArithmeticError: the matrix is singular." in report.cases[0].figures[0].caption


def test_method_that_fails_everywhere_fails_the_study(here, tmp_path):
    (told,) = failing(study(tmp_path, [example.method(solve=example.never)], example.TRUTH))
    assert told == "methods without an answer at any setting of a scene: deviates, sinusoid, halving"


def test_reference_that_fails_is_told(here, tmp_path):
    told = failing(study(tmp_path, [example.method()], example.LOST))
    assert "sinusoid, reference: lost: answered (1: yes): error, ArithmeticError: reference not converged" in told


def test_measurement_repeats_and_takes_the_least():
    (found,) = measured(Sweep(SINUSOID, example.method(), (0.1,), 5, 10.0))
    assert (found.repeats, found.status) == (5, "done")
    assert found.wall_seconds >= 0.002
    assert found.spread >= 0
    assert found.peak_megabytes > 0


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
def test_methods_reach_other_processes(method):
    task = Sweep(SINUSOID, method, method.settings, 1, 1.0)
    assert repr(pickle.loads(pickle.dumps(task))) == repr(task)


def test_repeats_end_with_their_time():
    (found,) = measured(Sweep(SINUSOID, example.method(), (0.1,), 1000, 0.02))
    assert found.repeats <= 10


def test_errors_are_over_the_scales_of_the_scene():
    reference = example.truth(SINUSOID)
    timed = Timed("1", found=example.off_by(SINUSOID, 0.1))
    point = point_of(SINUSOID, example.method(), timed, reference)
    assert point.errors == pytest.approx({"contact_fraction": 0.1, "mean_pressure": 0.0, "elastic_energy": 0.0})
    assert point.floor == pytest.approx(1e-9)  # of the contact fraction; that of a pressure is 1e-9 Pa


def test_of_several_targets_the_largest_error_counts():
    paper = scenes()["paper"]
    found = numbers_of({"contact_fraction": [0.1, 0.2, None], "mean_pressure": [1.0, 2.0, 3.0]})
    other = numbers_of({"contact_fraction": [0.1, 0.23, 0.3], "mean_pressure": [1.0, 2.0, 3.0]})
    assert paper.errors(found, other) == pytest.approx({"contact_fraction": 0.03, "mean_pressure": 0.0})


def test_digits_are_not_claimed_against_a_finer_run_of_the_same_code():
    itself = replace(example.truth(SINUSOID), kind="self")
    points = [point_of(SINUSOID, example.method(), Timed("1", found=example.off_by(SINUSOID, 1e-4)), itself)]
    (curve,) = work_precision.curves_of(points, "sinusoid")
    assert not curve.independent


def test_theory_at_a_penetration_is_that_at_its_separation():
    rough = scenes()["rough"]
    apart = replace(rough, control="separation", targets=(highest(rough) - rough.penetration,))
    assert by_separation(rough, 0.03).values == by_separation(apart, 0.03).values


def test_finite_elements_begin_at_edges():
    begun = finite_elements.solve(SINUSOID, (2, 4, 4), np.array([[-2.2e-3, 2.2e-3]]))
    found = finite_elements.solve(SINUSOID, (2, 4, 4))
    assert begun.values["contact_fraction"] == pytest.approx(found.values["contact_fraction"], rel=1e-6)


def test_point_below_the_uncertainty_is_grey():
    def point(error):
        return MethodPoint("sinusoid", "m", Timed("1"), {"contact_fraction": error}, floor=1e-6)

    assert point(0.9e-6).grey
    assert not point(1.1e-6).grey


@pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
def test_references_are_of_another_code_and_settings_are_many(method):
    for scene in method.scenes:
        source = source_for(scene, method)
        assert source.code != method.code or (scene == "paper" and source.of_itself)  # where no other code reaches
        minutes = (method.name, scene) == ("fem", "rough")  # one a mesh
        assert len(method.settings_for(scene, quick=False)) >= (3 if minutes else 6)
    assert set(method.scenes) | set(method.cannot) <= set(scenes())


def test_every_scene_is_done_or_told_why_not():
    for scene in ("sinusoid", "layer", "rough", "paper"):
        assert all(scene in method.scenes or scene in method.cannot for method in METHODS)


def test_reference_of_the_same_code_only_is_refused():
    with pytest.raises(ValueError, match="another code than truth"):
        source_for("sinusoid", example.method(code="truth"), example.TRUTH)


def test_closed_gap_and_energy_of_johnsons_state():
    wave, found = Sinusoid(1e-4, 0.01, 1e6, 0.5, 0.3), exact_sinusoid(SINUSOID)
    psi = found["contact_fraction"] * np.pi / 2
    share, tension = np.sin(psi) ** 2, 0.3 * wave.full_contact_pressure * np.sqrt(np.tan(psi))

    def opening(v):  # slope of the gap, continued from the pressure
        root = np.sqrt(np.sin(v) ** 2 - share)
        return 2 / wave.modulus * (2 * wave.full_contact_pressure * np.cos(v) * root + tension * np.cos(v) / root)

    # v = psi + s^2 takes the root singularity away
    gap, _ = quad(lambda s: opening(psi + s * s) * 2 * s, 0, np.sqrt(np.pi / 2 - psi), epsabs=1e-16)
    assert found["gap"] == pytest.approx(gap * wave.wavelength / np.pi, rel=1e-9)

    def work(angle):  # dU = p dDelta + (G - w) da from the point where contact has no width, G = w throughout
        step = 1e-5 * angle
        rate = (float(wave.penetration(angle + step)) - float(wave.penetration(angle - step))) / (2 * step)
        return float(wave.mean_pressure(angle)) * rate + wave.work_of_adhesion * 2 / np.pi

    energy, _ = quad(work, 0, psi, epsrel=1e-9)
    assert found["elastic_energy"] == pytest.approx(energy, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "setting", "error"),
    [("bem", 1e-6, 2e-11), ("bem, dense", 16, 2e-13), ("fem", (2, 6, 6), 1.2e-3), ("paper's method", 32, 1e-3)],
)
def test_methods_find_johnsons_state(name, setting, error):
    (method,) = (method for method in METHODS if method.name == name)
    found = method.solve(SINUSOID, setting)
    errors = SINUSOID.errors(numbers_of(found.values), exact_sinusoid(SINUSOID))
    assert set(errors) == set(QUANTITIES)
    assert set(found.parts) == {"setup", "solve", "post"}
    assert max(errors.values()) < error  # 6e-12, 0, 4e-4, 3.5e-4
    assert found.unknowns > 0


def test_scales_of_a_sinusoid_are_those_of_johnson():
    wave = Sinusoid(1e-4, 0.01, 1e6, 0.5, 0.3)
    assert SINUSOID.scales["mean_pressure"] == pytest.approx(wave.full_contact_pressure, rel=1e-13)


def test_every_scene_has_a_reference():
    assert set(SOURCES) == set(scenes())
