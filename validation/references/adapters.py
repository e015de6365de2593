"""From a scene to what each code is told: raw E, nu, harmonics, work of adhesion; each derives the rest on its own.

That is a `Problem` (harness/route.py), the record from which all routes start.  A code names the effects that it
provides, and a scene with any other table that says what is in contact is refused.
"""

import copy
import tomllib
from collections.abc import Mapping
from importlib import resources
from typing import Any

from numpy.typing import ArrayLike

import bem
import persson
from bem.scene.scene import Scene, parse_scene
from persson import AdhesiveContact, DiscreteSpectrum, NonadhesiveContact
from validation.harness.route import Problem

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


def problem_of(posed: Scene, code: str, *effects: str) -> Problem:
    """Solid, profile and path of a scene, and those of its tables "layer" and "adhesion" that `code` provides.

    ValueError where the scene has another one that says what is in contact.

    Examples
    --------
    >>> problem_of(scene("sinusoid"), "this code", "layer")
    Traceback (most recent call last):
    ValueError: scene: this code does not provide [adhesion]
    """
    tables = posed.physics()
    unknown = [name for name in tables if name not in ("solid", "profile", *effects)]
    if unknown:
        raise ValueError(f"scene: {code} does not provide {', '.join(f'[{name}]' for name in unknown)}")
    surface, layer, adhesion = posed.surface(), tables.get("layer"), tables.get("adhesion")
    return Problem(
        id=posed.title,
        youngs_modulus=posed.solid.youngs_modulus,
        poisson_ratio=posed.solid.poisson_ratio,
        period=surface.period,
        orders=tuple(surface.orders.tolist()),
        amplitudes=tuple(surface.amplitudes.tolist()),
        phases=tuple(surface.phases.tolist()),
        control=posed.loading.control,
        targets=tuple(map(float, posed.loading.targets)),
        asked={},
        thickness=None if layer is None else layer.thickness,
        work_of_adhesion=None if adhesion is None else adhesion.work_of_adhesion,
        slope_term=adhesion is not None and adhesion.slope_term,
    )


def contact_of(problem: Problem, edges: ArrayLike, penetration: float) -> bem.ContactState:
    """The boundary elements' elastic state at edges (n_patches, 2) and penetration, both in m."""
    profile = bem.Profile.from_harmonics(problem.period, *problem.harmonics)
    solid = bem.Solid(problem.youngs_modulus, problem.poisson_ratio)
    layer = None if problem.thickness is None else bem.Layer(problem.thickness)
    return bem.ContactState(profile, solid, edges, penetration, layer)


def persson_contact(posed: Scene, mean_pressure: float, **options: Any) -> AdhesiveContact | NonadhesiveContact:
    """Persson's theory of a scene (`persson_spectrum`) at a mean pressure in Pa, with adhesion where it has that."""
    problem = problem_of(posed, "Persson's theory", "adhesion")
    return persson.solve(
        DiscreteSpectrum.of_profile(posed.surface()),
        mean_pressure,
        youngs_modulus=problem.youngs_modulus,
        poisson_ratio=problem.poisson_ratio,
        work_of_adhesion=problem.work_of_adhesion,
        **options,
    )


def persson_spectrum(posed: Scene) -> DiscreteSpectrum:
    """The lines of the profile of a scene: wavenumbers in rad/m and amplitudes in m.

    ValueError for a layer, or anything else that Persson's theory of the half-space does not know.
    """
    problem_of(posed, "Persson's theory", "adhesion")
    return DiscreteSpectrum.of_profile(posed.surface())
