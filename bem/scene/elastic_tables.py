"""Tables of a scene that change the compliance of the half-space, and their elastic effects.

A further effect is a row of `ELASTIC` and a table with a method `effect` in bem/elastic, a module that is imported only
when the scene has the table.  `ElasticEffect` in bem/elastic/kernel_series.py says what an effect must offer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from bem.scene.scene import Scene

if TYPE_CHECKING:
    from bem.elastic.kernel_series import ElasticEffect

ELASTIC = {"layer": "thickness = {thickness:g} m"}  # tables, and what is said of them
NEGLIGIBLE = 0.1  # derived: of accuracy.tolerance: elastic effects that change no mode by more are left out


def elastic_effects(scene: Scene) -> dict[str, ElasticEffect]:
    """Return the change of the half-space by each table of `ELASTIC` that the scene has."""
    tables = {name: getattr(scene, name) for name in ELASTIC}
    period = scene.profile.period
    return {name: table.effect(scene.solid, period) for name, table in tables.items() if table is not None}


def negligible(scene: Scene) -> float:
    """Return the largest relative change of the compliance of a mode that is left out."""
    return NEGLIGIBLE * scene.accuracy.tolerance
