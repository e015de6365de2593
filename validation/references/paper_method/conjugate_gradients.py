"""Conjugate gradients of Polak and Ribiere on the edges: the nearest minimum of the energy.

Each edge moves in units of the square root of its edge scale, the lesser of its patch and its gap at the start, in
which the energy curves about alike in all directions (dG/da ~ w / edge scale).  With the gradient g of the energy in
these variables,

    d <- -g + max(0, g.(g - g_before) / g_before.g_before) d,

and along d the zero of g.d is looked for by the secant method, each trial costing one pressure.  The energy does not
know the sign of K: edges that close at the start (K < 0) first move outward until none does, a trial at which one
closes has gone too far, and where even short ones do the edge is opened and the descent starts anew.  A trial never
takes an edge farther than a third of its edge scale.  The descent ends when |G/w - 1| is below what is allowed at every
edge, or when a patch or a gap has all but vanished, which is then for the caller to decide.

Source: E. Polak, G. Ribiere, Rev. Fr. Inform. Rech. Oper. 3-R1 (1969) 35.  Limits: adhesion is needed, without it the
energy is flat where it is least.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from validation.harness.arrays import FloatArray, IntArray
from validation.references.paper_method.cells import graded
from validation.references.paper_method.energy import Energy, energy
from validation.references.paper_method.surface import Surface

ITERATIONS = 400
TRIALS = 12  # of the secant method along a direction
LEVEL = 0.1  # of the slope at the start, below which a point along a direction will do
FARTHEST = 0.3  # of its edge scale that an edge may travel along one direction
OPENINGS = 60  # steps in which edges that close at the start move outward
OUTWARD = 0.15  # of their edge scale in each
NEAREST = 0.2  # of the step expected: an edge that closes even there is opened first
VANISHED = 0.02  # of its size at the start: a patch or gap that is gone
FIRST_STEP = 0.05  # of its edge scale that the edge pulled most moves in the first trial
OUT = np.array([-1.0, 1.0])  # outward at the left and the right edge
PRECISION = 1e-3  # of the residual allowed: that of the pressure, of which a small patch feels many times as much

End = Literal["closed", "vanished", "not_converged"]


@dataclass(frozen=True, eq=False)
class Descent:
    """State at the end of a descent, the reason of the end, and the cost."""

    end: End
    state: Energy
    residual: float
    evaluations: int
    sweeps: int
    edge_scale: FloatArray


def edge_scale_of(edges: FloatArray) -> FloatArray:
    """Return the lesser of patch width and adjacent gap of each edge, (L, 2)."""
    width = np.diff(edges, axis=1)[:, 0]
    behind = np.append(edges[1:, 0], edges[0, 0] + 2 * np.pi) - edges[:, 1]
    return np.stack([np.minimum(width, np.roll(behind, 1)), np.minimum(width, behind)], axis=1)


def descend(
    surface: Surface, edges: FloatArray, counts: IntArray, penetration: float, allowed_residual: float
) -> Descent:
    """Minimise the energy over the edges, starting from `edges` (L, 2), with fixed numbers of cells, (L,)."""
    edge_scale = edge_scale_of(edges)
    unit = np.sqrt(edge_scale)
    pressures = _Pressures(surface, counts, penetration, PRECISION * allowed_residual)
    state = pressures.opened(pressures.at(edges, None))
    direction, before, scale = np.zeros_like(edge_scale), None, np.nan
    for _ in range(ITERATIONS):
        residual = _residual(surface, state)
        if residual < allowed_residual:
            return Descent("closed", state, residual, pressures.evaluations, pressures.sweeps, edge_scale)
        if np.any(edge_scale_of(state.cells.edges) < VANISHED * edge_scale):
            return Descent("vanished", state, residual, pressures.evaluations, pressures.sweeps, edge_scale)
        gradient = state.outward * unit
        turn = 0.0 if before is None else max(0.0, float(np.sum(gradient * (gradient - before)) / np.sum(before**2)))
        direction = turn * direction - gradient
        slope = float(np.sum(gradient * direction))
        if slope >= 0:
            direction, slope = -gradient, -float(np.sum(gradient**2))
        if np.isnan(scale):
            scale = -slope * FIRST_STEP / float(np.max(np.abs(direction * unit) / edge_scale))
        step, trial = _along(pressures, state, direction * unit, slope, scale / -slope)
        if np.any(trial.closing):
            state, before, scale = pressures.opened(trial), None, np.nan
        else:
            state, before, scale = trial, gradient, -slope * step
    return Descent(
        "not_converged", state, _residual(surface, state), pressures.evaluations, pressures.sweeps, edge_scale
    )


class _Pressures:
    """Energies of given edges, counted."""

    def __init__(self, surface: Surface, counts: IntArray, penetration: float, precision: float) -> None:
        self.surface, self.counts, self.penetration, self.precision = surface, counts, penetration, precision
        self.evaluations, self.sweeps = 0, 0

    def at(self, edges: FloatArray, near: Energy | None) -> Energy:
        """Return the energy at edges; Gauss-Seidel starts from the charges of a state near by."""
        start = None if near is None else near.charges
        state = energy(self.surface, graded(edges, self.counts), self.penetration, self.precision, start)
        self.evaluations, self.sweeps = self.evaluations + 1, self.sweeps + state.sweeps
        return state

    def opened(self, state: Energy) -> Energy:
        """Move edges that close (K < 0) outward until none closes, and return the state."""
        for _ in range(OPENINGS):
            if not np.any(state.closing):
                break
            edges = state.cells.edges
            state = self.at(edges + OUTWARD * state.closing * edge_scale_of(edges) * OUT, state)
        return state


def _along(
    pressures: _Pressures, state: Energy, motion: FloatArray, slope: float, guess: float
) -> tuple[float, Energy]:
    """Find step and state at which the slope along a motion of the edges (L, 2, outward) has nearly vanished.

    A state with a closing edge is returned only if every trial has a closing edge.
    """
    edges = state.cells.edges
    longest = FARTHEST / float(np.max(np.abs(motion) / edge_scale_of(edges)))
    low, at_low, high, at_high = 0.0, slope, np.nan, np.nan
    step, trial = min(guess, longest), state
    best: tuple[float, Energy] | None = None
    for _ in range(TRIALS):
        trial = pressures.at(edges + step * motion * OUT, trial)
        trial_slope = float(np.sum(trial.outward * motion))
        if np.any(trial.closing):
            if best is None and step < NEAREST * guess:
                return step, trial
            high, at_high = step, np.nan
            step = _between(low, at_low, high, at_high)
            continue
        best = step, trial
        if abs(trial_slope) <= LEVEL * abs(slope) or (trial_slope < 0 and step >= longest):
            break
        if trial_slope < 0:
            secant = step + (step - low) * trial_slope / (at_low - trial_slope) if at_low < trial_slope else 2 * step
            low, at_low = step, trial_slope
            step = min(secant, 4 * step, longest) if np.isnan(high) else _between(low, at_low, high, at_high)
        else:
            high, at_high = step, trial_slope
            step = _between(low, at_low, high, at_high)
    return (step, trial) if best is None else best


def _between(low: float, at_low: float, high: float, at_high: float) -> float:
    """Return the secant step between two points, not too near either; their middle if `at_high` is NaN."""
    share = 0.5 if np.isnan(at_high) else float(np.clip(at_low / (at_low - at_high), 0.05, 0.95))
    return low + (high - low) * share


def _residual(surface: Surface, state: Energy) -> float:
    """Return max |G/w - 1| over the edges."""
    return float(np.max(np.abs(state.outward) / (surface.work * surface.adhesive_length(state.cells.edges))))
