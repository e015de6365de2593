"""Boundary elements against finite elements: equilibria of layers on unequal crests, each code with its own edges.

One case for every kind of scene at the coarse elements (quick) and at the fine ones (standard), and all thicknesses
with all Poisson's ratios (full). How both are compared: fem_comparison.py.
"""

from functools import partial
from typing import Any

import numpy as np

from bem.scene.scene import Scene
from validation.cases.finite_elements import fem_comparison
from validation.cases.finite_elements.fem_comparison import Comparison, compare_equilibria, compare_prescribed
from validation.cases.shared.checks import case, posed
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import drawn, loglog, marks, semilogx, trace
from validation.harness.schema import Figure, Level, Table

PERIOD = 0.01
THICKNESSES = (0.05, 0.1, 0.5, 2.0)  # in periods
RATIOS = (0.3, 0.45, 0.49, 0.5)
EDGES = np.array([[4.9e-3, 6.3e-3], [8.8e-3, 11.4e-3]])  # under the two crests, wider and narrower than equilibrium
PENETRATION = 50e-6


def _layer(thickness: float, ratio: float) -> dict[str, Any]:
    """A layer of a thickness in periods."""
    return {"layer": {"thickness": thickness * PERIOD}, "solid": {"poisson_ratio": ratio}}


LOAD = {"loading": {"control": "mean_pressure", "targets": [1e4]}, "accuracy": {"max_increment": 5.0}}
SCENES: dict[str, tuple[str, int, dict[str, Any]]] = {  # scene, patches, changes
    "two-patches": ("layer_two_crests", 2, {}),
    "two-patches-thin": ("layer_two_crests", 2, _layer(0.1, 0.49)),
    "two-patches-load": ("layer_two_crests", 2, {**LOAD, "solid": {"poisson_ratio": 0.45}}),
    "without-adhesion": ("layer_two_crests", 2, {**LOAD, "adhesion": None, **_layer(0.2, 0.5)}),
    "three-patches": ("layer_three_crests", 3, _layer(0.2, 0.49)),
    "three-patches-load": ("layer_three_crests", 3, {**LOAD, "layer": {"thickness": 2e-2}}),
}


def _outcome(found: list[Comparison], *figures: Figure, tables: tuple[Table, ...] = ()) -> Outcome:
    rows = (row for comparison in found for row in fem_comparison.rows(comparison))
    return Outcome(rows=tuple(rows), figures=figures, tables=tables, counts=fem_comparison.counts(found))


def _equilibrium(name: str, elements: str) -> Outcome:
    scene, patches, changes = SCENES[name]
    found = compare_equilibria("", posed(scene, **changes), elements, patches)
    caption = f"Pressure under {patches} unequal patches, {name.replace('-', ' ')}, {elements}."
    return _outcome([found], *fem_comparison.figure(f"fem-{name}", caption, found))


def _crests(thickness: float, ratio: float) -> tuple[str, Scene]:
    """A label, and two crests on a layer."""
    return f"d/lambda {thickness:g}, nu {ratio:g}", posed("layer_two_crests", **_layer(thickness, ratio))


def _prescribed(elements: str) -> Outcome:
    found = [compare_prescribed(*_crests(*layer), elements, EDGES, PENETRATION) for layer in ((0.1, 0.49), (0.5, 0.3))]
    caption = f"Pressure of given patches at given penetration, {found[0].label}, {elements}."
    return _outcome(found, *fem_comparison.figure("fem-prescribed", caption, found[0]))


def _layers() -> Outcome:
    found = {(d, nu): compare_equilibria(*_crests(d, nu), "P4/P3", 2) for d in THICKNESSES for nu in RATIOS}
    captions = {
        "share": "Largest |BEM - FEM| over the combined uncertainty of all quantities: at most 1 where codes agree.",
        "uncertainty": "Largest combined uncertainty over its scale, displacement at single points left out.",
    }
    tables = (
        Table(caption=caption, columns=["d/lambda", *(f"nu = {nu:g}" for nu in RATIOS)],
              rows=[[d, *(one.shown(name) for one in (found[d, nu] for nu in RATIOS))] for d in THICKNESSES])
        for name, caption in captions.items()
    )  # fmt: skip
    figure = _layers_figure({place: one for place, one in found.items() if one.differences})
    return _outcome(list(found.values()), figure, tables=tuple(tables))


