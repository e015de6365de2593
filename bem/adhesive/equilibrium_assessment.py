"""Stability, stiffness and corrections of an adhesive equilibrium (assessment.py).

The edges are evaluated with more nodes and modes, moved by -H^-1 g, and evaluated there once more: without that second
evaluation the correction of the stiffness would take third derivatives of the energy.
Dimensionless.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bem.adhesive.equilibrium import Balance, System, balance
from bem.elastic.collocation import finer
from bem.loading.assessment import UNKNOWN, Assessment, Quantities, quantities_of, stiffened, with_left_out


def assess_equilibrium(system: System, forces: Balance, value: float, tolerance: float) -> Assessment:
    """Assess an adhesive equilibrium at a value of the control by two evaluations at `tolerance`.

    Parameters
    ----------
    system : System
    forces : Balance
    value : float
        Of the control.
    tolerance : float
        Finer than the tolerance of `forces`.
    """
    state = forces.state
    resolution = finer(system.elastic, state.patches, state.resolution, tolerance)
    system = replace(system, elastic=with_left_out(system.elastic, state))
    fine = balance(system, state.patches, state.penetration, value, tolerance, resolution)
    corrected = state.patches.moved(-fine.response(fine.gradient))
    correction = UNKNOWN
    if corrected.is_ordered:
        exact = balance(system, corrected, state.penetration, value, tolerance, resolution)
        correction = _of_equilibrium(exact).minus(_of_equilibrium(forces))
        change = np.abs(exact.state.stress_intensity - state.stress_intensity)  # that of the largest K may vanish
        correction = replace(correction, stress_intensity=float(np.max(change)))
        correction = stiffened(correction, system.elastic, state, forces.stiffness)
    return Assessment(
        work=forces.work,
        adhesion_energy=forces.adhesion_energy,
        min_eigenvalue=forces.smallest_eigenvalue,
        hessian_asymmetry=forces.hessian_asymmetry,
        stiffness=forces.stiffness,
        stable_at_fixed_load=forces.stable_at_fixed_load,
        correction=correction,
    )


def _of_equilibrium(forces: Balance) -> Quantities:
    return replace(
        quantities_of(forces.state),
        adhesion_energy=forces.adhesion_energy,
        total_energy=forces.energy,
        stiffness=forces.stiffness,
    )
