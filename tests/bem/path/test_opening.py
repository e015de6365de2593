"""Complete contact opens at a flaw of any width: the closed form of a narrow one against evaluations of it."""

from dataclasses import replace

import numpy as np
import pytest
from rough_surfaces import rough_scene

from bem.adhesive.equilibrium import System, balance
from bem.adhesive.relaxation import fall
from bem.geometry.patches import TWO_PI
from bem.loading.complete_contact import complete_contact
from bem.loading.control import DisplacementControl
from bem.loading.increments import COARSE
from bem.path import opening
from bem.problem import pose
from bem.scene.scene import SceneError
from bem.solver import solve

LAYERS = {"half-space": {}, "layer": {"layer": {"thickness": 0.003}}, "thin layer": {"layer": {"thickness": 0.0005}}}
by_layer = pytest.mark.parametrize("layer", LAYERS)
by_harmonics = pytest.mark.parametrize("harmonics", [1, 60])


def flawed_scene(share, harmonics=10, targets=(2e5, -1e9), **changes):
    flaw = {"initial": "complete_contact", "flaw": share * 0.01}
    loading = {"control": "mean_pressure", "targets": list(targets), **flaw}
    return rough_scene([], harmonics=harmonics, loading=loading, accuracy={"max_increment": 5.0}, **changes)


def posed(harmonics, layer):
    scene = flawed_scene(1e-4, harmonics, **LAYERS[layer])
    problem = pose(scene)
    return System(problem.elastic, problem.law, problem.control), complete_contact(
        problem.profile, problem.law, problem.elastic.compliance
    )


def flaw_of(share, complete):
    return opening.Flaw(opening.lowest_pressure(complete), share * TWO_PI)


@by_layer
@by_harmonics
def test_load_of_a_narrow_flaw_is_that_of_its_evaluation(harmonics, layer, monkeypatch):
    system, complete = posed(harmonics, layer)
    flaw = flaw_of(5e-5, complete)
    found = opening.opening_load(system, complete, flaw, 1e-8)
    monkeypatch.setattr(opening, "RESOLVED_GAP", 0.0)
    evaluated = opening.opening_load(system, complete, flaw, 1e-8)
    assert found == pytest.approx(evaluated, rel=2e-8)  # measured 6e-9


@by_layer
def test_layer_acts_by_the_square_of_the_width(layer, monkeypatch):
    """Below the finest gap that is evaluated."""
    system, complete = posed(10, layer)
    flaw = flaw_of(1e-4, complete)
    evaluated = opening.opening_load(system, complete, flaw, 1e-8)
    monkeypatch.setattr(opening, "RESOLVED_GAP", 2e-4 * TWO_PI)
    monkeypatch.setattr(opening, "FINEST_GAP", 2e-4 * TWO_PI)
    assert opening.opening_load(system, complete, flaw, 1e-8) == pytest.approx(evaluated, rel=2e-8)  # measured 8e-9


@by_harmonics
def test_a_narrow_flaw_costs_half_of_its_work_of_adhesion(harmonics):
    system, complete = posed(harmonics, "half-space")
    flaw = flaw_of(3e-5, complete)
    load = opening.opening_load(system, complete, flaw, 1e-8)
    gap = opening.with_gap(flaw.center, flaw.width)
    here = balance(system, gap, system.elastic.profile.max_height, load, 1e-10)
    found = opening.flawed_potential(system, complete, flaw, load, 1e-10)
    costs = here.potential - opening.complete_potential(system, complete, load)
    assert found - here.potential == pytest.approx(0, abs=1e-3 * costs)


def test_a_flaw_opens_to_the_same_state_as_one_that_is_evaluated(monkeypatch):
    targets = (2e5, 1e4)
    scene = flawed_scene(9e-5, 60, targets=targets, adhesion=1e-3)
    found = solve(scene)
    monkeypatch.setattr(opening, "RESOLVED_GAP", 0.0)
    evaluated = solve(scene)
    assert found.targets[-1].n_patches > 0
    assert found.targets[-1].contact_fraction == pytest.approx(evaluated.targets[-1].contact_fraction, abs=1e-10)
    first, other = found.events[0], evaluated.events[0]
    assert first.mean_pressure == pytest.approx(other.mean_pressure, rel=1e-7)
    assert first.energy_released == pytest.approx(other.energy_released, rel=1e-6)


QUICK_FLAWS = {(1e-9, "half-space"), (1e-2, "layer"), (1e-2, "thin layer")}


@pytest.mark.parametrize(
    ("share", "layer"),
    [
        pytest.param(share, layer, marks=() if (share, layer) in QUICK_FLAWS else pytest.mark.slow)
        for share in (1e-9, 3e-7, 1e-6, 3e-5, 1e-2)
        for layer in LAYERS
    ],
)
def test_a_flaw_of_any_width_opens(share, layer):
    result = solve(flawed_scene(share, 4, **LAYERS[layer]))
    assert result.status == "unreachable"  # the tension of the target: nothing carries it once the flaw has opened
    assert result.events[0].kind == "opening"


