"""Adhesive equilibrium of the edges at given control: Newton where a branch is followed, descent where it ends.

An equilibrium has G_e = K_e^2/4 = w_e at every edge with K_e > 0, and is stable where the Hessian of the potential
under control is positive definite.  `correct` is plain Newton, which stays on the branch it starts from or says
why it cannot.  `descend` minimises the potential in small trust-region steps measured in units of the room of
each edge, so that it ends in the minimum that an overdamped motion of the edges reaches; on the way patches may
vanish and gaps may close.  Dimensionless.  Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65,
section 3, for the functional; Conn, Gould, Toint, Trust-Region Methods (2000), section 7.3, for the step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, eigh

from bem.collocation import Elastic, Evaluation, IllConditionedSystemError, Resolution, evaluate, resolve
from bem.control import Control
from bem.patches import Patches
from bem.sensitivities import stress_intensity_jacobian

FloatArray = NDArray[np.float64]

NEWTON_STEPS = 8
LARGEST_NEWTON_STEP = 0.3  # of the room of an edge
DESCENT_STEPS = 600
ENERGY_RATIO = (0.1, 2.5)  # accepted actual over predicted decrease
ENERGY_TRUNCATION = 3e-3  # relative error of the energy over the square of the tolerance of the evaluation
DOOMED_GAP = 0.02  # of the shortest wavelength, when also 20 times narrower than the widest gap
CLOSED_GAP = 1e-7  # of the period
LAST_GAP = 2e-4  # of the period: the only gap left, when it closes
TIED = 1e-3  # relative difference of gaps that close, or patches that vanish, at the same instant
VANISHED_WIDTH = 0.02  # of the half width at which a lone JKR contact pulls off


class InterfaceLaw(Protocol):
    """Work of adhesion along the interface, dimensionless (adhesion.py)."""

    def work_of_adhesion(self, x: FloatArray) -> FloatArray:
        """w at the positions x, same shape."""
        ...

    def work_gradient(self, x: FloatArray) -> FloatArray:
        """dw/dx at the positions x, same shape."""
        ...

    def energy(self, patches: Patches) -> float:
        """-int w dx over the patches."""
        ...


@dataclass(frozen=True, eq=False)
class System:
    """What an equilibrium depends on besides edges and target."""

    elastic: Elastic
    law: InterfaceLaw
    control: Control


@dataclass(frozen=True, eq=False)
class Balance:
    """Forces on the edges of a state, dimensionless.

    Attributes
    ----------
    state : Evaluation
        At the target.
    work : (2 L,) array
        w at the edges.
    gradient : (2 L,) array
        dU / d(outward motion) = G - w.
    hessian : (2 L, 2 L) array
        Of the potential under control.
    fixed_penetration_hessian : (2 L, 2 L) array
        Of U.
    load_gradient : (2 L,) array
        d(load) / d(outward motion).
    potential : float
        What the equilibrium minimises.
    energy : float
        U = U_el + U_ad.
    rounding : (2 L,) array
        Accuracy of K in double precision.
    """

    state: Evaluation
    work: FloatArray
    gradient: FloatArray
    hessian: FloatArray
    fixed_penetration_hessian: FloatArray
    load_gradient: FloatArray
    potential: float
    energy: float
    rounding: FloatArray

    @property
    def closure(self) -> float:
        """max |G/w - 1| over the edges."""
        return float(np.max(np.abs(self.gradient / self.work)))

    def closed(self, limit: float) -> bool:
        """Whether |G/w - 1| is at most the limit at every edge, or what rounding of K leaves where w is tiny."""
        rounding = self.rounding / np.sqrt(self.work)
        return bool(np.all(np.abs(self.gradient / self.work) <= np.maximum(limit, rounding)))

    @property
    def opening(self) -> bool:
        """Whether K > 0 at every edge."""
        return bool(np.all(self.state.stress_intensity > 0))

    @property
    def stable_at_fixed_load(self) -> bool:
        """Whether the Hessian bordered with Delta, of U - load Delta, is positive definite."""
        soft = self.fixed_penetration_hessian - np.outer(self.load_gradient, self.load_gradient) / self.state.load_rate
        return bool(eigh(self._scaled(soft), eigvals_only=True, subset_by_index=[0, 0])[0] > 0)

    @property
    def stiffness(self) -> float:
        """d(load)/dDelta along the branch, the edges following."""
        response = np.linalg.solve(self.fixed_penetration_hessian, self.load_gradient)
        return float(self.state.load_rate - self.load_gradient @ response)

    @property
    def smallest_eigenvalue(self) -> float:
        """Smallest eigenvalue of the Hessian scaled by work of adhesion and room of the edges."""
        return float(eigh(self._scaled(self.hessian), eigvals_only=True, subset_by_index=[0, 0])[0])

    @property
    def hessian_asymmetry(self) -> float:
        """max |H - H^T| / max |H|."""
        matrix = self.fixed_penetration_hessian
        return float(np.abs(matrix - matrix.T).max() / np.abs(matrix).max())

    def _scaled(self, hessian: FloatArray) -> FloatArray:
        scale = np.sqrt(self.state.patches.edge_room / self.work)
        return np.asarray((hessian + hessian.T) / 2 * np.outer(scale, scale))


def edge_positions(patches: Patches) -> FloatArray:
    """All left edges, then all right ones, (2 L,)."""
    return np.concatenate([patches.left, patches.right])


def balance(
    system: System,
    patches: Patches,
    penetration: float,
    target: float,
    tolerance: float,
    resolution: Resolution | None = None,
) -> Balance:
    """Evaluate the forces on the edges at the target; `penetration` is where load control starts from."""
    state = evaluate(system.elastic, patches, system.control.guess(penetration, target), tolerance, resolution)
    state = system.control.reach(state, target)
    edges, intensity = edge_positions(patches), state.stress_intensity
    work = system.law.work_of_adhesion(edges)
    jacobian = stress_intensity_jacobian(state)
    hessian = (intensity / 2)[:, None] * jacobian
    outward = np.repeat([-1.0, 1.0], patches.count)
    diagonal = np.arange(edges.size)
    hessian[diagonal, diagonal] -= outward * system.law.work_gradient(edges)
    load_gradient = intensity * state.stress_intensity_rate / 2
    energy = state.elastic_energy + system.law.energy(patches)
    return Balance(
        state=state,
        work=work,
        gradient=intensity**2 / 4 - work,
        hessian=system.control.stiffen(hessian, load_gradient, state),
        fixed_penetration_hessian=hessian,
        load_gradient=load_gradient,
        potential=system.control.potential(state, energy, target),
        energy=energy,
        rounding=state.rounding(system.control.penetration_rate(state)),
    )


NewtonStatus = Literal["converged", "indefinite", "long_step", "stalled", "ill_conditioned"]


@dataclass(frozen=True, eq=False)
class Corrected:
    """Outcome of `correct`: the balance when converged, else the reason why not."""

    status: NewtonStatus
    balance: Balance | None
    evaluations: int


def correct(
    system: System, patches: Patches, penetration: float, target: float, tolerance: float, closure: float
) -> Corrected:
    """Newton iteration on K = 2 sqrt(w) from edges close to an equilibrium.

    K is closer to a linear function of the edges than G = K^2/4, above all where w is small and K changes sign on
    the way.  Steps must shrink by half each time and stay below 0.3 of the room of an edge, and the end must have
    K > 0 and a positive definite Hessian; anything else ends the iteration with its reason.
    """
    last = np.inf
    start = patches
    for count in range(1, NEWTON_STEPS + 1):
        try:
            here = balance(system, patches, penetration, target, tolerance)
        except IllConditionedSystemError:
            return Corrected("ill_conditioned", None, count)
        room = patches.edge_room
        if here.opening and here.closed(closure):
            try:
                cho_factor((here.hessian + here.hessian.T) / 2 * np.outer(room, room), check_finite=False)
            except LinAlgError:
                return Corrected("indefinite", None, count)
            return Corrected("converged", here, count)
        step = _newton_step(system, here)
        size = float(np.abs(step).max())
        if not size <= LARGEST_NEWTON_STEP:
            return Corrected("long_step", None, count)
        if size > last / 2 and here.closure > 100 * closure:
            return Corrected("stalled", None, count)
        last = size
        penetration = here.state.penetration
        patches = patches.moved(step * room)
        travelled = np.abs(edge_positions(patches) - edge_positions(start)) / start.edge_room
        if not patches.is_ordered or travelled.max() > LARGEST_NEWTON_STEP:
            return Corrected("long_step", None, count)
    return Corrected("stalled", None, NEWTON_STEPS)


def _newton_step(system: System, here: Balance) -> FloatArray:
    """Newton step on K = 2 sqrt(w) in units of the room of each edge, (2 L,); infinite where there is none."""
    state, control = here.state, system.control
    edges = edge_positions(state.patches)
    outward = np.repeat([-1.0, 1.0], state.patches.count)
    jacobian = stress_intensity_jacobian(state)
    if control.load_weight > 0:
        jacobian -= (
            control.load_weight * control.rate(state) * np.outer(state.stress_intensity_rate, here.load_gradient)
        )
    diagonal = np.arange(edges.size)
    jacobian[diagonal, diagonal] -= outward * system.law.work_gradient(edges) / np.sqrt(here.work)
    try:
        missing = 2 * np.sqrt(here.work) - state.stress_intensity
        return np.asarray(np.linalg.solve(jacobian * state.patches.edge_room, missing))
    except np.linalg.LinAlgError:
        return np.full(edges.size, np.inf)


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
        `not_converged` or `ill_conditioned`.
    patches : Patches
        Where it ended.
    balance : Balance or None
        Forces there; None without patches or gaps.
    changes : tuple of Change
        Patches and gaps that vanished, in order.
    evaluations : int
        Number of evaluations.
    """

    status: Literal["converged", "separated", "complete_contact", "not_converged", "ill_conditioned"]
    patches: Patches
    balance: Balance | None
    changes: tuple[Change, ...]
    evaluations: int


