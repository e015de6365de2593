"""Events: new contacts, coalescence and detachment relax into the next equilibrium and release energy."""

import numpy as np
import pytest
from rough_surfaces import rough_profile

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.equilibrium import System, balance
from bem.adhesive.relaxation import Cause, fall, first_contact, interpenetration
from bem.adhesive.vanishing import pull_off_half_width
from bem.elastic.collocation import Elastic
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.complete_contact import complete_contact
from bem.loading.control import DisplacementControl, LoadControl
from bem.loading.increments import Accuracy, Increments
from bem.path.jump import Jumps
from bem.path.locating import AtControl, Start, settle
from bem.path.rest import at_rest

ACCURACY = Accuracy(1e-8, 1e-9, 1e-10)
TWO_CRESTS = Profile.from_harmonics(2 * np.pi, [1, 2], [0.2, 1.0])
SYSTEM = System(Elastic(TWO_CRESTS), UniformLaw(0.1), DisplacementControl())


def jumps_of(system):
    complete = complete_contact(system.elastic.profile, system.law)
    return Jumps(system, Increments(0.05, 2e-3, 0.05, way=ACCURACY), complete)


def relaxed(system, patches, target, penetration=None):
    return at_rest(jumps_of(system), Start(patches, target if penetration is None else penetration, target))


def kinds(end):
    return [kind for kind, _ in end.changes]


def one_patch(half_width):
    return Patches(np.array([-half_width]), np.array([half_width]))


def test_nothing_happens_to_an_equilibrium():
    end = relaxed(SYSTEM, one_patch(0.5), 0.1)
    again = relaxed(SYSTEM, end.balance.state.patches, 0.1)
    assert (again.status, again.changes) == ("converged", ())
    np.testing.assert_allclose(again.balance.state.patches.right, end.balance.state.patches.right, atol=1e-9)


def test_second_crest_makes_contact_where_the_first_state_overlaps():
    # the crest at pi is 0.4 lower, and the surface is sucked down beside the first contact
    end = relaxed(SYSTEM, one_patch(0.5), 0.6)
    assert kinds(end) == ["new_contact"]
    assert end.changes[0][1] == pytest.approx(np.pi, abs=0.02)
    assert end.balance.state.patches.count == 2


def test_relaxed_state_is_a_stable_equilibrium_without_overlap():
    end = relaxed(SYSTEM, one_patch(0.5), 0.6)
    assert end.balance.is_equilibrium(ACCURACY.residual)
    assert end.balance.smallest_eigenvalue > 0
    assert interpenetration(SYSTEM, end.balance.state, 1e-10).position.size == 0


def resting(patches, value):
    """The equilibrium of these patches, whatever touches beside them."""
    here, _ = settle(SYSTEM, Start(patches, value, value), AtControl(value), Accuracy(1e-8, 1e-9))
    return here


def test_new_contact_releases_energy():
    # the lower crest is touched at a penetration of 0.33
    start = resting(one_patch(0.5), 0.335)
    assert interpenetration(SYSTEM, start.state, 1e-10).position.size == 1
    end = relaxed(SYSTEM, start.state.patches, 0.335)
    assert end.balance.state.patches.count == 2
    assert end.balance.potential < start.potential - 0.01


def test_overlap_allowed_is_no_new_contact():
    start = resting(one_patch(0.62), 0.6).state
    depth = -interpenetration(SYSTEM, start, 1e-10).depth[0]
    assert interpenetration(SYSTEM, start, 0.9 * depth).position.size == 1
    assert interpenetration(SYSTEM, start, 1.1 * depth).position.size == 0


@pytest.mark.parametrize("start", [0.1, 0.5], ids=["from narrow", "from wide"])
def test_settling_does_not_depend_on_where_it_starts(start):
    end = relaxed(SYSTEM, one_patch(start), 0.6)
    again = relaxed(SYSTEM, one_patch(0.3), 0.6)
    np.testing.assert_allclose(end.balance.state.patches.right, again.balance.state.patches.right, atol=1e-8)


