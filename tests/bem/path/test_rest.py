"""Edges that come to rest at a value of the control, and the state behind a jump, against Johnson's contact."""

import numpy as np
import pytest
from johnson_branch import johnson, resting, waves

from bem.geometry.patches import Patches
from bem.loading.complete_contact import complete_contact
from bem.loading.control import DisplacementControl
from bem.loading.increments import Accuracy, Increments
from bem.loading.path_events import EventNumbers
from bem.path.jump import Jumps
from bem.path.locating import Start
from bem.path.points_with_edges import Equilibrium
from bem.path.rest import at_rest
from bem.path.tension import behind_jump

FINE = Accuracy(1e-10, 1e-10)
TWO_CRESTS = waves(DisplacementControl(), orders=(2,), work=1.0)


def at(value, *centers, half_width=0.3):
    patches = Patches(np.array(centers) - half_width, np.array(centers) + half_width)
    profile = TWO_CRESTS.elastic.profile
    jumps = Jumps(TWO_CRESTS, Increments(0.05, 2e-3, 0.05, way=FINE), complete_contact(profile, TWO_CRESTS.law))
    return at_rest(jumps, Start(patches, value, value))


def test_a_crest_that_interpenetrates_is_a_new_contact():
    """Of two equal crests one is left out: the edges at the other come to rest, and the gap at this one is closed."""
    found, whole = at(1.0, 0.0), at(1.0, 0.0, np.pi)
    assert (found.status, whole.changes) == ("converged", ())
    assert [kind for kind, _ in found.changes] == ["new_contact"]
    assert found.changes[0][1] % (2 * np.pi) == pytest.approx(np.pi, abs=1e-6)
    np.testing.assert_allclose(found.balance.state.patches.width, whole.balance.state.patches.width, rtol=1e-9)


def test_the_load_behind_a_jump_is_as_uncertain_as_its_place():
    system, psi, off = waves(DisplacementControl()), 0.6, 1e-6
    value = float(johnson("penetration", psi))
    behind = Equilibrium.of(value, resting(system, [0.0], 2 * psi, value))
    sure, unsure = (behind_jump(system, behind, EventNumbers(e, e, e, e), 1e-10) for e in (0.0, off))
    load, stiffness = float(johnson("load", psi)), behind.balance.stiffness
    assert sure.numbers.load == unsure.numbers.load == pytest.approx(load, abs=1e-10)
    assert unsure.error.load - sure.error.load == pytest.approx(off * stiffness, rel=1e-3)
    assert unsure.error.value == off
