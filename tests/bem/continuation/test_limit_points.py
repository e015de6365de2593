"""Ends of branches by their own equation: folds against closed forms, broken symmetries, and ways that lead on."""

from dataclasses import replace

import numpy as np
import pytest

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.branch import tangent
from bem.adhesive.descent import Steps, descend
from bem.adhesive.equilibrium import System, balance, correct, forces
from bem.adhesive.relaxation import Relaxed, interpenetration
from bem.adhesive.third_derivatives import with_slopes
from bem.continuation import branch_ends, limit_points
from bem.continuation.branch_ends import TouchedFold
from bem.continuation.departure import departure
from bem.continuation.foretold_folds import foretell_folds
from bem.continuation.jumps import Jumps, interpolated
from bem.continuation.limit_points import Search, UndecidedError, before_fold, locate_limit_point, sharper
from bem.continuation.points_with_edges import Equilibrium, equilibrium
from bem.continuation.rest import at_rest
from bem.continuation.softness import LostError, Soft, refined
from bem.continuation.turning_points import continued
from bem.elastic.collocation import Elastic, resolve
from bem.elastic.gap import GapMinima
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.complete_contact import complete_contact
from bem.loading.control import DisplacementControl, LoadControl
from bem.loading.increments import Accuracy, Increments
from bem.loading.path_events import EventNumbers

BETWEEN_AND_AT_TARGETS = (Accuracy(1e-3, 1e-4), Accuracy(1e-8, 1e-9))
TOLERANCES = (1e-3, 1e-5, 1e-8)
AMPLITUDE = np.sqrt(2.0)  # of a wave of unit rms height
ALPHA = 0.3


def johnson(quantity, psi):
    """Load per period or penetration on the branch of one wave (Johnson 1995), dimensionless."""
    S, t = np.sin(psi) ** 2, ALPHA * np.sqrt(np.tan(psi))
    return 2 * np.pi * AMPLITUDE * (S - t) if quantity == "load" else AMPLITUDE * (S * (1 - np.log(S)) + t * np.log(S))


def lowest(quantity):
    """Least value on the branch, to rounding: on ever finer grids around it."""
    psi = np.linspace(0.01, 0.8, 1001)
    for _ in range(8):
        best = psi[np.argmin(johnson(quantity, psi))]
        psi = np.linspace(best - (psi[1] - psi[0]) * 2, best + (psi[1] - psi[0]) * 2, 1001)
    return float(np.min(johnson(quantity, psi)))


def system_of(orders, amplitudes, control, work):
    return System(Elastic(Profile.from_harmonics(2 * np.pi, orders, amplitudes)), UniformLaw(work), control)


def wave(control):
    return system_of([1], [AMPLITUDE], control, np.pi * (ALPHA * AMPLITUDE) ** 2 / 2)


def resting(system, centers, half_width, value):
    """Coarse equilibrium of patches around crests, with its value of the control."""
    patches = Patches(np.array(centers) - half_width, np.array(centers) + half_width)
    found = descend(system, patches, 0.0, value, Accuracy(1e-3, 1e-4), Steps(0.2))
    assert found.status == "converged"
    return found.balance


@pytest.mark.parametrize(
    ("control", "quantity", "taken"),
    [(DisplacementControl(), "penetration", 12), (LoadControl(), "load", 5)],
    ids=["Delta", "load"],
)
def test_a_fold_is_where_johnsons_branch_turns(control, quantity, taken):
    """Under Delta the mode that moves the patch aside is softest at first, and is asked about before."""
    system, exact = wave(control), lowest(quantity)
    start = 0.7 * exact
    here = resting(system, [2 * np.pi], 0.8, start)
    before = system.effort.evaluations
    found = locate_limit_point(system, here, start, Search(exact - start, TOLERANCES))
    assert found.kind == "fold"
    assert found.exact.value == pytest.approx(exact, rel=1e-11)  # measured 3e-13
    assert abs(found.exact.value - exact) <= 3 * found.error.value + 1e-13
    assert system.effort.evaluations - before <= taken + 2