def test_equal_crests_make_contact_at_the_same_instant():
    three = Profile.from_harmonics(2 * np.pi, [3], [1.0])
    system = System(Elastic(three), UniformLaw(0.1), DisplacementControl())
    crests = np.arange(3) * 2 * np.pi / 3
    end = relaxed(system, first_contact(system, crests), 0.5)
    assert end.balance.state.patches.count == 3
    np.testing.assert_allclose(np.ptp(end.balance.state.patches.width), 0.0, atol=1e-9)


def test_equal_crests_of_a_ripple_that_both_lie_deep_below_zero_make_contacts_apart():
    """An odd ripple splits the lower of two waves: its halves touch together, and deep ones were taken to be wide."""
    rippled = Profile.from_harmonics(2 * np.pi, [2, 41], [1.0, 0.02])
    system = System(Elastic(rippled), UniformLaw(0.1), DisplacementControl())
    end = relaxed(system, one_patch(0.5), 0.6)
    beside = [position for kind, position in end.changes if kind == "new_contact"][:2]
    assert sum(beside) == pytest.approx(2 * np.pi, abs=1e-6)
    assert np.diff(beside)[0] == pytest.approx(2 * np.pi / 41, rel=0.2)
    assert end.status == "converged"
    assert end.balance.state.patches.count == 2
    np.testing.assert_allclose(np.sin(end.balance.state.patches.center), 0.0, atol=1e-9)


def test_patches_detach_beyond_pull_off():
    loaded = relaxed(SYSTEM, one_patch(0.5), 0.6).balance.state.patches
    end = relaxed(SYSTEM, loaded, -0.05, 0.6)
    assert "detachment" in kinds(end)
    assert end.balance.state.patches.count == 1
    assert np.abs((end.balance.state.patches.center[0] + np.pi) % (2 * np.pi) - np.pi) < 1e-6  # the higher one stays


def test_last_patch_separates():
    end = relaxed(SYSTEM, one_patch(0.1), -3.0)
    assert end.status == "separated"
    assert end.balance is None
    assert kinds(end) == ["detachment"]


def test_load_that_no_branch_carries_ends_in_complete_contact():
    system = System(SYSTEM.elastic, SYSTEM.law, LoadControl())
    end = fall(system, one_patch(0.6), 1.0, 30.0, Accuracy(1e-4, 1e-5, 1e-7))
    assert end.status == "complete_contact"
    assert kinds(end)[-1] == "complete_contact"


def test_first_contact_is_tensile_at_its_edges():
    position = np.array([0.0])
    patches = first_contact(SYSTEM, position)
    assert patches.half_width[0] == pytest.approx(1.5 * pull_off_half_width(SYSTEM, position)[0])
    assert balance(SYSTEM, patches, 0.0, 0.0, 1e-8).all_tensile


def test_first_contacts_of_close_crests_stay_apart():
    strong = System(SYSTEM.elastic, UniformLaw(100.0), DisplacementControl())
    patches = first_contact(strong, np.array([0.0, 0.2, 3.0]))
    assert patches.is_ordered
    assert patches.count == 3


def test_local_settling_ends_in_the_same_state():
    """With many patches the unstable ones move first in the field of the others; the end must not know."""
    profile = rough_profile(harmonics=200, seed=3, hurst=0.4).scaled()
    system = System(Elastic(profile), UniformLaw(2e-4), DisplacementControl())
    x, h = profile.crests
    high = x[h > profile.max_height - 1.3]
    before = relaxed(system, first_contact(system, np.sort(high)), 1.3).balance.state
    start = before.patches
    assert start.count > 18
    counts = [system.effort.local_evaluations]
    plain = relaxed(system, start, 1.27, 1.3)
    counts.append(system.effort.local_evaluations)
    local = jumps_of(system).landed(start, 1.3, 1.27, Cause(np.array([1]), state=before))
    assert counts[0] == counts[1] < system.effort.local_evaluations
    np.testing.assert_allclose(local.minimum.patches.right, plain.balance.state.patches.right, atol=1e-7)
