"""Events do not depend on the increment: equal crests that pull off one by one, and rough profiles."""

from functools import cache

import numpy as np
import pytest
from scene_tables import rough, tables, waves

from bem.scene.scene import parse_scene
from bem.solver import solve

AMPLITUDE, PERIOD, MODULUS = 1e-4, 0.01, 4e6 / 3
LARGEST = 0.05


def crests(order, alpha, delta, control, targets, layer=None, increment=LARGEST):
    """Equal crests but for a wave of order 1; alpha is Johnson's of one of them."""
    full = np.pi * MODULUS * AMPLITUDE * order / PERIOD
    equal, unequal = waves([order], [AMPLITUDE]), waves([1, order], [delta * AMPLITUDE, AMPLITUDE], [0.3, 0.0])
    profile, nu = unequal if delta else equal, 0.5 if layer is None else 0.45
    work = (alpha * full) ** 2 * PERIOD / order / (2 * MODULUS)
    return tables(profile, control, targets, work, thickness=layer, nu=nu, accuracy={"max_increment": increment})


def outcome(data):
    """Kinds of all events, their numbers by rows, and the contact fractions of the targets."""
    result = solve(parse_scene(data))
    assert result.status in ("converged", "unreachable")
    assert all(state.certificate.ok for state in result.states if state.status != "unreachable")
    kinds = [event.kind for event in result.events]
    numbers = [(event.penetration, event.mean_pressure, event.energy_released or 0.0) for event in result.events]
    return kinds, np.array(numbers), [state.contact_fraction for state in result.targets]


def assert_same(one, other, places=1e-9, energies=1e-7, fractions=1e-10):
    """Penetrations over the amplitude, pressures and energies over the largest, contact fractions."""
    assert one[0] == other[0]
    assert one[2] == pytest.approx(other[2], abs=fractions)
    difference, size = np.abs(one[1] - other[1]).max(axis=0), np.abs(other[1]).max(axis=0)
    assert difference[0] <= places * AMPLITUDE
    assert difference[1] <= energies * size[1]
    assert difference[2] <= energies * size[2]


def also(rows):
    """Parameters of a test that repeats with them, when slow ones run, what it says of others always."""
    return [pytest.param(*row, marks=pytest.mark.slow) for row in rows]


UNLOADED = {0.01: 0.012, 0.02: 0.021, 0.05: 0.053, 0.1: 0.113, 0.3: 0.389}  # of the amplitude, where some still hold

PATTERNS = [
    (2, 0.05, 1e-3, "separation", None),
    (4, 0.01, 1e-8, "separation", None),
    (3, 0.05, 1e-5, "separation", 2e-3),
    (3, 0.02, 1e-5, "total_displacement", 3e-3),
]
MORE_PATTERNS = [
    (12, 0.05, 0.0, "separation", None),
    (7, 0.05, 0.0, "total_displacement", 1e-3),
    (2, 0.3, 1e-12, "separation", None),
    (3, 0.1, 0.0, "separation", None),
    (7, 0.02, 0.0, "separation", None),
    (2, 0.02, 0.0, "separation", None),
    (3, 0.01, 1e-5, "separation", None),
    (4, 0.02, 0.0, "separation", None),
    (4, 0.05, 1e-12, "separation", None),
    (7, 0.1, 1e-3, "separation", None),
    (12, 0.02, 1e-3, "separation", 1e-3),
    (2, 0.02, 0.0, "separation", 1e-3),
    (7, 0.3, 0.0, "separation", 5e-3),
    (7, 0.3, 1e-8, "separation", None),
    (12, 0.1, 1e-8, "separation", None),
]


def pattern(order, alpha, delta, control, layer, increment):
    back = UNLOADED[alpha] * AMPLITUDE
    targets = [0.3 * AMPLITUDE, AMPLITUDE + back, AMPLITUDE + 1.5 * back]
    if control == "total_displacement":
        targets = [0.5 * AMPLITUDE, -back, -3 * back]
    return crests(order, alpha, delta, control, targets, layer, increment)


@cache
def of_pattern(finer, *chosen):
    return outcome(pattern(*chosen, LARGEST / finer))


@pytest.mark.parametrize(("order", "alpha", "delta", "control", "layer"), [*PATTERNS, *also(MORE_PATTERNS)])
def test_equal_crests_pull_off_one_by_one_at_any_increment(order, alpha, delta, control, layer):
    coarse, fine = (of_pattern(n, order, alpha, delta, control, layer) for n in (1, 3))
    assert "detachment" in coarse[0]
    assert_same(coarse, fine)


@pytest.mark.slow
@pytest.mark.parametrize("order", [2, 4, 7])
def test_equal_crests_pull_off_one_by_one_at_a_tenth_of_the_increment(order):
    coarse, fine = (of_pattern(n, order, 0.02, 0.0, "separation", None) for n in (1, 10))
    assert_same(coarse, fine)


@pytest.mark.parametrize(("order", "alpha", "delta"), [(2, 0.02, 0.0), (4, 0.3, 1e-3), (7, 0.05, 0.0)])
def test_equal_crests_pull_off_under_load_at_any_increment(order, alpha, delta):
    full = np.pi * MODULUS * AMPLITUDE * order / PERIOD
    targets = [0.1 * full, -0.5 * alpha * full, -2 * alpha * full]
    coarse, fine = (
        outcome(crests(order, alpha, delta, "mean_pressure", targets, increment=n * LARGEST)) for n in (4, 1)
    )
    assert coarse[0][-1] == "pull_off"
    assert_same(coarse, fine, fractions=3e-10)  # measured 1e-10


