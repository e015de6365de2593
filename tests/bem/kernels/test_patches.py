"""Right-hand sides, charges and sizes of patches: evaluated back at random points, and by their formulas."""

import numpy as np
import pytest
from numpy.polynomial.chebyshev import chebval
from rough_surfaces import bearing_cut, rough_profile

from bem.elastic.collocation import Elastic, Resolution, resolve, right_hand_sides
from bem.geometry.patches import Patches
from bem.kernels import patches as kernels

ROUGH = rough_profile(60, 1, 0.7).scaled()
LEVEL = 0.7


def cosines(x):
    return np.cos(np.multiply.outer(x, ROUGH.orders) + ROUGH.phases) @ ROUGH.amplitudes


@pytest.fixture(scope="module", params=["rough contact", "one patch of 300 nodes"])
def posed(request):
    if request.param == "rough contact":
        patches, _ = bearing_cut(ROUGH, 0.3)
        resolution = resolve(Elastic(ROUGH), patches, 1e-6)
    else:
        patches, resolution = Patches(np.array([3.0]), np.array([8.5])), Resolution(np.array([300]), np.array([40]))
    return patches, resolution, right_hand_sides(ROUGH, patches, LEVEL, resolution)


def test_series_evaluated_back_at_random_points_is_the_profile(posed):
    patches, resolution, (series, *_) = posed
    t = np.random.default_rng(1).uniform(-1, 1, 50)
    for i, size in enumerate(resolution.nodes):
        expected = np.pi * (LEVEL - cosines(patches.center[i] + patches.half_width[i] * t))
        np.testing.assert_allclose(chebval(t, series[i, :size]), expected, rtol=0, atol=1e-10)
        assert not np.any(series[i, size:])


def test_columns_and_tails_are_sums_of_the_series(posed):
    patches, resolution, (series, x, columns, tail, energy) = posed
    first, expected_energy, order = 0, 0.0, np.arange(series.shape[1])
    for i, modes in enumerate(resolution.modes.tolist()):
        t = np.cos((np.arange(modes) + 0.5) * np.pi / modes)
        rows = slice(first, first + modes)
        np.testing.assert_allclose(x[rows], patches.center[i] + patches.half_width[i] * t, rtol=0, atol=1e-14)
        np.testing.assert_allclose(columns[0, rows], chebval(t, series[i, :modes]), rtol=0, atol=1e-12)
        rest = np.where(order < modes, 0.0, series[i])
        for side, sign in enumerate((-1.0, 1.0)):
            terms = order * rest * sign**order / np.pi
            found = tail[:, i + side * patches.count]
            assert found[0] == pytest.approx(terms.sum(), abs=1e-14 * np.abs(terms).sum())
            assert found[1] == pytest.approx(-(order**2 * terms).sum(), abs=1e-14 * np.abs(order**2 * terms).sum())
        expected_energy += float(order @ rest**2)
        first += modes
    assert np.all(columns[1] == 1)
    assert energy == pytest.approx(expected_energy, rel=1e-12)


@pytest.mark.parametrize("width", [1e-3, 1e-7, 1e-11])
def test_a_narrow_patch_keeps_the_digits_of_its_slope(width):
    """h(x + d) - h(x) = -2 sum h_m sin(m d / 2) sin(m (x + d / 2) + phi_m), without cancellation."""
    patch = Patches(np.array([1.0]), np.array([1.0 + width]))
    series, *_ = right_hand_sides(ROUGH, patch, LEVEL, resolve(Elastic(ROUGH), patch, 1e-4))
    t = np.linspace(-1, 1, 11)
    step = patch.half_width[0] * t[:, None]
    angle = ROUGH.orders * (patch.center[0] + step / 2) + ROUGH.phases
    rise = -2 * (np.sin(ROUGH.orders * step / 2) * np.sin(angle)) @ ROUGH.amplitudes
    found = chebval(t, np.append(0.0, series[0, 1:])) - chebval(0.0, np.append(0.0, series[0, 1:]))
    np.testing.assert_allclose(found, -np.pi * rise, rtol=0, atol=1e-12 * np.abs(rise).max())


def test_charges_evaluated_back_at_the_nodes_are_the_nodal_charges(posed):
    _, resolution, (series, x, *_) = posed
    skeleton = np.random.default_rng(1).normal(size=x.size)
    tables = [packed(modes) for modes in resolution.modes.tolist()]
    at = np.cumsum([0, *(table.size for table in tables[:-1])])
    charges = kernels.all_charges(resolution.modes, np.concatenate(tables), at, series, skeleton)
    first = 0
    for i, modes in enumerate(resolution.modes.tolist()):
        t = np.cos((np.arange(modes) + 0.5) * np.pi / modes)
        nodal = np.pi / modes * chebval(t, charges[i, :modes])
        np.testing.assert_allclose(nodal, skeleton[first : first + modes], rtol=0, atol=1e-13)
        order = np.arange(modes, series.shape[1])
        np.testing.assert_allclose(charges[i, modes:], -order * series[i, modes:] / np.pi, rtol=1e-14)
        first += modes


def packed(modes):
    """Table whose part of polynomial values alone is known."""
    angle = (np.arange(modes) + 0.5) * np.pi / modes
    table = np.full(5 * modes + 2 * modes**2, np.nan)
    table[5 * modes : 5 * modes + modes**2] = np.cos(np.outer(angle, np.arange(modes))).ravel()
    return table


@pytest.mark.parametrize("tolerance", [1e-3, 1e-10])
def test_sizes_are_the_next_ones_of_their_ladders(tolerance):
    patches, _ = bearing_cut(ROUGH, 0.3)
    ladder = np.arange(4, 4000)
    least = np.linspace(0, 20, patches.count)
    nodes, modes = kernels.sizes(patches.left, patches.right, tolerance, 60.0, least, ladder, ladder)
    z = 2 * np.minimum(patches.gap_after, np.roll(patches.gap_after, 1)) / patches.width
    rho = 1 + z + np.sqrt(z * (2 + z))
    wanted = np.maximum(np.log(1 / tolerance) / np.log(rho) + 2, least)
    np.testing.assert_array_equal(modes, np.ceil(wanted - 1e-9).clip(4))
    kappa = patches.width * 60 / 2
    wanted = np.maximum(1.15 * kappa + 3 * kappa ** (1 / 3) + 12, modes + 4)
    np.testing.assert_array_equal(nodes, np.ceil(wanted - 1e-9))


def test_patches_that_overlap_have_no_sizes():
    with pytest.raises(ValueError, match="patches that overlap"):
        kernels.sizes(np.array([0.0, 1.0]), np.array([1.5, 2.0]), 1e-3, 60.0, np.zeros(2), *[np.arange(4, 400)] * 2)
