"""The study of faults: what is caught and by how much, what is not counted, and five faults of the real tables."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from carried import carried, failing, silent
from in_this_process import forking

from validation.__main__ import main
from validation.harness import store
from validation.harness.execution import run_in_processes
from validation.harness.runner import record_of
from validation.harness.schema import Band
from validation.harness.store import Store
from validation.studies.faults import faults
from validation.studies.faults.fault_findings import Finding, Search, compared, excess_of
from validation.studies.faults.fault_injection import Examined, Exposure, Fault, Studied, faults_in
from validation.studies.faults.faults import Runs

HERE = Path(__file__).parent
QUICK = Studied(tuple(f for f in faults_in() if f.quick), modules=("validation.cases.suite.harness",))


def runs(folder, studied=QUICK, jobs=1):
    return Runs(studied, Store(folder, "now", silent), jobs)


@pytest.fixture
def example(apart, forked):
    """The example, importable here."""
    return apart


@pytest.fixture
def apart(monkeypatch):
    """The example, importable here and by worker processes that start afresh."""
    monkeypatch.syspath_prepend(str(HERE))
    for name in [name for name in sys.modules if name.split(".")[0] == "example_faults"]:
        monkeypatch.delitem(sys.modules, name)
    import example_faults

    return example_faults


@pytest.fixture(scope="module")
def studied(tmp_path_factory):
    """The whole study of the example, once: what fails, faults.json and folder."""
    folder = tmp_path_factory.mktemp("faults")
    sys.path.insert(0, str(HERE))
    try:
        import example_faults

        with forking():
            told = failing(carried(faults, folder, quick=False, studied=example_faults.STUDIED))
    finally:
        sys.path.remove(str(HERE))
    return told, json.loads((folder / "faults.json").read_text()), folder


def fault_of(studied, name):
    return next(fault for fault in studied[1]["faults"] if fault["id"] == name)


def test_fault_is_caught_by_the_row_that_moved_and_by_how_much(studied):
    found = fault_of(studied, "off")
    assert found["caught"]
    by = {sight["case"]: sight["excess"] for sight in found["caught_by"]}
    assert by == pytest.approx({"uses-function": 1000.0, "uses-function-loosely": 1 / 0.3})


def test_smallest_size_is_a_decade_that_is_caught_beside_one_that_is_not(studied):
    found = fault_of(studied, "off")
    assert (found["smallest_size_caught"], found["largest_size_missed"]) == (1e-2, 1e-3)  # the tolerance is 1e-3


@pytest.mark.parametrize(
    ("name", "message"), [("crash", "division by zero"), ("blank", "answer"), ("die", "ended without an answer")]
)
def test_what_fails_by_name_is_noticed_and_not_counted_as_caught(studied, name, message):
    found = fault_of(studied, name)
    assert (found["caught"], found["noticed"]) == (False, True)
    assert any(message in reported for reported in found["crashes_and_refusals"].values())


def test_study_fails_for_what_its_case_does_not_notice(studied):
    (why,) = studied[0]
    assert why.endswith("deviates, never: uses-function, which must notice it, does not; nothing notices it")


def test_other_case_that_notices_is_named(example, tmp_path):
    loosely = replace(example.FAULTS[0], case="uses-method")
    (why,) = failing(carried(faults, tmp_path, studied=replace(example.STUDIED, faults=(loosely,))))
    assert why.endswith("uses-method, which must notice it, does not; noticed by uses-function, uses-function-loosely")


def test_planned_faults_are_reported(studied):
    assert studied[1]["planned"] == len(studied[1]["faults"]) == 5


def test_figure_shows_every_fault(studied):
    text = (studied[2] / "faults.svg").read_text()
    assert all(f">{name}<" in text for name in ("off", "crash", "blank", "die", "never"))


def test_red_base_proves_nothing(example, tmp_path, monkeypatch):
    red = Examined((faults_record(example, example.red),), {})
    monkeypatch.setattr(faults, "control_run", lambda *_: red)
    assert failing(carried(faults, tmp_path, studied=example.STUDIED))[0].endswith("deviates, red: deviates")
    assert json.loads((tmp_path / "faults.json").read_text())["faults"] == []


def faults_record(example, compute):
    return record_of(example.case(compute.__name__, compute), compute(), 0.1)


def test_row_that_appears_or_vanishes_is_listed_apart(example):
    record = faults_record(example, example.use_function)
    other = record.model_copy(update={"rows": [record.rows[0].model_copy(update={"quantity": "another"})]})
    sights, failed, apart = compared(Examined((record,), {}), Examined((other,), {}))
    assert (sights, failed, list(apart)) == ([], {}, [record.id])


@pytest.mark.parametrize(("message", "noticed"), [("ValueError: no", True), ("TooSlowError: no answer in 5 s", False)])
def test_case_that_is_cut_off_proves_nothing(example, message, noticed):
    record = faults_record(example, example.use_function)
    ended = record.model_copy(update={"status": "error", "message": message})
    _, failed, apart = compared(Examined((record,), {}), Examined((ended,), {}))
    assert (list(failed), list(apart)) == (([record.id], []) if noticed else ([], [record.id]))


def test_excess_of_a_band_is_counted_from_its_middle(example):
    row = example.compared(1.0, 4.0).rows[0]
    band = Band(low=1.0, high=3.0, cause="c", source="s", review="2099-01-01")
    assert excess_of(row.model_copy(update={"norm": "ratio", "tolerance": None, "band": band})) == 2.0


@pytest.mark.parametrize("last", [0, 1, 4, 9, 15])
@pytest.mark.parametrize("predicted", [0, 3, 12])
def test_search_ends_at_the_last_decade_that_is_seen(last, predicted):
    search = Search(Finding(Fault("f", "w", "m", "a", "b", "c", "s")), [], predicted)
    asked = 0
    while (decade := search.next_decade()) is not None:
        asked += 1
        if decade <= last:
            search.seen = decade
        else:
            search.lost = decade
        assert asked < 20
    assert (search.seen, search.lost) == (last, last + 1)


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        ({"before": "return y"}, "off: example_faults/sources.py holds 'return y' 0 times, exactly once is needed"),
        ({"case": "gone"}, "off: its case is not one of uses-function, uses-function-loosely, uses-method"),
    ],
    ids=["text", "case"],
)
def test_fault_that_does_not_fit_is_refused_before_anything_runs(
    example, tmp_path, monkeypatch, capsys, change, reported
):
    unfit = replace(example.STUDIED, faults=(replace(example.FAULTS[0], **change),))
    monkeypatch.setattr(faults, "Studied", lambda _: unfit)
    assert main(["study", "faults", "--quick", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"error: {reported}\n"
    assert not (tmp_path / "answers").exists()


def test_answers_come_in_the_order_of_the_tasks(apart, tmp_path):
    tasks = [Exposure(apart.FAULTS[0], size, (("uses-function", 10.0),)) for size in (0.5, 0.25)]
    answers = runs(tmp_path, apart.STUDIED, 2).answers(tasks)
    assert [answer.records[0].rows[0].computed for answer in answers] == [[1.5], [1.25]]


def test_interrupted_study_goes_on_to_the_same_report(studied, example, tmp_path, monkeypatch):
    begun = []

    def interrupted(function, tasks, jobs, **options):
        if any(task.fault for task in tasks):
            raise KeyboardInterrupt
        yield from run_in_processes(function, tasks, jobs, **options)

    def noted(function, tasks, jobs, **options):
        begun.extend(task.fault and task.fault.id for task in tasks)
        yield from run_in_processes(function, tasks, jobs, **options)

    monkeypatch.setattr(store, "run_in_processes", interrupted)
    with pytest.raises(KeyboardInterrupt):
        carried(faults, tmp_path, studied=example.STUDIED)
    monkeypatch.setattr(store, "run_in_processes", noted)
    for asked in (["off"], []):  # the control run is not repeated, then nothing is
        assert failing(carried(faults, tmp_path, studied=example.STUDIED)) == []
        assert begun == asked
        begun.clear()
    first = json.loads((tmp_path / "faults.json").read_text())
    assert fault_of((0, first), "off")["caught_by"] == fault_of(studied, "off")["caught_by"]
