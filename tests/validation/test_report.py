"""The page of a report: complete, self-contained, its verdicts recomputed from the numbers."""

import re

import pytest
from report_parts import BAND, Page, case, figure, report, row

from validation.harness.case import registry
from validation.harness.compare import combined_tolerance
from validation.harness.schema import (
    Figure,
    Panel,
    Reference,
    Series,
    with_checksum,
)
from validation.report.figures import svg_of
from validation.report.pages import ReportError, number
from validation.report.render import render
from validation.report.verification.allowances import budget_of
from validation.report.verification.first_screen import first_sentence, scatter
from validation.report.verification.typesetting import typeset, unset


@pytest.fixture(scope="module")
def drawn():
    """A report with figures, one of them for the top of the page."""
    return report(case(figures=[figure("curve"), figure("landing-area")]), *report().cases[1:])


@pytest.fixture(scope="module")
def text(drawn):
    return render(drawn)


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


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


def test_equal_reports_give_equal_pages(drawn, text):
    assert render(drawn) == text


def test_figures_drawn_in_processes_are_the_same(drawn, text, monkeypatch):
    asked = []

    def noted(function, items, jobs):
        asked.append((len(items), jobs))
        return [function(item) for item in items]

    monkeypatch.setattr("validation.report.render.MANY", 2)
    monkeypatch.setattr("validation.report.render.answers_in_order", noted)
    assert (render(drawn, 2), asked) == (text, [(2, 2)])


@pytest.fixture(scope="module")
def before():
    return svg_of(figure("curve"), "p")


@pytest.mark.parametrize("part", ["solution", "error"])
def test_number_in_a_figure_changes_the_figure(before, part):
    shown = figure("curve").model_dump()
    shown[part]["series"][0]["y"][1] = 5.0
    assert svg_of(Figure.model_validate(shown), "p") != before


def test_equal_figures_are_drawn_alike(before):
    assert svg_of(figure("curve"), "p") == before


def test_strip_shows_the_worst_ratio_with_its_case_and_the_changes():
    page = Page(render(with_checksum(report(case("a", row(1.02)), case("b", row(0.95)), changes=["b: moved"]))))
    assert "0.5 worst error / allowed 1 changes from the baselines" in page.text
    assert "#b" in page.inside


def test_the_first_sentence_counts_what_was_compared():
    cases = (*report().cases, case("slow", seconds=12.0), case("peers", rows=[], status="not run", message="no extra"))
    assert first_sentence(with_checksum(report(*cases))) == (
        "Passed: 2 of 2 comparisons with something else agree; 1 known deviation; 1 not run; slowest: slow, 12 s."
    )


