"""Rough profile where all three codes answer: boundary elements, finite elements, and Persson's theory.

A self-affine profile (H = 0.7, h_rms = 50 um, period 10 mm, E = 1 MPa, nu = 0.5) on a layer of two periods, which is a
half-space to 1e-8: 20 harmonics with a work of adhesion of 0.03 J/m^2, or 8 without adhesion, under three rising loads.

Both solvers answer for one realisation.  The boundary elements follow their path.  The finite elements begin with 2e-3
periods of contact at the highest crest: at each load the energy descends from the contact before, patches and gaps
come and go (`fem_reference/descent.py`), and `solve` closes what is left on three meshes.  The theory knows the
spectrum, not the realisation: it is compared with means over twelve realisations by boundary elements.  That ratio is a
known deviation; with adhesion its bands are three standard errors of twelve about the means of 24 other realisations.
"""

import numpy as np
import pytest

from fem_reference import Resolution, solve
from validation.plugin.rows import Code, Quantity
from validation.routes.fem_scenes import BECAUSE, TWICE, descend_fem, fem_arguments, uncertain
from validation.routes.persson_scenes import persson_contact
from validation.routes.scenes import posed, solved, values

MODULUS, LOADS, PERIOD, TOLERANCE = 1e6 / (1 - 0.5**2), (0.0025, 0.005, 0.01), 0.01, 1e-9
SEED, REALISATIONS = 1, 12
CAUSE = "mean-field theory: it neglects correlations between neighbouring contacts, strongest in one direction"
QUANTITIES = {"contact_fraction": (Quantity.AREA, ""), "separation": (Quantity.LENGTH, "m"),
              "elastic_energy": (Quantity.ENERGY, "J/m^2"), "adhesion_energy": (Quantity.ENERGY, "J/m^2")}
BANDS = {  # by harmonics, number and load: mean over the theory, and its standard error
    20: {"contact_fraction": {0.0025: (2.38, 0.24), 0.005: (1.90, 0.155), 0.01: (1.67, 0.074)},
         "separation": {0.0025: (0.886, 0.043), 0.005: (1.039, 0.029), 0.01: (1.227, 0.045)},
         "elastic_energy": {0.0025: (0.337, 0.026), 0.005: (0.497, 0.043), 0.01: (0.661, 0.049)},
         "adhesion_energy": {0.0025: (2.37, 0.24), 0.005: (1.89, 0.154), 0.01: (1.665, 0.073)}},
    8: {"contact_fraction": {0.01: (1.27, 0.06)}, "separation": {0.01: (1.25, 0.06)}, "elastic_energy": {}}}


def scene(harmonics, seed, layer=True):
    """Return the scene rough_100 with fewer harmonics, under the loads."""
    return {"profile": {"harmonics": harmonics, "seed": seed}, "accuracy": {"tolerance": TOLERANCE},
            "adhesion": {"slope_term": True} if harmonics == 20 else None,
            "layer": {"thickness": 2 * PERIOD} if layer else None,
            "loading": {"control": "mean_pressure", "targets": [load * MODULUS for load in LOADS]}}


def by_fem(posed_scene, elements):
    """Return the states of the finite elements at every load, from the highest crest on."""
    arguments, pressures = fem_arguments(posed_scene), posed_scene.loading.targets
    states = [solve(**arguments | {"value": float(pressure)}, start=edges * PERIOD, resolution=elements)
              for pressure, edges in zip(pressures, descend_fem(posed_scene), strict=True)]
    for state in states:
        assert state.status == "converged", state.message
    return states


def number(state, name):
    """Return a number of the finite elements and its uncertainty, energies per area."""
    share = PERIOD if name.endswith("energy") else 1.0
    of = "penetration" if name == "separation" else name
    return getattr(state, name) / share, uncertain(state, of) / share


def shown(value, uncertainty):
    """Return a number with its uncertainty as a text."""
    return f"{value:.5g} ± {uncertainty:.1g}"


@pytest.mark.parametrize(
    ("harmonics", "elements"),
    [pytest.param(8, Resolution(2, 12, 10), id="8", marks=pytest.mark.quick),
     pytest.param(20, Resolution(2, 10, 10), id="20", marks=pytest.mark.standard)],
)
def test_rough_profile(rows, harmonics, elements):
    """For one rough profile, do both solvers agree, and how far is Persson's theory from the mean of realisations?"""
    fem = by_fem(posed("rough_100", **scene(harmonics, SEED)), elements)
    ensemble = [solved("rough_100", **scene(harmonics, seed)).targets for seed in range(REALISATIONS)]
    alone = posed("rough_100", **scene(harmonics, SEED, layer=False))
    theory, finer = ([persson_contact(alone, load * MODULUS, **options) for load in LOADS]
                     for options in ({}, {"resolution": 2.0} if harmonics == 20 else {}))
    lines, ratios = [], {}
    for name, bands in BANDS[harmonics].items():
        (quantity, unit), words = QUANTITIES[name], name.replace("_", " ").replace("separation", "mean gap")
        every = np.array([values(states, name) for states in ensemble])
        expected, spread = values(theory, name), np.abs(values(theory, name) - values(finer, name))
        mean, error = every.mean(axis=0), 2 * every.std(axis=0, ddof=1) / np.sqrt(REALISATIONS)
        for k, load in enumerate(LOADS):
            state, (by_elements, u_fem) = ensemble[SEED][k], number(fem[k], name)
            own = max(getattr(state.error_estimate, name, None) or 0.0, TOLERANCE * abs(every[SEED, k]))
            rows.compare(f"{words} at {load:g} E*", every[SEED, k], by_elements, of=Code.BEM, by=Code.FEM,
                         quantity=quantity, unit=unit, uncertainty=(own, u_fem), required=TWICE * np.hypot(own, u_fem),
                         because=BECAUSE, source=f"P2/P1, {fem[k].unknowns} unknowns, from the highest crest")
            u_theory = max(spread[k], TOLERANCE * abs(expected[k]))
            if load in bands:
                ratio, standard = bands[load]
                rows.known(f"{words} at {load:g} E*, mean of {REALISATIONS} realisations over the theory", mean[k],
                           expected[k], band=(ratio - 3 * standard, ratio + 3 * standard), of=Code.BEM, by=Code.THEORY,
                           quantity=quantity, cause=CAUSE, source="Persson 2001; 2002",
                           uncertainty=(error[k], u_theory))
            lines.append([f"{words}{' / ' if unit else ''}{unit}", load, shown(every[SEED, k], own),
                          shown(by_elements, u_fem), shown(mean[k], error[k]), shown(expected[k], u_theory)])
        ratios[f"{words}, mean"] = LOADS, mean / expected
        ratios[f"{words}, this realisation"] = LOADS, every[SEED] / expected
    counts = ", ".join(str(len(state.edges)) for state in fem)
    rows.table(f"Rough profile of {harmonics} harmonics, {'adhesive' if harmonics == 20 else 'no adhesion'}: {counts} "
               "patches. Value ± U", ["number", "load / E*", "bem", "fem", f"bem, mean of {REALISATIONS}", "theory"],
               lines, front=harmonics == 20)
    rows.curves(f"Boundary elements over Persson's theory, {harmonics} harmonics", "load / E*", "over the theory",
                ratios)
