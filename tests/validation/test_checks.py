"""What cases share: tolerances from the error measured, columns of states in their units, work summed, words."""

from types import SimpleNamespace

import pytest

from validation.cases.shared.checks import Against, as_many, case, column, posed, work
from validation.harness.case import gathered
from validation.harness.figure_data import axes, digits, drawn, marks, table
from validation.harness.verdict import verdict_of

KNOWN = Against("exact", "a closed form")


@pytest.mark.parametrize(
    ("measured", "required", "tolerance", "basis"),
    [(0.02, None, 0.05, "measured"), ((0.07, 0.02), None, 0.07, "measured"), (0.02, 0.1, 0.1, "required")],
)
def test_tolerance_follows_the_error_measured_unless_it_is_given(measured, required, tolerance, basis):
    row = KNOWN.row("load", "N/m", 1.0, 1.04, measured, required=required)
    assert (row.tolerance.value, row.tolerance.measured, row.tolerance.basis) == (tolerance, 0.02, basis)
    assert verdict_of(row) == "agrees"


def test_a_tolerance_below_the_error_measured_is_refused():
    with pytest.raises(ValueError, match="below the measured error"):
        KNOWN.row("load", "N/m", 1.0, 1.0, 0.02, required=0.01)


def test_a_row_without_a_tolerance_is_refused():
    with pytest.raises(ValueError, match="neither an error measured nor one required"):
        KNOWN.row("load", "N/m", 1.0, 1.0, None)


@pytest.mark.parametrize(("computed", "verdict"), [(2.0, "expected deviation"), (1.0, "changed")])
def test_a_known_discrepancy_fails_where_it_is_gone(computed, verdict):
    row = KNOWN.ratio("area", "", 1.0, computed, (1.5, 3.0), "made up", "this test")
    assert verdict_of(row) == verdict


def test_a_value_that_is_not_there_is_an_error():
    assert verdict_of(KNOWN.row("load", "N/m", [1.0, 1.0], [1.0, None], 0.1)) == "error"


def test_columns_are_in_their_unit_and_nothing_stays_nothing():
    states = [SimpleNamespace(p=2.0, kind="a"), SimpleNamespace(p=None, kind="b")]
    assert column(states, "p", 4.0) == [0.5, None]
    assert column(states, "kind") == ["a", "b"]


def test_work_of_paths_is_summed_but_for_the_largest_system():
    paths = [SimpleNamespace(states=[SimpleNamespace(unknowns=n, evaluations=n)] * 2, events=[1]) for n in (3, 5)]
    assert work("unknowns evaluations states events", *paths) == {
        "unknowns": 5,
        "evaluations": 16,
        "states": 4,
        "events": 2,
    }


def test_a_case_is_told_in_words():
    made = case(
        "one", "group", lambda: iter(()), "Why?", "$a$", "johnson1995 carbone2009", "layer adhesion", scene="sinusoid"
    )
    assert made.sources == ("johnson1995", "carbone2009")
    assert made.effects == ("layer", "adhesion")
    assert "[solid]" in made.scene


def test_a_case_is_what_it_yields_each_kind_in_its_order():
    rows = [KNOWN.row(name, "N/m", 1.0, 1.0, 0.1) for name in ("first", "second")]
    figure = drawn("one", "One point.", axes("x", "y", marks("found", [1.0], [2.0])))
    lines = table("Two numbers.", {"name": ("a", "b"), "value": digits([1.26, 0.0314], 2)})
    found = gathered(lambda: iter((rows[0], {"states": 1}, figure, lines, rows[1], {"events": 2})))
    assert (found.rows, found.figures, found.tables) == (tuple(rows), (figure,), (lines,))
    assert found.counts == {"states": 1, "events": 2}
    assert (lines.columns, lines.rows) == (["name", "value"], [["a", 1.3], ["b", 0.031]])


def test_a_case_that_yields_something_else_is_refused():
    with pytest.raises(TypeError, match="not tuple"):
        gathered(lambda: iter(((KNOWN.row("load", "N/m", 1.0, 1.0, 0.1),),)))


@pytest.mark.parametrize("found", [[], [1.0], [1.0, 1.0, 1.0]])
def test_another_number_of_values_is_an_error(found):
    assert verdict_of(KNOWN.row("load", "N/m", [1.0, 1.0], as_many(found, [1.0, 1.0]), 0.1)) == "error"


def test_columns_of_a_table_are_of_one_length():
    with pytest.raises(ValueError, match="shorter"):
        table("Two numbers.", {"name": ("a", "b"), "value": (1.0,)})


def test_tables_of_a_scene_are_changed_and_left_out():
    scene = posed("sinusoid", adhesion=None, solid={"poisson_ratio": 0.25})
    assert scene.adhesion is None
    assert scene.solid.poisson_ratio == 0.25
