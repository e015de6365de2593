"""Files that somebody else wrote: whatever is in a report, a baseline or a submission, it is judged or one clear error.

Checksums are right: what is wrong was there before they were made.
"""

import hashlib
import json

import pytest
from drawn_once import drawn_once
from report_parts import case, figure, report

from validation.__main__ import main
from validation.harness.baseline import BaselineError, read_baseline
from validation.harness.schema import with_checksum
from validation.report import challenge_page, render

DEEP = "[" * 100_000 + "]" * 100_000
HUGE = 10**400


def changed(**changes):
    return lambda content: content["cases"][0].update(changes)


def drawn(**changes):
    return lambda content: content["cases"][0]["figures"][0]["solution"]["series"][0].update(changes)


REPORTS = {
    "deep": (lambda content: DEEP, "not JSON"),
    "digits": (lambda content: json.dumps(content).replace("[64, 0.25]", "[" + "9" * 5000 + "]"), "not JSON"),
    "deep facts": (
        lambda content: json.dumps(content).replace('"0123abc"', "[" * 300 + "]" * 300),
        "provenance.commit",
    ),
    "no date": (lambda content: content.update(provenance={}), "no date"),
    "count": (changed(counts={"unknowns": HUGE}), "cases.0.counts.unknowns"),
    "planned": (lambda content: content.update(planned=HUGE), "planned"),
    "value": (lambda content: content["cases"][0]["rows"][0].update(computed=[HUGE]), "cases.0.rows.0.computed.0"),
    "text": (changed(rows="abc"), "cases.0.rows"),
    "null": (lambda content: content.update(cases=[None]), "cases.0"),
    "mapping": (lambda content: content.update(cases={"a": 1}), "cases"),
    "surrogate": (changed(question="\udc80"), "cases.0.question"),
    "id": (changed(id="a\0b"), "cases.0.id"),
    "drawing": (drawn(y=[1.7e308, -1.7e308, 0.0]), "1.7e+308, at most 1e+250"),
}


@pytest.mark.parametrize("kind", REPORTS)
def test_a_report_with_anything_in_it_is_one_error(kind, tmp_path, capsys):
    change, said = REPORTS[kind]
    content = json.loads(with_checksum(report(case(figures=[figure("a")]))).model_dump_json(by_alias=True))
    del content["checksum"]
    text = change(content)
    if text is None:
        digest = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
        text = json.dumps(content | {"checksum": digest})
    (tmp_path / "report.json").write_text(text, "utf-8")
    assert main(["report", str(tmp_path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert said in line
    assert not (tmp_path / "report.html").exists()


@pytest.mark.parametrize("x", [[-1.0, -2.0, -3.0], [0.0, 0.0, float("nan")], [1e-12, 1e12, -1e12]])
@pytest.mark.parametrize("scale", ["linear", "log"])
def test_any_finite_figure_is_drawn(x, scale):
    content = figure("a").model_dump()
    content["solution"] |= {"xscale": scale, "yscale": scale}
    content["solution"]["series"][0] |= {"x": x, "label": "_hidden"}
    assert drawn_once(type(figure("a")).model_validate(content), "p").startswith("<svg")


BASELINES = {
    "deep": DEEP,
    "empty": "",
    "null": "null",
    "types": '{"case": "one", "quantities": 5}',
    "digits": '{"blas_threads": ' + "9" * 5000,
}


@pytest.mark.parametrize("text", BASELINES.values(), ids=BASELINES)
def test_a_baseline_with_anything_in_it_is_one_error(text, tmp_path):
    (tmp_path / "one.json").write_text(text)
    with pytest.raises(BaselineError, match=r"^one\.json: malformed baseline .*$"):
        read_baseline("one", tmp_path)


ANSWERS = '{"westergaard": {"contact_fraction": %s}}'
HEAD = "problem,quantity,index,value\n"
SUBMISSIONS = {
    "deep.json": (DEEP, "recursion"),
    "digits.json": (ANSWERS % ("9" * 5000), "digits"),
    "name.json": ('{"\\u0000\\udc80": {}}', "problem '\\x00\\udc80'"),
    "field.csv": (HEAD + f'westergaard,contact_fraction,0,"{"1" * 200_000}"\n', "field larger than"),
    "index.csv": (HEAD + f"westergaard,contact_fraction,{'9' * 5000},1\n", "line 2: index and value"),
    "nul.csv": (HEAD + "westergaard,contact_fraction,0,0.\x005\n", "line 2: index and value"),
}


@pytest.fixture
def undrawn(monkeypatch):
    monkeypatch.setattr(challenge_page, "standings_svg", lambda *_: "")


@pytest.mark.parametrize("name", SUBMISSIONS)
def test_a_submission_with_anything_in_it_is_one_error(name, tmp_path, capsys):
    text, said = SUBMISSIONS[name]
    (tmp_path / name).write_text(text)
    assert main(["challenge", "judge", "--submission", str(tmp_path / name), "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


@pytest.mark.parametrize("value", ["[" * 900 + "]" * 900, f"[{HUGE}, 1, 2]", "[Infinity, NaN, 1e400]", '{"value": {}}'])
def test_answers_that_are_no_numbers_are_rows(value, tmp_path, undrawn, capsys):
    (tmp_path / "a.json").write_text(ANSWERS % value)
    words = ["challenge", "judge", "--submission", str(tmp_path / "a.json"), "--only", "westergaard"]
    assert main([*words, "--out", str(tmp_path / "out")]) == 1
    assert "westergaard: contact_fraction: " in capsys.readouterr().err


@pytest.mark.parametrize("text", [DEEP, "9" * 5000, "[]", '{"schema": []}', '{"schema": "linecontact-challenge/1"}'])
def test_a_judgement_with_anything_in_it_is_one_error(text, tmp_path, capsys):
    (tmp_path / "before.json").write_text(text)
    (tmp_path / "a.json").write_text(ANSWERS % "1")
    words = ["challenge", "judge", "--submission", str(tmp_path / "a.json"), "--out", str(tmp_path / "out")]
    assert main([*words, "--baseline", str(tmp_path / "before.json")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: baseline ")


@pytest.fixture(autouse=True)
def equal_figures_are_drawn_once(monkeypatch):
    monkeypatch.setattr(render, "svg_of", drawn_once)
