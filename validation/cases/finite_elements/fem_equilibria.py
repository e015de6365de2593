"""Boundary elements against finite elements: equilibria of layers, each code with its own edges.

- Unequal crests: one case for every kind of scene at the coarse elements (quick) and at the fine ones (standard), and
  all thicknesses with all Poisson's ratios (full).
- Scenes drawn at random, in states that a path past events leads to. Scene k is `draw(SEED, k)` of
  validation/corpus/random: any profile of up to 12 harmonics, at any length from nm to m and modulus from 1e2 to 1e13
  Pa, with and without adhesion, loaded and unloaded under every control. The full form takes every k below `DRAWN` with
  a layer of .02 to 5 periods, 0 <= nu <= 1/2 and an equilibrium of 1 to 12 patches at the last target; the others take
  some of these, chosen by their number of patches before they were solved by finite elements. Where a path has led
  cannot be known without following it: the finite elements begin `ASIDE` of the edges of the boundary elements, find
  theirs by their own closure, and say whether that is a minimum of the energy.

How both are compared: fem_comparison.py. SI units.
"""

from collections.abc import Iterable
from functools import partial
from typing import Any

import numpy as np

import bem
import fem_reference
from bem.scene.scene import Scene, parse_scene
from validation.cases.exact.waves import uniform_compliance
from validation.cases.finite_elements import fem_comparison
from validation.cases.finite_elements.fem_comparison import (
    Comparison,
    compare_equilibria,
    compare_prescribed,
    uncertain,
)
from validation.cases.shared.checks import Against, Found, case, in_forms, posed
from validation.corpus.random.random_scenes import draw
from validation.harness.case import Case
from validation.harness.figure_data import digits, drawn, loglog, marks, semilogx, table, trace
from validation.harness.schema import Level

PERIOD, MODULUS = 0.01, 1e6
THICKNESSES = (0.05, 0.1, 0.5, 2.0)  # in periods
RATIOS = (0.3, 0.45, 0.49, 0.5)
EDGES = np.array([[4.9e-3, 6.3e-3], [8.8e-3, 11.4e-3]])  # under the two crests, wider and narrower than equilibrium
PENETRATION = 50e-6
SEED, DRAWN = 47, 200
TINY = (3, 340, 577)  # 1, 2 and 1 patches, past 5, 2 and 1 events
SHORT = (111, 160, 568)  # 6, 1 and 3 patches
DRAWN_THICKNESSES, DRAWN_RATIOS, MOST = (0.02, 5.0), (0.0, 0.5), 12


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


def _found(*comparisons: Comparison) -> Found:
    for comparison in comparisons:
        yield from fem_comparison.rows(comparison)
    yield fem_comparison.counts(comparisons)


def _equilibrium(name: str, elements: str) -> Found:
    scene, patches, changes = SCENES[name]
    found = compare_equilibria("", posed(scene, **changes), elements, patches)
    yield from _found(found)
    yield from fem_comparison.figure(
        f"fem-{name}", f"Pressure under {patches} unequal patches, {name.replace('-', ' ')}, {elements}.", found
    )


def _crests(thickness: float, ratio: float) -> tuple[str, Scene]:
    """A label, and two crests on a layer."""
    return f"d/lambda {thickness:g}, nu {ratio:g}", posed("layer_two_crests", **_layer(thickness, ratio))


def _prescribed(elements: str) -> Found:
    found = [compare_prescribed(*_crests(*layer), elements, EDGES, PENETRATION) for layer in ((0.1, 0.49), (0.5, 0.3))]
    yield from _found(*found)
    caption = f"Pressure of given patches at given penetration, {found[0].label}, {elements}."
    yield from fem_comparison.figure("fem-prescribed", caption, found[0])


def _layer_by_fem() -> Found:
    nu, thickness, penetration = 0.3, 0.2 * PERIOD, 12e-6
    harmonics = ([1, 2], [4e-6, 20e-6], [0.5, 0.3])
    profile = bem.Profile.from_harmonics(PERIOD, *harmonics)
    edges = [[place - 0.7e-3, place + 0.9e-3] for place in np.sort(profile.crests[0])]
    solid, layer = bem.Solid(MODULUS, nu), bem.Layer(thickness)
    state = bem.ContactState(profile, solid, edges, penetration, layer=layer)
    fem = fem_reference.solve(youngs_modulus=MODULUS, poisson_ratio=nu, thickness=thickness, period=PERIOD,
                              harmonics=harmonics, control="penetration", value=penetration, edges=edges,
                              resolution=fem_reference.Resolution(4, 6, 9))  # fmt: skip
    total = layer.total_displacement(solid, penetration, state.mean_pressure)
    for name, unit, computed, measured in (  # within the uncertainty of the finite elements, which is larger still
        ("load", "N/m", state.load, (3e-4, 1.3e-4)),
        ("stress_intensity", "Pa m^1/2", state.stress_intensity, (9e-4, 3.5e-4)),
        ("elastic_energy", "J/m", state.elastic_energy, (1.5e-4, 5.8e-5)),
        ("total_displacement", "m", total, (6e-5, 2.4e-5)),
    ):
        yield Against("FEM", "P4/P3, 6 cells", uncertain(fem, name)).row(
            f"{name.replace('_', ' ')} at given edges", unit, np.ravel(getattr(fem, name)), np.ravel(computed), measured
        )
    yield Against("exact", "Betti: c(0) times the mean pressure").row(
        "mean displacement of the face, finite elements", "m", uniform_compliance(thickness, nu) * fem.mean_pressure,
        fem.total_displacement - fem.penetration, (2e-12, 6.8e-13), code="fem")  # fmt: skip
    yield Against("exact", "an exact solution has none: as sharp as when it was measured").row(
        "uncertainty of the load of the finite elements, over the load", "", 0.0, uncertain(fem, "load") / fem.load,
        (4.5e-3, 1.9e-3), "absolute", code="fem")  # fmt: skip
    yield {"unknowns": fem.unknowns}


