"""Calibration of the finite elements' uncertainty U on values with known truth: how often, and by how much, it holds.

Drawn at random are Poisson's ratio, adhesion, edges, meshes, and five kinds of states:

- complete contact of one to four waves with a layer (Carbone and Mangialardi 2008): a smooth solution;
- Johnson's state of one wave (1995), Westergaard's without adhesion (1939), with edges given or found, on a layer of
  three periods, a half-space to 1e-12;
- a rough profile of 2 to 8 waves on a layer of 0.05 to 2 periods, with edges given or found, against boundary elements
  at a tolerance of 1e-10 whose certificate holds.

U is what `fem_reference.solve` states: three meshes with half, three quarters and all of the cells, and the rule of Eca
and Hoekstra (J. Comput. Phys. 262 (2014) 104) as published, with 2 m as the theoretical order of P2 (m = 2) and P4 (m =
4) elements, chosen on draws of another seed (`fem_reference/README.md`, with the cause of the largest errors).  A value
is left out where U is below ten times the uncertainty of the truth; states that finite elements do not close are
counted.  At equilibrium the finite elements start a tenth of a patch or gap beside the edges of the boundary elements,
which tells them the branch and nothing else.  Truths by closed form and by the other solver are judged apart.
"""

from collections import Counter
from functools import partial

import numpy as np
import pytest

import bem
from fem_reference import Resolution, solve
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid, layer_compliance
from validation.routes.fem_scenes import middle_pressure, raw
from validation.routes.scenes import contact_state, edge_scale, problem_of

SEED = 62
PERIOD, E, HEIGHT, WORK = 0.01, 1e6, 50e-6, 0.02
CELLS, TIPS = {2: (10, 12, 16), 4: (8, 10, 12)}, {2: (10, 15), 4: (14, 21)}
KNOWN = {"closed form": 1e-11, "boundary elements": 1e-10}  # of the scale: uncertainty of the truth
CLEAR = 10.0  # U below so many uncertainties of the truth is not judged
COVERAGE, MEDIAN, ASIDE = 0.95, 0.4, {"few": 0.3, "many": 0.2}  # what is asked; how far the median may be off
OPEN = "not closed by finite elements"


def judged(fem, truths, known):
    """Return |error| / U of every number, by name; `truths` holds truth and scale, `known` the truth's uncertainty.

    A text instead states why a draw has no values.
    """
    if fem.status in ("no_equilibrium", "not_converged"):
        return OPEN
    shares = []
    for name, (truth, scale) in truths.items():
        error, spread = (np.ravel(part) for part in (getattr(fem, name) - np.asarray(truth), fem.uncertainty[name]))
        if name == "edges":
            error = (error + PERIOD / 2) % PERIOD - PERIOD / 2
        shares += [(name, abs(e) / u) for e, u in zip(error, spread, strict=True) if u > CLEAR * known * abs(scale)]
    return shares


def material(rng):
    """Return a Poisson's ratio, an end of its range now and then."""
    return float(rng.choice([0.0, 0.5, rng.uniform(0.0, 0.5)]))


def resolution(rng, order):
    """Return a resolution among those that users take."""
    return Resolution(order, int(rng.choice(CELLS[order])), int(rng.integers(*TIPS[order])))


def complete(rng, order):
    """Return the shares of complete contact: its elastic energy."""
    nu, count = material(rng), int(rng.integers(1, 5))
    waves = np.sort(rng.choice(np.arange(1, 7), count, replace=False))
    amplitudes, phases = HEIGHT * rng.uniform(0.2, 1.0, count) / waves, rng.uniform(0.0, 2 * np.pi, count)
    thickness = PERIOD * 10 ** rng.uniform(-1.0, 0.3)
    fem = solve(youngs_modulus=E, poisson_ratio=nu, thickness=thickness, period=PERIOD, edges="complete",
                harmonics=(waves, amplitudes, phases), control="mean_pressure", value=0.0,
                resolution=resolution(rng, order))
    compliance = layer_compliance(2 * np.pi * waves / PERIOD, thickness, E, nu)
    energy = PERIOD * float(np.sum(0.25 * amplitudes**2 / compliance))
    return judged(fem, {"strain_energy": (energy, energy)}, KNOWN["closed form"])


