"""Energy release rate at equilibrium: both codes by differences of their energies, and by what each closes with.

At the edges that each code found for itself,

    finite elements   dU/dx of an edge at fixed plate, meshes made anew (fem_reference/energy_difference.py),
    boundary elements K^2 / (2 E*), and dU/dx of an edge at fixed penetration, by differences of their own energy,

which is the work of adhesion w = gamma sqrt(1 + h'^2) there: a closure imposes its own K, but no difference of
energies. SI units.
"""

from typing import Any

import numpy as np

import bem
from bem.scene.scene import Scene
from fem_reference.energy_difference import energy_difference
from validation.cases.finite_elements.fem_comparison import COARSER, GROUP, within
from validation.cases.shared.checks import Against, Found, beside, in_forms, posed
from validation.harness.arrays import FloatArray
from validation.references import fem_adapter

SCENES: dict[str, tuple[str, int, dict[str, Any]]] = {  # scene, patches, changes
    "one crest": ("layer_sinusoid", 1, {"loading": {"targets": [20e-6]}}),
    "two crests": ("layer_two_crests", 2, {}),
}
STEP = 0.003  # of the shorter of the patch and the gap beside an edge
BEM_ERROR = 2e-7  # of w: three times what the difference of the energies of boundary elements was off by (7e-8)


def _difference_of_bem(scene: Scene, edges: FloatArray, penetration: float) -> FloatArray:
    """G (n_patches, 2) in J/m^2: fourth-order differences of the elastic energy at fixed penetration."""
    rates, steps = np.zeros(edges.shape), STEP * beside(edges, scene.surface().period)
    for place in np.ndindex(*edges.shape):
        total = 0.0
        for k, weight in ((1, 8.0), (-1, -8.0), (2, -1.0), (-2, 1.0)):
            moved = edges.copy()
            moved[place] += k * steps[place] * (1.0 if place[1] else -1.0)
            total += weight * fem_adapter.contact_state(scene, moved, penetration).elastic_energy
        rates[place] = total / (12 * steps[place])
    return rates


def _rates(elements: str, label: str) -> Found:
    name, patches, changes = SCENES[label]
    scene = posed(name, **changes)
    state, fem = bem.solve(scene).targets[-1], fem_adapter.solve_fem(scene, COARSER[elements], patches)
    if state.status != "converged" or fem.status != "converged":
        raise ArithmeticError(f"{label}: boundary elements {state.status}, finite elements {fem.status}")
    found, uncertain = energy_difference(fem)
    spread, edges = float(np.max(uncertain)), np.array(state.edges)
    elastic = fem_adapter.contact_state(scene, edges, state.penetration)
    assert scene.adhesion is not None
    work = scene.adhesion.work_of_adhesion
    slope = scene.surface().slope(fem.edges) if scene.adhesion.slope_term else 0.0 * fem.edges
    by_energies = Against("FEM", f"fem_reference, {elements}, by its energies", spread)
    ours = f"{label}: G of the boundary elements"
    yield within(f"{ours}, K^2 / 2 E*", "J/m^2", by_energies, found, elastic.energy_release_rate, BEM_ERROR * work,
                 work)  # fmt: skip
    yield within(f"{ours}, by differences of energies", "J/m^2", by_energies, found,
                 _difference_of_bem(scene, edges, state.penetration), BEM_ERROR * work, work)  # fmt: skip
    yield within(f"{label}: G of the finite elements, by differences of energies", "J/m^2",
                 Against("exact", "the work of adhesion at the edges"), work * np.sqrt(1 + slope**2), found, spread,
                 work, "fem")  # fmt: skip
    yield {"unknowns of the finite elements": fem.unknowns}


CASES = tuple(in_forms(
    {"fem-release-rate-coarse": ("quick", "P2/P1", "one crest"),
     "fem-release-rate": ("standard", "P4/P3", "one crest"),
     "fem-release-rate-two": ("full", "P4/P3", "two crests")}, GROUP, _rates,
    "Is the energy that opening an edge releases the same by differences of both codes' energies?",
    r"$G = dU / d\xi = K^2 / (2 E^\ast) = \gamma \sqrt{1 + h'^2}$ at every edge",
    "carbone2009 destuynder1983 shih1986", "layer adhesion slope_term", scene="layer_two_crests"))  # fmt: skip
