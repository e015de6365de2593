"""Equilibria that meet a condition, found by Newton on the bordered system (stand.py), and their errors.

Iterates are evaluated at a tolerance until a step is short.  The last evaluation has more nodes and modes than that
tolerance asks for; its change of the numbers, as the last Newton steps leave them, is the error.  Newton has diverged
if a step is no shorter than the step before.  Where modes V are held (a symmetry that is to be kept), the
forces lambda that hold them are further unknowns, and V . d xi = 0.

A condition gives phi and its derivatives in a state.  Conditions are a value of the control, a load, a plane through
edges, the neutral mode of a fold or of a bifurcation (fold.py), and a gap that closes (touch.py).  Dimensionless.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.linalg import lapack

from bem.adhesive.branch import after_step, outward_motion
from bem.adhesive.equilibrium import Balance, System, balance, energy_noise
from bem.elastic.collocation import Resolution, finer, resolve
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import Patches
from bem.loading.increments import FINE, MAXIMUM_ITERATIONS, Accuracy
from bem.loading.path_events import EventNumbers
from bem.path.stand import LONGEST_MOTION, SHORT, Row, bordered, missing, unit_of

LAST = 1e-5  # units: the last step, behind which LAST^2 = 1e-10 is missing
LOCATED = 1e-9  # largest remainder of zero: rms heights, works of adhesion, eigenvalues
OFF = 0.3  # of the tolerance: error of K, of a gap and of the load by an evaluation; measured .03, .2 on thin layers
FINER_MODES = 1e-2  # of the tolerance, for which a finer evaluation has the modes


class Refused(Enum):
    """Reasons why no state was found, or a step was not taken."""

    OVERLAP = "edges overlap"
    COMPRESSED = "K is not positive at an edge"
    UNRESOLVED = "the gaps are too narrow to resolve"
    SINGULAR = "the bordered system is singular"
    DIVERGED = "Newton's steps do not shrink"
    FAR = "what was found is not on this span of the curve"
    MISFIT = "the two ends of the step do not agree"
    UNCLEAR = "a shorter step must tell what happens in this one"


class Condition(ABC):
    """Condition that closes the equations of equilibrium: phi(xi, tau) = 0, in a settled state within an accuracy."""

    accuracy: float = np.inf
    off: float = OFF

    def asked(self, system: System) -> System:
        """Return the system whose evaluations hold the quantities that the condition needs."""
        return system

    @abstractmethod
    def row(self, balance: Balance, value: float) -> Row:
        """Return phi and its derivatives."""


@dataclass(frozen=True)
class AtControl(Condition):
    """Condition that the control has a value."""

    goal: float

    def row(self, balance: Balance, value: float) -> Row:
        """Return tau - goal and its derivatives."""
        return Row(value - self.goal, np.zeros(balance.work.size), 1.0)


@dataclass(frozen=True)
class AtLoad(Condition):
    """Condition that the load has a value, within an accuracy."""

    system: System
    load: float
    accuracy: float

    def row(self, balance: Balance, value: float) -> Row:
        """Return P - load and its derivatives: edges change P by k at fixed penetration, and by the control."""
        control, state = self.system.control, balance.state
        share = control.load_weight * control.rate(state) * state.load_rate
        return Row(state.load - self.load, balance.load_gradient * (1 - share), state.load_rate * control.rate(state))


@dataclass(frozen=True, eq=False)
class InPlane(Condition):
    """Condition that edges lie in a plane: normal . (xi - xi of the edges given) = 0."""

    patches: Patches
    normal: FloatArray

    def row(self, balance: Balance, value: float) -> Row:
        """Return the distance of the edges beyond the plane, along its normal, and its derivatives."""
        return Row(float(self.normal @ outward_motion(self.patches, balance.state.patches)), self.normal, 0.0)


@dataclass(frozen=True, eq=False)
class Start:
    """Start of Newton's method: edges, the penetration from which a load is reached, and a value of the control."""

    patches: Patches
    penetration: float
    value: float


