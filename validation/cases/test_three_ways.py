"""Adhesive wave three ways: boundary elements, finite elements and Johnson's closed form, any two compared.

h = D cos(q0 x), D = 50 um, period 10 mm, E = 1 MPa, nu = 0.3, work of adhesion by Johnson's alpha = 0.3.  Both codes
get the mean pressure of the contact fraction 0.5, p = p* [sin^2 psi - alpha sqrt(tan psi)], psi = pi/4, and find their
own edges.  The layer of three periods is a half-space to 1e-12.  Fields are compared on the inner 0.8 of the contact
(pressure) and farther from the edges than a tenth of the gap (gap).  Source: Johnson, Int. J. Solids Struct. 32 (1995)
423.
"""

import numpy as np
import pytest

from fem_reference import Resolution
from validation.plugin.rows import Code, Quantity
from validation.references.closed_forms import Sinusoid
from validation.routes.fem_scenes import solve_fem, uncertain
from validation.routes.scenes import TEN_DIGITS, contact_state, posed, solved

WAVE = Sinusoid(amplitude=50e-6, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.3, alpha=0.3)
PERIOD, DEPTH, STAR = WAVE.wavelength, WAVE.amplitude, WAVE.full_contact_pressure
PSI, HALF = np.pi / 4, PERIOD / 4
CREST = -0.7 / (2 * np.pi) * PERIOD  # of the scene
TABLES = {
    "layer": {"thickness": 3 * PERIOD},
    "adhesion": {"work_of_adhesion": WAVE.work_of_adhesion, "slope_term": False},
    "loading": {"control": "mean_pressure", "targets": [float(WAVE.mean_pressure(PSI))]},
}
HALF_SPACE = 1e-12  # relative: the layer of three periods for the half-space of the closed form


def from_crest(x):
    """Return distances from the nearest crest, m."""
    return (np.asarray(x) - CREST + PERIOD / 2) % PERIOD - PERIOD / 2


@pytest.fixture(scope="module")
def state():
    """Return the state of the boundary elements."""
    return solved("layer_sinusoid", **TABLES).targets[-1]


@pytest.fixture(scope="module")
def fem():
    """Return the state of the finite elements: P4/P3, 8 cells, 18 halvings at each edge."""
    result = solve_fem(posed("layer_sinusoid", **TABLES), Resolution(4, 8, 18))
    assert result.status == "converged", result.message
    return result


def scalars(state, fem):
    """Yield name, quantity, unit, then answer and uncertainty of the closed form, BEM and FEM."""
    own = state.error_estimate
    energy = WAVE.elastic_energy(PSI)
    yield ("contact fraction", Quantity.AREA, "", (0.5, HALF_SPACE), (state.contact_fraction, own.contact_fraction),
           (fem.contact_fraction, uncertain(fem, "contact_fraction")))
    yield ("penetration", Quantity.LENGTH, "m", (float(WAVE.penetration(PSI)), HALF_SPACE * DEPTH),
           (state.penetration, own.penetration), (fem.penetration, uncertain(fem, "penetration")))
    yield ("edges", Quantity.EDGES, "m", ([-HALF, HALF], HALF_SPACE * PERIOD),
           (from_crest(state.edges[0]), own.contact_fraction * PERIOD),
           (from_crest(fem.edges[0]), uncertain(fem, "edges")))
    yield ("elastic energy", Quantity.ENERGY, "J/m^2", (energy, HALF_SPACE * energy),
           (state.elastic_energy, own.elastic_energy),
           (fem.elastic_energy / PERIOD, uncertain(fem, "elastic_energy") / PERIOD))


