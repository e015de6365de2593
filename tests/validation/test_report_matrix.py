"""What a report compares with what: the matrix, its signs, the kinds of rows, and the map of hard cases."""

from typing import get_args

import pytest
from report_parts import Page, case, figure, report, row

from validation.harness.schema import Code, Reference, ReferenceKind, Table, Tolerance
from validation.report.render import render
from validation.report.verification.allowances import loose, unstated
from validation.report.verification.first_screen import hard_map
from validation.report.verification.matrix import CODES, REFERENCES, kind_of, matrix_of, tally

HARD = Table(
    id="hard-reduced",
    caption="Hard.",
    columns=["code", "case", "expected", "observed", "ending", "correct", "CPU s"],
    rows=[
        ["bem", "twin", "converged", "converged", "converged", "yes", 0.1],
        ["bem", "apart", "", "", "refused as expected", "yes", 0.1],
        ["bem", "wrong", "converged", "converged", "converged", "NO", 0.1],
        ["fem", "later", "converged", "", "not run", "–", None],
    ],
)


def test_a_new_comparison_is_in_the_matrix_by_what_it_says():
    fem = Reference(kind="FEM", source="a mesh", uncertainty=0.02)
    new = row(1.01, quantity="deep: edges", reference=fem)
    ours, theirs = row(1.0, quantity="edges"), row(1.0, quantity="edges", code="fem")
    found = matrix_of([case("new-case-coarse", new, row(1.0, quantity="colour")), case("old", ours, theirs)])
    lines = {line.problem: line for line in found.lines}
    assert list(lines) == ["old", "new case, deep"]
    entry = lines["new case, deep"].cells[3][0]
    assert (entry.pair, entry.shown, entry.target) == ("BF", "0.5 u", "row-new-case-coarse-0")
    assert [one.pair for one in lines["old"].cells[3]] == ["BX", "FX"]
    assert found.outside == [("row-new-case-coarse-1", "colour")]


@pytest.mark.parametrize("kind", sorted(set(get_args(ReferenceKind)) - {"self", "predicted order"}))
@pytest.mark.parametrize("code", sorted(set(get_args(Code)) - {"suite"}))
def test_every_sign_that_the_matrix_shows_is_in_its_legend(kind, code):
    cases = [case("one", row(quantity="edges", reference=Reference(kind=kind, source="s"), code=code))]
    (pair,) = matrix_of(cases).lines[0].pairs
    assert pair == CODES[code][0] + REFERENCES[kind][0]
    legend = Page(render(report(*cases))).text
    for sign in pair:
        assert f"{sign} {dict([*REFERENCES.values(), *CODES.values()])[sign]}" in legend


def test_kinds_of_references_have_signs_of_their_own():
    signs = {kind: sign for kind, (sign, _) in REFERENCES.items() if kind != "manufactured"}  # it is exact
    assert len(set(signs.values())) == len(signs)


def test_panels_of_a_centre_figure_are_apart_and_the_last_case_of_two_forms_has_the_place():
    page = render(report(*(case(name, figures=[figure("centre-rough")]) for name in ("rough-coarse", "rough"))))
    first, after = page[: page.index('id="summary"')], page[page.index('id="summary"') :]
    assert [part.count("<svg") for part in (first, after)] == [2, 3]  # all results stand behind the first screen
    assert 'id="figure-rough-centre-rough"' in first
    assert 'id="figure-rough-coarse-centre-rough"' in after


def test_an_order_of_convergence_is_in_no_column():
    predicted = Reference(kind="predicted order", source="s")
    found = matrix_of([case("one", row(quantity="order: load of a curve", reference=predicted))])
    assert (found.lines, len(found.outside)) == ([], 1)


def test_cases_of_one_problem_share_a_line_and_the_worst_row_stands_for_a_pair():
    cases = [
        case("a", row(1.01, quantity="edges"), problem="wave"),
        case("b", row(1.5, quantity="edges"), problem="wave"),
    ]
    (line,) = matrix_of(cases).lines
    assert [(entry.target, entry.verdict) for entry in line.cells[3]] == [("row-b-0", "deviates")]


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({}, "comparison"),
        ({"reference": Reference(kind="self", source="half the step")}, "self-comparison"),
        ({"pinned": "exact"}, "limit"),
        ({"unit": "", "expected": [0.0], "tolerance": Tolerance(value=2.0, measured=1.0, basis="required")}, "limit"),
        ({"unit": "", "expected": [0.0]}, "comparison"),
    ],
)
def test_kinds_of_rows(changes, kind):
    assert kind_of(row(**changes)) == kind


def test_rows_are_counted_by_what_they_compare():
    rows = (row(), row(code="fem"), row(pinned="exact"), row(reference=Reference(kind="self", source="itself")))
    assert tally([case("one", *rows)]) == [
        ("boundary elements", [1, 0, 0, 0, 0, 0, 0, 1, 1]),
        ("finite elements", [1, 0, 0, 0, 0, 0, 0, 0, 0]),
    ]


def test_rows_without_an_uncertainty_and_loose_tolerances_are_listed():
    wide = row(1.0, quantity="wide", tolerance=Tolerance(value=0.1, measured=0.001))
    stated = row(1.0, quantity="stated", uncertainty=0.2, tolerance=Tolerance(value=0.1, measured=0.001))
    cases = [case("one", wide, stated, row())]
    assert [found.name for found in loose(cases)] == ["one, wide"]
    assert [name for found in unstated(cases).values() for _, name in found] == ["one, wide", "one, load < K & friends"]
    text = Page(render(report(*cases))).text
    assert "Tolerance more than 10 times the error measured: 1 row" in text
    assert "Without an uncertainty: 2 rows" in text


def test_hard_cases_are_a_map_of_every_one():
    lines = hard_map([case("hard", tables=[HARD])])
    marks = {code: [cell.mark for cell in cells] for code, cells in lines.items()}
    assert marks == {"bem": ["✓", "⊘", "✗"], "fem": ["·"]}
    later = HARD.model_copy(update={"rows": [["fem", "later", "converged", "converged", "converged", "yes", 0.1]]})
    both = hard_map([case("hard", tables=[later]), case("quick", tables=[HARD])])
    assert [cell.mark for cell in both["fem"]] == ["✓"]
    text = Page(render(report(case("hard", tables=[HARD])))).text
    assert "✓ converged and correct 1, ⊘ refused as it should be 1, · at a higher level 1, ✗ neither 1" in text
