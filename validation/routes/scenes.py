"""Scenes of validation/cases/scenes, with keys changed, their solution by boundary elements, and their raw numbers.

Every other code is told raw numbers only: E, nu, harmonics, thickness, work of adhesion (`problem_of`).  It derives E*,
slopes and edges on its own, so that a mistake in a derived constant cannot cancel between two codes.
"""

import copy
import tomllib
from collections.abc import Iterable, Mapping
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import bem
from bem.scene.result import Result
from bem.scene.scene import Scene, parse_scene
from bem.scene.state import State
from validation.harness.arrays import FloatArray
from validation.harness.route import Problem

TEN_DIGITS = "ten digits of the largest value, as gaps are certified: 1e-10 rms heights (bem/README.md, section 7)"
NOT_SELF_AFFINE: dict[str, Any] = dict.fromkeys(("hurst", "rms_height", "harmonics", "seed"))  # removed for harmonics


def scene_text(name: str) -> str:
    """Return the text of a scene file of validation/cases/scenes, by its name without ending."""
    return resources.files("validation.cases").joinpath(f"scenes/{name}.toml").read_text("utf-8")


def posed(name: str, **tables: Any) -> Scene:
    """Return a scene of validation/cases/scenes with some keys changed; None removes a table or a key."""
    return parse_scene(changed(tomllib.loads(scene_text(name)), tables))


def solved(name: str, **tables: Any) -> Result:
    """Solve a scene of validation/cases/scenes with some keys changed; AssertionError where it does not converge."""
    result = bem.solve(posed(name, **tables))
    assert result.status == "converged", f"{name}: {result.status}: {result.failure}"
    return result


def values(states: Iterable[Any], name: str) -> FloatArray:
    """Return one attribute of every state or event as numbers, (n,); nan for None."""
    attributes = [getattr(state, name) for state in states]
    return np.array([np.nan if value is None else value for value in attributes], dtype=np.float64)


def estimates(states: Iterable[State], name: str) -> FloatArray:
    """Return the error that every state estimates of one of its numbers, (n,); nan where it estimates none."""
    return values((state.error_estimate for state in states), name)


def touching(states: Iterable[State]) -> list[State]:
    """Return the states that have edges: some contact, and some gap."""
    return [state for state in states if state.edges]


def edge_scale(edges: FloatArray, period: float) -> FloatArray:
    """Return the shorter of the patch and the gap beside every edge, (n_patches, 2), m."""
    lengths = np.diff(np.append(edges.ravel(), edges[0, 0] + period))
    return np.minimum(lengths, np.roll(lengths, 1)).reshape(edges.shape)


def changed(tables: Mapping[str, Any], changes: Mapping[str, Mapping[str, Any] | None]) -> dict[str, Any]:
    """Return tables with some keys changed; None removes a table or a key.

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


def problem_of(scene: Scene, code: str, *effects: str) -> Problem:
    """Return solid, profile and path of a scene, and its tables "layer" and "adhesion" if `code` provides them.

    ValueError where the scene has another table that decides what is in contact.
    """
    tables = scene.physics()
    unknown = [name for name in tables if name not in ("solid", "profile", *effects)]
    if unknown:
        raise ValueError(f"scene: {code} does not provide {', '.join(f'[{name}]' for name in unknown)}")
    surface, layer, adhesion = scene.surface(), tables.get("layer"), tables.get("adhesion")
    return Problem(
        youngs_modulus=scene.solid.youngs_modulus,
        poisson_ratio=scene.solid.poisson_ratio,
        period=surface.period,
        orders=tuple(surface.orders.tolist()),
        amplitudes=tuple(surface.amplitudes.tolist()),
        phases=tuple(surface.phases.tolist()),
        control=scene.loading.control,
        targets=tuple(map(float, scene.loading.targets)),
        thickness=None if layer is None else layer.thickness,
        work_of_adhesion=None if adhesion is None else adhesion.work_of_adhesion,
        slope_term=adhesion is not None and adhesion.slope_term,
    )


def contact_state(scene: Scene, edges: ArrayLike, penetration: float, tolerance: float = 1e-12) -> bem.ContactState:
    """Return the elastic state of a scene by boundary elements at edges (n_patches, 2) and penetration, both in m."""
    problem = problem_of(scene, "bem.ContactState", "layer", "adhesion")
    profile = bem.Profile.from_harmonics(problem.period, *problem.harmonics)
    solid = bem.Solid(problem.youngs_modulus, problem.poisson_ratio)
    layer = None if problem.thickness is None else bem.Layer(problem.thickness)
    return bem.ContactState(profile, solid, edges, penetration, layer, tolerance=tolerance)
