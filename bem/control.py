"""What is held fixed while the edges move: penetration, mean pressure or total displacement.

Every control is a linear condition alpha Delta + beta load = target, and both load and Delta are linear in each
other at given edges, so a state solved at any Delta is carried to the condition exactly, without a second
factorisation.  With g_Delta = d(load)/d(edges) = K K_Delta / 2 the second derivative of the potential under
control is H - beta / (alpha + beta dload/dDelta) g_Delta g_Delta^T: penetration control leaves H alone, load
control borders it fully, and a layer driven by u_tot = Delta + c(0) sigma_0 lies in between.

The potential is U for beta = 0, else U + alpha Delta^2 / (2 beta) - target Delta / beta.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem.collocation import Evaluation

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class PenetrationControl:
    """Delta is prescribed."""

    penetration_weight: float = 1.0
    load_weight: float = 0.0

    def reach(self, state: Evaluation, target: float) -> Evaluation:
        """The state itself, which was evaluated at the target."""
        return state

    def guess(self, penetration: float, target: float) -> float:
        """Penetration at which to evaluate: the target."""
        return target

    def value(self, penetration: float, load: float) -> float:
        """What the control holds fixed, in a state."""
        return penetration

    def potential(self, penetration: float, energy: float, target: float) -> float:
        """The energy that an equilibrium minimises."""
        return energy

    def force(self, state: Evaluation) -> float:
        """Derivative of the potential by the target, in equilibrium or at fixed edges."""
        return state.load

    def force_rate(self, state: Evaluation, load_growth: float = 0.0) -> float:
        """Derivative of the force by the target; `load_growth` is that of the load by the motion of the edges."""
        return state.load_rate + load_growth

    def rate(self, state: Evaluation) -> float:
        """dDelta / dtarget at fixed edges."""
        return 1.0

    def penetration_rate(self, state: Evaluation) -> float:
        """Share of an error in the heights that is left as an error of Delta: all of it."""
        return 1.0

    def stiffen(self, hessian: FloatArray, load_gradient: FloatArray, state: Evaluation) -> FloatArray:
        """Hessian of the potential, (2 L, 2 L)."""
        return hessian


@dataclass(frozen=True)
class LinearControl:
    """alpha Delta + beta load is prescribed, beta > 0.

    Parameters
    ----------
    penetration_weight, load_weight : float
        alpha and beta; (0, 1) is load control.
    """

    penetration_weight: float
    load_weight: float

    def reach(self, state: Evaluation, target: float) -> Evaluation:
        """The state carried to the target along Delta at fixed edges."""
        return state.shifted((target - self.value(state.penetration, state.load)) * self.rate(state))

    def guess(self, penetration: float, target: float) -> float:
        """Penetration at which to evaluate: any would do; that of the last state."""
        return penetration

    def value(self, penetration: float, load: float) -> float:
        """What the control holds fixed, in a state."""
        return self.penetration_weight * penetration + self.load_weight * load

    def potential(self, penetration: float, energy: float, target: float) -> float:
        """The energy that an equilibrium minimises."""
        return energy + (self.penetration_weight * penetration / 2 - target) * penetration / self.load_weight

    def force(self, state: Evaluation) -> float:
        """Derivative of the potential by the target, in equilibrium or at fixed edges."""
        return -state.penetration / self.load_weight

    def force_rate(self, state: Evaluation, load_growth: float = 0.0) -> float:
        """Derivative of the force by the target; `load_growth` is that of the load by the motion of the edges."""
        return -self.rate(state) * (1 / self.load_weight - load_growth)

    def rate(self, state: Evaluation) -> float:
        """dDelta / dtarget at fixed edges."""
        return 1.0 / (self.penetration_weight + self.load_weight * state.load_rate)

    def penetration_rate(self, state: Evaluation) -> float:
        """Share of an error in the heights that is left as an error of Delta, from 0 (load control) to 1."""
        return self.penetration_weight * self.rate(state)

    def stiffen(self, hessian: FloatArray, load_gradient: FloatArray, state: Evaluation) -> FloatArray:
        """Hessian of the potential, (2 L, 2 L)."""
        return hessian - self.load_weight * self.rate(state) * np.outer(load_gradient, load_gradient)


Control = PenetrationControl | LinearControl
