"""Forces near a neutral equilibrium in fixed units of length, the softest modes of their Hessian, and steps from there.

The derivative of the smallest eigenvalue mu along a motion of the edges, D_v H v, is a difference of exact Hessians;
that by the control is exact: K is linear in the control at fixed edges.  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bem.adhesive.equilibrium import Balance, System, balance, symmetric_part
from bem.adhesive.lowest_modes import lowest_modes
from bem.elastic.collocation import Resolution, finer, resolve
from bem.elastic.sensitivities import stress_intensity_jacobian
from bem.loading.path_events import EventNumbers

FloatArray = NDArray[np.float64]

LONGEST_STEP = 0.2  # of the edge scale
NEAR = 1e-3  # of the edge scale: the rest of a step is left to finer evaluations
SYMMETRIC = 1e-3  # cosine between a mode and the pull of the load, below which it may break a symmetry
SIDEWAYS = 1e-4  # of the edge scale, over which D_v H is a difference


class LostError(Exception):
    """A step that leads away from all equilibria."""


@dataclass(frozen=True, eq=False)
class Soft:
    """Forces on the edges in fixed units of length, with the modes of their Hessian."""

    here: Balance
    value: float
    scale: FloatArray
    gradient: FloatArray
    hessian: FloatArray
    pull: FloatArray
    eigenvalues: FloatArray
    modes: FloatArray
    eigenvalue_rate: float

    @property
    def mode(self) -> FloatArray:
        """The softest one, (2 L,)."""
        return np.asarray(self.modes[:, 0])

    @property
    def edge_scale(self) -> FloatArray:
        """Edge scale, (2 L,)."""
        return np.asarray(self.here.state.patches.edge_scale / self.scale)

    def size(self, step: FloatArray) -> float:
        """Largest part of its edge scale by which an edge moves in a step."""
        return float(np.max(np.abs(step) / self.edge_scale))


def softness(
    system: System, here: Balance, value: float, scale: FloatArray, last: FloatArray | None = None, every: bool = False
) -> Soft:
    """Forces of a balance, and its two softest modes or `every` one; the first has the sign of `last`."""
    hessian = symmetric_part(here.hessian, scale)
    eigenvalues, modes = lowest_modes(hessian, None if every else 2)
    if last is not None:
        modes *= np.sign(modes[:, 0] @ last) or 1.0
    rate = system.control.rate(here.state)
    return Soft(
        here=here,
        value=value,
        scale=scale,
        gradient=here.gradient * scale,
        hessian=hessian,
        pull=here.load_gradient * scale * rate,
        eigenvalues=eigenvalues,
        modes=modes,
        eigenvalue_rate=_stiffening(system, here, modes[:, 0] * scale),
    )


def _stiffening(system: System, here: Balance, outward: FloatArray) -> float:
    """v . dH/dtau v for a motion v of the edges; at fixed edges K and its Jacobian are linear in the control."""
    state, rate = here.state, system.control.rate(here.state)
    growing = replace(state, stress_intensity=state.stress_intensity_rate, edge_slope=state.edge_slope_rate)
    twice = (outward * state.stress_intensity_rate) @ (here.jacobian @ outward)
    twice += (outward * state.stress_intensity) @ (stress_intensity_jacobian(growing) @ outward)
    carried = float(here.load_gradient @ outward) * float(state.stress_intensity_rate**2 @ outward)
    return float(rate * (twice / 2 - system.control.load_weight * rate * carried))


def is_at_rest(soft: Soft, modes: FloatArray) -> NDArray[np.bool_]:
    """Which modes, (2 L, n) or (2 L,), the load does no work on: they may break a symmetry."""
    cosine = np.abs(modes.T @ soft.pull) / (np.linalg.norm(soft.pull) * np.linalg.norm(modes, axis=0))
    return np.asarray(cosine < SYMMETRIC)


def forces_at(
    system: System, soft: Soft, step: FloatArray, value: float, tolerance: float, like: Resolution
) -> Balance:
    """Forces after a step of the edges at a value of the control."""
    state = soft.here.state
    patches = state.patches.moved(step * soft.scale)
    if not patches.is_ordered:
        raise LostError
    here = balance(system, patches, state.penetration, value, tolerance, like)
    if not here.all_tensile:
        raise LostError
    return here


def eigenvalue_gradient(system: System, soft: Soft, tolerance: float) -> FloatArray:
    """D_v H v, the derivative of the smallest eigenvalue by the edges, (2 L,)."""
    distance = SIDEWAYS / soft.size(soft.mode)
    beside = forces_at(system, soft, distance * soft.mode, soft.value, tolerance, soft.here.state.resolution)
    return np.asarray((symmetric_part(beside.hessian, soft.scale) - soft.hessian) @ soft.mode / distance)


def refined(system: System, soft: Soft, step: FloatArray, value: float, tolerance: float, other: bool) -> Balance:
    """Forces after a step, at a finer tolerance; with another resolution than it asks for, where errors are wanted."""
    wanted = resolve(system.elastic, soft.here.state.patches.moved(step * soft.scale), tolerance)
    return forces_at(system, soft, step, value, tolerance, finer(wanted) if other else wanted)


def to_rest(soft: Soft) -> FloatArray:
    """Newton step of the edges to the equilibrium at the same control, (2 L,)."""
    return np.asarray(-np.linalg.solve(soft.hessian, soft.gradient))


def after_step(system: System, here: Balance, value: float, outward: FloatArray, change: float) -> EventNumbers:
    """Numbers of the state to which short motions of the edges and of the control lead, to second order."""
    state, control = here.state, system.control
    rate = control.rate(state)
    carried = float(here.load_gradient @ outward)
    deeper = rate * (change - control.load_weight * carried)
    work = float(here.gradient @ outward + outward @ here.hessian @ outward / 2) + change * rate * carried
    work += change * (control.force(state) + change / 2 * control.force_rate(state))
    return EventNumbers(
        value + change,
        state.penetration + deeper,
        state.load + carried + state.load_rate * deeper,
        here.potential + work,
    )
