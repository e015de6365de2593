"""Stand on a branch: an equilibrium with two derivatives along the curve, and the bordered system that finds it.

Unknowns are the outward motions xi of the edges and the control tau.  The curve K(xi, tau) = 2 sqrt(w(xi)) is regular
at folds, where tau turns.  Each state that is searched for on the curve meets one more condition phi(xi, tau) = 0
and is found by Newton on the bordered system

    [ (J - beta r K_Delta k^T - diag(w'/sqrt w)) / sqrt w    r K_Delta / sqrt w ] [ d xi  ]   [ 2 - K / sqrt w ]
    [ phi_xi                                                 phi_tau            ] [ d tau ] = [ - phi          ],

J = dK/dxi at fixed penetration, r = dDelta/dtau at fixed edges, beta the load weight of the control and k = dP/dxi
(H. B. Keller, Numerical Methods in Bifurcation Problems, 1987, section 5).  On the curve by s = c . xi / n, with the
tangent (t, tau') and the Hessian H under control, the second derivatives solve the bordered system for the right
side -((D_t H + tau' H_tau) t + tau' H_tau t + (tau' r K_Delta)^2 / 2) / w, 0.

Lengths are maximum norms of motions in parts of the unit of each edge: its edge scale, or 0.4 of the shortest wave that
may pin it.  Dimensionless.  Limits: K > 0 at every edge, and no two tangents at one point: at a bifurcation the system
is singular (symmetry.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import lapack

from bem.adhesive.branch import after_step, tangent
from bem.adhesive.equilibrium import Balance, System, forces, symmetric_part
from bem.adhesive.lowest_modes import lowest_modes
from bem.adhesive.third_derivatives import hessian_change_times
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.path_events import EventNumbers

PINNED = 0.4  # of the shortest wave that may pin an edge: its unit of length, if its edge scale is not less
LONGEST_STEP = 0.4  # units: the motion of the edges in a step
LONGEST_MOTION = LONGEST_STEP / 2  # of the edges by Newton
SHORT = 5e-4  # units, or of a gap: a motion in which everything is linear but for a part of its square
SOFTENING = 60.0  # times the work of adhesion: largest loss of stiffness per unit in a motion by a unit; measured 39
MODES = 8  # lowest modes that are looked at; more turn within a step only among equal patches


@dataclass(frozen=True, eq=False)
class Row:
    """Condition next to the curve: phi and its derivatives by outward motions of the edges, and by the control."""

    value: float
    by_edges: FloatArray
    by_control: float


def unit_of(system: System, balance: Balance) -> FloatArray:
    """Return the lengths in which motions of the edges are measured, (2 L,)."""
    scale = balance.state.patches.edge_scale
    return np.minimum(scale, PINNED * system.pinning.shortest(balance.work, scale))


def bordered(system: System, balance: Balance, unit: FloatArray, row: Row) -> FloatArray:
    """Return the matrix of the bordered system, motions in units, (2 L + 1, 2 L + 1)."""
    state, control, n, root = balance.state, system.control, balance.work.size, np.sqrt(balance.work)
    matrix = np.empty((n + 1, n + 1))
    matrix[:n, :n], matrix[:n, n] = balance.jacobian, state.stress_intensity_rate * control.rate(state)
    if control.load_weight > 0:
        matrix[:n, :n] -= np.outer(control.load_weight * matrix[:n, n], balance.load_gradient)
    matrix.flat[: n * (n + 1) : n + 2] -= balance.work_gradient / root
    matrix[:n, :n] *= unit
    matrix[:n] /= root[:, None]
    matrix[n, :n], matrix[n, n] = row.by_edges * unit, row.by_control
    return matrix


def missing(balance: Balance) -> FloatArray:
    """Return 2 - K / sqrt w, (2 L,): zero in equilibrium."""
    return np.asarray(2 - balance.state.stress_intensity / np.sqrt(balance.work))


@dataclass(frozen=True, eq=False)
class Stand:
    """Point of the curve with two derivatives by its parameter.

    Attributes
    ----------
    balance : Balance
        Forces one Newton step away.
    patches, numbers : Patches, EventNumbers
        The point itself.
    rate, control_rate : (2 L,) array, float
        First derivatives of the outward motions and of the control.
    bend, control_bend : (2 L,) array, float
        Second derivatives.
    unit : (2 L,) array
    off : float
        Length of the Newton step.
    """

    balance: Balance
    patches: Patches
    numbers: EventNumbers
    rate: FloatArray
    control_rate: float
    bend: FloatArray
    control_bend: float
    unit: FloatArray
    off: float

    @property
    def value(self) -> float:
        """Value of the control."""
        return self.numbers.value

    @property
    def speed(self) -> float:
        """Length of the tangent."""
        return float(np.max(np.abs(self.rate / self.unit)))

    @cached_property
    def lowest(self) -> tuple[FloatArray, FloatArray]:
        """Negative eigenvalues of the scaled Hessian, ascending, and their modes; up to MODES."""
        size = self.balance.work.size
        if self.balance.factor is not None:
            return np.zeros(0), np.zeros((size, 0))
        values, modes = lowest_modes(self.balance.scaled_hessian, MODES)
        return values[values < 0], modes[:, values < 0]

    @property
    def is_clear(self) -> bool:
        """True if some eigenvalues are negative, or if changes by the Newton step leave all of them positive.

        False where an edge is not tensile, because the Hessian then says nothing.
        """
        if not self.balance.all_tensile:
            return False
        if self.balance.factor is None:
            return True
        shifted = symmetric_part(self.balance.hessian, np.sqrt(self.unit / self.balance.work))
        shifted.flat[:: shifted.shape[0] + 1] -= SOFTENING * self.off
        return bool(lapack.dpotrf(shifted, lower=0, clean=0)[1] == 0)

    @cached_property
    def derivatives(self) -> tuple[FloatArray, FloatArray]:
        """First and second derivatives of motions and control, (2 L + 1,) each."""
        return np.append(self.rate, self.control_rate), np.append(self.bend, self.control_bend)

    def by(self, normal: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return first and second derivatives of motions and control by the parameter normal . xi, (2 L + 1,) each."""
        along, turning = float(normal @ self.rate), float(normal @ self.bend)
        first, second = self.derivatives
        return first / along, (second - first * (turning / along)) / along**2