@pytest.mark.parametrize("tolerances", [TOLERANCES, (1e-8,) * 3], ids=["finer and finest", "finest alone"])
@pytest.mark.parametrize(
    ("control", "quantity"), [(DisplacementControl(), "penetration"), (LoadControl(), "load")], ids=["Delta", "load"]
)
def test_a_fold_is_sharper_by_more_nodes_and_modes(control, quantity, tolerances):
    system, exact = wave(control), lowest(quantity)
    here = resting(system, [2 * np.pi], 0.8, 0.7 * exact)
    found = locate_limit_point(system, here, 0.7 * exact, Search(0.3 * exact, tolerances))
    again = sharper(system, found, 1e-8)
    known, more = found.balance.state.resolution, again.balance.state.resolution
    assert np.all(more.nodes > known.nodes) and np.all(more.modes > known.modes)
    assert abs(again.exact.value - exact) <= 3 * again.error.value + 1e-13  # measured 4e-14
    assert again.error.value <= 6e-12  # measured 2e-12, of folds whose error was up to 2.6e-7


@pytest.mark.parametrize(
    "control", [DisplacementControl(), DisplacementControl(0.7), LoadControl()], ids=["Delta", "spring", "load"]
)
def test_the_softest_mode_stiffens_as_differences_of_hessians_say(control):
    system, value, change = wave(control), 0.5, 0.1
    here = resting(system, [2 * np.pi], 1.0, value)
    soft = Soft(system, here, value, here.scale)
    rate = control.rate(here.state)

    def eigenvalue(by):
        beside = forces(system, here.state.shifted(by * rate), value + by)
        return (soft.mode * here.scale) @ beside.hessian @ (soft.mode * here.scale)

    # the Hessian is quadratic in the control; measured 3e-14
    assert soft.eigenvalue_rate == pytest.approx((eigenvalue(change) - eigenvalue(-change)) / (2 * change), rel=1e-13)


def test_edges_between_a_point_and_a_touched_fold_follow_the_branch():
    system, exact = wave(DisplacementControl()), lowest("penetration")
    values = exact * np.array([0.8, 0.95])
    here, between = (resting(system, [2 * np.pi], 0.8, value) for value in values)
    fold = locate_limit_point(system, here, values[0], Search(exact - values[0], TOLERANCES))
    point = Equilibrium(values[0], here, tangent(system.control, here))
    touched = TouchedFold(fold.exact.value, fold.balance.state, interpenetration(system, here.state, 1.0))
    found = interpolated(point, touched, values[1]).half_width[0]
    width = here.state.patches.half_width[0] - fold.balance.state.patches.half_width[0]
    assert found == pytest.approx(between.state.patches.half_width[0], abs=4e-3 * width)  # measured 1.5e-3


@pytest.mark.parametrize(
    ("control", "quantity", "expected"),
    [(DisplacementControl(), "penetration", 1.48), (LoadControl(), "load", 1.05)],
    ids=["Delta", "load"],
)
@pytest.mark.parametrize("part", [0.1, 0.02, 0.005])
def test_the_error_of_the_distance_falls_with_its_root(control, quantity, expected, part):
    """d is too long by 1.41 to 1.56, under load by 1.04 to 1.07 of its root, in parts of the value at the fold."""
    system, exact = wave(control), lowest(quantity)
    start = exact * (1 - part)
    here = resting(system, [2 * np.pi], 0.8, start)
    here = with_slopes(system, here, start, 1e-3)
    foretold = foretell_folds(system, Soft(system, here, start, here.scale), exact - start)
    error = foretold.distance / abs(exact - start) - 1
    assert error / np.sqrt(part) == pytest.approx(expected, rel=0.08)


def test_a_fold_behind_a_snap_does_not_come_back(monkeypatch):
    """Refused once, it is not returned where the way along the branch finds nothing either."""
    system, exact = wave(DisplacementControl()), lowest("penetration")
    start = 0.98 * exact
    here = resting(system, [2 * np.pi], 0.8, start)
    searched, neutral = [], limit_points._neutral

    def only_once(*inputs, **options):
        searched.append(inputs)
        if len(searched) > 1:
            raise LostError
        return neutral(*inputs, **options)

    monkeypatch.setattr(limit_points, "_is_expected", lambda *_: False)
    monkeypatch.setattr(limit_points, "_neutral", only_once)
    assert locate_limit_point(system, here, start, Search(exact - start, TOLERANCES, thorough=True)) is None
    assert len(searched) > 1


