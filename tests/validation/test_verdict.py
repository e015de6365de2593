"""Verdicts beside those on the known rows of the case `harness`: that nothing passes that says nothing."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from validation.cases.suite import harness
from validation.harness.compare import combined_tolerance, error_of, error_over_tolerance, fitted_order, pairwise_orders
from validation.harness.schema import Band, CaseRecord, Reference, Report, Row, Tolerance
from validation.harness.verdict import VERDICTS, case_verdicts, counts, fails, verdict_of

EXACT = Reference(kind="exact", source="closed form")
BAND = Band(low=1.5, high=3.0, cause="mean-field theory", source="the paper", review="2027-11-21")
TOLERANCE = Tolerance(value=0.1, measured=0.04)


def row(**changes):
    plain = {
        "quantity": "load",
        "unit": "N/m",
        "reference": EXACT,
        "norm": "absolute",
        "expected": [1.0],
        "computed": [1.0],
        "tolerance": TOLERANCE,
    }
    return Row(**(plain | changes))


def banded(*ratios):
    computed = [2.0 * ratio for ratio in ratios]
    return row(norm="ratio", tolerance=None, band=BAND, expected=[2.0] * len(ratios), computed=computed)


def case(*rows, **changes):
    plain = {"id": "c", "group": "g", "level": "quick", "question": "q", "equations": "e", "sources": []}
    return CaseRecord(**(plain | {"rows": list(rows)} | changes))


def report(*cases, planned=None):
    planned = len(cases) if planned is None else planned
    return Report(level="quick", command="run", planned=planned, provenance={}, cases=list(cases))


def test_known_rows_of_the_harness_are_judged_right():
    (known,) = harness.CASES
    for judged in known.compute().rows:  # not by their verdicts, which a judge that accepts everything gives too
        assert judged.computed == pytest.approx(judged.expected, abs=judged.tolerance.value)


@pytest.mark.parametrize(
    ("computed", "verdict"),
    [
        (1.0, "agrees"),
        (1.0899, "agrees"),
        (0.9101, "agrees"),
        (1.0901, "marginal"),
        (1.0999, "marginal"),
        (0.9001, "marginal"),
        (1.1001, "deviates"),
        (0.8999, "deviates"),
    ],
)
def test_tolerance_bounds_both_sides(computed, verdict):
    assert verdict_of(row(computed=[computed])) == verdict


@pytest.mark.parametrize(
    ("ratio", "verdict"),
    [(1.5, "expected deviation"), (3.0, "expected deviation"), (1.49, "changed"), (3.01, "changed"), (-2.0, "changed")],
)
def test_band_holds_on_either_side(ratio, verdict):
    assert verdict_of(banded(ratio)) == verdict


def test_agreeing_too_well_is_a_change():
    assert verdict_of(banded(1.0)) == "changed"


@pytest.mark.parametrize("where", [0, 1, 2])
def test_one_value_outside_the_band_is_enough(where):
    ratios = [2.0, 2.0, 2.0]
    ratios[where] = 3.2
    assert verdict_of(banded(*ratios)) == "changed"


@pytest.mark.parametrize("value", [math.nan, None], ids=["nan", "missing"])
@pytest.mark.parametrize("side", ["expected", "computed"])
@pytest.mark.parametrize(
    "make", [row, lambda **k: row(norm="ratio", tolerance=None, band=BAND, **k)], ids=["t", "band"]
)
def test_no_number_never_passes(value, side, make):
    plain = {"expected": [1.0, 1.0], "computed": [2.0, 2.0]} | {side: [1.0, value]}
    assert verdict_of(make(**plain)) == "error"


def test_infinity_on_both_sides_is_no_agreement():
    assert verdict_of(row(expected=[math.inf], computed=[math.inf])) == "error"


def test_zero_reference_of_a_ratio_is_an_error():
    assert verdict_of(row(norm="ratio", tolerance=None, band=BAND, expected=[0.0], computed=[1.0])) == "error"


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=8), st.floats(1e-3, 1e3))
def test_error_is_the_largest_distance_over_the_scale(values, scale):
    expected = [0.0] * len(values)
    assert error_of(row(expected=expected, computed=values, scale=scale)) == max(map(abs, values)) / scale


def test_agreement_is_never_claimed_finer_than_the_uncertainties():
    reference = Reference(kind="FEM", source="finite elements", uncertainty=3.0)
    compared = row(reference=reference, uncertainty=4.0, computed=[5.0], expected=[1.0], scale=10.0)
    assert combined_tolerance(compared) == 5.0 / 10.0  # no factor on what the codes state
    assert error_over_tolerance(compared) == pytest.approx(0.8)
    assert verdict_of(compared) == "agrees"


def test_an_error_that_uses_up_the_uncertainty_is_marginal_and_gates_nothing():
    close = row(uncertainty=4.0, computed=[4.7], expected=[1.0])
    assert verdict_of(close) == "marginal"
    assert not fails(report(case(close)))


@pytest.mark.parametrize("status", ["not run", "not converged", "error"])
def test_a_row_that_did_not_run_keeps_its_status(status):
    assert verdict_of(row(status=status, message="why")) == status


@pytest.mark.parametrize("missing", ["quantity", "unit", "reference", "norm", "expected", "computed", "tolerance"])
def test_incomplete_row_is_refused(missing):
    content = {name: value for name, value in row().model_dump(exclude_none=True).items() if name != missing}
    with pytest.raises(ValidationError, match=r"acceptance rule" if missing == "tolerance" else missing):
        Row(**content)


@pytest.mark.parametrize(
    "changes",
    [
        {"quantity": ""},
        {"reference": {"kind": "exact", "source": ""}},
        {"reference": {"kind": "guess", "source": "s"}},
        {"norm": "eyeball"},
        {"expected": [], "computed": []},
        {"expected": [1.0, 2.0]},
        {"band": BAND, "norm": "ratio"},
        {"norm": "ratio"},
        {"status": "not run"},
        {"scale": 0.0},
        {"scale": math.inf},
        {"uncertainty": math.inf},
        {"uncertainty": math.nan},
        {"reference": {"kind": "exact", "source": "s", "uncertainty": math.inf}},
        {"tolerance": {"value": math.inf, "measured": 0.0}},
        {"tolerance": {"value": 0.1, "measured": 0.2}},
        {"surprise": 1},
    ],
    ids=repr,
)
def test_row_that_could_not_fail_or_not_be_judged_is_refused(changes):
    with pytest.raises(ValidationError):
        row(**changes)


@pytest.mark.parametrize(("low", "high"), [(2.0, 2.0), (3.0, 1.5), (1.5, math.inf), (math.nan, 3.0)])
def test_band_without_two_finite_sides_is_refused(low, high):
    with pytest.raises(ValidationError):
        Band(low=low, high=high, cause="c", source="s", review="r")


def test_every_verdict_is_counted():
    found = counts([case(row(), row(computed=[2.0]), banded(2.0), banded(1.0)), case(status="error", message="crash")])
    assert found == dict.fromkeys(VERDICTS, 0) | {
        "agrees": 1,
        "deviates": 1,
        "expected deviation": 1,
        "changed": 1,
        "error": 1,
    }


def test_case_without_rows_is_an_error():
    assert case_verdicts(case()) == ["error"]


@pytest.mark.parametrize(
    ("cases", "failed"),
    [
        ((case(row()), case(banded(2.0))), False),
        ((case(status="not run", message="no peer"),), False),
        ((case(row(), row(computed=[2.0])),), True),
        ((case(banded(1.0)),), True),
        ((case(status="error", message="crash"),), True),
    ],
    ids=["fine", "not run", "deviates", "changed", "crash"],
)
def test_gating_verdicts_fail_the_report(cases, failed):
    assert fails(report(*cases)) is failed


@pytest.mark.parametrize("planned", [1, 3])
def test_planned_and_reported_cases_must_agree(planned):
    assert fails(report(case(row()), case(row(), id="d"), planned=planned))


@given(st.floats(0.5, 8.0), st.floats(1e-6, 1e3))
def test_orders_of_a_power_law(order, constant):
    size = np.array([0.5, 0.25, 0.1, 0.05])
    error = constant * size**order
    assert fitted_order(size, error) == pytest.approx(order, rel=1e-10)  # measured 2e-14
    assert pairwise_orders(size, error) == pytest.approx([order] * 3, rel=1e-10)


def test_verdict_survives_the_file():
    stored = report(case(row(computed=[math.nan]), banded(2.0), row()))
    again = Report.model_validate_json(stored.model_dump_json(by_alias=True))
    assert counts(again.cases) == counts(stored.cases)
