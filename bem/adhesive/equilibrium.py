"""Adhesive equilibrium of the edges at given control: the forces on them, and Newton along a branch.

An equilibrium has G_e = K_e^2/4 = w_e at every edge with K_e > 0, and is stable where the Hessian of the potential
under control is positive definite.  Newton's method for it is that of bem/path; where a branch ends, descent.py
continues.  Dimensionless.  Source: Carbone, Scaraggi, Tartaglino,
Eur. Phys. J. E 30 (2009) 65, section 3.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from scipy.linalg import lapack

from bem.adhesive.lowest_modes import lowest_modes
from bem.adhesive.pinning import PinningWaves
from bem.elastic.collocation import ROUNDINGS, Elastic, Evaluation, Resolution, evaluate
from bem.elastic.second_sensitivities import EdgeFields
from bem.elastic.sensitivities import stress_intensity_jacobian
from bem.geometry.arrays import FloatArray
from bem.geometry.patches import Patches
from bem.loading.control import Control
from bem.loading.increments import Effort
from bem.loading.interface_law import InterfaceLaw

ENERGY_TRUNCATION = 3e-3  # relative error of the energy over the square of the tolerance of the evaluation
KERNEL_TRUNCATION = 5e-3  # relative error of the energy over the tolerance, if an effect adds to the kernel; measured


@dataclass(frozen=True, eq=False)
class System:
    """Elastic body, law of adhesion and control of an equilibrium, and the count of its evaluations."""

    elastic: Elastic
    law: InterfaceLaw
    control: Control
    effort: Effort = field(default_factory=Effort)

    @cached_property
    def sloped(self) -> System:
        """System with edge slopes switched on: every state also holds the slopes that edges make at edges."""
        return replace(self, elastic=replace(self.elastic, slopes=True))

    @cached_property
    def pinning(self) -> PinningWaves:
        """Waves of the profile that may pin edges, with their strength."""
        return PinningWaves.of(self.elastic.profile)


@dataclass(frozen=True, eq=False)
class Balance:
    """Forces on the edges of a state, dimensionless.

    Attributes
    ----------
    state : Evaluation
        At the target.
    work, work_gradient : (2 L,) arrays
        w at the edges, and its derivative by the outward motion of each.
    gradient : (2 L,) array
        dU / d(outward motion) = G - w.
    jacobian : (2 L, 2 L) array
        dK / d(outward motion) at fixed penetration.
    load_gradient : (2 L,) array
        d(load) / d(outward motion).
    potential : float
        Potential under control, which the equilibrium minimises.
    adhesion_energy : float
        U_ad.
    penetration_rate : float
        Share of an error in the heights that the control lets pass as one of Delta.
    """

    state: Evaluation
    work: FloatArray
    work_gradient: FloatArray
    gradient: FloatArray
    jacobian: FloatArray
    load_gradient: FloatArray
    potential: float
    adhesion_energy: float
    penetration_rate: float

    @cached_property
    def fixed_penetration_hessian(self) -> FloatArray:
        """Hessian of U, (2 L, 2 L)."""
        hessian = (self.state.stress_intensity / 2)[:, None] * self.jacobian
        hessian.flat[:: self.work.size + 1] -= self.work_gradient
        return hessian

    @cached_property
    def hessian(self) -> FloatArray:
        """Hessian of the potential under control, (2 L, 2 L)."""
        if self.penetration_rate == 1.0:
            return self.fixed_penetration_hessian
        share = (1 - self.penetration_rate) / self.state.load_rate
        return self.fixed_penetration_hessian - (share * self.load_gradient)[:, None] * self.load_gradient

    @cached_property
    def rounding(self) -> FloatArray:
        """Accuracy of K in double precision, (2 L,)."""
        return self.state.rounding(self.penetration_rate)

    @property
    def energy(self) -> float:
        """U = U_el + U_ad."""
        return self.state.elastic_energy + self.adhesion_energy

    @property
    def residual(self) -> float:
        """max |G/w - 1| over the edges."""
        return float(np.max(np.abs(self.gradient / self.work)))

    def is_equilibrium(self, limit: float) -> bool:
        """Return whether |G/w - 1| at every edge is at most the limit, or the rounding of K where w is tiny."""
        missing = np.abs(self.gradient / self.work)
        if np.all(missing <= limit):
            return True
        return bool(np.all((missing <= limit) | (missing <= ROUNDINGS * self.rounding / np.sqrt(self.work))))

    @property
    def all_tensile(self) -> bool:
        """True if K > 0 at every edge, as at the tip of a crack."""
        return bool((self.state.stress_intensity > 0).all())

    @cached_property
    def hessian_by_edge_scale(self) -> FloatArray:
        """Symmetric part of the Hessian with every edge in units of its edge scale, (2 L, 2 L)."""
        return symmetric_part(self.hessian, self.state.patches.edge_scale)

    @cached_property
    def factor(self) -> FloatArray | None:
        """U with U^T U = `hessian_by_edge_scale`, (2 L, 2 L); None where that is not positive definite."""
        factor, info = lapack.dpotrf(self.hessian_by_edge_scale, lower=0, clean=0)
        return np.asarray(factor) if info == 0 else None

    @cached_property
    def edge_fields(self) -> EdgeFields:
        """Pressure fields that moving edges add, at all edges."""
        return EdgeFields(self.state, self.jacobian)

    @property
    def stable_at_fixed_load(self) -> bool:
        """True if the Hessian bordered with Delta, of U - load Delta, is positive definite."""
        soft = self.fixed_penetration_hessian - np.outer(self.load_gradient, self.load_gradient) / self.state.load_rate
        return bool(lowest_modes(symmetric_part(soft, self.scale), 1)[0][0] > 0)

    def response(self, force: FloatArray) -> FloatArray:
        """Return the outward motion of the edges under a force on them, H^-1 force, (2 L,)."""
        scale = self.state.patches.edge_scale
        if self.factor is not None:
            return np.asarray(scale * lapack.dpotrs(self.factor, scale * force, lower=0)[0])
        return np.asarray(scale * np.linalg.solve(self.hessian_by_edge_scale, scale * force))

    @cached_property
    def stiffness(self) -> float:
        """d(load)/dDelta along the branch, the edges following.

        At fixed penetration H is larger by (1 - penetration_rate) / load_rate times the square of the load gradient.
        """
        rate, share = self.state.load_rate, self.penetration_rate
        softened = float(self.load_gradient @ self.response(self.load_gradient))
        return (rate - share * softened) / (1 + (1 - share) * softened / rate)

    @property
    def smallest_eigenvalue(self) -> float:
        """Smallest eigenvalue of the Hessian scaled by work of adhesion and edge scale."""
        return float(lowest_modes(self.scaled_hessian, 1)[0][0])

    @property
    def hessian_asymmetry(self) -> float:
        """max |H - H^T| / max |H|."""
        matrix = self.fixed_penetration_hessian
        return float(np.abs(matrix - matrix.T).max() / np.abs(matrix).max())

    @property
    def scaled_hessian(self) -> FloatArray:
        """Symmetric part of the Hessian, scaled: of order 1 at edges of patches of any size, (2 L, 2 L)."""
        return symmetric_part(self.hessian, self.scale)

    @property
    def scale(self) -> FloatArray:
        """Root of edge scale over work of adhesion of each edge, (2 L,)."""
        return np.asarray(np.sqrt(self.state.patches.edge_scale / self.work))


def symmetric_part(hessian: FloatArray, scale: FloatArray) -> FloatArray:
    """Return the symmetric part of a Hessian in units of length of every edge, (2 L, 2 L)."""
    result = hessian + hessian.T
    result *= (scale / 2)[:, None]  # in place: fresh memory for large matrices takes longer than the product
    result *= scale
    return result


def edge_positions(patches: Patches) -> FloatArray:
    """Return all left edges, then all right edges, (2 L,)."""
    return np.concatenate([patches.left, patches.right])


def balance(
    system: System,
    patches: Patches,
    penetration: float,
    target: float,
    tolerance: float,
    resolution: Resolution | None = None,
) -> Balance:
    """Evaluate the forces on the edges at the target; load control starts from `penetration`."""
    system.effort.evaluations += 1
    state = evaluate(system.elastic, patches, system.control.guess(penetration, target), tolerance, resolution)
    return forces(system, system.control.reach(state, target), target)


def forces(system: System, state: Evaluation, target: float, known: Balance | None = None) -> Balance:
    """Return the forces on the edges of an evaluated state at the target; `known` are forces on the same edges."""
    intensity = state.stress_intensity
    if known is None:
        work, work_gradient, adhesion_energy = _adhesion(system, state.patches)
    else:
        work, work_gradient, adhesion_energy = known.work, known.work_gradient, known.adhesion_energy
    return Balance(
        state=state,
        work=work,
        work_gradient=work_gradient,
        gradient=intensity**2 / 4 - work,
        jacobian=stress_intensity_jacobian(state),
        load_gradient=intensity * state.stress_intensity_rate / 2,
        potential=system.control.potential(state.penetration, state.load, state.elastic_energy + adhesion_energy),
        adhesion_energy=adhesion_energy,
        penetration_rate=system.control.penetration_rate(state),
    )


def _adhesion(system: System, patches: Patches) -> tuple[FloatArray, FloatArray, float]:
    """Return w at the edges, (2 L,), its derivative by their outward motion, and U_ad."""
    work, work_gradient = system.law.work_and_gradient(edge_positions(patches))
    work_gradient[: patches.count] *= -1.0
    return work, work_gradient, system.law.energy(patches)


def energy_noise(system: System, first: Balance, last: Balance, tolerance: float) -> float:
    """Return the error of the difference in elastic energy of two states evaluated to `tolerance`, dimensionless."""
    share = ENERGY_TRUNCATION * tolerance**2 if system.elastic.kernel is None else KERNEL_TRUNCATION * tolerance
    return share * (first.state.elastic_energy + last.state.elastic_energy)
