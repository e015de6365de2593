"""Closed forms of sinusoidal and complete contact, written independently of the solver.

h = D cos(q0 x) on a half-space, contact width 2a, psi = pi a / wavelength, p* = pi E* D / wavelength:

- without adhesion (Westergaard, J. Appl. Mech. 6 (1939) A49): mean pressure p* sin^2 psi;
- with JKR adhesion, no slope term (Johnson, Int. J. Solids Struct. 32 (1995) 423): mean pressure
  p* [sin^2 psi - alpha sqrt(tan psi)], alpha = sqrt(2 E* gamma / wavelength) / p*, and penetration
  D S (1 - ln S) + alpha p* wavelength sqrt(tan psi) ln S / (pi E*), S = sin^2 psi;
- with v = sin(pi x / wavelength), x from the crest, and the mean tension T = alpha p* sqrt(tan psi): pressure
  2 p* cos(pi x / wavelength) sqrt(S - v^2) - T cos(pi x / wavelength) / sqrt(S - v^2) and gap
  2 D (v sqrt(v^2 - S) - S arcosh(v S^-1/2)) + (2 wavelength T / pi E*) arcosh(v S^-1/2);
- elastic energy per area p* D (S^2/4 - S^2/2 ln S) + p* S delta - pi E* delta^2 / (2 wavelength ln S), which is
  Westergaard's and that of a flat punch under T, delta = wavelength T ln S / (pi E*) (dU/dDelta = load at fixed edges).

SI units.  Limits: one contact a period; near psi = pi/2 the formulas lose digits (up to contact fraction 0.95 none
that matter).
"""

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
        """Return the mean pressure in Pa at psi = pi times half the contact fraction."""
        angle = np.asarray(psi, dtype=np.float64)
        return np.asarray(self.full_contact_pressure * (np.sin(angle) ** 2 - self.alpha * np.sqrt(np.tan(angle))))

    def penetration(self, psi: ArrayLike) -> FloatArray:
        """Return the penetration in m at psi."""
        angle = np.asarray(psi, dtype=np.float64)
        share = np.sin(angle) ** 2
        adhesive = self.alpha * self.full_contact_pressure * np.sqrt(np.tan(angle)) * np.log(share)
        return np.asarray(
            self.amplitude * share * (1 - np.log(share)) + adhesive * self.wavelength / (np.pi * self.modulus)
        )

    def pressure(self, x: FloatArray, psi: float) -> FloatArray:
        """Return the pressure in Pa at distances in m from the crest, on the contact."""
        v = np.sin(np.pi * x / self.wavelength)
        root = np.sqrt(np.sin(psi) ** 2 - v**2)
        cosine = np.cos(np.pi * x / self.wavelength)
        return np.asarray(cosine * (2 * self.full_contact_pressure * root - self._tension(psi) / root))

    def gap(self, x: ArrayLike, psi: float) -> FloatArray:
        """Return the gap in m at distances in m from the crest; zero on the contact."""
        share = np.sin(psi) ** 2
        v = np.maximum(np.abs(np.sin(np.pi * np.asarray(x) / self.wavelength)), np.sqrt(share))
        angle = np.arccosh(v / np.sqrt(share))
        dry = 2 * self.amplitude * (v * np.sqrt(np.maximum(v**2 - share, 0.0)) - share * angle)
        return np.asarray(dry + 2 * self.wavelength * self._tension(psi) / (np.pi * self.modulus) * angle)

    def elastic_energy(self, psi: float) -> float:
        """Return the elastic energy in J/m^2 of nominal area."""
        share, full, length = np.sin(psi) ** 2, self.full_contact_pressure, self.wavelength
        lift = length * self._tension(psi) * np.log(share) / (np.pi * self.modulus)
        energy = full * self.amplitude * (share**2 / 4 - share**2 / 2 * np.log(share)) + full * share * lift
        return float(energy - np.pi * self.modulus * lift**2 / (2 * length * np.log(share)))

    def _tension(self, psi: float) -> float:
        return float(self.alpha * self.full_contact_pressure * np.sqrt(np.tan(psi)))

    def fold(self) -> float:
        """Return psi at the least penetration: pull-off under penetration control."""

        def slope(psi: float) -> float:
            step = 1e-6 * psi
            return float(self.penetration(psi + step) - self.penetration(psi - step))

        grid = np.linspace(1e-3, 1.2, 400)
        start = grid[int(np.argmin(self.penetration(grid)))]
        return float(brentq(slope, start / 1.05, start * 1.05, xtol=1e-12))


def layer_ratio(k: ArrayLike, poisson_ratio: float) -> FloatArray:
    """Return the compliance of a bonded layer over that of the half-space at k = q d, any shape.

    The bracket of equation (2) of G. Carbone, L. Mangialardi, J. Mech. Phys. Solids 56 (2008) 684,

        [(3-4nu) sinh 2k - 2k] / [(3-4nu) cosh 2k + 2k^2 + 5 - 12nu + 8nu^2],

    divided by e^2k where that is large, with the series of sinh y - y where that is small.

    Examples
    --------
    >>> float(layer_ratio(400.0, 0.3)), round(float(layer_ratio(1e-3, 0.5)) / (2e-3**3 / 6 / 2), 5)
    (1.0, 1.0)
    """
    y, nu = 2 * np.asarray(k, dtype=np.float64), poisson_ratio
    decay = np.exp(-y)
    small = y**3 / 6 * (1 + y**2 / 20 * (1 + y**2 / 42 * (1 + y**2 / 72 * (1 + y**2 / 110 * (1 + y**2 / 156)))))
    excess = np.where(y < 1, small * decay, (1 - decay**2) / 2 - y * decay)  # (sinh y - y) e^-y
    top = (3 - 4 * nu) * excess + (2 - 4 * nu) * y * decay
    bottom = (3 - 4 * nu) * (1 + decay**2) / 2 + (y**2 / 2 + 5 - 12 * nu + 8 * nu**2) * decay
    return np.asarray(top / bottom)


def layer_compliance(q: ArrayLike, thickness: float, youngs_modulus: float, poisson_ratio: float) -> FloatArray:
    """Return c(q) in m/Pa: displacement of a bonded layer's frictionless face per pressure of a wave, q in rad/m."""
    wavenumber = np.asarray(q, dtype=np.float64)
    half_space = 2 * (1 - poisson_ratio**2) / (youngs_modulus * wavenumber)
    return np.asarray(half_space * layer_ratio(wavenumber * thickness, poisson_ratio))


def uniform_compliance(thickness: float, youngs_modulus: float, poisson_ratio: float) -> float:
    """Return c(0) of a bonded layer in m/Pa: its face cannot spread under a mean pressure."""
    nu = poisson_ratio
    return thickness * (1 - 2 * nu) * (1 + nu) / (youngs_modulus * (1 - nu))


def full_contact_amplitudes(orders: ArrayLike, amplitudes: ArrayLike, wavelength: float, modulus: float) -> FloatArray:
    """Return the pressure amplitudes in Pa of complete contact with a half-space: E* m q0 h_m / 2."""
    m, h = np.asarray(orders, dtype=np.float64), np.asarray(amplitudes, dtype=np.float64)
    return np.asarray(modulus * np.pi * m * h / wavelength)
