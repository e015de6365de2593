"""The cost study: what gates, drift, exponents; a run that fails stays in the table; one small measurement for real."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import example_runs as examples
import pytest

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
    return [name for name, _, good, _ in judged(runs, drifts) if not good]


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
        ({"status": "not_converged"}, "every load reached"),
        ({"loads_asked_for": 3}, "every load reached"),
        ({"failed_states": 1}, "no failed state"),
        ({"certificates_not_ok": 1}, "every certificate ok"),
        ({"worst_closure": 1.1e-8}, "closure <= 1e-08"),
        ({"worst_closure": float("nan")}, "closure <= 1e-08"),
        ({"peak_megabytes": 2049.0}, "below 2048 MB"),
        ({"cpu_seconds": 61.0}, "at most 60 s of one core (not gating)"),
    ],
)
def test_what_is_not_reached_is_named(pair, change, name):
    assert unmet([replace(pair[0], **change), pair[1]]) == [name]


def test_seconds_do_not_gate(pair):
    assert [name for name, _, _, gates in judged(pair, drifts_of(pair)) if not gates] == [
        "at most 60 s of one core (not gating)"
    ]


@pytest.mark.parametrize(
    ("change", "names"),
    [
        ({"contact_fraction": 1.1e-6}, ["contact fraction at a quarter of the increment within 1e-06"]),
        ({"separation": 1.1e-6}, ["separation at a quarter of the increment within 1e-06"]),
        ({"separation": float("nan")}, ["separation at a quarter of the increment within 1e-06"]),
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


@pytest.mark.parametrize(("power", "expected"), [(1.1, []), (1.3, ["CPU seconds to a contact fraction of 0.2 grow"])])
def test_growth_beyond_the_exponent_asked_for_is_named(pair, power, expected):
    sweep = [
        replace(examples.converge(PaperRun(0, size, 0.05)), cpu_seconds=1.0, cpu_seconds_to_a_fifth=1e-3 * size**power)
        for size in (250, 2000, 8000)
    ]
    assert [name.split(" no faster")[0] for name in unmet([*pair, *sweep])] == expected


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
    return cost.run(folder, True, lambda note: None, tasks, measure, dissect)


BARE = [task for task in realisations_of(quick=True) if task.load is not None]


@pytest.mark.parametrize(("measure", "code"), [(examples.converge, 0), (examples.crash_without_adhesion, 1)])
def test_loads_without_adhesion_are_told_stored_and_gate(measure, code, here, tmp_path, capsys):
    assert study(tmp_path, measure, [*PAIR, *BARE]) == code
    rows = json.loads((tmp_path / "cost.json").read_text())["without_adhesion"]["rows"]
    assert [row[:2] for row in rows] == [[n, load] for n in (1000, 10_000) for load in (0.005, 0.01, 0.02)]
    assert ("NOT MET: every load without adhesion certified" in capsys.readouterr().out) == bool(code)


def test_a_load_without_adhesion_for_real():
    found = measured(PaperRun(0, 50, load=0.01))
    assert found.status == "converged"
    assert 0 < found.contact_fractions[0] < 1
    assert found.worst_closure < 1e-8
    assert min(found.cpu_seconds, found.peak_megabytes, found.unknowns, found.patches, found.evaluations) > 0


def test_study_writes_and_prints_its_table(here, tmp_path, capsys):
    assert study(tmp_path, examples.converge) == 0
    stored = json.loads((tmp_path / "cost.json").read_text())
    assert stored["schema"] == "linecontact-cost/1"
    assert [row[:3] for row in stored["table"]["rows"]] == [[0, 100, 0.05], [0, 100, 0.0125]]
    assert "0       100    0.0125" in capsys.readouterr().out


def test_run_that_crashes_is_a_line_with_its_message(here, tmp_path, capsys):
    assert_told(tmp_path, capsys, examples.crash, "ZeroDivisionError: the matrix")


def test_run_that_dies_is_a_line_with_its_message(forked, tmp_path, capsys):
    """In processes of their own, as the study starts them."""
    assert_told(tmp_path, capsys, examples.die, "WorkerDiedError")


def assert_told(tmp_path, capsys, measure, message):
    tasks = (PaperRun(1, 100, 0.05), PaperRun(0, 100, 0.05), PaperRun(0, 100, 0.0125))
    assert study(tmp_path, measure, tasks) == 1
    reported = capsys.readouterr().out
    assert "NOT MET: every load reached: seed 1, 100: " + message in reported
    stored = json.loads((tmp_path / "cost.json").read_text())
    assert [run["status"][:5] for run in stored["runs"]] == [message[:5], "conve", "conve"]


def test_breakdown_is_told_and_stored(here, tmp_path, capsys):
    tasks = (
        PaperRun(0, 100, 0.05),
        PaperRun(0, 100, 0.0125),
        PaperRun(0, 200, 0.05),
        PaperRun(0, 200, 0.0125),
    )
    assert study(tmp_path, examples.converge, tasks, examples.apart) == 0
    stored = json.loads((tmp_path / "cost.json").read_text())
    assert stored["stage_exponents"]["factorisation"] == pytest.approx(3.0, rel=1e-9)
    reported = capsys.readouterr().out
    assert "200 harmonics, 9.0 s: factorisation 89 %, gap search 11 %" in reported
    assert "seconds of one evaluation grow as patches^2.00 (200 harmonics)" in reported
    assert {path.name for path in tmp_path.glob("*.svg")} == {
        "cost-harmonics.svg",
        "cost-patches.svg",
        "cost-stages.svg",
    }


def test_breakdown_that_fails_is_told(here, tmp_path, capsys):
    study(tmp_path, examples.converge, PAIR, examples.never_apart)
    assert "100 harmonics, stage by stage: ZeroDivisionError: no stages" in capsys.readouterr().out


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
