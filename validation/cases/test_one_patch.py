"""Single patch on a symmetric profile in closed form: jumps from ripple to ripple, and two crests that merge.

A wave D cos q0 x, D = 100 um, period 10 mm, E* = 1 MPa / 0.75, carries a ripple of order 20, 30 or 40.  The mean
pressure p(a) of one patch of half width a in equilibrium rises and falls with every ripple that the edges cross.
Under a growing load contact jumps at a maximum of p, or where the gap at the next crest closes, to the next a of equal
p, and releases U(a1) - U(a2) - p (Delta(a1) - Delta(a2)); under a falling load at a minimum
(references/rippled_wave.py).

Two crests with a shallow dip between them, h = D (cos y - cos(2y) / 2), merge into one patch.  The period begins in the
dip or in the valley.  Their closed form: references/one_patch.py, after Muskhelishvili, Some Basic Problems of the
Mathematical Theory of Elasticity, chapter 19.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from validation.harness.arrays import FloatArray
from validation.plugin.rows import Code, Quantity
from validation.references.one_patch import OnePatch
from validation.references.rippled_wave import AMPLITUDE, MODULUS, PERIOD, WAVE, RippledWave
from validation.routes.scenes import TEN_DIGITS, estimates, posed, solved, values

UP, DOWN = (0.0, 1e3, 3e3, 6e3, 1e4, 1.4e4), (1.2e4, 1e4, 6e3, 3e3, 0.0, -1e3, -1.6e3)  # Pa, of WAVE
COARSE, FINE = RippledWave(20, 4e-6, 0.06), RippledWave(40, 2e-6, 0.06)
RELEASED = 1e-3  # of the work of adhesion: least energy of a jump; folds of rounding size release less
STRESS = MODULUS * AMPLITUDE / PERIOD  # unit of pressures
CRESTS = OnePatch(PERIOD, MODULUS, (AMPLITUDE, -0.5 * AMPLITUDE), 0.003)  # of the scene merged_crests
MERGED = (1e4, 2e4, 4e4)  # Pa, loads behind the coalescence; three lie before it


def solve_wave(wave, control, targets, max_increment=None):
    """Solve the loading path of a rippled wave."""
    return solved("rippled_wave", profile={"orders": [1, wave.order], "amplitudes": [AMPLITUDE, wave.ripple]},
                  adhesion={"work_of_adhesion": wave.work}, loading={"control": control, "targets": list(targets)},
                  accuracy={"max_increment": max_increment})


def jumps_of(result, wave):
    """Return the events that are jumps."""
    return [event for event in result.events if (event.energy_released or 0.0) > RELEASED * wave.work]


def released(jumps) -> FloatArray:
    """Return energies released, J/m^2."""
    return values(jumps, "energy_released")


@pytest.mark.quick
def test_contact_spreads_and_recedes(rows):
    """Does contact spread and recede by the jumps of the closed form, also with a large increment?"""
    result = solved("rippled_wave")
    up, widths = WAVE.loaded(*UP)
    down, narrower = WAVE.unloaded(widths[-1], *DOWN)
    expected = [jump.pressure for jump in (*up[1:], *down)]
    jumps = [event for event in jumps_of(result, WAVE) if event.kind != "first_touch"]
    exact = rows.between(Code.BEM, Code.EXACT, "first and last passages of the mean pressure of one patch")
    fractions = np.array([*widths, *narrower]) / np.pi
    exact.compare("contact fraction at every load, growing then falling", values(result.targets, "contact_fraction"),
                  fractions, quantity=Quantity.AREA, uncertainty=estimates(result.targets, "contact_fraction"),
                  required=1e-10, because=TEN_DIGITS)
    exact.compare("mean pressure at every jump", values(jumps, "mean_pressure"), expected, unit="Pa",
                  quantity=Quantity.PRESSURE, uncertainty=estimates(jumps, "mean_pressure"), required=1e-9 * STRESS,
                  because="a jump is an extremum of the load: nine digits")
    exact.compare("patches of every state", values(result.targets, "n_patches"), 1.0, quantity=Quantity.COUNT,
                  kind="construction", required=0.5, because="a count")
    rows.count("evaluations", sum(state.evaluations for state in result.states), of=Code.BEM)
    curve = np.linspace(0.03, 0.5, 600)
    rows.curves("Contact of a rippled wave", "mean pressure / kPa", "contact fraction",
                {"boundary elements": (np.array([*UP, *DOWN]) / 1e3, values(result.targets, "contact_fraction")),
                 "closed form of one patch": (WAVE.patch.mean_pressure(np.pi * curve) / 1e3, curve)})


@pytest.mark.quick
def test_jumps(rows):
    """Does every jump happen at its load, release its energy and touch its crests, within the errors it estimates?"""
    loads = (0.0, 1e4, 0.0, -1500.0)  # Pa
    result = solve_wave(COARSE, "mean_pressure", loads)
    rows.count("evaluations", sum(state.evaluations for state in result.states), within=0.1, of=Code.BEM)
    up, widths = COARSE.loaded(*loads[:2])
    down, narrower = COARSE.unloaded(widths[-1], *loads[2:])
    expected, jumps = [*up, *down], jumps_of(result, COARSE)
    exact = rows.between(Code.BEM, Code.EXACT, "closed form of one patch, order 20")
    exact.compare("contact fraction at every load", values(result.targets, "contact_fraction"),
                  np.array([*widths, *narrower]) / np.pi, quantity=Quantity.AREA, required=1e-10,
                  uncertainty=estimates(result.targets, "contact_fraction"), because=TEN_DIGITS)
    energies, pressures = values(expected, "released"), values(expected, "pressure")
    exact.compare("energy released by every jump", released(jumps), energies, unit="J/m^2", quantity=Quantity.ENERGY,
                  uncertainty=(estimates(jumps, "energy_released"), 1e-13 * COARSE.work))
    exact.compare("mean pressure at every jump", values(jumps, "mean_pressure"), pressures, unit="Pa",
                  quantity=Quantity.PRESSURE,
                  uncertainty=(estimates(jumps, "mean_pressure"), 1e-13 * STRESS))
    exact.compare("energy released, to ten digits", released(jumps) / energies, 1.0, quantity=Quantity.ENERGY,
                  uncertainty=estimates(jumps, "energy_released") / energies, required=1e-10,
                  because=TEN_DIGITS)
    kinds, touched = [event.kind for event in result.events], 2 * sum(jump.touched for jump in expected)
    exact.compare("new contacts and coalescences", [kinds.count("new_contact"), kinds.count("coalescence")], touched,
                  quantity=Quantity.COUNT, kind="construction", required=0.5, because="a count")


@pytest.mark.quick
def test_jumps_under_separation(rows):
    """Has contact spread right at two separations, and does an increment of an rms height lose no jump?"""
    separations = (60e-6, 20e-6)
    usual, long = (solve_wave(FINE, "separation", separations, longest) for longest in (None, 1.0))
    fractions = [FINE.spread(FINE.highest - s) / np.pi for s in separations]
    rows.compare("contact fraction", values(usual.targets, "contact_fraction"), fractions, of=Code.BEM, by=Code.EXACT,
                 quantity=Quantity.AREA, uncertainty=estimates(usual.targets, "contact_fraction"), required=1e-10,
                 because=TEN_DIGITS, source="closed form of one patch, order 40")
    rows.compare("jumps with increments of an rms height", len(jumps_of(long, FINE)), len(jumps_of(usual, FINE)),
                 of=Code.BEM, by=Code.IDENTITY, quantity=Quantity.COUNT, kind="construction", required=0.5,
                 because="a count", source="the path with default increments")


@pytest.mark.quick
def test_two_crests_merge(rows):
    """Do two patches become the one patch of the closed form, also when they merge across the end of the period?"""
    # keys: place of the dip over the period
    results = {dip: solved("merged_crests", profile={"phases": [-2 * np.pi * dip, np.pi - 4 * np.pi * dip]})
               for dip in (0.0, 0.5)}
    exact = [brentq(lambda f, p=p: float(CRESTS.mean_pressure(np.pi * f)) - p, 0.4, 0.9, xtol=1e-15) for p in MERGED]
    behind = [state for result in results.values() for state in result.targets[3:]]
    patch = rows.between(Code.BEM, Code.EXACT, "closed form of one patch")
    patch.compare("contact fraction behind the coalescence", values(behind, "contact_fraction"), exact * 2,
                  quantity=Quantity.AREA, uncertainty=estimates(behind, "contact_fraction"), required=1e-10,
                  because=TEN_DIGITS)
    patch.compare("patches at every load", [s.n_patches for r in results.values() for s in r.targets],
                  [2, 2, 2, 1, 1, 1] * 2, quantity=Quantity.COUNT, kind="construction", required=0.5,
                  because="a count")
    for result in results.values():
        assert sorted(event.kind for event in result.events) == ["coalescence", "first_touch", "first_touch"]
    symmetry = rows.between(Code.BEM, Code.IDENTITY, "symmetry of the profile", "construction")
    before = [values(result.targets[:3], "contact_fraction") for result in results.values()]
    symmetry.compare("contact fraction before the coalescence, dip in the middle", before[1], before[0],
                     quantity=Quantity.AREA, required=1e-12, because="rounding")
    places = [[*(sum(state.edges[0]) / 2 for state in result.targets[3:]),
               *(event.position for event in result.events if event.kind == "coalescence")]
              for result in results.values()]
    off = np.array(places) / PERIOD - np.array(list(results))[:, None]
    symmetry.compare("middle of the patch and place of the coalescence, from the dip, over the period",
                     off - np.round(off), 0.0, quantity=Quantity.EDGES, required=1e-11,
                     because="a fold is located to rounding of its neutral mode")


@pytest.mark.quick
def test_dip_opens(rows):
    """Does the dip between two crests pressed together without adhesion open where the pressure vanishes in it?"""
    dented = OnePatch(PERIOD, MODULUS, (AMPLITUDE, -0.5 * AMPLITUDE), 0.0)
    profile = {"orders": [1, 2], "amplitudes": [AMPLITUDE, 0.5 * AMPLITUDE], "phases": [0.0, np.pi]}
    scene = posed("sinusoid", profile=profile, adhesion=None)
    dip = scene.surface().max_height - float(scene.surface().height(0.0))
    loading = {"targets": [float(dented.penetration(a)) + dip for a in (1.575, 1.57)]}  # about a = pi / 2
    states = solved("sinusoid", profile=profile, adhesion=None, loading=loading).targets
    rows.compare("patches before and after", values(states, "n_patches"), [1, 2], of=Code.BEM, by=Code.EXACT,
                 quantity=Quantity.COUNT, kind="construction", required=0.5, because="a count",
                 source="the pressure of one patch vanishes in the dip at a = pi / 2")