def stand_near(system: System, balance: Balance, value: float, normal: FloatArray, length: float) -> Stand | None:
    """Return the point of the curve next to forces, in the plane through their edges whose normal is given.

    One Newton step leads to the point; its change of the control is exact at once, because the state is linear in
    Delta.  The parameter is normal . xi / length.  None where the step is longer than a unit, or edges overlap behind
    it.
    """
    unit, row = unit_of(system, balance), Row(0.0, normal, 0.0)
    sides = np.zeros((unit.size + 1, 2))
    sides[-1, 1] = length
    for _ in range(2):
        factors, pivots, singular = lapack.dgetrf(bordered(system, balance, unit, row), overwrite_a=1)
        if singular:
            return None
        sides[:-1, 0] = missing(balance)
        solution = lapack.dgetrs(factors, pivots, sides)[0]
        value += float(solution[-1, 0])
        control = system.control
        moved = balance.state if control.load_weight else balance.state.shifted(value - balance.state.penetration)
        balance = forces(system, control.reach(moved, value), value, balance)
    rate, control_rate = solution[:-1, 1] * unit, float(solution[-1, 1])
    bent = np.append(-_bent(system, balance, rate, control_rate) / balance.work, 0.0)
    second = lapack.dgetrs(factors, pivots, bent)[0]
    step, off = solution[:-1, 0] * unit, float(np.max(np.abs(solution[:-1, 0])))
    patches = balance.state.patches.moved(step)
    if not off <= 1 or not patches.is_ordered:
        return None
    numbers = after_step(system, balance, value, step, 0.0)
    return Stand(balance, patches, numbers, rate, control_rate, second[:-1] * unit, float(second[-1]), unit, off)


def _bent(system: System, balance: Balance, rate: FloatArray, control_rate: float) -> FloatArray:
    """Return the second derivative of the gradient along a tangent, (2 L,)."""
    bent = hessian_change_times(system, balance, rate, 2 * control_rate, rate)
    bent += (control_rate * balance.state.stress_intensity_rate * system.control.rate(balance.state)) ** 2 / 2
    return bent


def first_stand(system: System, balance: Balance, value: float, direction: float) -> Stand | None:
    """Return the point next to a stable state; its parameter grows as the control moves in a direction."""
    along = direction * tangent(system, balance)
    unit = unit_of(system, balance)
    along = along / np.max(np.abs(along / unit))
    normal = along / unit**2
    return stand_near(system, balance, value, normal, float(normal @ along))
