"""Johnson's branch of one wave (1995) in dimensionless form, and systems of waves with its adhesion."""

import numpy as np

from bem.adhesive.adhesion import UniformLaw
from bem.adhesive.descent import descend
from bem.adhesive.equilibrium import System
from bem.adhesive.strides import Steps
from bem.elastic.collocation import Elastic
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile
from bem.loading.increments import Accuracy

AMPLITUDE = np.sqrt(2.0)  # of a wave of unit rms height
ALPHA = 0.3
WORK = np.pi * (ALPHA * AMPLITUDE) ** 2 / 2


def johnson(quantity, psi):
    """Load per period or penetration on the branch of one wave; psi is the half width over 2."""
    S, t = np.sin(psi) ** 2, ALPHA * np.sqrt(np.tan(psi))
    return 2 * np.pi * AMPLITUDE * (S - t) if quantity == "load" else AMPLITUDE * (S * (1 - np.log(S)) + t * np.log(S))


def lowest(quantity):
    """Least value on the branch, to rounding: on ever finer grids around it."""
    psi = np.linspace(0.01, 0.8, 1001)
    for _ in range(8):
        best = psi[np.argmin(johnson(quantity, psi))]
        psi = np.linspace(best - (psi[1] - psi[0]) * 2, best + (psi[1] - psi[0]) * 2, 1001)
    return float(np.min(johnson(quantity, psi)))


def waves(control, orders=(1,), amplitudes=(AMPLITUDE,), work=WORK):
    """Waves whose crests are at 0."""
    return System(Elastic(Profile.from_harmonics(2 * np.pi, list(orders), list(amplitudes))), UniformLaw(work), control)


def resting(system, centers, half_width, value):
    """Coarse equilibrium of patches around crests, at a value of the control."""
    patches = Patches(np.array(centers) - half_width, np.array(centers) + half_width)
    found = descend(system, patches, 0.0, value, Accuracy(1e-3, 1e-4), Steps(0.2))
    assert found.status == "converged"
    return found.balance
