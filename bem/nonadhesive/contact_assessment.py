"""Stiffness and corrections of a contact without adhesion (assessment.py).

The corrected edges are so close to K = 0 that the derivatives there stand for a second evaluation,

    d(load)/d(out) = K K_Delta / 2,   dU_el/d(out) = K^2 / 4,   d^2(load)/dDelta d(out) = K_Delta^2 / 2,

the first two integrated along K -> 0.

Heights are known to rounding, which matters on a patch where they hardly vary.  Its size s is that of the coefficients
of R that only the finer evaluation has: they consist of rounding alone.  The pressure is taken to
where its coefficients are above that, since K weighs them with n and dK/d(out) with n^3; what is left in K,
(s/pi) (sum n^2)^(1/2) (pi/r)^(1/2), moves the edges by that over dK/d(out).  An error of all heights is one of Delta,
which the assessment does not see (certified_states.py has a floor for it).  Dimensionless.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from bem.elastic.collocation import ROUNDINGS, Elastic, Evaluation, evaluate, finer
from bem.elastic.sensitivities import own_sensitivity
from bem.geometry.arrays import FloatArray, IntArray
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
    fine, noise = _without_noise(fine, state.resolution.nodes)
    slope, correction = own_sensitivity(fine), UNKNOWN
    if np.all(slope > 0) and state.patches.moved(outward := -fine.stress_intensity / slope).is_ordered:
        correction = _moved(control, fine, outward, value).minus(quantities_of(state))
        correction = _uncertain(correction, fine, noise / slope)
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


def _without_noise(fine: Evaluation, known: IntArray) -> tuple[Evaluation, FloatArray]:
    """Return the state with K and the slope of the pressure at the edges from coefficients above rounding.

    `known` is the number of coefficients of R, (L,), beyond which there is nothing but rounding.  And what that leaves
    of K, one standard deviation, (2 L,).
    """
    charges, order = fine.charges(), np.arange(fine.series.shape[1])
    beyond = (order >= known[:, None]) & (order < fine.resolution.nodes[:, None])
    rounded = np.sqrt(np.sum(fine.series**2, axis=1, where=beyond) / np.sum(beyond, axis=1))
    above = np.pi * np.abs(charges) > ROUNDINGS * rounded[:, None] * np.maximum(order, 1)
    above[:, 0] = True
    certain = np.maximum.accumulate(above[:, ::-1], axis=1)[:, ::-1]
    charges = np.where(certain, charges, 0.0)
    sign, radius = 1.0 - 2.0 * (order % 2), np.tile(fine.patches.half_width, 2)
    regular, bent = (np.concatenate([terms @ sign, terms.sum(axis=1)]) for terms in (charges, charges * order**2))
    left = np.tile(rounded / np.pi * np.sqrt(np.sum(np.where(certain, order**2, 0), axis=1)), 2)
    to_intensity = np.sqrt(np.pi / radius)
    return replace(fine, stress_intensity=-regular * to_intensity, edge_slope=bent / radius), left * to_intensity


def _uncertain(correction: Quantities, fine: Evaluation, moved: FloatArray) -> Quantities:
    """With what edges that may lie elsewhere by so much, (2 L,), change: patches independent, edges of one alike."""
    rate = fine.stress_intensity_rate
    length, stiffness = (np.linalg.norm(each.reshape(2, -1).sum(axis=0)) for each in (moved, rate**2 * moved / 2))
    return replace(
        correction,
        contact_length=correction.contact_length + math.copysign(length, correction.contact_length),
        stiffness=correction.stiffness + math.copysign(stiffness, correction.stiffness),
    )
