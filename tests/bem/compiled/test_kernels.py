"""The kernels in C say what the functions in NumPy say that they mirror, to rounding."""

import os
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bem.adhesive.adhesion import true_length
from bem.compiled import kernels
from bem.elastic import collocation, gap, hierarchical, sensitivities, separated_kernel
from bem.elastic.collocation import Elastic
from bem.elastic.kernel_series import kernel_series
from bem.elastic.layer import LayerEffect
from bem.elastic.skeleton import Coupling, Skeleton
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
    "one hundred and sixty": lambda: random_patches(160, 4, 0.2),
}


@pytest.fixture(params=PATCHES, ids=str, scope="module")
def posed(request):
    """What the kernels are given, made by the references: of some patches at a tolerance, with a cut in two halves."""
    patches, reference = PATCHES[request.param](), SimpleNamespace(**kernels.REFERENCES)
    resolution = collocation.resolve(Elastic(ROUGH), patches, 1e-4)
    sides = reference.right_hand_sides(ROUGH, patches, 0.7, resolution)
    columns = np.concatenate([sides[2], [np.cos(sides[1])]])
    skeleton = Skeleton(patches, resolution.modes, sides[1], columns, None)
    return SimpleNamespace(
        patches=patches, reference=reference, sides=sides, skeleton=skeleton, resolution=resolution,
    )  # fmt: skip


def check(found, expected):
    """Whether arrays agree to rounding of the largest entry."""
    assert found.shape == expected.shape
    assert np.abs(found - expected).max(initial=0.0) <= ROUNDING * np.abs(expected).max(initial=0.0)


@pytest.mark.parametrize("points", [1, 40, 1000])
def test_profile(points):
    x = np.random.default_rng(1).uniform(-7, 15, points)
    given = ROUGH._table, x, ROUGH._table.shape[0] / TWO_PI, 2
    for found, expected in zip(CORE.taylor(*given), kernels.REFERENCES["taylor"](*given), strict=True):
        check(found, expected)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-10])
def test_nodes_and_modes_of_the_patches(posed, tolerance):
    given = posed.patches, tolerance, 400, np.linspace(0.0, 20.0, posed.patches.count)
    for found, expected in zip(CORE.sizes(*given), posed.reference.sizes(*given), strict=True):
        assert found.dtype == np.int64
        np.testing.assert_array_equal(found, expected)


def test_right_hand_sides(posed):
    *found, tail, energy = CORE.right_hand_sides(ROUGH, posed.patches, 0.7, posed.resolution)
    for one, expected in zip(found, posed.sides, strict=False):
        check(one, expected)
    expected, expected_energy = collocation.uncoupled(
        found[0], posed.resolution.modes
    )  # of the same series: factors n^3
    terms = np.abs(collocation.uncoupled(np.abs(found[0]), posed.resolution.modes)[0]).max()
    assert np.abs(tail - expected).max() <= 1e-14 * terms  # measured 2e-16
    assert energy == pytest.approx(expected_energy, rel=ROUNDING)


def test_right_hand_sides_of_a_narrow_patch_beyond_their_mean():
    patch = Patches(np.array([1.0]), np.array([1.0 + 1e-7]))
    given = ROUGH, patch, 0.7, collocation.resolve(Elastic(ROUGH), patch, 1e-4)
    found, expected = (sides(*given)[0][:, 1:] for sides in (CORE.right_hand_sides, collocation.right_hand_sides))
    check(found, expected)


@pytest.mark.parametrize("edge_columns", [0, 2, 4], ids=["", "edges", "slopes"])
@pytest.mark.parametrize(
    ("layered", "largest"), [(False, 10**9), (False, 110), (False, 30), (True, 30)],
    ids=["one leaf", "split", "split often", "layer"],
)  # fmt: skip
def test_system_of_all_patches(posed, layered, largest, edge_columns):
    coupling = LAYER.coupling(posed.skeleton.x, posed.patches, posed.resolution.modes, 1e-4, False) if layered else None
    given = (
        replace(posed.skeleton, coupling=coupling, edge_columns=edge_columns),
        hierarchical.Splitting(1e-12, largest, 0.03),
    )
    *found, at_edges, slopes = CORE.solved(*given)
    for one, expected in zip(found, posed.reference.solved(*given), strict=False):
        check(one, expected)
    for one, expected in zip((at_edges, slopes), posed.skeleton.at_edges_of(found[-1]), strict=True):
        check(one, expected)  # of the charges found: factors n^2 of their rounding


def refused(skeleton, splitting, reference):
    """Whether kernel and reference both find that the matrix is not positive definite."""
    return CORE.solved(skeleton, splitting) is None and reference.solved(skeleton, splitting) is None


def test_leaf_that_is_not_positive_definite(posed):
    assert refused(posed.skeleton, hierarchical.Splitting(1e-12, 110, -100.0), posed.reference)


def test_matrix_that_a_uniform_charge_alone_keeps_positive_definite(posed):
    gram = posed.reference.solved(posed.skeleton, hierarchical.Splitting(1e-12, 10**9, 0.03))[2]
    size = posed.skeleton.x.size
    beyond = replace(posed.skeleton, coupling=Coupling(np.full((size, size), 1.01 / gram[1, 1]), None))
    assert refused(beyond, hierarchical.Splitting(1e-12, 110, 2.02 / gram[1, 1]), posed.reference)


@pytest.mark.parametrize("posed", ["sixty", "one hundred and sixty"], indirect=True)
def test_clusters_that_are_not_positive_definite_together(posed, monkeypatch):
    original, splitting = separated_kernel.modes_and_core, hierarchical.Splitting(1e-12, 110, 0.03)

    def too_strong(steps, accuracy):
        modes, even, core = original(steps, accuracy)
        return modes, even, 100 * core

    monkeypatch.setattr(separated_kernel, "modes_and_core", too_strong)
    assert refused(posed.skeleton, splitting, posed.reference)


