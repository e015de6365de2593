"""The cost study: what gates, drift, exponents; a run that fails stays in the table; one small measurement for real."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import example_runs as examples
import pytest
from carried import carried, failing, lines

from validation.harness.verdict import verdict_of
from validation.studies import cost, cost_breakdown
from validation.studies.cost import Drift, PaperRun, drifts_of, exponents_of, judged, measured, realisations_of
from validation.studies.cost_breakdown import dissected


@pytest.fixture
def pair():
    """A run and the same at a quarter of the increment."""
    return [examples.converge(PaperRun(0, 1000, increment)) for increment in (0.05, 0.0125)]


STEADY = (Drift(0, 1e-9, 1e-9),)
PAIR = (PaperRun(0, 100, 0.05), PaperRun(0, 100, 0.0125))


def unmet(runs, drifts=STEADY):
    return [row.quantity for row in judged(runs, drifts) if verdict_of(row) not in ("agrees", "marginal")]


def test_benchmark_is_three_realisations_and_their_quarter_increments():
    tasks = [task for task in realisations_of(quick=True) if task.load is None]
    assert {(task.seed, task.harmonics) for task in tasks} == {(seed, 1000) for seed in (0, 1, 2)}
    assert sorted(task.increment for task in tasks) == [0.0125] * 3 + [0.05] * 3


def test_full_study_shows_path_convergence_of_the_papers_realisations_and_twenty_others():
    tasks = [task for task in realisations_of(quick=False) if task.harmonics == 1000 and task.load is None]
    assert {task.seed for task in tasks} == set(range(31))
    assert sorted(task.increment for task in tasks) == [0.0125] * 31 + [0.05] * 31


def test_full_study_goes_from_125_to_8000_harmonics():
    tasks = [task for task in realisations_of(quick=False) if task.load is None]
    swept = {task.harmonics for task in tasks if (task.seed, task.increment) == (0, 0.05)}
    assert swept == {125, 250, 500, 1000, 2000, 4000, 8000}


def test_nothing_is_unmet_by_good_runs(pair):
    assert unmet(pair, drifts_of(pair)) == []


@pytest.mark.parametrize(
    ("change", "name"),
    [
        ({"status": "not_converged"}, "runs that do not reach every load"),
        ({"loads_asked_for": 3}, "runs that do not reach every load"),
        ({"failed_states": 1}, "runs with failed states"),
        ({"certificates_not_ok": 1}, "runs with states whose certificate is not ok"),
        ({"worst_closure": 1.1e-8}, "worst closure"),
        ({"worst_closure": float("nan")}, "worst closure"),
        ({"peak_megabytes": 2049.0}, "largest memory"),
    ],
)
def test_what_is_not_reached_is_named(pair, change, name):
    assert unmet([replace(pair[0], **change), pair[1]]) == [name]


def test_seconds_do_not_gate(pair):
    assert unmet([replace(pair[0], cpu_seconds=61.0), pair[1]]) == []


@pytest.mark.parametrize(
    ("change", "names"),
    [
        ({"contact_fraction": 1.1e-6}, ["contact fraction at a quarter of the increment, relative change"]),
        ({"separation": 1.1e-6}, ["separation at a quarter of the increment, relative change"]),
        ({"separation": float("nan")}, ["separation at a quarter of the increment, relative change"]),
    ],
)
def test_path_that_is_not_converged_is_named(pair, change, names):
    assert unmet(pair, [Drift(1, 1e-9, 1e-9), replace(Drift(0, 1e-9, 1e-9), **change)]) == names


def test_no_path_convergence_without_a_finer_run(pair):
    assert len(unmet(pair[:1], drifts_of(pair[:1]))) == 2


def test_drift_is_the_largest_relative_change(pair):
    coarse = replace(pair[0], contact_fractions=(0.1, 0.202), separations=(3.3e-5, 2e-5))
    fine = replace(pair[1], contact_fractions=(0.1, 0.2), separations=(3e-5, 2e-5))
    (drift,) = drifts_of([coarse, fine])
    assert drift.contact_fraction == pytest.approx(0.01, rel=1e-12)
    assert drift.separation == pytest.approx(0.1, rel=1e-12)


def test_drift_compares_a_realisation_with_itself_only(pair):
    other = replace(pair[1], seed=1)
    assert drifts_of([pair[0], other]) == []


def test_missing_load_is_infinite_drift(pair):
    (drift,) = drifts_of([pair[0], replace(pair[1], separations=(3e-5,))])
    assert drift.separation == float("inf")


def test_exponent_of_a_power_law_is_found():
    runs = [examples.converge(PaperRun(0, harmonics, 0.05)) for harmonics in (125, 500, 4000)]
    found = exponents_of(runs)
    assert found["cpu_seconds"] == pytest.approx(2.0, abs=1e-12)
    assert found["unknowns"] == pytest.approx(1.0, abs=1e-12)
    assert found["patches"] == pytest.approx(0.0, abs=1e-12)


def test_growth_stands_beside_what_is_asked(here, tmp_path):
    report = study(tmp_path, examples.converge, [*PAIR, PaperRun(0, 250), PaperRun(0, 1000)])
    asked = next(table for table in report.cases[0].tables if table.columns[-1] == "at most")
    assert asked.rows[0] == ["CPU seconds of the slowest run", pytest.approx(1.0), 60.0]
    assert ["exponent of cpu seconds", pytest.approx(2.0), None] in asked.rows
    assert asked.rows[-1][2] == 1.2


def test_seconds_to_a_fraction_are_interpolated_between_states():
    states = [SimpleNamespace(cpu_seconds=c, contact_fraction=f) for c, f in ((1.0, 0.1), (2.0, 0.15), (4.0, 0.25))]
    assert cost._seconds_to(0.2, states) == pytest.approx(5.0, abs=1e-12)
    assert math.isnan(cost._seconds_to(0.3, states))


@pytest.mark.parametrize("change", [{"status": "error"}, {"seed": 1}, {"increment": 0.0125}])
def test_exponent_leaves_out_other_runs(change):
    runs = [examples.converge(PaperRun(0, harmonics, 0.05)) for harmonics in (125, 500)]
    outlier = replace(examples.converge(PaperRun(0, 4000, 0.05)), cpu_seconds=1e6, **change)
    assert exponents_of([*runs, outlier]) == exponents_of(runs)


def study(folder, measure, tasks=PAIR, dissect=None):
    return carried(cost, folder, realisations=tasks, measure=measure, dissect=dissect)


BARE = [task for task in realisations_of(quick=True) if task.load is not None]


@pytest.mark.parametrize(("measure", "failed"), [(examples.converge, 0), (examples.crash_without_adhesion, 1)])
def test_loads_without_adhesion_are_told_stored_and_gate(measure, failed, here, tmp_path):
    report = study(tmp_path, measure, [*PAIR, *BARE])
    rows = report.cases[0].tables[1].rows
    assert [row[:2] for row in rows] == [[n, load] for n in (1000, 10_000) for load in (0.005, 0.01, 0.02)]
    told = failing(report)
    assert len(told) == failed
    assert all(why.startswith("loads without adhesion that are not certified: deviates, ") for why in told)


def test_a_load_without_adhesion_for_real():
    found = measured(PaperRun(0, 50, load=0.01))
    assert found.status == "converged"
    assert 0 < found.contact_fractions[0] < 1
    assert found.worst_closure < 1e-8
    assert min(found.cpu_seconds, found.peak_megabytes, found.unknowns, found.patches, found.evaluations) > 0


def test_study_writes_its_table(here, tmp_path):
    report = study(tmp_path, examples.converge)
    assert failing(report) == []
    assert json.loads((tmp_path / "cost.json").read_text())["schema"] == "linecontact-cost/2"
    assert [row[:3] for row in report.cases[0].tables[0].rows] == [[0, 100, 0.05], [0, 100, 0.0125]]


def test_run_that_crashes_is_a_line_with_its_message(here, tmp_path):
    assert_told(tmp_path, examples.crash, "ZeroDivisionError: the matrix")


def test_run_that_dies_is_a_line_with_its_message(forked, tmp_path):
    """In processes of their own, as the study starts them."""
    assert_told(tmp_path, examples.die, "WorkerDiedError")


def assert_told(tmp_path, measure, message):
    tasks = (PaperRun(1, 100, 0.05), PaperRun(0, 100, 0.05), PaperRun(0, 100, 0.0125))
    told = failing(study(tmp_path, measure, tasks))
    assert f"deviates, seed 1, 100 harmonics, increment 0.05: {message}" in told[0]
    stored = json.loads((tmp_path / "cost.json").read_text())
    assert [run["status"][:5] for run in stored["runs"]] == [message[:5], "conve", "conve"]


def test_breakdown_is_told_and_stored(here, tmp_path):
    tasks = [PaperRun(0, harmonics, step) for harmonics in (100, 200) for step in (0.05, 0.0125)]
    report = study(tmp_path, examples.converge, tasks, examples.apart)
    assert failing(report) == []
    stored = json.loads((tmp_path / "cost.json").read_text())
    assert stored["stage_exponents"]["factorisation"] == pytest.approx(3.0, rel=1e-9)
    stages, evaluation = report.cases[0].tables[3:]
    assert stages.rows[0] == ["factorisation", pytest.approx(1.0), pytest.approx(8.0), pytest.approx(3.0)]
    assert ["seconds", pytest.approx(2.0)] in evaluation.rows
    assert [figure.id for figure in report.cases[0].figures] == ["harmonics", "stages", "patches"]
    assert report.cases[0].figures[2].solution.series[0].notes == ["60", "240", "480", "960"]


def test_breakdown_that_fails_is_told(here, tmp_path):
    report = study(tmp_path, examples.converge, PAIR, examples.never_apart)
    assert "status ZeroDivisionError: no stages None" in lines(report)
    assert failing(report) == [
        "paths that could not be taken apart: deviates, 100 harmonics: ZeroDivisionError: no stages"
    ]


def test_exponents_of_stages_and_patches():
    runs = [examples.apart(n) for n in (100, 200, 400)]
    assert cost_breakdown.stage_exponents(runs) == pytest.approx({"factorisation": 3.0, "gap search": 1.0})
    assert cost_breakdown.patch_exponents(runs[0]) == pytest.approx({"unknowns": 1.0, "seconds": 2.0, "megabytes": 2.0})


def test_path_taken_apart_for_real():
    found = dissected(20)
    assert found.status == "converged"
    assert found.calls["factorisation"] > 0
    assert min(found.stages.values()) >= 0
    assert [one.patches for one in found.evaluated] == sorted({one.patches for one in found.evaluated})
    assert all(one.seconds > 0 and one.megabytes > 0 for one in found.evaluated)


def test_measurement_reaches_the_loads_and_counts():
    found = measured(PaperRun(0, 20, 0.05))
    assert (found.status, len(found.separations)) == ("converged", 8)
    assert (found.failed_states, found.certificates_not_ok) == (0, 0)
    assert found.worst_closure < 1e-8
    assert min(found.cpu_seconds, found.unknowns, found.evaluations, found.accepted, found.peak_megabytes) > 0