def trust_region_step(gradient: FloatArray, hessian: FloatArray, radius: float) -> FloatArray:
    """Minimiser of the quadratic model in the ball of this radius, by eigendecomposition, (n,).

    In the hard case (no force along the most negative mode) the step leaves along that mode, in the direction
    in which its largest component is positive.

    Examples
    --------
    >>> trust_region_step(np.array([1.0, 0.0]), np.eye(2), 10.0).tolist()
    [-1.0, 0.0]
    """
    values, vectors = eigh(hessian)
    force = vectors.T @ gradient
    if values[0] > 0:
        newton = -force / values
        if np.linalg.norm(newton) <= radius:
            return np.asarray(vectors @ newton)
    low = max(0.0, -values[0])
    high = low + np.linalg.norm(gradient) / radius + 1e-300
    for _ in range(100):
        shift = (low + high) / 2
        length = np.linalg.norm(force / (values + shift)) if shift > -values[0] else np.inf
        low, high = (shift, high) if length > radius else (low, shift)
        if high - low <= 1e-10 * high:
            break
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.where(values + high > 0, -force / (values + high), 0.0)
    missing = radius**2 - float(step @ step)
    if values[0] < 0 and missing > 1e-3 * radius**2:
        leading = vectors[np.argmax(np.abs(vectors[:, 0])), 0]
        step[0] = np.copysign(np.sqrt(step[0] ** 2 + missing), step[0] if step[0] != 0 else leading)
    return np.asarray(vectors @ step)