def test_derivatives_of_the_stress_intensities(posed):
    state = collocation.evaluate(Elastic(ROUGH), posed.patches, 1.0, 1e-6)
    check(
        CORE.stress_intensity_jacobian(state),
        kernels.REFERENCES[sensitivities.stress_intensity_jacobian.__name__](state),
    )


def test_charges_of_all_modes(posed):
    given = posed.resolution.modes, posed.sides[0], np.random.default_rng(1).normal(size=posed.skeleton.x.size)
    check(CORE.all_charges(*given), posed.reference.all_charges(*given))


@pytest.mark.parametrize("points", [1, 300])
def test_potential_of_charges(points):
    random = np.random.default_rng(2)
    given = random.normal(size=(2, points)), random.normal(size=(2, 777)), random.normal(size=777)
    check(CORE.pair_by_pair(*given), kernels.REFERENCES["pair_by_pair"](*given))


@pytest.mark.parametrize("boxes", [4, 32])
def test_boxes_of_charges(boxes):
    random = np.random.default_rng(2)
    x, position = random.uniform(-7, 14, 1000), random.uniform(-7, 14, 333)
    charge, series = random.normal(size=333), random.normal(size=(boxes, 20))
    points = np.stack([np.sin(x / 2), np.cos(x / 2)]) * 2
    sources = np.stack([np.cos(position / 2), -np.sin(position / 2)])
    moments = position, charge, boxes
    potential = x, points, position, sources, charge, series
    check(CORE.box_moments(*moments), kernels.REFERENCES["box_moments"](*moments))
    check(CORE.box_potential(*potential), kernels.REFERENCES["box_potential"](*potential))


def test_logarithm():
    random = np.random.default_rng(6)
    x = np.concatenate([random.uniform(0.5, 2, 20_000), 10 ** random.uniform(-300, 300, 20_000)])
    found = CORE.pair_by_pair(np.stack([x, np.zeros(x.size)]), np.array([[1.0], [0.0]]), np.ones(1))
    assert np.abs(found / np.log(x) - 1).max() < 6e-16  # measured: 2.3e-16


def test_logarithm_of_nothing_and_of_what_is_no_number():
    chords = np.array([0.0, np.nan, np.inf, 1.0, -1e300, 5e-324])
    given = np.stack([chords, np.zeros(6)]), np.array([[1.0], [0.0]]), np.ones(1)
    found = CORE.pair_by_pair(*given)
    assert found[0] == found[5] == -np.inf  # numbers below the smallest normal one are as good as zero
    assert np.isnan(found[1])
    assert found[2] == np.inf
    assert found[3:5] == pytest.approx([0.0, np.log(1e300)], rel=2e-16)


def gap_of(patches):
    return gap.gap_field(Elastic(ROUGH), collocation.evaluate(Elastic(ROUGH), patches, 1.0, 1e-4))


def test_potential_of_the_patches_beside_a_gap(posed):
    field, random = gap_of(posed.patches), np.random.default_rng(3)
    which = random.integers(0, posed.patches.count, 100)
    apart = np.where(random.random(100) < 0.3, 1e-9, random.random(100))  # of the gap behind the patch
    x = posed.patches.right[which] + apart * posed.patches.gap_after[which]
    given = posed.patches, *field._charges, which, x
    check(CORE.near_patches(*given), posed.reference.near_patches(*given))


def test_potential_at_a_point_that_rounding_puts_into_the_patch():
    patch, charges, which = Patches(-np.ones(1), np.ones(1)), np.array([[1.0, 0.1, 0.4, 0.9]]), np.zeros(8, dtype=int)
    given = patch, collocation.Resolution(np.array([4]), np.array([2])), charges, np.ones(2)
    beside, reference = np.linspace(1.5, 3.0, 7), kernels.REFERENCES["near_patches"]
    for at_edge in (1.0, np.nextafter(1.0, 0.0)):
        found = CORE.near_patches(*given, which, np.append(at_edge, beside))
        check(found, reference(*given, which, np.append(at_edge, beside)))
        check(found[1:], reference(*given, which[1:], beside))


@pytest.mark.parametrize("threshold", [8.0, 100.0])
def test_low_points_of_the_gaps(posed, threshold, monkeypatch):
    asked = []
    monkeypatch.setattr(gap, "low_points", lambda *given: asked.append(given) or posed.reference.low_points(*given))
    gap.low_minima(gap_of(posed.patches), threshold)
    found, expected = CORE.low_points(*asked[0]), posed.reference.low_points(*asked[0])
    assert found.shape[0] > 0
    np.testing.assert_array_equal(found[:, 0], expected[:, 0])
    check(found, expected)


def test_true_length():
    x, length = np.random.default_rng(4).uniform(-20, 20, 500), true_length(ROUGH, 0.3)
    given = length.start, length.width, length.series, length.whole, x
    check(CORE.integral(*given), kernels.REFERENCES["integral"](*given))


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: CORE.taylor(ROUGH._table, np.zeros(3)),
        lambda: CORE.taylor(ROUGH._table, np.zeros(3, dtype=np.float32), 1.0, 0),
        lambda: CORE.taylor(ROUGH._table, np.zeros(6)[::2], 1.0, 0),
        lambda: CORE.taylor(ROUGH._table, np.zeros(3), 1.0, 4),
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


def test_an_extension_of_other_sources_is_not_taken(monkeypatch):
    monkeypatch.setattr(kernels, "import_module", lambda name: SimpleNamespace(INTERFACE="0"))
    assert kernels.compiled("") is None
    with pytest.raises(ImportError, match="built from other sources, install again"):
        kernels.compiled("compiled")
