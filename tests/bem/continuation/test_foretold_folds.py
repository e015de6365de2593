"""Folds foretold: the order of modes, and signs of a snap on the way (on a branch: test_limit_points.py)."""

from types import SimpleNamespace

import numpy as np
import pytest

from bem.continuation import foretold_folds
from bem.continuation.foretold_folds import Foretold, foretell_folds


def test_the_mode_that_folds_first_need_not_be_the_softest(monkeypatch):
    """Stiffnesses 1 and 4, falling by 0.1 and 4 per unit of the control: folds at 5 and 0.5."""
    hessian, change = np.diag([1.0, 4.0]), np.diag([-0.1, -4.0])
    soft = SimpleNamespace(
        hessian=hessian,
        pull=np.array([-1.0, -1.0]),
        value=0.0,
        scale=np.ones(2),
        size=lambda step: float(np.abs(step).max()),
        here=SimpleNamespace(state=SimpleNamespace(resolution=None)),
    )
    monkeypatch.setattr(foretold_folds, "forces_at", lambda system, soft, step, value, tolerance, like: value)
    monkeypatch.setattr(foretold_folds, "hessian_in", lambda value, scale: hessian + value * change)
    foretold = foretell_folds(None, soft, 1.0, 1e-3)
    np.testing.assert_allclose(foretold.distances, [0.5, 5.0], rtol=1e-11)
    assert abs(foretold.modes[0, 0]) <= 1e-12 * abs(foretold.modes[1, 0])
    motion, way = foretold.at(1.0)
    assert way == pytest.approx(0.5)
    # the first mode by twice its rate, the other by the root as well
    np.testing.assert_allclose(motion, [2 * 5.0 * (1 - np.sqrt(1 - 0.5 / 5.0)), 2 * 0.5 * 0.25], rtol=1e-11)


@pytest.mark.parametrize(("second", "softened"), [(0.7, True), (0.9, False)])
def test_a_mode_that_is_stiffer_than_foretold_tells_of_another_branch(second, softened):
    """The second mode was to soften to 1/2; the third folds so far away that it is not asked."""
    foretold = Foretold(np.array([0.6, 0.8, 5.0]), np.eye(3), np.zeros(3), np.zeros(3))
    assert foretold.have_softened(np.diag([0.0, second, 1.5]), 0.6) is softened
