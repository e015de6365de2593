"""The runner: every planned case is reported, finished ones are kept, a crash is a row, a death harms nobody else."""

import json
from pathlib import Path

import pytest

from validation.runner import run_cases, write_atomically
from validation.verdict import case_verdicts


@pytest.fixture
def examples(monkeypatch):
    """The example cases, importable here and, since workers get this search path, there."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    import example_cases

    return example_cases


def run(cases, folder, jobs=1, notes=None):
    return run_cases(cases, folder, jobs, (lambda note: None) if notes is None else notes.append)


def times_run(folder):
    return len((folder / "runs").read_text())


def test_records_come_in_the_order_of_the_cases(examples, tmp_path):
    cases = [examples.case(name, examples.agree) for name in ("b", "c", "a")]
    assert [record.id for record in run(cases, tmp_path, jobs=2)] == ["b", "c", "a"]


def test_no_case_is_no_record(tmp_path):
    assert run([], tmp_path) == []


@pytest.mark.parametrize(
    ("kind", "message"),
    [("crash", "ZeroDivisionError: the matrix is singular"), ("leave", "SystemExit: gone"), ("die", "worker process")],
)
def test_case_that_ends_badly_is_an_error_row_and_spares_the_others(examples, tmp_path, kind, message):
    cases = [examples.case(kind, getattr(examples, kind)), examples.case("fine", examples.agree)]
    bad, fine = run(cases, tmp_path)
    assert (bad.status, case_verdicts(bad)) == ("error", ["error"])
    assert message in bad.message
    assert case_verdicts(fine) == ["agrees"]


def test_traceback_of_a_crash_is_kept(examples, tmp_path):
    run([examples.case("crash", examples.crash)], tmp_path)
    assert "in crash" in (tmp_path / "cases" / "crash.log").read_text()


def test_skipped_case_is_not_run_with_its_reason(examples, tmp_path):
    (record,) = run([examples.case("skip", examples.skip)], tmp_path)
    assert case_verdicts(record) == ["not run"]
    assert record.message == "the extra 'peers' is not installed"


def test_workers_use_one_thread(examples, tmp_path):
    (record,) = run([examples.case("threads", examples.threads)], tmp_path)
    assert record.counts == {"threads": 1}


def test_finished_case_is_not_run_again(examples, tmp_path):
    first = run([examples.noting(tmp_path)], tmp_path)
    notes = []
    again = run([examples.noting(tmp_path), examples.case("b", examples.agree)], tmp_path, notes=notes)
    assert times_run(tmp_path) == 1
    assert again[0] == first[0]
    assert notes[0].text == "1 of 2 cases are there already"


def test_interrupted_run_keeps_what_was_finished(examples, tmp_path):
    cases = [examples.noting(tmp_path), examples.case("stop", examples.interrupt)]
    with pytest.raises(KeyboardInterrupt):
        run(cases, tmp_path)
    run([examples.noting(tmp_path)], tmp_path)
    assert times_run(tmp_path) == 1


@pytest.mark.parametrize("kind", ["crash", "die"])
def test_failed_case_runs_again(examples, tmp_path, kind):
    run([examples.case("a", getattr(examples, kind))], tmp_path)
    (record,) = run([examples.case("a", examples.agree)], tmp_path)
    assert case_verdicts(record) == ["agrees"]


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_text("{"),
        lambda path: path.write_text("[]"),
        lambda path: path.write_text(json.dumps(json.loads(path.read_text()) | {"key": "made by other code"})),
        lambda path: path.write_text(json.dumps({"key": json.loads(path.read_text())["key"], "record": {}})),
    ],
    ids=["cut off", "other content", "other code", "incomplete"],
)
def test_record_that_cannot_be_trusted_is_computed_again(examples, tmp_path, damage):
    run([examples.noting(tmp_path)], tmp_path)
    damage(tmp_path / "cases" / "note.json")
    run([examples.noting(tmp_path)], tmp_path)
    assert times_run(tmp_path) == 2


def test_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "report.json"
    write_atomically(path, "old")
    monkeypatch.setattr(Path, "replace", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        write_atomically(path, "new")
    assert path.read_text() == "old"
