"""The judge: whatever a solver or a file of answers does is a row, the exit code, or one clear error."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from bem.scene.atomic_file import write_atomically
from validation.__main__ import main
from validation.challenge.judging import Judgement, judged, lost
from validation.challenge.problem import FOLDER, NAMES, Certified, Shipped, problem
from validation.challenge.record_standings import estimated, extrapolated
from validation.challenge.run_judge import write
from validation.challenge.solver_process import returned
from validation.challenge.worker import LONGEST, plain
from validation.harness.route import Answer

SOLVERS = """
import math, os, subprocess, sys, time
from pathlib import Path
import numpy as np

def exact(problem):
    with open("calls", "a") as file:
        file.write("called")
    p, profile = problem["path"]["targets"], problem["profile"]
    full = np.pi * 1e6 / 0.75 * profile["amplitudes"][0] / profile["period"]
    S, D = p / full, profile["amplitudes"][0]
    x, y = (np.pi * problem["asked"][name]["points"] / profile["period"] for name in ("pressure_at", "gap_at"))
    w = np.sin(y)
    return {
        "contact_fraction": 2 / np.pi * np.arcsin(np.sqrt(S)),
        "separation": D * (1 - S + S * np.log(S)),
        "elastic_energy": full * D * (S**2 / 4 - S**2 / 2 * np.log(S)),
        "pressure_at": 2 * full * np.cos(x) * np.sqrt(S[2] - np.sin(x) ** 2),
        "gap_at": 2 * D * (w * np.sqrt(w**2 - S[2]) - S[2] * np.arccosh(w / np.sqrt(S[2]))),
        "wear": 1.0,
    }

def coarse(problem):
    return {name: value * 1.00001 for name, value in exact(problem).items()}

def raises(problem):
    raise RuntimeError("boom")

def inside(problem):
    np.linalg.inv(np.zeros((2, 2)))

def aborts(problem):
    os.abort()

def dies(problem):
    os._exit(3)

def leaves(problem):
    sys.exit("enough")

def hangs(problem):
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    Path("child").write_text(str(child.pid))
    time.sleep(60)

def flees(problem):
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"], start_new_session=True)
    Path("child").write_text(str(child.pid))
    if problem["name"] == "steep":
        time.sleep(60)
    return exact(problem)

def talks(problem):
    raise RuntimeError("ah" * 10**6)

def talks_of_it(problem):
    raise NotImplementedError("ah" * 10**6)

def fills(problem):
    held = []
    while True:
        held.append(bytearray(10**6))

def asks_too_much(problem):
    np.ones(10**12)

def declines(problem):
    raise NotImplementedError("lines only")

def number(problem):
    return 3

def not_numbers(problem):
    nothing = [math.nan] * 4
    return {"contact_fraction": nothing, "separation": "three", "elastic_energy": ["1", "2", "3", "4"],
            "pressure_at": [True] * 3, "gap_at": [1j, 2, 3]}

def huge(problem):
    return exact(problem) | {"separation": [10**400, 1, 2, 3], "elastic_energy": [10**5000, 1, 2, 3],
                             "pressure_at": {"value": 1}, "gap_at": [1e308, 1.0, 1.0]}

def shapes(problem):
    return {"contact_fraction": [0.1], "separation": np.zeros((2, 2)), "elastic_energy": 1.0, "pressure_at": [],
            "gap_at": [None, None, None]}

def parts(problem):
    return exact(problem) | {"separation": [None, *exact(problem)["separation"][1:]]}

def kills(problem):
    # the first call takes with it the process that asked
    with open("asked", "a") as asked:
        asked.write(problem["name"] + " ")
    if not os.path.exists("killed"):
        open("killed", "w").close()
        os.kill(os.getppid(), 9)
        time.sleep(60)
    return exact(problem)

def prints(problem):
    print("{" * 100000)
    return exact(problem)
