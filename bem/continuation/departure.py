"""Ways from a limit point: where the contact goes when its branch has ended.  Dimensionless.

From a fold the mode itself leads on, to the side on which the potential falls.  Where a symmetry breaks both sides do,
and several modes may be soft together: among equal patches one shrinks.  The way is as short as forces can be felt.
"""

from __future__ import annotations

import numpy as np

from bem.adhesive.equilibrium import System, balance
from bem.continuation.limit_points import LimitPoint, is_pushed
from bem.geometry.arrays import FloatArray
from bem.loading.increments import Accuracy

DEPARTURES = (0.02, 0.04, 0.08, 0.16)  # of the edge scale
LEAST_FORCE = 3.0  # times the residual between targets
TIED = 1e-6  # relative difference of patches that are equal


def departure(system: System, limit: LimitPoint, accuracy: Accuracy) -> tuple[FloatArray, bool, int]:
    """A way from a limit point, whether forces lead on along it, and the number of evaluations.

    Parameters
    ----------
    system : System
    limit : LimitPoint
    accuracy : Accuracy
        Of the evaluations, and of max |G/w - 1|: weaker forces say nothing.

    Returns
    -------
    outward : (2 L,) array
        Motion of the edges, the shortest on which they feel a force, or the longest one tried.
    leads_on : bool
        Whether the force is along the motion; against it all the way where another branch begins continuously.
    evaluations : int
    """
    state, direction = limit.balance.state, _direction(limit)
    motion = direction / np.max(np.abs(direction) / state.patches.edge_scale)
    force, outward, evaluations = -np.inf, motion, 0
    for part in DEPARTURES:
        for sign in (1.0,) if limit.kind == "fold" else (1.0, -1.0):
            moved = state.patches.moved(sign * part * motion)
            here = balance(system, moved, state.penetration, limit.exact.value, accuracy.tolerance)
            evaluations += 1
            along = -sign * float(here.gradient @ motion) / float(here.work @ np.abs(motion))
            if along > force:
                force, outward = along, sign * part * motion
        if force > LEAST_FORCE * accuracy.residual:
            return outward, True, evaluations
    return outward * (DEPARTURES[-1] / float(np.max(np.abs(outward) / state.patches.edge_scale))), False, evaluations


def _direction(limit: LimitPoint) -> FloatArray:
    """Outward motion of the edges, (2 L,): the mode of a fold; at a bifurcation that in which a force acts, or the one
    nearest to a single patch that shrinks, among equal ones the first."""
    modes = limit.modes
    if limit.kind == "fold":
        return np.asarray(modes[:, 0])
    unit = modes / np.linalg.norm(modes, axis=0)
    if is_pushed(limit):
        return np.asarray(-unit @ (limit.balance.gradient @ unit))
    count = limit.balance.state.patches.count
    shrink = -(unit[:count] + unit[count:])
    share = np.linalg.norm(shrink, axis=1)
    first = int(np.flatnonzero(share >= (1 - TIED) * share.max())[0])
    return np.asarray(unit @ shrink[first])