@pytest.mark.parametrize("share", [9e-13, 0.96])
def test_another_flaw_is_refused_with_what_is_allowed(share):
    with pytest.raises(SceneError, match=r"loading.flaw = .*; allowed: a number from 1e-14 to 0.0095 \(m\)"):
        flawed_scene(share)


@by_layer
@pytest.mark.parametrize("share", [1e-3, 1e-2])
def test_a_flaw_opens_at_both_edges_at_once(share, layer):
    """Where the pressure is lowest one edge would open and the other heal."""
    system, complete = posed(60, layer)
    flaw = opening.flaw_of(system, complete, share * TWO_PI, 1e-8)
    behind, before = opening._critical_loads(system, complete, flaw, 1e-8)
    assert behind == pytest.approx(before, rel=1e-5)
    assert abs(flaw.center - opening.lowest_pressure(complete)) < flaw.width / 4  # measured .13


@pytest.mark.parametrize(("share", "layer"), [(0.95, "thin layer"), (0.5, "half-space")], ids=["at an edge", "crest"])
def test_a_flaw_that_the_pressure_shuts_in_part_is_refused(share, layer):
    with pytest.raises(SceneError, match=rf"loading.flaw = {share / 100:g}: the pressure would hold a part"):
        solve(flawed_scene(share, **LAYERS[layer]))


@by_layer
def test_what_rounding_leaves_of_the_load_at_which_a_flaw_opens_is_in_its_error(layer):
    """Eight flaws that differ by roundings: their loads are apart by a part of 100 to 700 of the bound."""
    system, complete = posed(10, layer)
    flaw = flaw_of(1e-3, complete)
    near = [opening.Flaw(flaw.center, flaw.width * (1 + k * 1e-14)) for k in range(8)]
    spread = np.ptp([opening.opening_load(system, complete, one, 1e-8) for one in near])
    assert spread <= opening.opening_rounding(system, flaw, 1e-8)
    event = solve(flawed_scene(1e-3, targets=(2e5, 1e2), **LAYERS[layer])).events[0]
    assert event.error_estimate.mean_pressure > 1e-11 * abs(event.mean_pressure)


def test_surfaces_part_at_any_increment():
    """A smallest increment off, paths began in gaps 2 and 15 of the shortest waves wide; the second ended there.

    An event that releases 1.9e-6 J/m2 takes an increment of less than a wave to be seen.
    """
    loading = {"control": "separation", "targets": [2e-6], "initial": "complete_contact"}
    found = [
        solve(rough_scene([], harmonics=250, seed=0, loading=loading, accuracy={"max_increment": largest}))
        for largest in (0.0125, 0.2)
    ]
    assert [result.status for result in found] == ["converged"] * 2
    fractions = [result.states[-1].contact_fraction for result in found]
    assert fractions[0] == pytest.approx(fractions[1], rel=1e-13)  # rounding: 3e-15, 4e-15 on other kernels
    kinds = [[event.kind for event in result.events] for result in found]
    assert kinds[0] == kinds[1] == ["opening", *["bifurcation"] * 12]
    released = [sum(event.energy_released for event in result.events) for result in found]
    assert released[0] == pytest.approx(released[1], rel=1e-11)  # measured 4.1e-12


def test_gap_of_a_row_of_cracks():
    """Uniform tension: K = T sqrt(2 pi tan(g/4)) for a row of cracks, T sqrt(pi g/2) for a short one."""
    _, complete = posed(1, "half-space")
    _, slope = opening._crack(complete, opening.Flaw(0.0, 1e-6))
    np.testing.assert_allclose(-slope * TWO_PI, np.sqrt(np.pi * 1e-6 / 2), rtol=1e-12)


def test_first_gap_is_as_wide_as_its_separation_asks():
    """Where the tension of complete contact is nothing beside that of so narrow a gap; measured 2e-4, 3e-4 at 1e-7."""
    system, complete = posed(10, "half-space")
    separation, start = opening.first_gap(system, complete, 1e-6)
    highest = system.elastic.profile.max_height
    relaxed = fall(
        replace(system, control=DisplacementControl()), start, highest - separation, highest - separation, COARSE
    )
    assert separation == 1e-6
    assert relaxed.balance.state.patches.gap_after == pytest.approx(start.gap_after, rel=1e-3)


def test_a_path_into_complete_contact_ends_where_one_gap_is_left():
    """A faint ripple makes the last gap snap again and again: the last increment is the smallest, however it opens."""
    wave = {"kind": "harmonics", "period": 0.01, "orders": [1, 300], "amplitudes": [50e-6, 1e-8], "phases": [0.0, 0.3]}
    loading = {"control": "separation", "targets": [1e-6, 0.0], "initial": "complete_contact"}
    result = solve(rough_scene([], adhesion=0.3, profile=wave, loading=loading))
    assert [state.status for state in result.targets] == ["converged", "complete_contact"]
