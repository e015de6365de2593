"""Boundary elements against finite elements: equilibria of layers on unequal crests, each code with its own edges.

One case for every kind of scene at the coarse elements (quick) and at the fine ones (standard), and all thicknesses
with all Poisson's ratios (full). How both are compared: fem_comparison.py.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from validation.cases.finite_elements.fem_comparison import (
    EQUATIONS,
    SOURCES,
    Comparison,
    Difference,
    compare_equilibria,
    compare_prescribed,
    counts,
    rows,
)
from validation.cases.finite_elements.fem_figures import figure
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import drawn, loglog, marks, semilogx, trace
from validation.harness.schema import Figure, Table
from validation.references import adapters

PERIOD = 0.01
THICKNESSES = (0.05, 0.1, 0.5, 2.0)  # in periods
RATIOS = (0.3, 0.45, 0.49, 0.5)
Changes = dict[str, dict[str, Any] | None]

EDGES = np.array([[4.9e-3, 6.3e-3], [8.8e-3, 11.4e-3]])  # under the two crests, wider and narrower than equilibrium
PENETRATION = 50e-6

LOAD: Changes = {"loading": {"control": "mean_pressure", "targets": [1e4]}, "accuracy": {"max_increment": 5.0}}
SCENES: dict[str, tuple[str, int, Changes]] = {
    "two-patches": ("layer_two_crests", 2, {}),
    "two-patches-thin": ("layer_two_crests", 2, {"layer": {"thickness": 1e-3}, "solid": {"poisson_ratio": 0.49}}),
    "two-patches-load": ("layer_two_crests", 2, {**LOAD, "solid": {"poisson_ratio": 0.45}}),
    "without-adhesion": (
        "layer_two_crests",
        2,
        {**LOAD, "adhesion": None, "layer": {"thickness": 2e-3}, "solid": {"poisson_ratio": 0.5}},
    ),
    "three-patches": ("layer_three_crests", 3, {"layer": {"thickness": 2e-3}, "solid": {"poisson_ratio": 0.49}}),
    "three-patches-load": ("layer_three_crests", 3, {**LOAD, "layer": {"thickness": 2e-2}}),
}


def _equilibrium(name: str, elements: str) -> Outcome:
    scene, patches, changes = SCENES[name]
    found = compare_equilibria("", adapters.scene(scene, changes), elements, patches)
    caption = f"Pressure under {patches} unequal patches, {name.replace('-', ' ')}, {elements}."
    return Outcome(
        rows=tuple(rows(found)), figures=tuple(figure(f"fem-{name}", caption, found)), counts=counts([found])
    )


def _prescribed(elements: str) -> Outcome:
    found = [
        compare_prescribed(
            f"d/lambda {thickness:g}, nu {ratio:g}", _layer(thickness, ratio), elements, EDGES, PENETRATION
        )
        for thickness, ratio in ((0.1, 0.49), (0.5, 0.3))
    ]
    caption = f"Pressure of given patches at given penetration, {found[0].label}, {elements}."
    return Outcome(
        rows=tuple(row for comparison in found for row in rows(comparison)),
        figures=tuple(figure("fem-prescribed", caption, found[0])),
        counts=counts(found),
    )


def _layer(thickness: float, ratio: float) -> Any:
    """The scene of two crests on a layer of a thickness in periods."""
    changes: Changes = {"layer": {"thickness": thickness * PERIOD}, "solid": {"poisson_ratio": ratio}}
    return adapters.scene("layer_two_crests", changes)


def _layers() -> Outcome:
    found = {
        (thickness, ratio): compare_equilibria(
            f"d/lambda {thickness:g}, nu {ratio:g}", _layer(thickness, ratio), "P4/P3", 2
        )
        for thickness in THICKNESSES
        for ratio in RATIOS
    }
    solved = {place: comparison for place, comparison in found.items() if comparison.differences}
    return Outcome(
        rows=tuple(row for comparison in found.values() for row in rows(comparison)),
        figures=(_layers_figure(solved),),
        tables=tuple(
            Table(
                caption=caption,
                columns=["d/lambda", *(f"nu = {ratio:g}" for ratio in RATIOS)],
                rows=[
                    [thickness, *(_shown(found[thickness, ratio], largest) for ratio in RATIOS)]
                    for thickness in THICKNESSES
                ],
            )
            for caption, largest in (
                (
                    "Largest |BEM - FEM| over 2 (u_BEM + u_FEM) of all quantities: at most 1 where the codes agree.",
                    True,
                ),
                ("Largest combined uncertainty over its scale, displacement at single points left out.", False),
            )
        ),
        counts=counts(list(found.values())),
    )


def _shown(comparison: Comparison, ratio: bool) -> float | str:
    """Largest difference over what is allowed, or largest combined uncertainty, as it stands in a table."""
    if not comparison.differences:
        return comparison.failure
    if ratio:
        return float(f"{max(d.largest / (2 * d.uncertainty) for d in comparison.differences):.2g}")
    return float(f"{max(d.uncertainty for d in comparison.differences[:-1]):.2g}")


def _layers_figure(found: dict[tuple[float, float], Comparison]) -> Figure:
    """Differences and combined uncertainty against thickness above; below, the signed difference of the energy."""

    def edges(place: tuple[float, float]) -> Difference:
        return next(d for d in found[place].differences if d.quantity == "edges")

    thicknesses = sorted({thickness for thickness, _ in found})
    apart = [
        marks(f"nu = {ratio:g}", [thickness for thickness, nu in found if nu == ratio],
              [edges((thickness, nu)).largest for thickness, nu in found if nu == ratio])
        for ratio in RATIOS
    ]  # fmt: skip
    least = trace("combined uncertainty, least", thicknesses,
                  [min(edges(place).uncertainty for place in found if place[0] == d) for d in thicknesses],
                  "dashed")  # fmt: skip
    signed = [
        marks(f"nu = {ratio:g}", [d for (d, nu) in found if nu == ratio],
              [_signed(c, "elastic energy per area") for (_, nu), c in found.items() if nu == ratio])
        for ratio in RATIOS
    ]  # fmt: skip
    return drawn(
        "fem-layers",
        "Two unequal patches: largest difference of an edge between the codes (points) and their combined "
        "uncertainty (dashed, least of the four ratios), in periods. Below, the signed difference of the elastic "
        "energy, relative.",
        loglog("layer thickness / period", "|BEM - FEM| of the edges / period", *apart, least),
        semilogx("layer thickness / period", "signed difference of energy", *signed),
    )


def _signed(comparison: Comparison, quantity: str) -> float:
    chosen = next(d for d in comparison.differences if d.quantity == quantity)
    return (chosen.bem[0] - chosen.fem[0]) / chosen.scale


def _case(
    name: str, elements: str, level: Any, compute: Any, question: str, scene: str, effects: tuple[str, ...]
) -> Case:
    return Case(id=f"fem-{name}" + ("-coarse" if elements == "P2/P1" else ""),
                group="boundary elements against finite elements", level=level,
                problem=f"{name.replace('-', ' ')} on a layer",
                question=question,
                equations=EQUATIONS,
                sources=SOURCES, compute=compute, effects=effects, scene=adapters.scene_text(scene))  # fmt: skip


def _effects(name: str) -> tuple[str, ...]:
    without = SCENES[name][2].get("adhesion", {}) is None
    return (
        "layer",
        *(() if without else ("adhesion", "slope_term")),
        *(("load_control",) if "loading" in SCENES[name][2] else ()),
    )


def _equilibrium_case(name: str, elements: str, level: str) -> Case:
    scene, patches, _ = SCENES[name]
    question = f"Do both codes find the same equilibrium of {patches} unequal patches ({name.replace('-', ' ')})?"
    return _case(name, elements, level, partial(_equilibrium, name, elements), question, scene, _effects(name))


def _prescribed_case(elements: str, level: str) -> Case:
    question = "Do both codes find the same load, energy, stress intensities and fields at given edges?"
    return _case(
        "prescribed-edges", elements, level, partial(_prescribed, elements), question, "layer_two_crests", ("layer",)
    )


CASES = (
    _prescribed_case("P2/P1", "quick"),
    _equilibrium_case("two-patches", "P2/P1", "quick"),
    _equilibrium_case("without-adhesion", "P2/P1", "quick"),
    _prescribed_case("P4/P3", "standard"),
    _equilibrium_case("two-patches-thin", "P4/P3", "standard"),
    _equilibrium_case("without-adhesion", "P4/P3", "standard"),
    _equilibrium_case("three-patches", "P4/P3", "standard"),
    _equilibrium_case("two-patches-load", "P4/P3", "full"),
    _equilibrium_case("three-patches-load", "P4/P3", "full"),
    _case(
        "layers",
        "P4/P3",
        "full",
        _layers,
        "Do both codes agree on two unequal patches for thin and thick, compressible and incompressible layers?",
        "layer_two_crests",
        ("layer", "adhesion", "slope_term"),
    ),
)
