"""One adhesive contact three ways: boundary elements, finite elements, and Johnson's closed form, each with the others.

Both codes are given the same load on a layer of three periods, which is a half-space to 1e-12, and find their own
edges.  The closed form is that of references/closed_forms.py.  Points: the inner 0.8 of the contact, and the gap from a
tenth of its width off the edge.  SI units.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import bem
from bem.scene.result import State
from fem_reference import Result
from validation.cases.finite_elements.fem_comparison import GROUP, RESOLUTIONS, within
from validation.cases.shared.checks import Against, Found, case, posed
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, drawn, marks, semilogy, trace
from validation.harness.schema import Figure
from validation.references import fem_adapter
from validation.references.closed_forms import Sinusoid

WAVE = Sinusoid(amplitude=50e-6, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.3, alpha=0.3)
FRACTION = 0.5
PSI = 0.5 * np.pi * FRACTION
CREST = -0.7 / (2 * np.pi) * WAVE.wavelength  # of the scene
INNER, AWAY = 0.8, 0.1
SMALLEST_SHOWN = 1e-17
# of the scale: the boundary elements less the closed form, largest of two processors and of the kernels in NumPy
MEASURED = {
    "contact fraction": 6.5e-15,
    "penetration": 5.7e-15,
    "edges": 4.5e-15,
    "elastic energy per area": 2.8e-14,
    "pressure at points": 4.1e-14,
    "gap at points": 1.8e-14,
}
JOHNSON = Against("exact", "Johnson 1995")
CAPTION = (
    "One adhesive wave: boundary elements (line), finite elements (points), Johnson's closed form (dashed); "
    "then how far any two are apart."
)


@dataclass(frozen=True)
class ThreeAnswers:
    """A quantity by both codes and the closed form, with the uncertainties that the codes state, in one unit."""

    name: str
    unit: str
    exact: FloatArray
    bem: FloatArray
    fem: FloatArray
    bem_uncertainty: float
    fem_uncertainty: float
    scale: float


def _quantities(state: State, elastic: bem.ContactState, fem: Result) -> list[ThreeAnswers]:
    """All that is compared; lengths along the period by it, heights by the amplitude, pressures by p*."""
    period, depth, star = WAVE.wavelength, WAVE.amplitude, WAVE.full_contact_pressure
    half = 0.5 * FRACTION * period
    estimate, x = state.error_estimate, fem.interface.x
    distance = _from_crest(x)
    inside, outside = _away_from_edges(distance)

    def of(
        name: str, unit: str, exact: Any, ours: Any, theirs: Any, own: float | None, key: str, scale: float,
        nodes: Any = slice(None),
    ) -> ThreeAnswers:  # fmt: skip
        right, one, other = (np.ravel(np.asarray(value, dtype=np.float64)) for value in (exact, ours, theirs))
        per = period if unit == "J/m^2" else 1.0  # theirs are of one period
        uncertain = float(np.max(np.ravel(fem.uncertainty[key])[nodes])) / per
        return ThreeAnswers(name, unit, right, one, other, own or 0.0, uncertain, scale)

    energy = WAVE.elastic_energy(PSI)
    return [
        of("contact fraction", "", FRACTION, state.contact_fraction, fem.contact_fraction, estimate.contact_fraction,
           "contact_fraction", 1.0),
        of("penetration", "m", WAVE.penetration(PSI), state.penetration, fem.penetration, estimate.penetration,
           "penetration", depth),
        of("edges", "m", [-half, half], _from_crest(np.array(state.edges[0])), _from_crest(fem.edges[0]),
           (estimate.contact_fraction or 0.0) * period, "edges", period),
        of("elastic energy per area", "J/m^2", energy, state.elastic_energy, fem.elastic_energy / period,
           estimate.elastic_energy, "elastic_energy", energy),
        of("pressure at points", "Pa", WAVE.pressure(distance[inside], PSI), elastic.pressure(x[inside]),
           fem.interface.pressure[inside], None, "pressure", star, inside),
        of("gap at points", "m", WAVE.gap(distance[outside], PSI), _gap(elastic, x[outside]),
           fem.gap(x[outside]), None, "gap", depth, outside),
    ]  # fmt: skip


def _gap(elastic: bem.ContactState, x: FloatArray) -> FloatArray:
    """By the boundary elements at places x, m."""
    return np.asarray(elastic.displacement(x) - elastic.profile.height(x) + WAVE.amplitude - elastic.penetration)


def _away_from_edges(distance: FloatArray) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Which distances from the crest lie where pressures are compared, and where gaps are."""
    half = 0.5 * FRACTION * WAVE.wavelength
    return np.abs(distance) < INNER * half, np.abs(distance) > half + AWAY * (WAVE.wavelength - 2 * half)


def _from_crest(x: FloatArray) -> FloatArray:
    return np.asarray((x - CREST + 0.5 * WAVE.wavelength) % WAVE.wavelength - 0.5 * WAVE.wavelength)


