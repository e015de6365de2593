"""Which scenes are followed in leaps."""

import pytest
from scene_tables import rough, tables, waves

from bem.scene.scene import parse_scene

ROUGH = rough(12, 1)
WAVES = waves([], [5e-5, 1e-5], [0.0, 0.3])


def scene(profile=ROUGH, tolerance=1e-3, control="separation", target=3e-5):
    return parse_scene(tables(profile, control, [target], 0.03, accuracy={"tolerance": tolerance}))


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_few_digits_of_a_rough_profile_are_found_in_leaps(tolerance):
    assert scene(tolerance=tolerance).leaps
    assert scene(WAVES | {"orders": [2, 3]}, tolerance).leaps


def test_many_digits_a_load_that_is_held_and_a_profile_that_repeats_are_not():
    """What breaks the symmetry of equal parts would be decided by the end of a leap."""
    assert not scene(tolerance=1e-5).leaps
    assert not scene(control="mean_pressure", target=1e3).leaps
    assert not scene(WAVES | {"orders": [4, 6]}).leaps
    for nothing in (0.0, 1e-19):
        assert not scene(WAVES | {"orders": [4, 6, 9], "amplitudes": [5e-5, 1e-5, nothing], "phases": [0, 0, 0]}).leaps