def descend(
    system: System,
    patches: Patches,
    penetration: float,
    target: float,
    tolerance: float,
    closure: float,
    largest_step: float,
    resolution_floor: Callable[[Patches], Resolution] | None = None,
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
    """
    changes: list[Change] = []
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
                wider = _expanded(here)
                if wider is None:
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
                patches, penetration, here = remaining, here.state.penetration, None
                radius = largest_step / 2
                continue
            room = patches.edge_room
            hessian = (here.hessian + here.hessian.T) / 2 * np.outer(room, room)
            gradient = here.gradient * room
            step = trust_region_step(gradient, hessian, radius)
            if here.closed(closure) and np.linalg.norm(step) < 0.9 * radius:
                return Descent("converged", patches, here, tuple(changes), evaluations)
            predicted = -float(gradient @ step + 0.5 * step @ hessian @ step)
            trial = patches.moved(step * room)
            wanted = _at_least(resolve(system.elastic, trial, tolerance), resolution)
            if resolution is not None and not _equal(wanted, resolution):
                resolution = wanted
                here = balance(system, patches, penetration, target, tolerance, resolution)
                evaluations += 1
                continue
            ahead = balance(system, trial, here.state.penetration, target, tolerance, resolution)
            evaluations += 1
            noise = 1e-13 * (abs(here.potential) + abs(ahead.potential))
            noise += ENERGY_TRUNCATION * tolerance**2 * (here.state.elastic_energy + ahead.state.elastic_energy)
            actual = here.potential - ahead.potential
            if predicted < 100 * noise:  # energies cancel: the work of the forces along the step instead
                actual = -0.5 * float((here.gradient + ahead.gradient) @ (step * room))
            ratio = actual / predicted if predicted > 0 else -1.0
            good = ENERGY_RATIO[0] < ratio < ENERGY_RATIO[1]
            closing = ahead.state.stress_intensity <= 0
            if good and np.all(step[closing] > 0):
                patches, here, penetration = trial, ahead, ahead.state.penetration
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


def _expanded(here: Balance) -> Patches | None:
    """Edges with K < 0 moved outward by Newton towards 0.3 of the critical K; None when no room is left."""
    state = here.state
    room = state.patches.edge_room
    short = state.stress_intensity < 0.3 * 2 * np.sqrt(here.work)
    slope = np.diagonal(stress_intensity_jacobian(state))
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
    outward = (here.gradient <= 0) | (here.state.stress_intensity <= 0)
    gaps = patches.gap_after
    wavelength = 2 * np.pi / system.elastic.profile.max_order
    doomed = gaps < min(DOOMED_GAP * wavelength, max(0.05 * float(gaps.max()), LAST_GAP * 2 * np.pi))
    both = outward[count:] & np.roll(outward[:count], -1)
    closing = np.flatnonzero((doomed & both) | (gaps < CLOSED_GAP * 2 * np.pi))
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

    R is the radius of curvature there, at most that of the rms curvature of the profile.
    Source: Barquins, J. Adhesion 26 (1988) 1.
    """
    profile = system.elastic.profile
    rms_curvature = float(np.sqrt(np.sum((profile.orders**2 * profile.amplitudes) ** 2) / 2))
    curvature = np.maximum(-profile.curvature(x), rms_curvature)
    return np.asarray(np.cbrt(system.law.work_of_adhesion(x) / (np.pi * curvature**2)))
