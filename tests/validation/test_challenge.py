"""The challenge: a solver, answers in a file, and what is not judged as a right answer."""

import json
import sys

import pytest

from validation.__main__ import main
from validation.challenge.judge import judge, names, problem
from validation.plugin.rows import Rows

SOLVER = """
import numpy as np

def solve(problem):
    profile, solid = problem["profile"], problem["solid"]
    height, modulus = profile["amplitudes"][0], solid["youngs_modulus"] / (1 - solid["poisson_ratio"] ** 2)
    share = problem["path"]["targets"] * profile["period"] / (np.pi * modulus * height)
    return {"contact_fraction": 2 / np.pi * np.arcsin(np.sqrt(share)) * %s}
"""


def judged(tmp_path, *words):
    code = main(["challenge", "judge", *words, "--out", str(tmp_path / "out")])
    report = tmp_path / "out" / "report.json"
    return code, json.loads(report.read_text()) if report.exists() else None


def test_there_are_fifteen_problems_and_certified_answers_are_right_to_themselves():
    assert len(names()) == 15
    for name in names():
        rows = Rows()
        judge(rows, name, {key: answer["value"] for key, answer in problem(name)[1].items()}, 9.0)
        assert {row.verdict for row in rows.rows} == {"agrees"}, name


@pytest.mark.parametrize(("factor", "verdict"), [("1", "agrees"), ("1.0009", "agrees"), ("1.002", "deviates")])
def test_a_solver_is_judged_by_its_digits(tmp_path, monkeypatch, factor, verdict):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delitem(sys.modules, "mine", raising=False)
    (tmp_path / "mine.py").write_text(SOLVER % factor)
    code, report = judged(tmp_path, "--solver", "mine:solve", "--only", "westergaard")
    assert code == 1  # other quantities are not answered
    verdicts = {row["name"]: row["verdict"] for row in report["rows"]}
    assert verdicts["contact fraction"] == verdict
    assert verdicts["separation"] == "not converged"


def test_a_solver_that_raises_fails_its_problem_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "raising.py").write_text("def solve(p): return {} if 'layer' in p else 1 / 0\n")
    code, report = judged(tmp_path, "--solver", "raising:solve", "--only", "westergaard,two-crests-thin")
    assert code == 1
    reasons = {row["case"]: row["reason"] for row in report["rows"]}
    assert reasons == {"two-crests-thin": "not answered", "westergaard": "ZeroDivisionError: division by zero"}


@pytest.mark.parametrize("answer", [[0.1], "much", [None, 0.3, 0.5, 0.8], [float("nan")] * 4])
def test_submitted_answers_that_are_no_numbers_fail(tmp_path, answer):
    (tmp_path / "answers.json").write_text(json.dumps({"westergaard": {"contact_fraction": answer}}))
    code, report = judged(tmp_path, "--submission", str(tmp_path / "answers.json"), "--only", "westergaard")
    assert code == 1
    assert next(row for row in report["rows"] if row["name"] == "contact fraction")["failed"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--solver", "mine"), "--solver mine: write MODULE:FUNCTION"),
        (("--solver", "absent:solve"), "--solver absent:solve: No module named 'absent'"),
        (("--solver", "mine:solve", "--only", "no"), "--only no: no problem matches"),
        (("--solver", "mine:solve", "--only", ","), "--only ,: no problem matches"),
        (("--submission", "absent.json"), "--submission absent.json: "),
    ],
)
def test_bad_input_is_one_sentence(tmp_path, capsys, words, message):
    assert judged(tmp_path, *words) == (2, None)
    assert message in capsys.readouterr().err