def wave(rng, order, *, given):
    """Return the shares of one wave at given edges, or in a stable equilibrium."""
    alpha = float(rng.choice([0.0, rng.uniform(0.05, 0.5)], p=[0.2, 0.8]))
    sine, fraction = Sinusoid(HEIGHT, PERIOD, E, material(rng), alpha), float(rng.uniform(0.1, 0.9))
    control, psi = str(rng.choice(["penetration", "mean_pressure"])), 0.5 * np.pi * fraction
    numbers = getattr(sine, control)
    if not given and float(numbers(1.01 * psi)) <= float(numbers(psi)):
        return "behind a fold: no minimum"
    fem = solve(youngs_modulus=E, poisson_ratio=sine.poisson_ratio, thickness=3 * PERIOD, period=PERIOD,
                harmonics=([1], [HEIGHT], [0.0]), work_of_adhesion=sine.work_of_adhesion, control=control,
                value=float(numbers(psi)), resolution=resolution(rng, order),
                edges=[[-fraction * PERIOD / 2, fraction * PERIOD / 2]] if given else None)
    gauss, weights = np.polynomial.legendre.leggauss(64)
    weights = weights * (1 - gauss**2) ** 4
    star, energy = sine.full_contact_pressure, PERIOD * float(sine.elastic_energy(psi))
    middle = float(sine.pressure(0.4 * fraction * PERIOD * gauss, psi) @ weights / weights.sum())
    truths = {"mean_pressure": (float(sine.mean_pressure(psi)), star), "middle_pressure": (middle, star),
              "penetration": (float(sine.penetration(psi)), HEIGHT), "elastic_energy": (energy, energy)}
    del truths[control]
    if not given:
        truths["contact_fraction"] = (fraction, 1.0)
    elif alpha > 0.0:
        critical = np.sqrt(2 * sine.modulus * sine.work_of_adhesion)
        truths["stress_intensity"] = ([[critical, critical]], critical)
    return judged(fem, truths, KNOWN["closed form"])


def rough(rng, order, *, given):
    """Return the shares of a rough profile on a layer at given edges, or in equilibrium."""
    tables = {"solid": {"youngs_modulus": E, "poisson_ratio": material(rng)},
              "profile": {"kind": "self_affine", "period": PERIOD, "hurst": 0.5, "rms_height": HEIGHT,
                          "harmonics": int(rng.integers(2, 9)), "seed": int(rng.integers(1000, 10**6))},
              "layer": {"thickness": PERIOD * 10 ** float(rng.uniform(-1.3, 0.3))}, "accuracy": {"tolerance": 1e-10}}
    if rng.random() < 0.6:
        tables["adhesion"] = {"work_of_adhesion": WORK, "slope_term": bool(rng.random() < 0.5)}
    surface = bem.parse_scene(tables | {"loading": {"control": "penetration", "targets": [HEIGHT]}}).surface()
    depth = float(rng.uniform(0.1, 0.8)) * surface.max_height
    scene = bem.parse_scene(tables | {"loading": {"control": "penetration", "targets": [depth]}})
    state = bem.solve(scene).targets[-1]
    if state.status != "converged" or not state.certificate.ok:
        return "no certified state by boundary elements"
    edges, scale = np.array(state.edges), edge_scale(np.array(state.edges), PERIOD)
    if given:
        edges = edges + 0.15 * rng.uniform(-1, 1, edges.shape) * scale
        if edges[0, 0] < 0.0:
            return "patches in another order: the codes list them by their left edge on the period"
    elastic = contact_state(scene, edges, depth)
    fem = solve(**raw(problem_of(scene, "finite elements", "layer", "adhesion")), control="penetration", value=depth,
                resolution=resolution(rng, order), patches=len(edges), edges=edges if given else None,
                start=None if given else edges + 0.1 * scale * np.array([-1.0, 1.0]))
    middle, energy = middle_pressure(elastic), elastic.elastic_energy
    largest = float(np.max(np.abs(middle)))
    truths = {"mean_pressure": (elastic.mean_pressure, largest), "middle_pressure": (middle, largest),
              "elastic_energy": (energy, energy)}
    if given:
        truths["stress_intensity"] = (elastic.stress_intensity, largest * np.sqrt(PERIOD))
    else:
        truths |= {"edges": (edges, PERIOD), "contact_fraction": (state.contact_fraction, 1.0)}
    return judged(fem, truths, KNOWN["boundary elements"])


