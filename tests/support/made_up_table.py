"""A scene with a table [coating] that no code knows: what refuses it must derive that from the tables of the scene."""

from dataclasses import field, make_dataclass
from typing import Any

from bem.geometry.table import table
from bem.scene import scene


@table("coating")
class Coating:
    thickness: float


COATING = {"thickness": 1e-6}


def allow_coatings(monkeypatch):
    """Let scene files have a table [coating]."""
    coated = make_dataclass("Scene", [("coating", Any, field(default=None))], bases=(scene.Scene,), frozen=True)
    monkeypatch.setattr(scene, "Scene", coated)
    monkeypatch.setitem(scene.TABLES, "coating", f"{__name__}.Coating")
