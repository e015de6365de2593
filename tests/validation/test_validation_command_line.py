"""The command line: exit codes, what stdout and stderr say, bad input reported before anything is run."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from drawn_once import drawn_once

from validation import __main__ as command_line
from validation.__main__ import main
from validation.command_line import front_door
from validation.harness import baseline
from validation.harness.schema import Table
from validation.report import render
from validation.studies import convergence
from validation.studies.bench import none_of, study_case
from validation.studies.own_scene import BUDGET, SEEDS

HERE = Path(__file__).parent


@pytest.fixture
def apart(monkeypatch, tmp_path):
    """The example cases in processes of their own; baselines in a new folder, from sources that count as committed."""
    monkeypatch.syspath_prepend(str(HERE))
    monkeypatch.setattr(baseline, "FOLDER", tmp_path / "baselines")
    monkeypatch.setattr(baseline, "working_tree", lambda: ("0" * 40, False))
    import example_cases

    return example_cases


@pytest.fixture
def examples(apart, in_this_process):
    """The same, run in this process."""
    return apart


@pytest.fixture
def registered(apart, monkeypatch):
    """Replace the registry: name of the case to name of its function."""

    def use(**computes):
        found = tuple(
            apart.case(name, getattr(apart, compute), sources=("johnson1995",)) for name, compute in computes.items()
        )
        monkeypatch.setattr(command_line, "registry", lambda: found)

    return use


@pytest.fixture
def cases(registered, in_this_process, monkeypatch):
    """The same, run in this process; equal figures are drawn once."""
    monkeypatch.setattr(render, "svg_of", drawn_once)
    return registered


def run(out, *words):
    return main(["run", "--jobs", "1", "--out", str(out), *words])


def report_of(out):
    return json.loads((out / "report.json").read_text())


def test_run_that_agrees_ends_with_0_and_one_line(cases, tmp_path, capsys):
    cases(fine="agree")
    assert run(tmp_path / "out") == 0
    reported = capsys.readouterr()
    assert reported.out.count("\n") == 1
    assert reported.out.startswith("1 case: 1 agrees; ")
    assert str(tmp_path / "out" / "report.html") in reported.out
    assert "[1/1] fine" in reported.err


def test_run_writes_report_and_page(cases, tmp_path):
    cases(fine="agree")
    run(tmp_path)
    assert (tmp_path / "report.html").exists()
    written = report_of(tmp_path)
    assert (written["planned"], [case["id"] for case in written["cases"]]) == (1, ["fine"])


def test_verify_of_the_front_door_is_run(cases, tmp_path, capsys):
    cases(fine="deviate")
    assert front_door.main(["verify", "--jobs", "1", "--out", str(tmp_path)]) == 1
    assert "FAILED fine" in capsys.readouterr().err
    assert report_of(tmp_path)["command"].startswith("python -m validation run --level quick")
    assert front_door.main(["report", str(tmp_path)]) == 1


def test_report_holds_its_provenance(stored):
    facts = report_of(stored)["provenance"]
    assert all(facts[fact] for fact in ("commit", "blas", "date", "sources_sha256", "jobs"))


def test_report_says_how_long_it_took(cases, tmp_path, monkeypatch):
    cases(fine="agree")
    monkeypatch.setattr(command_line, "time", SimpleNamespace(monotonic=iter([3.0, 10.25]).__next__))
    run(tmp_path)
    assert report_of(tmp_path)["provenance"]["seconds"] == 7.2


def test_report_names_no_folder_of_the_machine(cases, tmp_path):
    cases(fine="agree")
    run(tmp_path / "out")
    assert str(tmp_path) not in (tmp_path / "out" / "report.json").read_text()


@pytest.mark.parametrize(
    ("compute", "message"),
    [
        ("deviate", "FAILED bad: load: deviates, error 0.5, allowed 0.1"),
        ("crash", "FAILED bad: error, ZeroDivisionError: the matrix is singular"),
        ("die", "FAILED bad: error, WorkerDiedError"),
    ],
)
def test_what_fails_is_named_and_ends_with_1(registered, forked, tmp_path, capsys, compute, message):
    registered(fine="agree", bad=compute)
    assert run(tmp_path) == 1
    assert message in capsys.readouterr().err
    assert [case["id"] for case in report_of(tmp_path)["cases"]] == ["fine", "bad"]


def test_skipped_case_is_counted_and_does_not_gate(cases, tmp_path, capsys):
    cases(fine="agree", peers="skip")
    assert run(tmp_path) == 0
    assert "1 not run" in capsys.readouterr().out


def test_summary_as_json(cases, tmp_path, capsys):
    cases(fine="agree", bad="deviate")
    assert run(tmp_path, "--json") == 1
    summary = json.loads(capsys.readouterr().out)
    assert summary["verdicts"] == {"agrees": 1, "deviates": 1}
    assert (summary["cases"], summary["planned"], summary["failed"]) == (2, 2, True)


def test_only_runs_what_it_names(cases, tmp_path):
    cases(fine="agree", bad="deviate")
    assert run(tmp_path, "--only", "fine") == 0
    assert [case["id"] for case in report_of(tmp_path)["cases"]] == ["fine"]


def test_same_command_does_not_compute_again(examples, monkeypatch, tmp_path):
    monkeypatch.setattr(command_line, "registry", lambda: (examples.noting(tmp_path),))
    run(tmp_path)
    run(tmp_path)
    assert (tmp_path / "runs").read_text() == "x"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--only", "other"], "matches no case of: fine, bad"),
        (["--level", "now"], "quick, standard, full"),
        (["--executor", "cluster"], "neither 'local' nor 'dask://host:port'"),
        (["--jobs", "0"], "an integer >= 1"),
        (["--jobs", "two"], "an integer >= 1"),
    ],
)
def test_bad_request_is_told_before_anything_is_written(cases, tmp_path, capsys, words, message):
    cases(fine="agree", bad="deviate")
    assert exit_code(["run", "--out", str(tmp_path / "out"), *words]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def exit_code(words):
    """Exit code, also where argparse ends the program."""
    try:
        return main(words)
    except SystemExit as error:
        return error.code


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["convergence", "--peers"], "--peers: study convergence does not take it, work-precision does"),
        (["work-precision", "--peers"], "not installed: pip install"),
        (["work-precision", "--executor", "dask://host:1"], "runs on this machine only"),
        (["convergence", "--jobs", "2"], "study convergence runs in one process"),
        (["stability", "--random", "2", "--quick"], "--quick: has no meaning with --random"),
        (["scene", "one-wave.toml", "--json"], "--json: study scene does not take it"),
        (["other"], "invalid choice"),
    ],
)
def test_bad_request_of_a_study_is_told_before_anything_is_written(monkeypatch, tmp_path, capsys, words, message):
    monkeypatch.setattr("validation.harness.route.find_spec", lambda name: None)
    assert exit_code(["study", *words, "--out", str(tmp_path / "out")]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_folder_that_is_a_file_is_bad_input(cases, tmp_path, capsys):
    cases(fine="agree")
    (tmp_path / "out").write_text("mine")
    assert run(tmp_path / "out") == 2
    assert "out" in capsys.readouterr().err
    assert (tmp_path / "out").read_text() == "mine"


def test_malformed_baseline_is_told_before_the_run(cases, tmp_path, capsys):
    cases(fine="agree")
    baseline.FOLDER.mkdir()
    (baseline.FOLDER / "fine.json").write_text("{")
    assert run(tmp_path / "out") == 2
    assert "fine.json: malformed baseline" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda path: path.unlink(), "no report there"),
        (lambda path: path.write_text("{"), "not JSON"),
        (lambda path: path.write_text('{"schema": "other/2"}'), "'other/2' is not"),
        (lambda path: path.write_text("[]"), "schema 'list'"),
        (lambda path: path.write_text('{"schema": "linecontact-report/1"}'), "planned"),
    ],
    ids=["missing", "cut off", "other schema", "list", "incomplete"],
)
@pytest.mark.parametrize("words", [["report"], ["baseline", "check", "--out"]], ids=["report", "check"])
def test_report_that_cannot_be_read_is_bad_input(cases, stored, capsys, damage, message, words):
    damage(stored / "report.json")
    assert main([*words, str(stored)]) == 2
    assert message in capsys.readouterr().err


@pytest.fixture
def stored(cases, tmp_path, capsys):
    """A report of one case that agrees."""
    cases(fine="agree")
    assert run(tmp_path / "stored") == 0
    capsys.readouterr()
    return tmp_path / "stored"


def test_report_is_rendered_again_from_its_numbers(stored):
    content = report_of(stored)
    content["cases"][0]["rows"][0]["computed"] = [1.5]
    (stored / "report.json").write_text(json.dumps(content))
    before = (stored / "report.html").read_text()
    assert main(["report", str(stored)]) == 1
    assert (stored / "report.html").read_text() != before


def test_report_with_fewer_cases_than_planned_fails(stored, capsys):
    content = report_of(stored) | {"planned": 2}
    (stored / "report.json").write_text(json.dumps(content))
    assert main(["report", str(stored)]) == 1
    assert "2 cases planned, 1 reported" in capsys.readouterr().err


def update(stored, case="fine", reason="first run"):
    return main(["baseline", "update", case, "--reason", reason, "--out", str(stored)])


def test_missing_baseline_fails_the_check(stored, capsys):
    assert main(["baseline", "check", "--out", str(stored)]) == 1
    assert "fine: no baseline" in capsys.readouterr().err


def test_update_then_check(stored, capsys):
    assert update(stored) == 0
    assert "fine: load: none -> 1" in capsys.readouterr().out
    assert main(["baseline", "check", "--out", str(stored)]) == 0


def test_check_names_what_moved(stored, capsys):
    update(stored)
    content = report_of(stored)
    content["cases"][0]["counts"]["unknowns"] = 20
    (stored / "report.json").write_text(json.dumps(content))
    assert main(["baseline", "check", "--out", str(stored)]) == 1
    assert "unknowns was 7, is 20" in capsys.readouterr().err


def test_baseline_that_no_case_owns_fails_the_check(stored, capsys):
    update(stored)
    (baseline.FOLDER / "gone.json").write_text("{}")
    assert main(["baseline", "check", "--out", str(stored)]) == 1
    assert "gone.json: no case of this name" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("case", "reason", "message"),
    [("other", "why", "case 'other' is not in the report: fine"), ("fine", " ", "--reason")],
)
def test_update_of_nothing_or_for_nothing_is_refused(stored, capsys, case, reason, message):
    assert update(stored, case, reason) == 2
    assert message in capsys.readouterr().err
    assert not baseline.FOLDER.exists()


def test_update_from_a_report_of_other_sources_is_refused(stored, capsys):
    content = report_of(stored)
    content["provenance"]["sources_sha256"] = "of another day"
    (stored / "report.json").write_text(json.dumps(content))
    assert update(stored) == 2
    assert "other sources" in capsys.readouterr().err


@pytest.mark.parametrize(("words", "quick"), [(["--quick"], True), ([], False)])
@pytest.mark.parametrize(("found", "code"), [([], 0), (["seed 1"], 1)], ids=["holds", "fails"])
def test_study_is_a_report_of_its_cases(monkeypatch, tmp_path, capsys, words, quick, found, code):
    yielded = none_of("runs that fail", found), Table(caption="All.", columns=["n"], rows=[[8]])
    seen = []

    def cases(bench):
        seen.append((bench.folder, bench.quick, bench.jobs))
        return [study_case("convergence", lambda: iter(yielded), "What?", "none", "carbone2009")]

    monkeypatch.setattr(convergence, "cases", cases)
    assert main(["study", "convergence", "--out", str(tmp_path), *words]) == code
    assert seen == [(tmp_path, quick, 1)]
    assert (
        report_of(tmp_path)["command"]
        == f"python -m validation study convergence{' --quick' * quick} --out {tmp_path.name}"
    )
    assert "runs that fail" in (tmp_path / "report.html").read_text("utf-8")
    told = capsys.readouterr()
    assert told.out.startswith("All.\nn\n8\n")
    assert ("FAILED convergence: runs that fail: deviates, seed 1" in told.err) == bool(code)


@pytest.mark.parametrize("words", [[], ["dance"], ["study", "dance"], ["run"], ["baseline", "update", "a"]])
def test_incomplete_or_unknown_command_is_bad_input(words):
    assert exit_code(words) == 2


def test_help_of_studies_names_the_defaults(capsys):
    with pytest.raises(SystemExit):
        main(["study", "--help"])
    told = " ".join(capsys.readouterr().out.split())
    assert f"(default: {SEEDS})" in told
    assert f"(default: {BUDGET:g})" in told


@pytest.mark.parametrize("command", ["example", "check one-wave.toml"])
def test_a_reader_of_stdout_that_goes_is_no_message(tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    front_door.main(["example", "one-wave"])
    words = [sys.executable, "-m", "validation.command_line.front_door", *command.split()]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        process.stdout.close()  # as `head` does
        assert process.stderr.read() == b""
    assert process.returncode == 1


INTERRUPTED = """
import sys
sys.path.insert(0, {here!r})
import example_cases as examples
from validation import __main__ as command_line
cases = (examples.case("first", examples.agree), examples.case("second", examples.wait))
command_line.registry = lambda: cases
sys.exit(command_line.main(["run", "--jobs", "2", "--out", {out!r}]))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_interrupt_ends_with_130_and_keeps_what_was_finished(tmp_path):
    out = tmp_path / "out"
    process = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED.format(here=str(HERE), out=str(out))],
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        env=os.environ | {"PYTHONPATH": str(HERE)},
    )
    for line in process.stderr:
        if "first: " in line and "started" not in line:
            break
    time.sleep(1.0)  # one worker waits for work, the other is at it
    os.killpg(process.pid, signal.SIGINT)  # as Ctrl-C in a terminal: parent and workers
    _, reported = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "interrupted" in reported
    assert "Traceback" not in reported
    assert sorted(path.name for path in (out / "cases").iterdir()) == ["first.json"]
