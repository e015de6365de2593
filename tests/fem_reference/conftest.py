"""Closed forms the finite elements are held against, and the problems they belong to."""

from dataclasses import dataclass

import numpy as np
import pytest

from fem_reference.problem import Problem


def layer_compliance(wavenumber, depth, poisson_ratio):
    """c(q) E of a bonded frictionless layer (Carbone and Mangialardi 2008, doi:10.1016/j.jmps.2007.05.009)."""
    nu, t = poisson_ratio, wavenumber * depth
    ratio = ((3 - 4 * nu) * np.sinh(2 * t) - 2 * t) / (
        (3 - 4 * nu) * np.cosh(2 * t) + 2 * t**2 + 5 - 12 * nu + 8 * nu**2
    )
    return 2 * (1 - nu**2) / wavenumber * ratio


@dataclass(frozen=True)
class Johnson:
    """One sinusoid on a half-space with edges at +-a: load, penetration, K (Johnson 1995; Westergaard 1939).

    Lengths in periods, heights in the rms height (amplitude sqrt 2), moduli in E. The state at half-width a and stress
    intensity K: p = p* S - K sqrt(tan psi), Delta = D S (1 - ln S) + K sqrt(tan psi) ln S / (pi E*), S = sin^2 psi.
    """

    half_width: float
    poisson_ratio: float

    @property
    def modulus(self):
        return 1 / (1 - self.poisson_ratio**2)

    def stress_intensity(self, penetration):
        psi = np.pi * self.half_width
        s = np.sin(psi) ** 2
        flat = (penetration - np.sqrt(2) * s * (1 - np.log(s))) * np.pi * self.modulus / np.log(s)
        return flat / np.sqrt(np.tan(psi))

    def load(self, penetration):
        psi = np.pi * self.half_width
        return np.pi * self.modulus * np.sqrt(2) * np.sin(psi) ** 2 - self.stress_intensity(penetration) * np.sqrt(
            np.tan(psi)
        )


@pytest.fixture
def compliance():
    return layer_compliance


@pytest.fixture
def johnson():
    return Johnson


@pytest.fixture
def sinusoid():
    def build(poisson_ratio=0.3, depth=2.0, work_of_adhesion=0.0, slope_term=False):
        return Problem(1.0, poisson_ratio, depth, 1.0, [1], [0.01], [0.0], work_of_adhesion, slope_term)

    return build


@pytest.fixture
def two_crests():
    def build(poisson_ratio=0.3, depth=0.5, work_of_adhesion=0.0, slope_term=False):
        return Problem(
            1.0,
            poisson_ratio,
            depth,
            1.0,
            [1, 2, 3],
            [0.004, 0.01, 0.002],
            [0.3, -0.4, 1.0],
            work_of_adhesion,
            slope_term,
        )

    return build
