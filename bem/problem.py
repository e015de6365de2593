"""Dimensionless problem of a scene (SI) as its effects define it.

Only the modules of effects that the scene names are imported: adhesion.py with [adhesion], compliance.py with the
tables that change the compliance (elastic_tables.py).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np

from bem.elastic.collocation import Elastic
from bem.geometry.arrays import FloatArray
from bem.geometry.profile import Profile
from bem.geometry.scaling import Scales, Solid
from bem.loading.control import Control, DisplacementControl, LoadControl
from bem.loading.interface_law import InterfaceLaw
from bem.scene.elastic_tables import elastic_effects, negligible
from bem.scene.scene import Scene


@dataclass(frozen=True, eq=False)
class Problem:
    """Dimensionless problem of a scene, with the units of its results.

    Attributes
    ----------
    surface : Profile
        Of the scene, SI: `Scene.surface()`.
    profile : Profile
        The surface in units of the problem, dimensionless.
    elastic : Elastic
        With the compliance, unless the body is a half-space.
    law : InterfaceLaw or None
        None without adhesion.
    """

    surface: Profile
    profile: Profile
    scales: Scales
    elastic: Elastic
    control: Control
    law: InterfaceLaw | None

    @property
    def mean_compliance(self) -> float | None:
        """c(0) in m/Pa; None for a half-space."""
        return None if self.elastic.compliance is None else self.elastic.compliance.mean

    @property
    def compliance_ratio(self) -> Callable[[FloatArray], FloatArray] | None:
        """Compliance of the modes m >= 1 relative to the half-space, (n,) to (n,); None for a half-space."""
        return None if self.elastic.kernel is None else self.elastic.kernel.ratio

    def control_value(self, target: float, kind: str) -> float:
        """Return a target of the scene (m or Pa) as value of the control."""
        if kind == "mean_pressure":
            return self.load_of(target)
        if kind == "separation":
            return (self.surface.max_height - target) / self.scales.height
        return target / self.scales.height

    def load_of(self, mean_pressure: float) -> float:
        """Return the dimensionless load per period of a mean pressure in Pa."""
        return 2 * np.pi * mean_pressure / self.scales.stress

    def mean_pressure(self, load: float) -> float:
        """Return the mean pressure in Pa of a dimensionless load per period."""
        return load / (2 * np.pi) * self.scales.stress


def pose(scene: Scene) -> Problem:
    """Return the dimensionless problem of a scene whose profile is not flat."""
    surface = scene.surface()
    solid = Solid(scene.solid.youngs_modulus, scene.solid.poisson_ratio)
    profile = surface.scaled()
    scales = Scales(surface.period, surface.rms_height, solid.plane_strain_modulus)
    law: InterfaceLaw | None = None
    if scene.adhesion is not None:
        adhesion: Any = import_module("bem.adhesive.adhesion")
        interface = adhesion.Adhesion(scene.adhesion.work_of_adhesion, scene.adhesion.slope_term)
        law = adhesion.dimensionless_law(interface, profile, scales)
    effects, compliance = elastic_effects(scene), None
    if effects:
        compliance = import_module("bem.elastic.compliance").compliance_of(effects.values(), negligible(scene))
    control = _control(scene.loading.control, scales, None if compliance is None else compliance.mean)
    return Problem(surface, profile, scales, Elastic(profile, compliance), control, law)


def _control(kind: str, scales: Scales, mean_compliance: float | None) -> Control:
    """Return the control of a scene as a linear condition on penetration and load."""
    if kind == "mean_pressure":
        return LoadControl()
    if kind == "total_displacement" and mean_compliance:
        return DisplacementControl(mean_compliance * scales.stress / (2 * np.pi * scales.height))
    return DisplacementControl()
