"""Elimination of modes that only near patches share: the same states as without, and as the dense reference."""

import numpy as np
import pytest

from bem import near_field
from bem.collocation import Elastic, evaluate, resolve
from bem.dense import evaluate_dense
from bem.near_field import elimination
from bem.patches import Patches, ordered
from bem.profile import Profile
from bem.sensitivities import stress_intensity_jacobian

M = np.arange(60, 251)
SHORT = Profile.from_harmonics(2 * np.pi, M, M**-1.2, np.random.default_rng(3).uniform(-np.pi, np.pi, M.size)).scaled()


def cut(fraction):
    """Patches where the profile is highest: many, of all widths, some with narrow gaps."""
    x, h = SHORT.grid
    level = float(np.quantile(h, 1 - fraction))
    above = h > level
    left = x[np.flatnonzero(above & ~np.roll(above, 1))] - x[1] / 2
    right = x[np.flatnonzero(above & ~np.roll(above, -1))] + x[1] / 2
    right = right if right[0] > left[0] else np.append(right[1:], right[0] + 2 * np.pi)
    return Patches(left, right), SHORT.max_height - level


def one_wide_patch():
    """A patch as wide as twenty others beside it, with a narrow gap on one side."""
    left = np.concatenate([[0.5], 2.52 + 0.1 * np.arange(20)])
    return Patches(left, left + np.concatenate([[2.0], np.full(20, 0.05)])), 3.0


def fine_without_a_pair():
    """Ten near patches, and two beside a gap so narrow that they keep all their modes: more than any pair has."""
    left = np.concatenate([2.0 + 0.1 * np.arange(10), [4.0, 4.505]])
    return Patches(left, np.concatenate([left[:-2] + 0.08, [4.5, 5.0]])), 3.0


CASES = {
    "light": lambda: cut(0.15),
    "dense": lambda: cut(0.6),
    "one wide patch": one_wide_patch,
    "no pair": fine_without_a_pair,
}


@pytest.fixture
def evaluated(monkeypatch):
    """An evaluation with all elimination there is, or with none."""

    def one(patches, penetration, tolerance, eliminate):
        monkeypatch.setattr(near_field, "WORTHWHILE", 0 if eliminate else 1e9)
        return evaluate(Elastic(SHORT), patches, penetration, tolerance)

    return one


def relative(found, expected):
    return np.abs(found - expected).max() / np.abs(expected).max()


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_states_are_those_without_elimination(evaluated, case, tolerance):
    patches, penetration = case()
    found, full = (evaluated(patches, penetration, tolerance, eliminate) for eliminate in (True, False))
    # measured, over the tolerance: K 0.02 (what p_i leaves out 0.08), Jacobian 0.7 (5), energy 5e-6, load 1.2e-5;
    # rounding 5e-12, 2e-9, 1e-15, 3e-15
    assert relative(found.stress_intensity, full.stress_intensity) <= max(0.05 * tolerance, 1e-11)
    assert relative(found.stress_intensity_rate, full.stress_intensity_rate) <= max(0.05 * tolerance, 1e-11)
    assert relative(stress_intensity_jacobian(found), stress_intensity_jacobian(full)) <= max(1.5 * tolerance, 5e-9)
    assert found.elastic_energy == pytest.approx(full.elastic_energy, rel=max(1.5e-5 * tolerance, 1e-14))
    assert found.load == pytest.approx(full.load, rel=max(3e-5 * tolerance, 1e-14))
    assert found.unknowns == full.unknowns


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_states_agree_with_the_dense_reference(evaluated, tolerance):
    patches, penetration = cut(0.4)
    found = evaluated(patches, penetration, tolerance, True)
    dense = evaluate_dense(SHORT, patches.left, patches.right, penetration)
    assert relative(found.stress_intensity, dense.stress_intensity) <= 0.05 * tolerance  # measured 0.017
    assert found.load == pytest.approx(dense.load, rel=max(2e-4 * tolerance, 1e-12))  # measured 7e-5 of it


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_pressure_carries_load_and_stress_intensities(evaluated, case):
    """The eliminated modes come back: the series at all nodes are those of the reported state."""
    patches, penetration = case()
    state = evaluated(patches, penetration, 1e-9, True)
    pressure = state.pressure()
    ends = [[np.polynomial.chebyshev.chebval(t, q) for q in pressure.charges] for t in (-1.0, 1.0)]
    expected = -np.concatenate(ends) * np.sqrt(np.pi / np.tile(patches.half_width, 2))
    assert relative(state.stress_intensity, expected) <= 1e-11
    assert pressure.load == pytest.approx(state.load, rel=1e-12)


def test_the_start_of_the_period_does_not_matter(evaluated):
    patches, penetration = cut(0.4)
    shift = 2 * np.pi - patches.right[patches.count // 2] - 1e-3
    moved = ordered(patches.left + shift, patches.right + shift)
    turned = Profile(SHORT.period, SHORT.orders, SHORT.amplitudes, SHORT.phases - SHORT.orders * shift)
    here = evaluated(patches, penetration, 1e-8, True)
    there = evaluate(Elastic(turned), moved, penetration, 1e-8)
    order = np.argsort((moved.left - shift) % (2 * np.pi))
    count = patches.count
    assert relative(there.stress_intensity[np.r_[order, count + order]], here.stress_intensity) <= 1e-9


@pytest.mark.parametrize(("tolerance", "share"), [(1e-3, 0.95), (1e-8, 0.75), (1e-12, 0.7)])
def test_fewer_modes_are_kept_and_few_pairs_are_near(tolerance, share):
    patches, _ = cut(0.4)
    modes = resolve(Elastic(SHORT), patches, tolerance).modes
    found = elimination(patches, modes, tolerance)
    assert found.kept.sum() <= share * modes.sum()
    assert np.all(found.kept <= modes)
    assert np.all(found.near == found.near.T)
    assert found.near.sum() <= 8 * patches.count  # measured 6


def test_layers_keep_all_modes(monkeypatch):
    """A layer couples high modes of all patches."""

    class OneMode:
        def matrix(self, x):
            return 0.3 * np.cos(np.subtract.outer(x, x))

        def coupled_modes(self, width, tolerance):
            return np.full(width.shape, 24.0)

    monkeypatch.setattr(near_field, "WORTHWHILE", 0)
    monkeypatch.setattr(near_field, "elimination", None)
    patches, penetration = cut(0.15)
    assert evaluate(Elastic(SHORT, (OneMode(),)), patches, penetration, 1e-3).unknowns >= 24 * patches.count


@pytest.mark.parametrize(("fraction", "expected"), [(0.02, False), (0.4, True)], ids=["few", "many"])
def test_it_is_used_where_it_saves_time(fraction, expected):
    patches, _ = cut(fraction)
    modes = resolve(Elastic(SHORT), patches, 1e-9).modes
    assert elimination(patches, modes, 1e-9).is_worthwhile == expected
