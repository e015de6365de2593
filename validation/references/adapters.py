"""From a scene to what each code needs: raw E, nu, harmonics, work of adhesion; each derives the rest on its own.

A code takes the tables that it provides (`taken`), and a scene with any other that says what is in contact is refused.
"""

import copy
import tomllib
from collections.abc import Mapping
from importlib import resources
from typing import Any

import persson
from bem.scene.scene import Scene, parse_scene
from persson import AdhesiveContact, DiscreteSpectrum, NonadhesiveContact

NOT_SELF_AFFINE: dict[str, Any] = dict.fromkeys(("hurst", "rms_height", "harmonics", "seed"))  # but of harmonics


def scene_text(name: str) -> str:
    """The text of a scene of the registry, by its file name without ending."""
    return resources.files("validation.cases").joinpath(f"scenes/{name}.toml").read_text("utf-8")


def scene(name: str, changes: Mapping[str, Mapping[str, Any] | None] | None = None) -> Scene:
    """A scene of the registry with some keys changed, table by table; None removes a table or key."""
    return parse_scene(changed(tomllib.loads(scene_text(name)), changes or {}))


def changed(tables: Mapping[str, Any], changes: Mapping[str, Mapping[str, Any] | None]) -> dict[str, Any]:
    """Tables with some keys changed; None removes a table or key.

    Examples
    --------
    >>> changed({"a": {"x": 1, "y": 2}, "c": {"w": 0}}, {"a": {"x": None, "y": 3}, "b": {"z": 4}, "c": None})
    {'a': {'y': 3}, 'b': {'z': 4}}
    """
    content = copy.deepcopy(dict(tables))
    for name, keys in changes.items():
        table = content.pop(name, {}) | dict(keys or {})
        if keys is not None:
            content[name] = {key: value for key, value in table.items() if value is not None}
    return content


def taken(posed: Scene, code: str, *names: str) -> list[Any]:
    """The named tables of a scene, None if absent: all that `code` provides of what is in contact.

    ValueError where the scene has another one.

    Examples
    --------
    >>> solid, profile = taken(scene("sinusoid"), "this code", "solid", "profile")
    Traceback (most recent call last):
    ValueError: scene: this code does not provide [adhesion]
    """
    tables = posed.physics()
    known = [tables.pop(name, None) for name in names]
    if tables:
        raise ValueError(f"scene: {code} does not provide {', '.join(f'[{name}]' for name in tables)}")
    return known


def persson_contact(posed: Scene, mean_pressure: float, **options: Any) -> AdhesiveContact | NonadhesiveContact:
    """Persson's theory of a scene (`persson_spectrum`) at a mean pressure in Pa, with adhesion where it has that."""
    solid, _, adhesion = taken(posed, "Persson's theory", "solid", "profile", "adhesion")
    return persson.solve(
        DiscreteSpectrum.of_profile(posed.surface()),
        mean_pressure,
        youngs_modulus=solid.youngs_modulus,
        poisson_ratio=solid.poisson_ratio,
        work_of_adhesion=None if adhesion is None else adhesion.work_of_adhesion,
        **options,
    )


def persson_spectrum(posed: Scene) -> DiscreteSpectrum:
    """The lines of the profile of a scene: wavenumbers in rad/m and amplitudes in m.

    ValueError for a layer, or anything else that Persson's theory of the half-space does not know.
    """
    taken(posed, "Persson's theory", "solid", "profile", "adhesion")
    return DiscreteSpectrum.of_profile(posed.surface())