@dataclass(frozen=True, eq=False)
class Located:
    """Equilibrium in which a condition is met.

    Attributes
    ----------
    balance : Balance
        Forces one Newton step away.
    numbers, error : EventNumbers
        Numbers of the equilibrium, and their changes by the last evaluation.
    step : (2 L,) array
        Newton step to the equilibrium, outward motion of the edges.
    """

    balance: Balance
    numbers: EventNumbers
    error: EventNumbers
    step: FloatArray

    @property
    def patches(self) -> Patches:
        """Edges to which Newton's last step leads."""
        return self.balance.state.patches.moved(self.step)


def locate(
    system: System,
    start: Start,
    on: Condition,
    tolerance: float,
    held: FloatArray | None = None,
    known: Balance | None = None,
) -> Located | Refused:
    """Return the equilibrium next to edges that meets a condition, with its error.

    Parameters
    ----------
    system : System
    start : Start
    on : Condition
    tolerance : float
        Tolerance of the evaluations.
    held : (2 L, k) array, optional
        Outward motions that do not take part, held by forces along them.
    known : Balance, optional
        Forces at the start, evaluated at `tolerance`.
    """
    before: EventNumbers | None = None
    place, last = start, np.inf
    short = max(np.sqrt(tolerance), LAST)  # its square, which is missing, is no more than an evaluation is off
    if held is not None:  # the control hardly acts on the eigenvalue
        short = LAST
    for _ in range(MAXIMUM_ITERATIONS):
        asked = on.asked(system.sloped)
        if before is None:
            balance = known or evaluated(asked, place, tolerance)
        else:
            balance = evaluated_finely(asked, place, tolerance)
        known = None
        if isinstance(balance, Refused):
            return balance
        step = newton_step(system, balance, on.row(balance, place.value), held)
        if isinstance(step, Refused):
            return step
        if step.size >= last:
            return Refused.DIVERGED
        if tolerance > FINE.tolerance and step.size <= short:
            return _unverified(system, balance, place.value, on, step, tolerance)
        numbers, last = after_step(system, balance, place.value, step.motion, step.change), step.size
        if before is not None and step.size <= LAST:
            return Located(balance, numbers, numbers.apart(before, system.control.force(balance.state)), step.motion)
        if before is None and step.size <= short:
            before, last = numbers, np.inf
        place = step.end(balance, place.value)
    return Refused.DIVERGED


def _unverified(
    system: System, balance: Balance, value: float, on: Condition, step: NewtonStep, tolerance: float
) -> Located:
    """Return the equilibrium located by coarse evaluations, with errors from the errors of K and of the condition.

    An error e of the right side of the bordered system A moves a number q with the derivatives c by c . A^-1 e, at most
    by the sum of the sizes; the error of q by the evaluation itself is added.
    """
    state, control, n = balance.state, system.control, balance.work.size
    error = np.append(OFF * tolerance / np.sqrt(balance.work), on.off * tolerance) + step.size**2
    error[n] /= step.scale
    load = AtLoad(system, 0.0, 0.0).row(balance, value)
    numbers = np.zeros((step.pivots.size, 3))
    numbers[n] = 1.0, load.by_control, control.rate(state)
    numbers[:n, 1], numbers[:n, 2] = load.by_edges, -control.load_weight * control.rate(state) * balance.load_gradient
    numbers[:n] *= unit_of(system, balance)[:, None]
    response = lapack.dgetrs(step.factors, step.pivots, numbers, trans=1)[0][: n + 1]
    by_value, by_load, by_depth = np.abs(response).T @ error
    at, own = after_step(system, balance, value, step.motion, step.change), OFF * tolerance
    errors = EventNumbers(
        float(by_value) + own * abs(at.value),
        float(by_depth) + own * abs(at.penetration),
        float(by_load) + own * abs(at.load),
        energy_noise(system, balance, balance, tolerance),
    )
    return Located(balance, at, errors, step.motion)


