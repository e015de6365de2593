"""Branch that begins where a symmetry breaks.

Where a symmetry breaks two branches cross and the bordered system of the curve is singular.  The branch of broken
symmetry is taken up in the plane a small motion along the neutral mode away (branch switching; H. B. Keller, Numerical
Methods in Bifurcation Problems, 1987, section 5).  Where several modes are neutral together, as among equal patches,
the motion is the one nearest to one patch alone that shrinks or slides: such branches begin at this point by symmetry
(Golubitsky, Stewart, Schaeffer, Singularities and Groups in Bifurcation Theory II, 1988, chapter XIII).  Dimensionless.
"""

from __future__ import annotations

import numpy as np

from bem.adhesive.branch import outward_motion
from bem.adhesive.equilibrium import System
from bem.adhesive.vanishing import TIED
from bem.geometry.arrays import FloatArray
from bem.path.fold import LimitPoint
from bem.path.locating import InPlane, Refused, Start, locate
from bem.path.stand import LONGEST_MOTION, Stand, stand_near, unit_of
from bem.path.steps import SHORTER, Way, shorter_steps


def alone(limit: LimitPoint) -> FloatArray:
    """Return the outward motion of the edges, (2 L,), nearest to one patch that shrinks or slides.

    The patch slides if modes slide patches more than they shrink them.  Among equal patches it is the first.
    """
    unit = limit.modes / np.linalg.norm(limit.modes, axis=0)
    left, right = np.split(unit, 2)
    shrink, slide = -(left + right), right - left
    single = max(shrink, slide, key=np.linalg.norm)
    share = np.linalg.norm(single, axis=1)
    first = int(np.flatnonzero(share >= (1 - TIED) * share.max())[0])
    return np.asarray(unit @ single[first])


def other_branch(system: System, limit: LimitPoint, motion: FloatArray, way: Way) -> Stand | Refused:
    """Return the branch that begins where a symmetry breaks, a little along a motion.

    Its parameter grows from the limit point on.  The point returned is so close to the limit point that no more modes
    are unstable on the branch than were neutral.
    """
    at = limit.at
    unit, refused = unit_of(system, at.balance), Refused.UNCLEAR
    motion = motion / np.max(np.abs(motion / unit))
    for part in shorter_steps(LONGEST_MOTION / SHORTER):
        patches = at.patches.moved(part * motion)
        normal = motion / unit**2
        start = Start(patches, at.numbers.penetration, at.numbers.value)
        located = locate(system, start, InPlane(patches, normal), way.tolerance)
        if isinstance(located, Refused):
            refused = located
            continue
        moved = outward_motion(at.patches, located.patches)
        point = stand_near(system, located.balance, located.numbers.value, normal, float(normal @ moved))
        if point is not None and point.lowest[0].size <= limit.modes.shape[1]:
            return point
    return refused
