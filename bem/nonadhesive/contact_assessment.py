"""Stiffness and corrections of a contact without adhesion (assessment.py).

The corrected edges are so close to K = 0 that the derivatives there stand for a second evaluation,

    d(load)/d(out) = K K_Delta / 2,   dU_el/d(out) = K^2 / 4,   d^2(load)/dDelta d(out) = K_Delta^2 / 2,

the first two integrated along K -> 0.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bem.elastic.collocation import Elastic, Evaluation, evaluate, finer
from bem.elastic.sensitivities import own_sensitivity
from bem.geometry.arrays import FloatArray
from bem.loading.assessment import UNKNOWN, Assessment, Quantities, quantities_of, stiffened, with_left_out
from bem.loading.control import Control


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
    elastic = with_left_out(elastic, state)
    resolution = finer(elastic, state.patches, state.resolution, tolerance)
    fine = evaluate(elastic, state.patches, at, tolerance, resolution, with_compliance=False)
    fine = control.reach(fine, value)
    outward = -fine.stress_intensity / own_sensitivity(fine)
    correction = UNKNOWN
    if state.patches.moved(outward).is_ordered:
        correction = _moved(control, fine, outward, value).minus(quantities_of(state))
        correction = stiffened(correction, elastic, state, state.load_rate)
    return Assessment(
        work=None,
        adhesion_energy=0.0,
        min_eigenvalue=None,
        hessian_asymmetry=None,
        stiffness=state.load_rate,
        stable_at_fixed_load=True,
        correction=correction,
    )


def _moved(control: Control, state: Evaluation, outward: FloatArray, value: float) -> Quantities:
    """Quantities after edges next to K = 0 moved outward to where it vanishes, at the same value of the control."""
    intensity, rate = state.stress_intensity, state.stress_intensity_rate
    moved = replace(
        state,
        patches=state.patches.moved(outward),
        stress_intensity=np.zeros(intensity.size),
        load=state.load + float(intensity * rate @ outward) / 4,
        load_rate=state.load_rate + float(rate**2 @ outward) / 2,
        elastic_energy=state.elastic_energy + float(intensity**2 @ outward) / 12,
    )
    return quantities_of(control.reach(moved, value))
