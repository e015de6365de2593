"""Folds and broken symmetries: the ends of the stable part of a branch on a span of its curve, and their equations.

The end of a span says which, by the number of negative eigenvalues of the Hessian and by the way the control goes:

=========  =======  ==============================================================================================
negative   control  content of the span
=========  =======  ==============================================================================================
none       onward   nothing, unless the quintic turns in between: a snap hides there, and a shorter step tells
one        back     a fold: the control turns, and the mode that is neutral there carries the contact away
any        any      if the control does no work on the modes that turned unstable: a symmetry broke
others              a shorter step tells
=========  =======  ==============================================================================================

Where a symmetry is restored (none, back) the branch goes on as its mirror image: shorter steps are tried until none is
left, and a step of the control finds the symmetric branch (path.py).

Folds and broken symmetries are located as equilibria with a neutral mode v, that is with mu = v . H v = 0 besides
(`NeutralMode`; minimally augmented: R. Seydel, Practical Bifurcation and Stability Analysis, 2010, section 5.4), and
their error comes with them (locating.py).  Modes that break a symmetry are held meanwhile; if that takes a force, the
profile has not quite the symmetry, and shorter steps lead to the fold near the bifurcation.  Eigenvalues are taken of
the Hessian in units of the root of edge scale over work of adhesion, of order 1.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bem.adhesive.equilibrium import Balance, System, symmetric_part
from bem.adhesive.lowest_modes import lowest_modes
from bem.adhesive.third_derivatives import hessian_change_times
from bem.geometry.arrays import FloatArray
from bem.path.locating import LOCATED, Condition, Located, Refused, Start, locate
from bem.path.span import Span
from bem.path.stand import MODES, Row

NO_WORK = 1e-3  # cosine of a mode and of the pull of the control, below which the control does no work on the mode
NEUTRAL_OFF = 5.0  # of the tolerance: error of an eigenvalue by an evaluation
NEUTRAL = 1e-2  # eigenvalues of modes that are neutral together


@dataclass(eq=False)
class NeutralMode(Condition):
    """Condition that an eigenvalue of the scaled Hessian vanishes: mu = v . H v.

    The derivatives are d mu = (D_v H v) . d xi + v . H_tau v d tau.

    The neutral mode is the one of the lowest modes that is most along the last neutral mode, at first along the mode
    given.

    Attributes
    ----------
    scale : (2 L,) array
        Units of motions, fixed.
    last : (2 L,) array
        Last neutral mode, in units `scale`.
    values, modes : (n,), (2 L, n) arrays
        Lowest eigenvalues and their modes in the last state; `index` is the index of the neutral mode.
    by_edges : (2 L,) array
        D_v H v.
    """

    system: System
    scale: FloatArray
    last: FloatArray
    values: FloatArray = field(init=False)
    modes: FloatArray = field(init=False)
    index: int = field(init=False)
    by_edges: FloatArray = field(init=False)
    off: float = NEUTRAL_OFF

    def row(self, balance: Balance, value: float) -> Row:
        """Return the eigenvalue mu and its derivatives by the edges and by the control."""
        self.values, self.modes = lowest_modes(symmetric_part(balance.hessian, self.scale), MODES)
        self.index = int(np.argmax(np.abs(self.modes.T @ self.last)))
        mode = self.modes[:, self.index]
        self.last = mode if mode @ self.last > 0 else -mode
        motion = self.motion
        self.by_edges = hessian_change_times(self.system, balance, motion, 0.0, motion)
        rate = float(motion @ hessian_change_times(self.system, balance, None, 1.0, motion))
        return Row(float(self.values[self.index]), self.by_edges, rate)

    @property
    def motion(self) -> FloatArray:
        """Mode as outward motion of the edges."""
        return self.last * self.scale

    @property
    def others(self) -> FloatArray:
        """Eigenvalues of the other modes, ascending."""
        return np.delete(self.values, self.index)


@dataclass(frozen=True, eq=False)
class LimitPoint:
    """Equilibrium at which a branch ends or loses its stability.

    Attributes
    ----------
    kind : {"fold", "broken_symmetry"}
    at : Located
    modes : (2 L, n) array
        Outward motions of the edges without resistance; one at a fold, to the side on which the potential falls.
    bend : float
        At a fold, D_v H v . v / 2: on the branch the forces are `bend` times the square of the motion along v.
    place : float
        Parameter on the span.
    """

    kind: Literal["fold", "broken_symmetry"]
    at: Located
    modes: FloatArray
    bend: float
    place: float


def does_no_work(balance: Balance, scale: FloatArray, modes: FloatArray) -> NDArray[np.bool_]:
    """Return for each mode, (2 L, n) in units `scale`, whether the control does no work on it, (n,)."""
    pull = balance.load_gradient * scale
    return np.asarray(np.abs(modes.T @ pull) < NO_WORK * np.linalg.norm(pull))


@dataclass(frozen=True, eq=False)
class LimitPoints:
    """Search for limit points on spans.

    Parameters
    ----------
    system : System
    direction : float
        Sign of the motion of the control.
    tolerance : float
        Tolerance of the evaluations that locate limit points.
    """

    system: System
    direction: float
    tolerance: float

    def on(self, span: Span) -> LimitPoint | Refused | None:
        """Return the limit point on a span; None where there is none."""
        last = span.last
        (values, modes), onward = last.lowest, last.control_rate * self.direction > 0
        idle = does_no_work(last.balance, last.balance.scale, modes)
        if np.any(idle):
            return self._broken(span, last.balance, modes[:, idle])
        if values.size == 0 and onward:
            return Refused.UNCLEAR if span.turns().size else None
        turns = span.turns()
        if onward or values.size != 1 or turns.size == 0:
            return Refused.UNCLEAR
        return self._fold(span, float(turns[0]))

    def _fold(self, span: Span, place: float) -> LimitPoint | Refused:
        """Return the fold at about a parameter, unless a symmetry breaks before it."""
        scale = span.first.balance.scale
        neutral = self._neutral(scale, span.last.rate / scale)
        at = locate(self.system, span.at(place), neutral, self.tolerance)
        if isinstance(at, Refused):
            return at
        if not span.holds(at.patches, at.numbers.value):
            return Refused.FAR
        pull, mode = at.balance.load_gradient * scale, neutral.last
        pull = pull * self.system.control.rate(at.balance.state)
        before = (neutral.values <= 0) & (np.arange(neutral.values.size) != neutral.index)
        if np.any(before):
            before &= does_no_work(at.balance, scale, neutral.modes)
            return self._broken(span, at.balance, neutral.modes[:, before], scale) if before.any() else Refused.UNCLEAR
        work = float(pull @ mode)
        cubic = float(neutral.by_edges @ neutral.motion)
        if cubic * work * self.direction <= 0:
            return Refused.UNCLEAR
        down = -np.sign(cubic) * neutral.motion
        return LimitPoint("fold", at, down[:, None], abs(cubic) / 2, span.parameter(at.patches))

    def _broken(
        self, span: Span, balance: Balance, modes: FloatArray, scale: FloatArray | None = None
    ) -> LimitPoint | Refused:
        """Return the point where the first of some modes turns unstable on which the control does no work.

        The modes, taken in the state `balance` in units `scale`, are held.  `scale` is by default the scale
        of `balance`.
        """
        held = modes * (balance.scale if scale is None else scale)[:, None]
        scale = span.first.balance.scale
        stiff, soft = (np.einsum("ij,ik,kj->j", held, state.hessian, held) for state in (span.first.balance, balance))
        shares = np.where((stiff > 0) & (soft < 0), stiff / np.where(soft < stiff, stiff - soft, 1.0), 1.0)
        start, along = span.at(float(shares.min())), held[:, int(np.argmin(shares))] / scale
        for _ in range(MODES):
            neutral = self._neutral(scale, along)
            at = locate(self.system, start, neutral, self.tolerance, held)
            if isinstance(at, Refused):
                return at
            start = Start(at.patches, at.numbers.penetration, at.numbers.value)
            felt = _forces(at.balance, held) > LOCATED
            if felt.any() and not felt.all():  # forces hold these modes: the profile lacks their symmetry
                held = held[:, ~felt]
                continue
            lowest = int(np.argmin(neutral.values))
            if neutral.values[lowest] > neutral.values[neutral.index] - LOCATED:
                return self._breaking(span, at, neutral)
            along = neutral.modes[:, lowest]
        return Refused.UNCLEAR

    def _breaking(self, span: Span, at: Located, neutral: NeutralMode) -> LimitPoint | Refused:
        """Return the point where a symmetry breaks, if the profile has it and nothing else turned unstable before."""
        soft = does_no_work(at.balance, neutral.scale, neutral.modes) & (neutral.values < NEUTRAL)
        modes = neutral.modes * neutral.scale[:, None]
        pushed = np.any(_forces(at.balance, modes[:, soft]) > LOCATED)
        behind = (at.numbers.value - span.first.value) * self.direction < -LOCATED
        if not soft[0] or np.any(neutral.values[~soft] <= 0) or pushed or behind:
            return Refused.UNCLEAR
        return LimitPoint("broken_symmetry", at, modes[:, soft], 0.0, span.parameter(at.patches))

    def _neutral(self, scale: FloatArray, mode: FloatArray) -> NeutralMode:
        """Return the condition of a neutral mode, at first along a mode in units `scale`."""
        return NeutralMode(self.system, scale, mode / np.linalg.norm(mode))


def _forces(balance: Balance, modes: FloatArray) -> FloatArray:
    """Return the forces along motions of the edges over the work of adhesion, (n,)."""
    return np.asarray(np.abs(balance.gradient @ (modes / np.linalg.norm(modes, axis=0))) / np.max(balance.work))