@pytest.mark.parametrize(
    ("failing", "part"),
    [
        (case("wrong", row(2.0)), "1 of 2 comparisons with something else agree; 1 deviates"),
        (case("wrong", row(2.0), row(3.0)), "1 of 3 comparisons with something else agree; 2 deviate."),
        (
            case("crash", rows=[], status="error", message="singular"),
            "1 of 1 comparison with something else agrees; 1 error",
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


def test_a_marginal_row_is_told_and_seen():
    made = with_checksum(report(case("close", row(1.02), row(1.095))))
    assert first_sentence(made).startswith("Passed: 2 of 2 comparisons with something else agree; 1 of these marginal")
    page = render(made)
    assert '<td class="verdict marginal" data-label="verdict">≲ marginal' in page
    assert '<li class="marginal"><b>1</b> ≲ marginal</li>' in page
    assert '<a href="#close" class="marginal">≲ close</a>' in page
    assert {series.label for series in scatter(made).solution.series} >= {"agrees", "marginal"}


def test_the_problem_stands_at_the_head_where_it_is_drawn():
    panel = Panel(xlabel="x", ylabel="y", series=[Series(label="one", x=[0.0, 1.0], y=[0.0, 1.0])])
    sketch = Figure(id="problem-layer", caption="A layer on a profile.", solution=panel)
    page = render(with_checksum(report(case("drawn", row(), figures=[sketch]))))
    place = page.index('id="figure-drawn-problem-layer"')
    assert page.index('id="verdict"') < place < page.index('id="centre"') < page.index('id="summary"')
    assert 'href="#problem"' in page
    assert 'id="problem"' not in render(with_checksum(report(case("bare", row()))))


def test_the_sentence_stands_before_any_figure(text):
    assert text.index('id="verdict"') < text.index("<svg")
    landing = text[text.index('id="landing"') :]
    assert landing.index("known discrepancy") < landing.index("<svg")


def test_verdicts_stand_in_the_first_column(text):
    for heads in re.findall(r"<thead><tr>(.*?)</tr></thead>", text, re.DOTALL):
        names = re.findall(r"<th[^>]*>(.*?)</th>", heads)
        assert "verdict" not in names[1:]
        assert ("verdict" in names) == ("expected" in names or "band" in names)
        assert ("unit" in names) == ("expected" in names)


def test_equations_are_mathml_and_dois_are_links(text):
    assert '<dd class="equations"><math' in text
    assert "</math> at every edge</dd>" in text
    assert '<a href="https://doi.org/10.1016/0020-7683(94)00111-9">doi:10.1016/0020-7683(94)00111-9</a>' in text


UNSET = ["from $a on", r"$\nonsense{a}$", "$x_{$", r"$\href{javascript:ran()}{x}$", "$" + 5000 * "{" + "$"]


@pytest.mark.parametrize("equations", UNSET, ids=["odd", "unknown", "unfinished", "link", "deep"])
def test_an_equation_that_cannot_be_set_is_shown_as_it_is_written(equations):
    assert equations in Page(render(report(case(equations=equations)))).text
    assert unset(equations)


def test_an_equation_with_signs_of_markup_is_set():
    assert "<mi>a</mi><mi>&amp;</mi><mi>b</mi>" in typeset("$a & b$")
    assert "<mtext>&lt;script&gt;</mtext>" in typeset(r"$\text{<script>}$")


def test_every_equation_of_the_house_can_be_set():
    texts = [case.equations for case in registry()]
    for text in texts:
        assert unset(text) == []
        assert text.count("$") == 0 or "<math" in typeset(text)


def test_a_row_over_something_holds_a_value_with_its_unit():
    shown = row(20.0, quantity="load over p*", unit="Pa", expected=[20.0], scale=100.0)
    text = Page(render(report(case("one", shown)))).text
    assert "load absolute, over p* = 100 Pa Pa 20 20 0" in text


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
    ("changes", "data", "validation", "decides"),
    [
        ({"uncertainty": 0.3}, 0.4, 0.5, "the uncertainty"),
        ({"uncertainty": 0.03, "reference": {"kind": "FEM", "uncertainty": 0.04}}, 0.04, 0.05, "the tolerance"),
        ({"reference": {"kind": "exact"}, "uncertainty": 0.3}, 0.0, 0.3, "the uncertainty"),
        ({"reference": {"kind": "exact", "uncertainty": 0.4}}, 0.4, 0.4, "the uncertainty"),
        ({"reference": {"kind": "exact"}}, 0.0, None, "the tolerance"),
        ({"reference": {"kind": "self"}}, None, None, "the tolerance"),
    ],
)
def test_budget_of_a_comparison_is_the_rule_that_judges_it(changes, data, validation, decides):
    reference = {"source": "s"} | changes.get("reference", {"kind": "FEM", "uncertainty": 0.4})
    judged = row(**(changes | {"reference": Reference(**reference)}))
    budget = budget_of(judged)
    assert (budget.numerical, budget.data) == (changes.get("uncertainty"), data)
    assert budget.validation == (None if validation is None else pytest.approx(validation))
    assert budget.decides == decides
    limit = validation if decides == "the uncertainty" else judged.tolerance.value
    assert combined_tolerance(judged) == pytest.approx(limit)


def test_infinite_ratio_is_the_worst():
    page = Page(render(report(case("a", row(float("inf"))))))
    assert "inf worst error / allowed" in page.text


def test_pair_shown_of_a_band_is_the_one_whose_ratio_is_told():
    of_two = row(norm="ratio", tolerance=None, band=BAND).model_copy(
        update={"expected": [1.0, 100.0], "computed": [2.9, 230.0]}
    )
    shown = Page(render(report(case("persson", of_two)))).text
    assert re.search(r"2\.9 largest error of 2.*?2\.9", shown, re.DOTALL)
    assert "230" not in shown


def test_known_discrepancy_shows_band_cause_source_and_review():
    text = Page(render(report())).text
    known = text[text.index("Known discrepancies: 1 row") :]
    assert "≈ expected deviation persson load < K & friends 2 1.5 to 3 mean-field theory the paper 2027-11-21" in known


@pytest.mark.parametrize(("date", "overdue"), [("2027-11-21", False), ("2027-11-22T08:00:00", True), ("soon", False)])
def test_review_that_is_overdue_is_told(date, overdue):
    text = Page(render(report(provenance={"date": date, "commit": "0123abc"}))).text
    assert ("2027-11-21: overdue" in text) is overdue


def test_what_fails_is_listed_first_with_its_link():
    page = Page(render(with_checksum(report(case("fine"), case("wrong", row(2.0))))))
    assert page.text.index("What fails wrong") < page.text.index("All rows Comparisons")
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
    with pytest.raises(ReportError, match="no commit"):
        render(report(provenance={"date": "2026-11-21"}))


def test_unknown_source_is_named():
    with pytest.raises(ReportError, match="nobody1900"):
        render(report(case(sources=["nobody1900"])))


@pytest.mark.parametrize(
    ("value", "shown"),
    [(None, "–"), (float("nan"), "not a number"), (0.0, "0"), (1e-12, "1e-12"), (True, "True"), ("as it is",) * 2],
)
def test_numbers_are_written_for_readers(value, shown):
    assert number(value) == shown
