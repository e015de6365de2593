"""Increments and accuracies of a path, as its scene and the adhesion of its problem ask for them."""

from __future__ import annotations

import numpy as np

from bem.loading.increments import COARSE, Accuracy, Increments
from bem.problem import Problem
from bem.scene.scene import Scene

INCREMENTS_PER_LARGEST = 25  # the smallest increment, at which events are resolved, is this part of the largest
FINEST = 1e-14  # derived: tolerance of an evaluation
FEW_DIGITS = 1e-4  # accuracy.tolerance of an adhesive path that stores few states
STATES_APART = 20.0  # format: times the largest increment between them: a state takes as long as ten steps
COARSEST_EVENT = Increments.deepest / INCREMENTS_PER_LARGEST  # rms heights, or their equal in load: as by default


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
