"""Touch points: where the gap beside a branch of equilibria closes on a crest, located to the accuracy of a target.

Between two points of a branch the edges follow a cubic in the control, from which Newton corrects them; the least of
the gaps that closed in between vanishes at the touch, found by the secant within its bracket.  Gaps that vanish there
to within `TIED` touch together.  The last two states are evaluated at different accuracies; by how much the touch
moved is its error.  Dimensionless.  Limits: the branch reaches beyond the touch, as it does until contact forms.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bem.adhesive.branch import tangent
from bem.adhesive.equilibrium import Balance, System, correct
from bem.elastic.gap import GapMinima, gap_field, minima_near
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.increments import Accuracy
from bem.loading.path_events import EventNumbers

STEPS = 20
TOUCHED = 1e-10  # of the rms height: a gap that is closed
AT_TOUCH = 1e-9  # the same: how near to it the last evaluation must be; the rest of the way is extrapolated
NEARLY = 1e-6  # the same for the evaluations that are not the last
TIED = 1e-9  # of the rms height: gaps that close together
DISTINCT = (1e-7, 1e-10)  # of the rms height: gaps farther apart give a slope, in the first evaluations and the last
RESIDUAL = 0.1  # of |G/w - 1| over the tolerance of the evaluation


@dataclass(frozen=True, eq=False)
class TouchPoint:
    """An equilibrium beside which a gap has just closed.

    Attributes
    ----------
    balance : Balance
    exact, error : EventNumbers
        Its numbers, and what the last refinement changed.
    touching : GapMinima
        The crests in contact.
    """

    balance: Balance
    exact: EventNumbers
    error: EventNumbers
    touching: GapMinima


@dataclass(frozen=True, eq=False)
class Bracket:
    """Where gaps beside a branch close.

    Attributes
    ----------
    ends : (float, float)
        Values of the control before and behind the touch.
    gaps : ((n,) array, (n,) array)
        The gaps in question there; some of the first may, all of the second must be negative.
    found : GapMinima
        Where these gaps are.
    beside : float
        How far from the ends the touch may be: they are states of less accuracy, beside a fold of much less.
    folds : bool
        Whether the second end is a fold, near which gaps are linear in the root of the distance from it.
    """

    ends: tuple[float, float]
    gaps: tuple[FloatArray, FloatArray]
    found: GapMinima
    beside: float
    folds: bool = False

    def reaches(self, value: float) -> bool:
        """Whether a value of the control lies between the ends, or not far from them."""
        return min(self.ends) - self.beside <= value <= max(self.ends) + self.beside


def locate_touch(
    system: System,
    branch: Callable[[float], Patches],
    penetration: float,
    bracket: Bracket,
    tolerances: tuple[float, float],
) -> TouchPoint | None:
    """The touch between two points of a branch; None where Newton does not follow the branch.

    Parameters
    ----------
    system : System
    branch : callable
        Edges near those of the branch at a value of the control.
    penetration : float
        From which load control starts.
    bracket : Bracket
    tolerances : (float, float)
        Of the evaluations that lead to the touch, and of the last.
    """
    first, last = bracket.ends
    crossing = float(np.clip(np.min(bracket.gaps[0] / (bracket.gaps[0] - bracket.gaps[1])), 0.0, 1.0))
    value = first + (last - first) * (crossing * (2 - crossing) if bracket.folds else crossing)
    before: EventNumbers | None = None
    slope = float(bracket.gaps[1].min() - bracket.gaps[0].min()) / (last - first)
    near, patches = bracket.found, branch(value)
    known: list[tuple[float, float]] = []  # of one accuracy: gaps at the ends may be off by what they are apart
    for _ in range(STEPS):
        tolerance = tolerances[int(before is not None)]
        if not patches.is_ordered:
            return None
        corrected = correct(system, patches, penetration, value, Accuracy(tolerance, RESIDUAL * tolerance))
        if corrected.balance is None:  # beyond a fold: halfway back to the branch
            value = (value + (known[-1][0] if known else first)) / 2
            patches = branch(value)
            continue
        here, at = corrected.balance, value
        rate = tangent(system.control, here)
        near = minima_near(gap_field(system.elastic, here.state), near.position, bracket.found.gap)
        depth = float(near.depth.min())
        if known:
            other, there = min(known, key=lambda point: abs(point[0] - value))
            if value != other and abs(depth - there) > DISTINCT[int(before is not None)]:
                slope = (depth - there) / (value - other)
        known.append((value, depth))
        change = -depth / slope
        exact = _at_touch(system, here, value, change)
        if before is not None and abs(depth) <= AT_TOUCH:
            tied = near.depth <= near.depth.min() + TIED
            touching = GapMinima(near.position[tied], np.full(int(tied.sum()), -TOUCHED), near.gap[tied])
            error = exact.apart(before, system.control.force(here.state))
            return TouchPoint(here, exact, error, touching)
        if before is None and abs(depth) <= NEARLY:
            before, known = exact, []
        value += change
        patches = here.state.patches.moved(rate * (value - at))
        if not bracket.reaches(value):
            return None
    return None


def _at_touch(system: System, here: Balance, value: float, change: float) -> EventNumbers:
    """Numbers of the state on the branch a small change of the control away."""
    control = system.control
    deeper = change / (control.penetration_weight + control.load_weight * here.stiffness)
    return EventNumbers(
        value + change,
        here.state.penetration + deeper,
        here.state.load + deeper * here.stiffness,
        here.potential + change * control.force(here.state),
    )
