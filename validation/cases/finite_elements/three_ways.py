"""One adhesive contact three ways: boundary elements, finite elements, and Johnson's closed form, each with the others.

Both codes are given the same load on a layer of three periods, which is a half-space to 1e-12, and find their own
edges.  The closed form is that of references/closed_forms.py.  Points: the inner 0.8 of the contact, and the gap from a
tenth of its width off the edge.  SI units.
"""

from typing import Any

import numpy as np

import bem
from validation.cases.finite_elements.fem_comparison import GROUP, RESOLUTIONS, uncertain, within
from validation.cases.shared.checks import Against, Found, case, posed
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, drawn, marks, semilogy, trace
from validation.references import fem_adapter
from validation.references.closed_forms import Sinusoid

WAVE = Sinusoid(amplitude=50e-6, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.3, alpha=0.3)
FRACTION = 0.5
PSI, HALF = 0.5 * np.pi * FRACTION, 0.5 * FRACTION * WAVE.wavelength
CREST = -0.7 / (2 * np.pi) * WAVE.wavelength  # of the scene
INNER, AWAY = 0.8, 0.1
SMALLEST_SHOWN = 1e-17
JOHNSON = Against("exact", "Johnson 1995")


def _gap(elastic: bem.ContactState, x: FloatArray) -> FloatArray:
    """By the boundary elements at places x, m."""
    return np.asarray(elastic.displacement(x) - (elastic.profile.height(x) - WAVE.amplitude) - elastic.penetration)


def _from_crest(x: FloatArray) -> FloatArray:
    return np.asarray((x - CREST + 0.5 * WAVE.wavelength) % WAVE.wavelength - 0.5 * WAVE.wavelength)


def _parted(pieces: list[tuple[list[float], list[float]]]) -> tuple[list[float | None], list[float | None]]:
    """Pieces of a curve as one, nothing drawn between them."""
    x, y = ([value for piece in pieces for value in (*piece[axis], None)] for axis in (0, 1))
    return x, y


def _over(x: FloatArray, values: FloatArray, scale: float) -> tuple[list[float], list[float]]:
    """Places from left to right, over the period, and values over a scale."""
    order = np.argsort(x)
    return (x[order] / WAVE.wavelength).tolist(), (values[order] / scale).tolist()


