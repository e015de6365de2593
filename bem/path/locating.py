"""Equilibria that meet a condition: Newton on the bordered system (stand.py), and the error of what it finds.

Iterates are evaluated at a tolerance until a step is short.  The last evaluation has more nodes and modes than that
tolerance asks for; what it changes, of the numbers as the last Newton steps leave them, is the error.  Newton has
diverged where a step is no shorter than the one before it.  Where modes V are held (a symmetry that is to be kept), the
forces lambda that hold them are further unknowns, and V . d xi = 0.

A condition says phi and its derivatives in a state.  These are a value of the control, a load, a plane through edges,
the neutral mode of a fold or of a bifurcation (fold.py), and a gap that closes (touch.py).  Dimensionless.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum

import numpy as np

from bem.adhesive.branch import after_step, outward_motion
from bem.adhesive.equilibrium import Balance, System, balance, energy_noise
from bem.elastic.collocation import Resolution, finer, resolve
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.increments import MAXIMUM_ITERATIONS, Accuracy
from bem.loading.path_events import EventNumbers
from bem.path.stand import LONGEST_MOTION, SHORT, Row, bordered, missing, unit_of

LAST = 1e-5  # units: the last step, behind which LAST^2 = 1e-10 is missing
LOCATED = 1e-9  # what is left of zero: rms heights, works of adhesion, eigenvalues
VERIFIED = 1e-8  # tolerance of evaluations up to which what is located is evaluated once more, finer
OFF = 0.3  # of the tolerance: error of K, of a gap and of the load by an evaluation; measured .03, .2 on thin layers
FINER_MODES = 1e-2  # of the tolerance, for which a finer evaluation has the modes


class Refused(Enum):
    """Why nothing was found, or a step was not taken."""

    OVERLAP = "edges overlap"
    COMPRESSED = "K is not positive at an edge"
    UNRESOLVED = "the gaps are too narrow to resolve"
    SINGULAR = "the bordered system is singular"
    DIVERGED = "Newton's steps do not shrink"
    FAR = "what was found is not on this span of the curve"
    MISFIT = "the two ends of the step do not agree"
    UNCLEAR = "a shorter step must tell what happens in this one"


class Condition(ABC):
    """What closes the equations of equilibrium: phi(xi, tau) = 0, in a settled state within an accuracy."""

    accuracy: float = np.inf
    off: float = OFF

    def asked(self, system: System) -> System:
        """The system whose evaluations know what the condition needs."""
        return system

    @abstractmethod
    def row(self, here: Balance, value: float) -> Row:
        """phi and its derivatives."""


@dataclass(frozen=True)
class AtControl(Condition):
    """The control has a value."""

    goal: float

    def row(self, here: Balance, value: float) -> Row:
        """tau - goal."""
        return Row(value - self.goal, np.zeros(here.work.size), 1.0)


@dataclass(frozen=True)
class AtLoad(Condition):
    """The load has a value, within an accuracy."""

    system: System
    load: float
    accuracy: float

    def row(self, here: Balance, value: float) -> Row:
        """P - load: edges change P by k at fixed penetration, and by the control."""
        control, state = self.system.control, here.state
        share = control.load_weight * control.rate(state) * state.load_rate
        return Row(state.load - self.load, here.load_gradient * (1 - share), state.load_rate * control.rate(state))


@dataclass(frozen=True, eq=False)
class InPlane(Condition):
    """Edges lie in a plane: normal . (xi - those given) = 0."""

    patches: Patches
    normal: FloatArray

    def row(self, here: Balance, value: float) -> Row:
        """Distance of the edges beyond the plane, along its normal."""
        return Row(float(self.normal @ outward_motion(self.patches, here.state.patches)), self.normal, 0.0)


@dataclass(frozen=True, eq=False)
class Start:
    """Where Newton begins: edges, the penetration from which a load is reached, and a value of the control."""

    patches: Patches
    penetration: float
    value: float


@dataclass(frozen=True, eq=False)
class Located:
    """Where a condition is met.

    Attributes
    ----------
    balance : Balance
        Forces one Newton step away.
    numbers, error : EventNumbers
        Its numbers, and what the last evaluation changed of them.
    step : (2 L,) array
        What is left to it, outward motion of the edges.
    """

    balance: Balance
    numbers: EventNumbers
    error: EventNumbers
    step: FloatArray

    @property
    def patches(self) -> Patches:
        """The edges where Newton's last step leads."""
        return self.balance.state.patches.moved(self.step)