"""


@pytest.fixture
def solvers(apart, in_this_process):
    """A folder to stand in, with a module of solvers, each called in a process of its own by this one."""
    return apart


@pytest.fixture
def apart(tmp_path, monkeypatch):
    """The same, called from worker processes."""
    (tmp_path / "mine.py").write_text(SOLVERS)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def answer(name, limit=60.0):
    """A problem, judged, with what one of the solvers says to it."""
    one = problem("westergaard")
    return judged(one, returned(f"mine:{name}", one.text, limit), 3.0)


@pytest.mark.parametrize(
    ("name", "status", "message"),
    [
        ("raises", "crashed", "RuntimeError: boom (mine.py:27)"),
        ("inside", "crashed", "LinAlgError: Singular matrix (mine.py:30)"),
        ("aborts", "crashed", "the process was ended by SIGABRT"),
        ("dies", "crashed", "the process ended with code 3"),
        ("leaves", "crashed", "enough"),
        ("number", "crashed", "a dictionary is needed, it returned int"),
        ("declines", "not offered", "lines only"),
    ],
)
def test_a_solver_without_answers_is_rows(solvers, name, status, message):
    found = answer(name)
    assert {row.status for row in found.rows} == {status} and len(found.rows) == 5
    assert found.message.endswith(message) and not any(row.error for row in found.rows) and not found.passed


def test_a_solver_that_hangs_is_ended_with_its_children(solvers):
    begun = time.monotonic()
    found = answer("hangs", limit=3.0)
    assert {row.status for row in found.rows} == {"timed out"} and time.monotonic() - begun < 30
    assert ended(int((solvers / "child").read_text()))


def test_a_judge_that_is_killed_leaves_no_process(solvers):
    command = [sys.executable, "-m", "validation", *["challenge", "judge", "--solver", "mine:hangs", "--out", "out"]]
    judge = subprocess.Popen(command, cwd=solvers, env={**os.environ, "PYTHONPATH": str(FOLDER.parents[2])})
    child = solvers / "child"
    for _ in range(600):
        if child.exists() and child.read_text():
            break
        time.sleep(0.1)
    judge.kill()
    judge.wait()
    assert ended(int(child.read_text()))


def ended(process):
    """Whether a process has ended within five seconds."""
    for _ in range(50):
        if not _runs(process):
            return True
        time.sleep(0.1)
    return False


def _runs(process):
    """Whether a process is there and not a zombie that only waits to be reaped."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


@pytest.mark.parametrize(("name", "limit", "status"), [("westergaard", 60.0, "answered"), ("steep", 3.0, "timed out")])
def test_a_child_in_a_session_of_its_own_ends_with_its_solver(solvers, name, limit, status):
    assert returned("mine:flees", problem(name).text, limit).status == status
    assert ended(int((solvers / "child").read_text()))


def test_texts_of_exceptions_are_cut(solvers):
    text = problem("westergaard").text
    for name, begin in (("talks", "RuntimeError: ahah"), ("talks_of_it", "ahah")):
        message = returned(f"mine:{name}", text, 60.0).message
        assert message.startswith(begin) and "ah..." in message and len(message) < LONGEST + 40
    assert plain("a" * 10**6) == "a" * LONGEST + "..."


@pytest.mark.skipif(sys.platform == "win32", reason="no limits of memory on this system")
@pytest.mark.parametrize("name", ["fills", "asks_too_much"])
def test_a_solver_that_meets_its_memory_limit_is_named(solvers, undrawn, name):
    assert run("--solver", f"mine:{name}", "--only", "westergaard", "--memory-limit", "1.5") == 1
    (found,) = json.loads((solvers / "out" / "challenge.json").read_text())["problems"]
    assert {row["status"] for row in found["rows"]} == {"out of memory"}
    assert found["message"].startswith("more than 1.5 GB; ") and "mine.py:" in found["message"]
    assert run("--solver", "mine:exact", "--only", "westergaard", "--memory-limit", "1.5") == 0


@pytest.mark.parametrize(
    ("name", "statuses"),
    [
        ("exact", ["right"] * 5),
        ("prints", ["right"] * 5),
        ("not_numbers", ["not a number"] * 5),
        ("huge", ["right", "not a number", "not a number", "not a number", "wrong"]),
        ("shapes", ["wrong shape", "wrong shape", "wrong shape", "wrong shape", "missing"]),
        ("parts", ["right", "missing", "right", "right", "right"]),
    ],
)
def test_each_quantity_has_its_verdict(solvers, name, statuses):
    assert [row.status for row in answer(name).rows] == statuses


