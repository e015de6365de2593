"""A scene for the finite element reference: raw E, nu, thickness, harmonics, work of adhesion, and the control.

Nothing that either code derived crosses over: no E*, no slope, no edge, no stress intensity.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import bem
import fem_reference
from bem.scene.scene import Scene
from fem_reference import Problem as FemProblem
from fem_reference import Resolution, Result
from fem_reference.closure import ControlKind, evaluate
from fem_reference.continuation import Branch
from fem_reference.crests import chosen_crests
from fem_reference.descent import SEED, descend
from fem_reference.path import TRACKING, Path, follow, step_unit
from fem_reference.result import quantities
from fem_reference.solve import control_of, prescribed
from fem_reference.solve import problem_of as fem_problem_of
from validation.harness.arrays import FloatArray
from validation.harness.route import Problem
from validation.routes.scenes import problem_of

DEPTH = 3.0  # periods: a layer of this thickness is the half-space within 1e-12


def fem_arguments(scene: Scene) -> dict[str, Any]:
    """Return the arguments of `fem_reference.solve` for the last target of a scene with a layer.

    ValueError without a layer, and for a table that the finite elements do not know.
    """
    problem = problem_of(scene, "the finite element reference", "layer", "adhesion")
    if problem.thickness is None:
        raise ValueError("scene: the finite element reference needs a [layer]")
    return raw(problem) | {"control": problem.control, "value": problem.targets[-1]}


def raw(problem: Problem) -> dict[str, Any]:
    """Return solid, profile and adhesion as the finite elements take them; a half-space is a layer of DEPTH."""
    return {
        "youngs_modulus": problem.youngs_modulus,
        "poisson_ratio": problem.poisson_ratio,
        "thickness": DEPTH * problem.period if problem.thickness is None else problem.thickness,
        "period": problem.period,
        "harmonics": problem.harmonics,
        "work_of_adhesion": problem.work_of_adhesion or 0.0,
        "slope_term": problem.slope_term,
    }


def solve_fem(
    scene: Scene,
    resolution: Resolution,
    patches: int = 1,
    edges: ArrayLike | None = None,
    start: ArrayLike | None = None,
) -> Result:
    """Solve the last target of a scene by finite elements, with free edges or prescribed edges (n_patches, 2) in m."""
    return fem_reference.solve(**fem_arguments(scene), patches=patches, edges=edges, start=start, resolution=resolution)


def on_meshes(
    resolutions: Sequence[Resolution], *, edges: ArrayLike | str, control: ControlKind, value: float, **numbers: Any
) -> list[dict[str, Any]]:
    """Return every quantity at given edges, or in complete contact, on each mesh; arguments as of `solve`."""
    problem = fem_problem_of(**{"work_of_adhesion": 0.0, "slope_term": False} | numbers)
    wanted = control_of(problem, control, value)
    meshes = prescribed(problem, wanted, edges, resolutions)
    return [quantities(evaluate(problem, mesh, resolution, wanted)) for resolution, mesh in meshes]


def follow_fem(scene: Scene) -> tuple[FemProblem, Path, float]:
    """Follow the path of a scene by finite elements alone; return their problem, the path, and the unit of its steps.

    Raises
    ------
    AssertionError
        Where the path ends early.
    """
    problem, kind, targets = path_of(scene)
    path = follow(problem, kind, targets)
    assert path.failure == "", path.failure
    return problem, path, step_unit(kind, targets)


def descend_fem(scene: Scene) -> list[FloatArray]:
    """Return edges (n_patches, 2) in periods at every target of a scene, by descent of the energy of finite elements.

    At each target the energy descends from the contact at the target before; the first contact is a seed at the highest
    crest.

    Raises
    ------
    AssertionError
        Where contact is lost or complete.
    """
    problem, kind, targets = path_of(scene)
    branch = Branch(problem, kind, TRACKING, step_unit(kind, targets))
    edges, found = chosen_crests(problem, 1)[:, None] + SEED * np.array([[-1.0, 1.0]]), []
    for target in targets:
        point = descend(branch, edges, target, 1.0).point
        assert point is not None, f"contact is lost or complete at {kind} {target:.6g}"
        edges = point.edges
        found.append(edges)
    return found


def path_of(scene: Scene) -> tuple[FemProblem, ControlKind, list[float]]:
    """Return problem, kind of control and dimensionless targets of a scene."""
    arguments = fem_arguments(scene)
    kind = arguments.pop("control")
    del arguments["value"]
    problem = fem_problem_of(**arguments)
    return problem, kind, [control_of(problem, kind, float(target)).value for target in scene.loading.targets]


def uncertain(result: Result, name: str) -> float:
    """Return the largest uncertainty that the finite elements state of a quantity, in its unit."""
    return float(np.max(result.uncertainty[name]))


def middle_pressure(state: bem.ContactState) -> FloatArray:
    """Return the mean pressure (n_patches,) in Pa of each patch's middle by BEM, weighted by (1 - (t / 0.8)^2)^4."""
    gauss, weights = np.polynomial.legendre.leggauss(64)
    weights = weights * (1.0 - gauss**2) ** 4
    middle, half = state.edges.mean(axis=1, keepdims=True), 0.5 * np.diff(state.edges, axis=1)
    pressure = state.pressure(middle + 0.8 * half * gauss)
    return np.asarray(pressure @ weights / weights.sum())
