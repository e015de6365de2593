"""From a scene to what each code needs: raw E, nu, harmonics, work of adhesion; each derives the rest on its own."""

from __future__ import annotations

import copy
import tomllib
from collections.abc import Mapping
from importlib import resources
from typing import Any

import numpy as np

from bem.scene.scene import Scene, parse_scene
from persson import DiscreteSpectrum


def scene_text(name: str) -> str:
    """The text of a scene of the registry, by its file name without ending."""
    return resources.files("validation.cases").joinpath(f"scenes/{name}.toml").read_text("utf-8")


def scene(name: str, changes: Mapping[str, Mapping[str, Any] | None] | None = None) -> Scene:
    """A scene of the registry with some keys changed, table by table; None removes a table or key."""
    data = tomllib.loads(scene_text(name))
    for table, keys in (changes or {}).items():
        if keys is None:
            data.pop(table, None)
            continue
        content = copy.deepcopy(data.get(table, {}))
        content.update(keys)
        data[table] = {key: value for key, value in content.items() if value is not None}
    return parse_scene(data)


def persson_spectrum(posed: Scene) -> DiscreteSpectrum:
    """The lines of the profile of a scene: wavenumbers in rad/m and amplitudes in m."""
    surface = posed.surface()
    return DiscreteSpectrum(2 * np.pi / surface.period * surface.orders, surface.amplitudes)
