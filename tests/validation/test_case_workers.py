"""Runs by `python -m validation run` with worker processes: deaths, hangs, interrupts, and what a user sees."""

import json
import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest

from validation.command_line import examples

HEAD = "import os, time, ctypes\nimport pytest\nfrom validation.plugin.rows import Code, Quantity\n"
AGREES = "rows.compare('area', 1.0, 1.0, of=Code.BEM, by=Code.EXACT, quantity=Quantity.AREA, uncertainty=1e-3)"


def case(name, *lines, mark=""):
    return f"\n{mark}\ndef {name}(rows):\n" + textwrap.indent("\n".join((*lines, AGREES)), "    ") + "\n"


@pytest.fixture
def verify(tmp_path):
    """Start the command on files of cases."""
    folder = tmp_path / "cases"
    folder.mkdir()

    def start(files, *options):
        for name, text in files.items():
            (folder / name).write_text(HEAD + text)
        words = ["--cases", str(folder), "--out", str(tmp_path / "out"), "--jobs", "2", *options]
        return subprocess.Popen(
            [sys.executable, "-m", "validation", "run", *words],
            text=True,
            start_new_session=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=tmp_path,
        )

    def run(files, *options):
        process = start(files, *options)
        out, err = process.communicate(timeout=120)
        report = tmp_path / "out" / "report.json"
        return process.returncode, out, err, json.loads(report.read_text()) if report.exists() else None

    run.start = start
    run.record = tmp_path / "out" / "rows.jsonl"
    return run


def outcomes(report):
    return {case["case"].partition("::")[2]: case["outcome"] for case in report["cases"]}


def test_a_case_that_kills_its_worker_fails_alone(verify):
    files = {
        "test_a.py": case("test_before") + case("test_dies", "os._exit(9)") + case("test_after"),
        "test_b.py": case("test_other"),
    }
    code, out, err, report = verify(files)
    assert code == 1
    assert outcomes(report) == {
        "test_before": "passed",
        "test_dies": "error",
        "test_after": "passed",
        "test_other": "passed",
    }
    assert [row["verdict"] for row in report["rows"] if row["case"].endswith("dies")] == ["error"]
    assert out.startswith("3 of 3 independent comparisons agree; 1 of 4 cases failed; report: ")
    assert "test_a.py::test_dies: error" in err


def test_a_hang_ends_at_its_time_limit_and_names_the_case(verify):
    limit = "@pytest.mark.timeout(1)"
    files = {"test_a.py": case("test_sleeps", "time.sleep(60)", mark=limit) + case("test_after")}
    begun = time.monotonic()
    code, _, err, report = verify(files)
    assert code == 1
    assert time.monotonic() - begun < 30
    assert outcomes(report) == {"test_sleeps": "error", "test_after": "passed"}
    assert "test_a.py::test_sleeps: error" in err
    assert report["rows"][0]["reason"].endswith("test_a.py::test_sleeps: no end within its time limit of 1 s")


def test_a_hang_outside_python_loses_its_worker_and_fails_alone(verify):
    blocked = "import signal; signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGALRM]); ctypes.PyDLL(None).sleep(60)"
    files = {"test_a.py": case("test_in_c", blocked, mark="@pytest.mark.timeout(1)"), "test_b.py": case("test_other")}
    code, _, _, report = verify(files, "--grace", "1")
    assert code == 1
    assert outcomes(report) == {"test_in_c": "error", "test_other": "passed"}


def wait_for_lines(path, count):
    for _ in range(600):
        if path.exists() and path.read_text().count("\n") > count:
            return
        time.sleep(0.1)
    raise AssertionError(f"{path} has fewer than {count} cases")


SLOW = {
    "test_a.py": case("test_first") + case("test_second"),
    "test_b.py": case("test_waits", "while not os.path.exists('go'): time.sleep(0.1)"),
}


