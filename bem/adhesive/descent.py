"""Descent to the minimum of the potential that an overdamped motion of the edges reaches, where a branch has ended.

Small trust-region steps, measured in units of the room of each edge, minimise the potential at a fixed target; on the
way patches may vanish, gaps close and crests touch.  Large steps would end in another basin: barriers between basins
are as narrow as the shortest wavelength, and no edge moves by more than a fifth of it at once.  Dimensionless.
Sources: Conn, Gould, Toint, Trust-Region Methods (2000), section 7.3, for the step; Barquins, J. Adhesion 26 (1988)
1, for the width at which a lone contact pulls off.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve, eigh

from bem.adhesive.equilibrium import Balance, System, balance, energy_noise
from bem.adhesive.touching import CrestsAhead
from bem.elastic.collocation import Resolution, resolve
from bem.elastic.gap import GapMinima
from bem.elastic.hierarchical import IllConditionedSystemError
from bem.geometry.patches import Patches

FloatArray = NDArray[np.float64]

DESCENT_STEPS = 10_000  # evaluations; jumps of three realisations of the paper's profile took up to 47
ENERGY_RATIO = (0.1, 2.5)  # accepted actual over predicted decrease
LARGEST_ROOM = 0.5  # of the shortest wavelength, in which the steps of an edge are measured
LARGEST_EXPANSION = 0.2  # of the shortest wavelength, by which an edge with K < 0 moves at once
DOOMED_GAP = 0.02  # of the shortest wavelength, when also 20 times narrower than the widest gap
NARROW_GAP, CLOSING_STEP = 0.25, 0.4  # of the shortest wavelength; part of its width by which its edges move at once
CLOSED_GAP = 1e-7  # of the period
LAST_GAP = 2e-4  # of the period: the only gap left, when it closes
TIED = 1e-3  # relative difference of gaps that close, or patches that vanish, at the same instant
VANISHED_WIDTH = 0.02  # of the half width at which a lone JKR contact pulls off


@dataclass(frozen=True)
class Change:
    """A patch or gap that vanished in a descent."""

    kind: Literal["coalescence", "detachment", "complete_contact"]
    position: float


@dataclass(frozen=True, eq=False)
class Descent:
    """Outcome of `descend`.

    Attributes
    ----------
    status : str
        `converged`, `separated` (the last patch vanished), `complete_contact` (the last gap closed),
        `touched` (a crest touched ahead of an edge), `not_converged` (also before an edge runs into patches that are
        not its own) or `ill_conditioned`.
    patches : Patches
        Where it ended.
    balance : Balance or None
        Forces there; None without patches or gaps.
    changes : tuple of Change
        Patches and gaps that vanished, in order.
    evaluations : int
        Number of evaluations.
    touching : GapMinima or None
        Crests that touched, dimensionless; their gaps are those of `patches`.
    """

    status: Literal["converged", "separated", "complete_contact", "touched", "not_converged", "ill_conditioned"]
    patches: Patches
    balance: Balance | None
    changes: tuple[Change, ...]
    evaluations: int
    touching: GapMinima | None = None


def trust_region_step(gradient: FloatArray, hessian: FloatArray, radius: float) -> FloatArray:
    """Minimiser of the quadratic model in a ball, (n,): by Cholesky inside, by eigendecomposition on its surface.

    In the hard case (no force along the most negative mode) the step leaves along that mode, in the direction
    in which its largest component is positive.

    Examples
    --------
    >>> trust_region_step(np.array([3.0, 4.0]), np.eye(2), 10.0).round(9).tolist()
    [-3.0, -4.0]
    >>> trust_region_step(np.array([3.0, 4.0]), np.eye(2), 1.0).round(9).tolist()
    [-0.6, -0.8]
    """
    try:
        newton = -cho_solve(cho_factor(hessian, check_finite=False), gradient, check_finite=False)
        if np.linalg.norm(newton) <= radius:
            return np.asarray(newton)
    except LinAlgError:  # not positive definite
        pass
    values, vectors = eigh(hessian)
    force = vectors.T @ gradient
    shift = _shift(values, force, radius)
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.where(values + shift > 0, -force / (values + shift), 0.0)
    missing = radius**2 - float(step @ step)
    if values[0] < 0 and missing > 1e-3 * radius**2:
        leading = vectors[np.argmax(np.abs(vectors[:, 0])), 0]
        step[0] = np.copysign(np.sqrt(step[0] ** 2 + missing), step[0] if step[0] != 0 else leading)
    return np.asarray(vectors @ step)


def _shift(values: FloatArray, force: FloatArray, radius: float) -> float:
    """The shift of the eigenvalues above the most negative one at which the step is as long as the radius.

    The length falls as the shift grows, and its inverse is nearly linear: Newton on that, within bounds that close in.
    Where every step is shorter (the hard case) the bounds close in on the most negative eigenvalue.
    """
    low, resolved = max(0.0, -float(values[0])), 1e-15 * float(np.abs(values).max())
    high = low + float(np.sqrt(force @ force)) / radius
    shift = low + 1e-3 * (high - low)
    while high - low > max(1e-10 * high, resolved):
        apart = values + shift
        step = force / apart
        square = float(step @ step)
        excess = np.sqrt(square) / radius - 1
        if abs(excess) <= 1e-10:
            return shift
        low, high = (shift, high) if excess > 0 else (low, shift)
        newton = shift + excess * square / float(step @ (step / apart))
        shift = newton if low < newton < high else (low + high) / 2
    return high


def descend(
    system: System,
    patches: Patches,
    penetration: float,
    target: float,
    tolerance: float,
    closure: float,
    largest_step: float,
    resolution_floor: Callable[[Patches], Resolution] | None = None,
    contacts: CrestsAhead | None = None,
) -> Descent:
    """Minimise the potential from the given edges, letting patches vanish and gaps close.

    Parameters
    ----------
    system : System
    patches : Patches
        Start.
    penetration, target : float
        Start of the penetration under load control, and value of the control.
    tolerance, closure : float
        Of the evaluation, and of max |G/w - 1|.
    largest_step : float
        Trust radius in units of the room of the edges; small values follow the descent path closely.
    resolution_floor : callable, optional
        Least resolution of given patches, where others than `patches` are near.
    contacts : CrestsAhead, optional
        Finds the crests that touch after a step; the descent ends there, or before edges reach patches that it knows.
        Motions smaller than it minds, just before a patch or a gap vanishes, are not looked ahead of.
    """
    changes: list[Change] = []
    seen = patches
    others = None if contacts is None else contacts.occupied
    radius = largest_step / 2
    evaluations = 0
    here: Balance | None = None
    resolution: Resolution | None = None
    try:
        while evaluations < DESCENT_STEPS:
            if here is None:
                resolution = _at_least(resolve(system.elastic, patches, tolerance), None)
                if resolution_floor is not None:
                    resolution = _at_least(resolution, resolution_floor(patches))
                here = balance(system, patches, penetration, target, tolerance, resolution)
                evaluations += 1
            vanished = _closing(system, here)
            if vanished is None and not here.opening:
                wider = _expanded(system, here)
                if wider is None or (others is not None and wider.joined(others) is None):
                    return Descent("not_converged", patches, here, tuple(changes), evaluations)
                patches, penetration, here = wider, here.state.penetration, None
                continue
            vanished = vanished or _vanishing(system, here)
            if vanished is not None:
                gone, remaining = vanished
                changes += gone
                if remaining is None:
                    status: Literal["separated", "complete_contact"] = (
                        "separated" if gone[0].kind == "detachment" else "complete_contact"
                    )
                    return Descent(status, patches, None, tuple(changes), evaluations)
                patches, penetration, here, seen = remaining, here.state.penetration, None, remaining
                radius = largest_step / 2
                continue
            room = _room(system, here, largest_step)
            hessian = (here.hessian + here.hessian.T) / 2 * np.outer(room, room)
            gradient = here.gradient * room
            step = trust_region_step(gradient, hessian, radius)
            if here.closed(closure) and np.linalg.norm(step) < 0.9 * radius:
                return Descent("converged", patches, here, tuple(changes), evaluations)
            predicted = -float(gradient @ step + 0.5 * step @ hessian @ step)
            trial = patches.moved(step * room)
            if others is not None and trial.joined(others) is None:
                return Descent("not_converged", patches, here, tuple(changes), evaluations)
            wanted = _at_least(resolve(system.elastic, trial, tolerance), resolution)
            if resolution is not None and not _equal(wanted, resolution):
                resolution = wanted
                here = balance(system, patches, penetration, target, tolerance, resolution)
                evaluations += 1
                continue
            ahead = balance(system, trial, here.state.penetration, target, tolerance, resolution)
            evaluations += 1
            noise = 1e-13 * (abs(here.potential) + abs(ahead.potential))
            noise += energy_noise(system, here, ahead, tolerance)
            actual = here.potential - ahead.potential
            if predicted < 100 * noise:  # energies cancel: the work of the forces along the step instead
                actual = -0.5 * float((here.gradient + ahead.gradient) @ (step * room))
            ratio = actual / predicted if predicted > 0 else -1.0
            good = ENERGY_RATIO[0] < ratio < ENERGY_RATIO[1]
            closing = ahead.state.stress_intensity <= 0
            if good and np.all(step[closing] > 0):
                touching, seen = (None, seen) if contacts is None else contacts(seen, ahead)
                patches, here, penetration = trial, ahead, ahead.state.penetration
                if touching is not None:
                    return Descent("touched", patches, here, tuple(changes), evaluations, touching)
                if 0.5 < ratio < 1.5:
                    radius = min(2 * radius, largest_step)
            else:
                radius = min(radius, float(np.linalg.norm(step))) / 3
                if radius < 1e-12:
                    break
    except IllConditionedSystemError:
        return Descent("ill_conditioned", patches, here, tuple(changes), evaluations)
    return Descent("not_converged", patches, here, tuple(changes), evaluations)


def _at_least(resolution: Resolution, floor: Resolution | None) -> Resolution:
    if floor is None:
        return resolution
    return Resolution(np.maximum(resolution.nodes, floor.nodes), np.maximum(resolution.modes, floor.modes))


def _equal(first: Resolution, second: Resolution) -> bool:
    return bool(np.all(first.nodes == second.nodes) and np.all(first.modes == second.modes))


def _room(system: System, here: Balance, largest_step: float) -> FloatArray:
    """Length in which each edge may move, (2 L,); more of it is used where a narrow gap closes, whatever happens."""
    patches, wavelength = here.state.patches, 2 * np.pi / system.elastic.profile.max_order
    room = np.minimum(patches.edge_room, LARGEST_ROOM * wavelength)
    narrow = (patches.gap_after < NARROW_GAP * wavelength) & _pulled_shut(here)
    if narrow.any():
        share = np.where(narrow, max(CLOSING_STEP / largest_step, 1.0), 1.0)
        room = room * np.concatenate([np.roll(share, 1), share])
    return room


def _pulled_shut(here: Balance) -> NDArray[np.bool_]:
    """Gaps behind the patches at whose ends adhesion wins over the stiffness, (L,)."""
    count = here.state.patches.count
    outward = (here.gradient <= 0) | (here.state.stress_intensity <= 0)
    return np.asarray(outward[count:] & np.roll(outward[:count], -1))


def _expanded(system: System, here: Balance) -> Patches | None:
    """Edges with K < 0 moved outward by Newton towards 0.3 of the critical K; None when no room is left."""
    state = here.state
    room = np.minimum(state.patches.edge_room, LARGEST_EXPANSION / 0.3 * 2 * np.pi / system.elastic.profile.max_order)
    short = state.stress_intensity < 0.3 * 2 * np.sqrt(here.work)
    slope = np.diagonal(here.jacobian)
    wanted = (0.6 * np.sqrt(here.work) - state.stress_intensity) / np.where(slope > 0, slope, np.inf)
    step = np.where(short, np.clip(wanted, 0.02 * room, 0.3 * room), 0.0)
    moved = state.patches.moved(step)
    return moved if moved.is_ordered else None


def _closing(system: System, here: Balance) -> tuple[tuple[Change, ...], Patches | None] | None:
    """The gaps about to close, with the patches that remain (None: none do, contact is complete).

    A gap narrower than the limits closes where both its edges move outward; gaps as narrow as that to within
    `TIED` close with it, so that symmetric states stay symmetric.  At fixed penetration the mean gap is fixed too,
    and the last gap stays.
    """
    patches = here.state.patches
    count = patches.count
    gaps = patches.gap_after
    wavelength = 2 * np.pi / system.elastic.profile.max_order
    doomed = gaps < min(DOOMED_GAP * wavelength, max(0.05 * float(gaps.max()), LAST_GAP * 2 * np.pi))
    closing = np.flatnonzero((doomed & _pulled_shut(here)) | (gaps < CLOSED_GAP * 2 * np.pi))
    if closing.size == 0:
        return None
    closing = closing[gaps[closing] <= (1 + TIED) * gaps[closing].min()]
    positions = patches.right[closing] + gaps[closing] / 2
    if closing.size == count:
        if system.control.load_weight == 0:
            return None
        return tuple(Change("complete_contact", float(x)) for x in positions), None
    remaining = patches
    for x in positions:
        distance = np.abs((remaining.right + remaining.gap_after / 2 - x + np.pi) % (2 * np.pi) - np.pi)
        remaining = remaining.merged_after(int(np.argmin(distance)))
    return tuple(Change("coalescence", float(x)) for x in positions), remaining


def _vanishing(system: System, here: Balance) -> tuple[tuple[Change, ...], Patches | None] | None:
    """The patches about to vanish, with those that remain (None: none do, the surfaces are apart)."""
    patches = here.state.patches
    count = patches.count
    inward = here.gradient > 0
    shrinking = np.flatnonzero(inward[:count] & inward[count:])
    if shrinking.size == 0:
        return None
    relative = patches.half_width[shrinking] / pull_off_half_width(system, patches.center[shrinking])
    if relative.min() >= VANISHED_WIDTH:
        return None
    gone = shrinking[relative <= (1 + TIED) * relative.min()]
    changes = tuple(Change("detachment", float(x)) for x in patches.center[gone])
    if gone.size == count:
        return changes, None
    return changes, Patches(np.delete(patches.left, gone), np.delete(patches.right, gone))


def pull_off_half_width(system: System, x: FloatArray) -> FloatArray:
    """Half width (2 w R^2 / (pi E*))^(1/3) of a lone JKR line contact at pull-off, per position, dimensionless.

    R is the radius of curvature there, at most that of the rms curvature of the profile.  A crest is no parabola beyond
    a fraction of the shortest wave, which bounds the width where adhesion is strong.
    Source: Barquins, J. Adhesion 26 (1988) 1.
    """
    profile = system.elastic.profile
    rms_curvature = float(np.sqrt(np.sum((profile.orders**2 * profile.amplitudes) ** 2) / 2))
    curvature = np.maximum(-profile.curvature(x), rms_curvature)
    half_width = np.cbrt(system.law.work_of_adhesion(x) / (np.pi * curvature**2))
    return np.asarray(np.minimum(half_width, 1 / profile.max_order))
