"""A scene for the finite element reference: raw E, nu, thickness, harmonics, work of adhesion, and the control.

Nothing that either code derived crosses over: no E*, no slope, no edge, no stress intensity.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import bem
import fem_reference
from bem.scene.scene import Scene
from fem_reference import Resolution, Result
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
