"""Curves of a run: jumps as jumps, states that are nothing alike not joined, the theory, distributions."""

from itertools import pairwise

import numpy as np
import pytest
from rough_scene import ROUGH

import bem
import persson
from validation.report.path_states import joins_of, path_of
from validation.report.run_figures import area_of, distributions_of, lines_of, theories_of

PRESSED = {
    **{name: table for name, table in ROUGH.items() if name != "adhesion"},
    "profile": ROUGH["profile"] | {"harmonics": 100},
    "loading": {"control": "mean_pressure", "targets": [2e3, 1e4]},
    "output": {"pressure_distribution": [1e4]},
}


@pytest.fixture(scope="module")
def adhesive():
    return bem.solve(ROUGH)


@pytest.fixture(scope="module")
def pressed():
    return bem.solve(PRESSED)


def series_of(result, figure):
    return {
        one.label: one
        for found in area_of(result, theories_of(result))
        if found.id == figure
        for one in found.solution.series
    }


def test_branches_end_where_the_contact_jumps(adhesive):
    lines = lines_of(path_of(adhesive))
    jumps = [tuple(lines["jumps"][k + 1 : k + 3]) for k in range(0, len(lines["jumps"]), 3)]
    known = [[(share(end), end.mean_pressure) for end in (event.before, event.after)] for event in adhesive.events]
    assert np.array(jumps) == pytest.approx(np.array(known), rel=1e-6)
    for name in ("loading", "unloading"):
        assert not set(pairwise(lines[name])) & set(jumps)


def share(end):
    return sum(b - a for a, b in end.edges) / 0.01


def test_a_dead_tension_pulls_off_without_an_end_to_draw():
    pulled = bem.solve({**ROUGH, "loading": {"control": "mean_pressure", "targets": [1e3, -5e4]}, "output": {}})
    path = path_of(pulled)
    place = next(k for k, point in enumerate(path) if any(event.kind == "pull_off" for event in point.events))
    assert (path[place - 1].jump, path[place].state.status) == ("before", "separated")
    assert joins_of(path)[place] == "n"


def test_the_theory_is_that_of_its_package(pressed):
    plain, fitted = theories_of(pressed)
    spectrum = persson.DiscreteSpectrum.of_profile(bem.parse_scene(PRESSED).surface())
    given = {"youngs_modulus": 1e6, "poisson_ratio": 0.5}
    for theory, solve in ((plain, persson.solve), (fitted, persson.contact_area)):
        states = [solve(spectrum, load, **given) for load in (theory.loads[0], theory.loads[-1])]
        assert [theory.fractions[0], theory.fractions[-1]] == pytest.approx([s.contact_fraction for s in states])
    drawn = series_of(pressed, "area")
    assert {"Persson's theory", "fitted area"} <= set(drawn)


def test_a_layer_has_no_theory_beside_it():
    layer = {**PRESSED, "layer": {"thickness": 1e-3}, "output": {}, "loading": PRESSED["loading"] | {"targets": [1e3]}}
    assert theories_of(bem.solve(layer)) == []


def test_the_theory_of_a_scan_is_that_of_its_lines(tmp_path):
    surface = bem.parse_scene(PRESSED).surface()
    x = np.arange(256) * surface.period / 256
    np.savetxt(tmp_path / "scan.csv", np.column_stack([x, surface.height(x)]))
    profile = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", "harmonics": 100}
    scan = bem.solve(bem.parse_scene({**PRESSED, "profile": profile}, tmp_path))
    whole = theories_of(bem.solve(PRESSED))
    for one, other in zip(theories_of(scan), whole, strict=True):
        assert one.fractions == pytest.approx(other.fractions, rel=1e-6)


def test_complete_contact_under_a_given_separation_has_distributions_without_a_pressure():
    deepest = bem.parse_scene(ROUGH).surface().max_height
    loading = {"control": "penetration", "targets": [1e-5, deepest]}
    whole = bem.solve({**ROUGH, "loading": loading, "output": {"pressure_distribution": True}})
    (pressures,) = distributions_of(whole)
    assert pressures.solution.series[-1].label == "at complete contact, loading"


def test_distributions_that_were_asked_for_are_drawn(pressed, adhesive):
    (pressures,) = distributions_of(pressed)
    assert [series.label for series in pressures.solution.series] == ["at 10.0 kPa, loading"]
    assert list(distributions_of(adhesive)) == []


def test_no_line_joins_complete_contact_with_another_state():
    loading = {"control": "mean_pressure", "targets": [1e3, 1e6]}
    result = bem.solve({**PRESSED, "loading": loading, "output": {}})
    assert [state.status for state in result.targets] == ["converged", "complete_contact"]
    assert joins_of(path_of(result)) == "nn"


def test_complete_contact_alone_has_no_curves():
    loading = {"control": "mean_pressure", "targets": [1e6, 2e6], "initial": "complete_contact"}
    assert [*area_of(bem.solve({**PRESSED, "loading": loading, "output": {}}), [])] == []