def opened(order, alpha, targets, increment):
    data = crests(order, alpha, 0.0, "separation", targets, increment=increment)
    data["loading"]["initial"] = "complete_contact"
    return outcome(data)


@pytest.mark.parametrize("order", [4, *also([(9,)])])
def test_equal_gaps_open_one_by_one_at_any_increment(order):
    """Edges of narrow gaps hardly move on the way to where the symmetry breaks: its eigenvalue says how near it is."""
    coarse, fine = (opened(order, 0.3, [0.0, 1.5 * AMPLITUDE], increment) for increment in (LARGEST, LARGEST / 3))
    assert coarse[0] == fine[0]
    assert coarse[0][:2] == ["opening", "bifurcation"]
    # measured 4e-10 of the amplitude; 7e-9 where short steps of the edges were enough
    assert np.abs(coarse[1] - fine[1])[:, 0].max() <= 1e-9 * AMPLITUDE


@pytest.mark.parametrize("order", [3, *also([(5,)])])
def test_a_target_just_before_a_symmetry_breaks_is_met_before_it_does(order):
    """Newton at the accuracy of targets finds the state next to neutral there, where coarse states have none."""
    last = 0.8 * AMPLITUDE
    kinds, numbers, _ = opened(order, 0.08, [last], LARGEST)
    breaks = AMPLITUDE - numbers[kinds.index("bifurcation"), 0]
    for before in (1e-5, 1e-7):  # at 1e-9 it is the state behind the jump at some increments
        coarse, fine = (opened(order, 0.08, [breaks * (1 - before), last], LARGEST / n) for n in (1, 4))
        assert coarse[0] == fine[0] == kinds
        assert coarse[2] == pytest.approx(fine[2], abs=3e-12)  # measured 9.2e-13
        for _, found, _ in (coarse, fine):
            assert np.abs(found - numbers)[1:, 0].max() <= 6e-13 * AMPLITUDE  # measured 2e-13
            assert np.abs(found - numbers)[:, 2].max() <= 2e-12 * numbers[:, 2].max()  # measured 7.5e-13


def test_the_error_of_a_broken_symmetry_is_that_along_its_branch():
    """On a layer its eigenvalue hardly changes at fixed edges: errors were 590 and 850 times as large.

    Where two gaps are left, rounding decides how the end is found, and so whether it is called by its bifurcation or by
    the contact it ends in: its place, its energy and what they are in error by are the same.
    """
    data = crests(5, 0.12, 0.0, "separation", [0.2 * AMPLITUDE, 0.8 * AMPLITUDE], layer=1e-3, increment=0.04)
    data["loading"]["initial"] = "complete_contact"
    released = [event for event in solve(parse_scene(data)).events if event.energy_released]
    assert len(released) == 3
    for event, energy in zip(released[1:], (3.12163064992, 3.29478221747), strict=True):  # at all increments and phases
        error = event.error_estimate.energy_released
        assert abs(event.energy_released - energy) <= error
        assert error <= 1.6e-9 * energy  # measured 5.5e-10


WAYS = {"separation": [40e-6, 250e-6], "mean_pressure": [5e3, -20.0], "total_displacement": [40e-6, -60e-6]}


def rough_faces(seed, work, control="separation", layer=None, increment=LARGEST):
    more = {"slope_term": True, "thickness": layer, "nu": 0.49, "accuracy": {"max_increment": increment}}
    return tables(rough(20, seed), control, WAYS[control], work, **more)


ROUGH = [
    (1, 0.003, "separation", None),
    (2, 0.03, "separation", 1e-3),
    (3, 0.0005, "separation", None),
    (4, 0.01, "mean_pressure", None),
    (5, 0.01, "mean_pressure", 2e-3),
    (6, 0.01, "total_displacement", 1e-3),
]


@pytest.mark.parametrize(("seed", "work", "control", "layer"), [*ROUGH[1:4:2], *also([*ROUGH[:5:2], ROUGH[5]])])
def test_events_of_rough_profiles_do_not_depend_on_the_increment(seed, work, control, layer):
    coarse, fine = (outcome(rough_faces(seed, work, control, layer, LARGEST / n)) for n in (1, 3))
    assert_same(coarse, fine, energies=1e-6)


@pytest.mark.parametrize(("seed", "work", "control", "layer"), [ROUGH[1], *also([ROUGH[0], ROUGH[2]])])
def test_events_do_not_depend_on_where_increments_end_at_targets(seed, work, control, layer):
    """Seventy targets on the way cut increments short, on the way to a foretold fold and from it too."""
    direct, data = (rough_faces(seed, work, control, layer) for _ in range(2))
    deepest, last = data["loading"]["targets"]
    data["loading"]["targets"] = [*np.linspace(170e-6, deepest, 40), *np.linspace(deepest, 120e-6, 30)[1:], last]
    (kinds, numbers, _), (others, known, _) = outcome(data), outcome(direct)
    # measured 2.3e-13 of the amplitude, and 7.8e-11 of the largest pressure on five kinds of kernels
    assert_same((kinds, numbers, []), (others, known, []), places=6e-13, energies=2e-10)
