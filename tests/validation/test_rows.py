"""The one rule that judges rows, on rows made by hand: every verdict, and what a person reads."""

import math

import numpy as np
import pytest

from validation.plugin.rows import Code, Quantity, Rows

PAIR = {"of": Code.BEM, "by": Code.FEM, "quantity": Quantity.AREA}
EXACT = PAIR | {"by": Code.EXACT}


def compared(value, reference, stored=None, **options):
    options = {"uncertainty": (3e-3, 4e-3)} | PAIR | options
    return Rows(stored).compare("area", value, reference, **options)


@pytest.mark.parametrize(
    ("difference", "verdict"),
    [(0.0, "agrees"), (4e-3, "agrees"), (4.6e-3, "marginal"), (-4.6e-3, "marginal"), (5.1e-3, "deviates")],
)
def test_the_difference_is_held_against_the_uncertainty_of_both_sides(difference, verdict):
    row = compared(0.3 + difference, 0.3)
    assert row.allowed == [pytest.approx(5e-3)]
    assert row.verdict == verdict


def test_a_requirement_decides_alone_and_the_uncertainty_stands_beside_it():
    row = compared(0.31, 0.3, required=0.02, because="decides nothing in a design")
    assert (row.verdict, row.allowed, row.value_uncertainties, row.reason) == (
        "agrees",
        [0.02],
        [3e-3],
        "decides nothing in a design",
    )
    assert compared(0.3001, 0.3, required=1e-5, because="asked for").verdict == "deviates"


@pytest.mark.parametrize(("error", "verdict"), [(4.9e-6, "agrees"), (5.1e-6, "changed")])
def test_an_error_five_times_the_stored_one_fails_though_it_is_allowed(error, verdict):
    row = compared(0.3 + error, 0.3, {"area [bem, fem]": 1e-6})
    assert row.verdict == verdict


def test_rounding_of_the_reference_is_no_regression_but_a_reference_of_zero_has_none():
    stored = {"area [bem, closed form]": 0.0}
    assert compared(0.3 + 2e-14, 0.3, stored, uncertainty=1e-6, by=Code.EXACT).verdict == "agrees"
    assert compared(1e-20, 0.0, stored, uncertainty=1e-6, by=Code.EXACT).verdict == "changed"


def test_the_worst_of_many_values_decides():
    row = compared([1.0, 2.0, 3.0], [1.0, 2.1, 3.05], uncertainty=([0.1, 0.2, 0.01], 0.0))
    assert (row.worst, row.verdict) == (2, "deviates")
    assert "(worst: 3 of 3)" in row.described()


@pytest.mark.parametrize("values", [math.nan, math.inf, [1.0, math.nan], None])
def test_what_is_not_a_number_is_an_error(values):
    assert compared(values, 1.0).verdict == "error"
    assert compared(1.0, 1.0, uncertainty=(math.nan, 0.0)).verdict == "error"


def test_lists_of_unequal_length_are_an_error_and_later_rows_stay():
    rows = Rows()
    assert rows.compare("edges", [1.0, 2.0, 3.0], [1.0, 2.0], uncertainty=(1, 1), **PAIR).verdict == "error"
    assert rows.compare("area", 1.0, 1.0, uncertainty=(1, 1), **PAIR).verdict == "agrees"
    with pytest.raises(AssertionError, match="3 values, 2 references"):
        rows.conclude()


@pytest.mark.parametrize(("value", "verdict"), [(1.1, "changed"), (1.5, "expected deviation"), (1.9, "changed")])
def test_a_known_deviation_fails_on_either_side_of_its_band(value, verdict):
    row = Rows({}).known("area", 2 * value, 2.0, band=(1.2, 1.8), cause="mean field", uncertainty=(0.2, 0.1), **PAIR)
    assert row.verdict == verdict
    assert row.value_uncertainties == [pytest.approx(0.1)]
    assert row.reference_uncertainties == [pytest.approx(0.05 * value)]
    assert "1.2 to 1.8, cause: mean field" in row.described()