@pytest.mark.quick
def test_any_two_answers_agree(rows, state, fem):
    """Do boundary elements, finite elements and the closed form find the same contact under the same load?"""
    by_fem, lines = f"P4/P3, {fem.unknowns} unknowns", []
    for name, quantity, unit, exact, ours, theirs in scalars(state, fem):
        for of, by, first, second, source in (
            (Code.BEM, Code.EXACT, ours, exact, "Johnson 1995"),
            (Code.FEM, Code.EXACT, theirs, exact, "Johnson 1995"),
            (Code.BEM, Code.FEM, ours, theirs, by_fem),
        ):
            rows.compare(name, first[0], second[0], of=of, by=by, quantity=quantity, unit=unit, source=source,
                         uncertainty=(first[1], second[1]),
                         kind="construction" if name == "edges" else "accuracy")  # edges repeat the contact fraction
        if name != "edges":
            sides = [f"{value:.6g} ± {uncertainty:.2g}" for value, uncertainty in (ours, theirs, exact)]
            lines.append([f"{name}{' / ' if unit else ''}{unit}", *sides])
    rows.table("One adhesive wave under a load. Value ± U", ["number", "bem", "fem", "closed form"], lines, front=True)
    rows.count("unknowns", state.unknowns, of=Code.BEM)
    rows.count("unknowns", fem.unknowns, of=Code.FEM)


@pytest.mark.quick
def test_fields_agree_at_points(rows, state, fem):
    """Do pressure on the contact and gap beside it agree at the nodes of the finite elements, any two of the three?"""
    by_place = np.argsort(from_crest(fem.interface.x))
    x, nodes = fem.interface.x[by_place], from_crest(fem.interface.x)[by_place]
    inside, outside = np.abs(nodes) < 0.8 * HALF, np.abs(nodes) > HALF + 0.1 * (PERIOD - 2 * HALF)
    elastic, coarse = (contact_state(posed("layer_sinusoid", **TABLES), state.edges, state.penetration, tolerance)
                       for tolerance in (1e-12, 1e-8))

    def gap(x, elastic=elastic):
        return elastic.displacement(x) - (elastic.profile.height(x) - DEPTH) - elastic.penetration

    for name, unit, scale, exact, ours, other, theirs, spread in (
        ("pressure", "Pa", STAR, WAVE.pressure(nodes[inside], PSI), elastic.pressure(x[inside]),
         coarse.pressure(x[inside]), fem.interface.pressure[by_place][inside],
         np.max(np.asarray(fem.uncertainty["pressure"])[by_place][inside])),
        ("gap", "m", DEPTH, WAVE.gap(nodes[outside], PSI), gap(x[outside]), gap(x[outside], coarse),
         fem.gap(x[outside]), np.max(np.asarray(fem.uncertainty["gap"])[by_place][outside])),
    ):
        own = float(np.max(np.abs(ours - other)))  # more than the error at the finer of two tolerances
        rows.compare(name, ours, exact, of=Code.BEM, by=Code.EXACT, quantity=Quantity.POINTS, unit=unit,
                     uncertainty=own, required=1e-10 * scale, because=TEN_DIGITS,
                     source="Johnson 1995")
        rows.compare(name, theirs, exact, of=Code.FEM, by=Code.EXACT, quantity=Quantity.POINTS, unit=unit,
                     uncertainty=(spread, HALF_SPACE * scale), source="Johnson 1995")
        rows.compare(name, ours, theirs, of=Code.BEM, by=Code.FEM, quantity=Quantity.POINTS, unit=unit,
                     uncertainty=(own, spread), source=f"P4/P3, {fem.unknowns} unknowns")
    on, off = np.linspace(-0.97, 0.97, 161) * HALF, np.linspace(HALF * 1.0001, PERIOD / 2, 121)
    shown, beside = np.abs(nodes) < 0.97 * HALF, nodes > HALF * (1 + 1e-9)
    rows.curves("One adhesive wave by two codes and Johnson's closed form", "x / period, from the crest",
                "pressure / p*, gap / amplitude",
                {"pressure, boundary elements": (on / PERIOD, elastic.pressure(CREST + on) / STAR),
                 "pressure, finite elements": (nodes[shown] / PERIOD, fem.interface.pressure[by_place][shown] / STAR),
                 "pressure, Johnson": (on / PERIOD, WAVE.pressure(on, PSI) / STAR),
                 "gap, boundary elements": (off / PERIOD, gap(CREST + off) / DEPTH),
                 "gap, finite elements": (nodes[beside] / PERIOD, fem.interface.gap[by_place][beside] / DEPTH),
                 "gap, Johnson": (off / PERIOD, WAVE.gap(off, PSI) / DEPTH)}, front=True)
