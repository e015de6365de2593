"""The folds that a branch comes to next, foretold from one of its points: how far ahead they lie, and in which modes.

With dH the change of the Hessian H along the branch, by the control, a mode v is neutral at t where (H + t dH) v = 0:
1/t is an eigenvalue of -U^-T dH U^-1, H = U^T U.  The greatest is that of the mode which comes first, whether or not it
is the softest yet.  Towards its fold a mode moves with the root of the distance from it, and its stiffness falls with
that root, twice as far as its tangent at the point says: the fold lies at d = t/2, and on the way to it the mode moves
twice as far as its rate at the point says.  A mode on which the load does no work, which breaks a symmetry, softens
evenly and is neutral at t.  Dimensionless.  Limits: of the first order, d is too long by about its own root, in parts
of it; modes apart from the first few are taken to move evenly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from bem.adhesive.equilibrium import System, symmetric_part
from bem.adhesive.lowest_modes import lowest_modes
from bem.adhesive.third_derivatives import hessian_change
from bem.continuation.softness import LONGEST_STEP, Soft, is_at_rest
from bem.geometry.arrays import FloatArray

MODES = 6  # that come first
RIVALS = 1.1  # times the distance of the first fold: a second mode this near may be taken for the first
SOON = 2.0  # times a way along the branch: modes that fold there soften on it to 0.7 and less
STIFFER = 0.3  # than foretold, in parts of the stiffness at the point; nine of ten modes are by less than 0.06


@dataclass(frozen=True, eq=False)
class Foretold:
    """Where a branch is expected to fold, or to break a symmetry.

    Attributes
    ----------
    direction : float
        Sign of the motion of the control.
    distances : (n,) array
        Of the control to where some modes are neutral, ascending, at least 0; inf where a mode does not soften.
    modes : (2 L, n) array
        These modes, each of stiffness 1 at the point.
    breaks : (n,) array
        Whether the load does no work on them.
    along : (2 L,) array
        Motion of the edges along the branch, per unit of the control in its direction.
    shares : (n,) array
        That of the modes.
    """

    direction: float
    distances: FloatArray
    modes: FloatArray
    breaks: NDArray[np.bool_]
    along: FloatArray
    shares: FloatArray

    @property
    def distance(self) -> float:
        """To the first of them."""
        return float(self.distances[0])

    @property
    def has_rivals(self) -> bool:
        """Whether another mode folds so soon behind the first that coarse evaluations may take one for the other."""
        return bool(self.distances[1:2].min(initial=np.inf) < RIVALS * self.distance)

    def stiffness(self, way: float) -> FloatArray:
        """Of the modes after a way of the control, (n,), in parts of that at the point."""
        left = np.maximum(1 - way / self.distances, 0.0)
        return np.asarray(np.where(self.breaks, left, np.sqrt(left)))

    def at(self, way: float) -> FloatArray:
        """Motion of the edges after a way of the control, at most to the first fold, (2 L,)."""
        soft = np.isfinite(self.distances)
        extra = 2 * self.distances[soft] * (1 - self.stiffness(way)[soft]) - way
        return np.asarray(
            way * self.along + self.modes[:, soft] @ np.where(self.breaks[soft], 0.0, self.shares[soft] * extra)
        )

    def next_to_fold(self, soft: Soft) -> tuple[FloatArray, float]:
        """Motion of the edges and of the control to the first fold, or on the way there, as long as a step may be."""
        part = 1.0
        while (size := soft.size(motion := self.at(self.distance * part * (2 - part)))) > 1.01 * LONGEST_STEP:
            part *= LONGEST_STEP / size
        return motion, self.direction * self.distance * part * (2 - part)

    def have_softened(self, hessian: FloatArray, change: float) -> bool:
        """Whether modes that are neutral after a change of the control, or soon behind, are as soft there as foretold.

        Where one is not, the contact snapped on the way, or the branch turned away from that fold.
        """
        soon = self.distances < SOON * self.direction * change
        modes = self.modes[:, soon]
        found = np.einsum("ij,ik,kj->j", modes, hessian, modes)
        return bool(np.all(found < self.stiffness(self.direction * change)[soon] + STIFFER))


def foretell_folds(system: System, soft: Soft, reach: float) -> Foretold | None:
    """The next folds of a branch as one of its points foretells them; None where that is not stable itself.

    All in the units of `soft`, whose forces know their changes along motions.

    Parameters
    ----------
    system : System
    soft : Soft
        An equilibrium.
    reach : float
        Of the motion of the control, with its sign.
    """
    direction = float(np.sign(reach))
    factor, info = lapack.dpotrf(soft.hessian, lower=0, clean=1)
    if info != 0:
        return None
    along = -direction * lapack.dpotrs(factor, soft.pull, lower=0)[0]
    change = symmetric_part(hessian_change(system, soft.here, along * soft.scale, direction), soft.scale)
    reduced = lapack.dsygst(change.T, factor, lower=0, overwrite_a=1)[0]
    rates, modes = lowest_modes(reduced.T, MODES)
    modes = np.asarray(lapack.dtrtrs(factor, modes, lower=0)[0])
    breaks = is_at_rest(soft, modes)
    with np.errstate(divide="ignore"):
        distances = np.where(rates < 0, np.where(breaks, -1.0, -0.5) / rates, np.inf)
    order = np.argsort(distances, kind="stable")
    modes, along = modes[:, order], np.asarray(along)
    return Foretold(direction, distances[order], modes, breaks[order], along, modes.T @ (soft.hessian @ along))
