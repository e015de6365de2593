"""Dense algebra next to a state of a scene, or from the overlap of the undeformed shapes on a half-space.

The second has no path and no search for contacts: with its number of nodes on every patch it shows what the
discretisation alone costs, digit by digit.  The equations are those of references/dense_equilibrium.py.
"""

from dataclasses import replace

import numpy as np

from bem.scene.scene import Scene
from bem.scene.state import State
from validation.harness.arrays import FloatArray
from validation.harness.route import Problem
from validation.references.dense_equilibrium import Interface, converged, equilibrium
from validation.references.waves import Waves
from validation.routes.scenes import problem_of


def reference(scene: Scene, state: State, refinement: int = 1) -> dict[str, float]:
    """Return every scalar of the equilibrium next to a state of a scene, in its unit, at the nearest target.

    NoReferenceError where Newton does not converge, ValueError for a table that dense algebra does not provide.
    """
    problem = problem_of(scene, "dense algebra", "layer", "adhesion")
    if problem.control in ("penetration", "separation"):
        problem, target = replace(problem, control="penetration"), state.penetration
    else:
        reached = getattr(state, problem.control)
        target = min(problem.targets, key=lambda aim: abs(aim - reached))
    return equilibrium(problem, state.edges, state.penetration, target, refinement)


def overlap(surface: Waves, penetration: float) -> FloatArray:
    """Return the intervals in which an undeformed profile is above the undeformed face, (L, 2) in m."""
    count = 64 * int(surface.orders.max())
    x = np.arange(count) * (surface.period / count)
    inside = surface.height(x) - surface.highest + penetration > 0
    starts, ends = np.flatnonzero(inside & ~np.roll(inside, 1)), np.flatnonzero(inside & ~np.roll(inside, -1))
    ends = np.where(ends < starts, np.roll(ends, -1), ends) if ends[0] < starts[0] else ends
    ends = np.where(ends < starts, ends + count, ends)
    return np.asarray(np.stack([starts, ends + 1], axis=1) * (surface.period / count), dtype=np.float64)


def contact_fraction(problem: Problem, nodes: int) -> float:
    """Return the contact fraction at the only target, a penetration; NoReferenceError if Newton does not converge."""
    (penetration,) = problem.targets
    surface = Waves(problem.period, *problem.harmonics)
    modulus, q0 = problem.youngs_modulus / (1 - problem.poisson_ratio**2), 2 * np.pi / problem.period
    rms = surface.rms_height
    profile = Waves(2 * np.pi, surface.orders, surface.amplitudes / rms, surface.phases)
    interface = Interface((problem.work_of_adhesion or 0.0) / (modulus * rms**2 * q0 / 2), profile, 0.0)
    depth, start = penetration / rms, overlap(surface, penetration) * q0
    count = np.full(len(start), nodes)
    left, right, _, _ = converged(
        profile, start[:, 0], start[:, 1], depth, count, None, interface, depth, (1.0, 0.0), far=True
    )
    return float(np.sum(right - left)) / (2 * np.pi)
