"""Events at the end of a branch: new contacts, coalescence, detachment, and the jump to the nearest minimum.

An event is resolved first where it happens and then everywhere: of more than 18 patches, those concerned and four
neighbours each side move at fixed penetration in the frozen field of all others (small trust-region steps, cheap
evaluations); then all edges descend together at fixed target.  A crest that touches ahead of a moving edge is a new
contact at once (touching.py).  Where the equilibrium interpenetrates elsewhere, a new contact begins there, and the
descent goes on (bem/path/jump.py).  The energy that the avalanche releases is the difference of the potential.
Dimensionless.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bem.adhesive.descent import descend
from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.strides import DescentStatus, Steps
from bem.adhesive.touching import CrestsAhead
from bem.adhesive.vanishing import TIED, pull_off_half_width
from bem.elastic.collocation import Evaluation
from bem.elastic.gap import GapMinima, gap_field, low_minima
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches, ordered
from bem.geometry.profile import EQUAL_HEIGHTS
from bem.loading.control import DisplacementControl
from bem.loading.increments import MAXIMUM_ITERATIONS, Accuracy

LARGEST_STEP = 0.4  # step scales: largest trust radius; below 0.7, or the two edges of a gap may cross
LOCAL_RESIDUAL = 1e-2  # speed: residual in the field of frozen patches, and from which on Newton goes on
NEIGHBOURS = 4  # speed: patches on each side that move first; 2: work -1.2 %, 8: same


@dataclass(frozen=True, eq=False)
class Relaxed:
    """Outcome of an event.

    Attributes
    ----------
    status : str
        As of a descent; a crest that touches does not end an event.
    target : float
        The value of the control at which it happened.
    balance : Balance or None
        The new equilibrium, if there are edges in it.
    changes : tuple of (kind, position)
        In the order in which they happened.
    """

    status: DescentStatus
    target: float
    balance: Balance | None
    changes: tuple[tuple[str, float], ...]


def interpenetration(system: System, state: Evaluation, allowed: float) -> GapMinima:
    """Return the minima of the gap below -allowed (dimensionless), each a new contact."""
    low = low_minima(gap_field(system.elastic, state))
    bad = low.depth < -allowed
    return GapMinima(low.position[bad], low.depth[bad], low.gap[bad])


@dataclass(frozen=True, eq=False)
class Cause:
    """Cause of the end of the last equilibrium.

    Attributes
    ----------
    unstable : int array or None
        Patches that are about to jump; they move first.
    found : GapMinima or None
        Minima of the gap at which the equilibrium at the given edges interpenetrates.
    state : Evaluation or None
        The last equilibrium, from which far patches keep their pressure while near ones move first.
    local_tolerance : float
        Tolerance of the evaluations of near patches, if the tolerance of the equilibrium is less.
    """

    unstable: IntArray | None = None
    found: GapMinima | None = None
    state: Evaluation | None = None
    local_tolerance: float = 0.0


NO_CAUSE = Cause()


def fall(
    system: System,
    patches: Patches,
    penetration: float,
    target: float,
    accuracy: Accuracy,
    cause: Cause = NO_CAUSE,
) -> Relaxed:
    """Resolve an event at fixed target: descend from given edges to an equilibrium, which may interpenetrate.

    Parameters
    ----------
    system, patches, penetration, target
        Where the last equilibrium ended; `penetration` is its Delta.
    accuracy : Accuracy
        Of the equilibrium that is sought.
    cause : Cause, optional
    """
    changes: list[tuple[str, float]] = []
    active, state = cause.unstable, cause.state
    if cause.found is not None:
        patches, active, formed = _with_new_contacts(system, patches, cause.found)
        changes += formed
    outside = None if system.elastic.far is None else system.elastic.far.arc.outside
    steps = Steps(LARGEST_STEP, ahead=CrestsAhead(system, accuracy.allowed, outside))
    for _ in range(_most_rounds(system)):
        if active is not None and state is not None and patches.count > 2 * (2 * NEIGHBOURS + 1):
            patches, local = _relaxed_locally(
                system, patches, target, accuracy, replace(cause, unstable=active, state=state)
            )
            changes += local
        end = descend(system, patches, penetration, target, accuracy, steps)
        changes += end.changes
        if end.status == "separated" and target > 0:  # apart, the surfaces would overlap: the highest crests touch
            crests = system.elastic.profile.highest_crests
            patches, active, state = first_contact(system, crests), None, None
            changes += [("new_contact", float(crest)) for crest in crests]
            continue
        if end.touching is None or end.balance is None:
            return Relaxed(end.status, target, end.balance, tuple(changes))
        state, penetration = end.balance.state, end.balance.state.penetration
        patches, active, formed = _with_new_contacts(system, end.patches, end.touching)
        changes += formed
    return Relaxed("not_converged", target, None, tuple(changes))


def _most_rounds(system: System) -> int:
    """Return the limit of rounds of an avalanche: two touches of every crest."""
    return MAXIMUM_ITERATIONS + 2 * int(system.elastic.profile.crests[0].size)


def first_contact(system: System, positions: FloatArray) -> Patches:
    """Return small patches on the crests just touched, wide enough for their edges to be tensile."""
    widest = 0.25 * np.pi
    if positions.size > 1:
        order = np.sort(positions)
        widest = 0.25 * float(np.min(np.diff(order, append=order[0] + TWO_PI)))
    half_width = np.minimum(1.5 * pull_off_half_width(system, positions), widest)
    return ordered(positions - half_width, positions + half_width)


def _with_new_contacts(
    system: System, patches: Patches, minima: GapMinima
) -> tuple[Patches, IntArray, list[tuple[str, float]]]:
    """Add patches at the deepest minima of the gap; return all patches, the new indices, and the changes."""
    tied = np.flatnonzero(minima.depth <= (1 - TIED) * minima.depth.min())
    where = minima.position[tied]
    for position, depth in zip(where, minima.depth[tied], strict=True):
        patches = _with_new_contact(system, patches, float(position), float(depth), where[where != position])
    active = np.array([_nearest(patches, float(position)) for position in where])
    return patches, active, [("new_contact", float(position)) for position in where]


def _with_new_contact(system: System, patches: Patches, position: float, depth: float, others: FloatArray) -> Patches:
    """Add a patch around a point that interpenetrates by -depth, clear of `others`, which interpenetrate too."""
    at = np.array([position])
    curvature = max(float(-system.elastic.profile.curvature(at)[0]), EQUAL_HEIGHTS)
    geometric = np.sqrt(-2 * depth / curvature)
    isolated = 1.5 * float(pull_off_half_width(system, at)[0])
    to_right = np.min((np.append(patches.left, others) - position) % TWO_PI)
    to_left = np.min((position - np.append(patches.right, others)) % TWO_PI)
    half_width = min(max(isolated, float(geometric)), 0.25 * float(to_right), 0.25 * float(to_left))
    return patches.with_patch(position - half_width, position + half_width)


def _nearest(patches: Patches, position: float) -> int:
    """Return the index of the patch whose centre is nearest to a position."""
    return int(np.argmin(np.abs((patches.center - position + np.pi) % TWO_PI - np.pi)))


def _relaxed_locally(
    system: System, patches: Patches, target: float, accuracy: Accuracy, cause: Cause
) -> tuple[Patches, list[tuple[str, float]]]:
    """Descend near the active patches at fixed penetration, in the frozen field of the others, touch by touch.

    Returns
    -------
    patches : Patches
        Joined with the others; those given where the local problem has no answer that fits among them.
    changes : list of (kind, position)
    """
    count, active, state = patches.count, cause.unstable, cause.state
    if active is None or state is None:
        return patches, []
    members = np.unique((active[:, None] + np.arange(-NEIGHBOURS, NEIGHBOURS + 1)) % count)
    if members.size > count // 2:
        return patches, []
    state = system.control.reach(state, target)
    penetration = system.control.guess(state.penetration, target)
    elastic = replace(system.elastic, backgrounds=(_frozen_field(system, patches, members, state, penetration),))
    local = System(elastic, system.law, DisplacementControl())  # its evaluations are booked as local ones
    far = np.setdiff1d(np.arange(count), members)
    inner, outer = (Patches(patches.left[who], patches.right[who]) for who in (members, far))
    accuracy = replace(accuracy, tolerance=max(accuracy.tolerance, cause.local_tolerance), residual=LOCAL_RESIDUAL)
    taken = outer if system.elastic.far is None else outer.joined(system.elastic.far.arc.outside)
    steps = Steps(LARGEST_STEP, outer, CrestsAhead(local, accuracy.allowed, taken))
    changes: list[tuple[str, float]] = []
    for _ in range(_most_rounds(system)):
        end = descend(local, inner, penetration, penetration, accuracy, steps)
        changes += end.changes
        if end.touching is None:
            break
        inner, _, formed = _with_new_contacts(local, end.patches, end.touching)
        changes += formed
    system.effort.local_evaluations += local.effort.evaluations
    if end.status == "separated":
        return outer, changes
    joined = None if end.status == "complete_contact" else outer.joined(end.patches)
    return (patches, []) if joined is None else (joined, changes)


def _frozen_field(
    system: System, patches: Patches, members: IntArray, state: Evaluation, penetration: float
) -> Callable[[FloatArray], FloatArray]:
    """Return the displacement (as a function of x) by all patches of a state but `members`, at a penetration."""
    apart = np.subtract.outer(state.patches.center, patches.center[members])
    frozen = np.all(np.abs((apart + np.pi) % TWO_PI - np.pi) > patches.half_width[members], axis=1)
    keep = np.repeat(frozen, state.resolution.modes)
    charges = state.skeleton + (penetration - state.penetration) * state.skeleton_rate
    return system.elastic.field_of_charges(state.skeleton_nodes()[keep], charges[keep])
