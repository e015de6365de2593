"""The closed second derivatives of the energy at Johnson's edges, against those of the boundary elements."""

import numpy as np
import pytest

import bem
from validation.cases.finite_elements.fem_closed_forms import WAVE, stiffness


@pytest.mark.parametrize("fraction", [0.2, 0.5, 0.8])
def test_closed_stiffness_is_that_of_the_boundary_elements(fraction):
    profile = bem.Profile.from_harmonics(WAVE.wavelength, [1], [WAVE.amplitude])
    solid = bem.Solid(WAVE.youngs_modulus, WAVE.poisson_ratio)
    half, penetration = fraction * WAVE.wavelength / 2, float(WAVE.penetration(fraction * np.pi / 2))
    adhesion = bem.Adhesion(WAVE.work_of_adhesion)
    state = bem.ContactState(profile, solid, [[-half, half]], penetration, adhesion=adhesion)
    outwards, aside = (float(motion @ state.hessian @ motion) / 2 for motion in np.array([[-1, 1], [1, 1]]))
    assert (outwards, aside) == pytest.approx(stiffness(WAVE, fraction * np.pi / 2), rel=1e-9)  # 3e-12