KINDS = {"complete contact": complete, "wave, edges given": partial(wave, given=True),
         "wave, edges found": partial(wave, given=False), "rough, edges given": partial(rough, given=True),
         "rough, edges found": partial(rough, given=False)}


def drawn(seed, order, draws):
    """Return kind of state, elements, name and |error| / U of every value of some draws, and draws without, counted."""
    values, without = [], Counter()
    for k in range(draws):
        for number, (kind, shares) in enumerate(KINDS.items()):
            of_draw = shares(np.random.default_rng([seed, order, k, number]), order)
            if isinstance(of_draw, str):
                without[kind, of_draw] += 1
            else:
                values += [(kind, f"P{order}/P{order - 1}", *each) for each in of_draw]
    return values, without


def histogram(shares):
    """Return corners of a histogram of shares, of the fraction of all values in each tenth of U."""
    counts, ends = np.histogram(np.minimum(shares, 1.95), bins=np.linspace(0.0, 2.0, 21))
    return np.repeat(ends, 2), np.concatenate([[0.0], np.repeat(counts / len(shares), 2), [0.0]])


@pytest.mark.parametrize(("many", "draws"), [
    pytest.param("few", {2: 2, 4: 1}, id="few", marks=pytest.mark.standard),
    pytest.param("many", {2: 18, 4: 6}, id="many", marks=[pytest.mark.full, pytest.mark.timeout(3600)])])
def test_calibration(rows, many, draws):
    """Does U of the finite elements hold 95 % of true errors, and is it no wider than it must be?"""
    values, without = [], Counter()
    for order, count in draws.items():
        more, lost = drawn(SEED, order, count)
        values, without = values + more, without + lost
    curves = {"U": ([1, 1], [0, 0.4], "dashed")}
    for truth, code in (("closed forms", Code.EXACT), ("boundary elements at 1e-10", Code.BEM)):
        shares = np.array([share for kind, *_, share in values if kind.startswith("rough") == (code == Code.BEM)])
        against = rows.between(Code.FEM, code, f"{shares.size} values, largest |error| / U {shares.max():.3g}",
                               quantity=Quantity.COUNT)
        error, aside = 2 * np.sqrt(COVERAGE * (1 - COVERAGE) / shares.size), 1 / np.sqrt(shares.size)
        against.compare(f"share of true errors within U, {truth}", float(np.mean(shares <= 1)), COVERAGE,
                        uncertainty=(error, 0.0))
        against.compare(f"median of true error over U, {truth}", float(np.median(shares)), MEDIAN,
                        uncertainty=(np.ptp(np.quantile(shares, [0.5 - aside, 0.5 + aside])) / 2, 0.0),
                        required=ASIDE[many],
                        because="below 0.2 U is wasteful, above 0.6 it holds by luck; a few values scatter by 0.1 more")
        curves[f"{shares.size} values, {truth}"] = (*histogram(shares), "line")
    rows.count("states that finite elements do not close", sum(n for (_, why), n in without.items() if why == OPEN),
               within=0.0, of=Code.FEM)
    rows.curves("True errors over U: share of all values in each tenth of U, those beyond 1.9 U in the last",
                "|error| / U", "share of values", curves)
    rows.table("Draws without values", ["state", "reason", "draws"],
               [[*why, n] for why, n in sorted(without.items())] or [["none", "", 0]])
    lines = []
    for column, title in enumerate(("state", "elements", "quantity")):
        for label in sorted({value[column] for value in values}):
            part = np.array([share for *names, share in values if names[column] == label])
            lines.append([title, label.replace("_", " "), len(part), float(np.mean(part <= 1)),
                          float(np.median(part)), float(part.max())])
    rows.table("True error over U by kind of state, elements and quantity",
               ["by", "which", "values", "within U", "median", "largest"], lines)
