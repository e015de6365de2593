"""The last gap next to complete contact, in closed form: an isolated crack in the pressure of complete contact.

The pressure of complete contact at the mean pressure p_0 is p_0 + q(x), q(x) = sum E* m q_0 h_m / 2 cos(m q_0 x +
phi_m).  A gap of half width c about x_0 is held open by the tension -p_0 - q on its faces, so that at its two ends

    K = -1/sqrt(pi c) int_-c^c (p_0 + q(x_0 + t)) sqrt((c +- t)/(c -+ t)) dt = sqrt(2 E* w),
    gap = int_-c^c (-p_0 - q(x_0 + t)) 2/E* sqrt(c^2 - t^2) dt,

(Griffith; Tada, Paris, Irwin, The Stress Analysis of Cracks Handbook, 3rd ed. (2000), part II), here with
lambda tan(pi c/lambda) for pi c in K, which is exact for a uniform tension (a row of collinear cracks).  What else
the row changes is of the order (c/lambda)^2.  So p_0 follows from the ends of the gap, and the separation gap/lambda
from both.  About the lowest pressure -Q of q the mean pressure is Q - K/sqrt(pi c): tensile only once the gap is
narrower than 2 c = 2 (K/Q)^2/pi, however near to complete contact a wider one is.

Without adhesion K = 0, and gaps close at the lowest pressures -Q of q with the curvatures k: at the mean pressure Q - T
the tension T - k t^2/2 holds open a gap of half width c with

    T = k c^2/4,   s = gap/lambda = 2 pi T^2/(lambda E* k),

the limit c -> 0; terms left out are of the relative order (Q - p_0)/Q, times the square of the highest order at most.
SI units.
"""

import numpy as np
from numpy.typing import NDArray

from validation.references.waves import Harmonics, Waves

POINTS = 200  # within the gap, at the cosines of equally spaced angles


def crack(surface: Harmonics, modulus: float, work: float, left: float, right: float) -> tuple[float, float]:
    """Return the mean pressure (Pa) and separation (m) at which the gap from `left` to `right` (m) is in equilibrium.

    The modulus is E*, Pa, the work of adhesion that of flat surfaces, J/m^2; along a slope it is larger by sqrt(1 +
    h'^2).
    """
    period, half_width, middle = surface.period, (right - left) / 2, (left + right) / 2
    wave_numbers = 2 * np.pi / period * surface.orders
    angle = np.pi * (np.arange(POINTS) + 0.5) / POINTS
    x = middle + half_width * np.cos(angle)
    varying = np.cos(np.multiply.outer(x, wave_numbers) + surface.phases) @ (
        modulus * wave_numbers * surface.amplitudes / 2
    )
    ends = np.array([left, right])
    slope = -np.sin(np.multiply.outer(ends, wave_numbers) + surface.phases) @ (wave_numbers * surface.amplitudes)
    critical = np.sqrt(2 * modulus * work * np.sqrt(1 + slope**2))
    tension = critical / np.sqrt(period * np.tan(np.pi * half_width / period))
    pressure = float(-varying.mean() - tension.mean())  # the mean over both ends
    opening = np.pi * half_width**2 / modulus * float(np.mean((-pressure - varying) * 2 * np.sin(angle) ** 2))
    return pressure, opening / period


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
