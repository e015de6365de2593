"""Files of answers to the challenge: what is read of them, what is right, and one clear error of bad ones."""

import json
from pathlib import Path

import pytest

from validation.__main__ import main
from validation.challenge.problem import FOLDER, NAMES, problem


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder to stand in."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*arguments):
    return main(["challenge", "judge", *arguments, "--out", "out"])


def submission(form):
    """The shipped answers to all problems, as one file of a form."""
    if form == "csv":
        texts = [(FOLDER / name / "answers.csv").read_text().splitlines() for name in NAMES]
        return "\n".join([texts[0][0], *(line for text in texts for line in text[1:])]) + "\n"
    keys = {name: problem(name) for name in NAMES}
    return json.dumps(
        {name: {key: list(one.value) for key, one in whole.answers.items()} for name, whole in keys.items()}
    )


@pytest.mark.parametrize(("form", "only"), [("json", "johnson-loop,steep"), ("csv", "*")])
def test_the_shipped_answers_pass(folder, form, only):
    (folder / f"all.{form}").write_text(submission(form))
    assert run("--submission", f"all.{form}", "--only", only) == 0


def test_the_answers_of_one_problem_are_a_submission(folder, undrawn, capsys):
    path = str(FOLDER / "steep" / "answers.json")
    assert run("--submission", path, "--only", "steep") == 0
    assert run("--submission", path, "--only", "steep,westergaard") == 1
    assert "4 of 9 answers right to 3 digits, 5 missing" in capsys.readouterr().out


def test_a_wrong_answer_fails(folder, undrawn, capsys):
    content = json.loads(submission("json"))
    content["steep"]["mean_pressure"][1] *= 1.01
    (folder / "all.json").write_text(json.dumps(content))
    assert run("--submission", "all.json", "--only", "steep") == 1
    assert "steep: mean_pressure: wrong, 2.3 digits" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "name", "text", "said"),
    [
        ([], "a.csv", "problem,quantity,index,value\nsteep,patches,0,2\nsteep,patches,one,2\n", "line 3"),
        ([], "a.csv", "problem,quantity,index,value\nsteep,patches\n", "line 2: columns are missing"),
        ([], "a.csv", "problem,quantity,index,value\nsteep,patches,0,2\nsteep,patches,0,3\n", "index 0"),
        (
            [],
            "a.csv",
            "problem,quantity,index,value\nsteep,patches,200000000,2\n",
            "line 2: index 200000000: each from 0",
        ),
        ([], "a.csv", "problem,quantity,index,value\nsteep,patches,-1,2\n", "line 2: index -1: each from 0 to "),
        ([], "a.csv", "problem,quantity\n", "columns index, value are missing, found: problem, quantity"),
        ([], "a.csv", "", "found: nothing"),
        ([], "a.json", f'{{"steep": {{"patches": 1{"0" * 5000}}}}}', "submission a.json: Exceeds the limit"),
        ([], "a.json", "{", "a.json"),
        ([], "a.json", "[1]", "is needed"),
        ([], "a.json", '{"deep": {}}', "problem 'deep': one of westergaard"),
        ([], "a.txt", "", "ends in .json or .csv"),
        (["--only", "steep"], "folder.csv", None, "submission folder.csv: "),
        (["--only", "deep"], "a.json", "{}", "--only 'deep': one of westergaard"),
        (["--baseline", "none.json"], "a.json", "{}", "none.json: no such file"),
        (["--baseline", "a.json"], "a.json", "{}", "challenge.json of a judgement is needed"),
    ],
)
def test_bad_input_is_one_clear_error(folder, capsys, arguments, name, text, said):
    (folder / name).mkdir() if text is None else (folder / name).write_text(text)
    assert run("--submission", name, *arguments) == 2
    error = capsys.readouterr().err
    assert error.count("error:") == 1 and said in error


def test_a_byte_order_mark_and_a_far_index_of_what_was_not_asked_are_read(folder, undrawn):
    text = (FOLDER / "steep" / "answers.csv").read_text()
    Path("a.csv").write_text(f"{text}steep,wear,200000000,1,,\n", "utf-8-sig")
    assert run("--submission", "a.csv", "--only", "steep") == 0
