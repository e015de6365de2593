"""Touch points: where the gap beside a branch of equilibria closes on a crest, located by its own equation.

At a touch an equilibrium leaves a gap of zero at one place y outside contact: with the gradient G of the potential

    G(x, tau) = 0,   gap(y; x, tau) = 0,

and Newton solves both at once, from the cubic in the control that the edges follow between two points of a branch.
What a motion a of the edges does to the gap follows from reciprocity: the gap at y is a load with the weight
f = -log|2 sin((x - y)/2)|/pi, so that like the load itself d gap / d a = K K_f / 2, where K_f are the stress
intensities by heights of the shape f; and these are those of a point charge at y.  They come with the evaluation of the
state, of charges where the gap was least at the step before and a little beside; between them they are linear in y.

Where another gap closes nearly there, steps go on until the first of them is known; gaps that vanish to within `TIED`
touch together.  The last two states are evaluated at different accuracies; by how much the touch moved is its error.
Source of the derivative: Rice, Int. J. Solids Struct. 21 (1985) 781.  Dimensionless.  Limits: the branch reaches
beyond the touch, as it does until contact forms.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bem.adhesive.branch import tangent
from bem.adhesive.equilibrium import Balance, System, balance
from bem.continuation.softness import LONGEST_STEP, after_step
from bem.elastic.gap import GapMinima, gap_field, minima_near
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.path_events import EventNumbers

STEPS = 20
SHORT = 1e-3  # of the edge scale: a step after which the last evaluation comes
CLOSE = 1e-5  # the same: what the last step leaves is below 1e-9
TOUCHED = 1e-10  # of the rms height: a gap that is closed
RIVAL = 1e-4  # the same: gaps this near to the first one may close before it, until
SETTLED = 1e-9  # the same: the last step changes gaps by no more
TIED = 1e-9  # of the rms height: gaps that close together


@dataclass(frozen=True, eq=False)
class TouchPoint:
    """An equilibrium beside which a gap has just closed.

    Attributes
    ----------
    balance : Balance
        Forces next to it.
    exact, error : EventNumbers
        Its numbers, and what the last refinement changed.
    touching : GapMinima
        The crests in contact.
    left : float
        What their gaps are in the state of these forces.
    """

    balance: Balance
    exact: EventNumbers
    error: EventNumbers
    touching: GapMinima
    left: float


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
    """The touch between two points of a branch; None where Newton does not find it.

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
    near, patches, good = bracket.found, branch(value), first
    for _ in range(STEPS):
        if not patches.is_ordered:
            return None
        tolerance = tolerances[int(before is not None)]
        places = near.position, near.position + SHORT * patches.gap_after[near.gap]
        here = if_solvable(balance, probed(system, *places), patches, penetration, value, tolerance)
        if here is None:
            return None
        if not here.all_tensile or here.factor is None:  # beyond a fold: halfway back to the branch
            value = (value + good) / 2
            patches = branch(value)
            continue
        near = minima_near(gap_field(system.elastic, here.state), near.position, bracket.found.gap)
        deepest = int(np.argmin(near.depth))
        share = (near.position[deepest] - places[0][deepest]) / (places[1][deepest] - places[0][deepest])
        outward, change = _step(system, here, deepest, share, float(near.depth[deepest]))
        size = float(np.max(np.abs(outward) / here.state.patches.edge_scale))
        if before is not None and size <= CLOSE and _is_first(near.depth):
            tied = near.depth <= near.depth[deepest] + TIED
            touching = GapMinima(near.position[tied], np.full(int(tied.sum()), -TOUCHED), near.gap[tied])
            exact = after_step(system, here, value, outward, change)
            error = exact.apart(before, system.control.force(here.state))
            return TouchPoint(here, exact, error, touching, float(near.depth[deepest]))
        if before is None and size <= SHORT:
            before = after_step(system, here, value, outward, change)
        part, good = min(1.0, LONGEST_STEP / size), value
        value += part * change
        patches, penetration = here.state.patches.moved(part * outward), here.state.penetration
        if not bracket.reaches(value):
            return None
    return None


def _is_first(depth: FloatArray) -> bool:
    """Whether it is known which of the gaps closes first: one is alone, or they are what they are at the touch."""
    lowest = float(depth.min())
    return abs(lowest) <= SETTLED or int(np.sum(depth <= lowest + RIVAL)) == 1


def probed(system: System, places: FloatArray, beside: FloatArray) -> System:
    """The same, which is asked besides what charges at places outside contact do, and at others beside them."""
    return replace(system, elastic=replace(system.elastic, probes=(*places.tolist(), *beside.tolist())))


def gap_rates(system: System, here: Balance, place: int, share: float) -> tuple[FloatArray, float]:
    """How the gap opens by outward motions of the edges, (2 L,), and by the control; a share of the way from one of the
    places probed to that beside it."""
    state, control = here.state, system.control
    intensity, load = (
        (1 - share) * values[place] + share * values[place + len(values) // 2]
        for values in (state.intensity_by_probes, state.load_by_probes)
    )
    by_edges = state.stress_intensity * intensity / 2
    by_control = (load - 1) * control.rate(state)
    return by_edges - control.load_weight * by_control * here.load_gradient, by_control


def _step(system: System, here: Balance, place: int, share: float, depth: float) -> tuple[FloatArray, float]:
    """Newton step of the edges, (2 L,), and of the control to where the edges rest and a gap vanishes."""
    by_edges, by_control = gap_rates(system, here, place, share)
    back, along = -here.response(here.gradient), tangent(system.control, here)
    change = -(depth + float(by_edges @ back)) / (by_control + float(by_edges @ along))
    return back + change * along, change
