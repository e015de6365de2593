"""What every path has, with adhesion or without: sizes of its increments and counts of its work.

Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.problem import Problem
from bem.scene import Scene

INCREMENTS_PER_LARGEST = 25  # the smallest increment, at which events are resolved, is this part of the largest
EQUAL, ALIKE = 1e-12, 1e-5  # of the rms height: crests that are as high as the highest, and nearly so
ALIKE_ACCURACY = 1e-3  # of the accuracies between targets, where crests are nearly as high as the highest
COARSEST_EVENT = 0.002  # of the rms height (or its equal in load): events are never resolved coarser


@dataclass(frozen=True)
class Increments:
    """Sizes of the increments in units of the control value, and accuracies.

    Parameters
    ----------
    largest, smallest : float
        Increments; an event is resolved within the smallest, or less in thin layers.
    tolerance, closure : float
        Of the evaluations, and of max |G/w - 1|, between targets.
    fine_tolerance, fine_closure : float
        The same at targets.
    allowed : float
        Interpenetration that is not a contact, in units of the rms height.
    """

    largest: float
    smallest: float
    tolerance: float = 1e-3
    closure: float = 1e-4
    fine_tolerance: float = 1e-8
    fine_closure: float = 1e-9
    allowed: float = 1e-10


def increments_of(scene: Scene, problem: Problem) -> Increments:
    """Increments and accuracies of a scene, in the units of its control."""
    unit = 1.0
    if scene.loading.control == "mean_pressure":
        unit = problem.load_of(1e-2 * problem.surface.rms_slope * problem.scales.plane_strain_modulus)
    largest = scene.accuracy.max_increment * unit
    tolerance = scene.accuracy.tolerance
    fine = min(1e-8, 1e-2 * tolerance)
    refined = ALIKE_ACCURACY if _has_twins(problem) else 1.0
    return Increments(
        largest=largest,
        tolerance=min(Increments.tolerance, 0.1 * _critical_intensity(problem)) * refined,
        closure=Increments.closure * refined,
        smallest=min(largest / INCREMENTS_PER_LARGEST, COARSEST_EVENT * unit, _jump_distance(problem) * unit),
        fine_tolerance=max(fine, 1e-14),
        fine_closure=max(1e-1 * fine, 1e-12),
        allowed=0.5 * max(1e-10, 1e-3 * tolerance),
    )


def _has_twins(problem: Problem) -> bool:
    """Whether highest crests are nearly, but not exactly, equal: less of a difference than coarse evaluations make.

    Where such crests pull off, it decides which of them goes first, and when.
    """
    heights = problem.profile.crests[1]
    lower = heights.max() - heights
    return bool(np.any((lower > EQUAL) & (lower < ALIKE)))


def _critical_intensity(problem: Problem) -> float:
    """Least critical K: the coarse evaluation, whose K is off by 3e-2 times its tolerance, must resolve it."""
    return np.inf if problem.law is None else 2 * float(np.sqrt(problem.law.least_work))


def _jump_distance(problem: Problem) -> float:
    """Half the distance a^2 kappa over which a lone contact of the rms curvature jumps in, in rms heights.

    a = (w / (pi kappa^2))^(1/3), Barquins, J. Adhesion 26 (1988) 1: weak adhesion acts over short distances.
    """
    if problem.law is None:
        return np.inf
    profile = problem.profile
    curvature = float(np.sqrt(np.sum((profile.orders**2 * profile.amplitudes) ** 2) / 2))
    return 0.5 * float(np.cbrt(problem.law.least_work**2 / curvature))


@dataclass
class Effort:
    """Counts of work along a path."""

    evaluations: int = 0
    local_evaluations: int = 0
    unknowns: int = 0
    accepted: int = 0
    rejected: int = 0

    def book(self, evaluations: int, local_evaluations: int) -> None:
        """Add what an event cost."""
        self.evaluations += evaluations
        self.local_evaluations += local_evaluations
