"""Codes that take a scene refuse what they do not know of it, whatever its name."""

import numpy as np
import pytest
from made_up_table import COATING, allow_coatings

from fem_reference import Resolution
from validation.references import adapters, fem_adapter
from validation.references.dense_equilibrium import reference
from validation.references.fft_solver import grid_contact

LAYER = "layer_sinusoid"
TAKES = {
    "finite elements": (LAYER, fem_adapter.fem_arguments),
    "finite element state": (LAYER, lambda scene: fem_adapter.solve_fem(scene, Resolution())),
    "given edges": (LAYER, lambda scene: fem_adapter.contact_state(scene, [[-1e-3, 1e-3]], 1e-6)),
    "theory": ("sinusoid", adapters.persson_spectrum),
    "dense algebra": (LAYER, lambda scene: reference(scene, None)),
    "grid": ("sinusoid", lambda scene: grid_contact(scene, 1e3, 64)),
}


@pytest.mark.parametrize("code", TAKES)
def test_a_made_up_table_is_refused(code, monkeypatch):
    allow_coatings(monkeypatch)
    name, take = TAKES[code]
    scene = adapters.scene(name, {"coating": COATING, "adhesion": None})
    with pytest.raises(ValueError, match=r"does not provide \[coating\]"):
        take(scene)


def test_a_layer_is_no_half_space():
    with pytest.raises(ValueError, match=r"Persson's theory does not provide \[layer\]"):
        adapters.persson_spectrum(adapters.scene(LAYER))


def test_a_problem_holds_the_raw_numbers_of_its_scene():
    scene = adapters.scene(LAYER)
    problem = adapters.problem_of(scene, "this code", "layer", "adhesion")
    assert (problem.youngs_modulus, problem.poisson_ratio) == (scene.solid.youngs_modulus, scene.solid.poisson_ratio)
    assert (problem.thickness, problem.slope_term) == (scene.layer.thickness, scene.adhesion.slope_term)
    assert problem.work_of_adhesion == scene.adhesion.work_of_adhesion
    surface = scene.surface()
    for found, given in zip(problem.harmonics, (surface.orders, surface.amplitudes, surface.phases), strict=True):
        np.testing.assert_array_equal(found, given)
    bare = adapters.problem_of(adapters.scene("sinusoid", {"adhesion": None}), "this code", "layer", "adhesion")
    assert (bare.thickness, bare.work_of_adhesion, bare.slope_term) == (None, None, False)