def test_a_fold_that_finer_evaluations_do_not_confirm_is_undecided_unless_they_led_there(monkeypatch):
    system, exact = wave(DisplacementControl()), lowest("penetration")
    start = 0.98 * exact
    here = resting(system, [2 * np.pi], 0.8, start)
    monkeypatch.setattr(limit_points, "_improved", lambda *_: None)
    with pytest.raises(UndecidedError):
        locate_limit_point(system, here, start, Search(exact - start, TOLERANCES))
    assert locate_limit_point(system, here, start, Search(exact - start, TOLERANCES[2:] * 3)) is None


@pytest.mark.parametrize(("rival", "undecided"), [(1.05, True), (1.2, False), (np.inf, False)])
def test_coarse_evaluations_that_find_no_fold_of_two_modes_at_once_decide_nothing(monkeypatch, rival, undecided):
    """Newton goes to and fro between the two: so it missed an event of one of 31 realisations in small increments."""
    system, exact = wave(DisplacementControl()), lowest("penetration")
    start = 0.98 * exact
    here = resting(system, [2 * np.pi], 0.8, start)
    foretell = limit_points.foretell_folds

    def with_rival(*inputs):
        found = foretell(*inputs)
        return replace(found, distances=found.distance * np.array([1.0, rival]))

    monkeypatch.setattr(limit_points, "foretell_folds", with_rival)
    monkeypatch.setattr(limit_points, "_neutral", lambda *_, **__: None)
    search = Search(exact - start, TOLERANCES)
    if undecided:
        with pytest.raises(UndecidedError):
            locate_limit_point(system, here, start, search)
        search = replace(search, tolerances=TOLERANCES[2:] * 3)
    assert locate_limit_point(system, here, start, search) is None


def test_an_undecided_fold_is_looked_for_at_the_accuracy_of_targets(monkeypatch):
    system, exact = wave(DisplacementControl()), lowest("penetration")
    start = 0.98 * exact
    point = equilibrium(system, start, resting(system, [2 * np.pi], 0.8, start))
    searches, located = [], branch_ends.locate_limit_point

    def undecided_at_first(system, here, value, search):
        searches.append((here, search.tolerances))
        if len(searches) == 1:
            raise UndecidedError
        return located(system, here, value, search)

    monkeypatch.setattr(branch_ends, "locate_limit_point", undecided_at_first)
    found = branch_ends.BranchEnds(system, Increments(0.1, 1e-3)).limit_point(point, exact - start, False)
    assert found.exact.value == pytest.approx(exact, rel=1e-11)
    assert searches[1][1] == (1e-8, 1e-8, 1e-8)
    assert searches[1][0].residual <= 1e-9 < searches[0][0].residual


@pytest.mark.parametrize("thorough", [False, True])
def test_a_gap_that_surely_is_closed_beside_a_fold_ends_the_search(monkeypatch, thorough):
    """A gap below zero by half the accuracy between targets: more than coarse evaluations are off by; a search that has
    no shorter increments behind it asks finer ones."""
    system, exact = wave(DisplacementControl()), lowest("penetration")
    start = 0.98 * exact
    point = equilibrium(system, start, resting(system, [2 * np.pi], 0.8, start))
    closed = GapMinima(np.array([np.pi]), np.array([-0.5e-3]), np.array([0]))
    none, improved, finer = GapMinima(*(x[:0] for x in (closed.position, closed.depth, closed.gap))), [], refined

    def found(system, state, allowed):
        return closed if allowed < 0.5e-3 else none

    monkeypatch.setattr(branch_ends, "interpenetration", found)
    monkeypatch.setattr(limit_points, "refined", lambda *inputs: improved.append(inputs) or finer(*inputs))
    limit = branch_ends.BranchEnds(system, Increments(0.1, 1e-3)).limit_point(point, exact - start, thorough)
    assert isinstance(limit, TouchedFold)
    assert bool(improved) == thorough


def test_no_fold_is_found_far_from_it():
    system = wave(DisplacementControl())
    here = resting(system, [2 * np.pi], 1.0, 0.5)
    assert locate_limit_point(system, here, 0.5, Search(-0.01, TOLERANCES)) is None


