"""Contact without adhesion by its gaps: where they are at K = 0, at a load, a separation or a total displacement.

The mirror of nonadhesive.py for gaps too narrow for it, as the last ones before complete contact are.  Every end does
its own Newton step on K (gap_series.py), outward where K > 0.  A gap is cut where it would interpenetrate, gaps that
touch are one, and a gap is added where contact is under tension.  The first gaps are isolated cracks: where the
pressure of complete contact at the load has a minimum -T < 0 with the curvature c, K = 0 at the half width a, with a
mean gap s,

    a = 2 sqrt(T / c),   s = c a^4 / 32 = T^2 / (2 c),

exact as a -> 0 (Galin, Contact Problems (2008), chapter 2; the terms left out are of the relative order a^2 and T / c).
A separation asked for enters as it is, not as a difference of heights.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.gaps import Gaps, sines
from bem.geometry.patches import TWO_PI
from bem.loading.assessment import Assessment, Quantities
from bem.loading.increments import MAXIMUM_ITERATIONS
from bem.nonadhesive.completed_body import CompletedBody, LinearControl
from bem.nonadhesive.gap_series import GapEvaluation, evaluate_gaps
from bem.nonadhesive.tension import dips

UNDERFLOW = 1e-70  # derived: of the lowest pressure of complete contact: tension on gaps whose volume underflows
INTENSITY_LEFT = 1e-10  # derived: of |k| over g_0, a hundredth of what the certificate demands; Newton leaves 1e-13
TENSION_ROUNDINGS = 8.0  # of the pressure: more is tension, and k more than that times the half width; measured 4
STEP = 0.5  # speed: largest step of an end, in half widths of its gap
OPENING_BELOW_ZERO = 1e-10  # derived: of the largest opening: what the certificate demands


@dataclass(frozen=True, eq=False)
class LastGaps:
    """Outcome of `solve_gaps`; `closed` where no gap is left to rounding."""

    status: Literal["converged", "closed", "not_converged", "ill_conditioned"]
    state: GapEvaluation | None
    evaluations: int


def isolated_cracks(body: CompletedBody, condition: LinearControl) -> Gaps:
    """Return the gaps as if each were alone; (0,) gaps where nothing holds any open."""
    x, q = body.minima
    curvature = np.maximum(body.pressure.curvature(x), 1e-300)
    shallower = q + body.lowest
    alpha, beta = condition.separation_weight, TWO_PI * condition.load_weight

    def excess(deficit: float) -> float:
        """Return the Newton step by which a deficit is too large."""
        tension = np.maximum(deficit - shallower, 0.0)
        miss = alpha * float(np.sum(tension**2 / (2 * curvature))) + beta * deficit - condition.rest
        return miss / (alpha * float(np.sum(tension / curvature)) + beta)

    deficit = condition.rest / beta if alpha == 0 else 0.0
    if alpha > 0 and condition.rest > 0:
        first = int(np.argmin(q))
        deficit = float(np.sqrt(2 * curvature[first] * condition.rest / alpha))
        while (less := excess(deficit)) > 1e-14 * deficit:  # convex: from above, never below the root
            deficit -= less
    tension = deficit - shallower
    open_ = tension > UNDERFLOW * abs(body.lowest)
    return _with_cracks(Gaps(*np.empty((3, 0))), body, x[open_], tension[open_], curvature[open_])


def _with_cracks(gaps: Gaps, body: CompletedBody, x: FloatArray, tension: FloatArray, curvature: FloatArray) -> Gaps:
    """Return gaps and isolated cracks, none wider than half the shortest wave."""
    half = np.minimum(2 * np.sqrt(tension / curvature), np.pi / (2 * body.pressure.max_order))
    return gaps.joined(Gaps(x % TWO_PI, np.zeros(x.size), half))


def solve_gaps(body: CompletedBody, condition: LinearControl, gaps: Gaps) -> LastGaps:
    """Find the gaps at whose ends K = 0, from where they may be."""
    last = np.inf
    for count in range(1, MAXIMUM_ITERATIONS + 1):
        if gaps.count == 0:  # also where a start was so wrong that nothing of it stayed open
            gaps = isolated_cracks(body, condition)
        if gaps.count == 0:
            return LastGaps("closed", None, count)
        state = if_solvable(evaluate_gaps, body, gaps, condition)
        if state is None:
            return LastGaps("ill_conditioned", None, count)
        changed = _without_overlap(state)
        if changed is None:
            noise = TENSION_ROUNDINGS * body.rounding * gaps.half_width
            wanted = np.maximum([INTENSITY_LEFT * series[0] for series in state.opening], noise)
            measure = float(np.max(np.abs(state.end_values) / np.tile(wanted, 2)))
            if 1 >= measure > 0.1 * last:
                changed = _with_gaps_under_tension(state)
                if changed is None:
                    return LastGaps("converged", state, count)
            last = measure
        gaps = gaps.moved(_end_steps(state)).united() if changed is None else changed
    return LastGaps("not_converged", None, MAXIMUM_ITERATIONS)


def assess_gaps(state: GapEvaluation, condition: LinearControl) -> Assessment:
    """Return stiffness and estimated errors of a state at K = 0, where its condition holds.

    The errors are what more nodes with one more Newton step change, and what rounding of the pressure of complete
    contact and of the control does: it acts like an error of the deficit.
    """
    exact = _after_step(state, condition, finer=True)
    rounded = state.body.rounding + condition.rounding / condition.rate(state.separation_rate)
    moved = _after_step(state, LinearControl(0.0, 1.0, TWO_PI * (state.deficit + rounded)))
    quantities = _quantities(state)
    parts = [_quantities(other).minus(quantities) for other in (exact, moved)]
    return Assessment(
        work=None,
        adhesion_energy=0.0,
        min_eigenvalue=None,
        hessian_asymmetry=None,
        stiffness=state.load_rate,
        stable_at_fixed_load=True,
        correction=parts[0].widened(parts[1]),
    )


def _after_step(state: GapEvaluation, condition: LinearControl, finer: bool = False) -> GapEvaluation:
    """Return the state under a condition after one Newton step of the ends."""
    steps = _end_steps(evaluate_gaps(state.body, state.gaps, condition, finer))
    return evaluate_gaps(state.body, state.gaps.moved(steps), condition, finer)


def _quantities(state: GapEvaluation) -> Quantities:
    """Return the reported quantities, with contact and penetration of the gaps, whose changes keep their digits."""
    return Quantities(
        penetration=-state.separation,
        load=-TWO_PI * state.deficit,
        contact_length=-2 * float(np.sum(state.gaps.half_width)),
        elastic_energy=-state.released_energy,
        adhesion_energy=0.0,
        total_energy=-state.released_energy,
        stress_intensity=float(np.max(state.stress_intensity)),
        stiffness=state.load_rate,
    )


def _end_steps(state: GapEvaluation) -> FloatArray:
    """Return outward Newton steps on K, end by end, within half the half width, (2 G,)."""
    half, slope, value = np.tile(state.gaps.half_width, 2), state.end_slopes, state.end_values
    with np.errstate(divide="ignore", invalid="ignore"):
        newton = np.where(slope > 0, value / slope * (2 / 3), np.sign(value) * STEP)
    return np.asarray(np.clip(newton, -STEP, STEP) * half)


def _without_overlap(state: GapEvaluation) -> Gaps | None:
    """Return the gaps cut to where they are open; None where they all are, but for eight of 4 n points at each end."""
    gaps, parts, whole = state.gaps, [], np.ones(state.gaps.count, dtype=bool)
    for i, series in enumerate(state.opening):
        n = 4 * series.size
        angle = np.asarray(np.arange(n + 1) * (np.pi / n), dtype=np.float64)
        opening = sines(series, angle)
        inside = opening > -OPENING_BELOW_ZERO * np.max(np.abs(opening))
        if series[0] > 0 and np.all(inside[8:-8]):
            continue
        whole[i], inside[[0, -1]] = False, False
        bounds = np.flatnonzero(inside[1:] != inside[:-1])
        for first, last in bounds.reshape(-1, 2):
            if np.max(opening[first + 1 : last + 1]) > 0:
                right, left = np.cos(angle[[first, last + 1]])
                a = gaps.half_width[i]
                parts.append((gaps.anchor[i], gaps.shift[i] + a * (right + left) / 2, a * (right - left) / 2))
    return None if np.all(whole) else gaps.kept(whole).joined(Gaps(*np.reshape(parts, (-1, 3)).T))


def _with_gaps_under_tension(state: GapEvaluation) -> Gaps | None:
    """Return the gaps with new ones where the contact is under tension; None where it is nowhere.

    Dips of the series tell where; there the pressure is summed to its last digits, as a dip is as shallow as its gap is
    narrow.
    """
    gaps, body, cracks = state.gaps, state.body, []
    for patch, dip in dips(state.pressure()).items():
        gap = state.gap_before[patch]
        angle, r = np.arccos(-dip.position), gaps.patch_after[gap] / 2
        x = gaps.center[gap] + gaps.half_width[gap] + r * (1 + dip.position)
        tension = state.deficit - body.at_anchor(x % TWO_PI) - body.lowest - state.added(gap, angle)
        under_tension = tension > TENSION_ROUNDINGS * body.rounding
        cracks.append(np.array([x, tension, dip.curvature / (r**3 * np.sin(angle))])[:, under_tension])
    sites = np.hstack([np.empty((3, 0)), *cracks])
    return _with_cracks(gaps, body, *sites) if sites.size else None