def test_digits_are_those_of_the_error_and_not_more_than_the_key_has():
    edges = Certified("m", (1.0, 4.0), (0.0, 4e-9), 4.0, "", ())
    key = Shipped("one", "", {"patches": Certified("", (2.0,), (0.0,), 1.0, "", ()), "edges": edges})
    found = judged(key, Answer("answered", values={"patches": 2, "edges": [1.0, 4.0 + 4e-6]}), 7.0)
    assert [row.digits for row in found.rows] == pytest.approx([15.0, 6.0], abs=1e-6)
    assert [row.status for row in found.rows] == ["right", "wrong"]
    assert found.rows[1].over_uncertainty == pytest.approx(1000, rel=1e-6)
    perfect = judged(key, Answer("answered", values={"edges": [1.0, 4.0]}), 7.0)
    assert perfect.rows[1].digits == pytest.approx(9.0)


def test_what_was_not_asked_is_named(solvers):
    assert answer("exact").ignored == ("wear",)


def run(*arguments):
    return main(["challenge", "judge", *arguments, "--out", "out"])


def test_a_judgement_is_written_and_kept(solvers, capsys):
    assert run("--solver", "mine:exact", "--only", "westergaard") == 0
    assert run("--solver", "mine:exact", "--only", "westergaard") == 0
    assert (solvers / "calls").read_text() == "called"
    content = json.loads((solvers / "out" / "challenge.json").read_text())
    assert content["passed"] and content["problems"][0]["rows"][0]["digits"] == pytest.approx(12.0, abs=0.1)
    page = (solvers / "out" / "challenge.html").read_text()
    assert "5 of 5 answers right" in page and 'role="img"' in page and 'src="' not in page
    assert "5 of 5 answers right" in capsys.readouterr().out


def test_a_route_is_named_on_the_page_with_its_setting(tmp_path):
    one = problem("westergaard")
    found = judged(one, Answer(values={name: list(key.value) for name, key in one.answers.items()}), 3.0)
    write(Judgement("routes.grid:solve@0.5", 3.0, (found,)), (one,), tmp_path)
    assert ". grid:solve@0.5: error" in (tmp_path / "challenge.html").read_text()


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
def test_a_worker_killed_in_the_middle_costs_no_problem_and_counts_none_twice(apart, forked):
    assert run("--solver", "mine:kills", "--only", "westergaard,complete-contact", "--jobs", "2") == 1
    found = json.loads((apart / "out" / "challenge.json").read_text())["problems"]
    assert [one["problem"] for one in found] == ["westergaard", "complete-contact"]
    assert [row["status"] for row in found[0]["rows"]] == ["right"] * 5
    assert 3 <= len((apart / "asked").read_text().split()) <= 4  # those that ran beside the killed one, once more


def test_a_solver_of_an_installed_package_goes_by_its_name(solvers, undrawn, monkeypatch):
    monkeypatch.setattr("validation.challenge.commands.solvers", lambda: {"ours": "mine:exact"})
    assert run("--solver", "ours", "--only", "westergaard") == 0


@pytest.mark.parametrize(
    "given",
    [
        *(("--executor", "slurm"), ("--jobs", "0"), ("--only", "st*,deep"), ("--baseline", "none.json")),
        *(("--digits", digits) for digits in ("nan", "-1", "16")),
        *(("--memory-limit", memory) for memory in ("nan", "-1", "0", "1e7", "all")),
    ],
)
def test_options_that_cannot_be_are_bad_input_before_a_problem_runs(solvers, capsys, given):
    try:
        code = run("--solver", "mine:exact", *given)
    except SystemExit as error:
        code = error.code
    assert code == 2 and given[1].split(",")[-1] in capsys.readouterr().err and not (solvers / "out").exists()


def test_a_changed_solver_is_called_again(solvers, undrawn):
    assert run("--solver", "mine:exact", "--only", "westergaard") == 0
    (solvers / "mine.py").write_text(SOLVERS.replace("* (1 - S + S * np.log(S))", "* (1 - S)"))
    assert run("--solver", "mine:exact", "--only", "westergaard") == 1


def test_a_baseline_fails_where_digits_are_lost_and_only_there(solvers, undrawn, capsys):
    only = ("--only", "westergaard")
    assert run("--solver", "mine:exact", *only) == 0
    write_atomically(solvers / "before.json", (solvers / "out" / "challenge.json").read_text())
    assert run("--solver", "mine:coarse", *only, "--baseline", "before.json") == 1
    assert "LOST westergaard: separation: 5.0 digits, 12.0 before" in capsys.readouterr().err
    write_atomically(solvers / "coarse.json", (solvers / "out" / "challenge.json").read_text())
    assert run("--solver", "mine:coarse", *only, "--digits", "9", "--baseline", "coarse.json") == 0
    assert run("--solver", "mine:raises", *only, "--baseline", "coarse.json") == 1
    capsys.readouterr()
    assert run("--solver", "mine:exact", "--only", "steep", "--baseline", "coarse.json") == 2
    assert "baseline coarse.json: has none of the problems judged; it holds westergaard" in capsys.readouterr().err


