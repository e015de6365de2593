"""Forces near a neutral equilibrium in fixed units of length, the softest modes of their Hessian, and steps from there.

Derivatives of the smallest eigenvalue mu, D_v H v by the edges and v . dH/dtau v by the control, are exact
(third_derivatives.py).  Dimensionless.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem.adhesive.equilibrium import Balance, System, balance, symmetric_part
from bem.adhesive.lowest_modes import known_mode, lowest_modes
from bem.adhesive.third_derivatives import hessian_change_times
from bem.elastic.collocation import Resolution, finer, resolve
from bem.loading.path_events import EventNumbers

FloatArray = NDArray[np.float64]

LONGEST_STEP = 0.2  # of the edge scale
NEAR = 1e-3  # of the edge scale: the rest of a step is left to finer evaluations
SYMMETRIC = 1e-3  # cosine between a mode and the pull of the load, below which it may break a symmetry


class LostError(Exception):
    """A step that leads away from all equilibria."""


@dataclass(frozen=True, eq=False)
class Soft:
    """Forces on the edges in fixed units of length, (2 L,), with the modes of their Hessian.

    Parameters
    ----------
    system : System
    here : Balance
    value : float
        Of the control.
    scale : (2 L,) array
        The units.
    last : (2 L,) array, optional
        A mode, with which the softest one goes; found the faster the closer to it.
    every : bool
        Whether all modes are wanted, not the softest alone.
    """

    system: System
    here: Balance
    value: float
    scale: FloatArray
    last: FloatArray | None = None
    every: bool = False

    @cached_property
    def gradient(self) -> FloatArray:
        """Of the potential, (2 L,)."""
        return self.here.gradient * self.scale

    @cached_property
    def hessian(self) -> FloatArray:
        """Its symmetric part, (2 L, 2 L)."""
        return symmetric_part(self.here.hessian, self.scale)

    @cached_property
    def pull(self) -> FloatArray:
        """Derivative of the gradient by the control, (2 L,)."""
        return self.here.load_gradient * self.scale * self.system.control.rate(self.here.state)

    @property
    def eigenvalues(self) -> FloatArray:
        """Of the Hessian, ascending: all, the lowest two, or the lowest where the others are positive."""
        return self._lowest[0]

    @property
    def modes(self) -> FloatArray:
        """Theirs, one a column."""
        return self._lowest[1]

    @property
    def mode(self) -> FloatArray:
        """The softest one, (2 L,)."""
        return np.asarray(self.modes[:, 0])

    @property
    def is_alone(self) -> bool:
        """Whether the eigenvalues of all other modes are positive."""
        return bool(self.eigenvalues[1:2].min(initial=1.0) > 0)

    @property
    def eigenvalue_rate(self) -> float:
        """v . dH/dtau v for the softest mode v."""
        outward = self.mode * self.scale
        return float(outward @ hessian_change_times(self.system, self.here, None, 1.0, outward))

    @property
    def edge_scale(self) -> FloatArray:
        """Edge scale, (2 L,)."""
        return np.asarray(self.here.state.patches.edge_scale / self.scale)

    def size(self, step: FloatArray) -> float:
        """Largest part of its edge scale by which an edge moves in a step."""
        return float(np.max(np.abs(step) / self.edge_scale))

    @cached_property
    def _lowest(self) -> tuple[FloatArray, FloatArray]:
        known = None if self.every or self.last is None else known_mode(self.hessian, self.last)
        eigenvalues, modes = known or lowest_modes(self.hessian, None if self.every else 2)
        if self.last is not None:
            modes *= np.sign(modes[:, 0] @ self.last) or 1.0
        return eigenvalues, modes


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
    here = balance(system.sloped, patches, state.penetration, value, tolerance, like)
    if not here.all_tensile:
        raise LostError
    return here


def eigenvalue_gradient(soft: Soft) -> FloatArray:
    """D_v H v, the derivative of the smallest eigenvalue by the edges, (2 L,)."""
    outward = soft.mode * soft.scale
    return np.asarray(soft.scale * hessian_change_times(soft.system, soft.here, outward, 0.0, outward))


def refined(system: System, soft: Soft, step: FloatArray, value: float, tolerance: float, other: bool) -> Balance:
    """Forces after a step, at a finer tolerance; with another resolution than it asks for, where errors are wanted."""
    patches = soft.here.state.patches.moved(step * soft.scale)
    wanted = resolve(system.elastic, patches, tolerance)
    if other:
        wanted = finer(system.elastic, patches, wanted, 1e-2 * tolerance)
    return forces_at(system, soft, step, value, tolerance, wanted)


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
