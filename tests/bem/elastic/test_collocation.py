"""The compressed evaluation: closed forms, the dense reference on rough states, its own identities and limits."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from johnson_wave import load_of, patch_of, penetration_of
from judges import SmoothKernel, evaluate_dense
from rough_surfaces import cut, short_waved

from bem.elastic.collocation import Elastic, Resolution, evaluate, finer, resolve
from bem.elastic.compliance import Compliance
from bem.elastic.hierarchical import IllConditionedSystemError
from bem.elastic.skeleton import Coupling, Waves
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile

WAVE = Profile.from_harmonics(2 * np.pi, [1], [1.0])
ROUGH = Profile.self_affine(2 * np.pi, 0.7, 1.0, 40, 0).scaled()


def johnson(fraction, alpha=0.0):
    """Patches, penetration, mean pressure and critical K, in units of the solver."""
    mean_pressure = load_of(fraction, alpha) / (2 * np.pi)
    return patch_of(fraction), penetration_of(fraction, alpha), mean_pressure, np.sqrt(2 * np.pi) * alpha


@pytest.fixture(scope="module")
def rough():
    patches, penetration = cut(ROUGH, 0.4)
    return patches, penetration, evaluate(Elastic(ROUGH), patches, penetration, 1e-12)


@pytest.fixture(scope="module")
def many_patches():
    profile = short_waved(3)
    patches, penetration = cut(profile, 0.4)
    return profile, patches, evaluate_dense(profile, patches.left, patches.right, penetration)


@pytest.mark.parametrize("alpha", [0.0, 0.1, 0.3, 0.5])
@pytest.mark.parametrize("fraction", [1e-4, 0.02, 0.3, 0.53, 0.8, 0.95])
def test_one_wave_is_johnsons(fraction, alpha):
    patches, penetration, mean_pressure, critical = johnson(fraction, alpha)
    state = evaluate(Elastic(WAVE), patches, penetration, 1e-12)
    assert state.unknowns <= 64
    assert abs(state.load / (2 * np.pi) - mean_pressure) <= 3e-13  # measured 1.1e-13 at 0.95, 1e-15 up to 0.8
    np.testing.assert_allclose(state.stress_intensity, critical, rtol=0, atol=2e-12)  # measured 6e-13


def test_error_falls_with_the_modes_as_the_bernstein_ellipse_says():
    """One patch feels its own images at the distance of the gap: each mode gains a factor rho in K."""
    patches, penetration, _, critical = johnson(0.8, 0.3)
    z = 2 * patches.gap_after[0] / patches.width[0]
    rho = 1 + z + np.sqrt(z * (2 + z))
    sizes = np.array([6, 8, 10, 12, 14, 16])
    error = [
        np.abs(
            evaluate(
                Elastic(WAVE), patches, penetration, 1e-12, Resolution(np.array([60]), np.array([size]))
            ).stress_intensity
            - critical
        ).max()
        for size in sizes
    ]
    rate = -np.polyfit(sizes, np.log(error), 1)[0]
    assert rate >= 0.95 * np.log(rho)


@pytest.mark.parametrize(("seed", "fraction"), [(0, 0.15), pytest.param(1, 0.4, marks=pytest.mark.slow), (2, 0.6)])
def test_rough_states_agree_with_the_dense_reference(seed, fraction):
    profile = short_waved(seed)
    patches, penetration = cut(profile, fraction)
    assert patches.count >= 60
    state = evaluate(Elastic(profile), patches, penetration, 1e-6)
    dense = evaluate_dense(profile, patches.left, patches.right, penetration)
    largest = np.abs(dense.stress_intensity).max()
    # measured 3e-8 in K, 1e-9 in load and energy
    np.testing.assert_allclose(state.stress_intensity, dense.stress_intensity, rtol=0, atol=1e-7 * largest)
    assert state.load == pytest.approx(dense.load, rel=1e-8)
    assert state.load_rate == pytest.approx(dense.load_rate, rel=1e-8)
    assert state.elastic_energy == pytest.approx(dense.elastic_energy, rel=1e-8)
    rates = np.abs(dense.stress_intensity_rate).max()
    np.testing.assert_allclose(state.stress_intensity_rate, dense.stress_intensity_rate, rtol=0, atol=1e-7 * rates)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9, 1e-11])
def test_error_is_below_the_tolerance(many_patches, tolerance):
    profile, patches, dense = many_patches
    state = evaluate(Elastic(profile), patches, dense.penetration, tolerance)
    error = np.abs(state.stress_intensity - dense.stress_intensity).max() / np.abs(dense.stress_intensity).max()
    assert error <= tolerance  # measured 3e-2 of it; rounding leaves 5e-12


def test_without_the_compliance_of_the_edges_the_rest_is_the_same(many_patches):
    profile, patches, dense = many_patches
    whole = evaluate(Elastic(profile), patches, dense.penetration, 1e-6)
    alone = evaluate(Elastic(profile), patches, dense.penetration, 1e-6, with_compliance=False)
    assert alone.edge_compliance.size == 0
    for name in ("stress_intensity", "stress_intensity_rate", "edge_slope", "skeleton", "load", "elastic_energy"):
        expected = getattr(whole, name)
        atol = 3e-12 * np.abs(expected).max()  # measured: 1e-12 in the slopes at edges, 3e-13 in the others
        np.testing.assert_allclose(getattr(alone, name), expected, rtol=0, atol=atol)


def test_pressure_series_agree_with_the_dense_reference(rough):
    patches, penetration, state = rough
    dense = evaluate_dense(ROUGH, patches.left, patches.right, penetration)
    for found, expected in zip(state.pressure().charges, dense.pressure.charges, strict=True):
        size = min(found.size, expected.size)
        np.testing.assert_allclose(found[:size], expected[:size], rtol=0, atol=1e-11)  # measured 5e-13


def test_finer_sizes_change_nothing(rough):
    patches, penetration, state = rough
    more = finer(Elastic(ROUGH), patches, state.resolution, 1e-12)
    other = evaluate(Elastic(ROUGH), patches, penetration, 1e-12, more)
    assert np.all(more.modes > state.resolution.modes)
    assert np.all(more.nodes > state.resolution.nodes)
    np.testing.assert_allclose(other.stress_intensity, state.stress_intensity, rtol=0, atol=1e-10)
    assert other.load == pytest.approx(state.load, rel=1e-12)


def test_wide_patch_is_resolved_to_the_tolerance():
    """A patch over many waves: the nodes of the profile, not the coupling, limit the accuracy."""
    profile = Profile.from_harmonics(2 * np.pi, [1, 10], [1.0, 0.5])
    patches = Patches(np.array([0.1]), np.array([5.0]))
    state = evaluate(Elastic(profile), patches, 1.0, 1e-12)
    dense = evaluate_dense(profile, patches.left, patches.right, 1.0)
    largest = np.abs(dense.stress_intensity).max()
    np.testing.assert_allclose(state.stress_intensity, dense.stress_intensity, rtol=0, atol=1e-10 * largest)


def test_load_and_stress_intensities_are_those_of_the_series(rough):
    patches, _, state = rough
    pressure = state.pressure()
    assert pressure.load == pytest.approx(state.load, rel=1e-12)
    ends = [[np.polynomial.chebyshev.chebval(t, q) for q in pressure.charges] for t in (-1.0, 1.0)]
    expected = -np.concatenate(ends) * np.sqrt(np.pi / np.tile(patches.half_width, 2))
    np.testing.assert_allclose(state.stress_intensity, expected, rtol=0, atol=1e-11)


def test_elastic_energy_is_the_work_of_the_pressure(rough):
    """1/2 int sigma (h - h_max + Delta) dx by Gauss-Chebyshev sums."""
    patches, penetration, state = rough
    total = 0.0
    for c, r, q in zip(patches.center, patches.half_width, state.pressure().charges, strict=True):
        t = np.cos((np.arange(400) + 0.5) * np.pi / 400)
        indentation = ROUGH.height(c + r * t) - ROUGH.max_height + penetration
        total += np.pi / 400 * np.sum(np.polynomial.chebyshev.chebval(t, q) * indentation) / 2
    assert state.elastic_energy == pytest.approx(total, rel=1e-11)


@given(shift=st.floats(-2, 2))
def test_everything_is_linear_in_the_penetration(rough, shift):
    patches, penetration, state = rough
    other = evaluate(Elastic(ROUGH), patches, penetration + shift, 1e-12)
    moved = state.stress_intensity + shift * state.stress_intensity_rate
    np.testing.assert_allclose(other.stress_intensity, moved, rtol=0, atol=1e-11)
    assert other.load == pytest.approx(state.load + shift * state.load_rate, rel=1e-12)
    energy = state.elastic_energy + shift * state.load + shift**2 * state.load_rate / 2
    assert other.elastic_energy == pytest.approx(energy, rel=1e-11)
    slope = state.edge_slope + shift * state.edge_slope_rate
    np.testing.assert_allclose(other.edge_slope, slope, rtol=0, atol=1e-8 * np.abs(slope).max())


@settings(max_examples=30)
@given(shift=st.floats(0.1, 6.0), seed=st.integers(0, 5))
def test_shift_and_mirror_change_nothing(shift, seed):
    profile = Profile.self_affine(2 * np.pi, 0.7, 1.0, 30, seed).scaled()
    patches, penetration = cut(profile, 0.3)
    state = evaluate(Elastic(profile), patches, penetration, 1e-12)
    phases = profile.phases - profile.orders * shift
    moved = evaluate(
        Elastic(replace(profile, phases=phases)),
        Patches(patches.left + shift, patches.right + shift),
        penetration,
        1e-12,
    )
    mirrored = evaluate(
        Elastic(replace(profile, phases=-profile.phases)),
        Patches(2 * np.pi - patches.right[::-1], 2 * np.pi - patches.left[::-1]),
        penetration,
        1e-12,
    )
    scale = np.abs(state.stress_intensity).max()
    np.testing.assert_allclose(moved.stress_intensity, state.stress_intensity, rtol=0, atol=1e-10 * scale)
    flipped = mirrored.stress_intensity.reshape(2, -1)[::-1, ::-1].ravel()
    np.testing.assert_allclose(flipped, state.stress_intensity, rtol=0, atol=1e-10 * scale)


def test_patches_in_the_field_of_the_others_do_not_know_the_difference(rough):
    """Some patches frozen as a background: the rest must carry what they carried."""
    patches, penetration, state = rough
    some = np.arange(patches.count) < patches.count // 2
    starts = np.concatenate([[0], np.cumsum(state.resolution.modes)])
    frozen = np.concatenate([np.arange(starts[i], starts[i + 1]) for i in np.flatnonzero(~some)])
    nodes, charges = state.skeleton_nodes()[frozen], state.skeleton[frozen]

    def field(x):
        return np.log(np.abs(2 * np.sin(np.subtract.outer(x, nodes) / 2))) @ charges

    few = Patches(patches.left[some], patches.right[some])
    sizes = Resolution(state.resolution.nodes[some], state.resolution.modes[some])
    alone = evaluate(Elastic(ROUGH, backgrounds=(field,)), few, penetration, 1e-12, sizes)
    expected = state.stress_intensity[np.tile(some, 2)]
    np.testing.assert_allclose(alone.stress_intensity, expected, rtol=0, atol=1e-10)


class OneMode:
    """An addition 0.3 cos x to the kernel, as waves if its columns are few."""

    def __init__(self, columns):
        self.columns = columns

    def coupling(self, x, patches, modes, tolerance, few):
        waves = Waves(np.sqrt(0.3) * np.stack([np.cos(x), np.sin(x)]), np.ones(2)) if few else None
        matrix = None if few else 0.3 * np.cos(np.subtract.outer(x, x))
        return Coupling(matrix, waves)

    def field(self, x, sources, charges):
        return 0.3 * np.cos(np.subtract.outer(x, sources)) @ charges

    def coupled_modes(self, width, tolerance, max_order):
        return np.full(width.shape, 24.0)


@pytest.mark.parametrize("columns", [10_000, 2], ids=["in the matrix", "as waves"])
def test_addition_to_the_kernel_agrees_with_the_dense_reference(rough, columns):
    patches, penetration, plain = rough
    state = evaluate(Elastic(ROUGH, Compliance(OneMode(columns))), patches, penetration, 1e-12)
    kernel = SmoothKernel(lambda x: 0.3 * np.cos(x), lambda x: -0.3 * np.sin(x))
    dense = evaluate_dense(ROUGH, patches.left, patches.right, penetration, smooth_kernel=kernel)
    np.testing.assert_allclose(state.stress_intensity, dense.stress_intensity, rtol=0, atol=1e-10)
    assert np.all(state.resolution.modes >= 24)
    assert np.abs(state.stress_intensity - plain.stress_intensity).max() > 1e-2


def test_too_many_unknowns_are_refused_by_name():
    edges = np.array([0.0, 3.0])
    patches = Patches(edges, np.array([3.0 - 1e-7, 6.0]))
    with pytest.raises(IllConditionedSystemError, match="gaps too narrow"):
        evaluate(Elastic(WAVE), patches, 1.0, 1e-12)


@pytest.mark.parametrize("columns", [10_000, 2], ids=["in the matrix", "as waves"])
def test_system_that_is_not_positive_definite_is_refused_by_name(columns):
    """An addition that gives the mean a compliance of the wrong sign."""

    class Wrong(OneMode):
        def coupling(self, x, patches, modes, tolerance, few):
            waves = Waves(np.full((1, x.size), np.sqrt(10.0)), np.ones(1)) if few else None
            matrix = None if few else np.full((x.size, x.size), 10.0)
            return Coupling(matrix, waves)

    patches, penetration, _, _ = johnson(0.5)
    with pytest.raises(IllConditionedSystemError, match="not positive definite"):
        evaluate(Elastic(WAVE, Compliance(Wrong(columns))), patches, penetration, 1e-8)


@pytest.mark.parametrize("fraction", [1e-4, 0.3, 0.9, 0.99])
def test_rounding_bounds_the_error_of_the_stress_intensity(fraction):
    patches, penetration, _, _ = johnson(fraction)
    sizes = resolve(Elastic(WAVE), patches, 1e-14)
    state = evaluate(Elastic(WAVE), patches, penetration, 1e-14, sizes)
    assert np.all(np.abs(state.stress_intensity) <= state.rounding(1.0))  # exactly zero in Westergaard's contact
    assert np.all(state.rounding(1.0) <= 1e-9)


def test_rounding_bounds_what_positions_leave_uncertain_on_a_steep_profile():
    """Edges that move by their last digits, where slopes of several hundred make other heights of them."""
    steep = Profile.self_affine(2 * np.pi, 0.01, 1.0, 1000, 0).scaled()
    patches, penetration = cut(steep, 0.03)
    state = evaluate(Elastic(steep), patches, penetration, 1e-8)
    rng = np.random.default_rng(5)
    noise = np.zeros(2 * patches.count)
    for _ in range(6):
        left, right = (
            edges * (1 + rng.integers(-2, 3, edges.size) * 2.2e-16) for edges in (patches.left, patches.right)
        )
        moved = evaluate(Elastic(steep), Patches(left, right), penetration, 1e-8, state.resolution)
        noise = np.maximum(noise, np.abs(moved.stress_intensity - state.stress_intensity))
    share = noise / state.rounding(0.0)
    assert 0.1 <= share.max() <= 1.0  # measured 0.63