def _layers_figure(found: dict[tuple[float, float], Comparison]) -> Figure:
    """Differences and combined uncertainty against thickness above; below, the signed difference of the energy."""
    edges = {place: one.of("edges") for place, one in found.items()}
    energy = {place: one.of("elastic energy per area") for place, one in found.items()}
    at = {ratio: [place for place in found if place[1] == ratio] for ratio in RATIOS}
    thicknesses = sorted({thickness for thickness, _ in found})
    least = [min(one.uncertainty for place, one in edges.items() if place[0] == d) for d in thicknesses]
    return drawn(
        "fem-layers",
        "Two unequal patches: largest difference of an edge between the codes (points) and their combined "
        "uncertainty (dashed, least of the four ratios), in periods. Below, the signed difference of the elastic "
        "energy, relative.",
        loglog("layer thickness / period", "|BEM - FEM| of the edges / period",
               *(marks(f"nu = {ratio:g}", [d for d, _ in at[ratio]], [edges[place].largest for place in at[ratio]])
                 for ratio in RATIOS),
               trace("combined uncertainty, least", thicknesses, least, "dashed")),
        semilogx("layer thickness / period", "signed difference of energy",
                 *(marks(f"nu = {ratio:g}", [d for d, _ in at[ratio]],
                         [(one.bem[0] - one.fem[0]) / one.scale for one in map(energy.get, at[ratio]) if one])
                   for ratio in RATIOS)),
    )  # fmt: skip


def _case(name: str, elements: str, level: Level, compute: Any, question: str, scene: str, effects: str) -> Case:
    coarse = "-coarse" if elements == "P2/P1" else ""
    return case(f"fem-{name}{coarse}", fem_comparison.GROUP, compute, question, fem_comparison.EQUATIONS,
                fem_comparison.SOURCES, effects, level=level, scene=scene,
                problem=f"{name.replace('-', ' ')} on a layer")  # fmt: skip


def _equilibrium_case(name: str, elements: str, level: Level) -> Case:
    scene, patches, changes = SCENES[name]
    adhesive, loaded = changes.get("adhesion", {}) is not None, "loading" in changes
    effects = f"layer {'adhesion slope_term' if adhesive else ''} {'load_control' if loaded else ''}"
    question = f"Do both codes find the same equilibrium of {patches} unequal patches ({name.replace('-', ' ')})?"
    return _case(name, elements, level, partial(_equilibrium, name, elements), question, scene, effects)


def _prescribed_case(elements: str, level: Level) -> Case:
    return _case("prescribed-edges", elements, level, partial(_prescribed, elements),
                 "Do both codes find the same load, energy, stress intensities and fields at given edges?",
                 "layer_two_crests", "layer")  # fmt: skip


CASES = (
    _prescribed_case("P2/P1", "quick"),
    _equilibrium_case("two-patches", "P2/P1", "quick"),
    _equilibrium_case("without-adhesion", "P2/P1", "quick"),
    _prescribed_case("P4/P3", "standard"),
    _equilibrium_case("two-patches-thin", "P4/P3", "standard"),
    _equilibrium_case("without-adhesion", "P4/P3", "standard"),
    _equilibrium_case("three-patches", "P2/P1", "standard"),  # at the fine ones: fem-matrix, and in full
    _equilibrium_case("three-patches", "P4/P3", "full"),
    _equilibrium_case("two-patches-load", "P4/P3", "full"),
    _equilibrium_case("three-patches-load", "P4/P3", "full"),
    _case("layers", "P4/P3", "full", _layers,
          "Do both codes agree on two unequal patches for thin and thick, compressible and incompressible layers?",
          "layer_two_crests", "layer adhesion slope_term"),
)  # fmt: skip
