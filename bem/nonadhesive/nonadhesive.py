"""Contact without adhesion: edges at which the pressure vanishes, K = 0, for any control.

At K = 0 the energy is stationary to second order and its Hessian vanishes, so nothing is minimised: Newton acts
on K itself, whose Jacobian is diagonal at the solution, so that every edge does its own Newton step, outward where
K < 0 (pressure piles up at the edge) and inward where K > 0 (the edge is in tension).  A patch is split where its
pressure is tensile inside, dropped when it carries no load, joined to its neighbour when the gap between them is
used up, and added where a gap interpenetrates.  The contact problem is convex (Signorini): the solution is unique and
independent of the path, and p >= 0, gap >= 0, K = 0 certify it.  Dimensionless.

Source: Galin, Contact Problems (2008), chapter 2, for the edge condition; Kalker, Three-Dimensional Elastic Bodies in
Rolling Contact (1990), section 3.2, for uniqueness.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bem.elastic.collocation import ROUNDINGS, Elastic, Evaluation, evaluate
from bem.elastic.gap import gap_field, low_minima
from bem.elastic.hierarchical import IllConditionedSystemError, if_solvable
from bem.elastic.sensitivities import own_sensitivity
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import CHARGE_ROUNDING, SHUT_GAP, TWO_PI, Patches, PatchPressure, ordered
from bem.loading.control import Control
from bem.loading.increments import MAXIMUM_ITERATIONS, Accuracy
from bem.nonadhesive.tension import dips, nodes, under_tension

# The contact is unique: what only shapes the way to it is a matter of cost, measured by halving and doubling.
INWARD, OUTWARD, INTO_GAP = 0.3, 1.0, 0.35  # speed: largest steps of an edge, in patch widths and gaps; work +0.8 %
UNTIL_NEAR, UNTIL_CLOSE = 1e-2, 1e-4  # speed: accuracies until the edges are near, and close; work -1 to +5 %
NEAR_RESIDUAL, CLOSE_RESIDUAL = 0.3, 4e-3  # speed: residuals that mean near and close; work +2 and +3 % if halved
CLOSED_GAP = 1e-4  # of the shortest wavelength, or its square root of the narrower neighbour
COARSELY_CLOSED = 1e-3  # speed: the same until the edges are close; what it closes too early is opened then
LEFT_OVER = 0.01  # of the residual and the contact: what the edges may still have to move, for invariances to 1e-10
CREST_ROUNDING = 10 * CHARGE_ROUNDING  # of the highest crest: charges are known no better, with a margin
DAMPED_AFTER = 15  # speed: steps of the same patches after which a change of sign of K halves the step of its edge
PENDING_STEPS = 10.0  # speed: Newton steps beside an edge with K < 0 in which the surfaces overlap until it has moved

CLOSING_MODES = 4000  # limit: of a patch: a gap beside it that asks for more counts as closed
DOUBTFUL = 0.1 * CLOSED_GAP**2  # of the mean pressure of a patch: a tenth of the tension that a closed gap leaves

ContactStatus = Literal["converged", "separated", "complete_contact", "narrow_gaps", "not_converged", "ill_conditioned"]


@dataclass(frozen=True, eq=False)
class Contact:
    """Outcome of `solve_contact`: the state when converged, and the number of evaluations.

    With `narrow_gaps` there may be gaps too narrow for unknowns on patches; `patches` are those around the wider ones.
    """

    status: ContactStatus
    state: Evaluation | None
    residual: float
    evaluations: int
    patches: Patches | None = None


def edge_residual(state: Evaluation) -> float:
    """Largest |K| sqrt(r/pi) relative to the load of its patch: the singular part over the mean charge."""
    return float(np.max(np.abs(state.stress_intensity) / _mean_intensity(state)))


def _mean_intensity(state: Evaluation) -> FloatArray:
    """|K| of flat punches that carry the loads of the patches, (2 L,)."""
    starts = np.concatenate([[0], np.cumsum(state.resolution.modes)[:-1]])
    mean = np.abs(np.add.reduceat(state.skeleton, starts)) / np.pi
    return np.tile(np.maximum(mean, 1e-300) * np.sqrt(np.pi / state.patches.half_width), 2)


def _closed(state: Evaluation, control: Control, limit: float) -> bool:
    """Return True if |K| and the remaining Newton steps, as contact fraction, are below the limit or rounding.

    The steps count because a gap that closes has hardly any K left.
    """
    rounding = state.rounding(control.penetration_rate(state))
    return _is_small(state, control, limit) and _remaining(state, rounding) <= TWO_PI * limit


def _is_small(state: Evaluation, control: Control, limit: float) -> bool:
    """Return True if |K| relative to the load of its patch is below the limit or rounding."""
    rounding = ROUNDINGS * state.rounding(control.penetration_rate(state))
    return bool(np.all(np.abs(state.stress_intensity) <= np.maximum(limit * _mean_intensity(state), rounding)))


def _remaining(state: Evaluation, rounding: FloatArray | float = 0.0) -> float:
    """Sum of the Newton steps still to be made, where K exceeds its rounding.

    The bound of rounding is generous on thin layers: what it excuses is still done as long as the steps shrink.
    """
    slope = np.maximum(np.abs(own_sensitivity(state)), 1e-300)
    return float(np.sum(np.maximum(np.abs(state.stress_intensity) - rounding, 0.0) / slope))


def solve_contact(
    elastic: Elastic, control: Control, patches: Patches, penetration: float, target: float, accuracy: Accuracy
) -> Contact:
    """Find the patches on which K = 0 at the target.

    1. Evaluate the state of the patches, coarsely until the edges are near.
    2. Where K vanishes: open gaps and add contacts that are missing; with none missing, the contact is found.
    3. Else every edge makes its Newton step, patches are split where they are in tension, and joined where gaps close.

    Parameters
    ----------
    elastic, control
        As for an equilibrium.
    patches : Patches
        Where to start; any patches that cover some contact will do.
    penetration, target : float
        Start of Delta under load control, and value of the control.
    accuracy : Accuracy
        Bounds at which the search ends: `tolerance` of each pressure field; `residual` of |K| at the edges over K of a
        flat punch, and of the last change of the contact fraction, where rounding allows it.

    Raises
    ------
    IllConditionedSystemError
        A contact, or the gap between two, has no width in double precision.
    """
    search = _Search(elastic, control, target, accuracy, patches, penetration)
    rounded = CREST_ROUNDING * elastic.profile.max_height
    for count in range(1, MAXIMUM_ITERATIONS + 1):
        state = if_solvable(search.evaluated)
        if state is None:
            return Contact("ill_conditioned", None, search.measure, count)
        pressure = state.pressure()
        tensile = under_tension(pressure, rounded)
        changed: Patches | None = None
        coarseness = search.coarseness
        if not tensile and search.is_closed(state):
            changed, doubtful = search.mended(state, pressure)
            if changed is None and search.is_at_rest(state):
                return Contact("narrow_gaps" if doubtful else "converged", state, search.measure, count, search.patches)
        if changed is None:
            changed, coarseness = search.moved(state, pressure, tensile)
        if changed is None:
            return Contact("complete_contact", None, 0.0, count)
        if changed.count == 0:
            return Contact("separated", None, 0.0, count)
        if not changed.is_ordered:
            raise IllConditionedSystemError("a contact is narrower than double precision tells positions apart")
        search.stand_at(changed, coarseness)
    return Contact("not_converged", state, search.measure, MAXIMUM_ITERATIONS)


@dataclass(eq=False)
class _Search:
    """Progress of a solution: patches, coarseness of the evaluation, damping of the edges, gaps opened so far."""

    elastic: Elastic
    control: Control
    target: float
    accuracy: Accuracy
    patches: Patches
    penetration: float
    coarseness: float = UNTIL_NEAR
    closed_gap: float = COARSELY_CLOSED
    measure: float = np.inf
    remaining: float = np.inf

    def __post_init__(self) -> None:
        self._undamped()

    def _undamped(self) -> None:
        """Forget the signs that K had at edges that are others now."""
        edges = 2 * self.patches.count
        self.damping, self.last_sign, self.steps = np.ones(edges), np.zeros(edges), 0

    @property
    def tolerance(self) -> float:
        """Tolerance of the next evaluation."""
        return max(self.accuracy.tolerance, self.coarseness)

    def evaluated(self) -> Evaluation:
        """Evaluate the patches at the target."""
        at = self.control.guess(self.penetration, self.target)
        evaluation = evaluate(
            self.elastic, self.patches, at, self.tolerance, with_compliance=self.elastic.kernel is not None
        )
        state = self.control.reach(evaluation, self.target)
        self.penetration, self.measure = state.penetration, edge_residual(state)
        return state

    def is_closed(self, state: Evaluation) -> bool:
        """Return True if K vanishes in an evaluation as fine as wanted."""
        return self.coarseness <= self.accuracy.tolerance and _closed(state, self.control, self.accuracy.residual)

    def mended(self, state: Evaluation, pressure: PatchPressure) -> tuple[Patches | None, bool]:
        """Patches with gaps and contacts that are missing (None: nothing is), and whether gaps may be left over."""
        opened, doubtful = _gaps_under_tension(self.elastic, pressure, self.accuracy.tolerance)
        touching = _overlapping_crests(self.elastic, state, self.accuracy.allowed)
        if opened.size == 0 and touching.size == 0:
            return None, doubtful
        left = np.concatenate([state.patches.left, opened[:, 1], touching[:, 0]])
        right = np.concatenate([state.patches.right, opened[:, 0], touching[:, 1]])
        return _between(left, right), doubtful

    def is_at_rest(self, state: Evaluation) -> bool:
        """Return True if the remaining steps are negligible, or shrink no more."""
        before, self.remaining = self.remaining, _remaining(state)
        negligible = LEFT_OVER * self.accuracy.residual * np.sum(self.patches.width)
        return bool(self.remaining <= negligible or self.remaining > 0.5 * before)

    def moved(
        self, state: Evaluation, pressure: PatchPressure, tensile: dict[int, list[tuple[int, int]]]
    ) -> tuple[Patches | None, float]:
        """Patches after a Newton step of each edge (None: no gap is left), and how coarse the next evaluation is."""
        sign = np.sign(state.stress_intensity)
        if self.steps >= DAMPED_AFTER:
            self.damping = np.where(sign * self.last_sign < 0, self.damping / 2, np.minimum(1.0, self.damping * 1.5))
        self.last_sign = sign
        moved = self.patches.moved(self.damping * _edge_steps(state, self.elastic.profile.max_order))
        changed = _joined(
            self.elastic, _split(self.patches, moved, pressure, tensile), self.closed_gap, self.accuracy.tolerance
        )
        if not tensile and self.coarseness > UNTIL_CLOSE and _is_small(state, self.control, NEAR_RESIDUAL):
            return changed, UNTIL_CLOSE
        wanted = self.accuracy.tolerance
        if not tensile and wanted < self.coarseness <= UNTIL_CLOSE and _is_small(state, self.control, CLOSE_RESIDUAL):
            self.closed_gap = CLOSED_GAP
            return changed, wanted
        return changed, self.coarseness

    def stand_at(self, patches: Patches, coarseness: float) -> None:
        """Go on from other patches."""
        known = patches.count == self.patches.count and coarseness == self.coarseness
        self.patches, self.coarseness = patches, coarseness
        self.steps += 1
        if not known:
            self._undamped()


def _edge_steps(state: Evaluation, max_order: int) -> FloatArray:
    """Outward Newton steps on K, edge by edge, within patch width, gap and shortest wavelength, (2 L,)."""
    patches = state.patches
    slope = own_sensitivity(state)
    gap = np.concatenate([patches.gap_before, patches.gap_after])
    width = np.tile(patches.width, 2)
    half_wave = np.pi / max_order
    outward = np.minimum(np.minimum(OUTWARD * width, half_wave), INTO_GAP * gap)
    intensity = state.stress_intensity
    with np.errstate(divide="ignore", invalid="ignore"):
        newton = np.where(slope > 0, -intensity / slope, -np.sign(intensity) * INWARD * np.minimum(width, gap))
    return np.asarray(np.clip(newton, -INWARD * width, outward))


def _joined(elastic: Elastic, patches: Patches, closed_gap: float, tolerance: float) -> Patches | None:
    """Patches whose gaps are used up become one; None when nothing of the last gap is left."""
    closed = patches.gap_after < _least_gap(elastic, patches.width, np.roll(patches.width, -1), closed_gap, tolerance)
    if np.all(closed):
        closed[np.argmax(patches.gap_after)] = False
        patches = patches.merged_at(closed)
        return None if patches.gap_after[0] < SHUT_GAP * TWO_PI else patches
    return patches.merged_at(closed)


def _least_gap(
    elastic: Elastic, before: FloatArray, behind: FloatArray, closed_gap: float, tolerance: float
) -> FloatArray:
    """Gaps that count as closed between patches of these widths; the modes beside them are `coupling_modes`.

    What a closed gap changes is of second order in its width over that of the narrower patch: `closed_gap` at most.
    """
    narrower, wider = np.minimum(before, behind), np.maximum(before, behind)
    resolved = wider * (np.log(tolerance) / (2 * CLOSING_MODES)) ** 2
    closed = np.minimum(closed_gap * (TWO_PI / elastic.profile.max_order), np.sqrt(closed_gap) * narrower)
    return np.asarray(np.maximum(closed, resolved))


def _gaps_under_tension(elastic: Elastic, pressure: PatchPressure, tolerance: float) -> tuple[FloatArray, bool]:
    """Gaps where the pressure inside patches dips below zero, (n, 2); whether there may be others, too narrow to open.

    A gap 2g wide that is taken for contact leaves a parabola of tension sqrt 2 g wide (Galin, chapter 2).
    """
    opened: list[tuple[float, float]] = []
    doubtful = False
    for i, low in dips(pressure).items():
        first, last, charge = pressure.left[i], pressure.right[i], pressure.charges[i]
        for k in np.argsort(low.value).tolist():
            at, value, bend = low.position[k], low.value[k], low.curvature[k]
            if not (value < DOUBTFUL * abs(float(charge[0])) and bend > 0):
                break
            middle = (first + last) / 2 + (last - first) / 2 * at
            half = (last - first) / 2 * float(np.sqrt(max(-4 * value / bend, 0.0)))
            room = min([middle - first, last - middle, *(max(a - middle, middle - b) for a, b in opened)])
            least = _least_gap(elastic, middle - first, last - middle, CLOSED_GAP, tolerance)
            if 2 * half > least and half < 0.5 * room:
                opened.append((middle - half, middle + half))
            else:
                doubtful = True
    return np.array(opened).reshape(-1, 2), doubtful


def _between(left: FloatArray, right: FloatArray) -> Patches:
    """Patches that begin and end at these edges, each end belonging to the start before it."""
    starts, stops = np.sort(left), np.sort(right)
    return ordered(starts, stops)


def _split(
    patches: Patches, moved: Patches, pressure: PatchPressure, tensile: dict[int, list[tuple[int, int]]]
) -> Patches:
    """Return moved patches, with their tensile parts cut out; the ends of patches under tension only move outward."""
    if not tensile:
        return moved
    pressed = np.array([i not in tensile for i in range(patches.count)])
    left, right = moved.left[pressed].tolist(), moved.right[pressed].tolist()
    for i, parts in tensile.items():
        x = patches.center[i] + patches.half_width[i] * nodes(pressure.charges[i])
        middle = (x[1:] + x[:-1]) / 2
        for first, last in parts:
            left.append(min(patches.left[i], moved.left[i]) if first == 0 else middle[first - 1])
            right.append(max(patches.right[i], moved.right[i]) if last == x.size - 1 else middle[last])
    return ordered(np.array(left), np.array(right))


def _overlapping_crests(elastic: Elastic, state: Evaluation, allowed: float) -> FloatArray:
    """Contacts where surfaces overlap in the gaps, left and right edges, (n, 2).

    Beside an edge with K < 0 the surfaces overlap until it has moved: no contact of its own.
    """
    low = low_minima(gap_field(elastic, state))
    patches = state.patches
    slope = own_sensitivity(state)
    with np.errstate(divide="ignore", invalid="ignore"):
        pending = np.where(state.stress_intensity < 0, -state.stress_intensity / np.maximum(slope, 0.0), 0.0)
    behind = low.position - patches.right[low.gap]
    ahead = patches.gap_after[low.gap] - behind
    following = (low.gap + 1) % patches.count
    overlap_behind, overlap_ahead = PENDING_STEPS * pending[patches.count + low.gap], PENDING_STEPS * pending[following]
    bad = (low.depth < -allowed) & (behind > overlap_behind) & (ahead > overlap_ahead)
    gap, position, depth = low.gap[bad], low.position[bad], low.depth[bad]
    order = np.lexsort((position, gap))
    gap, position, depth = gap[order], position[order], depth[order]
    apart = np.where(np.diff(gap) == 0, np.diff(position), np.inf)
    neighbour = np.minimum(np.append(np.inf, apart), np.append(apart, np.inf))
    room = np.minimum(np.minimum(behind[bad], ahead[bad])[order], neighbour)
    curvature = np.maximum(-elastic.profile.curvature(position), 1e-12)
    half = np.minimum(np.sqrt(-2 * depth / curvature), 0.3 * room)
    return np.stack([position - half, position + half], axis=1)