def test_a_problem_without_answers_is_one_line(solvers, capsys):
    assert run("--solver", "mine:raises", "--only", "westergaard") == 1
    lines = capsys.readouterr().err.splitlines()
    assert sum(line.startswith("westergaard: crashed, RuntimeError: boom") for line in lines) == 1


def test_half_a_digit_is_not_lost():
    whole = problem("westergaard")
    values = {name: list(one.value) for name, one in whole.answers.items()}
    exact, close, apart = (
        judged(whole, Answer(values=values | {"separation": np.multiply(values["separation"], f).tolist()}), 3)
        for f in (1 + 1e-6, 1 + 2e-6, 1 + 4e-6)
    )
    assert list(lost([close], [exact])) == []
    assert [line.split(",")[0] for line in lost([apart], [exact])] == ["westergaard: separation: 5.4 digits"]


@pytest.mark.parametrize(
    ("spec", "said"),
    [
        ("mine", "package.module:function is needed"),
        ("mine:none", "no function 'none'"),
        ("nowhere:f", "nowhere"),
        ("validation.routes.paper_method:solve@four", "malformed node"),
    ],
)
def test_a_solver_that_cannot_be_found_is_bad_input(solvers, capsys, spec, said):
    assert run("--solver", spec) == 2
    assert said in capsys.readouterr().err


def test_grids_are_extrapolated():
    def grid(spacing):
        return Answer("answered", values={"contact_fraction": [0.5 + spacing], "patches": [3]}, seconds=1.0)

    found = extrapolated({}, [grid(0.4), grid(0.2), grid(0.1)])
    assert found.values == {"contact_fraction": [pytest.approx(0.5)], "patches": [3]}
    adhesive = extrapolated({"adhesion": {}}, [grid(0.2), grid(0.2 / np.sqrt(2))])
    assert adhesive.values["contact_fraction"] == [pytest.approx(0.5)]
    failed = Answer("not offered", "layers")
    assert extrapolated({}, [grid(0.2), failed]) is failed


def test_problems_are_listed_and_shown(solvers, capsys):
    assert main(["challenge", "list"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == list(NAMES)
    assert main(["challenge", "show", "rough-1000"]) == 0
    shown = capsys.readouterr().out
    assert "youngs_modulus = 1000000.0" in shown and "# 1000 numbers" in shown and "dense algebra" in shown
    assert main(["challenge", "show", "steep", "--out", "here"]) == 0
    assert sorted(path.name for path in Path("here").iterdir()) == ["answers.csv", "answers.json", "problem.toml"]


def test_what_extrapolation_says_of_the_finest_grid():
    one = problem("westergaard")
    finest, limit = (
        Answer("answered", values={"contact_fraction": values, "gap_at": [1.0, None, 2.0]})
        for values in ([0.1, 0.3, 0.5, 0.8], [0.1, 0.3, 0.49, 0.8])
    )
    scale = max(one.answers["contact_fraction"].value)
    assert estimated(one, "contact_fraction", finest, limit) == pytest.approx(0.01 / scale, rel=1e-2)
    assert estimated(one, "gap_at", finest, limit) is None
    assert estimated(one, "separation", finest, limit) is None


def test_a_time_limit_beyond_what_a_clock_can_wait_for_is_refused(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["challenge", "judge", "--time-limit", "1e300", "--solver", "a:b", "--out", "judged"])
    assert ended.value.code == 2
    assert "at most 9.22e+09 is needed" in capsys.readouterr().err


def test_a_thread_that_a_solver_leaves_does_not_keep_its_answers(tmp_path, monkeypatch):
    text = "import threading\nimport time\n\n\ndef solve(problem):\n"
    text += "    threading.Thread(target=time.sleep, args=(600,)).start()\n    return {'a': 1.0}\n"
    (tmp_path / "leaving.py").write_text(text)
    monkeypatch.chdir(tmp_path)
    found = returned("leaving:solve", 'title = "any"', 60.0)
    assert (found.status, found.values) == ("answered", {"a": 1.0})
