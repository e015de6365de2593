"""A scene from what describes one: itself, its file, its tables as a mapping, or objects and mappings by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from bem.geometry.profile import Profile
from bem.geometry.scaling import Solid
from bem.scene.scene import Scene, load_scene, parse_scene

if TYPE_CHECKING:
    from bem.adhesive.adhesion import Adhesion
    from bem.elastic.layer import Layer

Table = Mapping[str, Any]
Described = Scene | Path | str | Table | None


class Tables(TypedDict, total=False):
    """The tables of a scene: objects, or mappings with the keys of the scene file; numbers and arrays of numpy too."""

    title: str
    solid: Solid | Table
    profile: Profile | Table
    layer: Layer | Table | None
    adhesion: Adhesion | Table | None
    loading: Table
    accuracy: Table
    output: Table


def scene_of(scene: Described, tables: Mapping[str, Any]) -> Scene:
    """The scene that is described.

    Parameters
    ----------
    scene : Scene, path of a scene file, or mapping of its tables; None when `tables` are given
    tables : mapping
        `Tables`; empty when a scene is given.

    Raises
    ------
    SceneError
        As of `parse_scene`.
    TypeError
        Neither a scene nor tables, or both; a scene of another type.

    Examples
    --------
    >>> wave = Profile.from_harmonics(0.01, [1], [1e-5])
    >>> loading = {"control": "separation", "targets": np.linspace(8e-6, 4e-6, 3)}
    >>> scene = scene_of(None, {"profile": wave, "solid": Solid(1e6, 0.5), "loading": loading})
    >>> scene.surface().max_height, scene.loading.targets
    (1e-05, (8e-06, 6e-06, 4e-06))
    """
    needed = "a scene, its file or its tables as a mapping is needed, or profile=, solid=, loading=, ..."
    if scene is not None and not isinstance(scene, Scene | Path | str | Mapping):
        raise TypeError(f"scene = {scene!r}, {type(scene).__name__}: {needed}")
    if scene is not None and tables:
        unknown = [f"{name}=" for name in tables if name not in Tables.__annotations__]
        clashing = [f"{name}=" for name in tables if name in Tables.__annotations__]
        found = [f"{', '.join(unknown)} unknown"] if unknown else []
        found += [f"{', '.join(clashing)} beside a whole scene"] if clashing else []
        raise TypeError(f"{' and '.join(found)}: {needed}")
    if scene is None and not tables:
        raise TypeError(f"nothing given: {needed}")
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, str | Path):
        return load_scene(scene)
    return parse_scene({name: _plain(table) for name, table in (tables if scene is None else scene).items()})


def _plain(value: Any) -> Any:
    """The same as a value of a TOML file."""
    if isinstance(value, Profile):
        return {"kind": "harmonics", **_plain(asdict(value))}
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
