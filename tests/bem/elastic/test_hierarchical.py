"""The system solved cluster by cluster: the same states as by one factorisation, and as the dense reference."""

import numpy as np
import pytest
from dense_states import evaluate_dense
from rough_surfaces import cut, short_waved

from bem.compiled.kernels import REFERENCES
from bem.elastic import hierarchical, separated_kernel
from bem.elastic.collocation import Elastic, evaluate, resolve, right_hand_sides
from bem.elastic.compliance import Compliance
from bem.elastic.hierarchical import IllConditionedSystemError
from bem.elastic.sensitivities import stress_intensity_jacobian
from bem.elastic.skeleton import Coupling, Skeleton
from bem.geometry.patches import Patches, ordered
from bem.geometry.profile import Profile
from bem.loading.control import LoadControl

SHORT = short_waved(3)


def one_wide_patch():
    """A patch as wide as twenty others beside it, with a narrow gap on one side."""
    left = np.concatenate([[0.5], 2.52 + 0.1 * np.arange(20)])
    return Patches(left, left + np.concatenate([[2.0], np.full(20, 0.05)])), 3.0


def narrow_gap():
    """Ten near patches, and two beside a gap so narrow that they have more modes than a cluster may have."""
    left = np.concatenate([2.0 + 0.1 * np.arange(10), [4.0, 4.505]])
    return Patches(left, np.concatenate([left[:-2] + 0.08, [4.5, 5.0]])), 3.0


CASES = {
    "light": lambda: cut(SHORT, 0.15),
    "dense": lambda: cut(SHORT, 0.6),
    "one wide patch": one_wide_patch,
    "narrow gap": narrow_gap,
}


@pytest.fixture
def evaluated(monkeypatch):
    """An evaluation in clusters of at most so many unknowns."""

    def one(patches, penetration, tolerance, largest):
        monkeypatch.setattr(hierarchical, "LARGEST_LEAF", largest)
        return evaluate(Elastic(SHORT), patches, penetration, tolerance)

    return one


def relative(found, expected):
    return np.abs(found - expected).max() / np.abs(expected).max()


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_states_are_those_of_one_cluster(evaluated, case, tolerance):
    patches, penetration = case()
    found, full = (evaluated(patches, penetration, tolerance, largest) for largest in (40, 10**9))
    # measured, over the tolerance: K 7e-5, its rate 6e-5, Jacobian 2.5e-3, energy 2e-6, load 1.5e-5;
    # rounding 5e-12, 4e-12, 1e-9, 1.7e-12, 2.3e-12
    assert relative(found.stress_intensity, full.stress_intensity) <= max(2e-4 * tolerance, 1e-11)
    assert relative(found.stress_intensity_rate, full.stress_intensity_rate) <= max(2e-4 * tolerance, 1e-11)
    assert relative(stress_intensity_jacobian(found), stress_intensity_jacobian(full)) <= max(6e-3 * tolerance, 2.5e-9)
    assert found.elastic_energy == pytest.approx(full.elastic_energy, rel=max(5e-6 * tolerance, 5e-12))
    assert found.load == pytest.approx(full.load, rel=max(4e-5 * tolerance, 6e-12))
    assert found.unknowns == full.unknowns


# measured 1.2e-12, 1e-11, 1.5e-10, the largest over BLAS kernels of five processors; with alpha = 0 5e-12, 3e-9, 2.5e-5
@pytest.mark.parametrize(
    ("gap", "error"), [(1e-2, 3e-12), (1e-3, 2.5e-11), pytest.param(1e-4, 4e-10, marks=pytest.mark.slow)]
)
def test_states_of_given_load_close_to_complete_contact(evaluated, gap, error):
    """The matrix is nearly singular, and the penetration hardly known; the stress intensities are."""
    edges = np.linspace(0.0, 2 * np.pi, 11)[:-1] + 0.05 * np.sin(np.arange(10))
    patches = Patches(edges + gap / 2, np.append(edges[1:], edges[0] + 2 * np.pi) - gap / 2)
    load = LoadControl()
    found, full = (load.reach(evaluated(patches, 3.0, 1e-8, largest), 100.0) for largest in (100, 10**9))
    assert relative(found.stress_intensity, full.stress_intensity) <= error


