"""Stability, stiffness and estimated errors of a state, from a finer evaluation of the same edges.

The finer evaluation (a third more nodes, half as many modes again) leaves forces on the edges; one Newton step on them
leads to corrected edges.  What a reported quantity changes by is its estimated error: it holds the error of the edges,
that of the quadrature, and what the one does to the other.  With adhesion the corrected edges are evaluated once more,
because the stiffness has third derivatives of the energy in it.  Without, they are so close to K = 0 that the exact
derivatives there do,

    d(load)/d(out) = K K_Delta / 2,   dU_el/d(out) = K^2 / 4,   d^2(load)/dDelta d(out) = K_Delta^2 / 2,

the first two integrated along K -> 0.  Dimensionless.  Limits: errors so large that the corrected edges overlap are
reported as infinite; an event missed on the way is no error of a state (certificate.py looks for those).

A layer that is left out of the equations acts on the finer evaluation as the field of the pressure found without it,
which is its effect to first order; on the energy twice that, its work being half.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from bem.collocation import Elastic, Evaluation, evaluate, finer
from bem.control import Control
from bem.equilibrium import Balance, System, balance
from bem.sensitivities import stress_intensity_jacobian

FloatArray = NDArray[np.float64]


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


def assess_equilibrium(system: System, here: Balance, value: float, tolerance: float) -> Assessment:
    """Assess an adhesive equilibrium at a value of the control by two evaluations at `tolerance`.

    Parameters
    ----------
    system : System
    here : Balance
    value : float
        Of the control.
    tolerance : float
        Finer than that of `here`.
    """
    state, resolution = here.state, finer(here.state.resolution)
    system = replace(system, elastic=_with_left_out(system.elastic, state))
    fine = balance(system, state.patches, state.penetration, value, tolerance, resolution)
    corrected = state.patches.moved(np.asarray(-np.linalg.solve(fine.hessian, fine.gradient)))
    correction = UNKNOWN
    if corrected.is_ordered:
        exact = balance(system, corrected, state.penetration, value, tolerance, resolution)
        correction = _of_equilibrium(exact).minus(_of_equilibrium(here))
        correction = _stiffened(correction, system.elastic, state, here.stiffness)
    return Assessment(
        work=here.work,
        adhesion_energy=here.energy - state.elastic_energy,
        min_eigenvalue=here.smallest_eigenvalue,
        hessian_asymmetry=here.hessian_asymmetry,
        stiffness=here.stiffness,
        stable_at_fixed_load=here.stable_at_fixed_load,
        correction=correction,
    )


def assess_contact(elastic: Elastic, control: Control, state: Evaluation, value: float, tolerance: float) -> Assessment:
    """Assess a contact without adhesion, K = 0, at a value of the control by an evaluation at `tolerance`.

    Parameters
    ----------
    elastic, control
        As for `solve_contact`.
    state : Evaluation
    value : float
        Of the control.
    tolerance : float
        Finer than that of `state`.
    """
    at = control.guess(state.penetration, value)
    elastic = _with_left_out(elastic, state)
    fine = control.reach(evaluate(elastic, state.patches, at, tolerance, finer(state.resolution)), value)
    jacobian = stress_intensity_jacobian(fine)
    outward = -fine.stress_intensity / np.diagonal(jacobian)
    correction = UNKNOWN
    if state.patches.moved(outward).is_ordered:
        correction = _moved(control, fine, jacobian, outward, value).minus(_of_contact(state))
        correction = _stiffened(correction, elastic, state, state.load_rate)
    return Assessment(
        work=None,
        adhesion_energy=0.0,
        min_eigenvalue=None,
        hessian_asymmetry=None,
        stiffness=state.load_rate,
        stable_at_fixed_load=True,
        correction=correction,
    )


def _with_left_out(elastic: Elastic, state: Evaluation) -> Elastic:
    """With the field that a correction left out adds for the pressure of a state, as background."""
    left_out, nodes, charges = elastic.left_out, state.skeleton_nodes(), state.skeleton
    if left_out is None:
        return elastic

    def field(x: FloatArray) -> FloatArray:
        return left_out.field(x, nodes, charges)

    return replace(elastic, backgrounds=(*elastic.backgrounds, field))


def _stiffened(correction: Quantities, elastic: Elastic, state: Evaluation, stiffness: float) -> Quantities:
    """With what a correction left out adds to the stiffness: the share by which it adds to that of edges at rest."""
    if elastic.left_out is None:
        return correction
    nodes, rate = state.skeleton_nodes(), state.skeleton_rate
    share = float(rate @ elastic.left_out.field(nodes, nodes, rate)) / (np.pi * state.load_rate)
    return replace(correction, stiffness=abs(correction.stiffness) + abs(share * stiffness))


def _moved(control: Control, state: Evaluation, jacobian: FloatArray, outward: FloatArray, value: float) -> Quantities:
    """Quantities after edges next to K = 0 moved outward to where it vanishes, at the same value of the control."""
    intensity, rate = state.stress_intensity, state.stress_intensity_rate
    moved = replace(
        state,
        patches=state.patches.moved(outward),
        stress_intensity=intensity + jacobian @ outward,
        load=state.load + float(intensity * rate @ outward) / 4,
        load_rate=state.load_rate + float(rate**2 @ outward) / 2,
        elastic_energy=state.elastic_energy + float(intensity**2 @ outward) / 12,
    )
    return _of_contact(control.reach(moved, value))


def _of_equilibrium(here: Balance) -> Quantities:
    return replace(
        _of_contact(here.state),
        adhesion_energy=here.energy - here.state.elastic_energy,
        total_energy=here.energy,
        stiffness=here.stiffness,
    )


def _of_contact(state: Evaluation) -> Quantities:
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