def locate(
    system: System,
    start: Start,
    on: Condition,
    tolerance: float,
    held: FloatArray | None = None,
    known: Balance | None = None,
) -> Located | Refused:
    """The equilibrium next to edges that meets a condition, with its error.

    Parameters
    ----------
    system : System
    start : Start
    on : Condition
    tolerance : float
        Of the evaluations.
    held : (2 L, k) array, optional
        Outward motions that do not take part, held by forces along them.
    known : Balance, optional
        Forces where it begins, evaluated at the same tolerance.
    """
    before: EventNumbers | None = None
    place, last = start, np.inf
    for _ in range(MAXIMUM_ITERATIONS):
        asked = on.asked(system.sloped)
        if before is None:
            here = known or evaluated(asked, place, tolerance)
        else:
            here = evaluated_finely(asked, place, tolerance)
        known = None
        if isinstance(here, Refused):
            return here
        step = newton_step(system, here, on.row(here, place.value), held)
        if isinstance(step, Refused):
            return step
        if step.size >= last:
            return Refused.DIVERGED
        if tolerance > VERIFIED and step.size <= np.sqrt(tolerance):
            return _unverified(system, here, place.value, on, step, tolerance)
        numbers, last = after_step(system, here, place.value, step.motion, step.change), step.size
        if before is not None and step.size <= LAST:
            return Located(here, numbers, numbers.apart(before, system.control.force(here.state)), step.motion)
        if before is None and step.size <= SHORT:
            before, last = numbers, np.inf
        place = step.end(here, place.value)
    return Refused.DIVERGED


def _unverified(
    system: System, here: Balance, value: float, on: Condition, step: NewtonStep, tolerance: float
) -> Located:
    """What was located by coarse evaluations, with errors from those of K and of the condition.

    An error e of the right side of the bordered system A moves a number q with the derivatives c by c . A^-1 e, at most
    by the sum of the sizes; what the evaluation itself lacks of q adds to that.
    """
    unit, state, control, row = unit_of(system, here), here.state, system.control, on.row(here, value)
    error = np.append(OFF * tolerance / np.sqrt(here.work), on.off * tolerance) + step.size**2
    load = AtLoad(system, 0.0, 0.0).row(here, value)
    deeper = control.rate(state) * np.append(-control.load_weight * here.load_gradient, 1.0)
    numbers = np.stack([np.eye(unit.size + 1)[-1], np.append(load.by_edges, load.by_control), deeper], axis=1)
    numbers[:-1] *= unit[:, None]
    try:
        by_value, by_load, by_depth = np.abs(np.linalg.solve(bordered(system, here, unit, row).T, numbers)).T @ error
    except np.linalg.LinAlgError:
        by_value = by_load = by_depth = np.inf
    at, own = after_step(system, here, value, step.motion, step.change), OFF * tolerance
    errors = EventNumbers(
        float(by_value) + own * abs(at.value),
        float(by_depth) + own * abs(at.penetration),
        float(by_load) + own * abs(at.load),
        energy_noise(system, here, here, tolerance),
    )
    return Located(here, at, errors, step.motion)


