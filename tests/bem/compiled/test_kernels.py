"""The kernels in C say what the functions in NumPy say that they mirror, to rounding."""

import os
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from bem.compiled import kernels
from bem.elastic import collocation, hierarchical, sensitivities
from bem.elastic.collocation import Elastic
from bem.elastic.kernel_series import kernel_series
from bem.elastic.layer import LayerEffect
from bem.elastic.separated_kernel import separated_kernel
from bem.geometry import chebyshev
from bem.geometry.patches import TWO_PI, Patches, ordered
from bem.geometry.profile import Profile

CORE = kernels.compiled("")
pytestmark = pytest.mark.skipif(CORE is None, reason="the kernels in C are not built")
ROUNDING = 1e-12  # measured up to 3e-13
LAYER = kernel_series(LayerEffect(1.0, 0.5, 0.0), 1e-14)
ROUGH = Profile.self_affine(TWO_PI, 0.7, 1.0, 400, 5).scaled()


def random_patches(count, seed, share=0.5):
    """Patches of random widths and gaps, which fill a share of the circle."""
    random = np.random.default_rng(seed)
    width, gap = random.exponential(size=(2, count)) + 0.05
    width, gap = share * TWO_PI * width / width.sum(), (1 - share) * TWO_PI * gap / gap.sum()
    left = np.cumsum(width + gap) - width
    return ordered(left, left + width)


def near_merging():
    patches = random_patches(6, 1)
    return Patches(patches.left, patches.right + np.array([0, 0, 1, 0, 0, 0]) * (patches.gap_after - 1e-4))


def near_vanishing():
    patches = random_patches(7, 2)
    right = patches.right.copy()
    right[3] = patches.left[3] + 1e-7
    return Patches(patches.left, right)


PATCHES = {
    "one": lambda: Patches(np.array([1.0]), np.array([1.3])),
    "one, beyond the period": lambda: Patches(np.array([3.0]), np.array([8.5])),
    "near merging": near_merging,
    "near vanishing": near_vanishing,
    "sixty": lambda: random_patches(60, 3),
    "three hundred": lambda: random_patches(300, 4, 0.2),
}


@pytest.fixture(params=PATCHES, ids=str, scope="module")
def posed(request):
    """What the kernels are given, made by the references: of some patches at a tolerance, with a cut in two halves."""
    patches, reference = PATCHES[request.param](), SimpleNamespace(**kernels.REFERENCES)
    resolution = collocation.resolve(Elastic(ROUGH), patches, 1e-4)
    coupled, sampling = chebyshev.by_modes(resolution.modes), chebyshev.by_nodes(resolution.nodes)
    series = reference.sampled_series(ROUGH, patches, sampling)
    x, force, at_edges = reference.skeleton_columns(patches, coupled, series)
    skeleton = hierarchical.Skeleton(patches, coupled, x, at_edges, force, None)
    shared = np.stack([force, np.ones(x.size)], axis=1)
    return SimpleNamespace(
        patches=patches, reference=reference, sampling=sampling, coupled=coupled, series=series, skeleton=skeleton,
        shared=shared, resolution=resolution,
    )  # fmt: skip


def check(found, expected):
    """Whether arrays agree to rounding of the largest entry."""
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() <= ROUNDING * np.abs(expected).max()


@pytest.mark.parametrize("points", [1, 40, 1000])
def test_profile(points):
    x = np.random.default_rng(1).uniform(-7, 15, points)
    given = ROUGH._table, x, ROUGH._table.shape[0] / TWO_PI, 2
    for found, expected in zip(CORE.taylor(*given), kernels.REFERENCES["taylor"](*given), strict=True):
        check(found, expected)


def test_series_on_the_patches(posed):
    found = CORE.sampled_series(ROUGH, posed.patches, posed.sampling)
    check(found, posed.series)


