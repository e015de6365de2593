"""One leap: the equilibrium at another value of the control, by Newton, else by one descent there.

From predicted edges Newton leads to the equilibrium of the same patches.  Where there is none, where an edge passed a
crest, or where a gap closes, events lie in between: they are resolved all at once at the end of the leap, by a descent
that begins at those patches that Newton lost (relaxation.py).  Nothing in between is located.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import lapack

from bem.adhesive.branch import moving_patches, outward_motion, unstable_patches
from bem.adhesive.equilibrium import Balance, System, balance, edge_positions
from bem.adhesive.relaxation import Cause, Relaxed, interpenetration, relax
from bem.continuation.curve import imbalance_by_edges
from bem.continuation.locating import Start
from bem.elastic.gap import GapMinima
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches
from bem.geometry.profile import Profile
from bem.loading.increments import Accuracy

STEPS = 8  # limit: of Newton
LONGEST_STEP = 0.3  # edge scales: a step behind which Newton has lost an edge, and what edges may move in all
SHRINKING, SHORT_STEP = 0.5, 0.01  # a step over the one before it, unless it is as short as this, in edge scales
LOCAL_STEP = 0.4  # speed: largest step of a local descent: twice as long as where the path is exact
NONE = np.zeros(0, dtype=np.int64)
PREDICTED = 0.15  # edge scales that edges are moved at most before Newton begins


@dataclass(frozen=True, eq=False)
class Newton:
    """Where Newton led: forces in equilibrium, and the patches that it lost; and the gaps that have closed there."""

    balance: Balance | None
    lost: IntArray
    closed: GapMinima | None = None

    @property
    def is_quiet(self) -> bool:
        """Whether it led to an equilibrium, and nothing happened on the way."""
        return self.balance is not None and self.closed is None and not self.lost.size


@dataclass(frozen=True, eq=False)
class Leapt:
    """Where a leap ended, and the forces before it where events lie between; a snap alone is a bifurcation."""

    relaxed: Relaxed
    before: Balance | None = None


def leap(
    system: System, start: Start, outward: FloatArray, value: float, accuracy: Accuracy, before: Balance | None = None
) -> Leapt:
    """The equilibrium to which a state leads when the control goes to a value at once.

    Parameters
    ----------
    system : System
    start : Start
        Edges of a stable equilibrium.
    outward : (2 L,) array
        Their predicted motion.
    value : float
        Of the control.
    accuracy : Accuracy
        Of the equilibrium that is sought.
    before : Balance, optional
        Forces at the start, if they are known.
    """
    found = tried(system, start, outward, value, accuracy)
    if found.is_quiet:
        return Leapt(Relaxed("converged", value, found.balance, ()))
    patches, cause, lost = start.patches, Cause(), found.lost
    if found.balance is not None and found.closed is not None:
        patches, cause = found.balance.state.patches, Cause(None, found.closed, found.balance.state, LOCAL_STEP)
    if before is None:
        before = balance(system, start.patches, start.penetration, start.value, accuracy.tolerance)
    if lost.size:
        cause = Cause(lost, None, before.state, LOCAL_STEP)
    relaxed = relax(system, patches, start.penetration, value, accuracy, cause)
    if not relaxed.changes and lost.size:
        relaxed = replace(relaxed, changes=(("bifurcation", float(start.patches.center[lost[0]])),))
    return Leapt(relaxed, before)


def quiet_leap(system: System, start: Start, outward: FloatArray, value: float, accuracy: Accuracy) -> Leapt | None:
    """The same where nothing happens on the way; None where something does."""
    found = tried(system, start, outward, value, accuracy)
    return Leapt(Relaxed("converged", value, found.balance, ())) if found.is_quiet else None


def tried(system: System, start: Start, outward: FloatArray, value: float, accuracy: Accuracy) -> Newton:
    """Where Newton leads from predicted edges, and what happened on the way."""
    patches, most = start.patches, PREDICTED * start.patches.edge_scale
    found = newton(system, patches.moved(np.clip(outward, -most, most)), start.penetration, value, accuracy)
    if found.balance is None:
        return found
    there = found.balance.state
    closed = interpenetration(system, there, accuracy.allowed)
    if closed.position.size:
        return Newton(found.balance, NONE, closed)
    return Newton(found.balance, passing_patches(system.elastic.profile, patches, there.patches))


def newton(system: System, patches: Patches, penetration: float, value: float, accuracy: Accuracy) -> Newton:
    """Newton's iteration on K = 2 sqrt(w) from edges close to a stable equilibrium.

    Steps shrink and stay within the edge scales; K > 0 and a positive definite Hessian hold at the end.  Where not,
    those patches are lost that move most in the step, or in the softest mode.
    """
    first, last, kept = patches, np.inf, None
    for _ in range(STEPS):
        here = if_solvable(balance, system, patches, penetration, value, accuracy.tolerance, kept)
        if here is None:
            break
        if here.all_tensile and here.factor is None:
            return Newton(None, unstable_patches(here))
        if here.all_tensile and here.is_equilibrium(accuracy.residual):
            return Newton(here, NONE)
        step = newton_step(system, here)
        if step is None:
            break
        moved, size = patches.moved(step), float(np.max(np.abs(step) / patches.edge_scale))
        travelled = float(np.max(np.abs(outward_motion(first, moved)) / first.edge_scale))
        shrinks = size <= max(SHRINKING * last, SHORT_STEP)
        if not (max(size, travelled) <= LONGEST_STEP and shrinks and moved.is_ordered):
            return Newton(None, moving_patches(patches, step))
        last, kept = size, here.state.resolution if size < SHORT_STEP else None
        patches, penetration = moved, here.state.penetration
    return Newton(None, np.arange(patches.count))


def newton_step(system: System, here: Balance) -> FloatArray | None:
    """Outward motion of the edges towards K = 2 sqrt(w), (2 L,); None where there is none."""
    missing = 2 * np.sqrt(here.work) - here.state.stress_intensity
    unit = here.state.patches.edge_scale
    _, _, step, info = lapack.dgesv(imbalance_by_edges(system, here, unit), missing, overwrite_a=1)
    return None if info else np.asarray(step * unit)


def passing_patches(profile: Profile, first: Patches, last: Patches) -> IntArray:
    """Patches an edge of which moved out over a valley and the crest behind it, which touches by itself."""
    motion = outward_motion(first, last)
    moved = np.flatnonzero(motion > TWO_PI / (4 * profile.max_order))
    if not moved.size:
        return moved
    left = moved < first.count
    where, size = edge_positions(first)[moved], motion[moved]
    start = np.where(left, -where, where) % TWO_PI  # leftward motion is looked at in the mirror
    passed = np.zeros(moved.size, dtype=bool)
    for side, sign in ((left, -1.0), (~left, 1.0)):
        valleys, crests = (_two_turns(sign * places) for places in (profile.valleys[0], profile.crests[0]))
        valley = valleys[np.searchsorted(valleys, start[side])]
        passed[side] = crests[np.searchsorted(crests, valley) % crests.size] < start[side] + size[side]
    return np.unique(moved[passed] % first.count)


def _two_turns(places: FloatArray) -> FloatArray:
    """Places on the circle on two turns of it, ascending."""
    once = np.sort(places % TWO_PI)
    return np.concatenate([once, once + TWO_PI])
