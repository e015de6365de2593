"""Equilibria that meet a condition: Newton on the bordered system (curve.py), and the error of what it finds.

Iterates are evaluated at a tolerance until a step is short.  The last evaluation has more nodes and modes than that
tolerance asks for; what it changes, of the numbers as the last Newton steps leave them, is the error.  Where modes are
held at rest (a symmetry that is to be kept), the forces lambda that hold them are further unknowns, and V . d xi = 0.

A condition says phi and its derivatives in a state.  These are a value of the control, a load, a plane through edges,
the neutral mode of a fold or of a bifurcation (minimally augmented: R. Seydel, Practical Bifurcation and Stability
Analysis, 2010, section 5.4), and a gap that closes (touches.py).  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Protocol

import numpy as np

from bem.adhesive.branch import after_step, outward_motion
from bem.adhesive.equilibrium import Balance, System, balance, symmetric_part
from bem.adhesive.lowest_modes import lowest_modes
from bem.adhesive.third_derivatives import hessian_change_times
from bem.continuation.curve import Row, bordered, missing, unit_of
from bem.elastic.collocation import Resolution, finer, resolve
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.increments import Accuracy
from bem.loading.path_events import EventNumbers

STEPS = 12  # of Newton; three to five do
LONGEST_STEP = 0.2  # units: what is taken of a longer step
SHORT, LAST = 1e-3, 1e-5  # units: a step behind which the last evaluation comes, and one that leaves 1e-10
FINER = 1e-2  # of the tolerance, for which a finer evaluation has the modes
MODES = 8  # lowest ones, among which the neutral one is followed


class Refused(Enum):
    """Why nothing was found, or a step was not taken."""

    OVERLAP = "edges overlap"
    COMPRESSED = "K is not positive at an edge"
    UNRESOLVED = "the gaps are too narrow to resolve"
    SINGULAR = "the bordered system is singular"
    DIVERGED = "Newton's steps do not shrink"
    FAR = "what was found is not on this piece of the curve"
    MISFIT = "the two ends of the step do not agree"
    UNCLEAR = "a shorter step must tell what happens in this one"


class Condition(Protocol):
    """What closes the equations of equilibrium: phi(xi, tau) = 0, within an accuracy."""

    @property
    def accuracy(self) -> float:
        """Largest |phi| of what is found."""
        ...

    def asked(self, system: System) -> System:
        """The system whose evaluations know what the condition needs."""
        ...

    def row(self, here: Balance, value: float) -> Row:
        """phi and its derivatives."""
        ...


@dataclass(frozen=True)
class AtControl:
    """The control has a value."""

    goal: float
    accuracy: float = np.inf

    def asked(self, system: System) -> System:
        """As it is."""
        return system

    def row(self, here: Balance, value: float) -> Row:
        """tau - goal."""
        return Row(value - self.goal, np.zeros(here.work.size), 1.0)


@dataclass(frozen=True)
class AtLoad:
    """The load has a value, within an accuracy."""

    system: System
    load: float
    accuracy: float

    def asked(self, system: System) -> System:
        """As it is."""
        return system

    def row(self, here: Balance, value: float) -> Row:
        """P - load: edges change P by k at fixed penetration, and by the control."""
        control, state = self.system.control, here.state
        share = control.load_weight * control.rate(state) * state.load_rate
        return Row(state.load - self.load, here.load_gradient * (1 - share), state.load_rate * control.rate(state))


@dataclass(frozen=True, eq=False)
class InPlane:
    """Edges lie in a plane: normal . (xi - those given) = 0."""

    patches: Patches
    normal: FloatArray
    accuracy: float = np.inf

    def asked(self, system: System) -> System:
        """As it is."""
        return system

    def row(self, here: Balance, value: float) -> Row:
        """How far beyond it."""
        return Row(float(self.normal @ outward_motion(self.patches, here.state.patches)), self.normal, 0.0)


@dataclass(eq=False)
class NeutralMode:
    """An eigenvalue of the scaled Hessian vanishes: mu = v . H v, d mu = (D_v H v) . d xi + v . H_tau v d tau.

    Of the lowest modes it is that which is most along the last one, at first along the mode given.

    Attributes
    ----------
    scale : (2 L,) array
        Units of motions, fixed.
    last : (2 L,) array
        The mode in these.
    values, modes : (n,), (2 L, n) arrays
        The lowest eigenvalues and their modes in the last state, `index` among them the neutral one.
    by_edges : (2 L,) array
        D_v H v.
    """

    system: System
    scale: FloatArray
    last: FloatArray
    accuracy: float
    values: FloatArray = field(default_factory=lambda: np.zeros(0))
    modes: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    index: int = 0
    by_edges: FloatArray = field(default_factory=lambda: np.zeros(0))

    def asked(self, system: System) -> System:
        """As it is."""
        return system

    def row(self, here: Balance, value: float) -> Row:
        """mu."""
        self.values, self.modes = lowest_modes(symmetric_part(here.hessian, self.scale), MODES)
        self.index = int(np.argmax(np.abs(self.modes.T @ self.last)))
        mode = self.modes[:, self.index]
        self.last = mode if mode @ self.last > 0 else -mode
        motion = self.motion
        self.by_edges = hessian_change_times(self.system, here, motion, 0.0, motion)
        rate = float(motion @ hessian_change_times(self.system, here, None, 1.0, motion))
        return Row(float(self.values[self.index]), self.by_edges, rate)

    @property
    def motion(self) -> FloatArray:
        """The mode as outward motion of the edges."""
        return self.last * self.scale

    @property
    def others(self) -> FloatArray:
        """Eigenvalues of the other modes, ascending."""
        return np.delete(self.values, self.index)


@dataclass(frozen=True, eq=False)
class AtRest:
    """Modes that do not take part, (2 L, k) outward motions, held by forces along them.

    Where a broken symmetry is restored it is not known where they are at rest: there the control does no work on them,
    v . dg/dtau = 0.
    """

    modes: FloatArray
    restored: bool = False

    def rows(self, system: System, here: Balance, unit: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Rows for motions in units and the control, (k, 2 L + 1), and what is missing of them, (k,)."""
        count, rate = self.modes.shape[1], system.control.rate(here.state)
        rows, off = np.zeros((count, unit.size + 1)), np.zeros(count)
        rows[:, :-1] = (self.modes * unit[:, None]).T
        if self.restored:
            rows[:, :-1] = [unit * hessian_change_times(system, here, None, 1.0, mode) for mode in self.modes.T]
            rows[:, -1] = self.modes.T @ (here.state.stress_intensity_rate * rate) ** 2 / 2
            off = -(self.modes.T @ here.load_gradient) * rate
        size = np.max(np.abs(rows), axis=1)
        return rows / size[:, None], off / size


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
        Forces beside it.
    exact, error : EventNumbers
        Its numbers, and what the last evaluation changed of them.
    step : (2 L,) array
        What is left to it, outward motion of the edges.
    """

    balance: Balance
    exact: EventNumbers
    error: EventNumbers
    step: FloatArray

    @property
    def patches(self) -> Patches:
        """Its edges."""
        return self.balance.state.patches.moved(self.step)


def locate(
    system: System, start: Start, on: Condition, tolerance: float, at_rest: AtRest | None = None
) -> Located | Refused:
    """The equilibrium next to edges that meets a condition, with its error.

    Parameters
    ----------
    system : System
    start : Start
    on : Condition
    tolerance : float
        Of the evaluations.
    at_rest : AtRest, optional
    """
    before: EventNumbers | None = None
    place, last = start, np.inf
    for _ in range(STEPS):
        asked = on.asked(system.sloped)
        here = evaluated(asked, place, tolerance) if before is None else evaluated_finely(asked, place, tolerance)
        if isinstance(here, Refused):
            return here
        row = on.row(here, place.value)
        taken = newton_step(system, here, row, at_rest)
        if isinstance(taken, Refused):
            return taken
        step, change, size = taken
        if size > last and size > SHORT:
            return Refused.DIVERGED
        numbers = after_step(system, here, place.value, step, change)
        if before is not None and size <= LAST and abs(row.value) <= on.accuracy:
            return Located(here, numbers, numbers.apart(before, system.control.force(here.state)), step)
        if before is None and size <= SHORT:
            before = numbers
        last = size
        place = _moved(here, place.value, step, change, size)
    return Refused.DIVERGED


def settle(system: System, start: Start, on: Condition, accuracy: Accuracy) -> tuple[Balance, float] | Refused:
    """The state next to edges that meets a condition, evaluated in itself, and its value of the control.

    It is no farther than LONGEST_STEP away, and at the end of a Newton step: what that leaves is below the residual.
    Short steps keep the resolution: where adhesion is weak K of one number of modes and K of the next differ by more
    than the residual allows.
    """
    place, last, kept = start, np.inf, None
    for count in range(STEPS):
        here = evaluated(on.asked(system), place, accuracy.tolerance, kept)
        if isinstance(here, Refused):
            return here
        if np.max(np.abs(outward_motion(start.patches, place.patches)) / unit_of(system, here)) > LONGEST_STEP:
            return Refused.FAR
        row = on.row(here, place.value)
        if count and here.is_equilibrium(accuracy.residual) and abs(row.value) <= on.accuracy:
            return here, place.value
        taken = newton_step(system, here, row, None)
        if isinstance(taken, Refused):
            return taken
        step, change, size = taken
        if size > last and size > SHORT:
            return Refused.DIVERGED
        last, kept = size, here.state.resolution if size < SHORT else None
        place = _moved(here, place.value, step, change, size)
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
    wanted = finer(elastic, place.patches, resolve(elastic, place.patches, tolerance), FINER * tolerance)
    return evaluated(system, place, tolerance, wanted)


def newton_step(
    system: System, here: Balance, row: Row, at_rest: AtRest | None
) -> tuple[FloatArray, float, float] | Refused:
    """Motion of the edges, change of the control, and length of the motion in units."""
    unit = unit_of(system, here)
    n = unit.size
    matrix, side = bordered(system, here, unit, row), np.append(missing(here), -row.value)
    if at_rest is not None:
        rows, off = at_rest.rows(system, here, unit)
        count = off.size
        columns = np.zeros((n + 1, count))
        columns[:n] = at_rest.modes / (np.sqrt(here.work) * unit)[:, None]
        matrix = np.block([[matrix, columns], [rows, np.zeros((count, count))]])
        side = np.append(side, off)
    scale = np.max(np.abs(matrix[n]))
    matrix[n] /= scale
    side[n] /= scale
    try:
        both = np.linalg.solve(matrix, side)
    except np.linalg.LinAlgError:
        return Refused.SINGULAR
    size = float(np.max(np.abs(both[:n])))
    return (both[:n] * unit, float(both[n]), size) if np.isfinite(size) else Refused.SINGULAR


def _moved(here: Balance, value: float, step: FloatArray, change: float, size: float) -> Start:
    """Where the next evaluation is: at the end of a step, or on the way there if it is long."""
    part = min(1.0, LONGEST_STEP / size) if size else 1.0
    return Start(here.state.patches.moved(part * step), here.state.penetration, value + part * change)