@pytest.mark.parametrize(
    ("value", "verdict"), [(121, "deviates"), (119, "marginal"), (80.5, "marginal"), (79, "deviates")]
)
def test_a_count_stays_within_a_share_of_the_stored_one(value, verdict):
    row = Rows({"steps [bem, stored]": 100.0}).count("steps", value, of=Code.BEM)
    assert (row.kind, row.verdict) == ("regression", verdict)


def test_the_order_of_convergence_has_the_scatter_of_its_fit():
    sizes = np.array([10.0, 20.0, 40.0, 80.0])
    errors = sizes**-3.0 * np.array([1.0, 1.05, 0.95, 1.0])
    rows = Rows()
    row = rows.order("area", sizes, errors, 3.0, of=Code.FEM)
    slope, covariance = np.polyfit(np.log(sizes), np.log(errors), 1, cov=True)
    assert row.values == [pytest.approx(-slope[0])]
    assert row.allowed == [pytest.approx(2 * math.sqrt(covariance[0, 0] * 2 / 2))]  # numpy scales by n - 2, too
    assert row.verdict == "agrees"
    assert rows.order("drag", sizes, errors, 2.9, of=Code.FEM).verdict == "deviates"
    assert rows.order("load", sizes, errors, 2.9, of=Code.FEM, required=0.2, because="asked").verdict != "deviates"
    assert len(rows.figures) == 3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"uncertainty": None}, "needs uncertainty="),
        ({"uncertainty": 1e-3}, "the reference is not exact"),
        ({"required": 1e-3}, "a requirement has its reason"),
        ({"because": "of this"}, "a requirement has its reason"),
        ({"quantity": Quantity.COUNT, "uncertainty": (0.0, 0.0)}, "kind='construction'"),
    ],
)
def test_a_row_without_its_rule_is_refused(options, message):
    with pytest.raises(TypeError, match=message):
        compared(1.0, 1.0, **options)


def test_a_construction_needs_no_uncertainty():
    row = Rows().compare("closure", 1.0, 1.0, required=1e-9, because="tolerance", kind="construction", **PAIR)
    assert (row.kind, row.verdict) == ("construction", "agrees")


def test_unknown_quantities_and_second_rows_of_a_name_are_refused():
    rows = Rows()
    rows.compare("area", 1.0, 1.0, uncertainty=(1, 1), **PAIR)
    rows.compare("area", 1.0, 1.0, uncertainty=1, **EXACT)
    with pytest.raises(TypeError, match="a second row of this name"):
        rows.compare("area", 1.0, 1.0, uncertainty=(1, 1), **PAIR)
    with pytest.raises(ValueError, match="weight"):
        rows.compare("weight", 1.0, 1.0, uncertainty=(1, 1), **PAIR | {"quantity": "weight"})


def test_a_state_that_does_not_exist_is_a_failed_row():
    rows = Rows()
    assert rows.not_converged("area", "the fold was not located", **PAIR).verdict == "not converged"
    with pytest.raises(AssertionError, match="the fold was not located"):
        rows.conclude()


def test_a_failure_says_what_was_measured_expected_allowed_and_stored():
    row = compared(0.31, 0.3, {"area [bem, fem]": 1e-6}, unit="Pa", uncertainty=(0.1, 0.0), source="Johnson 1995")
    lines = row.described().splitlines()
    assert lines[0].startswith("validation/test_rows.py:") and lines[0].endswith(": area: changed")
    assert lines[1:] == [
        "    measured    0.31 Pa (bem)",
        "    expected    0.3 Pa (fem: Johnson 1995)",
        "    difference  +0.01 Pa, 0.1 of the allowed 0.1 Pa (U of both sides)",
        "    stored      error 1e-06 Pa; fails above 5e-06 Pa",
    ]
