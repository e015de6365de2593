"""From a scene (SI) to the dimensionless problem that its effects define.

Only the modules of effects that the scene names are imported here: adhesion.py with [adhesion], layer.py with
[layer].  A layer so thick that it changes less than a tenth of the tolerance is left out of the equations and kept for
their error estimates.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.collocation import Elastic
from bem.control import Control, DisplacementControl, LoadControl
from bem.interface_law import InterfaceLaw
from bem.profile import Profile
from bem.scaling import Scales, Solid
from bem.scene import Scene

FloatArray = NDArray[np.float64]

KERNEL_TRUNCATION = 1e-14  # of the layer's series; its terms are cheap


@dataclass(frozen=True, eq=False)
class Problem:
    """A scene in the units of the solver, and what converts its results.

    Attributes
    ----------
    profile : Profile
        Dimensionless.
    surface : Profile
        SI.
    mean_compliance : float or None
        c(0) in m/Pa; None for a half-space.
    compliance_ratio : callable or None
        Compliance of the modes m >= 1 relative to the half-space; None for a half-space.
    left_out : callable or None
        The same of a layer that is left out of the equations.
    law : InterfaceLaw or None
        None without adhesion.
    """

    surface: Profile
    profile: Profile
    scales: Scales
    elastic: Elastic
    control: Control
    law: InterfaceLaw | None
    mean_compliance: float | None
    compliance_ratio: Callable[[FloatArray], FloatArray] | None
    left_out: Callable[[FloatArray], FloatArray] | None = None

    def control_value(self, target: float, kind: str) -> float:
        """A target of the scene (m or Pa) as value of the control."""
        if kind == "mean_pressure":
            return self.load_of(target)
        if kind == "separation":
            return (self.surface.max_height - target) / self.scales.height
        return target / self.scales.height

    def load_of(self, mean_pressure: float) -> float:
        """Dimensionless load per period of a mean pressure in Pa."""
        return 2 * np.pi * mean_pressure / self.scales.stress

    def mean_pressure(self, load: float) -> float:
        """Mean pressure in Pa of a dimensionless load per period."""
        return load / (2 * np.pi) * self.scales.stress


def pose(scene: Scene, surface: Profile) -> Problem:
    """The dimensionless problem of a scene whose profile is not flat.

    Parameters
    ----------
    scene : Scene
    surface : Profile
        The profile of the scene, SI.
    """
    solid = Solid(scene.solid.youngs_modulus, scene.solid.poisson_ratio)
    profile = surface.scaled()
    scales = Scales(surface.period, surface.rms_height, solid.plane_strain_modulus)
    law: InterfaceLaw | None = None
    if scene.adhesion is not None:
        adhesion: Any = import_module("bem.adhesion")
        interface = adhesion.Adhesion(scene.adhesion.work_of_adhesion, scene.adhesion.slope_term)
        law = adhesion.dimensionless_law(interface, profile, scales)
    elastic, mean_compliance, ratio, left_out = Elastic(profile), None, None, None
    if scene.layer is not None:
        layer = import_module("bem.layer").Layer(scene.layer.thickness)
        mean_compliance = layer.mean_compliance(solid)
        kernel = layer.kernel(solid, surface.period, KERNEL_TRUNCATION)
        if layer.is_negligible(solid, surface.period, 0.1 * scene.accuracy.tolerance):
            elastic, left_out = Elastic(profile, left_out=kernel if kernel.terms else None), kernel.ratio
        else:
            elastic, ratio = Elastic(profile, (kernel,)), kernel.ratio
    control = _control(scene.loading.control, scales, mean_compliance)
    return Problem(surface, profile, scales, elastic, control, law, mean_compliance, ratio, left_out)


def _control(kind: str, scales: Scales, mean_compliance: float | None) -> Control:
    """The control of a scene as a linear condition on penetration and load."""
    if kind == "mean_pressure":
        return LoadControl()
    if kind == "total_displacement" and mean_compliance:
        return DisplacementControl(mean_compliance * scales.stress / (2 * np.pi * scales.height))
    return DisplacementControl()
