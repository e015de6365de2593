"""The softest mode of some forces is the same whether or not a mode before it is known."""

from dataclasses import replace

import numpy as np
import pytest

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.equilibrium import System, balance
from bem.continuation.softness import Soft
from bem.elastic.collocation import Elastic
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl

SYSTEM = System(Elastic(Profile.from_harmonics(2 * np.pi, [1, 2], [0.2, 1.0])), UniformLaw(0.1), DisplacementControl())
PATCHES = Patches(np.array([0.0, 3.0]), np.array([1.0, 3.5]))
LAST = np.array([0.02, -1.0, 0.01, 0.03])


def soft_with(stiffness, **others):
    """Forces whose modes are the edges, of these stiffnesses."""
    here = balance(SYSTEM, PATCHES, 0.5, 0.5, 1e-8)
    return Soft(SYSTEM, replace(here, hessian=np.diag(stiffness / here.scale**2)), 0.5, here.scale, **others)


@pytest.mark.parametrize("others", [{}, {"last": LAST}, {"last": LAST, "every": True}], ids=["new", "last", "every"])
@pytest.mark.parametrize(
    ("stiffness", "alone"),
    [((1.0, 0.01, 3.0, 2.0), True), ((1.0, -0.01, 3.0, 2.0), True), ((1.0, -0.02, -0.01, 2.0), False)],
    ids=["stable", "unstable", "doubly unstable"],
)
def test_a_known_mode_changes_nothing(stiffness, alone, others):
    soft = soft_with(stiffness, **others)
    assert soft.eigenvalues[0] == pytest.approx(min(stiffness), rel=0, abs=1e-16)  # measured 0
    np.testing.assert_allclose(np.abs(soft.mode), np.abs(np.eye(4)[1]), rtol=0, atol=5e-15)  # measured 2.0e-15
    assert soft.is_alone == alone
    assert soft.mode[1] < 0 or not others


def test_every_mode_is_there_where_all_are_wanted():
    assert soft_with((1.0, 0.01, 3.0, 2.0), last=LAST, every=True).eigenvalues.size == 4
