"""From a scene to the finite element reference: raw E, nu, thickness, harmonics, work of adhesion, what is prescribed.

Nothing that either code derived from these crosses over: no E*, no slope, no edge, no stress intensity.
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
from validation.references.adapters import contact_of, problem_of

DEPTH = 3.0  # periods: a layer so thick is the half-space within 1e-12


def fem_arguments(posed: Scene) -> dict[str, Any]:
    """Arguments of `fem_reference.solve` for the last target of a scene with a layer.

    ValueError without a layer, and for a table that the finite elements do not know.
    """
    problem = problem_of(posed, "the finite element reference", "layer", "adhesion")
    if problem.thickness is None:
        raise ValueError("scene: the finite element reference needs a [layer]")
    return raw(problem) | {"control": problem.control, "value": problem.targets[-1]}


def raw(problem: Problem) -> dict[str, Any]:
    """What the finite elements are told of solid, profile and adhesion; a half-space is a layer of DEPTH."""
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
    posed: Scene,
    resolution: Resolution,
    patches: int = 1,
    edges: ArrayLike | None = None,
    start: ArrayLike | None = None,
) -> Result:
    """The reference's own state of a scene (`fem_arguments`): its own edges, or prescribed ones (n_patches, 2) in m."""
    return fem_reference.solve(**fem_arguments(posed), patches=patches, edges=edges, start=start, resolution=resolution)


def contact_state(posed: Scene, edges: ArrayLike, penetration: float) -> bem.ContactState:
    """The boundary elements' elastic state of a scene at edges (n_patches, 2) and penetration, both in m.

    ValueError for a table that `bem.ContactState` does not know.
    """
    return contact_of(problem_of(posed, "bem.ContactState", "layer", "adhesion"), edges, penetration)


def middle_pressure(state: bem.ContactState) -> FloatArray:
    """Mean pressure (n_patches,) in Pa of the middle of each patch, weighted by (1 - (t / 0.8)^2)^4, |t| < 0.8."""
    gauss, weights = np.polynomial.legendre.leggauss(64)
    weights = weights * (1.0 - gauss**2) ** 4
    middle, half = state.edges.mean(axis=1, keepdims=True), 0.5 * np.diff(state.edges, axis=1)
    pressure = state.pressure(middle + 0.8 * half * gauss)
    return np.asarray(pressure @ weights / weights.sum())
