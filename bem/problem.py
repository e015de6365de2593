"""Dimensionless problem of a scene (SI) as its effects define it, and the increments of its path.

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
from bem.loading.increments import COARSE, Accuracy, Increments
from bem.loading.interface_law import InterfaceLaw
from bem.scene.elastic_tables import elastic_effects, negligible
from bem.scene.scene import Scene

INCREMENTS_PER_LARGEST = 25  # the smallest increment, at which events are resolved, is this part of the largest
FINEST = 1e-14  # derived: tolerance of an evaluation
FEW_DIGITS = 1e-4  # accuracy.tolerance of an adhesive path that stores few states
STATES_APART = 20.0  # format: times the largest increment between them: a state takes as long as ten steps
COARSEST_EVENT = Increments.deepest / INCREMENTS_PER_LARGEST  # rms heights, or their equal in load: as by default


@dataclass(frozen=True, eq=False)
class Problem:
    """Dimensionless problem of a scene, with the units of its results.

    Attributes
    ----------
    profile : Profile
        Dimensionless.
    surface : Profile
        SI.
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


def pose(scene: Scene, surface: Profile) -> Problem:
    """Return the dimensionless problem of a scene whose profile is not flat.

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


def increments_of(scene: Scene, problem: Problem) -> Increments:
    """Return increments and accuracies of a scene, in the units of its control."""
    unit = 1.0
    if scene.loading.control == "mean_pressure":
        unit = problem.load_of(1e-2 * problem.surface.rms_slope * problem.scales.plane_strain_modulus)
    largest = scene.accuracy.max_increment * unit
    tolerance = scene.accuracy.tolerance
    coarse = max(min(COARSE.tolerance, 0.1 * _critical_intensity(problem)), FINEST)
    fine = max(min(1e-8, 1e-2 * tolerance, coarse), FINEST)
    exactly = problem.law is None or problem.surface.has_equal_parts  # there a small error decides which one moves
    way = fine if exactly else max(min(1e-2 * tolerance, coarse), fine)
    few = problem.law is not None and tolerance >= FEW_DIGITS
    sharp = tolerance if problem.law is None else min(tolerance, 1e-6)  # a gap that is closed decides the branch
    allowed = 0.5 * max(1e-10, 1e-3 * sharp)  # half of what the certificate allows
    return Increments(
        largest=largest,
        apart=largest * (STATES_APART if few else 1.0),
        smallest=min(largest / INCREMENTS_PER_LARGEST, COARSEST_EVENT * unit, _jump_distance(problem) * unit),
        coarse=Accuracy(coarse, COARSE.residual, allowed),
        way=Accuracy(way, max(1e-1 * way, 1e-12), max(allowed, 0.5e-3 * way)),
        fine=Accuracy(fine, max(1e-1 * fine, 1e-12), allowed),
        deepest=scene.accuracy.max_increment,
        between=way if exactly else max(way, 1e-2 * coarse),
    )


def _critical_intensity(problem: Problem) -> float:
    """Return the least critical K: the coarse evaluation, whose K is off by 3e-2 times its tolerance, must resolve it.

    K is divided by the rms pressure of complete contact relative to the half-space: the error of K grows with this
    pressure on thin layers.
    """
    if problem.law is None:
        return np.inf
    critical, ratio = 2 * float(np.sqrt(problem.law.least_work)), problem.compliance_ratio
    if ratio is None:
        return critical
    orders = problem.profile.orders.astype(np.float64)
    pressure = orders * problem.profile.amplitudes
    return critical * float(np.linalg.norm(pressure) / np.linalg.norm(pressure / ratio(orders)))


def _jump_distance(problem: Problem) -> float:
    """Return half the distance a^2 kappa over which an isolated contact of the rms curvature jumps in, in rms heights.

    a = (w / (pi kappa^2))^(1/3), Barquins, J. Adhesion 26 (1988) 1: weak adhesion acts over short distances.
    """
    if problem.law is None:
        return np.inf
    return 0.5 * float(np.cbrt(problem.law.least_work**2 / problem.profile.rms_curvature))
