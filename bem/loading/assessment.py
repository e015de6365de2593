"""Assessment of a state: stability, stiffness, and the change of each number by a finer evaluation.

The finer evaluation is made by equilibrium_assessment.py with adhesion and by contact_assessment.py without: a third
more nodes and the modes of a hundredth of the tolerance leave forces on the edges, and one Newton step on them leads to
corrected edges.  The change of a reported quantity is its correction, which holds the error of the edges and the error
of the quadrature.  The estimated error is three times the correction (certified_states.py).  Dimensionless.  Limits:
where the corrected edges overlap, corrections are infinite; an event missed on the way is no error of a state
(certificate.py refuses the state where the missed event leaves interpenetration or an indefinite Hessian).

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
    """Reported numbers of a state that carry an error, or changes of these numbers, dimensionless.

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
        """Return the differences to another set of numbers, number by number."""
        return Quantities(*(getattr(self, f.name) - getattr(other, f.name) for f in fields(self)))

    def widened(self, other: Quantities) -> Quantities:
        """Return the sums of the absolute values of both sets, number by number."""
        return Quantities(*(abs(getattr(self, f.name)) + abs(getattr(other, f.name)) for f in fields(self)))


UNKNOWN = Quantities(*[np.inf] * 8)


@dataclass(frozen=True, eq=False)
class Assessment:
    """Reported properties of an equilibrium besides its edges, dimensionless.

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
        Changes that the finer evaluations would make; infinite where the corrected edges overlap.
    """

    work: FloatArray | None
    adhesion_energy: float
    min_eigenvalue: float | None
    hessian_asymmetry: float | None
    stiffness: float
    stable_at_fixed_load: bool
    correction: Quantities


def with_left_out(elastic: Elastic, state: Evaluation) -> Elastic:
    """Return the elastic problem with the field of an effect left out, for the pressure of a state, as a background."""
    left_out, nodes, charges = elastic.left_out, state.skeleton_nodes(), state.skeleton
    if left_out is None:
        return elastic

    def field(x: FloatArray) -> FloatArray:
        return left_out.field(x, nodes, charges)

    return replace(elastic, backgrounds=(*elastic.backgrounds, field))


def stiffened(correction: Quantities, elastic: Elastic, state: Evaluation, stiffness: float) -> Quantities:
    """Return a correction widened by an effect left out: by its share of the stiffness, and by its energy.

    As a background the effect moves the surfaces, but stores no energy.  The energy that is added is q . F q / (2 pi)
    for the charges q of the state.
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
    """Return the numbers of a state without adhesion.

    No energy belongs to the interface, and the edges do not soften the contact.
    """
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
