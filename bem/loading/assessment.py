"""What an assessment says of a state: stability, stiffness, and what a finer evaluation changes of each number.

The finer evaluation is made by equilibrium_assessment.py with adhesion and by contact_assessment.py without: a third
more nodes and the modes of a hundredth of the tolerance leave forces on the edges, and one Newton step on them leads to
corrected edges.  What a reported quantity changes by is its correction, which holds the error of the edges and that of
the quadrature; its estimated error is three times that (certified_states.py).  Dimensionless.  Limits: where the
corrected edges overlap, corrections are infinite; an event missed on the way is no error of a state (certificate.py
refuses the state where the missed event leaves interpenetration or an indefinite Hessian).

An elastic effect that is left out of the equations acts on the finer evaluation as the field of the pressure found
without it, which is its effect to first order; on the energy twice that, its work being half.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from bem.elastic.collocation import Elastic, Evaluation
from bem.geometry.arrays import FloatArray


@dataclass(frozen=True)
class Quantities:
    """Everything reported of a state that carries an error, or changes of all that, dimensionless.

    Attributes
    ----------
    penetration, load, contact_length : float
    elastic_energy, adhesion_energy, total_energy : float
        Per period.
    stress_intensity : float
        The largest K.
    stiffness : float
        d(load)/dDelta along the branch.
    """

    penetration: float
    load: float
    contact_length: float
    elastic_energy: float
    adhesion_energy: float
    total_energy: float
    stress_intensity: float
    stiffness: float

    def minus(self, other: Quantities) -> Quantities:
        """Differences, one by one."""
        return Quantities(*(getattr(self, f.name) - getattr(other, f.name) for f in fields(self)))

    def widened(self, other: Quantities) -> Quantities:
        """Sizes and those of others together, one by one."""
        return Quantities(*(abs(getattr(self, f.name)) + abs(getattr(other, f.name)) for f in fields(self)))


UNKNOWN = Quantities(*[np.inf] * 8)


@dataclass(frozen=True, eq=False)
class Assessment:
    """What is reported of an equilibrium besides its edges, dimensionless.

    Attributes
    ----------
    work : (2 L,) array or None
        w at the edges; None without adhesion.
    adhesion_energy : float
        Per period.
    min_eigenvalue, hessian_asymmetry : float or None
        None without adhesion.
    stiffness : float
        d(load)/dDelta along the branch.
    stable_at_fixed_load : bool
    correction : Quantities
        What the finer evaluations would add; infinite where the corrected edges overlap.
    """

    work: FloatArray | None
    adhesion_energy: float
    min_eigenvalue: float | None
    hessian_asymmetry: float | None
    stiffness: float
    stable_at_fixed_load: bool
    correction: Quantities


def with_left_out(elastic: Elastic, state: Evaluation) -> Elastic:
    """With the field that an effect left out adds for the pressure of a state, as background."""
    left_out, nodes, charges = elastic.left_out, state.skeleton_nodes(), state.skeleton
    if left_out is None:
        return elastic

    def field(x: FloatArray) -> FloatArray:
        return left_out.field(x, nodes, charges)

    return replace(elastic, backgrounds=(*elastic.backgrounds, field))


def stiffened(correction: Quantities, elastic: Elastic, state: Evaluation, stiffness: float) -> Quantities:
    """With what an effect left out adds to the stiffness, the share of that of edges at rest, and to the energy.

    As a background it moves the surfaces, but stores no energy: q . F q / (2 pi) for the charges q of the state.
    """
    if elastic.left_out is None:
        return correction
    nodes, rate, charges = state.skeleton_nodes(), state.skeleton_rate, state.skeleton
    share = float(rate @ elastic.left_out.field(nodes, nodes, rate)) / (np.pi * state.load_rate)
    stored = abs(float(charges @ elastic.left_out.field(nodes, nodes, charges))) / (2 * np.pi)
    return replace(
        correction,
        stiffness=abs(correction.stiffness) + abs(share * stiffness),
        elastic_energy=abs(correction.elastic_energy) + stored,
        total_energy=abs(correction.total_energy) + stored,
    )


def quantities_of(state: Evaluation) -> Quantities:
    """Without adhesion no energy is the interface's, and the edges do not soften the contact."""
    return Quantities(
        penetration=state.penetration,
        load=state.load,
        contact_length=float(np.sum(state.patches.width)),
        elastic_energy=state.elastic_energy,
        adhesion_energy=0.0,
        total_energy=state.elastic_energy,
        stress_intensity=float(np.max(state.stress_intensity)),
        stiffness=state.load_rate,
    )
