"""Rough profile where all three codes answer: boundary elements, finite elements, and Persson's theory.

A self-affine profile (H = 0.7, h_rms = 50 um, period 10 mm, E = 1 MPa, nu = 0.5) on a layer of two periods, which is a
half-space to 1e-8: 20 harmonics with a work of adhesion of 0.03 J/m^2, under three rising loads and two on the way
back, or 8 without adhesion, where a state has no history, under three.

Both solvers answer for one realisation.  The boundary elements follow their path.  The finite elements begin with 2e-3
periods of contact at the highest crest: at each load the energy descends from the contact before, patches and gaps
come and go (`fem_reference/descent.py`), and `solve` closes what is left on three meshes.  Contact fraction and energy
of adhesion follow from the edges: rows by construction.

The differences of the two solvers have one sign: the finite elements touch less under a given load.  At given edges
and plate their elastic energy is above the exact one (one wave, fractions 0.2 to 0.8, nu = 0.3 and 0.5, four meshes: 55
of 56 states) by an excess that grows with the contact; so K, its derivative by the edge, is too large (50 of 56; less
so where the gap is the narrower side), and K = K_c is met further in.  No theorem: mixed elements have no such bound.
From 5 to 14 cells the difference in elastic energy falls 5 to 30 times; a row fits its order on the meshes of `solve`.

The theory knows the spectrum, not the realisation: it is compared with means over twelve realisations by boundary
elements.  That ratio is a regression: its bands are three standard errors of twelve about the means of 24 other
realisations by the same code, no independent number.
"""

import numpy as np
import pytest
from scipy.stats import t

from fem_reference import Resolution
from fem_reference.closure import Control
from fem_reference.result import quantities
from fem_reference.solve import closed, companions, judged_closure
from validation.cases.bem_beside_fem import compare_codes
from validation.plugin.rows import Code, Quantity
from validation.routes.fem_scenes import descend_fem, path_of, uncertain
from validation.routes.persson_scenes import persson_contact
from validation.routes.scenes import posed, solved, values

MODULUS, PERIOD = 1e6 / (1 - 0.5**2), 0.01
LOADS, BACK = (0.0025, 0.005, 0.01), (0.006, 0.0035)  # over E*
SEED, REALISATIONS, FEW_DIGITS = 1, 12, 1e-9
CEILING = 0.02  # of every number but the edges: the theory is a tenth and more off
CAUSE = "mean-field theory: it neglects correlations between neighbouring contacts, strongest in one direction"
QUANTITIES = {  # quantity, unit, kind of the row of both solvers
    "contact_fraction": (Quantity.AREA, "", "construction"), "separation": (Quantity.LENGTH, "m", "accuracy"),
    "elastic_energy": (Quantity.ENERGY, "J/m^2", "accuracy"),
    "adhesion_energy": (Quantity.ENERGY, "J/m^2", "construction")}
SHOWN = {"m": (1e6, "um"), "J/m^2": (1e3, "mJ/m^2"), "": (1.0, "")}  # units of the table
BANDS = {  # by harmonics, number and load: mean over the theory, and its standard error
    20: {"contact_fraction": {0.0025: (2.38, 0.24), 0.005: (1.90, 0.155), 0.01: (1.67, 0.074)},
         "separation": {0.0025: (0.886, 0.043), 0.005: (1.039, 0.029), 0.01: (1.227, 0.045)},
         "elastic_energy": {0.0025: (0.337, 0.026), 0.005: (0.497, 0.043), 0.01: (0.661, 0.049)},
         "adhesion_energy": {0.0025: (2.37, 0.24), 0.005: (1.89, 0.154), 0.01: (1.665, 0.073)}},
    8: {"contact_fraction": {0.01: (1.27, 0.06)}, "separation": {0.01: (1.25, 0.06)}, "elastic_energy": {}}}


def scene(harmonics, seed, layer=True, back=()):
    """Return the scene rough_100 with fewer harmonics, under the loads and some on the way back."""
    return {"profile": {"harmonics": harmonics, "seed": seed},
            "adhesion": {"slope_term": True} if harmonics == 20 else None,
            "layer": {"thickness": 2 * PERIOD} if layer else None, "accuracy": {"tolerance": FEW_DIGITS},
            "loading": {"control": "mean_pressure", "targets": [load * MODULUS for load in (*LOADS, *back)]}}


def by_fem(posed_scene, elements):
    """Return the states of the finite elements at every load, and elastic energies on three meshes, J/m^2."""
    states, energies, (problem, kind, targets) = [], [], path_of(posed_scene)
    for value, edges in zip(targets, descend_fem(posed_scene), strict=True):
        closures = closed(problem, Control(kind, value), companions(elements), len(edges), start=edges * PERIOD)
        states.append(judged_closure(problem, closures))
        assert states[-1].status == "converged", states[-1].message
        energies.append([quantities(closure.evaluation)["elastic_energy"] / PERIOD for closure in closures[1:]])
    return states, np.array(energies)


def number(state, name):
    """Return a number of the finite elements and its uncertainty, energies per area."""
    share = PERIOD if name.endswith("energy") else 1.0
    of = "penetration" if name == "separation" else name
    return getattr(state, name) / share, uncertain(state, of) / share


def shown(name, value, uncertainty):
    """Return a number with its uncertainty as a text, in the unit of the table."""
    factor, _ = SHOWN[QUANTITIES[name][1]]
    u = factor * uncertainty
    return f"{factor * value:.5g} ± " + (f"{u:.0f}" if u > 9.5 else f"{u:.1g}".replace("e-0", "e-"))