def _figure(found: list[ThreeAnswers], elastic: bem.ContactState, fem: Result) -> Figure:
    """Pressure and gap by all three; below, the differences of any two and the uncertainty stated."""
    period, star, depth = WAVE.wavelength, WAVE.full_contact_pressure, WAVE.amplitude
    half = 0.5 * FRACTION * period
    on, off = np.linspace(-0.97 * half, 0.97 * half, 161), np.linspace(half * 1.0001, 0.5 * period, 121)
    off = np.concatenate([-off[::-1], off])
    nodes = _from_crest(fem.interface.x)
    inside, outside = _away_from_edges(nodes)
    beside = np.abs(nodes) > half * (1 + 1e-9)
    gap, shown = _gap(elastic, CREST + off), np.abs(nodes) < 0.97 * half

    def over(x: FloatArray, values: FloatArray, scale: float) -> tuple[list[float], list[float]]:
        order = np.argsort(x)
        return (x[order] / period).tolist(), (values[order] / scale).tolist()

    left = off < 0
    halves = [over(off[side], gap[side], depth) for side in (left, ~left)]
    exact = [over(off[side], WAVE.gap(off[side], PSI), depth) for side in (left, ~left)]
    exact.insert(1, over(on, WAVE.pressure(on, PSI), star))
    above = axes(
        "x / period, from the crest",
        "pressure / p*,  gap / amplitude",
        trace("pressure, boundary elements", *over(on, elastic.pressure(CREST + on), star), hue=0),
        marks("pressure, finite elements", *over(nodes[shown], fem.interface.pressure[shown], star), hue=0),
        trace("gap, boundary elements", *_parted(halves), hue=1),
        marks("gap, finite elements", *over(nodes[beside], fem.interface.gap[beside], depth), hue=1),
        trace("Johnson 1995, both", *_parted(exact), "dashed", hue=5),
    )
    pressure, opened = found[-2:]
    places, own = np.concatenate([nodes[inside], nodes[outside]]), fem.uncertainty
    stated = np.concatenate([np.asarray(own["pressure"])[inside] / star, np.asarray(own["gap"])[outside] / depth])

    def apart(a: str, b: str) -> FloatArray:
        parts = [np.abs(getattr(q, a) - getattr(q, b)) / q.scale for q in (pressure, opened)]
        return np.asarray(np.maximum(np.concatenate(parts), SMALLEST_SHOWN))

    below = semilogy(
        "x / period, from the crest", "difference",
        trace("uncertainty stated by finite elements", *over(places, stated, 1.0), "dots", hue=5),
        marks("boundary less finite elements", *over(places, apart("bem", "fem"), 1.0), hue=1),
        marks("finite elements less Johnson", *over(places, apart("fem", "exact"), 1.0), hue=2),
        marks("boundary elements less Johnson", *over(places, apart("bem", "exact"), 1.0), hue=0),
    )  # fmt: skip
    return drawn("centre-three-ways", CAPTION, above, below)


def _parted(pieces: list[tuple[list[float], list[float]]]) -> tuple[list[float | None], list[float | None]]:
    """Pieces of a curve as one, nothing drawn between them."""
    x, y = ([value for piece in pieces for value in (*piece[axis], None)] for axis in (0, 1))
    return x, y


def _three_ways() -> Found:
    scene = posed("layer_sinusoid", layer={"thickness": 3 * WAVE.wavelength},
                  adhesion={"work_of_adhesion": WAVE.work_of_adhesion, "slope_term": False},
                  loading={"control": "mean_pressure", "targets": [float(WAVE.mean_pressure(PSI))]})  # fmt: skip
    state = bem.solve(scene).targets[-1]
    elastic = fem_adapter.contact_state(scene, np.array(state.edges), state.penetration)
    fem = fem_adapter.solve_fem(scene, RESOLUTIONS["P4/P3"])
    found, source = _quantities(state, elastic, fem), f"fem_reference, P4/P3, {fem.unknowns} unknowns"
    for q in found:
        by_fem, ours, theirs = Against("FEM", source, q.fem_uncertainty), q.bem_uncertainty, q.fem_uncertainty
        yield JOHNSON.row(f"{q.name}, boundary elements", q.unit, q.exact, q.bem, MEASURED[q.name], "absolute", q.scale,
                          uncertainty=ours)  # fmt: skip
        yield within(f"{q.name}, finite elements", q.unit, JOHNSON, q.exact, q.fem, theirs, q.scale, "fem")
        yield within(q.name, q.unit, by_fem, q.fem, q.bem, ours, q.scale, None)
    yield _figure(found, elastic, fem)
    yield {"unknowns": state.unknowns, "unknowns of the finite elements": fem.unknowns}


CASES = (
    case("three-ways", GROUP, _three_ways,
         "Do boundary elements, finite elements and the closed form agree on one adhesive contact, any two?",
         r"$p = p^\ast [\sin^2 \psi - \alpha \sqrt{\tan \psi}]$ given; $|E| \le \sqrt{u_{\text{num}}^2 + u_D^2}$",
         "johnson1995 westergaard1939 gustafsson2020 roache1998", "layer adhesion load_control", scene="layer_sinusoid",
         problem="one adhesive wave under load"),
)  # fmt: skip
