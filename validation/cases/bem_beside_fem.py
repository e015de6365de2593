"""Scene by boundary elements and by finite elements: the numbers compared, with the uncertainty of each code.

For every quantity |BEM - FEM| <= 2 U, U = sqrt(u_BEM^2 + u_FEM^2), and at most a share of its scale (CEILINGS): where U
alone is beyond that, nothing is established and the row fails.  u_FEM comes from the three meshes of the reference and
holds 95 % of its errors (test_fem_calibration.py): of many numbers one in twenty lies beyond U, hardly one beyond 2 U.
u_BEM is the error that a state estimates (test_error_estimate.py), of the contact fraction for the edges; at given
edges and at points it is the change by the tolerance COARSER instead of 1e-12.  Scales: rms height for heights, largest
pressure in the middle of a patch for stresses, that times sqrt(period) for stress intensities.

Contact fraction, total displacement and total energy follow from edges, penetration and mean pressure, and the other
energies: rows by construction.

Stress intensities are compared at given edges alone, because both codes impose them at an equilibrium.  Displacements
behave as a square root at edges and pressures diverge: displacements are compared no nearer to an edge than a tenth of
the patch or gap beside it, pressures under a smooth weight on the inner 0.8 of each patch.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import bem
from bem.scene.scene import Scene
from bem.scene.state import State
from fem_reference import Resolution, Result
from validation.harness.arrays import FloatArray
from validation.plugin.rows import Code, Quantity, Rows
from validation.routes.fem_scenes import middle_pressure, solve_fem, uncertain
from validation.routes.scenes import contact_state, edge_scale

RESOLUTIONS = {
    "P2/P1": Resolution(2, 10, 10),
    "P2/P1, 12 cells": Resolution(2, 12, 10),
    "P4/P3": Resolution(4, 8, 18),
}
TWICE, CEILINGS = 2.0, {Quantity.EDGES: 1e-3, Quantity.POINTS: 0.05}  # most that is allowed, of the scale
CEILING = 0.01  # of all other quantities: the theory differs from both solvers by a tenth and more
DERIVED = ("contact fraction", "total displacement", "total energy")  # rows by construction
COARSER = 1e-8  # tolerance of a second elastic state, whose numbers differ by more than the error of the first
ROUNDING = 1e-11  # of the scale: left by doubles where finite elements state less
AWAY = 0.1  # of the patch or gap beside an edge
ASIDE = 0.1  # of a patch or gap: offset of the edges from which finite elements start where several equilibria exist
POINTS = 48  # at which displacements are compared
ELASTIC = ("converged", "negative_stress_intensity", "interpenetration")  # at given edges: a state, whatever K


def compare_codes(rows: Rows, name: str, ours: ArrayLike, theirs: ArrayLike, uncertainty: tuple[Any, Any], scale: float,
                  *, quantity: Quantity, ceiling: float = CEILING, times: float = TWICE,
                  unknown: list[Any] | None = None, **options: Any) -> float | None:
    """Add a row of two codes, allowed some times the combined U and at most a ceiling, and return its share of U.

    Where U alone is beyond the ceiling, a share of the scale, the row fails, or `unknown` gets its numbers (None).
    """
    combined, share = float(np.max(np.hypot(*uncertainty))), CEILINGS.get(quantity, ceiling)
    given = {"of": Code.BEM, "by": Code.FEM, "quantity": quantity} | options
    if combined <= share * scale:
        because = f"{times:g} U of both sides (U of finite elements holds 95 %), at most {share:g} of the scale"
        rows.compare(name, ours, theirs, uncertainty=uncertainty, because=because,
                     required=min(times * combined, share * scale), **given)
    elif unknown is not None:
        unknown.append([name, ours, theirs, combined])
        return None
    else:
        message = f"not established: U {combined:.2g} is beyond {share * scale:.2g}, {share:g} of the scale"
        rows.not_converged(name, message, of=given["of"], by=given["by"], quantity=quantity)
    return float(np.max(np.abs(np.subtract(ours, theirs)))) / combined


@dataclass(frozen=True)
class Difference:
    """Quantity by both codes, with the uncertainty of each and a scale, all in `unit`."""

    name: str
    quantity: Quantity
    unit: str
    bem: FloatArray
    fem: FloatArray
    bem_uncertainty: float
    fem_uncertainty: float
    scale: float


@dataclass(frozen=True)
class Comparison:
    """A scene by both codes; without differences a code has no state, and `failure` states the reason."""

    differences: tuple[Difference, ...]
    fem: Result | None = None
    state: bem.ContactState | None = None  # the boundary elements at their edges
    failure: str = ""

    def add_to(self, rows: Rows, label: str = "", times: float = TWICE) -> None:
        """Add a row for every difference, allowed some times the combined U, or a failed row."""
        prefix = f"{label}: " if label else ""
        if not self.differences or self.fem is None:
            rows.not_converged(f"{prefix}equilibrium", self.failure, of=Code.BEM, by=Code.FEM, quantity=Quantity.EDGES)
            return
        resolution = self.fem.resolution
        source = f"P{resolution.order}/P{resolution.order - 1}, {self.fem.unknowns} unknowns"
        for each in self.differences:
            compare_codes(rows, prefix + each.name, each.bem, each.fem, (each.bem_uncertainty, each.fem_uncertainty),
                          each.scale, quantity=each.quantity, times=times, unit=each.unit, source=source,
                          kind="construction" if each.name in DERIVED else "accuracy")

    def shares(self) -> list[float]:
        """Return each difference that does not follow from others over its combined uncertainty."""
        return [float(np.max(np.abs(d.bem - d.fem)) / np.hypot(d.bem_uncertainty, d.fem_uncertainty))
                for d in self.differences if d.name not in DERIVED]


def compare_equilibria(scene: Scene, elements: str, patches: int | None) -> Comparison:
    """Compare the equilibria at the last target of a scene with a layer; each code finds its own edges.

    `patches` is the number that the finite elements look for.  If None, they start from the boundary elements' edges,
    shifted by `ASIDE`, because several equilibria exist and the path decides which one is meant.
    """
    result = bem.solve(scene)
    state = result.targets[-1]
    if state.status != "converged" or not state.certificate.ok:
        return Comparison((), failure=f"boundary elements: {state.status}, {result.failure}")
    edges, period = np.array(state.edges), scene.surface().period
    start = None if patches else edges + ASIDE * edge_scale(edges, period) * np.array([-1.0, 1.0])
    fem = solve_fem(scene, RESOLUTIONS[elements], patches or len(edges), start=start)
    if fem.status != "converged" or fem.edges.shape != (state.n_patches, 2):
        why = f"finite elements: {fem.status} with {len(fem.edges)} patches of {state.n_patches}. {fem.message}"
        return Comparison((), fem, failure=why)
    elastic = contact_state(scene, edges, state.penetration)
    return Comparison(tuple(differences(scene, fem, elastic, state)), fem, elastic)


def compare_prescribed(scene: Scene, elements: str, edges: FloatArray, penetration: float) -> Comparison:
    """Compare the elastic states at edges (n_patches, 2) and penetration, m, given to both codes."""
    fem = solve_fem(scene, RESOLUTIONS[elements], edges=edges)
    state = contact_state(scene, edges, penetration)
    if fem.status not in ELASTIC:
        return Comparison((), fem, failure=f"finite elements: {fem.status}. {fem.message}")
    return Comparison(tuple(differences(scene, fem, state, None)), fem, state)


def differences(scene: Scene, fem: Result, elastic: bem.ContactState, state: State | None) -> Iterator[Difference]:
    """Yield every quantity that both codes compute and that is not prescribed; `state` is None at given edges."""
    own: Any = state.error_estimate if state else None
    known, coarse = fem.uncertainty, contact_state(scene, elastic.edges, elastic.penetration, COARSER)
    height, period, control = fem.problem.unit_height, fem.problem.period, scene.loading.control
    prescribed = "penetration" if control == "separation" else control
    middle = middle_pressure(elastic)
    scale = float(np.max(np.abs(middle)))

    def changes(of: Callable[[bem.ContactState], ArrayLike]) -> float:
        return float(np.max(np.abs(np.subtract(of(elastic), of(coarse)))))

    def difference(name: str, quantity: Quantity, unit: str, ours: ArrayLike, theirs: ArrayLike, own: float,
                   uncertainty: Any, scale: float) -> Difference:
        spread = max(float(np.max(uncertainty)), ROUNDING * scale)
        return Difference(name, quantity, unit, np.ravel(ours), np.ravel(theirs), own, spread, scale)

    if state is not None:
        yield difference("edges", Quantity.EDGES, "m", state.edges, fem.edges, own.contact_fraction * period,
                         known["edges"], period)
        yield difference("contact fraction", Quantity.AREA, "", state.contact_fraction, fem.contact_fraction,
                         own.contact_fraction, known["contact_fraction"], 1.0)
        for key in ("penetration", "total_displacement"):
            if key != prescribed and getattr(state, key) is not None:
                yield difference(key.replace("_", " "), Quantity.LENGTH, "m", getattr(state, key), getattr(fem, key),
                                 getattr(own, key), known[key], height)
    if prescribed != "mean_pressure":
        ours, u_ours = ((elastic.mean_pressure, changes(lambda s: s.mean_pressure)) if state is None
                        else (state.mean_pressure, own.mean_pressure))
        yield difference("mean pressure", Quantity.PRESSURE, "Pa", ours, fem.mean_pressure, u_ours,
                         known["mean_pressure"], scale)
    yield difference("pressure away from the edges", Quantity.POINTS, "Pa", middle, fem.middle_pressure,
                     changes(middle_pressure), known["middle_pressure"], scale)
    if state is None:
        root, energy = scale * float(np.sqrt(period)), elastic.elastic_energy
        yield difference("stress intensity", Quantity.INTENSITY, "Pa m^1/2", elastic.stress_intensity,
                         fem.stress_intensity, changes(lambda s: s.stress_intensity), known["stress_intensity"], root)
        yield difference("elastic energy per period", Quantity.ENERGY, "J/m", energy, fem.elastic_energy,
                         changes(lambda s: s.elastic_energy), known["elastic_energy"], abs(energy))
    else:
        energy = abs(state.elastic_energy)
        for key in ("elastic_energy", "total_energy") if scene.adhesion is not None else ("elastic_energy",):
            yield difference(key.replace("_", " "), Quantity.ENERGY, "J/m^2", getattr(state, key),
                             getattr(fem, key) / period, getattr(own, key), np.asarray(known[key]) / period, energy)
    x = away_from_edges(fem)
    spread = float(np.max(fem.uncertainty_at("displacement", x))) + 2 * uncertain(fem, "penetration")
    yield difference("displacement away from the edges", Quantity.POINTS, "m", elastic.displacement(x),
                     fem.displacement(x) - (fem.total_displacement - fem.penetration),
                     changes(lambda s: s.displacement(x)), spread, height)


def away_from_edges(fem: Result) -> FloatArray:
    """Return equally spaced positions from the first edge on, at most POINTS, in m, without those near an edge."""
    knots = np.append(fem.edges.ravel(), fem.edges[0, 0] + fem.problem.period)
    x = knots[0] + (np.arange(POINTS) + 0.5) / POINTS * fem.problem.period
    place = np.searchsorted(knots, x) - 1
    share = (x - knots[place]) / np.diff(knots)[place]
    return np.asarray(x[(share > AWAY) & (share < 1 - AWAY)])


def figure(rows: Rows, title: str, comparison: Comparison) -> None:
    """Add a figure of the pressure along the layer by both codes."""
    fem, state = comparison.fem, comparison.state
    if fem is None or state is None:
        return
    scale, period, x = float(np.max(np.abs(fem.middle_pressure))), fem.problem.period, fem.interface.x
    line = np.linspace(x[0], x[0] + period, 400)
    ours, theirs = np.nan_to_num(state.pressure(line)), fem.interface.pressure
    shown, on = np.abs(theirs) < 1.5 * scale, np.abs(ours) < 1.5 * scale  # pressures are infinite at edges
    rows.curves(title, "x / mm", "pressure / kPa",
                {"boundary elements": (line[on] * 1e3, ours[on] / 1e3),
                 "finite elements": (x[shown] * 1e3, theirs[shown] / 1e3)})
