"""Boundary elements against finite elements: rows of one scene, each judged by the uncertainty of both codes.

Both find their own edges (or are given the same ones, where the case says so). For every quantity

    |BEM - FEM| <= 2 (u_BEM + u_FEM),

u_FEM from the three meshes of the reference, u_BEM from the solver's error estimate: that of the contact fraction for
the edges, that of the mean pressure for the load, the tolerance of the scene, relative, for all that has none of its
own. Nothing but the uncertainties decides, and rows of their own ask that they be small. Stress intensities are
compared at given edges alone: at an equilibrium both codes impose them.

Scales: lengths along the layer by the period, heights by the rms height of the profile, stresses by the largest
pressure in the middle of a patch, stress intensities by that times sqrt(period), energies by the elastic energy.
Displacement and pressure are compared away from the edges, where displacements behave as a square root and pressures
diverge: a displacement no nearer than a tenth of the patch or gap beside it, the pressure under a smooth weight on
the inner 0.8 of each patch.

SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import bem
from bem.scene.scene import Scene
from fem_reference import Resolution, Result
from validation.harness.arrays import FloatArray
from validation.harness.rows import compared
from validation.harness.schema import Reference, Row, Tolerance
from validation.references import fem_adapter

RESOLUTIONS = {"P2/P1": Resolution(2, 10, 10), "P4/P3": Resolution(4, 8, 18)}
ROUNDING = 1e-11  # of the scale: what a comparison of doubles that differ by nothing else leaves
TAKEN = {2: 0.38, 4: 0.1}  # by order: largest |BEM - FEM| over what is allowed, of all rows of all scenes, measured
AWAY = 0.1  # of the patch or gap beside an edge
ASIDE = 0.1  # of a patch or gap: how far off the edges begin where a start is given
POINTS = 48  # where displacements are compared
ASKED = (1e-5, 2.7e-6)  # largest combined uncertainty over its scale with P4/P3: asked, measured
ASKED_OF_DISPLACEMENT = (1e-4, 3.5e-5)  # the same of a displacement at single points
EQUATIONS = (
    r"$K = \sqrt{2 E^\ast \gamma \sqrt{1 + h'^2}}$ at every edge ($K = 0$ without adhesion), "
    r"$u = h - h_{\text{max}} + \Delta$ on the contact; judged by "
    r"$|\text{BEM} - \text{FEM}| \le 2 (u_{\text{BEM}} + u_{\text{FEM}})$"
)
SOURCES = ("carbone2008", "carbone2009", "gustafsson2020", "taylor1973", "destuynder1983", "shih1986", "roache1998")
SOLVED = ("converged", "negative_stress_intensity", "interpenetration")  # at given edges: an elastic state, whatever K
REACHED = "converged"


@dataclass(frozen=True)
class Difference:
    """One quantity of both codes with the uncertainty of each and a scale, all in `unit`."""

    quantity: str
    unit: str
    bem: list[float]
    fem: list[float]
    bem_uncertainty: float
    fem_uncertainty: float
    scale: float

    @property
    def largest(self) -> float:
        """Largest |BEM - FEM| over the scale."""
        return float(np.max(np.abs(np.subtract(self.bem, self.fem)))) / self.scale

    @property
    def uncertainty(self) -> float:
        """Sum of both uncertainties over the scale."""
        return (self.bem_uncertainty + self.fem_uncertainty) / self.scale


@dataclass(frozen=True)
class Comparison:
    """A scene solved by both codes."""

    label: str  # what distinguishes the scene from the others of its case
    differences: tuple[Difference, ...]  # empty when one of the codes has no state; `failure` then says why
    fem: Result | None = None
    state: bem.ContactState | None = None  # the boundary elements at their edges
    failure: str = ""


def compare_equilibria(label: str, posed: Scene, elements: str, patches: int | None) -> Comparison:
    """Equilibria at the last target of a scene with a layer: each code finds its own edges.

    `elements`, "P2/P1" or "P4/P3", and `patches`, how many are looked for, are those of the reference. None: a path
    past events decides which of many equilibria is meant; the reference is told so by a start that is `ASIDE`.
    """
    path = bem.solve(posed)
    state = path.targets[-1]
    if state.status != "converged" or not state.certificate.ok:
        return Comparison(
            label, (), failure=f"boundary elements: {state.status}, certificate ok: {state.certificate.ok}"
        )
    edges, period = np.array(state.edges), posed.surface().period
    start = None if patches else _aside(edges, period)
    fem = fem_adapter.solve_fem(posed, RESOLUTIONS[elements], patches or len(edges), start=start)
    if fem.status != REACHED or fem.edges.shape != (state.n_patches, 2):
        return Comparison(
            label,
            (),
            fem,
            failure=f"finite elements: {fem.status} with {len(fem.edges)} patches of {state.n_patches}. {fem.message}",
        )
    elastic = fem_adapter.contact_state(posed, edges, state.penetration)
    energies = [("elastic energy", fem.elastic_energy, state.elastic_energy, "elastic_energy")]
    if posed.adhesion is not None:
        energies.append(("elastic and adhesive energy", fem.total_energy, state.total_energy, "total_energy"))
    lengths = state.error_estimate.contact_fraction or 0.0
    found = (
        Difference("edges", "m", flat(edges), flat(fem.edges), lengths * period, _largest(fem, "edges"), period),
        Difference("contact fraction", "", [state.contact_fraction], [fem.contact_fraction], lengths,
                   _largest(fem, "contact_fraction"), 1.0),
        *_heights(posed, fem, state.penetration, state.total_displacement),
        *_stresses(posed, fem, elastic, state.mean_pressure, state.error_estimate.mean_pressure or 0.0)[:-1],
        *(
            Difference(f"{name} per area", "J/m^2", [theirs], [ours / period],
                       posed.accuracy.tolerance * abs(state.elastic_energy), _largest(fem, key) / period,
                       abs(state.elastic_energy))
            for name, ours, theirs, key in energies
        ),
        _displacement(posed, fem, elastic),
    )  # fmt: skip
    return Comparison(label, found, fem, elastic)


def _aside(edges: FloatArray, period: float) -> FloatArray:
    """Edges (n_patches, 2) in m, each moved outwards by `ASIDE` of the shorter of the patch and the gap beside it."""
    lengths = np.diff(np.append(edges.ravel(), edges[0, 0] + period))
    away = ASIDE * np.minimum(lengths, np.roll(lengths, 1)).reshape(edges.shape)
    return np.asarray(edges + away * np.array([-1.0, 1.0]))


def compare_prescribed(label: str, posed: Scene, elements: str, edges: FloatArray, penetration: float) -> Comparison:
    """The elastic state at edges (n_patches, 2) and penetration, m, given to both codes, whatever the sign of K."""
    fem = fem_adapter.solve_fem(posed, RESOLUTIONS[elements], edges=edges)
    state = fem_adapter.contact_state(posed, edges, penetration)
    if fem.status not in SOLVED:
        return Comparison(label, (), fem, failure=f"finite elements: {fem.status}. {fem.message}")
    energy = state.elastic_energy
    found = (
        *_stresses(posed, fem, state, state.mean_pressure, 0.0),
        Difference("elastic energy per period", "J/m", [energy], [fem.elastic_energy],
                   posed.accuracy.tolerance * abs(energy), _largest(fem, "elastic_energy"), abs(energy)),
        _displacement(posed, fem, state),
    )  # fmt: skip
    return Comparison(label, found, fem, state)


def _heights(posed: Scene, fem: Result, penetration: float, total: float | None) -> list[Difference]:
    """Penetration and total displacement, but not the one that is prescribed."""
    height, uncertainty = fem.problem.unit_height, posed.accuracy.tolerance * fem.problem.unit_height
    found = []
    for name, theirs, key in (
        ("penetration", penetration, "penetration"),
        ("total displacement", total, "total_displacement"),
    ):
        prescribed = "penetration" if posed.loading.control == "separation" else posed.loading.control
        if theirs is not None and prescribed != key:
            found.append(Difference(name, "m", [theirs], [getattr(fem, key)], uncertainty, _largest(fem, key), height))
    return found


def _stresses(
    posed: Scene, fem: Result, state: bem.ContactState, mean_pressure: float, estimate: float
) -> list[Difference]:
    """Mean pressure (unless prescribed), pressure of the middle of each patch, stress intensity at each edge."""
    middle = fem_adapter.middle_pressure(state)
    scale = float(np.max(np.abs(middle)))
    own = posed.accuracy.tolerance * scale
    root = float(np.sqrt(fem.problem.period))
    found = [
        Difference("pressure away from the edges", "Pa", flat(middle), flat(fem.middle_pressure), own,
                   _largest(fem, "middle_pressure"), scale),
        Difference("stress intensity at the edges", "Pa m^1/2", flat(state.stress_intensity),
                   flat(fem.stress_intensity), own * root, _largest(fem, "stress_intensity"), scale * root),
    ]  # fmt: skip
    if posed.loading.control != "mean_pressure":
        found.insert(
            0,
            Difference("mean pressure", "Pa", [mean_pressure], [fem.mean_pressure], max(estimate, own),
                       _largest(fem, "mean_pressure"), scale),
        )  # fmt: skip
    return found


def _displacement(posed: Scene, fem: Result, state: bem.ContactState) -> Difference:
    """Mean-free displacement at points away from the edges."""
    height, x = fem.problem.unit_height, away_from_edges(fem)
    mean = fem.total_displacement - fem.penetration
    uncertainty = float(np.max(fem.uncertainty_at("displacement", x))) + 2.0 * float(
        np.max(fem.uncertainty["penetration"])
    )
    return Difference("interface displacement away from the edges", "m", flat(state.displacement(x)),
                      flat(fem.displacement(x) - mean), posed.accuracy.tolerance * height, uncertainty,
                      height)  # fmt: skip


def away_from_edges(fem: Result) -> FloatArray:
    """Positions (at most `POINTS`,) in m, equally spaced from the first edge on, those near an edge left out."""
    knots = np.append(fem.edges.ravel(), fem.edges[0, 0] + fem.problem.period)
    x = knots[0] + (np.arange(POINTS) + 0.5) / POINTS * fem.problem.period
    place = np.searchsorted(knots, x) - 1
    share = (x - knots[place]) / np.diff(knots)[place]
    return np.asarray(x[(share > AWAY) & (share < 1.0 - AWAY)])


def _largest(fem: Result, name: str) -> float:
    return float(np.max(np.asarray(fem.uncertainty[name])))


def flat(values: FloatArray) -> list[float]:
    """Values of any shape as a list."""
    return [float(value) for value in np.ravel(values)]


def rows(comparison: Comparison, asked_uncertainty: bool = True) -> list[Row]:
    """Rows of a comparison; with P4/P3 one more, unless told: no combined uncertainty is above the one asked for."""
    prefix = f"{comparison.label}: " if comparison.label else ""
    if not comparison.differences:
        return [
            Row(
                quantity=f"{prefix}equilibrium",
                unit="",
                reference=Reference(kind="FEM", source="fem_reference"),
                norm="absolute",
                expected=[1.0],
                computed=[0.0],
                tolerance=Tolerance(value=0.5, measured=0.0),
                status="not converged",
                message=comparison.failure,
            )
        ]
    found = [_judged(prefix, difference, comparison) for difference in comparison.differences]
    if asked_uncertainty and comparison.fem is not None and comparison.fem.resolution.order == 4:
        *others, displacement = comparison.differences
        found += [
            compared(f"{prefix}combined uncertainty over its scale, {name}", "",
                     Reference(kind="FEM", source=_source(comparison)), [0.0],
                     [max(difference.uncertainty for difference in judged)], asked, measured, "absolute",
                     basis="required", pinned="unconverged")
            for name, judged, (asked, measured) in (("largest of all but displacement", others, ASKED),
                ("displacement", [displacement], ASKED_OF_DISPLACEMENT))
        ]  # fmt: skip
    return found


def _judged(prefix: str, difference: Difference, comparison: Comparison) -> Row:
    """The row of a quantity: nothing but the uncertainties of both decides."""
    order = 2 if comparison.fem is None else comparison.fem.resolution.order
    reference = Reference(kind="FEM", source=_source(comparison), uncertainty=difference.fem_uncertainty)
    return within(prefix + difference.quantity, difference.unit, reference, difference.fem, difference.bem,
                  difference.bem_uncertainty, difference.scale, TAKEN[order])  # fmt: skip


def within(
    quantity: str,
    unit: str,
    reference: Reference,
    expected: list[float],
    computed: list[float],
    uncertainty: float,
    scale: float,
    taken: float,
) -> Row:
    """A row judged by twice the uncertainties of both sides; `taken` is the share of it that was measured."""
    allowed = max(2.0 * (uncertainty + reference.uncertainty) / scale, ROUNDING)
    return compared(quantity, unit, reference, expected, computed, allowed, taken * allowed, "absolute", scale,
                    basis="required", uncertainty=uncertainty)  # fmt: skip


def _source(comparison: Comparison) -> str:
    fem = comparison.fem
    if fem is None:
        return "fem_reference"
    kind = {2: "P2/P1", 4: "P4/P3"}[fem.resolution.order]
    return f"fem_reference, {kind}, {fem.unknowns} unknowns"


def counts(comparisons: list[Comparison]) -> dict[str, int]:
    """Largest numbers of unknowns of both codes."""
    return {
        "unknowns": max((c.state.evaluation.unknowns for c in comparisons if c.state is not None), default=0),
        "unknowns of the finite elements": max((c.fem.unknowns for c in comparisons if c.fem is not None), default=0),
    }
