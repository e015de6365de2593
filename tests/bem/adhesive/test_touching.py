"""Crests that touch ahead of moving edges: where they are found, where not, and what a jump makes of them."""

import numpy as np
import pytest

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.descent import descend
from bem.adhesive.equilibrium import System, balance
from bem.adhesive.relaxation import Cause, fall
from bem.adhesive.strides import Steps
from bem.adhesive.touching import CrestsAhead
from bem.elastic.collocation import Elastic
from bem.elastic.gap import gap_field
from bem.geometry.patches import TWO_PI, Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl
from bem.loading.increments import Accuracy

TWO_CRESTS = Profile.from_harmonics(TWO_PI, [1, 2], [0.2, 1.0])  # at 0 the higher, at pi the lower one
SYSTEM = System(Elastic(TWO_CRESTS), UniformLaw(0.1), DisplacementControl())
DEEP, SHALLOW = 1.0, 0.3  # penetrations at which the lower crest is in contact with one patch, and is not


def around(center, left, right):
    return Patches(np.array([center - left]), np.array([center + right]))


def looked_at(seen, after, penetration=DEEP, occupied=None):
    state = balance(SYSTEM, after, penetration, penetration, 1e-10)
    return CrestsAhead(SYSTEM, 1e-10, occupied)(seen, state)


@pytest.mark.parametrize("closed", [False, True], ids=["tensile", "K < 0 at the far end"])
@pytest.mark.parametrize("moving", [0, 1, 2])
@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("turn", [-1, 0, 1])
@pytest.mark.parametrize("center", [0.0, 0.6, 2.0])
def test_the_crest_in_the_gap_ahead_is_found(center, turn, side, moving, closed):
    """Three higher crests in contact, three lower ones between them, anywhere on the circle and on any of its turns."""
    profile = Profile.from_harmonics(TWO_PI, [3, 6], [0.2 / 3, 1 / 3], [-3 * center, -6 * center])
    system = System(Elastic(profile), UniformLaw(0.1), DisplacementControl())
    places = center + np.arange(3) * TWO_PI / 3 + turn * TWO_PI
    half = np.full(3, 1 / 3)
    gap = moving if side == "right" else (moving - 1) % 3
    if closed:
        half[(gap + 1) % 3 if side == "right" else gap] = 0.05
    after = Patches(places - half, places + half)
    motion = np.zeros(6)
    motion[moving + 3 * (side == "right")] = 0.03
    state = balance(system, after, DEEP / 3, DEEP / 3, 1e-10)
    found, seen = CrestsAhead(system, 1e-10)(after.moved(-motion), state)
    if closed:
        assert found is None
        np.testing.assert_array_equal(seen.right, after.moved(-motion).right)
    else:
        assert found.gap.tolist() == [gap]
        assert found.position[0] == pytest.approx(after.right[gap] + after.gap_after[gap] / 2, abs=1e-9)
        assert found.depth[0] == gap_field(system.elastic, state.state)(found.position, found.gap)[0] < -0.03


def test_crest_ahead_of_both_edges_is_found_once():
    assert looked_at(around(0, 0.9, 0.9), around(0, 1.0, 1.0))[0].position.size == 1


@pytest.mark.parametrize(
    ("seen", "after", "penetration"),
    [
        (around(0, 1.0, 1.0), around(0, 1.0, 1.0), DEEP),
        (around(0, 1.1, 1.1), around(0, 1.0, 1.0), DEEP),
        (around(0, 0.9, 0.9), around(0, 1.0, 1.0), SHALLOW),
        (around(0, 0.1, 0.1), around(0, 0.2, 0.2), DEEP),
    ],
    ids=["at rest", "inward", "does not touch", "edges interpenetrate"],
)
def test_nothing_is_found(seen, after, penetration):
    assert looked_at(seen, after, penetration)[0] is None


@pytest.mark.parametrize(("center", "found"), [(np.pi, False), (np.pi - TWO_PI, False), (2.0, True)])
def test_no_crest_touches_within_other_patches(center, found):
    other = around(center, 0.2, 0.2)
    assert (looked_at(around(0, 0.9, 0.9), around(0, 1.0, 1.0), occupied=other)[0] is not None) == found


