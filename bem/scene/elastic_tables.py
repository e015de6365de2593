"""The tables of a scene that change the compliance of the half-space, and the elastic effect that each one names.

A further effect is a row of `ELASTIC` and the lines of `elastic_effects` that build it; its module in bem/elastic is
imported only when the scene has the table.  What it must offer is `ElasticEffect` in bem/elastic/kernel_series.py.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from bem.geometry.scaling import Solid
from bem.scene.scene import Scene

if TYPE_CHECKING:
    from bem.elastic.kernel_series import ElasticEffect

ELASTIC = {"layer": "thickness = {thickness:g} m"}  # tables, and what is said of them
NEGLIGIBLE = 0.1  # derived: of accuracy.tolerance: elastic effects that change no mode by more are left out


def elastic_effects(scene: Scene) -> dict[str, ElasticEffect]:
    """What each table of `ELASTIC` that the scene has changes of the half-space."""
    solid, period = Solid(scene.solid.youngs_modulus, scene.solid.poisson_ratio), scene.profile.period
    found: dict[str, ElasticEffect] = {}
    if scene.layer is not None:
        found["layer"] = import_module("bem.elastic.layer").Layer(scene.layer.thickness).effect(solid, period)
    return found


def negligible(scene: Scene) -> float:
    """Largest change of the compliance of any mode that is left out."""
    return NEGLIGIBLE * scene.accuracy.tolerance
