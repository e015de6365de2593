"""Starting contact from the crests of the profile: a one-parameter family of patches, one around each of the highest.

At depth tau below the highest point, the patch of a crest of height h_i reaches down to h_i - delta_i on both sides,

    delta_i = max( tau - (h_max - h_i), tau / 10 ),

stopping short of the valley towards the next chosen crest. The closure is looked for along this family first: where
the mean of K - K_c changes from closing (negative) to opening (positive) as the contact grows, the energy has a
minimum along it. Geometry of the profile only; nothing comes from another solver.

Units: as in `problem` (dimensionless).
"""

import numpy as np

from fem_reference.problem import FloatArray, InvalidProblemError, Problem

GRID = 4096  # points per period and unit of the highest order, on which crests are walked down
SHORT_OF_VALLEY = 0.95


def chosen_crests(problem: Problem, patches: int) -> FloatArray:
    """Return the positions (patches,) of the highest crests, in order along the period.

    Raises
    ------
    InvalidProblemError
        For a number of patches the profile has no crests for.
    """
    if patches < 1 or patches != int(patches):
        raise InvalidProblemError("patches", f"must be a positive integer, got {patches!r}")
    if problem.crests.size < patches:
        raise InvalidProblemError("patches", f"the profile has {problem.crests.size} crests, {patches} asked for")
    return np.asarray(np.sort(problem.crests[:patches]))


def crest_patches(problem: Problem, crests: FloatArray, depth: float) -> FloatArray:
    """Return the patches (n_patches, 2) of the family at depth tau, in periods.

    Parameters
    ----------
    problem : Problem
    crests : FloatArray, shape (n_patches,)
        Positions in increasing order.
    depth : float
        tau > 0 in units of the rms height.

    Examples
    --------
    >>> layer = Problem(1.0, 0.3, 1.0, 1.0, [1], [0.01], [0.0])
    >>> crest_patches(layer, np.array([0.5]), np.sqrt(2)).shape
    (1, 2)
    """
    n = GRID * problem.highest_order
    step = 1.0 / n
    patches = []
    for i, crest in enumerate(crests):
        height = float(problem.height(crest))
        level = height - max(depth - (problem.highest - height), 0.1 * depth)
        bend = max(-float(problem.curvature(crest)), np.finfo(float).tiny)
        near = np.sqrt(2.0 * (height - level) / bend)  # within the first points: a parabola
        sides = []
        for direction, neighbour in ((-1.0, crests[i - 1]), (1.0, crests[(i + 1) % len(crests)])):
            distance = (direction * (neighbour - crest)) % 1.0 or 1.0
            offsets = step * np.arange(1, int(distance / step))
            along = problem.height(crest + direction * offsets)
            valley = SHORT_OF_VALLEY * offsets[np.argmin(along)]
            below = np.flatnonzero(along < level)
            walked = offsets[below[0]] if below.size else np.inf
            resolved = max(min(walked, valley), 2.0 * step)
            sides.append(crest + direction * (resolved if near > 4.0 * step else near))
        patches.append(sides)
    return np.array(patches)


def scaled_patches(edges: FloatArray, factor: float) -> FloatArray:
    """Return the patches (n_patches, 2) with their widths multiplied about their middles."""
    middle, half = edges.mean(axis=1, keepdims=True), 0.5 * np.diff(edges, axis=1)
    return np.asarray(middle + factor * half * np.array([-1.0, 1.0]))