@pytest.fixture(scope="module")
def dense():
    """Four tenths of the period in contact, by dense algebra."""
    patches, penetration = cut(SHORT, 0.4)
    return evaluate_dense(SHORT, patches.left, patches.right, penetration)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_states_agree_with_the_dense_reference(evaluated, dense, tolerance):
    found = evaluated(*cut(SHORT, 0.4), tolerance, 40)
    assert relative(found.stress_intensity, dense.stress_intensity) <= 0.05 * tolerance  # measured 0.017
    assert found.load == pytest.approx(dense.load, rel=max(2e-4 * tolerance, 1e-12))  # measured 7e-5 of it


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_pressure_carries_load_and_stress_intensities(evaluated, case):
    """The charges of all clusters are those of the reported state."""
    patches, penetration = case()
    state = evaluated(patches, penetration, 1e-9, 40)
    pressure = state.pressure()
    ends = [[np.polynomial.chebyshev.chebval(t, q) for q in pressure.charges] for t in (-1.0, 1.0)]
    expected = -np.concatenate(ends) * np.sqrt(np.pi / np.tile(patches.half_width, 2))
    assert relative(state.stress_intensity, expected) <= 1e-11
    assert pressure.load == pytest.approx(state.load, rel=1e-12)


def test_the_start_of_the_period_does_not_matter(evaluated):
    patches, penetration = cut(SHORT, 0.4)
    shift = 2 * np.pi - patches.right[patches.count // 2] - 1e-3
    moved = ordered(patches.left + shift, patches.right + shift)
    turned = Profile(SHORT.period, SHORT.orders, SHORT.amplitudes, SHORT.phases - SHORT.orders * shift)
    here = evaluated(patches, penetration, 1e-8, 40)
    there = evaluate(Elastic(turned), moved, penetration, 1e-8)
    order = np.argsort((moved.left - shift) % (2 * np.pi))
    count = patches.count
    assert relative(there.stress_intensity[np.r_[order, count + order]], here.stress_intensity) <= 1e-9


def test_clusters_of_clusters_stay_few_where_gaps_widen_towards_the_ends(monkeypatch):
    """Such gaps would all be worth a split at the end, a patch at a time."""
    shared = []

    def leaf(skeleton, first, last, columns, uniform):
        shared.append(columns.shape[1])
        return original(skeleton, first, last, columns, uniform)

    original = hierarchical._leaf
    monkeypatch.setattr(hierarchical, "_leaf", leaf)
    behind = np.cumsum(0.3 + 1e-3 + np.linspace(-1, 1, 60) ** 2)
    left = np.append(0.0, behind[:-1])
    patches = Patches(left * 2 * np.pi / behind[-1], (left + 0.3) * 2 * np.pi / behind[-1])
    resolution = resolve(Elastic(SHORT), patches, 1e-6)
    _, x, columns, *_ = right_hand_sides(SHORT, patches, 1.0, resolution)
    skeleton = Skeleton(patches, resolution.modes, x, columns, None)
    REFERENCES["solved"](skeleton, hierarchical.Splitting(1e-8, 130, 0.03))
    assert max(shared) <= 200  # measured 94; with splits at any gap 578


def test_layers_of_many_waves_are_one_cluster(monkeypatch):
    """A thin layer couples high modes of all patches."""

    class OneMode:
        columns = 10**6

        def coupling(self, x, patches, modes, tolerance, few):
            assert x.size >= 24 * patches.count and not few
            matrix = 0.3 * np.cos(np.subtract.outer(x, x))
            return Coupling(matrix, None)

        def coupled_modes(self, width, tolerance, max_order):
            return np.full(width.shape, 24.0)

    monkeypatch.setattr(hierarchical, "LARGEST_LEAF", 40)
    monkeypatch.setattr(hierarchical, "separated_kernel", None)
    patches, penetration = cut(SHORT, 0.15)
    assert evaluate(Elastic(SHORT, Compliance(OneMode())), patches, penetration, 1e-3).unknowns >= 24 * patches.count


def test_clusters_that_are_not_positive_definite_together_are_refused_by_name(monkeypatch):
    """A kernel between them far larger than that within them."""

    def too_strong(steps, accuracy):
        modes, even, core = original(steps, accuracy)
        return modes, even, 100 * core

    original = separated_kernel.modes_and_core
    monkeypatch.setattr(hierarchical, "LARGEST_LEAF", 40)
    monkeypatch.setattr(separated_kernel, "modes_and_core", too_strong)
    patches, penetration = cut(SHORT, 0.15)
    with pytest.raises(IllConditionedSystemError, match="unknowns is not positive definite"):
        evaluate(Elastic(SHORT), patches, penetration, 1e-6)
