"""Descent to the minimum of the potential that an overdamped motion of the edges reaches, where a branch has ended.

Small steps at a fixed target (strides.py) lead from change to change: on the way patches vanish and gaps close
(vanishing.py), and crests touch (touching.py).  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.strides import DescentStatus, Steps, Walk
from bem.adhesive.vanishing import Change, without_gaps, without_patches
from bem.elastic.collocation import Resolution, resolve
from bem.elastic.gap import GapMinima
from bem.geometry.patches import TWO_PI, Patches
from bem.loading.increments import MAXIMUM_ITERATIONS, Accuracy


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
        Patches at the end of the descent.
    changes : tuple of Change
        Patches and gaps that vanished, in order.
    balance : Balance or None
        Forces on the edges; None without patches or gaps, or if their system is ill-conditioned.
    touching : GapMinima or None
        Crests that touched, dimensionless; their gaps are those of `patches`.
    """

    status: DescentStatus
    patches: Patches
    changes: tuple[Change, ...]
    balance: Balance | None = None
    touching: GapMinima | None = None


def descend(
    system: System, patches: Patches, penetration: float, target: float, accuracy: Accuracy, steps: Steps
) -> Descent:
    """Minimise the potential from the given edges, letting patches vanish and gaps close.

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
    rounds = MAXIMUM_ITERATIONS * system.elastic.profile.max_order  # edges move on from wave to wave
    changes: tuple[Change, ...] = ()
    while True:
        least = _least(system, patches, steps, accuracy)
        walk = Walk(system, target, accuracy, steps, patches, penetration, patches, steps.largest / 2, rounds, least)
        verdict = walk.to_change()
        if verdict == "closing":
            gone, remaining = without_gaps(walk.patches, walk.gone)
        elif verdict == "vanishing":
            gone, remaining = without_patches(walk.patches, walk.gone)
        else:
            return Descent(verdict, walk.patches, changes, walk.forces, walk.touching)
        changes += gone
        if remaining is None:
            status: DescentStatus = "complete_contact" if verdict == "closing" else "separated"
            return Descent(status, walk.patches, changes)
        patches, rounds = remaining, walk.rounds
        penetration = walk.penetration if walk.forces is None else walk.forces.state.penetration


def _least(system: System, patches: Patches, steps: Steps, accuracy: Accuracy) -> Resolution | None:
    """Return the resolution of patches among the frozen ones; None without frozen patches or if patches overlap."""
    together = None if steps.beside is None else steps.beside.joined(patches)
    if steps.beside is None or together is None:
        return None
    whole = resolve(system.elastic, together, accuracy.tolerance)
    place = np.argsort(np.argsort(np.concatenate([steps.beside.left, patches.left]) % TWO_PI))[steps.beside.count :]
    return Resolution(whole.nodes[place], whole.modes[place])