def test_columns_of_the_coupled_modes(posed):
    found = CORE.skeleton_columns(posed.patches, posed.coupled, posed.series)
    for one, other in zip(found, (posed.skeleton.x, posed.skeleton.force, posed.skeleton.at_edges), strict=True):
        check(one, other)


@pytest.mark.parametrize("layered", [False, True], ids=["half-space", "layer"])
def test_leaf(posed, layered):
    addition = LAYER.matrix(posed.skeleton.x) if layered else None
    given = posed.skeleton, 0, posed.patches.count, posed.shared, addition, hierarchical.UNIFORM
    found, expected = CORE.solved_leaf(*given), posed.reference.solved_leaf(*given)
    check(found[0], expected[0])
    check(np.tril(found[1]), np.tril(expected[1]))
    check(found[2], expected[2])


def test_matrix_that_is_not_positive_definite(posed):
    given = posed.skeleton, 0, posed.patches.count, posed.shared, None, -100.0
    assert CORE.solved_leaf(*given) is None
    assert posed.reference.solved_leaf(*given) is None


@pytest.mark.parametrize("posed", ["near merging", "near vanishing", "sixty", "three hundred"], indirect=True)
def test_two_clusters(posed):
    patches, skeleton, count = posed.patches, posed.skeleton, posed.patches.count
    middle = count // 2
    beta = patches.right[middle - 1] + patches.gap_after[middle - 1] / 2
    delta = patches.right[-1] + patches.gap_after[-1] / 2
    kernel = separated_kernel(skeleton.x, beta, delta, 1e-12)
    wider, split = np.concatenate([posed.shared, kernel.columns], axis=1), posed.coupled.starts[middle]
    leaf, core = posed.reference.solved_leaf, -kernel.core + np.diag(np.arange(kernel.core.shape[0]) == 1) * 0.03
    first = leaf(skeleton, 0, middle, wider[:split], None, hierarchical.UNIFORM)[0]
    second = leaf(skeleton, middle, count, np.ascontiguousarray(wider[split:]), None, hierarchical.UNIFORM)[0]
    given = np.ascontiguousarray(first), np.ascontiguousarray(second), core, 2
    for found, expected in zip(CORE.joined_gram(*given), posed.reference.joined_gram(*given), strict=True):
        check(found, expected)
    assert CORE.joined_gram(*given[:2], 100 * core, 2) is None
    assert posed.reference.joined_gram(*given[:2], 100 * core, 2) is None


def test_derivatives_of_the_stress_intensities(posed):
    state = collocation.evaluate(Elastic(ROUGH), posed.patches, 1.0, 1e-6)
    check(
        CORE.stress_intensity_jacobian(state),
        kernels.REFERENCES[sensitivities.stress_intensity_jacobian.__name__](state),
    )


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: CORE.taylor(ROUGH._table, np.zeros(3)),
        lambda: CORE.taylor(ROUGH._table, np.zeros(3, dtype=np.float32), 1.0, 0),
        lambda: CORE.taylor(ROUGH._table, np.zeros(6)[::2], 1.0, 0),
        lambda: CORE.taylor(ROUGH._table, np.zeros(3), 1.0, 3),
        lambda: CORE.stress_intensity_jacobian(None),
    ],
    ids=["too few", "of another type", "not contiguous", "order too high", "no state"],
)
def test_arguments_that_a_kernel_cannot_take(wrong):
    with pytest.raises((TypeError, ValueError, AttributeError)):
        wrong()


def in_use(asked):
    """Kernels that a new process uses, and what it prints about errors."""
    code = "from bem.compiled import kernels; print(kernels.IN_USE)"
    environment = os.environ | {kernels.VARIABLE: asked}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=False)
    return done.stdout.strip(), done.stderr


def test_the_environment_chooses():
    assert in_use("numpy")[0] == "NumPy"
    assert in_use("compiled")[0] == in_use("")[0] == "compiled"
    assert "LINECONTACT_KERNELS: 'fast' must be numpy, compiled or empty" in in_use("fast")[1]
