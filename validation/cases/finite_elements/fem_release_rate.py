"""Energy release rate at equilibrium: both codes by differences of their energies, and by what each closes with.

At the edges that each code found for itself,

    finite elements   dU/dx of an edge at fixed plate, meshes made anew (fem_reference/energy_difference.py),
    boundary elements K^2 / (2 E*), and dU/dx of an edge at fixed penetration, by differences of their own energy,

which is the work of adhesion w = gamma sqrt(1 + h'^2) there: a closure imposes its own K, but no difference of
energies. SI units.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

import bem
from fem_reference.energy_difference import energy_difference
from validation.cases.finite_elements.fem_comparison import RESOLUTIONS, TAKEN, flat, within
from validation.harness.arrays import FloatArray
from validation.harness.case import Case, Outcome
from validation.harness.schema import Reference, Row
from validation.references import adapters, fem_adapter

SCENES: dict[str, tuple[str, int, dict[str, Any]]] = {
    "one crest": ("layer_sinusoid", 1, {"loading": {"targets": [20e-6]}}),
    "two crests": ("layer_two_crests", 2, {}),
}
STEP = 0.003  # of the shorter of the patch and the gap beside an edge
BEM_ERROR = 2e-7  # of w: three times what the difference of the energies of boundary elements was off by (7e-8)


def _difference_of_bem(posed: Any, edges: FloatArray, penetration: float) -> FloatArray:
    """G (n_patches, 2) in J/m^2: fourth-order differences of the elastic energy at fixed penetration."""
    rates, period = np.zeros(edges.shape), posed.surface().period
    lengths = np.diff(np.append(edges.ravel(), edges[0, 0] + period))
    for place in np.ndindex(*edges.shape):
        edge = 2 * place[0] + place[1]
        step = STEP * min(lengths[edge], lengths[edge - 1])
        total = 0.0
        for k, weight in ((1, 8.0), (-1, -8.0), (2, -1.0), (-2, 1.0)):
            moved = edges.copy()
            moved[place] += k * step * (1.0 if place[1] else -1.0)
            total += weight * fem_adapter.contact_state(posed, moved, penetration).elastic_energy
        rates[place] = total / (12 * step)
    return rates


def _rates(elements: str, chosen: tuple[str, ...]) -> Outcome:
    rows: list[Row] = []
    unknowns = 0
    for label in chosen:
        name, patches, changes = SCENES[label]
        posed = adapters.scene(name, changes)
        state = bem.solve(posed).targets[-1]
        fem = fem_adapter.solve_fem(posed, RESOLUTIONS[elements], patches)
        if state.status != "converged" or fem.status != "converged":
            raise ArithmeticError(f"{label}: boundary elements {state.status}, finite elements {fem.status}")
        found, uncertain = energy_difference(fem)
        edges = np.array(state.edges)
        elastic = fem_adapter.contact_state(posed, edges, state.penetration)
        assert posed.adhesion is not None
        work = posed.adhesion.work_of_adhesion
        reference = Reference(kind="FEM", source=f"fem_reference, {elements}, by its energies",
                              uncertainty=float(np.max(uncertain)))  # fmt: skip
        slope = posed.surface().slope(fem.edges) if posed.adhesion.slope_term else 0.0 * fem.edges
        taken = TAKEN[fem.resolution.order]
        for quantity, computed in (
            ("K^2 / 2 E*", elastic.energy_release_rate),
            ("by differences of energies", _difference_of_bem(posed, edges, state.penetration)),
        ):
            rows.append(within(f"{label}: G of the boundary elements, {quantity}", "J/m^2", reference, flat(found),
                               flat(computed), BEM_ERROR * work, work, taken))  # fmt: skip
        adhesion = Reference(kind="exact", source="the work of adhesion at the edges")
        rows.append(within(f"{label}: G of the finite elements, by differences of energies", "J/m^2", adhesion,
                           flat(work * np.sqrt(1 + slope**2)), flat(found), float(np.max(uncertain)), work,
                           taken))  # fmt: skip
        unknowns = max(unknowns, fem.unknowns)
    return Outcome(rows=tuple(rows), counts={"unknowns of the finite elements": unknowns})


def _case(name: str, level: Any, elements: str, chosen: tuple[str, ...]) -> Case:
    return Case(id=name, group="boundary elements against finite elements", level=level,
                question="Is the energy that opening an edge releases the same by differences of both codes' energies?",
                equations=r"$G = dU / d\xi = K^2 / (2 E^\ast) = \gamma \sqrt{1 + h'^2}$ at every edge",
                sources=("carbone2009", "destuynder1983", "shih1986"), compute=partial(_rates, elements, chosen),
                effects=("layer", "adhesion", "slope_term"), scene=adapters.scene_text("layer_two_crests"))  # fmt: skip


CASES = (
    _case("fem-release-rate-coarse", "quick", "P2/P1", ("one crest",)),
    _case("fem-release-rate", "standard", "P4/P3", ("one crest",)),
    _case("fem-release-rate-two", "full", "P4/P3", ("two crests",)),
)
