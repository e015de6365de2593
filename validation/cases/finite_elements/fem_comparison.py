"""Boundary elements against finite elements: one scene by both, its rows, judged by both uncertainties, its figure.

Both find their own edges (or are given the same ones, where the case says so). For every quantity

    |BEM - FEM| <= sqrt(u_BEM^2 + u_FEM^2),

u_FEM from the three meshes of the reference, u_BEM from the solver's error estimate: that of the contact fraction for
the edges, that of the mean pressure for the load, the tolerance of the scene, relative, for all that has none of its
own. Nothing but these decides, without a factor, and rows of their own ask that they be small. Stress intensities are
compared at given edges alone: at an equilibrium both codes impose them.

Scales: lengths along the layer by the period, heights by the rms height of the profile, stresses by the largest
pressure in the middle of a patch, stress intensities by that times sqrt(period), energies by the elastic energy.
Displacement and pressure are compared away from the edges, where displacements behave as a square root and pressures
diverge: a displacement no nearer than a tenth of the patch or gap beside it, the pressure under a smooth weight on
the inner 0.8 of each patch.

SI units.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

import bem
from bem.scene.result import State
from bem.scene.scene import Scene
from fem_reference import Resolution, Result
from validation.cases.shared.checks import Against, beside
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.schema import Code, Figure, Row
from validation.references import fem_adapter

COARSER = {"P2/P1": Resolution(2, 10, 10), "P4/P3": Resolution(4, 6, 16)}  # of many meshes: folds, moved edges
RESOLUTIONS = {
    "P2/P1": Resolution(2, 10, 10),
    "P2/P1, 12 cells": Resolution(2, 12, 10),
    "P4/P3": Resolution(4, 8, 18),
}
NAMES = {2: "P2/P1", 4: "P4/P3"}
ROUNDING = 1e-11  # of the scale: what a comparison of doubles that differ by nothing else leaves
AWAY = 0.1  # of the patch or gap beside an edge
ASIDE = 0.1  # of a patch or gap: how far off the edges begin where a start is given
POINTS = 48  # where displacements are compared
SHOWN = 1.5  # times the scale: the exact pressure is infinite at the edges
MIDDLE = 0.8  # of a patch, where pressures are compared node by node
GROUP = "boundary elements against finite elements"
EQUATIONS = (
    r"$K = \sqrt{2 E^\ast \gamma \sqrt{1 + h'^2}}$ at every edge ($K = 0$ without adhesion), "
    r"$u = h - h_{\text{max}} + \Delta$ on the contact; judged by "
    r"$|\text{BEM} - \text{FEM}| \le \sqrt{u_{\text{BEM}}^2 + u_{\text{FEM}}^2}$"
)
SOURCES = "carbone2008 carbone2009 gustafsson2020 taylor1973 destuynder1983 shih1986 roache1998"
SOLVED = ("converged", "negative_stress_intensity", "interpenetration")  # at given edges: an elastic state, whatever K


@dataclass(frozen=True)
class Difference:
    """One quantity of both codes with the uncertainty of each and a scale, all in `unit`."""

    quantity: str
    unit: str
    bem: FloatArray
    fem: FloatArray
    bem_uncertainty: float
    fem_uncertainty: float
    scale: float

    @property
    def largest(self) -> float:
        """Largest |BEM - FEM| over the scale."""
        return float(np.max(np.abs(self.bem - self.fem))) / self.scale

    @property
    def uncertainty(self) -> float:
        """That of both codes combined, over the scale."""
        return math.hypot(self.bem_uncertainty, self.fem_uncertainty) / self.scale


def _difference(
    quantity: str, unit: str, ours: ArrayLike, theirs: ArrayLike, own: float, uncertain: ArrayLike, scale: float
) -> Difference:
    """Values of any shape; the largest uncertainty of the finite elements counts."""
    return Difference(quantity, unit, np.ravel(ours), np.ravel(theirs), own, float(np.max(uncertain)), scale)


@dataclass(frozen=True)
class Comparison:
    """A scene solved by both codes."""

    label: str  # what distinguishes the scene from the others of its case
    differences: tuple[Difference, ...]  # empty when one of the codes has no state; `failure` then says why
    fem: Result | None = None
    state: bem.ContactState | None = None  # the boundary elements at their edges
    failure: str = ""

    @property
    def share(self) -> float:
        """Largest difference over the combined uncertainty."""
        return max(one.largest / one.uncertainty for one in self.differences)

    @property
    def elements(self) -> str:
        """Those of the reference."""
        return "P2/P1" if self.fem is None else NAMES[self.fem.resolution.order]

    @property
    def uncertainty(self) -> float:
        """Largest combined uncertainty over its scale, displacement at single points left out."""
        return max(one.uncertainty for one in self.differences[:-1])

    def shown(self, name: str) -> float | str:
        """`share` or `uncertainty` as it stands in a table, or the failure."""
        return float(f"{getattr(self, name):.2g}") if self.differences else self.failure

    def of(self, quantity: str) -> Difference:
        """The difference of a quantity."""
        return next(one for one in self.differences if one.quantity == quantity)


def compare_equilibria(label: str, posed: Scene, elements: str, patches: int | None) -> Comparison:
    """Equilibria at the last target of a scene with a layer: each code finds its own edges.

    `elements`, "P2/P1" or "P4/P3", and `patches`, how many are looked for, are those of the reference. None: a path
    past events decides which of many equilibria is meant; the reference is told so by a start that is `ASIDE`.
    """
    state = bem.solve(posed).targets[-1]
    if state.status != "converged" or not state.certificate.ok:
        why = f"boundary elements: {state.status}, certificate ok: {state.certificate.ok}"
        return Comparison(label, (), failure=why)
    edges, period = np.array(state.edges), posed.surface().period
    start = None if patches else _aside(edges, period)
    fem = fem_adapter.solve_fem(posed, RESOLUTIONS[elements], patches or len(edges), start=start)
    if fem.status != "converged" or fem.edges.shape != (state.n_patches, 2):
        why = f"finite elements: {fem.status} with {len(fem.edges)} patches of {state.n_patches}. {fem.message}"
        return Comparison(label, (), fem, failure=why)
    elastic = fem_adapter.contact_state(posed, edges, state.penetration)
    return Comparison(label, tuple(_differences(posed, fem, elastic, state)), fem, elastic)


def _aside(edges: FloatArray, period: float) -> FloatArray:
    """Edges (n_patches, 2) in m, each moved outwards by `ASIDE` of the shorter of the patch and the gap beside it."""
    return np.asarray(edges + ASIDE * beside(edges, period) * np.array([-1.0, 1.0]))


def compare_prescribed(label: str, posed: Scene, elements: str, edges: FloatArray, penetration: float) -> Comparison:
    """The elastic state at edges (n_patches, 2) and penetration, m, given to both codes, whatever the sign of K."""
    fem = fem_adapter.solve_fem(posed, RESOLUTIONS[elements], edges=edges)
    state = fem_adapter.contact_state(posed, edges, penetration)
    if fem.status not in SOLVED:
        return Comparison(label, (), fem, failure=f"finite elements: {fem.status}. {fem.message}")
    return Comparison(label, tuple(_differences(posed, fem, state, None)), fem, state)


def _differences(posed: Scene, fem: Result, elastic: bem.ContactState, state: State | None) -> Iterator[Difference]:
    """All that is compared and not prescribed; without a state at edges that were given to both codes."""
    tolerance, known = posed.accuracy.tolerance, fem.uncertainty
    height, period = fem.problem.unit_height, fem.problem.period
    prescribed = "penetration" if posed.loading.control == "separation" else posed.loading.control
    middle = fem_adapter.middle_pressure(elastic)
    scale = float(np.max(np.abs(middle)))
    estimate = 0.0
    if state is not None:
        own, estimate = state.error_estimate.contact_fraction or 0.0, state.error_estimate.mean_pressure or 0.0
        yield _difference("edges", "m", np.array(state.edges), fem.edges, own * period, known["edges"], period)
        yield _difference("contact fraction", "", state.contact_fraction, fem.contact_fraction, own,
                          known["contact_fraction"], 1.0)  # fmt: skip
        for key in ("penetration", "total_displacement"):
            if key != prescribed and getattr(state, key) is not None:
                yield _difference(key.replace("_", " "), "m", getattr(state, key), getattr(fem, key),
                                  tolerance * height, known[key], height)  # fmt: skip
    if prescribed != "mean_pressure":
        ours = elastic.mean_pressure if state is None else state.mean_pressure
        yield _difference("mean pressure", "Pa", ours, fem.mean_pressure, max(estimate, tolerance * scale),
                          known["mean_pressure"], scale)  # fmt: skip
    yield _difference("pressure away from the edges", "Pa", middle, fem.middle_pressure, tolerance * scale,
                      known["middle_pressure"], scale)  # fmt: skip
    if state is None:
        root, energy = float(np.sqrt(period)), elastic.elastic_energy
        yield _difference("stress intensity at the edges", "Pa m^1/2", elastic.stress_intensity, fem.stress_intensity,
                          tolerance * scale * root, known["stress_intensity"], scale * root)  # fmt: skip
        yield _difference("elastic energy per period", "J/m", energy, fem.elastic_energy, tolerance * abs(energy),
                          known["elastic_energy"], abs(energy))  # fmt: skip
    else:
        for name, key in (("elastic", "elastic_energy"), ("elastic and adhesive", "total_energy")):
            if key == "elastic_energy" or posed.adhesion is not None:
                yield _difference(f"{name} energy per area", "J/m^2", getattr(state, key), getattr(fem, key) / period,
                                  tolerance * abs(state.elastic_energy), np.asarray(known[key]) / period,
                                  abs(state.elastic_energy))  # fmt: skip
    x = away_from_edges(fem)
    uncertain_there = float(np.max(fem.uncertainty_at("displacement", x))) + 2.0 * uncertain(fem, "penetration")
    yield _difference("interface displacement away from the edges", "m", elastic.displacement(x),
                      fem.displacement(x) - (fem.total_displacement - fem.penetration), tolerance * height,
                      uncertain_there, height)  # fmt: skip


def away_from_edges(fem: Result) -> FloatArray:
    """Positions (at most `POINTS`,) in m, equally spaced from the first edge on, those near an edge left out."""
    knots = np.append(fem.edges.ravel(), fem.edges[0, 0] + fem.problem.period)
    x = knots[0] + (np.arange(POINTS) + 0.5) / POINTS * fem.problem.period
    place = np.searchsorted(knots, x) - 1
    share = (x - knots[place]) / np.diff(knots)[place]
    return np.asarray(x[(share > AWAY) & (share < 1.0 - AWAY)])


def rows(comparison: Comparison, asked_uncertainty: bool = True) -> Iterator[Row]:
    """Rows of a comparison; with P4/P3 more, unless told: no combined uncertainty is above the one asked for."""
    prefix, fem, elements = f"{comparison.label}: " if comparison.label else "", comparison.fem, comparison.elements
    source = "fem_reference" if fem is None else f"fem_reference, {elements}, {fem.unknowns} unknowns"
    if not comparison.differences:
        missing = Against("FEM", "fem_reference").row(f"{prefix}equilibrium", "", 1.0, 0.0, None, "absolute",
                                                      required=0.5)  # fmt: skip
        yield missing.model_copy(update={"status": "not converged", "message": comparison.failure})
        return
    for one in comparison.differences:
        yield within(prefix + one.quantity, one.unit, Against("FEM", source, one.fem_uncertainty), one.fem, one.bem,
                     one.bem_uncertainty, one.scale)  # fmt: skip
    if not asked_uncertainty or elements != "P4/P3":
        return
    *others, displacement = comparison.differences
    for name, judged, asked, measured in (  # displacements at single points are less certain
        ("largest of all but displacement", others, 1e-5, 2.7e-6),
        ("displacement", [displacement], 1e-4, 3.5e-5),
    ):
        yield Against("FEM", source).row(f"{prefix}combined uncertainty over its scale, {name}", "", 0.0,
                                         max(difference.uncertainty for difference in judged), measured, "absolute",
                                         required=asked, pinned="unconverged")  # fmt: skip


def uncertain(fem: Result, name: str) -> float:
    """The largest uncertainty that the finite elements state of a quantity, in its unit."""
    return float(np.max(fem.uncertainty[name]))


def within(
    quantity: str,
    unit: str,
    against: Against,
    expected: ArrayLike,
    computed: ArrayLike,
    uncertainty: float,
    scale: float,
    code: Code | None = "bem",
) -> Row:
    """A row of a code's answer that the combined uncertainty of both sides judges, never below rounding."""
    return against.row(quantity, unit, np.ravel(expected), np.ravel(computed), None, "absolute", scale,
                       required=ROUNDING, uncertainty=uncertainty, code=code)  # fmt: skip


