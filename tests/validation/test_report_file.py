"""A report as a file: exit codes of its page, what cannot be read or judged, what was changed by hand."""

import json

import pytest
from drawn_once import drawn_once
from report_parts import case, figure, report

from bem.scene.atomic_file import write_atomically
from validation.__main__ import main, read_report
from validation.harness.schema import Series, with_checksum
from validation.report import render


@pytest.fixture(autouse=True)
def equal_figures_are_drawn_once(monkeypatch):
    monkeypatch.setattr(render, "svg_of", drawn_once)


@pytest.fixture
def folder(tmp_path):
    write_atomically(tmp_path / "report.json", with_checksum(report()).model_dump_json(by_alias=True))
    return tmp_path


def edited(folder, change):
    content = json.loads((folder / "report.json").read_text())
    change(content)
    (folder / "report.json").write_text(json.dumps(content))


def test_changed_number_changes_page_and_verdict(folder):
    assert main(["report", str(folder)]) == 0
    before = (folder / "report.html").read_text()
    edited(folder, lambda content: content["cases"][0]["rows"][0].update(computed=[1.2]))
    assert main(["report", str(folder)]) == 1
    after = (folder / "report.html").read_text()
    assert "✓ Passed: " in before
    assert "✗ Failed: " in after
    assert "deviates</td>" not in before
    assert "deviates</td>" in after


def test_agreeing_too_well_fails_the_page(folder):
    edited(folder, lambda content: content["cases"][1]["rows"][0].update(computed=[1.0]))
    assert main(["report", str(folder)]) == 1
    assert "changed</td>" in (folder / "report.html").read_text()


def test_case_left_out_fails(folder):
    edited(folder, lambda content: content["cases"].pop())
    assert main(["report", str(folder)]) == 1


@pytest.mark.parametrize(
    "change",
    [
        lambda content: content.update(schema="linecontact-report/0"),
        lambda content: content.pop("provenance"),
        lambda content: content["cases"][0]["rows"][0].pop("reference"),
        lambda content: content["cases"][0]["rows"][0].pop("tolerance"),
        lambda content: content["cases"][0].update(sources=["nobody1900"]),
    ],
    ids=["schema", "provenance", "reference", "rule", "source"],
)
def test_report_that_cannot_be_judged_is_bad_input(folder, change, capsys):
    edited(folder, change)
    assert main(["report", str(folder)]) == 2
    assert "error:" in capsys.readouterr().err
    assert not (folder / "report.html").exists()


@pytest.mark.parametrize("text", ["", "[]", "{", "null"])
def test_file_that_is_no_report_is_bad_input(tmp_path, text):
    (tmp_path / "report.json").write_text(text)
    assert main(["report", str(tmp_path)]) == 2


def test_pdf_without_a_browser_is_refused(folder, capsys, monkeypatch):
    monkeypatch.setattr("validation.report.pdf.BROWSERS", ())
    assert main(["report", str(folder), "--pdf"]) == 2
    assert "--pdf: no browser" in capsys.readouterr().err


def test_pdf_is_named(folder, capsys, monkeypatch):
    monkeypatch.setattr("validation.__main__.write_pdf", lambda folder: folder / "report.pdf")
    assert main(["report", str(folder), "--pdf"]) == 0
    assert capsys.readouterr().out.splitlines()[1] == str(folder / "report.pdf")


def test_report_of_the_current_folder_names_it(folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    main(["report", "."])
    assert str(folder / "report.html") in capsys.readouterr().out


def test_missing_report_is_bad_input(tmp_path):
    assert main(["report", str(tmp_path)]) == 2


def without(name):
    def change(content):
        content["cases"][0]["figures"] = [f for f in content["cases"][0]["figures"] if f["id"] != name]

    return change


@pytest.fixture
def drawn_folder(tmp_path):
    """A report whose case says which figures it drew."""
    names = ("curve", "landing-area")
    drawn = case(figures=[figure(name) for name in names], drawn=list(names))
    made = with_checksum(report(drawn, *report().cases[1:]))
    write_atomically(tmp_path / "report.json", made.model_dump_json(by_alias=True))
    return tmp_path


def test_missing_figure_is_bad_input(drawn_folder, capsys):
    assert main(["report", str(drawn_folder)]) == 0
    (drawn_folder / "report.html").unlink()
    edited(drawn_folder, without("curve"))
    assert main(["report", str(drawn_folder)]) == 2
    assert "missing figure curve" in capsys.readouterr().err
    assert not (drawn_folder / "report.html").exists()


@pytest.mark.parametrize(
    "change",
    [
        {"x": [0.0, 1.0], "y": [0.0]},
        {"x": [0.0], "y": [0.0], "upper": [1.0]},
        {"x": [0.0], "y": [0.0], "style": "band"},
        {"x": [0.0], "y": [0.0], "style": "band", "upper": []},
    ],
    ids=["lengths", "upper without band", "band without upper", "length of upper"],
)
def test_series_that_cannot_be_drawn_is_refused(change):
    with pytest.raises(ValueError, match="series"):
        Series(label="s", **change)


@pytest.mark.parametrize(
    "change",
    [
        lambda content: content["cases"][0]["rows"][0].update(computed=[1.02]),
        lambda content: content.pop("checksum"),
        lambda content: content.update(level="full"),
    ],
    ids=["number", "none", "level"],
)
def test_report_changed_by_hand_is_shown_on_page_and_by_exit_code(folder, change, capsys):
    edited(folder, change)
    assert main(["report", str(folder)]) == 1
    assert "checksum does not fit" in capsys.readouterr().err
    assert "its checksum does not fit" in (folder / "report.html").read_text()


def test_report_in_another_layout_is_the_same_report(folder):
    content = json.loads((folder / "report.json").read_text())
    (folder / "report.json").write_text(json.dumps(content, indent=7, sort_keys=True))
    assert main(["report", str(folder)]) == 0


def test_json_summary(folder, capsys):
    main(["report", str(folder), "--json"])
    summary = json.loads(capsys.readouterr().out)
    assert summary["cases"] == 2
    assert summary["verdicts"] == {"agrees": 1, "expected deviation": 1}


def test_one_line_on_stdout(folder, capsys):
    main(["report", str(folder)])
    assert len(capsys.readouterr().out.splitlines()) == 1


def test_report_comes_back_from_its_file(folder):
    assert read_report(folder) == with_checksum(report())
