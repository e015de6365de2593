"""Branch of equilibria near one of its points: motions of edges, its tangent, and numbers after a short step.

Along a branch the edges move by -H^-1 dg/dtau, and the potential grows by the integral of the force that the control
exerts.  Dimensionless.
"""

from __future__ import annotations

import numpy as np

from bem.adhesive.equilibrium import Balance, System
from bem.adhesive.lowest_modes import lowest_modes
from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.patches import TWO_PI, Patches
from bem.loading.path_events import EventNumbers

MOVING = 0.3  # of the largest motion in units of the edge scale: patches that move with a mode


def outward_motion(first: Patches, last: Patches) -> FloatArray:
    """Return the outward motion of the edges from `first` to `last`, (2 L,); across the end of the period too."""
    moved = np.concatenate([first.left - last.left, last.right - first.right])
    return np.asarray((moved + np.pi) % TWO_PI - np.pi)


def tangent(system: System, forces: Balance) -> FloatArray:
    """Return d(outward motion of the edges) / d(control) along the branch of a stable state, (2 L,)."""
    return -system.control.rate(forces.state) * forces.response(forces.load_gradient)


def after_step(system: System, forces: Balance, value: float, outward: FloatArray, change: float) -> EventNumbers:
    """Return the numbers of a state after short motions of the edges and of the control, to second order."""
    state, control = forces.state, system.control
    rate = control.rate(state)
    carried = float(forces.load_gradient @ outward)
    deeper = rate * (change - control.load_weight * carried)
    work = float(forces.gradient @ outward + outward @ forces.hessian @ outward / 2) + change * rate * carried
    work += change * (control.force(state) + change / 2 * control.force_rate(state))
    return EventNumbers(
        value + change,
        state.penetration + deeper,
        state.load + carried + state.load_rate * deeper,
        forces.potential + work,
    )


def numbers_of(forces: Balance, value: float) -> EventNumbers:
    """Return control value, penetration, load and potential of a state."""
    return EventNumbers(value, forces.state.penetration, forces.state.load, forces.potential)


def unstable_patches(forces: Balance) -> IntArray:
    """Return the indices of the patches that move most in the softest mode of the Hessian."""
    return moving_patches(forces.state.patches, lowest_modes(forces.scaled_hessian, 1)[1][:, 0] * forces.scale)


def moving_patches(patches: Patches, outward: FloatArray) -> IntArray:
    """Return the indices of the patches that move most in a motion of the edges."""
    size = np.abs(outward) / patches.edge_scale
    return np.unique(np.flatnonzero(size > MOVING * size.max()) % patches.count)
