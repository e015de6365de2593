"""Contact patches on the circle: order, gaps, and what moving, adding, removing and joining does to them."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from bem.geometry.patches import TWO_PI, Patches, PatchPressure, ordered


@st.composite
def patch_sets(draw, least=1):
    """Disjoint patches in order, the last one possibly across 2 pi."""
    lengths = draw(st.lists(st.floats(0.05, 1.0), min_size=2 * least, max_size=16).filter(lambda x: len(x) % 2 == 0))
    start = draw(st.floats(0.0, 1.0)) * lengths[-1]
    points = start + np.concatenate([[0.0], np.cumsum(lengths)[:-1]]) * (TWO_PI / np.sum(lengths))
    assume(points[-2] < TWO_PI)
    return Patches(points[0::2], points[1::2])


@given(patches=patch_sets())
def test_patches_and_gaps_fill_the_period(patches):
    assert np.sum(patches.width) + np.sum(patches.gap_after) == pytest.approx(TWO_PI, rel=1e-14)
    assert patches.contact_fraction == pytest.approx(np.sum(patches.width) / TWO_PI)
    np.testing.assert_array_equal(np.roll(patches.gap_after, 1), patches.gap_before)
    assert patches.is_ordered


@given(patches=patch_sets(), turns=st.integers(-2, 2), cut=st.integers(0, 7))
def test_order_does_not_depend_on_where_counting_starts(patches, turns, cut):
    cut %= patches.count
    left = np.roll(patches.left, cut) + turns * TWO_PI
    found = ordered(left, np.roll(patches.right, cut) + turns * TWO_PI)
    np.testing.assert_allclose(found.left, patches.left, atol=1e-14)
    np.testing.assert_allclose(found.right, patches.right, atol=1e-14)


@pytest.mark.parametrize("left", [TWO_PI, -TWO_PI, -1e-9, 0.0, 5 * TWO_PI, -1e-17])
def test_left_edges_lie_in_the_period(left):
    assert 0 <= ordered(np.array([left]), np.array([left + 0.1])).left[0] < TWO_PI


@given(patches=patch_sets(), amount=st.floats(-0.4, 0.4))
def test_moving_every_edge_outward_widens_all_patches(patches, amount):
    step = amount * patches.edge_scale
    moved = patches.moved(step)
    np.testing.assert_allclose(moved.width - patches.width, step[: patches.count] + step[patches.count :], atol=1e-14)
    assert moved.is_ordered


@given(patches=patch_sets(), index=st.integers(0, 7), place=st.floats(0.1, 0.9), size=st.floats(0.01, 0.09))
def test_new_patch_takes_its_place_and_leaves_the_others(patches, index, place, size):
    index %= patches.count
    gap = patches.gap_after[index]
    position = patches.right[index] + place * gap
    more = patches.with_patch(position - size * gap, position + size * gap)
    assert more.count == patches.count + 1
    assert more.is_ordered
    new = int(np.argmin(np.abs((more.center - position + np.pi) % TWO_PI - np.pi)))
    others = Patches(np.delete(more.left, new), np.delete(more.right, new)).canonical()
    np.testing.assert_allclose(others.left, patches.left, atol=1e-14)


@given(patches=patch_sets(least=2), index=st.integers(0, 7))
def test_merging_closes_one_gap_and_no_other(patches, index):
    assume(patches.count >= 2)
    index %= patches.count
    merged = patches.merged_after(index)
    assert merged.count == patches.count - 1
    gained = np.sum(merged.width) - np.sum(patches.width)
    assert gained == pytest.approx(patches.gap_after[index], abs=1e-13)
    remaining = np.sort(np.delete(patches.gap_after, index))
    np.testing.assert_allclose(np.sort(merged.gap_after), remaining, atol=1e-13)


def test_single_patch_has_nothing_to_merge_with():
    with pytest.raises(ValueError, match="complete contact"):
        Patches(np.array([0.0]), np.array([6.0])).merged_after(0)


@pytest.mark.parametrize(
    ("left", "right"),
    [([0.0, 1.0], [1.0, 2.0]), ([0.0, 1.0], [0.5, 1.0]), ([0.5], [0.5 + TWO_PI])],
    ids=["no gap", "no width", "whole period"],
)
def test_degenerate_patches_are_not_in_order(left, right):
    assert not Patches(np.array(left), np.array(right)).is_ordered


def test_room_of_an_edge_is_the_smaller_of_patch_and_gap():
    patches = Patches(np.array([1.0, 2.0]), np.array([1.5, 5.0]))
    expected = [0.5, 0.5, 0.5, TWO_PI + 1.0 - 5.0]
    np.testing.assert_allclose(patches.edge_scale, expected, rtol=1e-14)


def test_load_is_the_sum_of_the_mean_charges():
    """A flat punch sigma = 1 / sqrt(r^2 - x^2) carries pi; odd and higher terms carry nothing."""
    pressure = PatchPressure(np.array([0.0, 2.0]), np.array([1.0, 3.0]), (np.array([1.0, 5.0]), np.array([0.5, 0, 7])))
    assert pressure.load == pytest.approx(1.5 * np.pi, rel=1e-15)