def _layers() -> Found:
    found = {(d, nu): compare_equilibria(*_crests(d, nu), "P4/P3", 2) for d in THICKNESSES for nu in RATIOS}
    yield from _found(*found.values())
    for name, caption in (
        ("share", "Largest |BEM - FEM| over the combined uncertainty of all quantities: at most 1 where codes agree."),
        ("uncertainty", "Largest combined uncertainty over its scale, displacement at single points left out."),
    ):
        shown = {f"nu = {nu:g}": [found[d, nu].shown(name) for d in THICKNESSES] for nu in RATIOS}
        yield table(caption, {"d/lambda": THICKNESSES, **shown})
    there = {place: one for place, one in found.items() if one.differences}
    edges = {place: one.of("edges") for place, one in there.items()}
    energy = {place: one.of("elastic energy per area") for place, one in there.items()}
    at = {ratio: [place for place in there if place[1] == ratio] for ratio in RATIOS}
    thicknesses = sorted({thickness for thickness, _ in there})
    least = [min(one.uncertainty for place, one in edges.items() if place[0] == d) for d in thicknesses]
    yield drawn(
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
                   for ratio in RATIOS)))  # fmt: skip


def posed_of(index: int) -> Scene:
    """Scene `index`, its targets alone, solved as accurately as those of other comparisons with finite elements."""
    tables = draw(SEED, index).tables
    loading = {key: value for key, value in tables["loading"].items() if "at_mean_pressure" not in key}
    changed = tables | {"loading": loading, "accuracy": tables["accuracy"] | {"tolerance": 1e-9}}
    return parse_scene({name: table for name, table in changed.items() if name != "output"})


def taken(index: int) -> bool:
    """Whether a scene is one of the matrix."""
    drawn = draw(SEED, index)
    if drawn.special or drawn.scan is not None or "layer" not in drawn.tables:
        return False
    thickness, ratio = drawn.tables["layer"]["thickness"], drawn.tables["solid"]["poisson_ratio"]
    if not DRAWN_THICKNESSES[0] <= thickness / drawn.tables["profile"]["period"] <= DRAWN_THICKNESSES[1]:
        return False
    if not DRAWN_RATIOS[0] <= ratio <= DRAWN_RATIOS[1]:
        return False
    state = bem.solve(posed_of(index)).targets[-1]
    return state.status == "converged" and 1 <= state.n_patches <= MOST


def _matrix(elements: str, chosen: Iterable[int] | None) -> Found:
    indices = [k for k in range(DRAWN) if taken(k)] if chosen is None else list(chosen)
    scenes = [posed_of(k) for k in indices]
    found = [compare_equilibria(f"scene {k}", scene, elements, None) for k, scene in zip(indices, scenes, strict=True)]
    for one in found:
        yield from fem_comparison.rows(one, asked_uncertainty=False)
    stable = [one.fem.stable for one in found if one.fem is not None and one.fem.stable is not None]
    yield Against("FEM", "fem_reference").count("adhesive states that are minima of the energy by finite elements",
                                                len(stable), sum(map(bool, stable)), code="fem")  # fmt: skip
    yield table(
        f"Scenes of seed {SEED}: any adhesion, or none; |BEM - FEM| over u, the combined uncertainty, at most.",
        {"scene": indices, "profile": [scene.profile.kind for scene in scenes],
         "control": [scene.loading.control for scene in scenes],
         "targets": [len(scene.loading.targets) for scene in scenes],
         "d/lambda": digits([scene.layer.thickness / scene.surface().period for scene in scenes if scene.layer], 3),
         "nu": digits([scene.solid.poisson_ratio for scene in scenes], 3),
         "adhesion": ["none" if scene.adhesion is None else "yes" for scene in scenes],
         "patches": [len(one.fem.edges) if one.fem is not None else 0 for one in found],
         "largest share": [one.shown("share") for one in found]})  # fmt: skip
    yield fem_comparison.counts(found)


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
    *in_forms(
        {"fem-matrix-coarse": ("quick", "P2/P1", TINY),
         "fem-matrix": ("standard", "P4/P3", SHORT),
         "fem-matrix-many": ("full", "P4/P3", None)}, fem_comparison.GROUP, _matrix,
        "Do both codes find the same equilibria of scenes drawn at random, past events, whatever the layer, the "
        "adhesion, the control and the number of patches?",
        fem_comparison.EQUATIONS, fem_comparison.SOURCES, "layer adhesion slope_term unloading"),
    case("layer-two-patches-fem", fem_comparison.GROUP, _layer_by_fem,
         "Do both codes see the same load, stress intensity, energy and displacement of two given patches?",
         r"$\nabla \cdot \sigma = 0$ in the layer; $u_y = h - h_{\text{max}} + u_{\text{tot}}$ on "
         r"the patches; $K = \sqrt{2 E^\ast G}$",
         "carbone2008", "layer", problem="two patches on a layer, given edges"),
)  # fmt: skip
