"""Free-boundary boundary element solver for adhesive line contact.

The public names are imported on first use, so that a scene without an effect never imports the module of that effect.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    __version__: str
    from bem.adhesive.adhesion import Adhesion as Adhesion
    from bem.contact_state import ContactState as ContactState
    from bem.elastic.layer import Layer as Layer
    from bem.geometry.profile import Profile as Profile
    from bem.geometry.scaling import Solid as Solid
    from bem.map_rows import RowResults as RowResults
    from bem.map_rows import read_rows as read_rows
    from bem.map_rows import solve_rows as solve_rows
    from bem.scene.result import Result as Result
    from bem.scene.result_file import read_result as read_result
    from bem.scene.scene import load_scene as load_scene
    from bem.scene.scene import parse_scene as parse_scene
    from bem.scene.scene_error import SceneError as SceneError
    from bem.solver import solve as solve

_HOME = {
    "Adhesion": "bem.adhesive.adhesion",
    "ContactState": "bem.contact_state",
    "Layer": "bem.elastic.layer",
    "Profile": "bem.geometry.profile",
    "Solid": "bem.geometry.scaling",
    "Result": "bem.scene.result",
    "RowResults": "bem.map_rows",
    "SceneError": "bem.scene.scene_error",
    "load_scene": "bem.scene.scene",
    "parse_scene": "bem.scene.scene",
    "read_result": "bem.scene.result_file",
    "read_rows": "bem.map_rows",
    "solve": "bem.solver",
    "solve_rows": "bem.map_rows",
}

__all__ = [
    *("Adhesion", "ContactState", "Layer", "Profile", "Result", "RowResults", "SceneError", "Solid"),
    *("load_scene", "parse_scene", "read_result", "read_rows", "solve", "solve_rows"),
]


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    if name == "__version__":
        return import_module("bem.scene.provenance").installed_version()
    if name == "ensemble_table":
        raise AttributeError("ensemble_table is gone: join result.to_table() of each, as example guide-ensemble does")
    raise AttributeError(f"module 'bem' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
