"""The page: rendered from report.json alone, complete, self-contained, its verdicts recomputed from the numbers."""

import json
import re
from html.parser import HTMLParser

import pytest
from report_parts import figure, row

from bem.scene.atomic_file import write_atomically
from validation.__main__ import main, read_report
from validation.harness.schema import (
    Band,
    CaseRecord,
    Figure,
    Report,
    Series,
    Table,
    with_checksum,
)
from validation.report.figures import svg_of
from validation.report.render import ReportError, number, render

BAND = Band(low=1.5, high=3.0, cause="mean-field theory", source="the paper", review="2027-11-21")


def case(name="johnson-0.1", *rows, **changes):
    plain = {
        "id": name,
        "group": "closed forms",
        "level": "quick",
        "question": "Does it stick?",
        "equations": "K^2 = 2 E* w",
        "sources": ["johnson1995"],
        "effects": ["adhesion"],
        "scene": "[solid]\nyoungs_modulus = 1.0e6 # <E>",
        "rows": list(rows) or [row()],
        "tables": [Table(caption="Cost.", columns=["unknowns", "s"], rows=[[64, 0.25], [128, None]])],
        "counts": {"unknowns": 64},
    }
    return CaseRecord(**(plain | changes))


def report(*cases, **changes):
    cases = cases or (case(), case("persson", row(2.0, norm="ratio", tolerance=None, band=BAND)))
    plain = {"level": "quick", "command": "run", "planned": len(cases), "cases": list(cases)}
    return Report(**(plain | {"provenance": {"date": "2026-11-21", "commit": "0123abc"}} | changes))


@pytest.fixture
def folder(tmp_path):
    write_atomically(tmp_path / "report.json", with_checksum(report()).model_dump_json(by_alias=True))
    return tmp_path


def edited(folder, change):
    content = json.loads((folder / "report.json").read_text())
    change(content)
    (folder / "report.json").write_text(json.dumps(content))


