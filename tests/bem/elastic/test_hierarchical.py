"""The system solved cluster by cluster: the same states as by one factorisation, and as the dense reference."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rough_surfaces import cut, short_waved

from bem.elastic import hierarchical
from bem.elastic.collocation import Elastic, evaluate, resolve, right_hand_sides
from bem.elastic.compliance import Compliance
from bem.elastic.hierarchical import IllConditionedSystemError
from bem.elastic.sensitivities import stress_intensity_jacobian
from bem.elastic.separated_kernel import RANGE_STEP, modes_and_core, range_steps
from bem.elastic.skeleton import Coupling, Skeleton
from bem.geometry.chebyshev import nodes_of, packed_bases
from bem.geometry.patches import Patches, ordered
from bem.geometry.profile import Profile
from bem.kernels import clusters
from bem.loading.control import LoadControl

SHORT = short_waved(3)


def one_wide_patch():
    """A patch as wide as twenty others beside it, with a narrow gap on one side."""
    left = np.concatenate([[0.5], 2.52 + 0.1 * np.arange(20)])
    return Patches(left, left + np.concatenate([[2.0], np.full(20, 0.05)])), 3.0


def narrow_gap():
    """Ten near patches, and two beside a gap so narrow that they have more modes than a cluster may have."""
    left = np.concatenate([2.0 + 0.1 * np.arange(10), [4.0, 4.502]])
    return Patches(left, np.concatenate([left[:-2] + 0.08, [4.5, 5.0]])), 3.0


CASES = {
    "light": lambda: cut(SHORT, 0.15),
    "dense": lambda: cut(SHORT, 0.6),
    "one wide patch": one_wide_patch,
    "narrow gap": narrow_gap,
}


class Nothing:
    """An addition of zeros to the kernel, whose many columns make one cluster of all patches."""

    columns = 10_000

    def coupling(self, x, patches, modes, tolerance, few):
        return Coupling(np.zeros((x.size, x.size)), None)

    def coupled_modes(self, width, tolerance, max_order):
        return np.zeros(width.shape)


def in_clusters_and_as_one(patches, penetration, tolerance):
    return (
        evaluate(Elastic(SHORT, kernel), patches, penetration, tolerance) for kernel in (None, Compliance(Nothing()))
    )


def relative(found, expected):
    return np.abs(found - expected).max() / np.abs(expected).max()


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-8, 1e-10])
@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_states_are_those_of_one_cluster(case, tolerance):
    patches, penetration = case()
    found, full = in_clusters_and_as_one(patches, penetration, tolerance)
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
def test_states_of_given_load_close_to_complete_contact(gap, error):
    """The matrix is nearly singular, and the penetration hardly known; the stress intensities are."""
    edges = np.linspace(0.0, 2 * np.pi, 11)[:-1] + 0.05 * np.sin(np.arange(10))
    patches = Patches(edges + gap / 2, np.append(edges[1:], edges[0] + 2 * np.pi) - gap / 2)
    load = LoadControl()
    found, full = (load.reach(state, 100.0) for state in in_clusters_and_as_one(patches, 3.0, 1e-8))
    assert relative(found.stress_intensity, full.stress_intensity) <= error


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_pressure_carries_load_and_stress_intensities(case):
    """The charges of all clusters are those of the reported state."""
    patches, penetration = case()
    state = evaluate(Elastic(SHORT), patches, penetration, 1e-9)
    pressure = state.pressure()
    ends = [[np.polynomial.chebyshev.chebval(t, q) for q in pressure.charges] for t in (-1.0, 1.0)]
    expected = -np.concatenate(ends) * np.sqrt(np.pi / np.tile(patches.half_width, 2))
    assert relative(state.stress_intensity, expected) <= 1e-11
    assert pressure.load == pytest.approx(state.load, rel=1e-12)


def test_the_start_of_the_period_does_not_matter():
    patches, penetration = cut(SHORT, 0.4)
    shift = 2 * np.pi - patches.right[patches.count // 2] - 1e-3
    moved = ordered(patches.left + shift, patches.right + shift)
    turned = Profile(SHORT.period, SHORT.orders, SHORT.amplitudes, SHORT.phases - SHORT.orders * shift)
    here = evaluate(Elastic(SHORT), patches, penetration, 1e-8)
    there = evaluate(Elastic(turned), moved, penetration, 1e-8)
    order = np.argsort((moved.left - shift) % (2 * np.pi))
    count = patches.count
    assert relative(there.stress_intensity[np.r_[order, count + order]], here.stress_intensity) <= 1e-9


def test_clusters_of_clusters_stay_few_where_gaps_widen_towards_the_ends():
    """Such gaps would all be worth a split at the end, a patch at a time."""
    behind = np.cumsum(0.3 + 1e-3 + np.linspace(-1, 1, 60) ** 2)
    left = np.append(0.0, behind[:-1])
    patches = Patches(left * 2 * np.pi / behind[-1], (left + 0.3) * 2 * np.pi / behind[-1])
    modes = resolve(Elastic(SHORT), patches, 1e-6).modes
    starts = np.concatenate([[0], np.cumsum(modes)])
    x = np.repeat(patches.center, modes) + np.repeat(patches.half_width, modes) * nodes_of(modes)
    cuts, _ = clusters.splits(x, patches.left, patches.right, starts, 130)

    def deepest(place):
        """Depth of the clusters from a place on, and the place behind them."""
        if cuts[place] < 0:
            return 0, place + 1
        first, place = deepest(place + 1)
        second, place = deepest(place)
        return 1 + max(first, second), place

    depth, size = deepest(0)
    assert size == cuts.size
    assert np.sum(cuts >= 0) > 5
    assert depth <= 6  # measured 4


def test_an_added_matrix_is_solved_in_one_cluster():
    """A thin layer couples high modes of all patches; charges are those of the dense matrix with the addition."""
    patches, skeleton = posed()
    added = 0.3 * np.cos(np.subtract.outer(skeleton.x, skeleton.x))
    whole = hierarchical.solve(replace(skeleton, coupling=Coupling(added, None)), 1e-12)
    plain = np.linalg.solve(dense_matrix(patches, skeleton), skeleton.columns.T)
    expected = np.linalg.solve(dense_matrix(patches, skeleton) - added, skeleton.columns.T).T
    assert skeleton.x.size > hierarchical.LARGEST_LEAF
    assert relative(whole.charges, expected) <= 1e-9
    assert relative(plain.T, expected) > 1e-4  # so the addition is seen


@pytest.mark.parametrize("edge_columns", [0, 2, 4], ids=["no edges", "edges", "slopes"])
def test_the_system_in_clusters_is_that_of_dense_algebra(edge_columns):
    """Matrix from math.log of chords between patches, and within them from the Chebyshev moments of the logarithm."""
    patches, skeleton = posed()
    solution = hierarchical.solve(replace(skeleton, edge_columns=edge_columns), 1e-13)
    charges = np.linalg.solve(dense_matrix(patches, skeleton), skeleton.columns.T).T
    assert relative(solution.charges, charges) <= 1e-9
    assert relative(solution.gram, skeleton.columns @ charges.T) <= 1e-10
    values, slopes = edge_vectors(skeleton.modes)
    assert relative(solution.at_edges, charges @ values.T) <= 1e-8
    assert relative(solution.slopes, charges @ slopes.T) <= 1e-7
    responses = np.linalg.solve(dense_matrix(patches, skeleton), values.T)
    if edge_columns:
        assert relative(solution.compliance, values @ responses) <= 1e-9
    if edge_columns == 4:
        assert relative(solution.slope_compliance, slopes @ responses) <= 1e-8


def posed():
    patches, penetration = cut(SHORT, 0.4)
    resolution = resolve(Elastic(SHORT), patches, 1e-6)
    _, x, columns, *_ = right_hand_sides(SHORT, patches, penetration, resolution)
    return patches, Skeleton(patches, resolution.modes, x, columns, None)


def dense_matrix(patches, skeleton):
    """Negated kernel between nodal charges, from chords and from int log|t - t'| T_n / sqrt(1 - t'^2) dt'."""
    chord = np.abs(2 * np.sin(np.subtract.outer(skeleton.x, skeleton.x) / 2)) + np.eye(skeleton.x.size)
    kernel = np.array([math.log(size) for size in chord.ravel()]).reshape(chord.shape)
    start = 0
    for modes, r in zip(skeleton.modes.tolist(), patches.half_width, strict=True):
        angle = (np.arange(modes) + 0.5) * np.pi / modes
        order, t = np.arange(modes), np.cos(angle)
        values = np.cos(np.outer(angle, order))
        moment = np.concatenate([[-np.pi * math.log(2)], -np.pi / order[1:]]) * np.where(order == 0, 1, 2) / np.pi
        y = r * np.subtract.outer(t, t) / 2 + 1e-300
        block = (values * moment) @ values.T + math.log(r) + np.log(np.sin(y) / y)
        kernel[start : start + modes, start : start + modes] = block
        start += modes
    return -kernel


