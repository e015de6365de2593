"""Boundary elements against finite elements: equilibria of layers, each code with its own edges.

- Unequal crests on a layer (scenes layer_two_crests and layer_three_crests: period 10 mm, E = 1 MPa, gamma = 0.03
  J/m^2, thickness 0.05 to 2 periods, nu 0.3 to 0.5), at given penetration or load, with and without adhesion.
- Scenes drawn at random (`draw(47, k)` of validation/corpus/random): any profile of up to 12 harmonics, lengths from
  nm to m, moduli from 1e2 to 1e13 Pa, with and without adhesion, loaded and unloaded under every control.  The full
  level takes every k < 200 with a layer of 0.02 to 5 periods, 0 <= nu <= 1/2 and 1 to 12 patches at the last target.
  Where several equilibria exist, the path decides which one is meant: the finite elements start a tenth of a patch or
  gap beside the edges of the boundary elements and find their own.

The numbers compared and their uncertainties: bem_beside_fem.py.
"""

import numpy as np
import pytest

import bem
from validation.cases.bem_beside_fem import TWICE, compare_equilibria, compare_prescribed, figure
from validation.corpus.random_scenes import draw
from validation.plugin.rows import Code, Quantity
from validation.routes.scenes import posed

PERIOD = 0.01
LOAD = {"loading": {"control": "mean_pressure", "targets": [1e4]}, "accuracy": {"max_increment": 5.0}}
SEED, DRAWN = 47, 200
COVERAGE, OF_MANY = 0.95, 6.0  # of U; times U for one of many numbers: the largest of 534 of the calibration is 5.7


def layer(thickness, ratio):
    """Return the tables of a layer of a thickness in periods."""
    return {"layer": {"thickness": thickness * PERIOD}, "solid": {"poisson_ratio": ratio}}


SCENES = {  # scene, patches, changes
    "two patches": ("layer_two_crests", 2, {}),
    "two patches, thin": ("layer_two_crests", 2, layer(0.1, 0.49)),
    "two patches under load": ("layer_two_crests", 2, LOAD | {"solid": {"poisson_ratio": 0.45}}),
    "without adhesion": ("layer_two_crests", 2, LOAD | {"adhesion": None} | layer(0.2, 0.5)),
    "three patches": ("layer_three_crests", 3, layer(0.2, 0.49)),
    "three patches under load": ("layer_three_crests", 3, LOAD | {"layer": {"thickness": 2e-2}}),
}
RUNS = {"quick": (("two patches", "P2/P1"), ("without adhesion", "P2/P1")),
        "standard": (("two patches, thin", "P4/P3"), ("without adhesion", "P4/P3"), ("three patches", "P2/P1")),
        "full": (("three patches", "P4/P3"), ("two patches under load", "P4/P3"),
                 ("three patches under load", "P4/P3"))}


@pytest.mark.parametrize(("name", "elements"), [pytest.param(*run, marks=getattr(pytest.mark, level))
                                                for level, runs in RUNS.items() for run in runs])
def test_unequal_crests(rows, name, elements):
    """Do both codes find the same equilibrium of unequal patches?"""
    scene, patches, changes = SCENES[name]
    both = compare_equilibria(posed(scene, **changes), elements, patches)
    both.add_to(rows)
    figure(rows, f"Pressure under {name}, {elements}", both)


@pytest.mark.parametrize("elements", [pytest.param("P2/P1", marks=pytest.mark.quick),
                                      pytest.param("P4/P3", marks=pytest.mark.standard)])
@pytest.mark.parametrize(("thickness", "ratio"), [(0.1, 0.49), (0.5, 0.3)])
def test_given_edges(rows, thickness, ratio, elements):
    """Do both codes find the same load, energy, stress intensities and fields at given edges?"""
    edges = np.array([[4.9e-3, 6.3e-3], [8.8e-3, 11.4e-3]])  # wider and narrower than equilibrium, under two crests
    both = compare_prescribed(posed("layer_two_crests", **layer(thickness, ratio)), elements, edges, 50e-6)
    both.add_to(rows)
    figure(rows, f"Pressure of given patches, d/period {thickness:g}, nu {ratio:g}, {elements}", both)


@pytest.mark.full
@pytest.mark.parametrize("ratio", [0.3, 0.45, 0.49, 0.5])
@pytest.mark.parametrize("thickness", [0.05, 0.1, 0.5, 2.0])
def test_thickness_and_poissons_ratio(rows, thickness, ratio):
    """Do both codes agree on two unequal patches for thin and thick, compressible and incompressible layers?"""
    compare_equilibria(posed("layer_two_crests", **layer(thickness, ratio)), "P4/P3", 2).add_to(rows)


def random_scene(k):
    """Return scene k with its targets alone, solved to 1e-9."""
    tables = draw(SEED, k).tables
    loading = {key: value for key, value in tables["loading"].items() if "at_mean_pressure" not in key}
    changed = tables | {"loading": loading, "accuracy": tables["accuracy"] | {"tolerance": 1e-9}}
    return bem.parse_scene({name: table for name, table in changed.items() if name != "output"})


def in_matrix(k):
    """Return whether scene k is one of the full level."""
    drawn = draw(SEED, k)
    if drawn.scan is not None or "layer" not in drawn.tables:
        return False
    thickness = drawn.tables["layer"]["thickness"] / drawn.tables["profile"]["period"]
    if not (0.02 <= thickness <= 5.0 and 0.0 <= drawn.tables["solid"]["poisson_ratio"] <= 0.5):
        return False
    state = bem.solve(random_scene(k)).targets[-1]
    return state.status == "converged" and 1 <= state.n_patches <= 12


@pytest.mark.parametrize(
    ("scenes", "elements"),  # chosen by their number of patches before finite elements solved them
    [pytest.param((3, 340, 577), "P2/P1", id="few", marks=pytest.mark.quick),  # 1, 2, 1 patches, past 5, 2, 1 events
     pytest.param((111, 160, 568), "P4/P3", id="some", marks=pytest.mark.standard),  # 6, 1, 3 patches
     pytest.param(None, "P4/P3", id="all", marks=[pytest.mark.full, pytest.mark.timeout(3600)])],
)
def test_random_scenes(rows, scenes, elements):
    """Do both codes find the same equilibria of random scenes, past events, whatever layer, adhesion and control?

    Of all scenes, U of both sides should hold 95 % of the differences; each is within the largest of the calibration.
    """
    shares, drawn = [], list[float]()
    for k in scenes or [k for k in range(DRAWN) if in_matrix(k)]:
        scene = random_scene(k)
        both = compare_equilibria(scene, elements, None)
        both.add_to(rows, f"scene {k}", TWICE if scenes else OF_MANY)
        own = both.shares()
        drawn += own
        shares.append([k, scene.loading.control, scene.layer.thickness / scene.surface().period,
                       scene.solid.poisson_ratio, "yes" if scene.adhesion else "no", max(own, default=np.nan)])
        assert both.fem is None or both.fem.stable is not False, f"scene {k}: no minimum by finite elements"
    if not scenes:
        spread = 2 * np.sqrt(COVERAGE * (1 - COVERAGE) / len(drawn))
        rows.compare("share of differences within U", float(np.mean(np.array(drawn) <= 1)), COVERAGE, of=Code.FEM,
                     by=Code.BEM, quantity=Quantity.COUNT, uncertainty=(spread, 0.0), source=f"{len(drawn)} numbers")
    rows.table(f"Scenes of seed {SEED}: |BEM - FEM| over the combined U, at most",
               ["scene", "control", "d/period", "nu", "adhesion", "largest share"], shares)