def settle(system: System, start: Start, on: Condition, accuracy: Accuracy) -> tuple[Balance, float] | Refused:
    """The state next to edges that meets a condition, evaluated in itself, and its value of the control.

    It is no farther than LONGEST_MOTION away, and at the end of a Newton step: what that leaves is below the residual,
    or rounding that no step makes smaller.
    Short steps keep the resolution: where adhesion is weak K of one number of modes and K of the next differ by more
    than the residual allows.
    """
    place, last, kept = start, np.inf, None
    for _ in range(MAXIMUM_ITERATIONS):
        here = evaluated(on.asked(system), place, accuracy.tolerance, kept)
        if isinstance(here, Refused):
            return here
        if np.max(np.abs(outward_motion(start.patches, place.patches)) / unit_of(system, here)) > LONGEST_MOTION:
            return Refused.FAR
        row = on.row(here, place.value)
        met = place is not start and abs(row.value) <= on.accuracy
        if met and here.residual <= accuracy.residual:
            return here, place.value
        step = newton_step(system, here, row)
        if isinstance(step, Refused):
            return step
        if step.size >= last:  # rounding is left, or nothing is near
            return (here, place.value) if met and here.is_equilibrium(accuracy.residual) else Refused.DIVERGED
        last, kept = step.size, here.state.resolution if step.size < SHORT else None
        place = step.end(here, place.value)
    return Refused.DIVERGED


def evaluated(
    system: System, place: Start, tolerance: float, resolution: Resolution | None = None
) -> Balance | Refused:
    """Forces on edges that are in order, all of them tensile."""
    here = evaluated_anywhere(system, place, tolerance, resolution)
    return here if isinstance(here, Refused) or here.all_tensile else Refused.COMPRESSED


def evaluated_anywhere(
    system: System, place: Start, tolerance: float, resolution: Resolution | None = None
) -> Balance | Refused:
    """Forces on edges that are in order."""
    if not place.patches.is_ordered:
        return Refused.OVERLAP
    here = if_solvable(balance, system, place.patches, place.penetration, place.value, tolerance, resolution)
    return Refused.UNRESOLVED if here is None else here


def evaluated_finely(system: System, place: Start, tolerance: float) -> Balance | Refused:
    """The same with the nodes and modes of a finer tolerance: what this changes is the error of an evaluation."""
    elastic = system.elastic
    wanted = finer(elastic, place.patches, resolve(elastic, place.patches, tolerance), FINER_MODES * tolerance)
    return evaluated(system, place, tolerance, wanted)


@dataclass(frozen=True, eq=False)
class NewtonStep:
    """Motion of the edges, change of the control, and the length of the motion in units."""

    motion: FloatArray
    change: float
    size: float

    def end(self, here: Balance, value: float) -> Start:
        """Where the next evaluation is: at the end of the step, or on the way there if it is long."""
        part = min(1.0, LONGEST_MOTION / self.size) if self.size else 1.0
        return Start(here.state.patches.moved(part * self.motion), here.state.penetration, value + part * self.change)


def newton_step(system: System, here: Balance, row: Row, held: FloatArray | None = None) -> NewtonStep | Refused:
    """The solution of the bordered system, some modes being held."""
    unit = unit_of(system, here)
    n = unit.size
    matrix, side = bordered(system, here, unit, row), np.append(missing(here), -row.value)
    if held is not None:
        rows = (held * unit[:, None]).T
        columns = held / (np.sqrt(here.work) * unit)[:, None]
        k = held.shape[1]
        columns, rows = np.pad(columns, ((0, 1), (0, 0))), np.pad(rows, ((0, 0), (0, 1)))
        rows /= np.max(np.abs(rows), axis=1)[:, None]
        matrix = np.block([[matrix, columns], [rows, np.zeros((k, k))]])
        side = np.append(side, np.zeros(k))
    scale = np.max(np.abs(matrix[n]))
    matrix[n] /= scale
    side[n] /= scale
    try:
        both = np.linalg.solve(matrix, side)
    except np.linalg.LinAlgError:
        return Refused.SINGULAR
    size = float(np.max(np.abs(both[:n])))
    return NewtonStep(both[:n] * unit, float(both[n]), size) if np.isfinite(size) else Refused.SINGULAR
