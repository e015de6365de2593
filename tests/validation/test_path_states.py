"""States on the page of a run: fields solved again from edges are those that the solver stores."""

from dataclasses import replace

import numpy as np
import pytest
from rough_scene import ROUGH
from scipy.interpolate import CubicSpline

import bem
from validation.report.moving_path import moving_path
from validation.report.path_states import FEWEST, MOST, fields_of, path_of, positions, profile_of, shown_of, with_events

LAYER = {**ROUGH, "layer": {"thickness": 1e-3}, "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.45}}
DRY = {name: table for name, table in ROUGH.items() if name != "adhesion"}
INTERPOLATED = 5e-3  # of the rms height: displacements stored at some 100 points, interpolated linearly
DEEP = {"control": "mean_pressure", "targets": [1e3, 2.9e4, 1e6]}


@pytest.mark.parametrize(
    "scene",
    [ROUGH, LAYER, {**DRY, "loading": DEEP, "output": {"shapes": True}}],
    ids=["adhesive", "layer", "up to complete contact"],
)
def test_fields_are_those_that_a_run_stores(scene):
    result = bem.solve({**scene, "output": {"shapes": True}})
    profile, checked = profile_of(result), 0
    for state in result.targets:
        fields = fields_of(result, profile, state)
        x, displacement, pressure = (
            result.fields[f"{name}_{state.stored}"] for name in ("x", "displacement", "pressure")
        )
        stored = np.interp(positions(profile), x, displacement, period=profile.period)
        assert fields.displacement == pytest.approx(stored, abs=INTERPOLATED * profile.rms_height)
        for (a, b), carried in zip(state.edges or [(0.0, 0.01)], fields.pressure, strict=bool(state.edges)):
            at = a + (b - a) * np.sin((np.arange(carried.size) + 0.5) * np.pi / (2 * carried.size)) ** 2
            inner = slice(carried.size // 3, -(carried.size // 3))
            near = (x - a) % profile.period
            known = np.isfinite(pressure) & (near <= b - a)
            order = np.argsort(near[known])
            place, bounded = near[known][order], pressure[known][order]
            if state.edges:  # pressure is singular at adhesive edges: its product with this root is smooth
                bounded = bounded * np.sqrt(place * (b - a - place))
            expected = CubicSpline(place, bounded)(at[inner] - a)
            if state.edges:
                expected = expected / np.sqrt((at[inner] - a) * (b - at[inner]))
            assert carried[inner] == pytest.approx(expected, abs=1e-3 * np.max(np.abs(expected)))
            checked += 1
    assert checked >= 3


def test_a_scan_is_drawn_from_its_stored_harmonics(tmp_path):
    surface = bem.parse_scene(ROUGH).surface()
    x = np.arange(256) * surface.period / 256
    np.savetxt(tmp_path / "scan.csv", np.column_stack([x, surface.height(x)]))
    profile = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", "harmonics": 8}
    result = bem.solve(bem.parse_scene({**ROUGH, "profile": profile, "loading": DEEP, "output": {}}, tmp_path))
    assert profile_of(result).height(x) == pytest.approx(surface.height(x), abs=1e-9)


def test_at_most_sixty_states_are_shown_with_every_event_and_both_ends_of_the_largest_jumps():
    profile = ROUGH["profile"] | {"harmonics": 30}
    loading = {"control": "separation", "targets": [5e-6, 9e-4]}
    result = bem.solve({**ROUGH, "profile": profile, "loading": loading, "output": {}})
    path = path_of(result)
    shown = shown_of(path)
    points = list(with_events(path, shown))
    assert FEWEST < len(shown) <= MOST < len(path)
    assert {0, len(path) - 1} <= set(shown)
    assert tuple(event for point in points for event in point.events) == result.events
    largest = max(range(len(path)), key=lambda k: sum(event.energy_released or 0.0 for event in path[k].events))
    assert path[largest].jump == "after"
    assert {largest - 1, largest} <= set(shown)


def test_a_large_contact_shows_fewer_states():
    path = path_of(bem.solve(ROUGH))
    large = [replace(point, state=replace(point.state, unknowns=50_000), jump="") for point in path]
    assert len(shown_of(large)) == FEWEST < len(shown_of(path))


def test_digits_follow_the_estimated_errors():
    result = bem.solve(ROUGH)
    known = moving_path(result)["states"]
    rough = [
        replace(state, error_estimate=replace(state.error_estimate, mean_pressure=abs(0.05 * state.mean_pressure)))
        for state in result.states
    ]
    doubtful = moving_path(replace(result, states=tuple(rough)))["states"]
    place = next(k for k, row in enumerate(known) if row["contacts"] == "2" and not row["words"])
    precise, vague = (rows[place]["mean_pressure"].replace(".", "") for rows in (known, doubtful))
    assert (len(precise), len(vague.rstrip("0"))) == (4, 2)


def test_complete_contact_has_no_gap_and_is_no_number_of_contacts():
    result = bem.solve({**DRY, "loading": DEEP, "output": {}})
    last = moving_path(result)["states"][-1]
    assert (last["separation"], last["contact_fraction"], last["open"], last["contacts"]) == (
        "0",
        "1.000",
        "–",
        "complete",
    )


def test_loads_in_complete_contact_behind_a_jump_are_states_of_their_own():
    targets = [1e3, 3e4, 3e5, 1e5]
    result = bem.solve({**ROUGH, "loading": {"control": "mean_pressure", "targets": targets}, "output": {}})
    path = path_of(result)
    complete = [point.state.mean_pressure for point in path if point.state.status == "complete_contact"]
    assert [point.state.mean_pressure for point in path if point.state.target] == pytest.approx(targets)
    assert len(complete) > 2 and complete[-2:] == pytest.approx(targets[-2:])
    assert path[[point.state.status for point in path].index("complete_contact")].jump == "after"