def settle(system: System, start: Start, on: Condition, accuracy: Accuracy) -> tuple[Balance, float] | Refused:
    """Return the state next to edges that meets a condition, evaluated in itself, and its value of the control.

    The state is no farther than LONGEST_MOTION away, and at the end of a Newton step.  Forces left at its
    edges are below the residual, or rounding that no step makes smaller.
    Short steps keep the resolution: where adhesion is weak, values of K with successive numbers of modes differ by more
    than the residual allows.
    """
    place, last, resolution = start, np.inf, None
    for _ in range(MAXIMUM_ITERATIONS):
        balance = evaluated(on.asked(system), place, accuracy.tolerance, resolution)
        if isinstance(balance, Refused):
            return balance
        if np.max(np.abs(outward_motion(start.patches, place.patches)) / unit_of(system, balance)) > LONGEST_MOTION:
            return Refused.FAR
        row = on.row(balance, place.value)
        met = place is not start and abs(row.value) <= on.accuracy
        if met and balance.residual <= accuracy.residual:
            return balance, place.value
        step = newton_step(system, balance, row)
        if isinstance(step, Refused):
            return step
        if step.size >= last:  # rounding is left, or nothing is near
            return (balance, place.value) if met and balance.is_equilibrium(accuracy.residual) else Refused.DIVERGED
        last, resolution = step.size, balance.state.resolution if step.size < SHORT else None
        place = step.end(balance, place.value)
    return Refused.DIVERGED


def evaluated(
    system: System, place: Start, tolerance: float, resolution: Resolution | None = None
) -> Balance | Refused:
    """Return the forces on edges that are in order, all of them tensile."""
    forces = evaluated_anywhere(system, place, tolerance, resolution)
    return forces if isinstance(forces, Refused) or forces.all_tensile else Refused.COMPRESSED


def evaluated_anywhere(
    system: System, place: Start, tolerance: float, resolution: Resolution | None = None
) -> Balance | Refused:
    """Return the forces on edges that are in order."""
    if not place.patches.is_ordered:
        return Refused.OVERLAP
    forces = if_solvable(balance, system, place.patches, place.penetration, place.value, tolerance, resolution)
    return Refused.UNRESOLVED if forces is None else forces


def evaluated_finely(system: System, place: Start, tolerance: float) -> Balance | Refused:
    """Return the forces on edges with the nodes and modes of a finer tolerance.

    The change of the forces by these is the error of an evaluation.
    """
    elastic = system.elastic
    wanted = finer(elastic, place.patches, resolve(elastic, place.patches, tolerance), FINER_MODES * tolerance)
    return evaluated(system, place, tolerance, wanted)


@dataclass(frozen=True, eq=False)
class NewtonStep:
    """Motion of the edges, change of the control, and the length of the motion in units.

    `factors` and `pivots` are those of the bordered system, whose row of the condition is divided by `scale`.
    """

    motion: FloatArray
    change: float
    size: float
    factors: FloatArray
    pivots: IntArray
    scale: float

    def end(self, balance: Balance, value: float) -> Start:
        """Return the start of the next evaluation: the end of the step, or a place on the way if the step is long."""
        part = min(1.0, LONGEST_MOTION / self.size) if self.size else 1.0
        return Start(
            balance.state.patches.moved(part * self.motion), balance.state.penetration, value + part * self.change
        )


def newton_step(system: System, balance: Balance, row: Row, held: FloatArray | None = None) -> NewtonStep | Refused:
    """Solve the bordered system, with some modes held."""
    unit = unit_of(system, balance)
    n = unit.size
    matrix, side = bordered(system, balance, unit, row), np.append(missing(balance), -row.value)
    if held is not None:
        rows = (held * unit[:, None]).T
        columns = held / (np.sqrt(balance.work) * unit)[:, None]
        k = held.shape[1]
        columns, rows = np.pad(columns, ((0, 1), (0, 0))), np.pad(rows, ((0, 0), (0, 1)))
        rows /= np.max(np.abs(rows), axis=1)[:, None]
        matrix = np.block([[matrix, columns], [rows, np.zeros((k, k))]])
        side = np.append(side, np.zeros(k))
    scale = float(np.max(np.abs(matrix[n])))
    matrix[n] /= scale
    side[n] /= scale
    factors, pivots, singular = lapack.dgetrf(matrix, overwrite_a=1)
    if singular:
        return Refused.SINGULAR
    solution = lapack.dgetrs(factors, pivots, side)[0]
    size = float(np.max(np.abs(solution[:n])))
    if not np.isfinite(size):
        return Refused.SINGULAR
    return NewtonStep(solution[:n] * unit, float(solution[n]), size, factors, pivots, scale)
