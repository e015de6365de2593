"""Equilibria by dense algebra alone, next to given edges: the reference for the error estimates of a solver.

Newton on K_e = 2 sqrt(w_e) (K_e = 0 without adhesion) and on the condition of the control, with the plain dense
evaluation (dense.py: own nodes, moments, kernels and derivatives), until its steps are rounding. Work and energy of
adhesion, stiffness and conversions are this file's own. Dimensionless inside: lengths period / 2 pi, heights the rms
height a, stresses E* q0 a / 2.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from validation.harness.arrays import FloatArray, IntArray
from validation.harness.route import Problem
from validation.references.closed_forms import uniform_compliance
from validation.references.dense import (
    DenseState,
    LayerKernel,
    dense_nodes,
    evaluate_dense,
    layer_nodes,
)
from validation.references.waves import Waves

STEPS = 8
SMALLEST_STEP = 1e-13  # of an edge, in radians
QUADRATURE = np.polynomial.legendre.leggauss(40)


class NoReferenceError(ArithmeticError):
    """Newton did not converge: the state is not an equilibrium, or not near one."""


@dataclass(frozen=True)
class Interface:
    """w(x) = gamma sqrt(1 + h'^2), dimensionless; `slope` is the true slope per dimensionless one."""

    gamma: float
    profile: Waves
    slope: float

    def work(self, x: FloatArray) -> FloatArray:
        """Return w at the positions x, same shape."""
        return np.asarray(self.gamma * np.sqrt(1 + (self.slope * self.profile.height(x, 1)) ** 2))

    def critical(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return K = 2 sqrt(w) and its derivative by x."""
        rise = self.slope**2 * self.profile.height(x, 1) * self.profile.height(x, 2)
        work = self.work(x)
        return 2 * np.sqrt(work), self.gamma**2 * rise / work**1.5

    def energy(self, left: FloatArray, right: FloatArray) -> float:
        """Return -int w dx by Gauss-Legendre on panels shorter than waves and than kinks of w on crests."""
        node, weight = QUADRATURE
        steepest = self.slope * float(np.abs(self.profile.amplitudes) @ self.profile.orders)
        total = 0.0
        for a, b in zip(left, right, strict=True):
            ends = np.linspace(a, b, 2 + int(np.ceil((b - a) * int(self.profile.orders.max()) * (1 + steepest))))
            middle, half = (ends[1:] + ends[:-1]) / 2, np.diff(ends) / 2
            total += float(np.sum(self.work(middle[:, None] + half[:, None] * node) @ weight * half))
        return -total


def equilibrium(
    problem: Problem, edges: ArrayLike, penetration: float, target: float, refinement: float = 1
) -> dict[str, float]:
    """Return every scalar of the equilibrium next to edges (n_patches, 2) and penetration, in m, in its unit.

    Parameters
    ----------
    problem : Problem
        Raw numbers of solid, profile, layer and adhesion; its `control` is one of "mean_pressure" (Pa),
        "total_displacement", "penetration" and "separation" (m).
    target : float
        Prescribed value of the control.
    refinement : float
        Factor on the nodes that dense algebra needs for all digits.

    Raises
    ------
    NoReferenceError
        Newton does not converge.
    """
    surface = Waves(problem.period, *problem.harmonics)
    modulus = problem.youngs_modulus / (1 - problem.poisson_ratio**2)
    q0, rms = 2 * np.pi / surface.period, surface.rms_height
    stress, energy = modulus * q0 * rms / 2, modulus * rms**2 / (2 * surface.period)
    profile = Waves(2 * np.pi, surface.orders, surface.amplitudes / rms, surface.phases)
    interface = None
    if problem.work_of_adhesion is not None:
        gamma = problem.work_of_adhesion / (modulus * rms**2 * q0 / 2)
        interface = Interface(gamma, profile, q0 * rms if problem.slope_term else 0.0)
    left, right = np.asarray(edges, dtype=np.float64).T * q0
    nodes, kernel, compliance = dense_nodes(profile, left, right), None, 0.0
    if problem.thickness is not None:
        depth = q0 * problem.thickness
        kernel, nodes = LayerKernel.of(depth, problem.poisson_ratio), np.maximum(nodes, layer_nodes(left, right, depth))
        compliance = uniform_compliance(problem.thickness, problem.youngs_modulus, problem.poisson_ratio)
    aim, weights = {  # aim = alpha Delta + beta load, dimensionless
        "mean_pressure": (2 * np.pi * target / stress, (0.0, 1.0)),
        "total_displacement": (target / rms, (1.0, compliance * stress / (2 * np.pi * rms))),
        "penetration": (target / rms, (1.0, 0.0)),
        "separation": (profile.highest - target / rms, (1.0, 0.0)),
    }[problem.control]
    nodes = np.ceil(refinement * nodes).astype(np.int64)
    left, right, state = _converged(
        profile,
        left,
        right,
        penetration / rms,
        nodes,
        kernel,
        interface,
        aim,
        weights,
    )
    critical = np.zeros(2 * left.size) if interface is None else interface.critical(np.concatenate([left, right]))[0]
    jacobian, _ = _residual(state, left, right, interface)
    stiffness = state.load_rate - state.load_jacobian @ np.linalg.solve(jacobian, state.stress_intensity_rate)
    adhesion = 0.0 if interface is None else interface.energy(left, right)
    pressure, depth = state.load / (2 * np.pi) * stress, state.penetration * rms
    return {
        "mean_pressure": pressure,
        "contact_fraction": float(np.sum(right - left)) / (2 * np.pi),
        "penetration": depth,
        "separation": surface.highest - depth,
        "total_displacement": depth + compliance * pressure,
        "elastic_energy": state.elastic_energy * energy,
        "adhesion_energy": adhesion * energy,
        "total_energy": (state.elastic_energy + adhesion) * energy,
        "stress_intensity_max": float(np.max(critical)) * stress / np.sqrt(q0),
        "contact_stiffness": float(stiffness) / (2 * np.pi) * stress / rms,
    }


def _residual(
    state: DenseState, left: FloatArray, right: FloatArray, interface: Interface | None
) -> tuple[FloatArray, FloatArray]:
    """Return d(K - K_c) / d(outward motion), (2 L, 2 L), and K - K_c, (2 L,)."""
    if interface is None:
        return state.stress_intensity_jacobian, state.stress_intensity
    critical, slope = interface.critical(np.concatenate([left, right]))
    outward = np.repeat([-1.0, 1.0], left.size)
    return state.stress_intensity_jacobian - np.diag(outward * slope), state.stress_intensity - critical


def _converged(
    profile: Waves,
    left: FloatArray,
    right: FloatArray,
    penetration: float,
    nodes: IntArray,
    kernel: LayerKernel | None,
    interface: Interface | None,
    target: float,
    weights: tuple[float, float],
) -> tuple[FloatArray, FloatArray, DenseState]:
    """Return edges and state of the equilibrium next to given edges."""
    alpha, beta = weights
    count = left.size
    smallest = np.inf
    for _ in range(STEPS):
        state = evaluate_dense(profile, left, right, penetration, nodes, kernel)
        jacobian, miss = _residual(state, left, right, interface)
        matrix = np.block(
            [
                [jacobian, state.stress_intensity_rate[:, None]],
                [beta * state.load_jacobian[None, :], np.array([[alpha + beta * state.load_rate]])],
            ]
        )
        step = np.linalg.solve(matrix, -np.append(miss, alpha * penetration + beta * state.load - target))
        size = float(np.max(np.abs(step)))
        if size < SMALLEST_STEP or (size < 1e-10 and size > 0.5 * smallest):  # no longer falls: rounding
            return left, right, state
        smallest = size
        left, right, penetration = left - step[:count], right + step[count:-1], penetration + step[-1]
    raise NoReferenceError(f"the last step of Newton is {smallest:.1e}")
