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
from validation.references.adapters import taken


def fem_arguments(posed: Scene) -> dict[str, Any]:
    """Arguments of `fem_reference.solve` for the last target of a scene with a layer.

    ValueError without a layer, and for a table that the finite elements do not know.
    """
    solid, _, layer, adhesion = taken(posed, "the finite element reference", "solid", "profile", "layer", "adhesion")
    if layer is None:
        raise ValueError("scene: the finite element reference needs a [layer]")
    surface = posed.surface()
    return {
        "youngs_modulus": solid.youngs_modulus,
        "poisson_ratio": solid.poisson_ratio,
        "thickness": layer.thickness,
        "period": surface.period,
        "harmonics": (surface.orders, surface.amplitudes, surface.phases),
        "work_of_adhesion": 0.0 if adhesion is None else adhesion.work_of_adhesion,
        "slope_term": False if adhesion is None else adhesion.slope_term,
        "control": posed.loading.control,
        "value": float(posed.loading.targets[-1]),
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
    solid, _, layer, _ = taken(posed, "bem.ContactState", "solid", "profile", "layer", "adhesion")
    return bem.ContactState(
        posed.surface(),
        bem.Solid(solid.youngs_modulus, solid.poisson_ratio),
        edges,
        penetration,
        layer=None if layer is None else bem.Layer(layer.thickness),
    )


def middle_pressure(state: bem.ContactState) -> FloatArray:
    """Mean pressure (n_patches,) in Pa of the middle of each patch, weighted by (1 - (t / 0.8)^2)^4, |t| < 0.8."""
    gauss, weights = np.polynomial.legendre.leggauss(64)
    weights = weights * (1.0 - gauss**2) ** 4
    middle, half = state.edges.mean(axis=1, keepdims=True), 0.5 * np.diff(state.edges, axis=1)
    pressure = state.pressure(middle + 0.8 * half * gauss)
    return np.asarray(pressure @ weights / weights.sum())