def test_small_steps_add_up_until_an_edge_has_moved():
    """Forty wavelengths round the circle: the right edge creeps, the left one walks."""
    profile = Profile.from_harmonics(TWO_PI, [40], [1.0])
    ahead = CrestsAhead(System(Elastic(profile), UniformLaw(1e-3), DisplacementControl()), 1e-10)
    creep = 0.008 * TWO_PI / 40
    start = 5.5 * TWO_PI / 40
    seen, found = around(0, start, start), []
    for k in range(1, 4):
        touching, seen = ahead(seen, balance(ahead.system, around(0, start, start + k * creep), 1.5, 1.5, 1e-10))
        found.append(touching is not None)
    assert found == [False, False, True]
    assert seen.right[0] == start + 3 * creep
    assert seen.left[0] == -start


def test_only_crests_within_four_wavelengths_are_looked_at():
    """Equal crests all round, a patch over some of them."""
    wavelength = TWO_PI / 64
    system = System(Elastic(Profile.from_harmonics(TWO_PI, [64], [1.0])), UniformLaw(1e-3), DisplacementControl())
    before, after = around(0, 5.5 * wavelength, 5.4 * wavelength), around(0, 5.5 * wavelength, 5.5 * wavelength)
    found, _ = CrestsAhead(system, 1e-10)(before, balance(system, after, 1.5, 1.5, 1e-10))
    np.testing.assert_allclose(found.position, wavelength * (5 + np.arange(1, 5)), atol=1e-9)


RIPPLED = System(Elastic(Profile.from_harmonics(TWO_PI, [1, 20], [1.0, 0.08])), UniformLaw(0.1), DisplacementControl())
NARROW, DEPTH = around(0, 0.2, 0.2), 0.4
TOUCHES = ["new_contact"] * 2 + ["coalescence"] * 2


def test_a_descent_stops_where_crests_touch():
    end = descend(RIPPLED, NARROW, DEPTH, DEPTH, Accuracy(1e-6, 1e-7), Steps(0.4, ahead=CrestsAhead(RIPPLED, 1e-10)))
    assert end.status == "touched"
    np.testing.assert_allclose(end.touching.position, -end.touching.position[::-1] + TWO_PI, atol=1e-9)
    assert end.patches is end.balance.state.patches


def test_a_descent_does_not_run_into_other_patches():
    other = around(0.7, 0.05, 0.05)
    end = descend(
        RIPPLED, NARROW, DEPTH, DEPTH, Accuracy(1e-6, 1e-7), Steps(0.4, ahead=CrestsAhead(RIPPLED, 1e3, other))
    )
    free = descend(RIPPLED, NARROW, DEPTH, DEPTH, Accuracy(1e-6, 1e-7), Steps(0.4))
    assert end.status == "not_converged"
    assert end.patches.joined(other) is not None
    assert free.patches.joined(other) is None


BUMPS = 20
MANY = System(
    Elastic(Profile.from_harmonics(TWO_PI, [BUMPS, 20 * BUMPS], [1 / BUMPS, 0.08 / BUMPS])),
    UniformLaw(0.1 / BUMPS),
    DisplacementControl(),
)


def test_in_the_field_of_others_the_same_crests_touch():
    """Twenty scaled copies of the rippled bump, all but one where they come to rest; that one jumps locally."""
    centers = TWO_PI / BUMPS * (0.5 + np.arange(BUMPS))
    moved = Profile.from_harmonics(
        TWO_PI, MANY.elastic.profile.orders, MANY.elastic.profile.amplitudes, -MANY.elastic.profile.orders * centers[0]
    )
    system = System(Elastic(moved), MANY.law, DisplacementControl())
    alone = fall(RIPPLED, NARROW, DEPTH, DEPTH, Accuracy(1e-6, 1e-7, 1e-10)).balance.state.patches.half_width[0] / BUMPS
    half = np.full(BUMPS, alone)
    half[10] = 0.2 / BUMPS
    start = Patches(centers - half, centers + half)
    state = balance(system, start, DEPTH / BUMPS, DEPTH / BUMPS, 1e-6).state
    end = fall(
        system,
        start,
        DEPTH / BUMPS,
        DEPTH / BUMPS,
        Accuracy(1e-6, 1e-7, 1e-10 / BUMPS),
        Cause(np.array([10]), state=state),
    )
    assert [kind for kind, _ in end.changes] == TOUCHES
    assert system.effort.local_evaluations > 2 * system.effort.evaluations
    np.testing.assert_allclose(end.balance.state.patches.half_width, alone, rtol=1e-6)