def test_before_a_fold_the_branch_is_where_its_parabola_says():
    system, exact = wave(DisplacementControl()), lowest("penetration")
    here = resting(system, [2 * np.pi], 0.8, 0.7 * exact)
    fold = locate_limit_point(system, here, 0.7 * exact, Search(0.3 * exact, TOLERANCES))
    value = exact * (1 - 1e-5)
    near = before_fold(fold, value)
    found = correct(system, near, value, value, Accuracy(1e-8, 1e-9)).balance
    moved = found.state.patches.half_width - fold.balance.state.patches.half_width
    np.testing.assert_allclose(near.half_width - fold.balance.state.patches.half_width, moved, rtol=0.05)


def equal_crests(count, delta=0.0, alpha=0.05):
    work = np.pi * (alpha * AMPLITUDE) ** 2 * count / 2
    orders, amplitudes = ([count], [AMPLITUDE]) if not delta else ([1, count], [delta, AMPLITUDE])
    return system_of(orders, amplitudes, DisplacementControl(), work)


def symmetric_state(system, count, value):
    crests = np.arange(1, count + 1) * 2 * np.pi / count
    return resting(system, crests, 0.2 / count, value)


@pytest.mark.parametrize("count", [2, 3, 4, 7])
def test_equal_crests_lose_their_symmetry_before_they_pull_off(count):
    """The load does no work on the modes that turn soft; their number is that of a representation of the symmetry."""
    system = equal_crests(count)
    start = -0.05
    here = symmetric_state(system, count, start)
    found = locate_limit_point(system, here, start, Search(-0.05, TOLERANCES, thorough=True))
    assert found.kind == "broken_symmetry"
    assert found.modes.shape[1] == (1 if count == 2 else 2)
    pull = found.balance.load_gradient
    for mode in found.modes.T:
        assert abs(pull @ mode) <= 1e-7 * np.linalg.norm(pull) * np.linalg.norm(mode)
    assert found.error.value <= 1e-9
    widths = found.balance.state.patches.width
    np.testing.assert_allclose(widths, widths.mean(), rtol=1e-6)
    way = departure(system, found, *BETWEEN_AND_AT_TARGETS)
    assert way.leads_on
    inward = -(way.outward[:count] + way.outward[count:])
    assert np.argmax(inward) == np.argmax(np.abs(inward))  # one patch shrinks most


@pytest.mark.parametrize(("waves", "refused"), [(0.45, False), (0.55, True)])
def test_a_limit_point_half_a_pinning_wave_away_is_of_another_branch(monkeypatch, waves, refused):
    """Whatever the control says: an edge snaps from wave to wave, and each has folds of its own."""
    system, start = system_of([1, 40], [AMPLITUDE, 0.02], DisplacementControl(), 0.3), 0.0
    point = equilibrium(system, start, resting(system, [0.0], 1.0, start))
    lengths = system.pinning.shortest(point.balance.work, point.state.patches.edge_scale)
    np.testing.assert_allclose(lengths, 2 * np.pi / 40, rtol=1e-14)
    there = balance(system, point.state.patches.moved(waves * lengths * [1, 0]), 0.0, start, 1e-3)
    numbers = EventNumbers(start, 0.0, there.state.load, there.potential)
    limit = limit_points.LimitPoint("fold", there, numbers, numbers.apart(numbers, 0.0), np.ones((2, 1)), 1.0)
    ends = branch_ends.BranchEnds(system, Increments(0.1, 1e-3))
    monkeypatch.setattr(branch_ends, "locate_limit_point", lambda *_: limit)
    monkeypatch.setattr(branch_ends.BranchEnds, "_is_behind", lambda *_: False)
    monkeypatch.setattr(branch_ends.BranchEnds, "_accounts_for", lambda *_: True)
    monkeypatch.setattr(branch_ends, "interpenetration", lambda *_: GapMinima(*[np.empty(0)] * 3))
    assert (ends.limit_point(point, 0.1, False) is None) == refused


