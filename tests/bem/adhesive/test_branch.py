"""A branch near one of its points: what is about to jump, and what a short step changes."""

from dataclasses import replace

import numpy as np
import pytest

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.branch import after_step, outward_motion, unstable_patches
from bem.adhesive.equilibrium import System, balance
from bem.elastic.collocation import Elastic
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl, LoadControl

SYSTEM = System(Elastic(Profile.from_harmonics(2 * np.pi, [1, 2], [0.2, 1.0])), UniformLaw(0.1), DisplacementControl())
WIDE = Patches(np.array([0.0, 3.0]), np.array([1.0, 4.5]))
WIDE_AND_TINY = Patches(np.array([0.0, 3.0]), np.array([1.0, 3.001]))


def with_stiffness(share):
    """Two patches whose edges resist a motion by their edge scale with this share of the work of adhesion on it."""
    here = balance(SYSTEM, WIDE_AND_TINY, 0.5, 0.5, 1e-8)
    stiffness = np.asarray(share) * here.work / here.state.patches.edge_scale
    jacobian = np.diag(2 * (stiffness + here.work_gradient) / here.state.stress_intensity)
    return replace(here, jacobian=jacobian, load_gradient=np.zeros(4))


@pytest.mark.parametrize("soft", [0, 1], ids=["wide", "tiny"])
def test_the_patch_about_to_jump_is_found_whatever_its_size(soft):
    share = np.ones(4)
    share[soft] = 0.1
    np.testing.assert_array_equal(unstable_patches(with_stiffness(share)), [soft])


@pytest.mark.parametrize("shift", [0.0, 2 * np.pi, -0.5])
def test_motions_are_the_same_across_the_end_of_the_period(shift):
    outward = np.array([0.1, -0.05, 0.02, 0.03])
    moved = WIDE_AND_TINY.moved(outward)
    start = Patches(WIDE_AND_TINY.left + shift - shift % (2 * np.pi), WIDE_AND_TINY.right + shift - shift % (2 * np.pi))
    np.testing.assert_allclose(outward_motion(start, moved), outward, atol=1e-14)


@pytest.mark.parametrize(
    "control", [DisplacementControl(), DisplacementControl(0.7), LoadControl()], ids=["Delta", "spring", "load"]
)
def test_numbers_after_a_step_are_of_second_order(control):
    """What is left falls eightfold with half the step, of penetration and load fourfold."""
    system = replace(SYSTEM, control=control)
    here = balance(system, WIDE, 0.5, 0.5, 1e-12)
    direction, change = np.array([0.3, -0.2, 0.25, 0.1]), 0.4
    left = []
    for part in (2e-2, 1e-2):
        there = balance(system, WIDE.moved(part * direction), 0.5, 0.5 + part * change, 1e-12)
        found = after_step(system, here, 0.5, part * direction, part * change)
        left.append([there.state.load - found.load, there.potential - found.potential])
        assert found.value == 0.5 + part * change
    ratios = np.abs(np.divide(*left))
    assert ratios[0] > 3 or abs(left[1][0]) < 1e-12
    assert ratios[1] > 6
