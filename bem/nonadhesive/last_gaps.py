"""Contact without adhesion by its gaps: where they are at K = 0, at a load, a separation or a total displacement.

The mirror of nonadhesive.py for gaps too narrow for it, as the last ones before complete contact are.  Every end does
its own Newton step on K (gap_series.py), outward where K > 0; a gap is cut where it would interpenetrate, dropped when
nothing holds it open, joined to its neighbour when the contact between them is used up, and added where contact is
under tension.  The first gaps are isolated cracks: where the pressure of complete contact at the load has a minimum
-T < 0 with the curvature c, K = 0 at the half width a, with a mean gap s,

    a = 2 sqrt(T / c),   s = c a^4 / 32 = T^2 / (2 c),

exact as a -> 0 (Galin, Contact Problems (2008), chapter 2; the terms left out are of the relative order a^2 and T / c).
A control alpha Delta + beta load is a condition alpha s + 2 pi beta tau = rest on separation and deficit, and a
separation asked for enters as it is, not as a difference of heights.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Literal

import numpy as np

from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.minima import REFINEMENTS
from bem.geometry.patches import TWO_PI
from bem.loading.assessment import Assessment, Quantities
from bem.loading.control import Control
from bem.loading.increments import MAXIMUM_ITERATIONS
from bem.nonadhesive.completed_body import CompletedBody
from bem.nonadhesive.gap_series import GapEvaluation, end_values, evaluate_gaps
from bem.nonadhesive.gaps import Gaps

FINER, EPS = 1.5, float(np.finfo(float).eps)  # nodes of the evaluation that assesses; double precision
UNDERFLOW = 1e-70  # derived: of the lowest pressure of complete contact: tension on gaps whose volume underflows
RESIDUAL = 1e-10  # of |k| over g_0, where rounding does not limit it; Newton's last step leaves 1e-13
UNCERTAIN = 20.0  # roundings of the pressure times the half width, below which k is noise; measured 4
STEP, INTO_CONTACT = 0.5, 0.35  # speed: largest steps of an end, in half widths of its gap and in patches
USED_UP, SHRINKING = 1e-2, 0.1  # of the narrower gap beside: contact narrower, and by how much it shrinks in a step
OVERLAP = 1e-8  # of the largest opening: gaps deeper below zero are cut
POINTS_PER_WAVE = 16  # of the shortest wavelength of q, where tension is looked for
LEAST_POINTS = 64
REFINEMENT_RATIO = 20.0  # of a minimum: bases of 1, 1/20, 1/400 of the distance of points
BEYOND_ROUNDING = 10.0  # roundings of the pressure that are tension
NEW_GAP = 0.3  # largest half width of a new gap, in distances to the next ones


@dataclass(frozen=True)
class Condition:
    """alpha s + 2 pi beta tau = rest: a control next to complete contact.

    Parameters
    ----------
    separation_weight, load_weight, rest : float
        alpha, beta >= 0.
    rounding : float
        Accuracy of `rest`: a small difference of large numbers where it comes from heights and loads.
    """

    separation_weight: float
    load_weight: float
    rest: float
    rounding: float = 0.0

    def reach(self, state: GapEvaluation) -> GapEvaluation:
        """Return the state that meets the condition with the same ends."""
        alpha, beta = self.separation_weight, TWO_PI * self.load_weight
        miss = self.rest - alpha * state.separation - beta * state.deficit
        return state.shifted(miss / (alpha * state.separation_rate + beta))


def condition_of(body: CompletedBody, control: Control, value: float, separation: float | None = None) -> Condition:
    """Return the condition of a control at a value, or of a separation given to full precision."""
    if separation is not None:
        return Condition(1.0, 0.0, separation)
    alpha, beta = control.penetration_weight, control.load_weight
    whole = alpha * body.max_height + beta * TWO_PI * body.lowest
    return Condition(alpha, beta, whole - value, EPS * whole)


@dataclass(frozen=True, eq=False)
class LastGaps:
    """Outcome of `solve_gaps`; `closed` where no gap is left to rounding."""

    status: Literal["converged", "closed", "not_converged", "ill_conditioned"]
    state: GapEvaluation | None
    evaluations: int


def isolated_cracks(body: CompletedBody, condition: Condition) -> tuple[Gaps, float]:
    """Gaps as if each were alone, and the deficit; (0,) gaps where nothing holds any open."""
    x, q = body.minima
    profile = body.pressure
    curvature = np.maximum(profile.curvature(x), 1e-300)
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
    half = np.minimum(2 * np.sqrt(tension[open_] / curvature[open_]), np.pi / (2 * profile.max_order))
    none = Gaps(x[:0], x[:0], x[:0])
    return none.joined(Gaps(x[open_], np.zeros(half.size), half)), deficit


def solve_gaps(body: CompletedBody, condition: Condition, gaps: Gaps, deficit: float) -> LastGaps:
    """Find the gaps at whose ends K = 0.

    Parameters
    ----------
    body : CompletedBody
    condition : Condition
    gaps : Gaps
        Where to start.
    deficit : float
        Where to start under a condition on the separation.
    """
    last = np.inf
    for count in range(1, MAXIMUM_ITERATIONS + 1):
        if gaps.count == 0:  # also where a start was so wrong that nothing of it stayed open
            gaps, deficit = isolated_cracks(body, condition)
        if gaps.count == 0:
            return LastGaps("closed", None, count)
        evaluated = if_solvable(evaluate_gaps, body, gaps, deficit)
        if evaluated is None:
            return LastGaps("ill_conditioned", None, count)
        state = condition.reach(evaluated)
        deficit = state.deficit
        changed = _without_overlap(state)
        if changed is None:
            noise = UNCERTAIN * body.rounding * gaps.half_width
            wanted = np.maximum([RESIDUAL * series[0] for series in state.opening], noise)
            measure = float(np.max(np.abs(state.end_values) / np.tile(wanted, 2)))
            if measure <= 1 and measure > 0.1 * last:
                changed = _with_gaps_under_tension(state)
                if changed is None:
                    return LastGaps("converged", state, count)
            last = measure
        if changed is None:
            steps = _end_steps(state)
            changed = _without_used_up(gaps.moved(steps), steps)
        gaps = changed
    return LastGaps("not_converged", None, MAXIMUM_ITERATIONS)


def assess_gaps(state: GapEvaluation, condition: Condition) -> Assessment:
    """Stiffness and estimated errors of a state at K = 0.

    What more nodes with one more Newton step change, and what rounding of the pressure of complete contact and of the
    control does: it acts like an error of the deficit.

    Parameters
    ----------
    state : GapEvaluation
    condition : Condition
        Where it is.
    """
    fine = condition.reach(evaluate_gaps(state.body, state.gaps, state.deficit, FINER))
    gaps = state.gaps.moved(_end_steps(fine))
    exact = condition.reach(evaluate_gaps(state.body, gaps, state.deficit, FINER))
    stiffness = condition.separation_weight * state.separation_rate + TWO_PI * condition.load_weight
    rounded = state.body.rounding + condition.rounding / stiffness
    with np.errstate(divide="ignore", invalid="ignore"):
        growth = np.where(state.end_slopes > 0, end_values(state.opening_rate) / state.end_slopes, 0.0)
    outward = growth * np.tile(state.gaps.half_width, 2) * (2 / 3) * rounded
    disturbed = state.body, state.gaps.moved(np.minimum(outward, np.tile(state.gaps.half_width, 2)))
    moved = evaluate_gaps(*disturbed, state.deficit + rounded)
    quantities = _quantities(state)
    parts = [_quantities(other).minus(quantities) for other in (exact, moved)]
    correction = Quantities(*(sum(abs(getattr(part, f.name)) for part in parts) for f in fields(Quantities)))
    return Assessment(
        work=None,
        adhesion_energy=0.0,
        min_eigenvalue=None,
        hessian_asymmetry=None,
        stiffness=state.load_rate,
        stable_at_fixed_load=True,
        correction=correction,
    )


def _quantities(state: GapEvaluation) -> Quantities:
    """Return the reported quantities, with contact and penetration of the gaps, whose changes keep their digits."""
    return Quantities(
        penetration=-state.separation,
        load=-TWO_PI * state.deficit,
        contact_length=-2 * float(np.sum(state.gaps.half_width)),
        elastic_energy=-state.work / 2 - TWO_PI * state.mean_pressure * state.separation,
        adhesion_energy=0.0,
        total_energy=-state.work / 2 - TWO_PI * state.mean_pressure * state.separation,
        stress_intensity=float(np.max(state.stress_intensity)),
        stiffness=state.load_rate,
    )


def _end_steps(state: GapEvaluation) -> FloatArray:
    """Outward Newton steps on K, end by end, within half width and contact, (2 G,)."""
    gaps = state.gaps
    half = np.tile(gaps.half_width, 2)
    contact = np.concatenate([gaps.patch_before, gaps.patch_after])
    slope, value = state.end_slopes, state.end_values
    with np.errstate(divide="ignore", invalid="ignore"):
        newton = np.where(slope > 0, value / slope * (2 / 3) * half, np.sign(value) * STEP * half)
    return np.asarray(np.clip(newton, -STEP * half, np.minimum(STEP * half, INTO_CONTACT * contact)))


def _without_used_up(gaps: Gaps, outward: FloatArray) -> Gaps:
    """Gaps of which those are one that leave hardly any contact between them, and ever less."""
    shrinking = outward[gaps.count :] + np.roll(outward[: gaps.count], -1) > SHRINKING * gaps.patch_after
    while gaps.count > 1:
        beside = 2 * np.minimum(gaps.half_width, np.roll(gaps.half_width, -1))
        used_up = np.flatnonzero(shrinking & (gaps.patch_after < USED_UP * beside))
        if used_up.size == 0:
            break
        first, shrinking = int(used_up[0]), np.zeros(gaps.count - 1, dtype=bool)  # one at a time
        kept = np.ones(gaps.count, dtype=bool)
        kept[[first, (first + 1) % gaps.count]] = False
        left, width = gaps.center[first] - gaps.half_width[first], gaps.patch_after[first]
        width += 2 * gaps.half_width[first] + 2 * gaps.half_width[(first + 1) % gaps.count]
        whole = Gaps(np.array([(left + width / 2) % TWO_PI]), np.zeros(1), np.array([width / 2]))
        gaps = gaps.kept(kept).joined(whole)
    return gaps


def _without_overlap(state: GapEvaluation) -> Gaps | None:
    """Gaps cut to where they are open; None where they all are from end to end."""
    gaps, parts, whole = state.gaps, [], np.ones(state.gaps.count, dtype=bool)
    for i, series in enumerate(state.opening):
        n = 4 * series.size
        angle = np.arange(1, n) * (np.pi / n)
        opening = np.sin(np.multiply.outer(angle, np.arange(1, series.size + 1))) @ series
        inside = opening > -OVERLAP * np.max(np.abs(opening))
        if series[0] > 0 and np.all(inside | (np.arange(1, n) < 8) | (np.arange(1, n) > n - 8)):
            continue
        whole[i] = False
        start = np.flatnonzero(inside & ~np.append(False, inside[:-1]))
        stop = np.flatnonzero(inside & ~np.append(inside[1:], False))
        for first, last in zip(start, stop, strict=True):
            if np.max(opening[first : last + 1]) <= 0:
                continue
            right, left = np.cos(first * np.pi / n), np.cos((last + 2) * np.pi / n)
            a = gaps.half_width[i]
            parts.append((gaps.anchor[i], gaps.shift[i] + a * (right + left) / 2, a * (right - left) / 2))
    if np.all(whole):
        return None
    cut = np.array(parts).reshape(-1, 3).T
    return gaps.kept(whole).joined(Gaps(cut[0], cut[1], cut[2]))


def _with_gaps_under_tension(state: GapEvaluation) -> Gaps | None:
    """Gaps with new ones where the contact is under tension; None where it is nowhere.

    Minima between the points are followed by parabolas on ever shorter bases: dips are as shallow as the gaps narrow.
    """
    gaps, body = state.gaps, state.body
    new_gaps: list[tuple[float, float]] = []
    for i, (width, start) in enumerate(zip(gaps.patch_after, gaps.center + gaps.half_width, strict=True)):
        n = LEAST_POINTS + int(POINTS_PER_WAVE * np.pi / 2 * width * body.pressure.max_order / TWO_PI)
        angle = (np.arange(n) + 0.5) * (np.pi / n)
        place = width * np.sin(angle / 2) ** 2
        pressure = state.mean_pressure + body.pressure.height(start + place) + _opened(state, i, place)
        before, here, after = pressure[:-2], pressure[1:-1], pressure[2:]
        low = np.flatnonzero((here <= before) & (here < after) & (3 * here < before + after)) + 1
        if low.size == 0:
            continue
        at, reach = place[low], np.minimum(place[low + 1] - place[low], place[low] - place[low - 1])
        for _ in range(REFINEMENTS):
            points = at + reach * np.array([[-1.0], [0.0], [1.0]])
            flat = points.ravel()
            around = body.pressure.height(start + flat) + _opened(state, i, flat)
            left, middle, right = around.reshape(3, -1)
            bend = np.maximum(left - 2 * middle + right, 1e-300)
            at = at + reach * np.clip((left - right) / (2 * bend), -1.0, 1.0)
            bend, reach = bend / reach**2, reach / REFINEMENT_RATIO
        lowest = body.at_anchor((start + at) % TWO_PI) + body.lowest - state.deficit + _opened(state, i, at)
        for k in np.flatnonzero(lowest < -BEYOND_ROUNDING * body.rounding):
            room = NEW_GAP * min(at[k], width - at[k])
            new_gaps.append((start + at[k], min(2 * float(np.sqrt(-lowest[k] / bend[k])), room)))
    if not new_gaps:
        return None
    x, half = np.array(new_gaps).T
    return gaps.joined(Gaps(x % TWO_PI, np.zeros(x.size), half))


def _opened(state: GapEvaluation, gap: int, place: FloatArray) -> FloatArray:
    """Return the pressure that the openings add in the contact behind a gap, at distances from its end, (n,)."""
    gaps = state.gaps
    x, ahead = gaps.center[gap] + gaps.half_width[gap] + place, gaps.patch_after[gap] - place
    beside = np.where(place < ahead, gap, (gap + 1) % gaps.count)
    return state.pressure_of_opening(x, beside, np.minimum(place, ahead))
