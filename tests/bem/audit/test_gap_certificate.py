"""The certificate of gaps accepts exact states down to the last digits, and rejects each way of being wrong."""

from dataclasses import replace

import numpy as np
import pytest

from bem.audit.gap_certificate import NEAR_IMAGE, _cotangent, certify_gaps
from bem.elastic.layer import LayerEffect
from bem.geometry.gaps import Gaps
from bem.geometry.profile import Profile
from bem.loading.complete_contact import CompleteContact
from bem.nonadhesive.completed_body import CompletedBody, LinearControl
from bem.nonadhesive.gap_series import evaluate_gaps
from bem.nonadhesive.last_gaps import isolated_cracks, solve_gaps

DEFICITS = pytest.mark.parametrize("deficit", [0.1, 1e-4, 1e-9], ids=str)


def two_waves(phase=0.0):
    return Profile.from_harmonics(2 * np.pi, [1, 2], [1.0, 1.0], [0.0, phase]).scaled()


def body_of(profile, ratio=None):
    stiffness = profile.orders / (1.0 if ratio is None else ratio(profile.orders.astype(float)))
    pressure = Profile(profile.period, profile.orders, stiffness * profile.amplitudes, profile.phases)
    return CompletedBody(CompleteContact(pressure, 0.0, 0.0, 0.0), profile.max_height, ratio)


def solved(profile, deficit, ratio=None):
    """The state at a deficit relative to the mean pressure of complete contact."""
    body = body_of(profile, ratio)
    condition = LinearControl(0.0, 1.0, 2 * np.pi * body.lowest * deficit)
    return solve_gaps(body, condition, isolated_cracks(body, condition)).state


def at_deficit(state):
    """The condition that holds the deficit of a state."""
    return LinearControl(0.0, 1.0, 2 * np.pi * state.deficit)


def judged(profile, state, ratio=None, opening=None, **changed):
    series = state.opening if opening is None else opening
    given = {
        "deficit": state.deficit,
        "mean_pressure": state.mean_pressure,
        "separation": state.separation,
        "penetration": state.penetration,
    } | changed
    return certify_gaps(profile, state.gaps, series, compliance_ratio=ratio, **given)


@pytest.mark.parametrize("deficit", [0.3, 0.1, 1e-4, 1e-9, 1e-12], ids=str)
@pytest.mark.parametrize(
    "profile",
    [two_waves(), two_waves(0.7), Profile.self_affine(2 * np.pi, 0.7, 1.0, 100, 1).scaled()],
    ids=["equal", "different", "rough"],
)
def test_correct_states_are_ok(profile, deficit):
    assert judged(profile, solved(profile, deficit)).reasons == ()


@pytest.mark.parametrize("nu", [0.3, 0.5])
@DEFICITS
def test_a_layer_enters_through_its_spectrum(deficit, nu):
    profile, ratio = two_waves(0.7), LayerEffect(0.4, nu).ratio
    state = solved(profile, deficit, ratio)
    assert judged(profile, state, ratio).reasons == ()
    assert not judged(profile, state).ok


@DEFICITS
@pytest.mark.parametrize("sign", [1, -1], ids=["outward", "inward"])
@pytest.mark.parametrize("end", range(4))
def test_every_end_moved_by_a_hundred_thousandth_and_solved_again_is_not_ok(end, sign, deficit):
    """Or by what rounding of pressures leaves uncertain, 1e-13 over the deficit."""
    profile = two_waves()
    state = solved(profile, deficit)
    outward = np.zeros(4)
    outward[end] = sign * (1e-5 + 1e-13 / deficit) * state.gaps.half_width[end % 2]
    again = evaluate_gaps(state.body, state.gaps.moved(outward), at_deficit(state))
    reasons = judged(profile, again).reasons
    assert any("closure" in reason for reason in reasons)


@DEFICITS
def test_a_gap_taken_for_contact_is_tension(deficit):
    """Without the other, one of two equal gaps is in equilibrium, but contact is under tension where the other was."""
    profile = two_waves()
    state = solved(profile, deficit)
    alone = evaluate_gaps(state.body, state.gaps.kept(np.array([True, False])), at_deficit(state))
    for _ in range(30):
        ends = 2 / 3 * alone.end_values / alone.end_slopes * alone.gaps.half_width
        alone = evaluate_gaps(state.body, alone.gaps.moved(ends), at_deficit(state))
    reasons = judged(profile, alone).reasons
    assert [reason.split()[0] for reason in reasons] == ["tension"]


@DEFICITS
def test_an_opening_scaled_by_a_millionth_leaves_pressure_in_the_gap(deficit):
    profile = two_waves(0.7)
    state = solved(profile, deficit)
    opening = tuple(series * (1 + 1e-5) for series in state.opening)
    assert any("pressure in a gap" in reason for reason in judged(profile, state, opening=opening).reasons)


@DEFICITS
def test_a_wrong_separation_is_not_ok(deficit):
    profile = two_waves(0.7)
    state = solved(profile, deficit)
    wrong = judged(profile, state, separation=state.separation * (1 + 1e-7))
    assert [reason.split(" 1")[0] for reason in wrong.reasons] == ["mean gap over separation"]


def test_a_wrong_penetration_or_mean_pressure_is_not_ok():
    profile = two_waves(0.7)
    state = solved(profile, 1e-4)
    assert any("less separation" in r for r in judged(profile, state, penetration=state.penetration + 1e-9).reasons)
    assert any("deficit" in r for r in judged(profile, state, mean_pressure=state.mean_pressure * (1 + 1e-13)).reasons)


def test_too_few_terms_are_seen():
    profile = two_waves()
    state = solved(profile, 0.3)
    reasons = judged(profile, state, opening=tuple(series[:6] for series in state.opening)).reasons
    assert any("truncation" in reason for reason in reasons)


def test_overlapping_surfaces_are_seen():
    """A gap across a crest, with its ends where they are."""
    profile = two_waves()
    state = solved(profile, 0.1)
    wide = replace(state.gaps, half_width=state.gaps.half_width * 1.5)
    again = evaluate_gaps(state.body, wide, at_deficit(state))
    assert any("interpenetration" in reason for reason in judged(profile, again).reasons)


def test_what_is_not_a_number_is_not_ok():
    profile = two_waves()
    state = solved(profile, 0.1)
    opening = (np.append(state.opening[0][:-1], np.nan), state.opening[1])
    assert not judged(profile, state, opening=opening).ok


@pytest.mark.parametrize("half_width", [[], [-0.1, 0.1], [2.0, 2.0]], ids=["none", "negative", "overlap"])
def test_gaps_that_are_none_are_refused(half_width):
    half = np.array(half_width)
    gaps = Gaps(np.arange(half.size) * 1.0, np.zeros(half.size), half)
    given = dict.fromkeys(("deficit", "mean_pressure", "separation", "penetration"), 0.1)
    with pytest.raises(ValueError, match="at least one"):
        certify_gaps(two_waves(), gaps, tuple(np.ones(4) for _ in half), **given)


def test_the_field_next_to_an_image_is_the_cotangent_less_its_pole():
    """The series and the difference, on both sides of where one follows the other."""
    y = NEAR_IMAGE * np.array([-2.0, -1.01, -0.99, -0.5, 0.5, 0.99, 1.01, 2.0])
    assert _cotangent(y, [y]) == pytest.approx(0.5 / np.tan(y / 2) - 1 / y, rel=0, abs=1e-13)