def test_another_branch_has_its_curvature_however_close_to_where_it_begins():
    """The control changes as the length squared, also where a step along the mode alone is short enough to pass.

    Its curvature falls by 2.0e-5 from one to the other; rounding, as 1/length, moves the shorter by up to 6e-6.
    """
    system, start = equal_crests(2), -0.05
    found = locate_limit_point(system, symmetric_state(system, 2, start), start, Search(-0.05, TOLERANCES))
    soft = Soft(system, found.balance, found.exact.value, found.balance.scale)
    mode = found.modes[:, 0] / soft.scale
    way = mode / soft.size(mode), 0.0
    short, long = (
        continued(system, soft, length, way, 1e-10, least=1).value - found.exact.value for length in (1.6e-3, 6.4e-3)
    )
    assert long / short == pytest.approx(16, rel=6e-5)  # measured 1.9e-5 to 2.6e-5 on six kernels


def test_newton_for_a_fold_that_ends_where_a_symmetry_breaks_has_found_no_fold(monkeypatch):
    """Crests far apart: the two modes are neutral together but for a little, and either may attract Newton."""
    system, start = equal_crests(2), -0.05
    here = symmetric_state(system, 2, start)
    broken = locate_limit_point(system, here, start, Search(-0.05, TOLERANCES))
    assert broken.kind == "broken_symmetry"

    def ends_there(system, soft, begin, search, breaking):
        return None if breaking else replace(broken, kind="fold")

    monkeypatch.setattr(limit_points, "_neutral", ends_there)
    monkeypatch.setattr(limit_points, "_near", lambda system, soft, expected, reach, tolerance: soft)
    assert locate_limit_point(system, here, start, Search(-0.05, TOLERANCES)) is None


def test_a_fold_of_almost_equal_crests_lies_before_the_symmetric_one():
    """By the power 2/3 of the difference, as an imperfect pitchfork has it."""
    values = []
    for delta in (0.0, 1e-6, 1e-5):
        system = equal_crests(2, delta)
        here = symmetric_state(system, 2, -0.05)
        found = locate_limit_point(system, here, -0.05, Search(-0.05, TOLERANCES, thorough=True))
        values.append(found.exact.value)
        assert found.kind == ("fold" if delta else "broken_symmetry")
    apart = np.array(values[1:]) - values[0]
    assert np.all(apart > 0)
    assert apart[1] / apart[0] == pytest.approx(10 ** (2 / 3), rel=0.2)  # measured 0.09


def test_the_way_from_a_fold_leads_down():
    system, exact = wave(DisplacementControl()), lowest("penetration")
    here = resting(system, [2 * np.pi], 0.8, 0.7 * exact)
    fold = locate_limit_point(system, here, 0.7 * exact, Search(0.3 * exact, TOLERANCES))
    way = departure(system, fold, *BETWEEN_AND_AT_TARGETS)
    assert way.leads_on and not way.fine
    assert np.all(way.outward < 0)  # it pulls off


def test_the_way_from_a_small_snap_is_as_short_as_the_snap():
    """One edge hops over a ripple: the force leads on up to 0.008 edge scales, by 2.4e-4 of w at most."""
    ripple = Profile.from_harmonics(2 * np.pi, [1, 20], [AMPLITUDE, 0.018], [0.0, 1.0])
    law, start, beyond = UniformLaw(np.pi * (ALPHA * AMPLITUDE) ** 2 / 2), 0.86, 0.02
    system = System(Elastic(ripple), law, DisplacementControl())
    here = resting(system, [2 * np.pi], 1.5, start)
    fold = locate_limit_point(system, here, start, Search(beyond, TOLERANCES))
    way = departure(system, fold, *BETWEEN_AND_AT_TARGETS)
    assert way.leads_on and way.fine
    assert np.max(np.abs(way.outward) / fold.balance.state.patches.edge_scale) <= 0.008  # measured 0.0044
    jump = Jumps(system, Increments(0.1, 1e-3), complete_contact(ripple, law)).from_limit(fold, beyond)
    assert [event.kind for event in jump[1].events] == ["bifurcation"]
    assert 0 < jump[1].events[0].energy_released <= 1e-4 * law.work


