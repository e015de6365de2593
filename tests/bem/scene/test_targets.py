"""Targets merged into a path: exact cases, and what holds for any path."""

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bem.scene.targets import expanded, found, merged, origin, unloads

VALUES = st.integers(min_value=0, max_value=20).map(float)


@given(targets=st.lists(VALUES, min_size=1, max_size=6), extra=st.lists(VALUES, max_size=4))
def test_targets_keep_their_order(targets, extra):
    path, _ = merged(targets, extra, math.inf)
    rest = iter(path)
    assert all(target in rest for target in targets)


@given(targets=st.lists(VALUES, min_size=1, max_size=6), extra=st.lists(VALUES, max_size=4))
def test_extra_values_are_met_or_missed(targets, extra):
    path, missed = merged(targets, extra, math.inf)
    assert set(missed) == set(extra) - set(path)


@given(targets=st.lists(VALUES, min_size=1, max_size=6, unique=True), extra=st.lists(VALUES, max_size=4))
def test_merging_again_changes_nothing(targets, extra):
    path, _ = merged(targets, extra, math.inf)
    assert merged(path, set(extra) & set(path), math.inf) == (path, ())


@given(targets=st.lists(VALUES, min_size=1, max_size=6, unique=True), extra=st.lists(VALUES, max_size=4))
def test_extra_values_do_not_lengthen_the_way_between_targets(targets, extra):
    path, _ = merged(targets, extra, targets[0])
    within = path[: len(path) - path[::-1].index(targets[-1])]
    travelled = sum(abs(b - a) for a, b in itertools.pairwise(within))
    assert travelled == sum(abs(b - a) for a, b in itertools.pairwise(targets))


def test_range_ends_exactly_where_asked():
    assert expanded(0.1, 0.7, 7)[-1] == 0.7


@pytest.mark.parametrize(
    ("control", "initial", "begin"),
    [
        ("separation", "separated", math.inf),
        ("separation", "complete_contact", -math.inf),
        ("penetration", "separated", -math.inf),
        ("total_displacement", "complete_contact", math.inf),
        ("mean_pressure", "separated", 0.0),
        ("mean_pressure", "complete_contact", 7.0),
    ],
)
def test_origin_of_a_path(control, initial, begin):
    assert origin(control, initial, 7.0) == begin


@pytest.mark.parametrize("control", ["penetration", "mean_pressure", "total_displacement"])
def test_falling_control_unloads_but_for_separation(control):
    assert unloads(control, 2.0, 1.0) is not unloads("separation", 2.0, 1.0)


def test_no_target_is_found_in_an_empty_path():
    assert found(1.0, ()) is None
