"""Crests that touch ahead of moving edges: where they are found, and where not."""

import numpy as np
import pytest

from bem.adhesion import UniformLaw
from bem.collocation import Elastic
from bem.control import PenetrationControl
from bem.equilibrium import System, balance
from bem.gap import gap_field
from bem.patches import TWO_PI, Patches
from bem.profile import Profile
from bem.touching import REACH, CrestsAhead

TWO_CRESTS = Profile.from_harmonics(TWO_PI, [1, 2], [0.2, 1.0])  # at 0 the higher, at pi the lower one
SYSTEM = System(Elastic(TWO_CRESTS), UniformLaw(0.1), PenetrationControl())
DEEP, SHALLOW = 1.0, 0.3  # penetrations at which the lower crest is in contact with one patch, and is not


def around(center, left, right):
    return Patches(np.array([center - left]), np.array([center + right]))


def looked_at(before, after, penetration=DEEP, occupied=None):
    state = balance(SYSTEM, after, penetration, penetration, 1e-10)
    return CrestsAhead(SYSTEM, 1e-10, occupied)(before, state)


@pytest.mark.parametrize(
    "center", [0.0, np.pi / 2 + 1.4, -1e-3], ids=["in the period", "crest at its end", "just left"]
)
@pytest.mark.parametrize("side", ["left", "right"])
def test_crest_that_touches_ahead_of_an_edge_is_found(center, side):
    """The profile is shifted with the patch: the same crest, on whatever turn of the circle."""
    shifted = Profile.from_harmonics(TWO_PI, [1, 2], [0.2, 1.0], [-center, -2 * center])
    system = System(Elastic(shifted), UniformLaw(0.1), PenetrationControl())
    before, after = (
        around(center, 0.9, 0.9),
        around(center, 1.0 - 0.1 * (side == "right"), 1.0 - 0.1 * (side == "left")),
    )
    state = balance(system, after, DEEP, DEEP, 1e-10)
    found = CrestsAhead(system, 1e-10)(before, state)
    assert found.gap.tolist() == [0]
    assert found.position[0] == pytest.approx(center + np.pi, abs=1e-9)
    assert found.depth[0] == gap_field(system.elastic, state.state)(found.position, found.gap)[0] < -0.1


def test_crest_ahead_of_both_edges_is_found_once():
    assert looked_at(around(0, 0.9, 0.9), around(0, 1.0, 1.0)).position.size == 1


@pytest.mark.parametrize(
    ("before", "after", "penetration"),
    [
        (around(0, 1.0, 1.0), around(0, 1.0, 1.0), DEEP),
        (around(0, 1.1, 1.1), around(0, 1.0, 1.0), DEEP),
        (around(0, 0.9, 0.9), around(0, 1.0, 1.0), SHALLOW),
        (around(0, 0.1, 0.1), around(0, 0.2, 0.2), DEEP),
    ],
    ids=["at rest", "inward", "does not touch", "edges interpenetrate"],
)
def test_nothing_is_found(before, after, penetration):
    assert looked_at(before, after, penetration) is None


def test_edges_at_the_penetration_of_the_tests_are_as_they_say():
    def edges(half_width):
        return balance(SYSTEM, around(0, half_width, half_width), DEEP, DEEP, 1e-10).state.stress_intensity

    assert np.all(edges(1.0) > 0)
    assert np.all(edges(0.2) < 0)


@pytest.mark.parametrize(("center", "found"), [(np.pi, False), (np.pi - TWO_PI, False), (2.0, True)])
def test_no_crest_touches_within_other_patches(center, found):
    other = around(center, 0.2, 0.2)
    assert (looked_at(around(0, 0.9, 0.9), around(0, 1.0, 1.0), occupied=other) is not None) == found


def test_only_crests_within_reach_are_looked_at():
    """Equal crests all round, a patch over some of them: as many are found as lie within reach of its right edge."""
    wavelength = TWO_PI / 64
    profile = Profile.from_harmonics(TWO_PI, [64], [1.0])
    system = System(Elastic(profile), UniformLaw(1e-3), PenetrationControl())
    before, after = around(0, 5.5 * wavelength, 5.4 * wavelength), around(0, 5.5 * wavelength, 5.5 * wavelength)
    found = CrestsAhead(system, 1e-10)(before, balance(system, after, 1.5, 1.5, 1e-10))
    np.testing.assert_allclose(found.position, wavelength * (5 + np.arange(1, REACH + 1)), atol=1e-9)
