"""The runner: every planned case is reported, finished ones are kept, a crash is a row, a death harms nobody else."""

import json
import os
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from bem.scene.atomic_file import write_atomically
from validation.harness import runner
from validation.harness.execution import Running, run_in_processes
from validation.harness.executors import Workers
from validation.harness.runner import run_cases
from validation.harness.verdict import case_verdicts


@pytest.fixture
def examples(apart, in_this_process):
    """The example cases, run in this process."""
    return apart


@pytest.fixture
def apart(monkeypatch):
    """The example cases, run in processes of their own, which get this search path."""
    monkeypatch.syspath_prepend(str(Path(__file__).parent))
    import example_cases

    return example_cases


def run(cases, folder, jobs=1, notes=None):
    return run_cases(cases, folder, jobs, (lambda note: None) if notes is None else notes.append)


def times_run(folder):
    return len((folder / "runs").read_text())


def test_records_come_in_the_order_of_the_cases(apart, tmp_path):
    cases = [apart.case(name, apart.agree) for name in ("b", "c", "a")]
    assert [record.id for record in run(cases, tmp_path, jobs=2)] == ["b", "c", "a"]


def test_no_case_is_no_record(tmp_path):
    assert run([], tmp_path) == []


@pytest.mark.parametrize(
    ("kind", "message"),
    [("crash", "ZeroDivisionError: the matrix is singular"), ("leave", "SystemExit: gone"), ("die", "worker process")],
)
def test_case_that_ends_badly_is_an_error_row_and_spares_the_others(request, tmp_path, kind, message):
    examples = request.getfixturevalue("apart")
    request.getfixturevalue("forked" if kind == "die" else "in_this_process")
    cases = [examples.case(kind, getattr(examples, kind)), examples.case("fine", examples.agree)]
    bad, fine = run(cases, tmp_path)
    assert (bad.status, case_verdicts(bad)) == ("error", ["error"])
    assert message in bad.message
    assert case_verdicts(fine) == ["agrees"]


def test_case_that_ran_beside_a_dying_worker_has_its_own_answer(apart, forked, tmp_path):
    cases = [apart.case("slow", apart.dawdle), apart.case("die", apart.die)]
    slow, die = run(cases, tmp_path, jobs=2)
    assert (case_verdicts(slow), case_verdicts(die)) == (["agrees"], ["error"])


def test_traceback_of_a_crash_is_kept(examples, tmp_path):
    run([examples.case("crash", examples.crash)], tmp_path)
    assert "in crash" in (tmp_path / "cases" / "crash.log").read_text()


def test_skipped_case_is_not_run_with_its_reason(examples, tmp_path):
    (record,) = run([examples.case("skip", examples.skip)], tmp_path)
    assert case_verdicts(record) == ["not run"]
    assert record.message == "the extra 'peers' is not installed"


def test_workers_use_one_thread(apart, tmp_path):
    (record,) = run([apart.case("threads", apart.threads)], tmp_path)
    assert record.counts == {"threads": 1}


def test_workers_leave_interrupts_to_the_parent(apart, tmp_path):
    (record,) = run([apart.case("a", apart.interrupts)], tmp_path)
    assert record.counts == {"ignored": 1}


def test_finished_case_is_not_run_again(examples, tmp_path):
    first = run([examples.noting(tmp_path)], tmp_path)
    notes = []
    again = run([examples.noting(tmp_path), examples.case("b", examples.agree)], tmp_path, notes=notes)
    assert times_run(tmp_path) == 1
    assert again[0] == first[0]
    assert notes[0].text == "1 of 2 cases are there already"


def test_case_is_told_when_it_starts_and_when_it_ends(examples, tmp_path):
    notes = []
    run([examples.case("a", examples.agree), examples.case("b", examples.crash)], tmp_path, notes=notes)
    texts = [note.text for note in notes]
    for name in "ab":
        ended = next(place for place, text in enumerate(texts) if f"/2] {name}: " in text)
        assert texts.index(f"{name}: started") < ended
    assert texts[-1].startswith("[2/2]")
    assert "0 s to go" in texts[-1]


def started(notes):
    return [note.text.split(":")[0] for note in notes if note.text.endswith(": started")]


def test_long_case_gives_signs_of_life(apart):
    events = list(run_in_processes(apart.call, [apart.dawdle], 1, pulse=0.2))
    alive = [event for event in events if isinstance(event, Running)]
    assert len(alive) >= 3
    assert alive[-1].items == (apart.dawdle,)
    assert alive[0].seconds < alive[-1].seconds


