"""Equilibria by dense algebra alone, next to a state of the solver: what its error estimates are measured against.

Newton on K_e = 2 sqrt(w_e) (K_e = 0 without adhesion) and on the condition of the control, with the plain dense
evaluation (dense.py: own nodes, moments, kernels and derivatives), until its steps are rounding. Work and energy of
adhesion, stiffness and conversions are this file's own. Dimensionless inside: lengths period / 2 pi, heights the rms
height a, stresses E* q0 a / 2.

Far from an answer (routes/dense_algebra.py) steps are limited to a third of the edge scale.
"""

from dataclasses import dataclass

import numpy as np

from bem.elastic.layer import Layer
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.geometry.scaling import Solid
from bem.scene.result import State
from bem.scene.scene import Scene
from validation.harness.arrays import FloatArray, IntArray
from validation.references.adapters import problem_of
from validation.references.dense import DenseState, SmoothKernel, dense_nodes, evaluate_dense

STEPS, FAR_STEPS = 8, 60
FARTHEST = 0.3  # of the edge scale, where Newton starts far away
SMALLEST_STEP = 1e-13  # of an edge, in radians
QUADRATURE = np.polynomial.legendre.leggauss(40)


class NoReferenceError(ArithmeticError):
    """Newton did not converge: the state is not an equilibrium, or not near one."""


