"""A branch near one of its points: what is about to jump, and what says that Newton leapt to another branch."""

from dataclasses import replace

import numpy as np
import pytest

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.branch import Missing, missing_energy, passes_crest, strays, tangent, unstable_patches
from bem.adhesive.descent import Steps, descend
from bem.adhesive.equilibrium import System, balance
from bem.elastic.collocation import Elastic
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl
from bem.loading.increments import Accuracy

SYSTEM = System(Elastic(Profile.from_harmonics(2 * np.pi, [1, 2], [0.2, 1.0])), UniformLaw(0.1), DisplacementControl())
WIDE_AND_TINY = Patches(np.array([0.0, 3.0]), np.array([1.0, 3.001]))


def with_stiffness(share):
    """Two patches whose edges resist a motion by their edge scale with this share of the work of adhesion on it."""
    here = balance(SYSTEM, WIDE_AND_TINY, 0.5, 0.5, 1e-8)
    return replace(here, hessian=np.diag(np.asarray(share) * here.work / here.state.patches.edge_scale))


@pytest.mark.parametrize("soft", [0, 1], ids=["wide", "tiny"])
def test_the_patch_about_to_jump_is_found_whatever_its_size(soft):
    share = np.ones(4)
    share[soft] = 0.1
    np.testing.assert_array_equal(unstable_patches(with_stiffness(share)), [soft])


RIPPLED = System(
    Elastic(Profile.from_harmonics(2 * np.pi, [1, 40], [1.0, 0.02])), UniformLaw(0.03), DisplacementControl()
)
SMALLER, LARGER = 0.8, 0.9  # half widths from which the edges come to rest on one ripple or on the next


def at_rest(start, target):
    patches = Patches(np.array([-start]), np.array([start]))
    return descend(RIPPLED, patches, target, target, Accuracy(1e-8, 1e-9), Steps(0.1)).balance


@pytest.mark.parametrize(
    ("start", "end", "left"),
    [(SMALLER, SMALLER, False), (LARGER, LARGER, False), (SMALLER, LARGER, True), (LARGER, SMALLER, True)],
    ids=["along one branch", "along the other", "down to a lower branch", "up to a higher branch"],
)
def test_energy_tells_a_leap_to_another_branch(start, end, left):
    change = 1e-3
    ends = at_rest(start, 0.4), at_rest(end, 0.4 + change)
    rates = tangent(RIPPLED.control, ends[0]), tangent(RIPPLED.control, ends[1])
    assert missing_energy(RIPPLED, ends, rates, change, 1e-8).tells_of_a_leap == left


@pytest.mark.parametrize(
    ("start", "end", "left"),
    [(SMALLER, SMALLER, False), (LARGER, LARGER, False), (SMALLER, LARGER, True), (LARGER, SMALLER, True)],
    ids=["along one branch", "along the other", "to the next ripple", "back to it"],
)
def test_tangents_say_that_the_edges_left_their_branch(start, end, left):
    change = 1e-3
    ends = at_rest(start, 0.4), at_rest(end, 0.4 + change)
    rates = tangent(RIPPLED.control, ends[0]), tangent(RIPPLED.control, ends[1])
    assert strays(ends, rates, change, 1e-9) == left


WAVES = Profile.from_harmonics(2 * np.pi, [10], [1.0])  # crests at multiples of 0.628, valleys between them


@pytest.mark.parametrize("turns", [-1, 0, 1])
@pytest.mark.parametrize("mirrored", [False, True], ids=["right edge", "left edge"])
@pytest.mark.parametrize(
    ("near", "far", "passed"),
    [(0.2, 0.9, True), (0.2, 0.5, False), (0.4, 0.9, False), (0.4, 1.2, False), (0.2, 1.6, True), (5.9, 6.5, True)],
    ids=["a valley and a crest", "a valley", "a crest", "a crest and a valley", "several", "across the end"],
)
def test_an_edge_passes_a_crest_behind_a_valley(near, far, passed, mirrored, turns):
    def patch(reach):
        ends = np.array([-reach, 0.1 - 2 * np.pi] if mirrored else [-0.1, reach]) + 2 * np.pi * turns
        return Patches(ends[:1], ends[1:])

    assert passes_crest(WAVES, patch(near), patch(far)) == passed
    assert passes_crest(WAVES, patch(far), patch(near)) == passed


@pytest.mark.parametrize(
    ("energy", "curvature", "turned_over", "leap", "left_open"),
    [
        (1.05, 10.0, 1.0, False, False),
        (1.2, 10.0, 1.0, False, True),
        (10.05, 10.0, 1.0, False, True),
        (10.2, 10.0, 1.0, True, True),
        (0.105, 0.0, 1.0, True, False),
        (0.105, 0.0, 10.0, False, False),
        (1.2, 0.0, 10.0, True, True),
    ],
)
def test_energy_leaves_open_what_curvature_may_hide(energy, curvature, turned_over, leap, left_open):
    missing = Missing(energy, curvature, turned_over, noise=0.1)
    assert (missing.tells_of_a_leap, missing.leaves_open) == (leap, left_open)
