"""Codes that take a scene refuse what they do not know of it, whatever its name."""

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


def test_known_tables_are_handed_over_in_order():
    scene = adapters.scene("sinusoid", {"adhesion": None})
    solid, profile, layer, adhesion = adapters.taken(scene, "this code", "solid", "profile", "layer", "adhesion")
    assert (solid, profile, layer, adhesion) == (scene.solid, scene.profile, None, None)
