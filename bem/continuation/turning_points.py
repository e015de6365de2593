"""Points next to which a branch turns, found by following it by its length, with the control as an unknown.

Where a branch turns sharply, as those of almost symmetric profiles do, or its fold is not foretold, the edges lead to
it in short steps.  Dimensionless.
Source: Keller, Numerical Methods in Bifurcation Problems (1987), section 5.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bem.adhesive.equilibrium import System
from bem.continuation.softness import LONGEST_STEP, NEAR, LostError, Soft, forces_at
from bem.elastic.collocation import resolve
from bem.geometry.arrays import FloatArray

CONTINUED, CORRECTIONS = 60, 5  # steps around a fold, and evaluations of each


def turning_points(system: System, soft: Soft, reach: float, tolerance: float) -> Iterator[Soft]:
    """Forces next to the places where the control turns on the branch of a point, and one mode is neutral.

    Parameters
    ----------
    system : System
    soft : Soft
        An equilibrium.
    reach : float
        How far the control may change, with the sign of its motion.
    tolerance : float
        Of the evaluations.
    """
    begin, length, way = soft.value, LONGEST_STEP / 4, _tangent(soft, _along(soft) * reach)
    for _ in range(CONTINUED):
        try:
            ahead = continued(system, soft, length, way, tolerance)
            turned = _tangent(ahead, way[0])
            if turned[1] * way[1] < 0 and ahead.is_alone:
                yield continued(system, soft, length * way[1] / (way[1] - turned[1]), way, tolerance)
        except LostError:
            ahead = None
        within = ahead is not None and ahead.eigenvalues[0] > 0 and -0.5 <= (ahead.value - begin) / reach <= 2
        if ahead is not None and within:
            soft, way, length = ahead, turned, min(1.5 * length, LONGEST_STEP)
        else:
            length /= 3
            if length < NEAR / 10:
                return


def _along(soft: Soft) -> FloatArray:
    """Motion of the edges along the branch by the control, (2 L,)."""
    return np.asarray(-np.linalg.solve(soft.hessian, soft.pull))


def _tangent(soft: Soft, along: FloatArray) -> tuple[FloatArray, float]:
    """Motion of edges and control along a branch, on the side of a given motion, as long as the edge scale."""
    step = np.linalg.solve(_bordered(soft, along), np.append(np.zeros(along.size), 1.0))
    size = soft.size(step[:-1]) * float(np.sign(along @ step[:-1]))
    return np.asarray(step[:-1] / size), float(step[-1]) / size


def continued(
    system: System, soft: Soft, length: float, way: tuple[FloatArray, float], tolerance: float, least: int = 0
) -> Soft:
    """The state of a branch a length along its tangent, which has the length of the edge scale.

    After at least so many corrections: a short step along a tangent is close to the branch, but has not its curvature.

    Raises
    ------
    LostError
        It is not found.
    """
    resolution = resolve(system.elastic, soft.here.state.patches, tolerance)
    step, change = length * way[0], length * way[1]
    for count in range(CORRECTIONS):
        here = forces_at(system, soft, step, soft.value + change, tolerance, resolution)
        soft = Soft(system, here, soft.value + change, soft.scale, soft.mode)
        both = np.linalg.solve(_bordered(soft, way[0]), -np.append(soft.gradient, 0.0))
        step, change = both[:-1], float(both[-1])
        if count >= least and soft.size(step) <= NEAR * length:
            return soft
    raise LostError


def _bordered(soft: Soft, along: FloatArray) -> FloatArray:
    """Derivatives of the forces by edges and control, and a last row for the motion along a direction."""
    size = along.size
    matrix = np.zeros((size + 1, size + 1))
    matrix[:size, :size], matrix[:size, size], matrix[size, :size] = soft.hessian, soft.pull, along
    return matrix
