"""The FFT peers of the study of accuracy: range of cohesion, absence, words, and Johnson's contact."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from carried import carried, lines

from validation.harness import route
from validation.harness.route import Answer
from validation.references.posed_contacts import exact_sinusoid, numbers_of, scenes
from validation.routes import cohesive_grid
from validation.routes.cohesive_grid import cohesive_range, missing
from validation.studies.work_precision import work_precision
from validation.studies.work_precision.methods import MethodPoint, Timed
from validation.studies.work_precision.peers import FFT_METHODS, peer_sentences, peer_table
from validation.studies.work_precision.references import source_for

SINUSOID = scenes()["sinusoid"]


def point(method, setting, error, seconds, area, scene="rough"):
    values = {"contact_fraction": [area], "mean_pressure": [1.0]}
    reported = {"cohesive range / m": 1e-6} if method.startswith("fft") else {}
    found = Answer(values=values, unknowns=setting, details=reported)
    errors = {"contact_fraction": error, "mean_pressure": error / 10}
    return MethodPoint(scene, method, Timed(str(setting), found=found, cpu_seconds=seconds), errors, 1e-9, "bem")


POINTS = [
    point("fft, c = 8", 1024, 3e-2, 2.0, 0.22),
    point("fft, c = 8", 2048, 1e-2, 9.0, 0.24),
    point("fft, c = 16", 2048, 2e-2, 8.0, 0.20),
    point("bem", 100, 1e-6, 3.0, 0.25),
    point("paper's method", 6, 5e-2, 1.0, 0.25),
]


@pytest.mark.parametrize("spacings", [8, 16])
def test_cohesion_acts_along_the_spacings_asked_for(spacings):
    modulus = SINUSOID.youngs_modulus / (1 - SINUSOID.poisson_ratio**2)
    rho = cohesive_range(SINUSOID, 4096, spacings)
    along = modulus * rho**2 / SINUSOID.work_of_adhesion
    assert along == pytest.approx(spacings * SINUSOID.period / 4096, rel=1e-13)


def test_words_say_who_needs_what_time_for_which_error():
    reported = " ".join(peer_sentences(POINTS))
    assert "the best of fft, c = 8 is an error of 1.0e-02 at 2048 points, rho = 1 um, in 9 s" in reported
    assert "as small an error takes bem 3 s (error 1.0e-06 at 100), paper's method never" in reported


def test_words_say_how_much_the_area_depends_on_the_range():
    reported = " ".join(peer_sentences(POINTS))
    assert (
        "on 2048 points the area changes by 20 % when rho grows by sqrt 2, over all grids and ranges by 20 %"
        in reported
    )


def test_table_lists_the_peers_only():
    assert [row[1:4] for row in peer_table(POINTS)] == [
        ["fft, c = 8", 1024, 1.0],
        ["fft, c = 8", 2048, 1.0],
        ["fft, c = 16", 2048, 1.0],
    ]


def test_failed_points_are_left_out_of_words_and_table():
    failed = replace(POINTS[0], timed=Timed("1024", "MethodError: no"), errors={})
    assert peer_table([failed]) == []
    assert list(peer_sentences([failed])) == []


@pytest.mark.parametrize("method", FFT_METHODS, ids=lambda method: method.name)
def test_peers_reach_other_processes_and_have_references_of_another_code(method):
    assert pickle.loads(pickle.dumps(method)).solve.args == method.solve.args
    assert all(source_for(scene, method).code != method.code for scene in method.scenes)


@pytest.mark.parametrize("scene", ["sinusoid", "rough"])
def test_grids_of_1024_to_65536_points_are_tried(scene):
    tried = {points for method in FFT_METHODS for points in method.settings_for(scene, quick=False)}
    assert tried == {2**k for k in range(10, 17)}


def test_absent_peers_are_named(monkeypatch):
    monkeypatch.setattr(route, "find_spec", lambda name: None if name == "Adhesion" else name)
    assert missing() == 'Adhesion not installed: pip install ".[peers]"'


def test_study_says_that_absent_peers_are_not_run(monkeypatch, tmp_path):
    monkeypatch.setattr(cohesive_grid, "missing", lambda: "Adhesion not installed")
    report = carried(work_precision, tmp_path, methods=(), sources={}, with_prices=False)
    assert "fft not run: Adhesion not installed" in lines(report)


@pytest.mark.skipif(bool(missing()), reason="needs the extra peers")
def test_peer_finds_johnsons_contact():
    exact = exact_sinusoid(SINUSOID)
    found = [cohesive_grid.solve(SINUSOID, points, 8, 1) for points in (1024, 2048)]
    errors = [SINUSOID.errors(numbers_of(one.values), exact) for one in found]
    assert max(errors[0].values()) < 0.02  # 0.012, of the area
    assert errors[1]["contact_fraction"] < 0.7 * errors[0]["contact_fraction"]  # 0.5: like rho squared
    assert np.max([error["mean_pressure"] for error in errors]) < 1e-3  # 2.6e-4
