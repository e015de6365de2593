"""References judge one another: closed forms are integrated, dense algebra and isolated cracks meet closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad

from validation.harness.route import Problem
from validation.references.closed_forms import Sinusoid, layer_ratio
from validation.references.dense_equilibrium import equilibrium
from validation.references.isolated_crack import crack
from validation.references.waves import Waves

WAVE = Sinusoid(amplitude=1e-4, wavelength=0.01, youngs_modulus=1e6, poisson_ratio=0.5, alpha=0.3)
ANGLES = [0.9, 1.2]  # psi; pull-off lies near 0.8


def rate(function, psi, step=1e-4):
    near, far = (function(psi + k * step) - function(psi - k * step) for k in (1, 2))
    return float(8 * near - far) / (12 * step)


def problem(*targets):
    return Problem(
        youngs_modulus=WAVE.youngs_modulus,
        poisson_ratio=WAVE.poisson_ratio,
        period=WAVE.wavelength,
        orders=(1,),
        amplitudes=(WAVE.amplitude,),
        phases=(0.0,),
        control="penetration",
        targets=targets,
        work_of_adhesion=WAVE.work_of_adhesion,
    )


@pytest.mark.parametrize("psi", ANGLES)
def test_johnsons_fields_have_his_load_separation_and_energy(psi):
    edge = np.sin(psi)

    def pressure(angle):  # sin(pi x / wavelength) = edge sin(angle): no singularity is left
        x = np.arcsin(edge * np.sin(angle)) * WAVE.wavelength / np.pi
        return float(WAVE.pressure(x, psi)) * edge * np.cos(angle) / np.cos(np.pi * x / WAVE.wavelength)

    load = quad(pressure, -np.pi / 2 + 1e-9, np.pi / 2 - 1e-9, epsabs=0.0, epsrel=1e-10)[0] / np.pi
    assert load == pytest.approx(float(WAVE.mean_pressure(psi)), rel=1e-8)
    half = psi * WAVE.wavelength / np.pi
    opening = 2 * quad(lambda x: float(WAVE.gap(x, psi)), half, WAVE.wavelength / 2, epsabs=0.0, epsrel=1e-9)[0]
    separation = WAVE.amplitude - float(WAVE.penetration(psi))
    assert opening / WAVE.wavelength == pytest.approx(separation, rel=1e-7)
    total = rate(lambda angle: WAVE.elastic_energy(angle) - WAVE.work_of_adhesion * 2 * angle / np.pi, psi)
    assert total == pytest.approx(float(WAVE.mean_pressure(psi)) * rate(WAVE.penetration, psi), rel=1e-8)


@pytest.mark.parametrize("psi", ANGLES)
def test_dense_algebra_is_johnsons_wave(psi):
    depth, half = float(WAVE.penetration(psi)), psi * WAVE.wavelength / np.pi
    state = equilibrium(problem(depth), [[-1.001 * half, 1.002 * half]], depth, depth)
    elastic, adhesion = WAVE.elastic_energy(psi), -WAVE.work_of_adhesion * 2 * psi / np.pi
    assert state == pytest.approx(
        {
            "mean_pressure": float(WAVE.mean_pressure(psi)),
            "contact_fraction": 2 * psi / np.pi,
            "penetration": depth,
            "separation": WAVE.amplitude - depth,
            "total_displacement": depth,
            "elastic_energy": elastic,
            "adhesion_energy": adhesion,
            "total_energy": elastic + adhesion,
            "stress_intensity_max": np.sqrt(2 * WAVE.modulus * WAVE.work_of_adhesion),
            "contact_stiffness": rate(WAVE.mean_pressure, psi) / rate(WAVE.penetration, psi),
        },
        rel=1e-9,
    )


def test_an_isolated_crack_obeys_its_integrals():
    """Griffith's: sum of K over both ends and opening, by adaptive quadrature, where the pressure is not symmetric."""
    surface = Waves(0.01, np.array([1, 3]), np.array([1e-4, 2e-5]), np.array([0.3, 1.0]))
    modulus, work, left, right = 1.3e6, 0.05, 0.0045, 0.0052
    pressure, separation = crack(surface, modulus, work, left, right)
    q, middle, half = 2 * np.pi / 0.01 * surface.orders, (left + right) / 2, (right - left) / 2

    def tension(angle):
        x = middle + half * np.sin(angle)
        return -pressure - float(np.cos(q * x + surface.phases) @ (modulus * q * surface.amplitudes / 2))

    slope = [-float(np.sin(q * x + surface.phases) @ (q * surface.amplitudes)) for x in (left, right)]
    critical = np.sqrt(2 * modulus * work * np.sqrt(1 + np.square(slope)))
    row = np.sqrt(0.01 * np.tan(np.pi * half / 0.01))  # sqrt(pi c) of a row of cracks
    assert quad(tension, -np.pi / 2, np.pi / 2)[0] / np.pi * row == pytest.approx(critical.mean(), rel=1e-6)
    opening = quad(lambda angle: tension(angle) * (half * np.cos(angle)) ** 2 * 2 / modulus, -np.pi / 2, np.pi / 2)[0]
    assert opening / 0.01 == pytest.approx(separation, rel=1e-9)


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_the_compliance_of_a_layer_is_the_printed_bracket_on_both_sides_of_its_series(nu):
    k = np.array([0.2, 0.49, 0.51, 3.0])
    bracket = (3 - 4 * nu) * np.cosh(2 * k) + 2 * k**2 + 5 - 12 * nu + 8 * nu**2
    assert layer_ratio(k, nu) == pytest.approx(((3 - 4 * nu) * np.sinh(2 * k) - 2 * k) / bracket, rel=1e-13)
