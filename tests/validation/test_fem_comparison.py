"""Boundary elements beside finite elements: raw input only, a wrong constant deviates, a failed code has a row."""

import numpy as np
import pytest

from validation.cases.bem_beside_fem import (
    AWAY,
    POINTS,
    RESOLUTIONS,
    Comparison,
    away_from_edges,
    compare_codes,
    compare_equilibria,
    compare_prescribed,
    differences,
)
from validation.plugin.rows import Quantity, Rows
from validation.routes.fem_scenes import fem_arguments, middle_pressure, solve_fem
from validation.routes.scenes import contact_state, posed

EDGES, PENETRATION = np.array([[4.9e-3, 6.3e-3], [8.8e-3, 11.4e-3]]), 50e-6
SCENE = posed("layer_two_crests")


def verdicts(comparison):
    rows = Rows()
    comparison.add_to(rows)
    return {row.verdict for row in rows.rows}


@pytest.fixture(scope="module")
def given_edges():
    return compare_prescribed(SCENE, "P2/P1", EDGES, PENETRATION)


def test_raw_constants_are_handed_over():
    arguments = fem_arguments(SCENE)
    assert (arguments["youngs_modulus"], arguments["poisson_ratio"]) == (1e6, 0.3)
    assert (arguments["thickness"], arguments["period"]) == (0.005, 0.01)
    assert (arguments["work_of_adhesion"], arguments["slope_term"]) == (0.03, True)
    assert (arguments["control"], arguments["value"]) == ("penetration", 50e-6)
    np.testing.assert_array_equal(arguments["harmonics"][0], [1, 2, 3])


def test_without_adhesion_nothing_is_paid():
    arguments = fem_arguments(posed("layer_two_crests", adhesion=None))
    assert (arguments["work_of_adhesion"], arguments["slope_term"]) == (0.0, False)


def test_a_half_space_is_refused():
    with pytest.raises(ValueError, match=r"needs a \[layer\]"):
        fem_arguments(posed("layer_two_crests", layer=None))


def test_both_codes_agree_at_given_edges(given_edges):
    assert verdicts(given_edges) <= {"agrees", "marginal"}


@pytest.mark.parametrize(
    "tables",
    [
        {"solid": {"poisson_ratio": 0.31}},
        {"solid": {"youngs_modulus": 1.01e6}},
        {"layer": {"thickness": 4.9e-3}},
        {"loading": {"targets": [50.5e-6]}},
    ],
    ids=lambda tables: next(iter(next(iter(tables.values())))),
)
def test_a_constant_that_is_wrong_in_one_code_deviates(tables):
    fem = solve_fem(posed("layer_two_crests", **tables), RESOLUTIONS["P2/P1"], edges=EDGES)
    state = contact_state(SCENE, EDGES, PENETRATION)
    assert "deviates" in verdicts(Comparison(tuple(differences(SCENE, fem, state, None)), fem, state))


def test_a_state_that_is_no_equilibrium_is_a_failed_row():
    rows = Rows()
    compare_equilibria(SCENE, "P2/P1", 1).add_to(rows)
    (row,) = rows.rows
    assert row.verdict == "not converged"
    assert "finite elements: interpenetration" in row.message


def test_displacements_are_compared_away_from_the_edges(given_edges):
    x = away_from_edges(given_edges.fem)
    period, knots = 0.01, np.append(EDGES.ravel(), EDGES[0, 0] + 0.01)
    beside = np.minimum(np.diff(knots), np.roll(np.diff(knots), 1))  # of the four edges
    apart = (x[:, None] - knots[:-1] + period / 2) % period - period / 2
    assert x.size > 0.7 * POINTS
    assert np.all(np.abs(apart) > 0.9 * AWAY * beside)


def test_middle_pressure_is_the_weighted_mean_of_westergaards():
    half, period, full = 2e-3, 0.01, np.pi * 1e6 / (1 - 0.3**2) * 50e-6 / 0.01
    sine = np.sin(np.pi * half / period) ** 2
    crest = -0.7 / (2 * np.pi) * period
    state = contact_state(
        posed("layer_sinusoid", adhesion=None), [[crest - half, crest + half]], 50e-6 * sine * (1 - np.log(sine))
    )
    t = (np.arange(20000) + 0.5) / 10000 - 1
    weight, at = (1 - t**2) ** 4, np.pi * 0.8 * half * t / period
    exact = 2 * full * np.cos(at) * np.sqrt(sine - np.sin(at) ** 2)
    # measured 3.8e-9: the layer
    np.testing.assert_allclose(middle_pressure(state), np.sum(weight * exact) / np.sum(weight), rtol=1e-8)


@pytest.mark.parametrize(
    ("theirs", "uncertainty", "verdict"),
    [(1.003, 0.002, "agrees"), (1.005, 0.002, "deviates"), (1.005, 0.02, "not converged"), (1.012, 0.009, "deviates")],
)
def test_what_is_allowed_has_a_ceiling_and_a_large_uncertainty_establishes_nothing(theirs, uncertainty, verdict):
    rows = Rows()
    compare_codes(rows, "load", 1.0, theirs, (0.0, uncertainty), 1.0, quantity=Quantity.PRESSURE)
    assert [row.verdict for row in rows.rows] == [verdict]
