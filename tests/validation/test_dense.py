"""The dense reference evaluation against closed forms, its own energy, and exact invariances."""

from dataclasses import dataclass

import numpy as np
import pytest
from rough_surfaces import cut_edges

from bem.geometry.profile import Profile
from validation.references.closed_forms import Sinusoid
from validation.references.dense import LayerKernel, dense_nodes, evaluate_dense

AMPLITUDE = 1.3


@dataclass(frozen=True)
class Wave:
    """Johnson (1995): one patch on D cos(x - crest); without alpha Westergaard's.

    In units of the solver, in which p* = pi E* D / period is D, hence E* = 2.
    """

    fraction: float
    alpha: float = 0.0
    crest: float = 0.0

    @property
    def exact(self):
        return Sinusoid(AMPLITUDE, 2 * np.pi, 2.0, 0.0, self.alpha)

    @property
    def psi(self):
        return np.pi * self.fraction / 2

    @property
    def profile(self):
        return Profile.from_harmonics(2 * np.pi, [1], [AMPLITUDE], [-self.crest])

    @property
    def penetration(self):
        return float(self.exact.penetration(self.psi))

    def solve(self):
        edges = np.array([self.crest - 2 * self.psi]), np.array([self.crest + 2 * self.psi])
        return evaluate_dense(self.profile, *edges, self.penetration)


WAVES = [
    Wave(fraction, alpha, crest)
    for fraction, crest in [(0.02, 0.0), (0.3, 1.7), (0.53, 0.0), (0.95, -0.4)]
    for alpha in (0.0, 0.1, 0.5)
]
by_wave = pytest.mark.parametrize("case", WAVES, ids=lambda c: f"fraction={c.fraction}-alpha={c.alpha}")


def rough(harmonics=40, seed=0):
    return Profile.self_affine(2 * np.pi, 0.7, 1.0, harmonics, seed).scaled()


def edge_moved(left, right, edge, amount):
    left, right = left.copy(), right.copy()
    if edge < left.size:
        left[edge] -= amount
    else:
        right[edge - left.size] += amount
    return left, right


def central_difference(function, step):
    """Fourth-order central difference at zero."""
    near, far = function(step) - function(-step), function(2 * step) - function(-2 * step)
    return (8 * near - far) / (12 * step)


def step_of(state, edge):
    """2e-4 of the length in which the edge may move: of its patch or of the gap beside it."""
    left, right = state.pressure.left, state.pressure.right
    gap = np.append(left[1:], left[0] + 2 * np.pi) - right
    return 2e-4 * np.minimum(np.tile(right - left, 2), np.append(np.roll(gap, 1), gap))[edge]


@pytest.fixture(scope="module")
def rough_state():
    profile = rough()
    left, right, penetration = cut_edges(profile, 0.4)
    nodes = dense_nodes(profile, left, right) + 10
    state = evaluate_dense(profile, left, right, penetration, nodes)

    def at(edge=0, amount=0.0, penetration=penetration):
        return evaluate_dense(profile, *edge_moved(left, right, edge, amount), penetration, nodes)

    return state, at


@by_wave
def test_mean_pressure_is_johnsons(case):
    # measured 5e-14 at fraction 0.95, below 4e-16 up to 0.53
    assert abs(case.solve().load / (2 * np.pi) - case.exact.mean_pressure(case.psi)) <= 2e-13 * AMPLITUDE


@by_wave
def test_stress_intensity_is_critical(case):
    # measured 9e-14
    critical = 2 * np.sqrt(case.exact.work_of_adhesion)
    np.testing.assert_allclose(case.solve().stress_intensity, critical, rtol=0, atol=2.5e-13 * AMPLITUDE)


def test_inner_pressure_of_nearly_complete_contact_is_that_of_complete_contact():
    # sigma = sigma_0 + D cos x but for Westergaard's sqrt(1 - cos^2(psi) / cos^2(x/2)), here 0.9997 at x = pi/6
    case = Wave(0.99)
    charge = case.solve().pressure.charges[0]
    x, half = np.pi / 6, np.pi * 0.99
    t = x / half
    sigma = np.polynomial.chebyshev.chebval(t, charge) / (half * np.sqrt(1 - t * t))
    psi = half / 2
    exact = 2 * AMPLITUDE * np.cos(x / 2) * np.sqrt(np.sin(psi) ** 2 - np.sin(x / 2) ** 2)
    assert abs(sigma / exact - 1) <= 1e-12  # measured 4e-14
    assert abs(exact / (AMPLITUDE * (1 + np.cos(x))) - 1) < 2e-4


