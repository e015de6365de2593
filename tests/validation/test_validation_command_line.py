"""The command line: exit codes, and reports rendered again."""

import json

import pytest

from validation.__main__ import main
from validation.plugin.rows import Code, Quantity, Rows
from validation.plugin.study_report import Part, write_study


@pytest.fixture
def report(tmp_path):
    rows = Rows()
    rows.compare("area", 1.0, 1.0, of=Code.BEM, by=Code.EXACT, quantity=Quantity.AREA, uncertainty=1e-3)
    write_study(tmp_path, "a command", [Part("one", "Is it so?", rows)])
    return tmp_path


def test_a_report_is_rendered_again(report, capsys):
    page = (report / "report.html").read_text()
    (report / "report.html").unlink()
    assert main(["report", str(report)]) == 0
    assert (report / "report.html").read_text() == page
    assert capsys.readouterr().out.startswith("1 of 1 independent comparisons agree; all 1 cases passed; report: ")


def test_a_report_with_failures_is_exit_code_1(report):
    content = json.loads((report / "report.json").read_text())
    (report / "report.json").write_text(json.dumps(content | {"failed": 1}))
    assert main(["report", str(report)]) == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "no report there"),
        ("{", "not JSON"),
        ('{"schema": "linecontact-report/1"}', "is not 'linecontact-report/2'; run the cases again"),
        ('{"schema": "linecontact-report/2"}', "without "),
        ("[1]", "schema 'list'"),
    ],
)
def test_a_foreign_report_is_one_sentence(tmp_path, capsys, text, message):
    if text is not None:
        (tmp_path / "report.json").write_text(text)
    assert main(["report", str(tmp_path)]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize("change", [{"rows": [{}]}, {"cases": [1]}, {"counts": 3}, {"provenance": []}])
def test_a_tampered_report_is_one_sentence(report, capsys, change):
    content = json.loads((report / "report.json").read_text())
    (report / "report.json").write_text(json.dumps(content | change))
    assert main(["report", str(report)]) == 2
    assert "not as a report is written" in capsys.readouterr().err
