"""A scene with a table [coating] that no code knows: what refuses it must derive that from the tables of the scene."""

from dataclasses import field, make_dataclass
from typing import Any

from bem.scene import scene, scene_tables


class CoatingTable(scene_tables.Table):
    thickness: float


COATING = {"thickness": 1e-6}


def allow_coatings(monkeypatch):
    """Let scene files have a table [coating]."""
    coated = make_dataclass("Scene", [("coating", Any, field(default=None))], bases=(scene.Scene,), frozen=True)
    monkeypatch.setattr(scene, "Scene", coated)
    monkeypatch.setitem(scene.TABLES, "coating", CoatingTable)
