"""Descent to the minimum of the potential that an overdamped motion of the edges reaches, where a branch has ended.

Small steps at a fixed target (strides.py) lead from change to change: on the way patches vanish and gaps close
(vanishing.py), and crests touch (touching.py).  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.equilibrium import Balance, System, forces
from bem.adhesive.strides import DescentStatus, Steps, Strides, Walk, strides
from bem.adhesive.vanishing import Change, without_gaps, without_patches
from bem.compiled.kernels import REFERENCES
from bem.elastic.collocation import Evaluation, Resolution, resolve
from bem.elastic.gap import GapMinima
from bem.elastic.logarithmic_potential import LogarithmicPotential
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
        Where it ended.
    changes : tuple of Change
        Patches and gaps that vanished, in order.
    system, target
        What `descend` was asked.
    state : Evaluation or None
        Of the patches; None without patches or gaps, or where they cannot be solved for.
    touching : GapMinima or None
        Crests that touched, dimensionless; their gaps are those of `patches`.
    """

    status: DescentStatus
    patches: Patches
    changes: tuple[Change, ...]
    system: System
    target: float
    state: Evaluation | None = None
    touching: GapMinima | None = None

    @cached_property
    def balance(self) -> Balance | None:
        """Forces there; None without a state."""
        return None if self.state is None else forces(self.system, self.state, self.target)


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
    least = _least(system, patches, steps, accuracy)
    walk = Walk(system, target, accuracy, steps, patches, penetration, patches, steps.largest / 2, rounds, least)
    taken = strides if _is_plain(system) else REFERENCES[strides.__name__]
    changes: tuple[Change, ...] = ()
    while True:
        end = Strides(*taken(walk))
        system.effort.evaluations += end.evaluations
        standing = Patches(end.left, end.right)
        state = None if end.numbers is None else _evaluation(system, standing, *end.numbers)
        if end.verdict == "closing":
            gone, remaining = without_gaps(standing, end.gone)
        elif end.verdict == "vanishing":
            gone, remaining = without_patches(standing, end.gone)
        else:
            touching = None if end.verdict != "touched" else GapMinima(end.crests, end.depth, end.gap)
            return Descent(end.verdict, standing, changes, system, target, state, touching)
        changes += gone
        if remaining is None:
            status: DescentStatus = "complete_contact" if end.verdict == "closing" else "separated"
            return Descent(status, standing, changes, system, target)
        penetration = walk.penetration if state is None else state.penetration
        walk = replace(
            walk, patches=remaining, penetration=penetration, seen=remaining, radius=steps.largest / 2,
            rounds=end.rounds, least=_least(system, remaining, steps, accuracy),
        )  # fmt: skip


def _is_plain(system: System) -> bool:
    """Whether the kernel takes the steps: on the half-space, at a given penetration."""
    elastic = system.elastic
    rests = all(isinstance(one, LogarithmicPotential) for one in elastic.backgrounds) and len(elastic.backgrounds) < 2
    bare = elastic.compliance is None and not elastic.slopes and not elastic.probes and rests
    return bare and not system.control.load_weight and isinstance(system.law, UniformLaw)


def _evaluation(system: System, patches: Patches, *numbers: Any) -> Evaluation:
    """The state of some patches with these numbers."""
    penetration, intensity, rate, load, load_rate, energy, compliance, slope, slope_rate, *others = numbers
    series, skeleton, skeleton_rate, nodes, modes = others
    return Evaluation(
        patches=patches,
        penetration=penetration,
        stress_intensity=intensity,
        stress_intensity_rate=rate,
        load=load,
        load_rate=load_rate,
        elastic_energy=energy,
        edge_compliance=compliance,
        slope_compliance=np.zeros((0, intensity.size)),
        edge_slope=slope,
        edge_slope_rate=slope_rate,
        resolution=Resolution(nodes, modes),
        unknowns=skeleton.size,
        series=series,
        skeleton=skeleton,
        skeleton_rate=skeleton_rate,
        rms_slope=system.elastic.profile.rms_slope,
        intensity_by_probes=np.zeros((0, intensity.size)),
        load_by_probes=np.zeros(0),
    )


def _least(system: System, patches: Patches, steps: Steps, accuracy: Accuracy) -> Resolution | None:
    """Resolution of patches as parts of all, frozen ones too; None where none are, or where they overlap."""
    together = None if steps.beside is None else steps.beside.joined(patches)
    if steps.beside is None or together is None:
        return None
    whole = resolve(system.elastic, together, accuracy.tolerance)
    place = np.argsort(np.argsort(np.concatenate([steps.beside.left, patches.left]) % TWO_PI))[steps.beside.count :]
    return Resolution(whole.nodes[place], whole.modes[place])
