"""The field of patches outside a window, against the sum of their charges and against the solution of all patches."""

from dataclasses import replace

import numpy as np
import pytest
from rough_surfaces import bearing_cut, short_waved

from bem.elastic.collocation import Elastic, _coupled_outside, evaluate
from bem.elastic.far_field import Arc, Charges, far_fields
from bem.elastic.gap import gap_field, low_minima
from bem.elastic.hierarchical import IllConditionedSystemError
from bem.elastic.logarithmic_potential import LogarithmicPotential
from bem.geometry.patches import Patches
from bem.windows.spread import charges_moved_in, charges_of
from bem.windows.windows import windows_of

TOLERANCE = 1e-8


@pytest.fixture(scope="module")
def whole():
    """A state of many patches, and its windows with their far fields."""
    profile = short_waved()
    patches, penetration = bearing_cut(profile, 0.3)
    patches = patches.merged_at(patches.gap_after < 0.3 * np.median(patches.gap_after))
    elastic = Elastic(profile)
    state = evaluate(elastic, patches, penetration, TOLERANCE)
    windows = windows_of(patches)
    fields = far_fields([window.arc for window in windows], charges_of(state), charges_moved_in(state))
    return elastic, state, windows, fields


def at_edges(window, values):
    """The values at the edges of a window, from those at all edges."""
    return values.reshape(2, -1)[:, window.members].ravel()


def test_the_field_is_that_of_the_charges_outside():
    random = np.random.default_rng(1)
    position, charge = random.uniform(0, 2 * np.pi, 300), random.normal(size=(2, 300))
    arc = Arc(5.0, 7.5, (0.02, 0.05))  # across the end of the period
    beside = np.abs((position - 5.0 + np.pi) % (2 * np.pi) - np.pi) < 0.04
    beside |= np.abs((position - 7.5 + np.pi) % (2 * np.pi) - np.pi) < 0.1
    position, charge = position[~beside], charge[:, : (~beside).sum()]
    (field,) = far_fields([arc], *(Charges(position, q, p) for q, p in zip(charge, (1.0, 1.5), strict=True)))
    x, outside = np.linspace(5.03, 7.4, 200), ~arc.holds(position)
    for share, penetration in ((0.0, 1.0), (1.0, 1.5), (-1.0, 0.5)):
        at = charge[0] + share * (charge[1] - charge[0])
        wanted = LogarithmicPotential(position[outside], at[outside])(x)
        np.testing.assert_allclose(
            field.at(x, penetration)[0], wanted, atol=1.5e-10 * np.abs(at).sum()
        )  # measured 5e-11
    with pytest.raises(IllConditionedSystemError, match="window"):
        field.at(np.array([5.0001]), 1.0)


def test_patches_in_a_window_feel_those_outside_as_in_the_solution_of_all(whole):
    elastic, state, windows, fields = whole
    assert len(windows) >= 3
    for window, far in zip(windows, fields, strict=True):
        local = replace(elastic, far=far)
        for deeper in (0.0, 0.01):
            alone = evaluate(local, window.of(state.patches), state.penetration + deeper, TOLERANCE)
            wanted = at_edges(window, state.shifted(deeper).stress_intensity)
            error = np.abs(alone.stress_intensity - wanted) / np.abs(wanted).max()
            assert error.max() < 1.5e-7  # measured 5e-8
        np.testing.assert_allclose(
            alone.stress_intensity_rate, at_edges(window, state.stress_intensity_rate), rtol=3e-7
        )


def test_the_gap_of_a_window_is_that_of_all_and_its_outer_gap_is_not_searched(whole):
    elastic, state, windows, fields = whole
    everywhere = low_minima(gap_field(elastic, state), 10.0)
    for window, far in zip(windows, fields, strict=True):
        local = replace(elastic, far=far)
        patches = window.of(state.patches)
        found = low_minima(gap_field(local, evaluate(local, patches, state.penetration, TOLERANCE)), 10.0)
        inner = np.isin(everywhere.gap, window.members) & window.arc.holds(everywhere.position)
        last = window.members[far.arc.outer_gap(patches)]
        inner &= everywhere.gap != last
        assert sorted(found.position) == pytest.approx(sorted(everywhere.position[inner]), abs=1e-6)
        np.testing.assert_allclose(np.sort(found.depth), np.sort(everywhere.depth[inner]), atol=1e-7)


def test_the_load_of_a_window_is_the_derivative_of_its_energy(whole):
    elastic, state, windows, fields = whole
    local, patches = replace(elastic, far=fields[0]), windows[0].of(state.patches)
    here, there = (evaluate(local, patches, state.penetration + d, TOLERANCE) for d in (-1e-4, 1e-4))
    middle = evaluate(local, patches, state.penetration, TOLERANCE)
    assert (there.elastic_energy - here.elastic_energy) / 2e-4 == pytest.approx(middle.load, rel=1e-8)
    assert (there.load - here.load) / 2e-4 == pytest.approx(middle.load_rate, rel=1e-8)


def test_modes_at_the_ends_are_those_that_the_patches_beyond_ask_for(whole):
    elastic, state, windows, fields = whole
    for window, far in zip(windows, fields, strict=True):
        alone = evaluate(replace(elastic, far=far), window.of(state.patches), state.penetration, TOLERANCE)
        assert np.all(alone.resolution.modes >= state.resolution.modes[window.members])
        patches, arc = alone.patches, far.arc  # seen from the other side, the last is the first
        mirrored = replace(far, arc=Arc(-arc.delta, -arc.beta, arc.margins[::-1]))
        least = _coupled_outside(mirrored, Patches(-patches.right[::-1], -patches.left[::-1]), TOLERANCE)
        np.testing.assert_allclose(least[::-1], _coupled_outside(far, patches, TOLERANCE), rtol=1e-9)


def test_a_window_has_the_patches_of_its_arc(whole):
    _, state, windows, _ = whole
    for window in windows:
        inside = window.arc.holds(state.patches.center)
        assert np.array_equal(np.flatnonzero(inside), window.members)
        assert isinstance(window.of(state.patches), Patches)
