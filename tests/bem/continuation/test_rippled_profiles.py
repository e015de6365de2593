"""Waves of 1e-8 to 1e-6 m on a height of 5e-5 m pin edges, which snap from one to the next, and break symmetries.

Hundreds of small events on a path: each must be met, at any increment, and a symmetric profile must do what profiles do
that are nearly so.
"""

import numpy as np
import pytest

from bem.continuation.path import Path
from bem.scene.scene import parse_scene
from bem.solver import solve

OPENING = {"control": "separation", "initial": "complete_contact"}
UNLOADED = {"control": "mean_pressure", "targets": [5e3, 3e4, 0.0]}


def rippled(orders, amplitudes, phases, work, loading, increment=0.05, poisson_ratio=0.5):
    profile = {"orders": orders, "amplitudes": amplitudes, "phases": phases}
    return parse_scene(
        {
            "solid": {"youngs_modulus": 1e6, "poisson_ratio": poisson_ratio},
            "profile": {"kind": "harmonics", "period": 0.01, **profile},
            "adhesion": {"work_of_adhesion": work},
            "loading": loading,
            "accuracy": {"max_increment": increment},
        }
    )


def released(result):
    return np.array([event.energy_released for event in result.events])


@pytest.mark.parametrize(
    ("ripple", "phase", "targets"),
    [
        ((300, 1e-8), 0.0, [1e-6]),
        ((300, 1e-8), 0.3, [1e-6]),
        ((200, 2e-8), 0.0, [20e-6, 30e-6, 10e-6]),
        ((150, 4e-8), 0.0, [1.265176e-6]),
    ],
    ids=["symmetric", "not symmetric", "there and back", "to just behind a broken symmetry"],
)
def test_every_snap_is_an_event_at_any_increment(monkeypatch, ripple, phase, targets):
    ways = []

    def advance(path, point, goal, separation=None):
        for passed in original(path, point, goal, separation):
            ways.append((goal - point.value) * (goal - passed.value))
            yield passed

    original = Path.advance
    monkeypatch.setattr(Path, "advance", advance)
    order, height = ripple
    coarse, fine = (
        solve(rippled([1, order], [50e-6, height], [phase, 0.0], 0.3, OPENING | {"targets": targets}, increment))
        for increment in (0.05, 0.0125)
    )
    assert min(ways) >= 0  # no point lies beyond its goal
    assert coarse.status == fine.status == "converged"
    assert [event.kind for event in coarse.events] == [event.kind for event in fine.events]
    first, second = released(coarse), released(fine)
    np.testing.assert_allclose(first, second, rtol=0, atol=7e-7 * first.max())  # measured 2.4e-7
    depths = [[event.penetration for event in result.events[1:]] for result in (coarse, fine)]
    np.testing.assert_allclose(*depths, rtol=0, atol=1.3e-10 * 50e-6)  # measured 5.2e-11
    for state, other in zip(coarse.targets, fine.targets, strict=True):
        assert state.contact_fraction == pytest.approx(other.contact_fraction, abs=1.7e-13)  # measured 5.6e-14


@pytest.mark.parametrize("initial", ["separated", "complete_contact"])
def test_a_symmetric_profile_does_what_one_does_that_is_nearly_so(initial):
    """Its contact fractions were 2 parts in 100 off: where its symmetry broke, the contact took up a branch too far."""
    loading = {"control": "separation", "targets": [2e-6, 7e-7, 1.3e-5], "initial": initial}
    symmetric, nearly = (
        solve(rippled([1, 40], [50e-6, 1e-6], [0.0, phase], 0.01, loading, poisson_ratio=0.45)) for phase in (0.0, 1e-6)
    )
    assert symmetric.status == nearly.status == "converged"
    for state, other in zip(symmetric.targets, nearly.targets, strict=True):
        assert state.contact_fraction == pytest.approx(other.contact_fraction, abs=3e-14)  # measured 1.0e-14
    assert released(symmetric).sum() == pytest.approx(released(nearly).sum(), rel=4e-3)  # measured 1.7e-3, 2.0e-6


def test_a_contact_does_not_jump_twice_from_one_fold():
    """Halfway from there to the next, edges were within their accuracy of the branch that ended in it."""
    result = solve(rippled([2, 150], [5e-5, 3e-8], [0.0, 0.1], 0.01, UNLOADED, poisson_ratio=0.45))
    assert result.status == "converged"
