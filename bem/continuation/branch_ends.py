"""Where a branch ends at a limit point: is it of this branch, and does a crest touch before?

Newton finds limit points (limit_points.py), of this branch or of another: it may step over a short unstable stretch,
or lead back to the fold from which the contact has just jumped.  Along one branch edges move as their tangents say, and
the potential changes by the work of the control.  What coarse evaluations leave undecided the accuracy of targets
decides.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bem.adhesive.branch import UNBOOKED, Missing, missing_energy, outward_motion, passes_crest, strays
from bem.adhesive.equilibrium import Balance, System, balance, correct, energy_noise
from bem.adhesive.relaxation import interpenetration
from bem.adhesive.third_derivatives import with_slopes
from bem.continuation.foretold_folds import foretell_folds
from bem.continuation.limit_points import LimitPoint, Search, UndecidedError, before_fold, locate_limit_point
from bem.continuation.points_with_edges import Equilibrium, equilibrium
from bem.continuation.softness import NEAR, Soft
from bem.elastic.collocation import Evaluation
from bem.elastic.gap import GapMinima
from bem.elastic.hierarchical import if_solvable
from bem.loading.increments import Increments

FINE = 1e-5  # tolerance of the first of the two evaluations that give an event its numbers
FINER = 0.3  # of FINE at limit points, where a neutral mode magnifies what is missing: the second then suffices oftener
DEEP = 0.3  # of what a coarse fold may be off by: depth of gaps beside it that surely are closed; errors seen: 0.16
HALFWAY = 10.0  # times the residual between targets, of points halfway to a fold from points that are more accurate
OFF = 8.0  # times the tolerance between targets, of the value: reach beyond coarse states; half behind them, seen: 2.8


@dataclass(frozen=True, eq=False)
class TouchedFold:
    """A fold beside which crests have touched, with the evaluation next to it: their touch ends the branch."""

    value: float
    state: Evaluation
    found: GapMinima


@dataclass(frozen=True, eq=False)
class BranchEnds:
    """Finds the limit points at which branches end.

    Parameters
    ----------
    system : System
    increments : Increments
    """

    system: System
    increments: Increments

    @property
    def fine(self) -> tuple[float, float]:
        """Tolerances of the two evaluations that give an event its numbers."""
        finest = self.increments.fine.tolerance
        return max(min(FINE, self.increments.coarse.tolerance), finest), finest

    def limit_point(self, point: Equilibrium, reach: float, thorough: bool) -> LimitPoint | TouchedFold | None:
        """The limit point that ends the branch of a point within about `reach` of the control, if there is one.

        A fold beside which crests have touched is not located any better: the branch ends before.
        """
        coarse, (fine, finest) = self.increments.coarse.tolerance, self.fine
        fine = max(FINER * fine, finest)
        surely = max(coarse, NEAR) * (1.0 if thorough else DEEP)
        touched: list[TouchedFold] = []

        def is_touched(here: Balance, value: float, allowed: float = surely) -> bool:
            found = interpenetration(self.system, here.state, allowed)
            touched.extend([TouchedFold(value, here.state, found)] if found.position.size else [])
            return bool(touched)

        limit = self._located(point, Search(reach, (coarse, fine, finest), thorough, is_touched))
        if limit is None and thorough and not touched:  # coarse states may end farther from it than `reach`
            near = float(np.copysign(max(self.increments.smallest, OFF * coarse * abs(point.value)), reach))
            limit = self._located(self._settled(point), Search(near, (fine, fine, finest), thorough, is_touched))
        if limit is None:
            return touched[0] if touched else None
        if is_touched(limit.balance, limit.exact.value, self.increments.fine.allowed):
            return touched[0] if limit.kind == "fold" else None
        return limit

    def foretold(self, point: Equilibrium, reach: float) -> float:
        """How far ahead of a point its branch is expected to end; inf where it is not.  `reach` has the direction."""
        here = if_solvable(with_slopes, self.system, point.balance, point.value, self.increments.coarse.tolerance)
        if here is None:
            return np.inf
        try:
            expected = foretell_folds(self.system, Soft(self.system, here, point.value, here.scale), reach)
        except np.linalg.LinAlgError:
            return np.inf
        return np.inf if expected is None else expected.distance

    def _located(self, point: Equilibrium, search: Search) -> LimitPoint | None:
        """The limit point that a search from a point finds, unless that ends another branch.

        Newton may lead back to the fold from which the contact has just jumped: its potential is higher by what the
        jump released, and no work of the control accounts for that.
        """
        start = point
        try:
            limit = locate_limit_point(self.system, start.balance, start.value, search)
        except UndecidedError:
            start, search = self._settled(point), replace(search, tolerances=search.tolerances[2:] * 3)
            limit = locate_limit_point(self.system, start.balance, start.value, search)
        if limit is None or self._is_waves_away(point, limit) or self._is_behind(point, limit, search.reach):
            return None
        if self._accounts_for(start.balance, start, limit):
            return limit
        return limit if self._accounts_for(self._finer(start.balance, start.value), start, limit) else None

    def _is_waves_away(self, point: Equilibrium, limit: LimitPoint) -> bool:
        """Whether an edge lies half a wave or more from where it is, of the shortest one that may pin it."""
        patches = point.state.patches
        wave = self.system.pinning.shortest(point.balance.work, patches.edge_scale)
        return bool(np.any(2 * np.abs(outward_motion(patches, limit.balance.state.patches)) > wave))

    def _is_behind(self, point: Equilibrium, limit: LimitPoint, reach: float) -> bool:
        """Whether a limit point lies behind a point at rest at the accuracy of targets too: it ends another branch.

        That rest is nearer to the point than it is, or may be where the contact has jumped to from there: farther from
        a fold than the branch that it ends at this value of the control.
        """
        doubt = limit.error.value if limit.kind == "fold" else 0.0  # of the other, what a push may do to it
        ahead = np.sign(reach) * (limit.exact.value - point.value)
        if ahead > doubt:
            return False
        start, there, settled = point.state.patches, limit.balance.state.patches, self._settled(point)
        own = (
            before_fold(limit, limit.exact.value - np.sign(reach) * (ahead + doubt)) if limit.kind == "fold" else there
        )
        ways = (start, settled.state.patches), (start, there), (settled.state.patches, there), (own, there)
        rest, far, left, most = (np.max(np.abs(outward_motion(*way)) / start.edge_scale) for way in ways)
        return bool(settled is not point and rest < far and left > most)

    def _settled(self, point: Equilibrium) -> Equilibrium:
        """The point at the accuracy of targets; as it is where Newton does not find it."""
        found = correct(self.system, point.state.patches, point.state.penetration, point.value, self.increments.fine)
        return point if found.balance is None else equilibrium(self.system, point.value, found.balance)

    def _accounts_for(self, here: Balance, point: Equilibrium, limit: LimitPoint) -> bool:
        """Whether the control does the work between a point, whose forces are `here`, and a limit point.

        Force over the way, to what it changes by there; and a thousandth of the work of adhesion turned over.
        """
        control, change, there = self.system.control, limit.exact.value - point.value, limit.balance
        first, last = control.force(here.state), control.force(there.state)
        along = control.force_rate(here.state, float(here.load_gradient @ point.rate)) * change
        missing = limit.exact.potential - here.potential - change * (first + last) / 2
        outward = outward_motion(here.state.patches, there.state.patches)
        missing -= float(here.gradient @ outward) / 2  # forces left on the edges
        allowed = abs(change) * (abs(last - first) + abs(along)) + UNBOOKED * float(there.work @ np.abs(outward))
        return abs(missing) <= allowed + energy_noise(self.system, here, there, self.increments.fine.tolerance)

    def leaps(self, start: Equilibrium, end: Equilibrium) -> bool:
        """Whether Newton leapt from one branch to another, as motions of the edges or energies say."""
        ends, rates, change = (start.balance, end.balance), (start.rate, end.rate), end.value - start.value
        least, largest = self.increments.coarse.residual, max(start.balance.residual, end.balance.residual)
        return (
            strays(ends, rates, change, max(least, min(largest, HALFWAY * least)))
            or passes_crest(self.system.elastic.profile, start.state.patches, end.state.patches)
            or self.surely_misses_energy(start, end)
        )

    def surely_misses_energy(self, start: Equilibrium, end: Equilibrium) -> bool:
        """Whether more energy went missing between two points than the forces along one branch account for.

        Newton can step over a short unstable stretch of the path.  What the coarse evaluations suspect, the accuracy
        of targets decides: coarse energies and tangents may be no better than what adhesion adds to them.
        """
        return self._missing(start, end).tells_of_a_leap and self._missing(start, end, fine=True).tells_of_a_leap

    def may_hide_a_jump(self, start: Equilibrium, end: Equilibrium) -> bool:
        """Whether two points of one branch, as it seems, are too far apart for energies to tell."""
        return self._missing(start, end).leaves_open and self._missing(start, end, fine=True).leaves_open

    def _missing(self, start: Equilibrium, end: Equilibrium, fine: bool = False) -> Missing:
        """Energy that is missing between two points, as they were evaluated or at the accuracy of a target."""
        ends, tolerance = (start.balance, end.balance), self.increments.coarse.tolerance
        if fine:
            ends = self._finer(start.balance, start.value), self._finer(end.balance, end.value)
            tolerance = self.increments.fine.tolerance
        return missing_energy(self.system, ends, (start.rate, end.rate), end.value - start.value, tolerance)

    def _finer(self, here: Balance, value: float) -> Balance:
        """The forces on the same edges at the accuracy of a target."""
        state = here.state
        return balance(self.system, state.patches, state.penetration, value, self.increments.fine.tolerance)
