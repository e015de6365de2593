"""Steps of a descent from one change of the patches to the next: trust-region steps at a fixed target.

Each edge moves in units of its step scale: the edge scale, at most half the shortest wavelength.  Larger steps would
end in another basin: barriers between basins are as narrow as the shortest wavelength, and no edge moves by more than a
fifth of it at once.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from bem.adhesive.equilibrium import Balance, System, balance, energy_noise, symmetric_part
from bem.adhesive.touching import CrestsAhead
from bem.adhesive.trust_region import trust_region_step
from bem.adhesive.vanishing import closing_gaps, vanishing_patches
from bem.elastic.collocation import Resolution, resolve
from bem.elastic.gap import GapMinima
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import Patches
from bem.geometry.profile import EQUAL_HEIGHTS
from bem.loading.increments import Accuracy

LEAST_RATIO, LARGEST_RATIO = 0.1, 2.5  # accepted actual over predicted decrease
LEAST_INTENSITY = 0.3  # of the critical K: edges below move outward by so much of their step scale, at most

DescentStatus = Literal["converged", "separated", "complete_contact", "touched", "not_converged", "ill_conditioned"]
StrideEnd = DescentStatus | Literal["closing", "vanishing"]


@dataclass(frozen=True)
class Steps:
    """Step sizes of a descent, and the patches and crests beside its edges.

    Attributes
    ----------
    largest : float
        Trust radius in units of the step scale; small values follow the descent path closely.
    beside : Patches or None
        Patches whose field is frozen: patches next to them are resolved as finely as if the frozen ones moved too.
    ahead : CrestsAhead or None
        Finds the crests that touch after a step; the descent ends there, or before edges reach neighbouring patches.
        Motions smaller than it minds, just before a patch or a gap vanishes, are not looked ahead of.
    """

    largest: float
    beside: Patches | None = None
    ahead: CrestsAhead | None = None


@dataclass(frozen=True, eq=False)
class _Step:
    """Trust-region step: step scale of each edge, motion in units of the scale, and fall predicted by the model."""

    scale: FloatArray
    parts: FloatArray
    predicted: float

    @property
    def size(self) -> float:
        """Length of the step, which the trust radius bounds."""
        return float(np.sqrt(self.parts @ self.parts))


@dataclass(eq=False)
class Walk:
    """Descent between two changes of the patches.

    Attributes
    ----------
    system, target, accuracy, steps
        Arguments of `descend`.
    patches, penetration
        Edges now, and the penetration from which load control starts.
    seen : Patches
        Edges at which crests ahead were last looked for.
    radius : float
        Of the trust region.
    rounds : int
        Steps left, refused ones included.
    least : Resolution or None
        Lower bound of the resolution of the patches.
    forces : Balance or None
        Forces on the edges; None where they are not evaluated yet.
    resolution : Resolution or None
        Resolution of the last evaluation, which both sides of a step share.
    gone : (n,) int array
        Indices of the patches or gaps that vanish now.
    touching : GapMinima or None
        Crests that touched in the last step.
    """

    system: System
    target: float
    accuracy: Accuracy
    steps: Steps
    patches: Patches
    penetration: float
    seen: Patches
    radius: float
    rounds: int
    least: Resolution | None = None
    forces: Balance | None = None
    resolution: Resolution | None = None
    gone: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    touching: GapMinima | None = None

    def to_change(self) -> StrideEnd:
        """Step until patches vanish, gaps close, a crest touches, or the descent ends.

        1. Evaluate the forces on the edges.
        2. Where gaps are about to close or patches about to vanish, end.  Where an edge has K <= 0, move edges outward;
           then evaluate again.
        3. Choose the step that minimises the quadratic model within the trust radius.  Where the residual is small and
           the step inside the radius, the descent has converged.
        4. Try it, and take it where the potential falls about as far as predicted, else shrink the radius.
        """
        verdict: StrideEnd | Literal["again"] = "again"
        while verdict == "again":
            verdict = self.round() if self.rounds > 0 and self.radius >= EQUAL_HEIGHTS else "not_converged"
            self.rounds -= 1
        return verdict

    def round(self) -> StrideEnd | Literal["again"]:
        """Evaluate the forces and take a step, or return the reason why no step is taken."""
        forces = self.evaluated()
        if forces is None:
            return "ill_conditioned"
        verdict = self.reshaped(forces)
        if verdict is not None:
            return verdict
        step = self.step(forces)
        inside = step.size < 0.9 * self.radius and forces.is_equilibrium(self.accuracy.residual)
        return "converged" if inside else self.tried(forces, step)

    def evaluated(self) -> Balance | None:
        """Return the forces on the edges, evaluated if unknown; None if their system is ill-conditioned."""
        if self.forces is None:
            wanted = resolve(self.system.elastic, self.patches, self.accuracy.tolerance)
            self.resolution = _at_least(wanted, self.least)
            self.forces = self._balance(self.patches, self.penetration, self.resolution)
        return self.forces

    def reshaped(self, forces: Balance) -> StrideEnd | Literal["again"] | None:
        """Find gaps that close or patches that vanish, or move edges with K <= 0 outward; return a verdict or None."""
        self.gone = closing_gaps(self.system, forces)
        if self.gone.size:
            return "closing"
        if not forces.all_tensile:
            wider = _expanded(self.system, forces)
            if wider is None or not self._is_free(wider):
                return "not_converged"
            self.patches, self.penetration, self.forces = wider, forces.state.penetration, None
            return "again"
        self.gone = vanishing_patches(self.system, forces)
        return "vanishing" if self.gone.size else None

    def step(self, forces: Balance) -> _Step:
        """Return the step that minimises the quadratic model within the trust radius."""
        scale = step_scale(self.system, forces)
        hessian = symmetric_part(forces.hessian, scale)
        gradient = forces.gradient * scale
        parts = trust_region_step(gradient, hessian, self.radius)
        return _Step(scale, parts, -float(gradient @ parts + 0.5 * parts @ hessian @ parts))

    def tried(self, forces: Balance, step: _Step) -> StrideEnd | Literal["again"]:
        """Try a step: take it where the potential falls about as far as predicted, else shrink the radius."""
        trial = self.patches.moved(step.parts * step.scale)
        if not self._is_free(trial):
            return "not_converged"
        wanted = _at_least(resolve(self.system.elastic, trial, self.accuracy.tolerance), self.resolution)
        ahead = self._balance(trial, forces.state.penetration, wanted)
        if ahead is None:
            return "ill_conditioned"
        alike = self.resolution is not None and _equal(wanted, self.resolution)
        ratio = self._ratio(forces, ahead, step, alike)
        compressed = ahead.state.stress_intensity <= 0
        if not (LEAST_RATIO < ratio < LARGEST_RATIO and np.all(step.parts[compressed] > 0)):
            if alike:
                self.radius = min(self.radius, step.size) / 3
                return "again"
            self.resolution, self.forces = wanted, self._balance(self.patches, self.penetration, wanted)
            return "ill_conditioned" if self.forces is None else "again"
        if self.steps.ahead is not None:
            self.touching, self.seen = self.steps.ahead(self.seen, ahead)
        self.patches, self.forces, self.penetration = trial, ahead, ahead.state.penetration
        self.resolution = wanted
        if self.touching is not None:
            return "touched"
        if 0.5 < ratio < 1.5:
            self.radius = min(2 * self.radius, self.steps.largest)
        return "again"

    def _ratio(self, forces: Balance, ahead: Balance, step: _Step, alike: bool) -> float:
        """Return the actual over the predicted fall of the potential; by the work of the forces where energies cancel.

        Energies of resolutions that are not `alike` differ by more than either is off, and are not compared.
        """
        noise = 1e-13 * (abs(forces.potential) + abs(ahead.potential))
        noise += energy_noise(self.system, forces, ahead, self.accuracy.tolerance)
        actual = forces.potential - ahead.potential
        if step.predicted < 100 * noise or not alike:
            actual = -0.5 * float((forces.gradient + ahead.gradient) @ (step.parts * step.scale))
        return actual / step.predicted if step.predicted > 0 else -1.0

    def _balance(self, patches: Patches, penetration: float, resolution: Resolution) -> Balance | None:
        """Return the forces on the edges of `patches`; None if their system is ill-conditioned."""
        tolerance = self.accuracy.tolerance
        return if_solvable(balance, self.system, patches, penetration, self.target, tolerance, resolution)

    def _is_free(self, patches: Patches) -> bool:
        """Return whether edges keep clear of neighbouring patches, which are frozen."""
        others = None if self.steps.ahead is None else self.steps.ahead.occupied
        return others is None or patches.joined(others) is not None


def _at_least(resolution: Resolution, floor: Resolution | None) -> Resolution:
    if floor is None:
        return resolution
    return Resolution(np.maximum(resolution.nodes, floor.nodes), np.maximum(resolution.modes, floor.modes))


def _equal(first: Resolution, second: Resolution) -> bool:
    return (first.nodes.tobytes(), first.modes.tobytes()) == (second.nodes.tobytes(), second.modes.tobytes())


def step_scale(system: System, forces: Balance) -> FloatArray:
    """Return the unit of the motion of each edge, (2 L,): the edge scale, at most half the shortest wavelength."""
    return np.minimum(forces.state.patches.edge_scale, np.pi / system.elastic.profile.max_order)


def _expanded(system: System, forces: Balance) -> Patches | None:
    """Move edges with too small a K outward by Newton on K; return None if no space is left."""
    state, scale = forces.state, step_scale(system, forces)
    least = LEAST_INTENSITY * 2 * np.sqrt(forces.work)
    slope = np.diagonal(forces.jacobian)
    wanted = (least - state.stress_intensity) / np.where(slope > 0, slope, np.inf)
    step = np.where(state.stress_intensity < least, np.clip(wanted, 0.02 * scale, LEAST_INTENSITY * scale), 0.0)
    moved = state.patches.moved(step)
    return moved if moved.is_ordered else None
