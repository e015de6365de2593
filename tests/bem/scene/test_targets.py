"""Ranges of targets, where a path begins, and which way it goes."""

import math

import pytest

from bem.scene.targets import expanded, origin, unloads


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
