"""Many patches at rest: equilibria, stability and errors of all edges from the Jacobians of windows.

Newton for all edges takes the steps that the windows ask for, each for the edges of its core, mixed with those before;
the residuals are those of all patches.  Stability is that of the windows: the softest modes of a rough contact are of
few patches.  The motion along the branch is corrected by what differences of evaluations still miss of it.
Dimensionless.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.linalg import lapack

from bem.adhesive.branch import tangent
from bem.adhesive.equilibrium import Balance, System, balance, edge_positions
from bem.continuation.curve import imbalance_by_edges
from bem.elastic.collocation import ROUNDINGS, Evaluation, Resolution, evaluate, finer
from bem.elastic.far_field import Charges, far_fields
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.leaps.landing import inside
from bem.leaps.leap import SHORT_STEP
from bem.leaps.windows import Window, windows_of
from bem.loading.assessment import UNKNOWN, Assessment, Quantities, quantities_of
from bem.loading.increments import COARSE, Accuracy

STEPS = 12  # limit: of Newton with the Jacobians of windows; five do
LONGEST_STEP = 0.3  # limit: edge scales
DIFFERENCE = 1e-5  # rms heights: step of the differences along the branch at most
CLOSE = 1e-5  # change of the stiffness by a correction of the motion, after which no other comes


@dataclass(frozen=True, eq=False)
class Solved:
    """A window with its forces, and its Jacobian as factors."""

    window: Window
    system: System
    balance: Balance
    factors: tuple[FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Jacobians:
    """The Jacobians of all windows next to a state."""

    windows: Sequence[Solved]

    def motion(self, missing: FloatArray) -> FloatArray:
        """Outward motion of the edges that adds what is missing of K, (2 L,)."""
        found = np.empty(missing.size)
        for one in self.windows:
            step, _ = lapack.dgetrs(*one.factors, one.window.edges(missing))
            one.window.put(step * one.balance.state.patches.edge_scale, found)
        return found

    @property
    def stable(self) -> bool:
        """Whether every window is."""
        return all(one.balance.factor is not None for one in self.windows)

    def rate(self) -> FloatArray:
        """d(outward motion of the edges) by the control along the branch, (2 L,)."""
        found = np.empty(sum(2 * int(one.window.core.sum()) for one in self.windows))
        for one in self.windows:
            one.window.put(tangent(one.system, one.balance), found)
        return found


@dataclass(eq=False)
class Mixing:
    """A fixed-point iteration whose steps learn from those before (D. G. Anderson, J. ACM 12 (1965) 547).

    A soft mode of patches in two windows would make it slow.

    Attributes
    ----------
    place : (n,) array
        Where it stands.
    """

    place: FloatArray
    _before: list[tuple[FloatArray, FloatArray]] = field(default_factory=list)

    def step(self, asked: FloatArray) -> FloatArray:
        """Go on from a place that asks for a step, (n,); how far that was."""
        self._before.append((self.place, asked))
        places, steps = (np.diff(np.array(kept), axis=0).T for kept in zip(*self._before, strict=True))
        taken = asked - (places + steps) @ np.linalg.lstsq(steps, asked)[0]
        self.place = self.place + taken
        return np.asarray(taken)


@dataclass(frozen=True, eq=False)
class Settling:
    """Finds and assesses equilibria of many patches."""

    system: System

    def settled(self, patches: Patches, value: float, accuracy: Accuracy) -> tuple[Evaluation, Jacobians] | None:
        """The stable equilibrium next to edges at a value of the control, without the compliance of its edges."""
        jacobians, kept = self.jacobians(patches, value), None
        if jacobians is None:
            return None
        first, unit, mixing = patches, patches.edge_scale, Mixing(np.zeros(2 * patches.count))
        for _ in range(STEPS):
            state = self.evaluated(patches, value, accuracy.tolerance, kept)
            if state is None or state.stress_intensity.min() <= 0:
                return None
            root = np.sqrt(self._work(patches))
            if self._at_rest(state, root, accuracy.residual):
                after = jacobians if jacobians.stable else self.jacobians(patches, value)
                return (state, after) if after is not None and after.stable else None
            asked = jacobians.motion(2 * root - state.stress_intensity) / unit
            size = float(np.max(np.abs(mixing.step(asked)))) if np.all(np.isfinite(asked)) else np.inf
            if size > LONGEST_STEP:
                return None
            kept = state.resolution if size < SHORT_STEP else None
            patches = first.moved(mixing.place * unit)
        return None

    def jacobians(self, patches: Patches, value: float) -> Jacobians | None:
        """The Jacobians of the windows next to edges; None where a state cannot be evaluated, or one is singular."""
        state = self.evaluated(patches, value, COARSE.tolerance)
        if state is None:
            return None
        windows, solved = windows_of(patches), []
        for window, far in zip(
            windows, far_fields([window.arc for window in windows], charges_of(state), moved_in(state)), strict=True
        ):
            system = inside(self.system, far)
            here = if_solvable(balance, system, window.of(patches), value, value, COARSE.tolerance)
            if here is None:
                return None
            unit = here.state.patches.edge_scale
            lu, pivots, singular = lapack.dgetrf(imbalance_by_edges(system, here, unit), overwrite_a=1)
            if singular:
                return None
            solved.append(Solved(window, system, here, (lu, pivots)))
        return Jacobians(solved)

    def assess(self, state: Evaluation, jacobians: Jacobians, tolerance: float) -> Assessment:
        """Stability, stiffness and corrections of a settled state, by finer evaluations at `tolerance`."""
        value, patches = state.penetration, state.patches
        resolution = finer(self.system.elastic, patches, state.resolution, tolerance)
        stiffness, doubt = self._stiffness(state, jacobians)
        correction = UNKNOWN
        fine = self.evaluated(patches, value, tolerance, resolution)
        if fine is not None:
            step = jacobians.motion(2 * np.sqrt(self._work(patches)) - fine.stress_intensity)
            exact = self.evaluated(patches.moved(step), value, tolerance, resolution)
            if exact is not None:
                changed = self._quantities(exact, stiffness).minus(self._quantities(state, stiffness))
                most = float(np.max(np.abs(exact.stress_intensity - state.stress_intensity)))
                correction = replace(changed, stress_intensity=most, stiffness=doubt)
        return Assessment(
            work=self._work(patches),
            adhesion_energy=self.system.law.energy(patches),
            min_eigenvalue=min(one.balance.smallest_eigenvalue for one in jacobians.windows),
            hessian_asymmetry=max(one.balance.hessian_asymmetry for one in jacobians.windows),
            stiffness=stiffness,
            stable_at_fixed_load=stiffness > 0,
            correction=correction,
        )

    def _stiffness(self, state: Evaluation, jacobians: Jacobians) -> tuple[float, float]:
        """d(load) by the penetration along the branch, and what the last correction of the motion changed of it."""
        unit, root = state.patches.edge_scale, np.sqrt(self._work(state.patches))
        rate, last, doubt = Mixing(jacobians.rate() / unit), np.inf, np.inf
        for _ in range(STEPS):
            there, change = self._farther(state, rate.place * unit)
            if there is None:
                return np.nan, np.inf
            stiffness = (there.load - state.load) / change
            last, doubt = stiffness, abs(stiffness - last)
            if doubt <= CLOSE * abs(stiffness):
                break
            missed = 2 * (np.sqrt(self._work(there.patches)) - root) - (there.stress_intensity - state.stress_intensity)
            rate.step(jacobians.motion(missed / change) / unit)
        return last, doubt

    def stiffness(self, state: Evaluation, rate: FloatArray) -> float:
        """d(load) by the penetration where edges move at a rate."""
        there, change = self._farther(state, rate)
        return np.nan if there is None else (there.load - state.load) / change

    def _farther(self, state: Evaluation, rate: FloatArray) -> tuple[Evaluation | None, float]:
        """The state a little farther along the branch, its edges moving at a rate, and how much farther."""
        fastest = float(np.max(np.abs(rate) / state.patches.edge_scale))
        change = SHORT_STEP / max(fastest, SHORT_STEP / DIFFERENCE)
        ahead = state.patches.moved(change * rate)
        return self.evaluated(ahead, state.penetration + change, 0.0, state.resolution), change

    def evaluated(
        self, patches: Patches, value: float, tolerance: float, resolution: Resolution | None = None
    ) -> Evaluation | None:
        """All patches at a value of the control, without the compliance of their edges; None where that fails."""
        if not patches.is_ordered:
            return None
        self.system.effort.evaluations += 1
        return if_solvable(evaluate, self.system.elastic, patches, value, tolerance, resolution, False)

    def missing(self, state: Evaluation) -> FloatArray:
        """2 - K / sqrt(w), (2 L,): zero in equilibrium."""
        return np.asarray(2 - state.stress_intensity / np.sqrt(self._work(state.patches)))

    def _at_rest(self, state: Evaluation, root: FloatArray, residual: float) -> bool:
        """Whether G = w at all edges, to a residual or to three roundings of K."""
        missing = np.abs((state.stress_intensity / (2 * root)) ** 2 - 1)
        return bool(np.all((missing <= residual) | (missing <= ROUNDINGS * state.rounding(1.0) / root)))

    def _work(self, patches: Patches) -> FloatArray:
        """w at the edges, (2 L,)."""
        return self.system.law.work_and_gradient(edge_positions(patches))[0]

    def _quantities(self, state: Evaluation, stiffness: float) -> Quantities:
        """What is reported of a state."""
        adhesion = self.system.law.energy(state.patches)
        total = state.elastic_energy + adhesion
        return replace(quantities_of(state), adhesion_energy=adhesion, total_energy=total, stiffness=stiffness)


def charges_of(state: Evaluation) -> Charges:
    """Charges of a state."""
    return Charges(state.skeleton_nodes(), state.skeleton, state.penetration)


def moved_in(state: Evaluation) -> Charges:
    """Charges of a state after a unit of penetration more, at fixed edges."""
    return Charges(state.skeleton_nodes(), state.skeleton + state.skeleton_rate, state.penetration + 1)
