"""Descents take the same steps by the kernel in C as by the functions in NumPy."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from rough_surfaces import banded_scene, rough_scene

from bem.adhesive import descent
from bem.adhesive.adhesion import SlopeLaw, UniformLaw
from bem.adhesive.equilibrium import System
from bem.adhesive.strides import Steps, Strides, Walk
from bem.compiled import kernels
from bem.elastic.collocation import Elastic, Resolution
from bem.geometry.patches import TWO_PI, Patches, ordered
from bem.geometry.profile import Profile
from bem.loading.control import DisplacementControl
from bem.loading.increments import Accuracy
from bem.solver import solve

CORE = kernels.compiled("")
pytestmark = pytest.mark.skipif(CORE is None, reason="the kernels in C are not built")
NUMBERS = 2e-8  # of the largest of an array; measured up to 8e-9, median 7e-17: steps add up what roundings differ by
REFERENCE = kernels.REFERENCES["strides"]


@pytest.fixture(scope="module")
def walks():
    """Those of two rough contacts: 7 to 90 patches, together, in windows, and in the frozen field of others."""
    found: list[Walk] = []

    def recorded(walk):
        found.append(walk)
        return REFERENCE(walk)

    recorded.__name__ = "strides"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(descent, "strides", recorded)
        solve(rough_scene([60e-6, 25e-6, 70e-6], 150, adhesion=0.003, accuracy={"tolerance": 1e-2}))
        solve(banded_scene([4e-6, 3e-6, 6e-6]))
    return found


def same(one, other):
    """Whether arrays agree; of other ones than numbers, exactly."""
    if one is None or other is None:
        return one is other
    one, other = np.asarray(one), np.asarray(other)
    if one.dtype.kind == "i":
        return np.array_equal(one, other)
    return one.shape == other.shape and np.abs(one - other).max() <= NUMBERS * np.abs(other).max()


def check(walk):
    """That kernel and reference end in the same way; the verdict."""
    found, expected = Strides(*CORE.strides(walk)), Strides(*REFERENCE(walk))
    assert found.verdict == expected.verdict
    assert found.rounds == expected.rounds
    for name in ("left", "right", "seen_left", "seen_right", "radius"):
        assert same(getattr(found, name), getattr(expected, name)), name
    if found.verdict in ("closing", "vanishing"):
        assert same(found.gone, expected.gone)
    for name in ("crests", "depth", "gap"):
        assert same(getattr(found, name), getattr(expected, name)), name
    assert (found.numbers is None) == (expected.numbers is None)
    for one, other in zip(found.numbers or (), expected.numbers or (), strict=True):
        assert same(one, other)
    return found.verdict


def test_descents_of_rough_contacts_are_the_same(walks):
    elastic = [walk.system.elastic for walk in walks]
    kinds = Counter((one.far is not None, len(one.backgrounds)) for one in elastic)
    assert min(kinds[far, backgrounds] for far in (False, True) for backgrounds in (0, 1)) > 10
    assert {type(walk.system.law) for walk in walks} == {UniformLaw, SlopeLaw}
    verdicts = Counter(check(walk) for walk in walks)
    assert min(verdicts[name] for name in ("converged", "touched", "closing", "vanishing")) > 3


def whole_walk(walks):
    """One of patches that are not in a window, but look ahead."""
    return next(
        walk for walk in walks if walk.system.elastic.far is None and walk.patches.count > 5 and walk.steps.ahead
    )


def narrower(patches):
    """Edges drawn in so far that K is negative at some."""
    return patches.moved(-0.3 * patches.edge_scale)


@pytest.mark.parametrize(
    ("changed", "verdict"),
    [
        pytest.param(lambda walk: replace(walk, rounds=2), "not_converged", id="few rounds"),
        pytest.param(lambda walk: replace(walk, radius=1e-13), "not_converged", id="no radius"),
        pytest.param(lambda walk: replace(walk, patches=narrower(walk.patches), rounds=2), "not_converged", id="K < 0"),
        pytest.param(lambda walk: replace(walk, patches=narrower(walk.patches)), None, id="K < 0, to the end"),
        pytest.param(lambda walk: beside(walk, walk.patches.right + 1e-9), "not_converged", id="no space"),
        pytest.param(lambda walk: beside(walk, walk.patches.center), "not_converged", id="taken"),
        pytest.param(lambda walk: replace(walk, steps=replace(walk.steps, ahead=None)), None, id="not looked ahead"),
        pytest.param(lambda walk: finer(walk), None, id="finer"),
    ],
)  # fmt: skip
def test_other_descents_are_the_same(walks, changed, verdict):
    found = check(changed(whole_walk(walks)))
    assert verdict in (None, found)


def beside(walk, places):
    """Narrow patches of others at places."""
    occupied = ordered(places, places + 1e-10)
    return replace(walk, steps=replace(walk.steps, ahead=replace(walk.steps.ahead, occupied=occupied)))


def finer(walk):
    """With more nodes and modes."""
    count = walk.patches.count
    least = Resolution(np.full(count, 91), np.full(count, 30))
    return replace(walk, least=least)


def test_edges_that_leave_their_window_are_refused(walks):
    walk = next(walk for walk in walks if walk.system.elastic.far is not None)
    arc = walk.system.elastic.far.arc
    edge = np.array([arc.delta - 0.01 * arc.margins[1]])
    left, right = walk.patches.left, walk.patches.right
    last = arc.outer_gap(walk.patches)
    right = np.where(np.arange(right.size) == last, right + (edge - right) % TWO_PI, right)
    assert check(replace(walk, patches=Patches(left, right), seen=walk.patches)) == "ill_conditioned"


def test_narrow_gaps_close_in_the_same_few_steps():
    system = System(
        Elastic(Profile.from_harmonics(TWO_PI, [1, 2], [1.0, 0.01])), UniformLaw(0.3), DisplacementControl()
    )
    halves = Patches(np.array([-1.5, 0.1]), np.array([-0.1, 1.5]))
    assert check(Walk(system, 1.0, Accuracy(1e-8, 1e-8), Steps(0.1), halves, 1.0, halves, 0.05, 100)) == "closing"
