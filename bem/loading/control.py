"""Control: the quantity that is held fixed while the edges move, displacement or mean pressure.

Every control is a linear condition alpha Delta + beta load = target, and at given edges the state is affine in Delta,
so that a state solved at any Delta is carried to the condition exactly, without a second factorisation.  With
g_Delta = d(load)/d(edges) = K K_Delta / 2 the second derivative of the potential under control is
H - beta / (alpha + beta dload/dDelta) g_Delta g_Delta^T: penetration control leaves H alone, load control borders it
fully, and a layer driven by u_tot = Delta + c(0) sigma_0 lies in between.

The potential is U + beta load^2 / 2 for alpha = 1 (the layer as a spring in series: a sum of squares, in which no
stiffness of the spring can cancel), and U - load Delta for alpha = 0.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bem.elastic.collocation import Evaluation


@dataclass(frozen=True)
class DisplacementControl:
    """Control by a prescribed Delta + beta load: the penetration, or the displacement above a spring in series.

    Parameters
    ----------
    load_weight : float
        beta >= 0, the compliance of the spring.
    """

    load_weight: float = 0.0
    penetration_weight: ClassVar[float] = 1.0

    def reach(self, state: Evaluation, target: float) -> Evaluation:
        """Return the state carried to the target along Delta at fixed edges."""
        if not self.load_weight:
            return state
        return state.shifted((target - self.value(state.penetration, state.load)) * self.rate(state))

    def guess(self, penetration: float, target: float) -> float:
        """Return a penetration at which to evaluate: the target; above a spring, where any would do, the last one."""
        return penetration if self.load_weight else target

    def value(self, penetration: float, load: float) -> float:
        """Return the controlled quantity of a state."""
        return penetration + self.load_weight * load

    def load(self, penetration: float, target: float) -> float:
        """Return the load at the target and a known penetration; NaN if the target is the penetration."""
        return (target - penetration) / self.load_weight if self.load_weight else np.nan

    def potential(self, penetration: float, load: float, energy: float) -> float:
        """Return the potential that an equilibrium minimises."""
        return energy + self.load_weight * load**2 / 2 if self.load_weight else energy

    def force(self, state: Evaluation) -> float:
        """Return the derivative of the potential by the target, in equilibrium or at fixed edges."""
        return state.load

    def force_rate(self, state: Evaluation, load_growth: float = 0.0) -> float:
        """Return the derivative of the force by the target.

        `load_growth` is the derivative of the load by the motion of the edges.
        """
        return self.rate(state) * (state.load_rate + load_growth)

    def rate(self, state: Evaluation) -> float:
        """Return dDelta / dtarget at fixed edges."""
        return 1.0 / (1.0 + self.load_weight * state.load_rate)

    def penetration_rate(self, state: Evaluation) -> float:
        """Return the share of an error in the heights that remains as an error of Delta, 0 (soft spring) to 1."""
        return self.rate(state)


@dataclass(frozen=True)
class LoadControl:
    """Control by a prescribed load."""

    load_weight: ClassVar[float] = 1.0
    penetration_weight: ClassVar[float] = 0.0

    def reach(self, state: Evaluation, target: float) -> Evaluation:
        """Return the state carried to the target along Delta at fixed edges."""
        return state.shifted((target - state.load) / state.load_rate)

    def guess(self, penetration: float, target: float) -> float:
        """Return a penetration at which to evaluate: the last one, because any would do."""
        return penetration

    def value(self, penetration: float, load: float) -> float:
        """Return the controlled quantity of a state."""
        return load

    def load(self, penetration: float, target: float) -> float:
        """Return the load at the target: the target itself."""
        return target

    def potential(self, penetration: float, load: float, energy: float) -> float:
        """Return the potential that an equilibrium minimises."""
        return energy - load * penetration

    def force(self, state: Evaluation) -> float:
        """Return the derivative of the potential by the target, in equilibrium or at fixed edges."""
        return -state.penetration

    def force_rate(self, state: Evaluation, load_growth: float = 0.0) -> float:
        """Return the derivative of the force by the target.

        `load_growth` is the derivative of the load by the motion of the edges.
        """
        return -self.rate(state) * (1 - load_growth)

    def rate(self, state: Evaluation) -> float:
        """Return dDelta / dtarget at fixed edges."""
        return 1.0 / state.load_rate

    def penetration_rate(self, state: Evaluation) -> float:
        """Return the share of an error in the heights that remains as an error of Delta: 0."""
        return 0.0


Control = DisplacementControl | LoadControl
