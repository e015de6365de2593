"""Folds foretold: the order of modes, and signs of a snap on the way (on a branch: test_limit_points.py)."""

from types import SimpleNamespace

import numpy as np
import pytest

from bem.continuation import foretold_folds
from bem.continuation.foretold_folds import Foretold, foretell_folds

DIRECTIONS = pytest.mark.parametrize("direction", [1.0, -1.0], ids=["loading", "unloading"])


def foretold_of(monkeypatch, direction, pull):
    """Of two modes with stiffnesses 1 and 4, which fall by 0.1 and 4 per unit of the control."""
    hessian, falling = np.diag([1.0, 4.0]), direction * np.diag([-0.1, -4.0])
    soft = SimpleNamespace(
        hessian=hessian,
        pull=-np.array(pull),
        value=0.0,
        scale=np.ones(2),
        size=lambda step: float(np.abs(step).max()),
        here=None,
    )
    monkeypatch.setattr(foretold_folds, "hessian_change", lambda system, here, outward, change: change * falling)
    return foretell_folds(None, soft, direction), soft


@DIRECTIONS
def test_the_mode_that_folds_first_need_not_be_the_softest(monkeypatch, direction):
    foretold, soft = foretold_of(monkeypatch, direction, [1e-2, 1e-2])
    np.testing.assert_allclose(foretold.distances, [0.5, 5.0], rtol=1e-11)
    assert abs(foretold.modes[0, 0]) <= 1e-12 * abs(foretold.modes[1, 0])
    motion, change = foretold.next_to_fold(soft)
    assert change == pytest.approx(0.5 * direction)
    # the first mode by twice its rate, the other by the root as well
    moved = direction * 1e-2 * np.array([2 * 5.0 * (1 - np.sqrt(1 - 0.5 / 5.0)), 2 * 0.5 * 0.25])
    np.testing.assert_allclose(motion, moved, rtol=1e-11)


def test_a_mode_on_which_the_load_does_no_work_softens_evenly(monkeypatch):
    foretold, _ = foretold_of(monkeypatch, 1.0, [1.0, 0.0])
    np.testing.assert_allclose(foretold.distances, [1.0, 5.0], rtol=1e-11)
    assert foretold.breaks.tolist() == [True, False]
    np.testing.assert_allclose(foretold.stiffness(0.6), [0.4, np.sqrt(1 - 0.6 / 5.0)], rtol=1e-11)


def test_edges_do_not_move_farther_than_a_step_may_be(monkeypatch):
    foretold, soft = foretold_of(monkeypatch, 1.0, [1.0, 1.0])
    motion, change = foretold.next_to_fold(soft)
    assert soft.size(motion) == pytest.approx(0.2, rel=0.01)
    assert 0 < change < 0.5


@DIRECTIONS
@pytest.mark.parametrize(
    ("second", "way", "softened"), [(0.7, 0.6, True), (0.9, 0.6, False), (1.2, -0.6, True)], ids=["", "snap", "behind"]
)
def test_a_mode_that_is_stiffer_than_foretold_tells_of_another_branch(second, way, softened, direction):
    """The second mode was to soften to 1/2; the third folds so far away that it is not asked, nor any of one behind."""
    none = np.zeros(3)
    foretold = Foretold(direction, np.array([0.6, 0.8, 5.0]), np.eye(3), none.astype(bool), none, none)
    assert foretold.have_softened(np.diag([0.0, second, 1.5]), direction * way) is softened