def edge_vectors(modes):
    """Rows that take nodal charges to q at the edges and to sum n^2 (+-1)^n Q_n, left edges first."""
    starts = np.cumsum(modes) - modes
    rows = np.zeros((2, 2, modes.size, modes.sum()))
    for patch, (start, size) in enumerate(zip(starts, modes, strict=True)):
        order, angle = np.arange(size), (np.arange(size) + 0.5) * np.pi / size
        weight = np.where(order == 0, 1, 2)[:, None] / np.pi * np.cos(np.outer(order, angle))
        for side, sign in enumerate((-1.0, 1.0)):
            rows[0, side, patch, start : start + size] = sign**order @ weight
            rows[1, side, patch, start : start + size] = (order**2 * sign**order) @ weight
    return rows.reshape(2, 2 * modes.size, -1)


def test_clusters_that_are_not_positive_definite_together_are_refused():
    """A kernel between them far larger than that within them."""
    patches, skeleton = posed()
    starts = np.concatenate([[0], np.cumsum(skeleton.modes)])
    cuts, arcs = clusters.splits(skeleton.x, patches.left, patches.right, starts, skeleton.x.size - 1)
    low, high = arcs[0, 2:]
    steps = range_steps((high - low) / 2)
    modes, even, core = modes_and_core(steps, 1e-12)
    arcs[0, 2:] = (low + high) / 2, RANGE_STEP**steps
    tables = packed_bases(skeleton.modes)

    def solution(factor):
        ranges = [(modes, even, factor * core), None, None]
        given = skeleton.x, patches.half_width, starts, *tables, skeleton.columns, cuts, arcs, ranges
        return clusters.solved(*given, 0.03, 2)

    assert cuts.size == 3
    assert solution(1) is not None
    assert solution(100) is None


@pytest.mark.parametrize("added", [np.eye, lambda n: np.full((n, n), 10.0 / n)], ids=["a leaf", "a uniform charge"])
def test_an_indefinite_matrix_is_refused_by_name(added):
    _, skeleton = posed()
    matrix = 1e3 * added(skeleton.x.size)
    with pytest.raises(IllConditionedSystemError, match="unknowns is not positive definite"):
        hierarchical.solve(replace(skeleton, coupling=Coupling(matrix, None)), 1e-12)