def compare_solvers(rows, states, fem, energies, elements):
    """Add rows of one realisation by both solvers; return (load, name, bem, fem, difference / U) for a table."""
    lines, way = [], [f"{load:g} E*" for load in LOADS] + [f"{load:g} E*, back" for load in BACK]
    rows.compare("patches at every load", [state.n_patches for state in states], [len(state.edges) for state in fem],
                 of=Code.BEM, by=Code.FEM, quantity=Quantity.COUNT, kind="construction", required=0.5,
                 because="a count")
    for load, state, by_elements in zip(way, states, fem, strict=False):
        own, source = state.error_estimate, f"P2/P1, {by_elements.unknowns} unknowns, from the highest crest"
        if state.n_patches == len(by_elements.edges):
            compare_codes(rows, f"edges at {load}", np.ravel(state.edges), by_elements.edges.ravel(),
                          (own.contact_fraction * PERIOD, uncertain(by_elements, "edges")), PERIOD, unit="m",
                          quantity=Quantity.EDGES, source=source)
        for name in BANDS[20 if state.adhesion_energy else 8]:
            quantity, unit, kind = QUANTITIES[name]
            value, u_own, (theirs, u_fem) = getattr(state, name), getattr(own, name), number(by_elements, name)
            compare_codes(rows, f"{words(name)} at {load}", value, theirs, (u_own, u_fem), abs(theirs),
                          quantity=quantity, ceiling=CEILING, unit=unit, kind=kind, source=source)
            lines.append([name, load, shown(name, value, u_own), shown(name, theirs, u_fem),
                          f"{(value - theirs) / np.hypot(u_own, u_fem):+.2f}"])
    off = np.array([state.elastic_energy for state in states])[:, None] / energies - 1
    rows.order("elastic energy, bem over fem less 1, all loads, against cells",
               [resolution.cells for resolution in companions(elements)], np.sqrt(np.mean(off**2, axis=0)), 4.0,
               of=Code.FEM, required=2.5, because="coarse meshes do not reach 4 yet; what is no truncation has order 0",
               source="energy norm h^2 (Strang and Fix 1973)")
    return sorted(lines, key=lambda line: list(QUANTITIES).index(line[0]))


def words(name):
    """Return the name of a quantity as rows have it."""
    return name.replace("_", " ").replace("separation", "mean gap")


@pytest.mark.parametrize(
    ("harmonics", "elements"),
    [pytest.param(20, Resolution(2, 10, 10), id="20", marks=pytest.mark.standard),
     pytest.param(8, Resolution(2, 12, 10), id="8", marks=pytest.mark.quick)],
)
def test_rough_profile(rows, harmonics, elements):
    """For one rough profile, do both solvers agree, and how far is Persson's theory from the mean of realisations?"""
    back = BACK if harmonics == 20 else ()
    states = solved("rough_100", **scene(harmonics, SEED, back=back)).targets
    fem, energies = by_fem(posed("rough_100", **scene(harmonics, SEED, back=back)), elements)
    lines = compare_solvers(rows, states, fem, energies, elements)
    ensemble = [states if seed == SEED else solved("rough_100", **scene(harmonics, seed)).targets
                for seed in range(REALISATIONS)]
    alone = posed("rough_100", **scene(harmonics, SEED, layer=False))
    theory, finer = ([persson_contact(alone, load * MODULUS, **options) for load in LOADS]
                     for options in ({}, {"resolution": 2.0} if harmonics == 20 else {}))
    by_theory = {}
    for name, bands in BANDS[harmonics].items():
        every = np.array([values(of[: len(LOADS)], name) for of in ensemble])
        expected, spread = values(theory, name), np.abs(values(theory, name) - values(finer, name))
        mean, standard = every.mean(axis=0), every.std(axis=0, ddof=1) / np.sqrt(REALISATIONS)
        error = t.ppf(0.975, REALISATIONS - 1) * standard
        for k, load in enumerate(LOADS):
            u_theory = max(spread[k], FEW_DIGITS * abs(expected[k]))
            if load in bands:
                ratio, scatter = bands[load]
                rows.known(f"{words(name)} at {load:g} E*, mean of {REALISATIONS} realisations over the theory",
                           mean[k], expected[k], band=(ratio - 3 * scatter, ratio + 3 * scatter), of=Code.BEM,
                           by=Code.THEORY, kind="regression", quantity=QUANTITIES[name][0], cause=CAUSE,
                           source="Persson 2001; 2002", uncertainty=(error[k], u_theory))
            by_theory[name, f"{load:g} E*"] = shown(name, mean[k], error[k]), shown(name, expected[k], u_theory)
    counts = ", ".join(str(len(state.edges)) for state in fem)
    rows.table(f"Rough profile of {harmonics} harmonics, {'adhesive' if harmonics == 20 else 'no adhesion'}: {counts} "
               "patches. off = bem - fem has one sign, that of the truncation of meshes: it falls with the cells",
               ["number", "load", "bem ± U", "fem ± U", "off / U", f"mean of {REALISATIONS}", "theory"],
               [[f"{words(name)} / {SHOWN[QUANTITIES[name][1]][1]}".removesuffix(" / "), load.replace(" E*", ""), *of,
                 *by_theory.get((name, load), ("", ""))] for name, load, *of in lines], front=harmonics == 20)
