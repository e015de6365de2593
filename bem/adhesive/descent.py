"""Descent to the minimum of the potential that an overdamped motion of the edges reaches, where a branch has ended.

Small trust-region steps minimise the potential at a fixed target.  Each edge moves in units of its step scale: the edge
scale, at most half the shortest wavelength.  Larger steps would end in another basin: barriers between basins are as
narrow as the shortest wavelength, and no edge moves by more than a fifth of it at once.  On the way patches vanish and
gaps close (vanishing.py), and crests touch (touching.py).  Dimensionless.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bem.adhesive.equilibrium import Balance, System, balance, energy_noise, symmetric_part
from bem.adhesive.touching import CrestsAhead
from bem.adhesive.trust_region import trust_region_step
from bem.adhesive.vanishing import Change, closing_gaps, vanishing_patches
from bem.elastic.collocation import Resolution, resolve
from bem.elastic.gap import GapMinima
from bem.elastic.hierarchical import if_solvable
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.geometry.profile import EQUAL_HEIGHTS
from bem.loading.increments import MAXIMUM_ITERATIONS, Accuracy

ENERGY_RATIO = (0.1, 2.5)  # accepted actual over predicted decrease
LEAST_INTENSITY = 0.3  # of the critical K: edges below move outward by so much of their step scale, at most


DescentStatus = Literal["converged", "separated", "complete_contact", "touched", "not_converged", "ill_conditioned"]


@dataclass(frozen=True, eq=False)
class Descent:
    """Outcome of `descend`.

    Attributes
    ----------
    status : str
        `converged`, `separated` (the last patch vanished), `complete_contact` (the last gap closed),
        `touched` (a crest touched ahead of an edge), `not_converged` (also before an edge runs into patches that are
        not its own) or `ill_conditioned`.
    patches : Patches
        Where it ended.
    balance : Balance or None
        Forces there; None without patches or gaps.
    changes : tuple of Change
        Patches and gaps that vanished, in order.
    touching : GapMinima or None
        Crests that touched, dimensionless; their gaps are those of `patches`.
    """

    status: DescentStatus
    patches: Patches
    balance: Balance | None
    changes: tuple[Change, ...]
    touching: GapMinima | None = None


@dataclass(frozen=True)
class Steps:
    """How a descent steps.

    Attributes
    ----------
    largest : float
        Trust radius in units of the step scale; small values follow the descent path closely.
    least_resolution : callable or None
        Least resolution of given patches, where others than these are near.
    ahead : CrestsAhead or None
        Finds the crests that touch after a step; the descent ends there, or before edges reach neighbouring patches.
        Motions smaller than it minds, just before a patch or a gap vanishes, are not looked ahead of.
    """

    largest: float
    least_resolution: Callable[[Patches], Resolution] | None = None
    ahead: CrestsAhead | None = None


def descend(
    system: System, patches: Patches, penetration: float, target: float, accuracy: Accuracy, steps: Steps
) -> Descent:
    """Minimise the potential from the given edges, letting patches vanish and gaps close.

    1. Evaluate the forces on the edges.
    2. Take out gaps about to close and patches about to vanish, and move edges out of interpenetration where one has
       K <= 0; then evaluate again.
    3. Choose the step that minimises the quadratic model within the trust radius.  Where the residual is small and the
       step inside the radius, the descent has converged.
    4. Try it, and take it where the potential falls about as far as predicted, else shrink the radius.

    Parameters
    ----------
    system : System
    patches : Patches
        Start.
    penetration, target : float
        Start of the penetration under load control, and value of the control.
    accuracy : Accuracy
        Of the evaluation, and of the equilibrium.
    steps : Steps
    """
    walk = _Walk(system, target, accuracy, steps, patches, penetration, seen=patches, radius=steps.largest / 2)
    for _ in range(MAXIMUM_ITERATIONS * system.elastic.profile.max_order):  # edges move on from wave to wave
        if walk.radius < EQUAL_HEIGHTS:
            break
        here = walk.evaluated()
        if here is None:
            return walk.ended("ill_conditioned")
        verdict = walk.reshaped(here)
        if verdict is None:
            step = walk.step(here)
            inside = step.size < 0.9 * walk.radius and here.is_equilibrium(accuracy.residual)
            verdict = "converged" if inside else walk.tried(here, step)
        if verdict != "again":
            return walk.ended(verdict)
    return walk.ended("not_converged")


@dataclass(frozen=True, eq=False)
class _Step:
    """A trust-region step: the step scale of each edge, the parts of it moved, and the fall that the model predicts."""

    scale: FloatArray
    parts: FloatArray
    predicted: float

    @property
    def size(self) -> float:
        """Its length, of which the trust radius is a bound."""
        return float(np.linalg.norm(self.parts))


@dataclass(eq=False)
class _Walk:
    """Where one descent stands.

    Attributes
    ----------
    system, target, accuracy, steps
        What `descend` was asked.
    patches, penetration
        The edges now, and where load control starts from.
    seen : Patches
        Where each edge was when crests ahead of it were last looked at.
    radius : float
        Of the trust region.
    here : Balance or None
        Forces on the edges; None where they are to be evaluated.
    resolution : Resolution or None
        Of the last evaluation: both sides of a step have the same.
    changes, touching
        What has happened, as in `Descent`.
    """

    system: System
    target: float
    accuracy: Accuracy
    steps: Steps
    patches: Patches
    penetration: float
    seen: Patches
    radius: float
    here: Balance | None = None
    resolution: Resolution | None = None
    changes: tuple[Change, ...] = ()
    touching: GapMinima | None = None

    def ended(self, status: DescentStatus) -> Descent:
        """The outcome."""
        return Descent(status, self.patches, self.here, self.changes, self.touching)

    def evaluated(self) -> Balance | None:
        """Forces on the edges; where none are known, with the resolution that the patches ask for; None: unsolvable."""
        if self.here is None:
            self.resolution = resolve(self.system.elastic, self.patches, self.accuracy.tolerance)
            if self.steps.least_resolution is not None:
                self.resolution = _at_least(self.resolution, self.steps.least_resolution(self.patches))
            self.here = self._balance(self.patches, self.penetration, self.resolution)
        return self.here

    def reshaped(self, here: Balance) -> DescentStatus | Literal["again"] | None:
        """Gaps close, edges move out of interpenetration, or patches vanish; None where nothing of that is due."""
        vanished = closing_gaps(self.system, here)
        if vanished is None and not here.all_tensile:
            wider = _expanded(self.system, here)
            if wider is None or not self._is_free(wider):
                return "not_converged"
            self._stand_at(wider, here)
            return "again"
        vanished = vanished or vanishing_patches(self.system, here)
        if vanished is None:
            return None
        gone, remaining = vanished
        self.changes += gone
        if remaining is None:
            self.here = None
            return "separated" if gone[0].kind == "detachment" else "complete_contact"
        self._stand_at(remaining, here)
        self.seen, self.radius = remaining, self.steps.largest / 2
        return "again"

    def step(self, here: Balance) -> _Step:
        """The step that minimises the quadratic model within the trust radius."""
        scale = step_scale(self.system, here)
        hessian = symmetric_part(here.hessian, scale)
        gradient = here.gradient * scale
        parts = trust_region_step(gradient, hessian, self.radius)
        return _Step(scale, parts, -float(gradient @ parts + 0.5 * parts @ hessian @ parts))

    def tried(self, here: Balance, step: _Step) -> DescentStatus | Literal["again"]:
        """Try a step: take it where the potential falls about as far as predicted, else shrink the radius."""
        trial = self.patches.moved(step.parts * step.scale)
        if not self._is_free(trial):
            return "not_converged"
        wanted = _at_least(resolve(self.system.elastic, trial, self.accuracy.tolerance), self.resolution)
        ahead = self._balance(trial, here.state.penetration, wanted)
        if ahead is None:
            return "ill_conditioned"
        alike = self.resolution is not None and _equal(wanted, self.resolution)
        ratio = self._ratio(here, ahead, step, alike)
        compressed = ahead.state.stress_intensity <= 0
        if not (ENERGY_RATIO[0] < ratio < ENERGY_RATIO[1] and np.all(step.parts[compressed] > 0)):
            if alike:
                self.radius = min(self.radius, step.size) / 3
                return "again"
            self.resolution, self.here = wanted, self._balance(self.patches, self.penetration, wanted)
            return "ill_conditioned" if self.here is None else "again"
        if self.steps.ahead is not None:
            self.touching, self.seen = self.steps.ahead(self.seen, ahead)
        self.patches, self.here, self.penetration = trial, ahead, ahead.state.penetration
        self.resolution = wanted
        if self.touching is not None:
            return "touched"
        if 0.5 < ratio < 1.5:
            self.radius = min(2 * self.radius, self.steps.largest)
        return "again"

    def _ratio(self, here: Balance, ahead: Balance, step: _Step, alike: bool) -> float:
        """Fall of the potential over that predicted; by the work of the forces, where energies cancel.

        Energies of resolutions that are not `alike` differ by more than either is off, and are not compared.
        """
        noise = 1e-13 * (abs(here.potential) + abs(ahead.potential))
        noise += energy_noise(self.system, here, ahead, self.accuracy.tolerance)
        actual = here.potential - ahead.potential
        if step.predicted < 100 * noise or not alike:
            actual = -0.5 * float((here.gradient + ahead.gradient) @ (step.parts * step.scale))
        return actual / step.predicted if step.predicted > 0 else -1.0

    def _balance(self, patches: Patches, penetration: float, resolution: Resolution) -> Balance | None:
        """Forces on some edges; None where their system is ill-conditioned."""
        tolerance = self.accuracy.tolerance
        return if_solvable(balance, self.system, patches, penetration, self.target, tolerance, resolution)

    def _is_free(self, patches: Patches) -> bool:
        """Whether edges keep clear of neighbouring patches, which are frozen."""
        others = None if self.steps.ahead is None else self.steps.ahead.occupied
        return others is None or patches.joined(others) is not None

    def _stand_at(self, patches: Patches, before: Balance) -> None:
        """Continue from other edges, on which the forces are not known."""
        self.patches, self.penetration, self.here = patches, before.state.penetration, None


def _at_least(resolution: Resolution, floor: Resolution | None) -> Resolution:
    if floor is None:
        return resolution
    return Resolution(np.maximum(resolution.nodes, floor.nodes), np.maximum(resolution.modes, floor.modes))


def _equal(first: Resolution, second: Resolution) -> bool:
    return bool(np.all(first.nodes == second.nodes) and np.all(first.modes == second.modes))


def step_scale(system: System, here: Balance) -> FloatArray:
    """Unit of the motion of each edge, (2 L,): the edge scale, at most half the shortest wavelength."""
    return np.minimum(here.state.patches.edge_scale, np.pi / system.elastic.profile.max_order)


def _expanded(system: System, here: Balance) -> Patches | None:
    """Edges with too small a K moved outward by Newton on K; None where no space is left."""
    state, scale = here.state, step_scale(system, here)
    least = LEAST_INTENSITY * 2 * np.sqrt(here.work)
    slope = np.diagonal(here.jacobian)
    wanted = (least - state.stress_intensity) / np.where(slope > 0, slope, np.inf)
    step = np.where(state.stress_intensity < least, np.clip(wanted, 0.02 * scale, LEAST_INTENSITY * scale), 0.0)
    moved = state.patches.moved(step)
    return moved if moved.is_ordered else None