def test_longest_case_starts_first(examples, tmp_path):
    notes = []
    cases = [examples.case(name, examples.agree) for name in "abc"]
    run_cases(cases, tmp_path, 1, notes.append, expected={"a": 1.0, "b": 100.0, "c": 10.0})
    assert started(notes) == ["b", "c", "a"]


def test_what_a_case_took_before_goes_before_what_is_expected(examples, tmp_path):
    cases = [examples.case(name, examples.agree) for name in "ab"]
    run(cases, tmp_path)
    for name, seconds in (("a", 1.0), ("b", 100.0)):
        path = tmp_path / "cases" / f"{name}.json"
        content = json.loads(path.read_text()) | {"key": "made by other code"}
        content["answer"]["seconds"] = seconds
        path.write_text(json.dumps(content))
    notes = []
    run_cases(cases, tmp_path, 1, notes.append, expected={"a": 1000.0, "b": 1.0})
    assert started(notes) == ["b", "a"]


def test_other_versions_compute_again(examples, tmp_path, monkeypatch):
    run([examples.noting(tmp_path)], tmp_path)
    monkeypatch.setattr(runner, "versions", lambda: {"numpy": "of another day"})
    run([examples.noting(tmp_path)], tmp_path)
    assert times_run(tmp_path) == 2


def test_other_scene_computes_again(examples, tmp_path):
    run([examples.noting(tmp_path)], tmp_path)
    run([replace(examples.noting(tmp_path), scene="a = 2")], tmp_path)
    assert times_run(tmp_path) == 2


def test_sources_that_change_during_the_run_are_told(examples, tmp_path, monkeypatch):
    digests = iter(["before", "after"])
    monkeypatch.setattr(runner, "sources_digest", lambda: next(digests))
    notes = []
    run([examples.case("a", examples.agree)], tmp_path, notes=notes)
    assert "sources changed" in notes[-1].text


def test_case_that_cannot_be_sent_to_a_worker_is_an_error_row(examples, tmp_path):
    (record,) = run([examples.case("a", lambda: None)], tmp_path)
    assert case_verdicts(record) == ["error"]


def test_environment_is_put_back(examples, tmp_path, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    monkeypatch.delenv("MKL_NUM_THREADS", raising=False)
    run([examples.case("a", examples.agree)], tmp_path)
    assert os.environ["OMP_NUM_THREADS"] == "3"
    assert "MKL_NUM_THREADS" not in os.environ


def test_interrupted_run_keeps_what_was_finished(examples, tmp_path):
    cases = [examples.noting(tmp_path), examples.case("stop", examples.interrupt)]
    with pytest.raises(KeyboardInterrupt):
        run(cases, tmp_path)
    run([examples.noting(tmp_path)], tmp_path)
    assert times_run(tmp_path) == 1


@pytest.mark.parametrize("kind", ["crash", "die"])
def test_failed_case_runs_again(apart, forked, tmp_path, kind):
    run([apart.case("a", getattr(apart, kind))], tmp_path)
    (record,) = run([apart.case("a", apart.agree)], tmp_path)
    assert case_verdicts(record) == ["agrees"]


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_text("{"),
        lambda path: path.write_text("[]"),
        lambda path: path.write_text(json.dumps(json.loads(path.read_text()) | {"key": "made by other code"})),
        lambda path: path.write_text(json.dumps({"key": json.loads(path.read_text())["key"], "answer": {}})),
    ],
    ids=["cut off", "other content", "other code", "incomplete"],
)
def test_record_that_cannot_be_trusted_is_computed_again(examples, tmp_path, damage):
    run([examples.noting(tmp_path)], tmp_path)
    damage(tmp_path / "cases" / "note.json")
    run([examples.noting(tmp_path)], tmp_path)
    assert times_run(tmp_path) == 2


@contextmanager
def elsewhere(_):
    """Workers that do not see the folder of the run: what they do is handed back."""
    with ThreadPoolExecutor(1) as pool:
        yield Workers(pool, lambda: 1)


def test_records_of_workers_elsewhere_are_stored_here(examples, tmp_path):
    cases = [examples.case("a", examples.agree), examples.case("b", examples.crash)]
    fine, bad = run_cases(cases, tmp_path, 1, lambda note: None, opener=elsewhere)
    assert (case_verdicts(fine), case_verdicts(bad)) == (["agrees"], ["error"])
    assert "in crash" in (tmp_path / "cases" / "b.log").read_text()
    notes = []
    run([examples.noting(tmp_path), *cases[:1]], tmp_path, notes=notes)
    assert notes[0].text == "1 of 2 cases are there already"


def test_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "report.json"
    write_atomically(path, "old")
    monkeypatch.setattr(Path, "replace", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        write_atomically(path, "new")
    assert path.read_text() == "old"