@pytest.mark.parametrize("part", [1e-2, 1e-3])
@pytest.mark.parametrize(
    ("control", "quantity", "other"),
    [(DisplacementControl(), "penetration", "load"), (LoadControl(), "load", "penetration")],
    ids=["Delta", "load"],
)
def test_an_end_that_is_not_located_knows_its_errors(control, quantity, other, part):
    """Numbers of a branch change as the root of the distance to its fold; measured 0.56 to 0.85 of the estimates."""
    system, exact = wave(control), lowest(quantity)
    psi = np.linspace(0.01, 0.8, 200_001)
    psi = psi[np.argmin(johnson(quantity, psi))]
    start, end = exact * (1 - part), exact * (1 + part / 2)
    here = resting(system, [2 * np.pi], 2.04 * psi, start)
    complete = complete_contact(system.elastic.profile, system.law)
    jumps = Jumps(system, Increments(0.1, 1e-3), complete)
    behind = jumps.unlocated(Equilibrium(start, here, tangent(control, here)), end, None, abs(end - start))
    assert [event.kind for event in behind.events] == ["pull_off"]
    at, error = behind.events[0].at, behind.events[0].error
    assert abs(at.value - exact) <= error.value
    assert 0.3 <= abs(getattr(at, other) - johnson(other, psi)) / getattr(error, other) <= 1


def test_errors_are_those_of_more_modes():
    system, value = wave(DisplacementControl()), johnson("penetration", 1.525)
    here = resting(system, [2 * np.pi], 3.05, value)
    soft = Soft(system, here, value, here.scale)
    fine, other = (refined(system, soft, np.zeros(2), value, 1e-6, more).state for more in (False, True))
    jumped = at_rest(system, here, value, (1e-6, 1e-6))[0].state
    least = resolve(system.elastic, here.state.patches, 1e-8).modes
    for more in (other.resolution, jumped.resolution):
        assert np.all(more.modes >= np.maximum(fine.resolution.modes + 3, least))
        assert np.all(more.nodes >= 1.3 * fine.resolution.nodes)


def test_a_coarse_equilibrium_is_improved_with_its_error():
    system = wave(DisplacementControl())
    here = resting(system, [2 * np.pi], 1.0, 0.5)
    better, exact, error = at_rest(system, here, 0.5, (1e-5, 1e-8))
    finest = at_rest(system, here, 0.5, (1e-8, 1e-12))[1]
    assert better.residual <= 1e-7
    assert abs(exact.potential - finest.potential) <= 3 * error.potential + 1e-13
    assert abs(exact.load - finest.load) <= 3 * error.load + 1e-12


def test_a_jump_goes_on_from_where_only_coarse_evaluations_find_it_at_rest():
    """Next to the unstable state of one wave, on the side of the stable one at the same penetration."""
    system, psi = wave(DisplacementControl()), np.linspace(0.01, 0.8, 200_001)
    turn = psi[np.argmin(johnson("penetration", psi))]
    narrow = 0.7 * turn
    value = johnson("penetration", narrow)
    wide = psi[(psi > turn)][np.argmin(np.abs(johnson("penetration", psi[psi > turn]) - value))]
    half_width = np.array([2 * narrow * 1.01])
    here = balance(system, Patches(-half_width, half_width), value, value, 1e-3)
    assert at_rest(system, here, value, (1e-5, 1e-8)) is None
    jumps = Jumps(system, Increments(0.1, 1e-3), complete_contact(system.elastic.profile, system.law))
    above = EventNumbers(value, value, johnson("load", narrow), here.potential + 1.0)
    known = EventNumbers(0.0, 0.0, 0.0, 0.0)
    behind = jumps.behind(above, known, Relaxed("converged", value, here, ()), (("coalescence", 0.0),))
    assert [event.kind for event in behind.events] == ["coalescence"]
    assert behind.state.patches.half_width[0] == pytest.approx(2 * wide, rel=2e-5)  # the grid of psi
    assert behind.balance.factor is not None


def test_an_equilibrium_that_needs_no_steps_has_an_error_from_another_resolution():
    system = wave(DisplacementControl())
    found = correct(system, resting(system, [0.0], 0.6, 0.5).state.patches, 0.5, 0.5, Accuracy(1e-8, 1e-9))
    better, _, error = at_rest(system, found.balance, 0.5, (1e-8, 1e-8))
    assert np.any(better.state.resolution.nodes != found.balance.state.resolution.nodes)
    assert 0 < error.load <= 4e-12  # measured 1.2e-12
