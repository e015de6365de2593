"""The conclusion in words: from manufactured curves, whose cheapest settings and crossings are known."""

import pytest

from validation.studies.work_precision.conclusion import DIGITS, MethodCurve, Spot, cheapest, crossing, sentences


def power(name, constant, slope, exponents=range(1, 13), **more):
    """Seconds = constant * error^-slope at errors 10^-exponent."""
    marks = tuple(Spot(f"{name}-{k}", 10.0**-k, constant * 10.0 ** (slope * k)) for k in exponents)
    return MethodCurve(name, "exact", marks, **more)


FLAT = power("flat", 1.0, 0.0, range(12, 13))
STEEP = power("steep", 1e-3, 0.5, range(1, 9))


@pytest.mark.parametrize("digits", DIGITS, ids=str)
def test_cheapest_setting_for_given_digits(digits):
    assert cheapest(power("a", 1.0, 0.3), digits).setting == f"a-{digits}"


def test_cheapest_is_not_the_coarsest_that_will_do_but_the_quickest():
    curve = MethodCurve("a", "exact", (Spot("coarse", 1e-3, 2.0), Spot("fine", 1e-9, 1.0)))
    assert cheapest(curve, 2).setting == "fine"


def test_of_times_that_differ_by_noise_the_coarsest_setting_is_named():
    curve = MethodCurve("a", "exact", (Spot("8", 1e-5, 1.05), Spot("12", 1e-10, 1.0), Spot("16", 1e-14, 1.2)))
    assert [cheapest(curve, digits).setting for digits in (2, 6)] == ["8", "12"]


def test_words_when_two_curves_cross_twice():
    bent = MethodCurve("bent", "exact", (Spot("", 1e-2, 0.1), Spot("", 1e-4, 9.9), Spot("", 1e-9, 10.0)))
    even = MethodCurve("even", "exact", (Spot("", 1e-2, 1.0), Spot("", 1e-4, 1.0), Spot("", 1e-9, 1e4)))
    reported = (
        "bent is cheaper than even down to an error of 9.9e-04, from there even down to 5.7e-06; then the other way."
    )
    assert sentences("scene", [bent, even])[5] == f"scene: {reported}"


def test_no_digits_beyond_the_reference():
    curve = power("a", 1.0, 0.3, floor=1e-7)
    assert cheapest(curve, 6) is not None
    assert cheapest(curve, 8) is None


def test_self_convergence_gives_no_digits():
    curve = power("a", 1.0, 0.3, independent=False)
    assert cheapest(curve, 2) is None
    assert any("self-convergence, no digits" in line for line in sentences("scene", [curve]))


def test_curves_cross_where_their_times_are_equal():
    # 1e-3 * error^-0.5 = 1 at 1e-6
    assert crossing(FLAT, STEEP) == pytest.approx([1e-6], rel=1e-9)
    assert crossing(STEEP, FLAT) == pytest.approx([1e-6], rel=1e-9)


def test_curves_cross_in_error_not_in_their_order():
    shifted = MethodCurve("shifted", "exact", tuple(reversed(STEEP.marks)))
    assert crossing(FLAT, shifted) == pytest.approx([1e-6], rel=1e-9)


def test_points_that_others_beat_do_not_count():
    worse = MethodCurve("steep", "exact", (*STEEP.marks, Spot("bad", 1e-2, 1e3)))
    assert crossing(FLAT, worse) == pytest.approx([1e-6], rel=1e-9)


def test_curves_that_do_not_cross():
    assert crossing(power("a", 1.0, 0.2), power("b", 2.0, 0.2)) == []
    reported = sentences("scene", [power("a", 1.0, 0.2), power("b", 2.0, 0.2)])
    assert reported[-1] == "scene: a is cheaper than b at every error that both reach."


def test_words_name_setting_seconds_reference_and_the_others():
    reported = sentences("scene", [FLAT, STEEP])
    assert reported[0] == (
        "scene: 2 digits cost least with steep at steep-2 (0.01 s, error 1.0e-02 against exact); "
        "flat 100.0 times as long."
    )
    assert reported[4] == (
        "scene: 9 digits cost least with flat at flat-12 (1 s, error 1.0e-12 against exact); steep not at all."
    )
    assert reported[5] == "scene: steep is cheaper than flat down to an error of 1.0e-06; then the other way."


def test_words_when_no_method_reaches_the_digits():
    reported = sentences("scene", [power("a", 1.0, 0.2, range(1, 4))])
    assert reported[2] == "scene: no setting reaches 4 digits that its reference resolves."
