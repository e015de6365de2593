"""Boundary elements against finite elements on scenes drawn at random, in states that a path past events leads to.

Scene k is `draw(SEED, k)` of validation/corpus/random: any profile of up to 12 harmonics, at any length from nm to m
and modulus from 1e2 to 1e13 Pa, with and without adhesion, loaded and unloaded under every control. The full form takes
every k below `DRAWN` with a layer of .02 to 5 periods, 0 <= nu <= 1/2 and an equilibrium of 1 to 12 patches at the last
target; the others take some of these, chosen by their number of patches before they were solved by finite elements.
Where a path has led cannot be known without following it: the finite elements begin `ASIDE` of the edges of the
boundary elements, find theirs by their own closure, and say whether that is a minimum of the energy. How both are
compared: fem_comparison.py. SI units.
"""

from collections.abc import Iterable

import bem
from bem.scene.scene import Scene, parse_scene
from validation.cases.finite_elements import fem_comparison
from validation.cases.finite_elements.fem_comparison import Comparison, compare_equilibria
from validation.cases.shared.checks import Against, in_forms
from validation.corpus.random.random_scenes import draw
from validation.harness.case import Outcome
from validation.harness.schema import Cells, Table

SEED, DRAWN = 47, 200
TINY = (3, 340, 577)  # 1, 2 and 1 patches, past 5, 2 and 1 events
SHORT = (111, 160, 568)  # 6, 1 and 3 patches
THICKNESSES, RATIOS, MOST = (0.02, 5.0), (0.0, 0.5), 12


def posed(index: int) -> Scene:
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
    if not THICKNESSES[0] <= thickness / drawn.tables["profile"]["period"] <= THICKNESSES[1]:
        return False
    if not RATIOS[0] <= ratio <= RATIOS[1]:
        return False
    state = bem.solve(posed(index)).targets[-1]
    return state.status == "converged" and 1 <= state.n_patches <= MOST


def _matrix(elements: str, chosen: Iterable[int] | None) -> Outcome:
    indices = [k for k in range(DRAWN) if taken(k)] if chosen is None else list(chosen)
    found = {k: compare_equilibria(f"scene {k}", posed(k), elements, None) for k in indices}
    stable = [one.fem.stable for one in found.values() if one.fem is not None and one.fem.stable is not None]
    states = Against("FEM", "fem_reference").count(
        "adhesive states that are minima of the energy by finite elements",
        len(stable),
        sum(map(bool, stable)),
        code="fem",
    )
    table = Table(
        caption=f"Scenes of seed {SEED}: any adhesion, or none; |BEM - FEM| over u, the combined uncertainty, at most.",
        columns=["scene", "profile", "control", "targets", "d/lambda", "nu", "adhesion", "patches", "largest share"],
        rows=[_line(index, comparison) for index, comparison in found.items()],
    )
    every = (row for one in found.values() for row in fem_comparison.rows(one, asked_uncertainty=False))
    return Outcome(rows=(*every, states), tables=(table,), counts=fem_comparison.counts(list(found.values())))


def _line(index: int, comparison: Comparison) -> Cells:
    """What a scene is, and how far the codes are apart."""
    scene = posed(index)
    assert scene.layer is not None
    thickness, ratio = scene.layer.thickness / scene.surface().period, scene.solid.poisson_ratio
    patches = len(comparison.fem.edges) if comparison.fem is not None else 0
    return [index, scene.profile.kind, scene.loading.control, len(scene.loading.targets), float(f"{thickness:.3g}"),
            float(f"{ratio:.3g}"), "none" if scene.adhesion is None else "yes", patches,
            comparison.shown("share")]  # fmt: skip


CASES = tuple(in_forms(
    {"fem-matrix-coarse": ("quick", "P2/P1", TINY),
     "fem-matrix": ("standard", "P4/P3", SHORT),
     "fem-matrix-many": ("full", "P4/P3", None)}, fem_comparison.GROUP, _matrix,
    "Do both codes find the same equilibria of scenes drawn at random, past events, whatever the layer, the "
    "adhesion, the control and the number of patches?",
    fem_comparison.EQUATIONS, fem_comparison.SOURCES, "layer adhesion slope_term unloading"))  # fmt: skip
