"""The page: rendered from report.json alone, complete, self-contained, its verdicts recomputed from the numbers."""

import json
import re
from html.parser import HTMLParser

import pytest
from report_parts import figure, row

from bem.scene.atomic_file import write_atomically
from validation.__main__ import main, read_report
from validation.harness.registry import registry
from validation.harness.schema import (
    Band,
    CaseRecord,
    Figure,
    Reference,
    Report,
    Series,
    Table,
    with_checksum,
)
from validation.replicate import TOPICS
from validation.report.figures import svg_of
from validation.report.render import ReportError, number, render
from validation.report.verification.all_results import first_sentence, scatter
from validation.report.verification.row_views import budget_of
from validation.report.verification.typesetting import typeset
from validation.studies.theory_correction.page import EQUATIONS

PUBLISHED = ("https://doi.org/10.", "https://arxiv.org/abs/")
BAND = Band(low=1.5, high=3.0, cause="mean-field theory", source="the paper", review="2027-11-21")


def case(name="johnson-0.1", *rows, **changes):
    plain = {
        "id": name,
        "group": "closed forms",
        "level": "quick",
        "question": "Does it stick?",
        "equations": r"$K^2 = 2 E^\ast w$ at every edge",
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
        self.ids, self.inside, self.outside, self.words, self.tags = [], [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        for name, value in attributes:
            if tag == "a" and value.startswith(PUBLISHED):
                continue  # asked for when a reader follows it
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
        "at every edge",
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
    assert "✓ Passed: " in before
    assert "✗ Failed: " in after
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
def test_report_changed_by_hand_is_shown_on_page_and_by_exit_code(folder, change, capsys):
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


def test_the_first_sentence_counts_what_was_compared():
    cases = (*report().cases, case("slow", seconds=12.0), case("peers", rows=[], status="not run", message="no extra"))
    assert first_sentence(with_checksum(report(*cases))) == (
        "Passed: 2 of 2 comparisons within their tolerance; 1 known deviation; 1 not run; slowest: slow, 12 s."
    )


@pytest.mark.parametrize(
    ("failing", "part"),
    [
        (case("wrong", row(2.0)), "1 of 2 comparisons within their tolerance; 1 deviates"),
        (case("wrong", row(2.0), row(3.0)), "1 of 3 comparisons within their tolerance; 2 deviate."),
        (
            case("crash", rows=[], status="error", message="singular"),
            "1 of 2 comparisons within their tolerance; 1 error",
        ),
        (
            case("lucky", row(1.0, norm="ratio", tolerance=None, band=BAND)),
            "1 known deviation outside the recorded band",
        ),
    ],
    ids=["deviates", "two deviate", "error", "changed"],
)
def test_the_first_sentence_says_what_fails(failing, part):
    sentence = first_sentence(with_checksum(report(case("fine"), failing)))
    assert sentence.startswith("Failed: ")
    assert part in sentence


def test_the_sentence_stands_before_any_figure(drawn):
    text = render(drawn)
    assert text.index('id="verdict"') < text.index("<svg")
    landing = text[text.index('id="landing"') :]
    assert landing.index("known discrepancy") < landing.index("<svg")


def test_verdicts_stand_in_the_first_column(page, drawn):
    text = render(drawn)
    for heads in re.findall(r"<thead><tr>(.*?)</tr></thead>", text, re.DOTALL):
        names = re.findall(r"<th[^>]*>(.*?)</th>", heads)
        assert "verdict" not in names[1:]
        assert ("verdict" in names) == ("expected" in names or "band" in names)
        assert ("unit" in names) == ("expected" in names or "E" in names)


def test_equations_are_mathml_and_dois_are_links(drawn):
    text = render(drawn)
    assert '<dd class="equations"><math' in text
    assert "</math> at every edge</dd>" in text
    assert '<a href="https://doi.org/10.1016/0020-7683(94)00111-9">doi:10.1016/0020-7683(94)00111-9</a>' in text


@pytest.mark.parametrize("equations", ["from $a on", r"$\nonsense{a}$"])
def test_an_equation_that_cannot_be_set_is_refused(equations):
    with pytest.raises(ReportError, match="cannot be set"):
        render(report(case(equations=equations)))


def test_every_equation_of_the_house_can_be_set():
    texts = [case.equations for case in registry()] + [topic[2] for topic in TOPICS] + [EQUATIONS]
    for text in texts:
        assert text.count("$") == 0 or "<math" in typeset(text)


def test_a_row_over_something_holds_a_value_with_its_unit():
    shown = row(20.0, quantity="load over p*", unit="Pa", expected=[20.0], scale=100.0)
    text = Page(render(report(case("one", shown)))).text
    assert "load Pa 20 20 0 0.1 0 absolute, over p* = 100 Pa" in text


def test_all_results_are_drawn_or_counted():
    rows = (row(1.0), row(1.05), row(0.0, expected=[0.0]), row(1.5))
    known = row(2.0, norm="ratio", tolerance=None, band=BAND)
    figure = scatter(report(case("one", *rows), case("two", known)))
    shown = {series.label: (series.x, series.y) for series in figure.solution.series}
    assert shown["agrees"] == ([1.0, 1.0], [1.0, 1.05])
    assert shown["known deviation"] == ([1.0], [2.0])
    assert shown["fails"] == ([1.0], [1.5])
    ratios = {series.label: series.y for series in figure.error.series}
    assert ratios["agrees"] == pytest.approx([0.5])
    assert ratios["fails"] == pytest.approx([5.0])
    assert "4 of 5 comparisons" in figure.caption
    assert "1 agree to the last bit" in figure.caption
    assert scatter(report(case("one", row(0.0, expected=[0.0])))) is None


@pytest.mark.parametrize(
    ("changes", "data", "validation", "says"),
    [
        ({"computed": 1.5, "uncertainty": 0.3}, 0.4, 0.5, "within 2 u_val"),
        ({"computed": 2.1, "uncertainty": 0.3}, 0.4, 0.5, "beyond 2 u_val: left to model or discretisation"),
        ({"computed": 1.5, "reference": {"kind": "exact"}, "uncertainty": 0.3}, 0.0, 0.3, "within 2 u_val"),
        ({"computed": 1.5, "reference": {"kind": "exact", "uncertainty": 0.4}}, 0.4, 0.4, "within 2 u_val"),
        ({"computed": 1.5, "reference": {"kind": "self"}}, None, None,
         "no uncertainty stated: judged by the tolerance"),
        ({"computed": 1.0, "reference": {"kind": "self"}}, None, None, "equal"),
    ],
)  # fmt: skip
def test_budget_of_a_comparison(changes, data, validation, says):
    reference = {"source": "s"} | changes.get("reference", {"kind": "FEM", "uncertainty": 0.4})
    budget = budget_of(row(**(changes | {"reference": Reference(**reference)})))
    assert budget.error == pytest.approx(changes["computed"] - 1.0)
    assert (budget.numerical, budget.data) == (changes.get("uncertainty"), data)
    assert budget.validation == (None if validation is None else pytest.approx(validation))
    assert budget.says == says


def test_a_row_without_numbers_has_no_budget():
    assert budget_of(row(None)) is None


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
    assert "≈ expected deviation persson load < K & friends 2 1.5 to 3 mean-field theory the paper 2027-11-21" in known


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