def _three_ways() -> Found:
    scene = posed("layer_sinusoid", layer={"thickness": 3 * WAVE.wavelength},
                  adhesion={"work_of_adhesion": WAVE.work_of_adhesion, "slope_term": False},
                  loading={"control": "mean_pressure", "targets": [float(WAVE.mean_pressure(PSI))]})  # fmt: skip
    state = bem.solve(scene).targets[-1]
    elastic = fem_adapter.contact_state(scene, np.array(state.edges), state.penetration)
    fem = fem_adapter.solve_fem(scene, RESOLUTIONS["P4/P3"])
    # lengths along the period by it, heights by the amplitude, pressures by p*
    period, depth, star, energy = WAVE.wavelength, WAVE.amplitude, WAVE.full_contact_pressure, WAVE.elastic_energy(PSI)
    estimate, x, nodes = state.error_estimate, fem.interface.x, _from_crest(fem.interface.x)
    inside, outside = np.abs(nodes) < INNER * HALF, np.abs(nodes) > HALF + AWAY * (period - 2 * HALF)
    pressures = WAVE.pressure(nodes[inside], PSI), elastic.pressure(x[inside]), fem.interface.pressure[inside]
    gaps = WAVE.gap(nodes[outside], PSI), _gap(elastic, x[outside]), fem.gap(x[outside])
    stated = [np.asarray(fem.uncertainty[name])[there] for name, there in (("pressure", inside), ("gap", outside))]
    # by the closed form and both codes; uncertainties of both; scale, and over it the boundary elements less the closed
    # form, the largest of two processors and of the kernels in NumPy
    quantities: tuple[tuple[str, str, tuple[Any, Any, Any], float | None, float, float, float], ...] = (
        ("contact fraction", "", (FRACTION, state.contact_fraction, fem.contact_fraction), estimate.contact_fraction,
         uncertain(fem, "contact_fraction"), 1.0, 6.5e-15),
        ("penetration", "m", (WAVE.penetration(PSI), state.penetration, fem.penetration), estimate.penetration,
         uncertain(fem, "penetration"), depth, 5.7e-15),
        ("edges", "m", ([-HALF, HALF], _from_crest(np.array(state.edges[0])), _from_crest(fem.edges[0])),
         (estimate.contact_fraction or 0.0) * period, uncertain(fem, "edges"), period, 4.5e-15),
        ("elastic energy per area", "J/m^2", (energy, state.elastic_energy, fem.elastic_energy / period),
         estimate.elastic_energy, uncertain(fem, "elastic_energy") / period, energy, 2.8e-14),
        ("pressure at points", "Pa", pressures, None, float(stated[0].max()), star, 4.1e-14),
        ("gap at points", "m", gaps, None, float(stated[1].max()), depth, 1.8e-14),
    )  # fmt: skip
    by_fem = f"fem_reference, P4/P3, {fem.unknowns} unknowns"
    for name, unit, answers, own, spread, scale, measured in quantities:
        exact, ours, theirs = map(np.ravel, answers)
        yield JOHNSON.row(f"{name}, boundary elements", unit, exact, ours, measured, "absolute", scale,
                          uncertainty=own or 0.0)  # fmt: skip
        yield within(f"{name}, finite elements", unit, JOHNSON, exact, theirs, spread, scale, "fem")
        yield within(name, unit, Against("FEM", by_fem, spread), theirs, ours, own or 0.0, scale, None)
    on, off = np.linspace(-0.97 * HALF, 0.97 * HALF, 161), np.linspace(HALF * 1.0001, 0.5 * period, 121)
    sides = -off[::-1], off
    shown, beside = np.abs(nodes) < 0.97 * HALF, np.abs(nodes) > HALF * (1 + 1e-9)
    left, right = (_over(side, WAVE.gap(side, PSI), depth) for side in sides)
    above = axes(
        "x / period, from the crest", "pressure / p*,  gap / amplitude",
        trace("pressure, boundary elements", *_over(on, elastic.pressure(CREST + on), star), hue=0),
        marks("pressure, finite elements", *_over(nodes[shown], fem.interface.pressure[shown], star), hue=0),
        trace("gap, boundary elements",
              *_parted([_over(side, _gap(elastic, CREST + side), depth) for side in sides]), hue=1),
        marks("gap, finite elements", *_over(nodes[beside], fem.interface.gap[beside], depth), hue=1),
        trace("Johnson 1995, both", *_parted([left, _over(on, WAVE.pressure(on, PSI), star), right]), "dashed", hue=5),
    )  # fmt: skip
    places = np.concatenate([nodes[inside], nodes[outside]])

    def apart(one: int, other: int) -> FloatArray:
        """Of the answers of pressures and gaps, over their scales."""
        parts = [np.abs(of[one] - of[other]) / scale for of, scale in ((pressures, star), (gaps, depth))]
        return np.asarray(np.maximum(np.concatenate(parts), SMALLEST_SHOWN))

    below = semilogy(
        "x / period, from the crest", "difference",
        trace("uncertainty stated by finite elements",
              *_over(places, np.concatenate([stated[0] / star, stated[1] / depth]), 1.0), "dots", hue=5),
        marks("boundary less finite elements", *_over(places, apart(1, 2), 1.0), hue=1),
        marks("finite elements less Johnson", *_over(places, apart(2, 0), 1.0), hue=2),
        marks("boundary elements less Johnson", *_over(places, apart(1, 0), 1.0), hue=0),
    )  # fmt: skip
    yield drawn("centre-three-ways",
                "One adhesive wave: boundary elements (line), finite elements (points), Johnson's closed form "
                "(dashed); then how far any two are apart.", above, below)  # fmt: skip
    yield {"unknowns": state.unknowns, "unknowns of the finite elements": fem.unknowns}


CASES = (
    case("three-ways", GROUP, _three_ways,
         "Do boundary elements, finite elements and the closed form agree on one adhesive contact, any two?",
         r"$p = p^\ast [\sin^2 \psi - \alpha \sqrt{\tan \psi}]$ given; $|E| \le \sqrt{u_{\text{num}}^2 + u_D^2}$",
         "johnson1995 westergaard1939 gustafsson2020 roache1998", "layer adhesion load_control", scene="layer_sinusoid",
         problem="one adhesive wave under load"),
)  # fmt: skip
