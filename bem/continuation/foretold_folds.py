"""The folds that a branch comes to next, foretold from one of its points: how far ahead they lie, and in which modes.

With dH the change of the Hessian H along the branch, by the control, a mode v is neutral at t where (H + t dH) v = 0:
1/t is an eigenvalue of -U^-T dH U^-1, H = U^T U.  The greatest is that of the mode which comes first, whether or not it
is the softest yet.  Towards its fold a mode moves with the root of the distance from it, and its stiffness falls with
that root, twice as far as its tangent at the point says: the fold lies at d = t/2, and on the way to it the mode moves
twice as far as its rate at the point says.  dH is a difference of Hessians.  Dimensionless.  Limits: predictions of the
first order, a few per cent off where d is below 1e-2; modes apart from the first few are taken to move evenly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import lapack

from bem.adhesive.equilibrium import System
from bem.adhesive.lowest_modes import lowest_modes
from bem.continuation.softness import SIDEWAYS, Soft, forces_at, hessian_in
from bem.geometry.arrays import FloatArray

EVEN = 0.1  # of the reach, at most, over which dH is a difference
MODES = 6  # that come first
SOON = 2.0  # times a way along the branch: modes that fold there soften on it to 0.7 and less
STIFFER = 0.3  # than foretold, in parts of the stiffness at the point; nine of ten modes are by less than 0.06


@dataclass(frozen=True, eq=False)
class Foretold:
    """Where a branch is expected to fold.

    Attributes
    ----------
    distances : (n,) array
        Of the control to the folds of some modes, ascending, at least 0; inf where a mode does not soften.
    modes : (2 L, n) array
        Which turn neutral there, each of stiffness 1 at the point.
    along : (2 L,) array
        Motion of the edges by the control along the branch.
    """

    distances: FloatArray
    modes: FloatArray
    along: FloatArray
    shares: FloatArray

    @property
    def distance(self) -> float:
        """To the first fold."""
        return float(self.distances[0])

    def at(self, part: float) -> tuple[FloatArray, float]:
        """Motion of the edges, (2 L,), and of the control, where the first mode has gone a part of its way."""
        way = self.distance * part * (2 - part)
        soft = np.isfinite(self.distances)
        far = self.distances[soft]
        extra = self.shares[soft] * (2 * far * (1 - np.sqrt(np.maximum(1 - way / far, 0.0))) - way)
        return way * self.along + self.modes[:, soft] @ extra, way

    def have_softened(self, hessian: FloatArray, way: float) -> bool:
        """Whether modes that fold by the end of a way, or soon behind, are as soft there as foretold.

        Where one is not, the contact snapped on the way, or the branch turned away from that fold.
        """
        soon = self.distances < SOON * abs(way)
        modes, foretold = self.modes[:, soon], np.sqrt(np.maximum(1 - abs(way) / self.distances[soon], 0.0))
        return bool(np.all(np.einsum("ij,ik,kj->j", modes, hessian, modes) < foretold + STIFFER))


def foretell_folds(system: System, soft: Soft, reach: float, tolerance: float) -> Foretold | None:
    """The next folds of a branch as one of its points foretells them; None where that is not stable itself.

    Takes one evaluation; all in the units of `soft`.

    Parameters
    ----------
    system : System
    soft : Soft
        An equilibrium.
    reach : float
        Of the motion of the control, with its sign.
    tolerance : float
        Of the evaluation.

    Raises
    ------
    LostError
        Forces beside it are not those of cracks.
    """
    direction = float(np.sign(reach))
    factor, info = lapack.dpotrf(soft.hessian, lower=0, clean=1)
    if info != 0:
        return None
    along = -direction * lapack.dpotrs(factor, soft.pull, lower=0)[0]
    step = min(SIDEWAYS / soft.size(along), EVEN * abs(reach))
    beside = forces_at(system, soft, step * along, soft.value + direction * step, tolerance, soft.here.state.resolution)
    change = (hessian_in(beside, soft.scale) - soft.hessian) / step
    half = lapack.dtrtrs(factor, change, lower=0, trans=1)[0]
    whole = lapack.dtrtrs(factor, half.T, lower=0, trans=1)[0]
    rates, modes = lowest_modes((whole + whole.T) / 2, MODES)
    modes = np.asarray(lapack.dtrtrs(factor, modes, lower=0)[0])
    with np.errstate(divide="ignore"):
        distances = np.where(rates < 0, -0.5 / rates, np.inf)
    return Foretold(distances, modes, np.asarray(along), modes.T @ (soft.hessian @ along))
