"""Codes that take a scene refuse what they do not know of it, whatever its name."""

import numpy as np
import pytest
from made_up_table import COATING, allow_coatings

from fem_reference import Resolution
from validation.routes.dense_algebra import reference
from validation.routes.fem_scenes import fem_arguments, solve_fem
from validation.routes.persson_scenes import persson_spectrum
from validation.routes.scenes import contact_state, posed, problem_of

LAYER = "layer_sinusoid"
TAKES = {
    "finite elements": (LAYER, fem_arguments),
    "finite element state": (LAYER, lambda scene: solve_fem(scene, Resolution())),
    "given edges": (LAYER, lambda scene: contact_state(scene, [[-1e-3, 1e-3]], 1e-6)),
    "theory": ("sinusoid", persson_spectrum),
    "dense algebra": (LAYER, lambda scene: reference(scene, None)),
}


@pytest.mark.parametrize("code", TAKES)
def test_a_made_up_table_is_refused(code, monkeypatch):
    allow_coatings(monkeypatch)
    name, take = TAKES[code]
    scene = posed(name, coating=COATING, adhesion=None)
    with pytest.raises(ValueError, match=r"does not provide \[coating\]"):
        take(scene)


def test_a_layer_is_no_half_space():
    with pytest.raises(ValueError, match=r"Persson's theory does not provide \[layer\]"):
        persson_spectrum(posed(LAYER))


def test_a_problem_holds_the_raw_numbers_of_its_scene():
    scene = posed(LAYER)
    problem = problem_of(scene, "this code", "layer", "adhesion")
    assert (problem.youngs_modulus, problem.poisson_ratio) == (scene.solid.youngs_modulus, scene.solid.poisson_ratio)
    assert (problem.thickness, problem.slope_term) == (scene.layer.thickness, scene.adhesion.slope_term)
    assert problem.work_of_adhesion == scene.adhesion.work_of_adhesion
    surface = scene.surface()
    for found, given in zip(problem.harmonics, (surface.orders, surface.amplitudes, surface.phases), strict=True):
        np.testing.assert_array_equal(found, given)
    bare = problem_of(posed("sinusoid", adhesion=None), "this code", "layer", "adhesion")
    assert (bare.thickness, bare.work_of_adhesion, bare.slope_term) == (None, None, False)
