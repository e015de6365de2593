"""Minima of functions between three points each, to rounding, by parabolas on ever shorter bases.

The parabola through three points b apart has its vertex f''' b^2 / (6 f'') beside the minimum, so that the next base
may be shorter: `RATIO` times each time.  Rounding e of the function moves the vertex by e / (f'' b), and the value by
the square of either times f'' / 2.  With ten points per wave, three bases leave 5e-6 of the wave, six leave 1e-10.

Promised: minima stay between their outer points; each is refined on its own, whatever others stand beside it; nothing
is evaluated outside.  Not promised: the lowest of several minima between two points, and minima at the outer points.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bem.geometry.arrays import FloatArray

REFINEMENTS, RATIO = 3, 5.0  # parabolas after the first, and how much shorter the base of each is
TO_ROUNDING = 2 * REFINEMENTS  # where the depth of a minimum is a small part of what the function is made of
OFFSETS = np.array([[-1.0], [0.0], [1.0]])  # of three points from the middle one


@dataclass(frozen=True, eq=False)
class Minima:
    """Minima of functions: positions, values and second derivatives, (n,) each."""

    position: FloatArray
    value: FloatArray
    curvature: FloatArray


def refined(
    function: Callable[[FloatArray], FloatArray],
    x: FloatArray,
    y: FloatArray | None = None,
    refinements: int = REFINEMENTS,
) -> Minima:
    """Return the minima between the outer of three points each.

    Parameters
    ----------
    function : callable
        Values at points, (3, n) to (3, n); column i belongs to minimum i.
    x, y : (3, n) arrays
        Ascending points, the middle one lowest, and the values there (evaluated if not given).
    refinements : int
        Parabolas after the first.

    Examples
    --------
    >>> lowest = refined(np.cos, np.array([[2.9], [3.1], [3.3]]), refinements=TO_ROUNDING)
    >>> bool(abs(lowest.position[0] - np.pi) < 1e-9), float(lowest.value[0])
    (True, -1.0)
    """
    first, last = x[0], x[2]
    reach = np.minimum(x[1] - x[0], x[2] - x[1])
    minima = vertices(x, function(x) if y is None else y)
    for _ in range(refinements if x.size else 0):
        reach = reach / RATIO
        x = np.minimum(np.maximum(minima.position, first + reach), last - reach) + reach * OFFSETS
        minima = vertices(x, function(x))
    return minima


def vertices(x: FloatArray, y: FloatArray) -> Minima:
    """Return the lowest points of the parabolas through three points, (3, n) each; the middle one without a vertex."""
    (left, _, right), (rise_left, _, rise_right) = x - x[1], y - y[1]
    slope_left, slope_right = rise_left / left, rise_right / right
    curvature = (slope_right - slope_left) / (right - left)
    slope = slope_left - curvature * left
    shift = np.divide(-slope, 2 * curvature, out=np.zeros(slope.size), where=curvature > 0)
    shift = np.minimum(np.maximum(shift, left), right)
    return Minima(x[1] + shift, y[1] + shift * (slope + curvature * shift), 2 * curvature)