def test_an_interrupt_writes_the_report_of_what_ran(verify):
    process = verify.start(SLOW)
    wait_for_lines(verify.record, 2)
    os.killpg(process.pid, signal.SIGINT)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 130
    report = json.loads(verify.record.with_name("report.json").read_text())
    assert sorted(outcomes(report)) == ["test_first", "test_second"]
    assert report["not_run"] == ["test_b.py::test_waits"]
    assert "1 did not run" in out
    assert [row["verdict"] for row in report["rows"]] == ["agrees", "agrees", "not run"]


def test_a_run_that_was_killed_continues_and_loses_the_running_case_alone(verify, tmp_path):
    process = verify.start(SLOW)
    wait_for_lines(verify.record, 2)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate(timeout=60)
    (tmp_path / "go").touch()
    code, _, err, report = verify(SLOW, "--resume")
    assert code == 0
    assert outcomes(report) == dict.fromkeys(("test_first", "test_second", "test_waits"), "passed")
    assert "test_waits" in err
    assert "test_first" not in err


def test_cases_of_a_file_share_a_worker_and_those_with_parameters_are_spread(verify):
    note = "open('where', 'a').write(f'{os.getpid()} ' + os.environ['PYTEST_CURRENT_TEST'] + '\\n')"
    spread = "@pytest.mark.parametrize('number', range(4))\ndef test_many(rows, number):\n    time.sleep(1)\n    "
    files = {
        "test_a.py": case("test_one", note) + case("test_two", note),
        "test_b.py": spread + f"{note}\n    {AGREES}\n",
    }
    verify(files)
    where = [line.split()[:2] for line in (verify.record.parents[1] / "where").read_text().splitlines()]
    assert len({process for process, name in where if "test_a.py" in name}) == 1
    assert len({process for process, name in where if "test_b.py" in name}) == 2


def test_progress_is_on_stderr_and_one_line_on_stdout(verify):
    stored = "case,row,value,error,unit,reason\n"
    stored += "".join(
        f"test_a.py::test_{name},{row}\n"
        for name in ("x", "y")
        for row in ("(seconds),2.0,,s,", '"area [bem, closed form]",1,0,,first')
    )
    verify.record.parents[1].joinpath("cases", "stored.csv").write_text(stored)
    code, out, err, _ = verify({"test_a.py": case("test_x") + case("test_y")})
    assert code == 0
    assert out.count("\n") == 1
    assert "[1/2, about " in err and " s left] test_a.py::test_x: passed" in err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--only", ""), "--only '': no letter"),
        (("--only", ","), "--only ',': no letter"),
        (("--only", "nothing_like_it"), "--only nothing_like_it: no case matches"),
        (("--jobs", "0"), "--jobs 0: at least 1"),
        (("--store",), "stored.csv does not exist; make it, empty"),
        (("--reason", "new"), "--reason: says why stored numbers change; add --store"),
    ],
)
def test_bad_input_is_one_sentence(verify, options, message):
    code, out, err, _ = verify({"test_a.py": case("test_x")}, *options)
    assert (code, out) == (2, "")
    assert message in err
    assert "Traceback" not in err


def test_errors_of_own_cases_are_stored_in_an_empty_file_with_a_reason(verify):
    stored = verify.record.parents[1] / "cases" / "stored.csv"
    stored.touch()
    code, out, err, _ = verify({"test_a.py": case("test_x")}, "--store")
    assert (code, out) == (2, "") and "--store: needs --reason TEXT" in err
    code, _, _, _ = verify({"test_a.py": case("test_x")}, "--store", "--reason", "new")
    assert code == 0 and "test_a.py::test_x" in stored.read_text()


def test_own_cases_import_modules_beside_them(verify):
    files = {
        "beside.py": "\nVALUE = 1.0\n",
        "test_a.py": "from beside import VALUE\n" + case("test_one", "assert VALUE == 1.0"),
    }
    code, _, _, report = verify(files)
    assert (code, outcomes(report)) == (0, {"test_one": "passed"})


def test_the_example_of_own_cases_runs(verify, tmp_path):
    examples.write_example("own-cases", tmp_path)
    code, _, _, report = verify({}, "--cases", str(tmp_path / "own-cases"))
    assert code == 0
    assert len(report["cases"]) == 4
