"""Work of adhesion along the profile: its integral, its derivative, its units, and the limit of small slopes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.special import ellipeinc

from bem.adhesive.adhesion import Adhesion, UniformLaw, dimensionless_law, true_length
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.geometry.scaling import Scales

SURFACE = Profile.self_affine(0.01, 0.7, 50e-6, 20, 3)
SCALED = SURFACE.scaled()


def law_of(slope_term, rms_height=50e-6):
    return dimensionless_law(Adhesion(0.03, slope_term), SCALED, Scales(0.01, rms_height, 4e6 / 3))


by_law = pytest.mark.parametrize("slope_term", [False, True], ids=["uniform", "slope"])


@by_law
@given(x=st.floats(0, 2 * np.pi))
def test_gradient_is_the_derivative_of_the_work(slope_term, x):
    law, step = law_of(slope_term), 1e-4
    w = law.work_of_adhesion(x + step * np.array([-2.0, -1.0, 1.0, 2.0]))
    found = (8 * (w[2] - w[1]) - (w[3] - w[0])) / (12 * step)
    scale = law.work * (law.slope_scale * SCALED.rms_slope) ** 2 * SCALED.max_order if slope_term else law.work
    assert law.work_and_gradient(np.array([x]))[1][0] == pytest.approx(found, abs=1e-8 * scale)  # measured 3e-9


@by_law
@given(left=st.floats(0, 6), width=st.floats(0.01, 6))
def test_energy_is_minus_the_integral_of_the_work(slope_term, left, width):
    law = law_of(slope_term)
    integral = quad(lambda x: float(law.work_of_adhesion(np.array(x))), left, left + width, epsabs=1e-12, limit=300)[0]
    energy = law.energy(Patches(np.array([left]), np.array([left + width])))
    assert energy == pytest.approx(-integral, rel=1e-10)  # measured 1e-11


@pytest.mark.parametrize("slope", [0.1, 2.0, 30.0, 1e6])
@pytest.mark.parametrize("order", [1, 5])
def test_true_length_of_a_sinusoid_is_an_elliptic_integral(slope, order):
    """int_0^x sqrt(1 + s^2 sin^2 t) dt = E(x | -s^2), shifted to where the profile has its crest."""
    phase = 0.7
    wave = Profile.from_harmonics(2 * np.pi, [order], [np.sqrt(2)], [phase])
    x = np.array([-9.0, -0.7 / order, 0.0, 0.1, 2.0, 6.2, 6.3, 40.0])
    exact = ellipeinc(order * x + phase, -(slope**2)) - ellipeinc(phase, -(slope**2))
    found = true_length(wave, slope / (np.sqrt(2) * order))(x) * order
    assert np.abs(found - exact).max() <= 6e-16 * np.hypot(1, slope) * 40 * order  # measured 2.3e-16


@given(x=st.floats(0, 0.01))
def test_slope_term_is_that_of_the_paper(x):
    """w = gamma sqrt(1 + h'^2) in SI units, h' being the true slope."""
    scales = Scales(0.01, 50e-6, 4e6 / 3)
    found = law_of(True).work_of_adhesion(np.array([x * SURFACE.q0]))[0] * scales.release_rate
    assert found == pytest.approx(0.03 * np.sqrt(1 + float(SURFACE.slope(x)) ** 2), rel=1e-12)


def test_critical_stress_intensity_is_griffiths():
    """K = sqrt(2 E* w) in SI units."""
    scales = Scales(0.01, 50e-6, 4e6 / 3)
    found = 2 * np.sqrt(law_of(False).work_of_adhesion(np.zeros(1))[0]) * scales.stress_intensity
    assert found == pytest.approx(np.sqrt(2 * 4e6 / 3 * 0.03), rel=1e-14)


def test_slope_term_vanishes_with_the_slopes():
    flat = dimensionless_law(Adhesion(0.03, True), SCALED, Scales(0.01, 1e-12, 4e6 / 3))
    uniform = dimensionless_law(Adhesion(0.03), SCALED, Scales(0.01, 1e-12, 4e6 / 3))
    x = np.linspace(0, 6, 50)
    np.testing.assert_allclose(flat.work_of_adhesion(x), uniform.work_of_adhesion(x), rtol=1e-14)


def test_law_without_slope_term_is_the_uniform_one():
    assert type(law_of(False)) is UniformLaw


@pytest.mark.parametrize("work", [0.0, -0.03, np.nan, np.inf])
def test_bad_work_of_adhesion_is_refused(work):
    with pytest.raises(ValueError, match="work_of_adhesion"):
        Adhesion(work)