def counts(comparisons: Sequence[Comparison]) -> dict[str, int]:
    """Largest numbers of unknowns of both codes."""
    return {
        "unknowns": max((c.state.evaluation.unknowns for c in comparisons if c.state is not None), default=0),
        "unknowns of the finite elements": max((c.fem.unknowns for c in comparisons if c.fem is not None), default=0),
    }


def figure(identity: str, caption: str, comparison: Comparison) -> tuple[Figure, ...]:
    """Pressure along the layer by both codes above; below, their signed differences away from the edges."""
    fem, state = comparison.fem, comparison.state
    if fem is None or state is None:
        return ()
    scale, period, x = float(np.max(np.abs(fem.middle_pressure))), fem.problem.period, fem.interface.x
    inside, middle = _in_patches(fem, x, 1.0), _in_patches(fem, x, MIDDLE)
    theirs, ours = state.pressure(x[inside]), fem.interface.pressure[inside]
    shown = np.abs(theirs) < SHOWN * scale
    line = np.linspace(x[0], x[0] + period, 400)
    curve = np.nan_to_num(state.pressure(line), nan=0.0, posinf=np.inf, neginf=-np.inf)  # nothing off the contact
    displacement, points = comparison.differences[-1], x[0] + (away_from_edges(fem) - x[0]) % period
    apart = (state.pressure(x[middle]) - fem.interface.pressure[middle]) / scale
    below = (
        "pressure at the nodes of the middle 0.8 of each patch over the largest middle pressure, displacement away "
        "from the edges over the rms height."
    )
    made = drawn(
        identity, f"{caption} Below, boundary elements less finite elements: {below}",
        axes("x / mm", "pressure / kPa",
             trace("boundary elements", line * 1e3, [v / 1e3 if abs(v) < SHOWN * scale else None for v in curve]),
             marks("finite elements", x[inside][shown] * 1e3, ours[shown] / 1e3)),
        axes("x / mm", "signed difference / scale",
             marks("pressure", x[middle] * 1e3, apart),
             marks("displacement", points * 1e3, (displacement.bem - displacement.fem) / displacement.scale)),
    )  # fmt: skip
    return (made,)


def _in_patches(fem: Result, x: FloatArray, share: float) -> NDArray[np.bool_]:
    """Whether positions x, m, lie in the inner share of a patch."""
    period, inside = fem.problem.period, np.zeros(x.shape, dtype=bool)
    for a, b in fem.edges:
        distance = x - 0.5 * (a + b)
        inside |= np.abs(distance - period * np.round(distance / period)) < share * 0.5 * (b - a)
    return inside
