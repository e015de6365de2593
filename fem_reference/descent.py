"""Descent of the energy at a fixed control: the edges after a jump, with patches and gaps that come and go.

Every edge moves the way that lowers the energy, out where K < K_c and in where K > K_c, by a share of the shorter of
the patch and the gap beside it (residual r of `closure`, share SHARE r / (|r| + SOFT)). An edge whose residual changes
sign is slowed down, any other one speeds up again. Between the moves

- a patch whose edges both move in, or a gap whose edges both move out, is taken out once it is narrower than NARROW,
  and any patch or gap once it is narrower than TRACE;
- where the gap between the faces is negative, a patch is put in;
- near rest Newton's method (`continuation`) is tried. It decides only where the descent ends, not in which valley.

Each change has a name: detachment, pull_off, coalescence, complete_contact, new_contact.

Units: as in `problem` (dimensionless).
"""

from dataclasses import dataclass

import numpy as np

from fem_reference.closure import intervals
from fem_reference.continuation import Branch, Point, gap_minima
from fem_reference.mesh import layer_mesh
from fem_reference.problem import BoolArray, FloatArray

SEED = 1e-3  # periods: half the width of a new patch
NARROW = 3e-3  # periods: a patch that shrinks, or a gap that closes, is gone when so narrow
TRACE = 2e-4  # periods: any patch or gap so narrow is gone
ENTERED = -1e-3  # rms heights: gap below which a new patch is put in
SHARE, SOFT = 0.25, 0.2  # of the patch or gap beside an edge that it moves at most; residual that halves its pace
WIDEST = 0.05  # periods: patch or gap beside an edge that counts
NEAR, SOONER = 0.3, 0.5  # residual at which Newton is tried first; share of it to which it falls before the next try
MOVES = 300


@dataclass(frozen=True)
class Change:
    """A patch or gap that came or went in a jump: its kind and position (periods)."""

    kind: str
    position: float


@dataclass(frozen=True)
class Rest:
    """End of a descent: a point of a branch, or None where contact is complete or lost (`changes` ends with it)."""

    point: Point | None
    changes: tuple[Change, ...]


class NoRestError(RuntimeError):
    """The edges find no rest at a fixed control."""


def descend(branch: Branch, edges: FloatArray, value: float, direction: float) -> Rest:
    """Move the edges (n_patches, 2) downhill at a value of the control until they rest.

    Parameters
    ----------
    branch : Branch
    edges : FloatArray, shape (n_patches, 2)
    value : float
    direction : float
        Sign of the change of the control with which the path continues.

    Raises
    ------
    NoRestError
        After MOVES moves.
    """
    changes: list[Change] = []
    pace, before, near = np.zeros(0), np.zeros(0), NEAR
    problem, resolution = branch.problem, branch.resolution
    for _ in range(MOVES):
        mesh = layer_mesh(problem.depth, edges, resolution, problem.highest_order)
        evaluation = branch.evaluated(mesh, value)
        lack = branch.residual(evaluation, value)
        remaining, lost = without_narrow(edges, lack.reshape(edges.shape) > 0.0)
        changes += lost
        if remaining.size == 0:
            return Rest(None, tuple(changes))
        if lost:
            edges, near = remaining, NEAR
            continue
        entered, gap = min(gap_minima(evaluation), key=lambda minimum: minimum[1], default=(0.0, 0.0))
        if gap < ENTERED:
            changes.append(Change("new_contact", entered % 1.0))
            edges, near = with_patch(edges, entered), NEAR
            continue
        size = float(np.max(np.abs(lack)))
        if size < near:
            near = SOONER * size
            point = branch.at(evaluation, value, direction)
            if point is not None and point.stable:
                return Rest(point, tuple(changes))
        if len(pace) != len(lack):
            pace = np.full(len(lack), SHARE)
        else:
            pace = np.clip(pace * np.where(before * lack < 0.0, 0.5, 1.3), 1e-3, SHARE)
        before = lack
        beside = np.minimum(np.minimum(intervals(edges), np.roll(intervals(edges), 1)), WIDEST)
        outwards = np.tile([-1.0, 1.0], len(edges))
        edges = edges - (pace * lack / (np.abs(lack) + SOFT) * beside * outwards).reshape(edges.shape)
    raise NoRestError(f"no equilibrium at control {value:.6g}: the edges still move after {MOVES} moves")


def without_narrow(edges: FloatArray, opening: BoolArray) -> tuple[FloatArray, list[Change]]:
    """Return edges (n_patches, 2) without narrow patches and gaps, and the changes; (0, 2) where nothing is left.

    Parameters
    ----------
    edges : FloatArray, shape (n_patches, 2)
    opening : BoolArray, shape (n_patches, 2)
        True where an edge moves into its patch.

    Examples
    --------
    >>> edges = np.array([[0.1, 0.3], [0.302, 0.5], [0.7, 0.702]])
    >>> without_narrow(edges, np.array([[False, False], [False, False], [True, True]]))[0]
    array([[0.1, 0.5]])
    """
    changes = []
    width = np.diff(edges)[:, 0]
    gone = ((width < NARROW) & opening.all(axis=1)) | (width < TRACE)
    for middle in edges[gone].mean(axis=1):
        changes.append(Change("detachment", float(middle % 1.0)))
    edges, opening = edges[~gone].copy(), opening[~gone].copy()
    if changes and edges.size == 0:
        changes[-1] = Change("pull_off", changes[-1].position)
    k = 0
    while k < len(edges):
        after = (k + 1) % len(edges)
        beyond = edges[after] + (after == 0)  # the next patch, a period on after the last one
        gap = float(beyond[0] - edges[k, 1])
        closing = not (opening[k, 1] or opening[after, 0])
        if gap > TRACE and not (gap < NARROW and closing):
            k += 1
            continue
        middle = float(edges[k, 1] + 0.5 * gap) % 1.0
        if len(edges) == 1:
            return np.zeros((0, 2)), [*changes, Change("complete_contact", middle)]
        changes.append(Change("coalescence", middle))
        edges[k, 1], opening[k, 1] = beyond[1], opening[after, 1]
        edges, opening = np.delete(edges, after, 0), np.delete(opening, after, 0)
        k = 0 if after == 0 else k
    return edges, changes


def with_patch(edges: FloatArray, middle: float) -> FloatArray:
    """Return edges (n_patches, 2) with a new patch in one of their gaps, in order along the period."""
    x = edges[0, 0] + (middle - edges[0, 0]) % 1.0
    every = np.vstack([edges, [[x - SEED, x + SEED]]])
    return np.asarray(every[np.argsort(every[:, 0])])