@dataclass(frozen=True)
class Interface:
    """w(x) = gamma sqrt(1 + h'^2), dimensionless; `slope` is the true slope per dimensionless one."""

    gamma: float
    profile: Profile
    slope: float

    def work(self, x: FloatArray) -> FloatArray:
        """w at the positions x, same shape."""
        return np.asarray(self.gamma * np.sqrt(1 + (self.slope * self.profile.slope(x)) ** 2))

    def critical(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """K = 2 sqrt(w) and its derivative by x."""
        rise = self.slope**2 * self.profile.slope(x) * self.profile.curvature(x)
        work = self.work(x)
        return 2 * np.sqrt(work), self.gamma**2 * rise / work**1.5

    def energy(self, left: FloatArray, right: FloatArray) -> float:
        """-int w dx by Gauss-Legendre on panels shorter than the shortest wave, and than kinks of w on steep crests."""
        node, weight = QUADRATURE
        steepest = self.slope * float(np.abs(self.profile.amplitudes) @ self.profile.orders)
        total = 0.0
        for a, b in zip(left, right, strict=True):
            ends = np.linspace(a, b, 2 + int(np.ceil((b - a) * self.profile.max_order * (1 + steepest))))
            middle, half = (ends[1:] + ends[:-1]) / 2, np.diff(ends) / 2
            total += float(np.sum(self.work(middle[:, None] + half[:, None] * node) @ weight * half))
        return -total


def reference(scene: Scene, state: State, refinement: int = 1) -> dict[str, float]:
    """Every scalar of a state with edges, in its unit, by dense algebra.

    `refinement` multiplies the nodes that dense algebra needs; 2 doubles the resolution. NoReferenceError where Newton
    did not converge, ValueError for a table of the scene that dense algebra does not provide.
    """
    problem, surface = problem_of(scene, "dense algebra", "layer", "adhesion"), scene.surface()
    profile, solid = surface.scaled(), Solid(problem.youngs_modulus, problem.poisson_ratio)
    modulus = problem.youngs_modulus / (1 - problem.poisson_ratio**2)
    q0, rms = 2 * np.pi / surface.period, surface.rms_height
    stress, energy = modulus * q0 * rms / 2, modulus * rms**2 / (2 * surface.period)
    interface = None
    if problem.work_of_adhesion is not None:
        gamma = problem.work_of_adhesion / (modulus * rms**2 * q0 / 2)
        interface = Interface(gamma, profile, q0 * rms if problem.slope_term else 0.0)
    kernel, compliance, terms = None, 0.0, np.zeros(len(state.edges), dtype=np.int64)
    edges = np.array(state.edges) * q0
    left, right = edges[:, 0], edges[:, 1]
    if problem.thickness is not None:
        layer = Layer(problem.thickness)
        addition = layer.kernel(solid, surface.period, 1e-16)
        kernel = SmoothKernel(addition.smooth, addition.slope)
        terms = addition.modes_of_kernel(right - left, 1e-14).astype(np.int64)
        compliance = layer.mean_compliance(solid)
    nodes = refinement * np.maximum(dense_nodes(profile, left, right), terms)
    target, weights = _condition(scene, state, compliance, rms, stress)
    left, right, found, _ = converged(
        profile, left, right, state.penetration / rms, nodes, kernel, interface, target, weights
    )
    critical = np.zeros(2 * left.size) if interface is None else interface.critical(np.concatenate([left, right]))[0]
    jacobian, _ = _residual(found, left, right, interface)
    stiffness = found.load_rate - found.load_jacobian @ np.linalg.solve(jacobian, found.stress_intensity_rate)
    adhesion = 0.0 if interface is None else interface.energy(left, right)
    pressure, penetration = found.load / (2 * np.pi) * stress, found.penetration * rms
    return {
        "mean_pressure": pressure,
        "contact_fraction": float(np.sum(right - left)) / (2 * np.pi),
        "penetration": penetration,
        "separation": surface.max_height - penetration,
        "total_displacement": penetration + compliance * pressure,
        "elastic_energy": found.elastic_energy * energy,
        "adhesion_energy": adhesion * energy,
        "total_energy": (found.elastic_energy + adhesion) * energy,
        "stress_intensity_max": float(np.max(critical)) * stress / np.sqrt(q0),
        "contact_stiffness": float(stiffness) / (2 * np.pi) * stress / rms,
    }


def _condition(
    scene: Scene, state: State, compliance: float, rms: float, stress: float
) -> tuple[float, tuple[float, float]]:
    """What the control fixes: target = alpha Delta + beta load, dimensionless."""
    control = scene.loading.control
    if control == "mean_pressure":
        nearest = min(scene.loading.targets, key=lambda target: abs(target - state.mean_pressure))
        return 2 * np.pi * nearest / stress, (0.0, 1.0)
    if control == "total_displacement":
        assert state.total_displacement is not None
        total = state.total_displacement
        nearest = min(scene.loading.targets, key=lambda target: abs(target - total))
        return nearest / rms, (1.0, compliance * stress / (2 * np.pi * rms))
    return state.penetration / rms, (1.0, 0.0)


def _residual(
    here: DenseState, left: FloatArray, right: FloatArray, interface: Interface | None
) -> tuple[FloatArray, FloatArray]:
    """d(K - K_c) / d(outward motion), (2 L, 2 L), and K - K_c, (2 L,)."""
    if interface is None:
        return here.stress_intensity_jacobian, here.stress_intensity
    critical, slope = interface.critical(np.concatenate([left, right]))
    outward = np.repeat([-1.0, 1.0], left.size)
    return here.stress_intensity_jacobian - np.diag(outward * slope), here.stress_intensity - critical


def converged(
    profile: Profile,
    left: FloatArray,
    right: FloatArray,
    penetration: float,
    nodes: IntArray,
    kernel: SmoothKernel | None,
    interface: Interface | None,
    target: float,
    weights: tuple[float, float],
    far: bool = False,
) -> tuple[FloatArray, FloatArray, DenseState, int]:
    """Edges and state of the equilibrium next to given edges, or far from them, and how often it was evaluated."""
    alpha, beta = weights
    count = left.size
    smallest = np.inf
    for evaluations in range(1, (FAR_STEPS if far else STEPS) + 1):
        here = evaluate_dense(profile, left, right, penetration, nodes, kernel)
        jacobian, miss = _residual(here, left, right, interface)
        matrix = np.block(
            [
                [jacobian, here.stress_intensity_rate[:, None]],
                [beta * here.load_jacobian[None, :], np.array([[alpha + beta * here.load_rate]])],
            ]
        )
        step = np.linalg.solve(matrix, -np.append(miss, alpha * penetration + beta * here.load - target))
        size = float(np.max(np.abs(step)))
        if size < SMALLEST_STEP or (size < 1e-10 and size > 0.5 * smallest):  # no longer falls: rounding
            return left, right, here, evaluations
        smallest = size
        if far:
            step = _limited(step, here.stress_intensity, Patches(left, right).edge_scale)
        left, right, penetration = left - step[:count], right + step[count:-1], penetration + step[-1]
    raise NoReferenceError(f"the last step of Newton is {smallest:.1e}")


def _limited(step: FloatArray, stress_intensity: FloatArray, edge_scale: FloatArray) -> FloatArray:
    """A step no longer than `FARTHEST`; edges that close (K < 0) move outward, and nothing else."""
    closing = stress_intensity < 0
    if np.any(closing):
        return np.append(np.where(closing, FARTHEST * edge_scale, 0.0), 0.0)
    return step * min(1.0, FARTHEST / float(np.max(np.abs(step[:-1]) / edge_scale)))