class Page(HTMLParser):
    """Ids, references and text of a page."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.inside, self.outside, self.words = [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id":
                self.ids.append(value)
            elif name in ("href", "src", "xlink:href") and not value.startswith("data:"):
                (self.inside if value.startswith("#") else self.outside).append(value)
            self.inside += [f"#{found}" for found in re.findall(r"url\(#([^)]+)\)", value or "")]

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.words).split())


@pytest.fixture(scope="module")
def drawn():
    """A report with figures, one of them for the top of the page."""
    return report(case(figures=[figure("curve"), figure("landing-area")]), *report().cases[1:])


@pytest.fixture(scope="module")
def page(drawn):
    return Page(render(drawn))


def test_page_asks_nothing_from_outside(page):
    assert page.outside == []


def test_every_link_resolves_and_ids_are_unique(page):
    assert len(page.ids) == len(set(page.ids))
    assert {link[1:] for link in page.inside} <= set(page.ids)


@pytest.mark.parametrize(
    "piece",
    [
        "Does it stick?",
        "K^2 = 2 E* w",
        "youngs_modulus = 1.0e6 # <E>",
        "load < K & friends",
        "closed form",
        "Caption of curve.",
        "mean-field theory",
        "2027-11-21",
        "64 unknowns",
        "K. L. Johnson",
        "python -m validation run --only johnson-0.1",
        "0123abc",
    ],
)
def test_page_says(page, piece):
    assert piece in page.text


def test_equal_reports_give_equal_pages(drawn):
    assert render(drawn) == render(drawn)


def test_changed_number_changes_page_and_verdict(folder):
    assert main(["report", str(folder)]) == 0
    before = (folder / "report.html").read_text()
    edited(folder, lambda content: content["cases"][0]["rows"][0].update(computed=[1.2]))
    assert main(["report", str(folder)]) == 1
    after = (folder / "report.html").read_text()
    assert "deviates</td>" not in before
    assert "deviates</td>" in after


@pytest.mark.parametrize("part", ["solution", "error"])
def test_number_in_a_figure_changes_the_figure(part):
    shown = figure("curve").model_dump()
    before = svg_of(figure("curve"), "p")
    shown[part]["series"][0]["y"][1] = 5.0
    assert svg_of(Figure.model_validate(shown), "p") != before
    assert svg_of(figure("curve"), "p") == before


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


def test_missing_report_is_bad_input(tmp_path):
    assert main(["report", str(tmp_path)]) == 2


def without(name):
    def change(content):
        content["cases"][0]["figures"] = [f for f in content["cases"][0]["figures"] if f["id"] != name]

    return change


@pytest.fixture
def drawn_folder(drawn, tmp_path):
    """A report whose case says which figures it drew."""
    cases = [case.model_copy(update={"drawn": [figure.id for figure in case.figures]}) for case in drawn.cases]
    made = with_checksum(drawn.model_copy(update={"cases": cases}))
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
def test_report_changed_by_hand_is_told_on_page_and_by_exit_code(folder, change, capsys):
    edited(folder, change)
    assert main(["report", str(folder)]) == 1
    assert "checksum does not fit" in capsys.readouterr().err
    assert "its checksum does not fit" in (folder / "report.html").read_text()


def test_report_in_another_layout_is_the_same_report(folder):
    content = json.loads((folder / "report.json").read_text())
    (folder / "report.json").write_text(json.dumps(content, indent=7, sort_keys=True))
    assert main(["report", str(folder)]) == 0


def test_strip_shows_the_worst_ratio_with_its_case_and_the_changes():
    page = Page(render(with_checksum(report(case("a", row(1.02)), case("b", row(0.95)), changes=["b: moved"]))))
    assert "0.5 worst error / tolerance 1 changes from the baselines" in page.text
    assert "#b" in page.inside


def test_infinite_ratio_is_the_worst():
    page = Page(render(report(case("a", row(float("inf"))))))
    assert "inf worst error / tolerance" in page.text


def test_pair_shown_of_a_band_is_the_one_whose_ratio_is_told():
    of_two = row(norm="ratio", tolerance=None, band=BAND).model_copy(
        update={"expected": [1.0, 100.0], "computed": [2.9, 230.0]}
    )
    shown = Page(render(report(case("persson", of_two)))).text
    assert re.search(r"2\.9 worst of 2.*?2\.9", shown, re.DOTALL)
    assert "230" not in shown


def test_known_discrepancy_shows_band_cause_source_and_review():
    text = Page(render(report())).text
    known = text[text.index("Known discrepancies Recorded") :]
    assert "persson load < K & friends 2 1.5 to 3 mean-field theory the paper 2027-11-21 ≈ expected deviation" in known


@pytest.mark.parametrize(("date", "overdue"), [("2027-11-21", False), ("2027-11-22T08:00:00", True), ("soon", False)])
def test_review_that_is_overdue_is_told(date, overdue):
    text = Page(render(report(provenance={"date": date, "commit": "0123abc"}))).text
    assert ("2027-11-21: overdue" in text) is overdue


def test_what_fails_is_listed_first_with_its_link():
    page = Page(render(with_checksum(report(case("fine"), case("wrong", row(2.0))))))
    assert page.text.index("What fails wrong") < page.text.index("Summary Expected")
    assert "wrong : load < K & friends: deviates, error 1, allowed 0.1" in page.text


def test_cases_are_found_by_group():
    cases = [case("a", group="one"), case("b", group="two"), case("c", group="one")]
    text = Page(render(report(*cases))).text
    assert "one ✓ a ✓ c two ✓ b Provenance" in text


def test_commit_is_shown_by_its_first_digits():
    commit = "0123456789abcdef" * 2 + "01234567 with changes"
    text = Page(render(report(provenance={"date": "2026-11-21", "commit": commit}))).text
    assert "commit 0123456789ab with changes." in text
    assert commit in text


def test_crashed_case_is_shown_with_its_message():
    page = Page(render(report(case("crash", rows=[], figures=[], status="error", message="the matrix is singular"))))
    assert "the matrix is singular" in page.text
    assert "1 ✗ error" in page.text


def test_provenance_that_the_page_needs_must_be_there():
    with pytest.raises(Exception, match="commit"):
        render(report(provenance={"date": "2026-11-21"}))


def test_unknown_source_is_named():
    with pytest.raises(ReportError, match="nobody1900"):
        render(report(case(sources=["nobody1900"])))


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


@pytest.mark.parametrize(
    ("value", "shown"),
    [(None, "–"), (float("nan"), "not a number"), (0.0, "0"), (1e-12, "1e-12"), (True, "True"), ("as it is",) * 2],
)
def test_numbers_are_written_for_readers(value, shown):
    assert number(value) == shown