@pytest.mark.parametrize("edge", range(8), ids=lambda e: f"edge{e}")
def test_energy_derivative_is_the_release_rate(rough_state, edge):
    state, at = rough_state
    slope = central_difference(lambda d: at(edge, d).elastic_energy, step_of(state, edge))
    # measured 1e-11
    assert abs(slope - state.stress_intensity[edge] ** 2 / 4) <= 3e-11 * np.max(state.stress_intensity**2)


@pytest.mark.parametrize("edge", range(8), ids=lambda e: f"edge{e}")
def test_stress_intensity_jacobian_is_the_derivative(rough_state, edge):
    state, at = rough_state
    slope = central_difference(lambda d: at(edge, d).stress_intensity, step_of(state, edge))
    exact = state.stress_intensity_jacobian[:, edge]
    assert np.max(np.abs(slope - exact)) <= 2e-9 * np.max(np.abs(exact))  # measured 9e-10


def test_energy_derivative_by_penetration_is_the_load(rough_state):
    state, at = rough_state
    slope = central_difference(lambda d: at(penetration=state.penetration + d).elastic_energy, 0.1)
    assert slope == pytest.approx(state.load, rel=1e-13)


def test_mixed_derivatives_agree(rough_state):
    # d2 U / d edge d Delta from either side; measured 1e-13
    state, _ = rough_state
    release = state.stress_intensity / 2 * state.stress_intensity_rate
    np.testing.assert_allclose(release, state.load_jacobian, rtol=0, atol=1e-12 * np.max(np.abs(release)))


def test_too_few_nodes_show_in_the_coefficients(rough_state):
    state, _ = rough_state
    left, right = state.pressure.left, state.pressure.right
    nodes = dense_nodes(rough(), left, right, margin=0.5) - 16
    with_few = evaluate_dense(rough(), left, right, state.penetration, nodes)
    last = [np.max(np.abs(q[-3:])) / np.max(np.abs(q)) for q in with_few.pressure.charges]
    assert max(last) >= 1e-6


def test_smooth_kernel_of_one_mode_softens_that_mode():
    """S = -2 (c - 1) cos x scales the compliance of mode 1 by c; near complete contact D cos x takes sigma_1 = D/c."""
    ratio = 0.8
    kernel = LayerKernel(np.array([1.0]), np.array([1 - ratio]))
    half = np.pi * 0.4
    left, right = np.array([-half]), np.array([half])
    case = Wave(0.4)
    with_kernel = evaluate_dense(case.profile, left, right, case.penetration, smooth_kernel=kernel)
    # the first mode of the pressure times 1 - c is what the profile seems to gain
    charge = with_kernel.pressure.charges[0]
    nodes = np.cos((np.arange(200) + 0.5) * np.pi / 200)
    first = np.mean(np.polynomial.chebyshev.chebval(nodes, charge) * np.cos(half * nodes))
    seeming = Profile.from_harmonics(2 * np.pi, [1], [AMPLITUDE + (1 - ratio) * first])
    penetration = case.penetration + seeming.max_height - case.profile.max_height
    plain = evaluate_dense(seeming, left, right, penetration)
    np.testing.assert_allclose(with_kernel.stress_intensity, plain.stress_intensity, rtol=1e-12)


def test_smooth_kernel_derivatives_are_exact():
    kernel = LayerKernel(np.array([2.0]), np.array([0.2]))
    profile = rough()
    left, right, penetration = cut_edges(profile, 0.4)
    nodes = dense_nodes(profile, left, right)
    state = evaluate_dense(profile, left, right, penetration, nodes, kernel)
    slope = central_difference(
        lambda d: evaluate_dense(profile, *edge_moved(left, right, 1, d), penetration, nodes, kernel).stress_intensity,
        1e-3 * (right[1] - left[1]),
    )
    exact = state.stress_intensity_jacobian[:, 1]
    assert np.max(np.abs(slope - exact)) <= 2e-9 * np.max(np.abs(exact))  # measured 9e-10
