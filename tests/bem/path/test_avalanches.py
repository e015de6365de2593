"""Events that were wrong once: an avalanche cut in two, crests that differ by 1e-10 of the height, event lists."""

import tomllib
from pathlib import Path

import pytest

from bem.scene.scene import parse_scene
from bem.solver import solve

CASES = Path(__file__).parent / "event_cases"


def solved(name, part=1.0):
    tables = tomllib.loads((CASES / f"{name}.toml").read_text("utf-8"))
    accuracy = tables.get("accuracy", {})
    accuracy["max_increment"] = accuracy.get("max_increment", 0.05) * part
    scene = parse_scene(tables | {"accuracy": accuracy})
    result = solve(scene)
    assert result.status == "converged"
    return result, scene.surface().rms_height


@pytest.mark.slow
def test_surfaces_that_would_overlap_apart_stay_in_contact():
    """Pull-off at a penetration, then a first touch at none that released -2.3e-8: it is one avalanche."""
    result, height = solved("negative-release")
    assert {event.kind for event in result.events}.isdisjoint({"pull_off"})
    assert [event.kind for event in result.events].count("first_touch") == 1
    assert min(event.energy_released for event in result.events) >= 0
    released = [event for event in result.events if event.energy_released > 1e-6]
    assert len(released) == 1
    assert released[0].penetration / height == pytest.approx(0.171087807704, abs=1e-9)
    assert released[0].energy_released == pytest.approx(1.23736165e-6, rel=1e-7)


def test_crests_that_differ_by_1e_10_touch_one_after_the_other():
    """As those that differ by 1e-9 do: together they released .18811 and left .0755 of the period in contact."""
    result, _ = solved("near-equal-crests")
    assert [event.kind for event in result.events] == ["first_touch", "new_contact"]
    assert result.targets[0].contact_fraction == pytest.approx(0.03892162517706, abs=1e-12)
    assert sum(event.energy_released for event in result.events) == pytest.approx(0.19273687572, rel=1e-9)


@pytest.mark.slow
def test_a_list_of_events_is_the_same_at_a_third_of_the_increment():
    coarse, fine = (solved("event-list", part)[0] for part in (1.0, 1 / 3))
    assert [event.kind for event in coarse.events] == [event.kind for event in fine.events]
    energies = [[event.energy_released for event in result.events] for result in (coarse, fine)]
    assert energies[0] == pytest.approx(energies[1], abs=1e-6 * max(energies[0]))
