"""The last gaps next to complete contact without adhesion, in closed form: isolated cracks in its pressure.

The pressure of complete contact at the mean pressure p_0 is p_0 + q(x), q(x) = sum E* m q_0 h_m / 2 cos(m q_0 x +
phi_m).  Gaps close at the lowest pressures -Q of q with the curvatures k: at the mean pressure Q - T the tension
T - k t^2/2 holds open a gap of half width c (Griffith; Tada, Paris, Irwin, The Stress Analysis of Cracks Handbook, 3rd
ed. (2000), part II) with

    T = k c^2/4,   s = gap/lambda = 2 pi T^2/(lambda E* k),

the limit c -> 0; terms left out are of the relative order (Q - p_0)/Q, times the square of the highest order at most.
SI units.
"""

import numpy as np
from numpy.typing import NDArray

from validation.references.waves import Harmonics, Waves


def valleys(pressure: Harmonics) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return values and curvatures at the local minima that are lowest to 1e-9 of the rms value, (n,) each."""
    below = Waves(pressure.period, pressure.orders, -pressure.amplitudes, pressure.phases)
    places = below.crests
    value, curvature = -below.height(places), -below.height(places, 2)
    lowest = value - value.min() <= 1e-9 * below.rms_height
    return value[lowest], curvature[lowest]


def closing(pressure: Harmonics, modulus: float, separation: float) -> tuple[float, NDArray[np.float64]]:
    """Return mean pressure (Pa) and widths (m) without adhesion of equally deep last gaps at a separation (m).

    `pressure` is that of complete contact less its mean, Pa, the modulus E*, Pa.
    """
    value, curvature = valleys(pressure)
    tension = np.sqrt(separation * pressure.period * modulus / (2 * np.pi * np.sum(1 / curvature)))
    return float(-value.min() - tension), np.asarray(4 * np.sqrt(tension / curvature))
