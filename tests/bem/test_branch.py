"""A branch near one of its points: which patches are about to jump, and which modes break a symmetry."""

from dataclasses import replace

import numpy as np
import pytest

from bem.adhesion import UniformLaw
from bem.branch import symmetry_breaking, unstable_patches
from bem.collocation import Elastic
from bem.control import PenetrationControl
from bem.equilibrium import System, balance
from bem.patches import Patches
from bem.profile import Profile

SYSTEM = System(Elastic(Profile.from_harmonics(2 * np.pi, [1, 2], [0.2, 1.0])), UniformLaw(0.1), PenetrationControl())
WIDE_AND_TINY = Patches(np.array([0.0, 3.0]), np.array([1.0, 3.001]))


def with_stiffness(share):
    """Two patches whose edges resist a motion by their room with this share of the work of adhesion on it."""
    here = balance(SYSTEM, WIDE_AND_TINY, 0.5, 0.5, 1e-8)
    return replace(here, hessian=np.diag(np.asarray(share) * here.work / here.state.patches.edge_room))


@pytest.mark.parametrize("soft", [0, 1], ids=["wide", "tiny"])
def test_the_patch_about_to_jump_is_found_whatever_its_size(soft):
    share = np.ones(4)
    share[soft] = 0.1
    np.testing.assert_array_equal(unstable_patches(with_stiffness(share)), [soft])


@pytest.mark.parametrize(("pull", "breaks"), [([0.0, 1.0, 0.0, 1.0], True), ([1.0, 1.0, 1.0, 1.0], False)])
def test_a_mode_on_which_the_load_does_no_work_breaks_a_symmetry(pull, breaks):
    here = replace(with_stiffness([0.1, 1.0, 1.0, 1.0]), load_gradient=np.array(pull))
    found = symmetry_breaking(here)
    assert found == ((("bifurcation", pytest.approx(0.5)),) if breaks else ())
