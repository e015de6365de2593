"""Closed forms of sinusoidal and complete contact, written independently of the solver.

h = D cos(q0 x) on a half-space, contact width 2a, psi = pi a / wavelength, p* = pi E* D / wavelength:

- without adhesion (Westergaard, J. Appl. Mech. 6 (1939) A49): mean pressure p* sin^2 psi;
- with JKR adhesion, no slope term (Johnson, Int. J. Solids Struct. 32 (1995) 423): mean pressure
  p* [sin^2 psi - alpha sqrt(tan psi)], alpha = sqrt(2 E* gamma / wavelength) / p*, and penetration
  D S (1 - ln S) + alpha p* wavelength sqrt(tan psi) ln S / (pi E*), S = sin^2 psi.

SI units.  Limits: one contact a period; near psi = pi/2 the formulas lose digits (up to contact fraction 0.95 none
that matter).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from validation.harness.arrays import FloatArray


@dataclass(frozen=True)
class Sinusoid:
    """Adhesive contact of a half-space with one sinusoid.

    Examples
    --------
    >>> wave = Sinusoid(1e-4, 0.01, 1e6, 0.5, 0.0)
    >>> float(round(wave.mean_pressure(np.pi / 2) / wave.full_contact_pressure, 12))
    1.0
    """

    amplitude: float  # D, m
    wavelength: float  # m
    youngs_modulus: float  # Pa
    poisson_ratio: float
    alpha: float  # Johnson's parameter; 0 without adhesion

    @property
    def modulus(self) -> float:
        """E / (1 - nu^2), Pa."""
        return self.youngs_modulus / (1 - self.poisson_ratio**2)

    @property
    def full_contact_pressure(self) -> float:
        """p*, Pa."""
        return np.pi * self.modulus * self.amplitude / self.wavelength

    @property
    def work_of_adhesion(self) -> float:
        """gamma that gives alpha, J/m^2."""
        return (self.alpha * self.full_contact_pressure) ** 2 * self.wavelength / (2 * self.modulus)

    def mean_pressure(self, psi: ArrayLike) -> FloatArray:
        """Mean pressure in Pa at psi = pi times half the contact fraction."""
        angle = np.asarray(psi, dtype=np.float64)
        return np.asarray(self.full_contact_pressure * (np.sin(angle) ** 2 - self.alpha * np.sqrt(np.tan(angle))))

    def penetration(self, psi: ArrayLike) -> FloatArray:
        """Penetration in m."""
        angle = np.asarray(psi, dtype=np.float64)
        share = np.sin(angle) ** 2
        adhesive = self.alpha * self.full_contact_pressure * np.sqrt(np.tan(angle)) * np.log(share)
        return np.asarray(
            self.amplitude * share * (1 - np.log(share)) + adhesive * self.wavelength / (np.pi * self.modulus)
        )

    def fold(self) -> float:
        """psi at which the penetration is least: pull-off under penetration control."""

        def slope(psi: float) -> float:
            step = 1e-6 * psi
            return float(self.penetration(psi + step) - self.penetration(psi - step))

        grid = np.linspace(1e-3, 1.2, 400)
        start = grid[int(np.argmin(self.penetration(grid)))]
        return float(brentq(slope, start / 1.05, start * 1.05, xtol=1e-12))


def layer_compliance(q: ArrayLike, thickness: float, youngs_modulus: float, poisson_ratio: float) -> FloatArray:
    """c(q) in m/Pa: displacement of the frictionless face of a bonded layer per pressure of a wave, rad/m, any shape.

    As printed by G. Carbone, L. Mangialardi, J. Mech. Phys. Solids 56 (2008) 684: fine for q d of order one.

    Examples
    --------
    >>> round(float(layer_compliance(1.0, 20.0, 1.0, 0.0)), 12)  # a half-space: 2 / (E* q)
    2.0
    """
    wavenumber, nu = np.asarray(q, dtype=np.float64), poisson_ratio
    y = 2 * wavenumber * thickness
    bracket = ((3 - 4 * nu) * np.sinh(y) - y) / ((3 - 4 * nu) * np.cosh(y) + y**2 / 2 + 5 - 12 * nu + 8 * nu**2)
    return np.asarray(2 * (1 - nu**2) / (youngs_modulus * wavenumber) * bracket)


def full_contact_amplitudes(orders: ArrayLike, amplitudes: ArrayLike, wavelength: float, modulus: float) -> FloatArray:
    """Pressure amplitudes in Pa of complete contact with a half-space: E* m q0 h_m / 2."""
    m, h = np.asarray(orders, dtype=np.float64), np.asarray(amplitudes, dtype=np.float64)
    return np.asarray(modulus * np.pi * m * h / wavelength)
