"""Ways from a limit point: where the contact goes when its branch has ended.  Dimensionless.

From a fold the mode itself leads on, to the side on which the potential falls: by a force D_v H v s^2 / 2 after a
motion s, which says how long a push must be for a force to be felt.  Small snaps lead back soon behind, and may take
finer evaluations.  Where a symmetry breaks both sides lead on, by a force that begins with s^3, and several modes may
be soft together: among equal patches one shrinks.  What the other edges do meanwhile may change the sign of that force:
where it holds against the mode alone, the branch that begins there is followed (turning_points.py).  If it is unstable,
it leads back, and forces lead on from where it begins.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.adhesive.branch import outward_motion
from bem.adhesive.equilibrium import System, balance
from bem.continuation.limit_points import LimitPoint
from bem.continuation.softness import LONGEST_STEP, LostError, Soft
from bem.continuation.turning_points import continued
from bem.geometry.arrays import FloatArray
from bem.loading.increments import Accuracy

DEPARTURES = (0.02, 0.04, 0.08, 0.16)  # of the edge scale; where a symmetry breaks, of a wave that may pin if shorter
FORCES = (1e-2, 1e-3, 1e-6)  # of the work of adhesion, that a push from a fold shall meet; the last, finely evaluated
LEAST_FORCE = 3.0  # times the residual between targets
TIED = 1e-6  # relative difference of patches that are equal
QUARTERS = 8  # lengths along another branch, each a quarter of the last
UNEVEN = 0.5  # relative difference from 16 of what an eigenvalue grows by over four times the length: as its square


@dataclass(frozen=True, eq=False)
class Departure:
    """A way from a limit point.

    Attributes
    ----------
    outward : (2 L,) array
        Motion of the edges, the first on which they feel a force along it, or a long one.
    leads_on : bool
        Whether the force is along the motion; against it all the way where another branch begins continuously.
    fine : bool
        Whether finer evaluations alone feel it.
    other : Soft or None
        Where no force leads on: a stable state of the branch that begins where a symmetry breaks, close to there; None
        at a fold, and where it is not found.
    """

    outward: FloatArray
    leads_on: bool
    fine: bool
    other: Soft | None = None


def departure(system: System, limit: LimitPoint, coarse: Accuracy, fine: Accuracy) -> Departure:
    """A way from a limit point, and whether forces lead on along it.

    Parameters
    ----------
    system : System
    limit : LimitPoint
    coarse, fine : Accuracy
        Of the evaluations, and of max |G/w - 1|: weaker forces say nothing.
    """
    state, direction = limit.balance.state, _direction(limit)
    unit = state.patches.edge_scale
    if limit.kind == "broken_symmetry":
        unit = np.minimum(unit, system.pinning.shortest(limit.balance.work, unit))
    motion = direction / np.max(np.abs(direction) / unit)
    pushes = [(part, coarse) for part in DEPARTURES]
    if limit.kind == "fold":
        first, second, least = _pushes(system, limit)
        second, least = min(second, DEPARTURES[-1]), min(least, DEPARTURES[-1])
        pushes = [(min(first, DEPARTURES[0]), coarse), (second, coarse), (second, fine), (least, fine)]
    force, outward = -np.inf, motion
    for part, accuracy in pushes:
        if accuracy is fine:
            force = -np.inf
        for sign in (1.0,) if limit.kind == "fold" else (1.0, -1.0):
            moved = state.patches.moved(sign * part * motion)
            here = balance(system, moved, state.penetration, limit.exact.value, accuracy.tolerance)
            along = -sign * float(here.gradient @ motion) / float(here.work @ np.abs(motion))
            if along > force:
                force, outward = along, sign * part * motion
        if force > LEAST_FORCE * accuracy.residual:
            return Departure(outward, True, accuracy is fine)
    outward = np.sign(outward @ motion) * DEPARTURES[-1] * motion
    other = None if limit.kind == "fold" else _other_branch(system, limit, motion, fine.tolerance)
    if other is not None and other.eigenvalues[0] < 0:
        return Departure(outward_motion(state.patches, other.here.state.patches), True, True)
    return Departure(outward, False, False, other)


def _other_branch(system: System, limit: LimitPoint, motion: FloatArray, tolerance: float) -> Soft | None:
    """A state of the branch that begins where a symmetry breaks by a motion.

    At most a fifth of that away, and so close that its lowest eigenvalue grows about as the length squared, from there
    on.  None where that is not found, as where several modes are neutral.
    """
    here = limit.balance
    start = Soft(system, here, limit.exact.value, here.scale)
    longest = start.size(motion / here.scale)
    way, found = (motion / here.scale / longest, 0.0), list[Soft]()
    for quarters in range(QUARTERS):
        try:
            length = LONGEST_STEP * longest / 4**quarters
            found.append(continued(system, start, length, way, tolerance, least=1))  # the other edges follow
        except (LostError, np.linalg.LinAlgError):
            found.clear()
        lowest = np.array([state.eigenvalues[0] for state in found[-3:]])
        if lowest.size == 3 and np.all(np.abs(lowest[:-1] / lowest[1:] / 16 - 1) < UNEVEN):
            return found[-3]
    return None


def _pushes(system: System, limit: LimitPoint) -> FloatArray:
    """Pushes from a fold, in edge scales, after which the quadratic force along its mode has the sizes `FORCES`."""
    here, mode = limit.balance, limit.modes[:, 0]
    bent = limit.bend * system.control.rate(here.state) * float(here.load_gradient @ mode)
    length = np.sqrt(np.array(FORCES) * float(here.work @ np.abs(mode)) / abs(bent))
    return np.asarray(length * np.max(np.abs(mode) / here.state.patches.edge_scale))


def _direction(limit: LimitPoint) -> FloatArray:
    """Outward motion of the edges, (2 L,): the mode of a fold; at a bifurcation that in which a force acts.

    Or else the one nearest to a single patch that shrinks, or slides where modes move patches more than they shrink
    them; among equal patches the first.
    """
    if limit.kind == "fold":
        return np.asarray(limit.modes[:, 0])
    if limit.is_pushed:
        return limit.push
    unit = limit.modes / np.linalg.norm(limit.modes, axis=0)
    left, right = np.split(unit, 2)
    shrink, slide = -(left + right), right - left
    alone = max(shrink, slide, key=np.linalg.norm)
    share = np.linalg.norm(alone, axis=1)
    first = int(np.flatnonzero(share >= (1 - TIED) * share.max())[0])
    return np.asarray(unit @ alone[first])
