"""Persson's theory without adhesion for roughness in one direction: closed forms.

The stress distribution diffuses with the slope variance S resolved, dP/dV = 1/2 d2P/dsigma2 with V = S/4 (stress in
units of E*), from delta(sigma - sigma_0), and is absorbed at sigma = 0 where contact is lost:

    A/A0 = erf(sqrt 2 sigma_0 / sqrt S),
    P(sigma) = [exp(-(sigma - sigma_0)^2 / 2V) - exp(-(sigma + sigma_0)^2 / 2V)] / sqrt(2 pi V).

Inside a line q is fixed while S runs over dS_m (narrow-band rule): energy and separation are sums of integrals,

    U_el / (A0 E*) = sum_m (1 / 4 q_m) int A/A0 dS,
    s = sum_m (1 / 4 q_m) int sqrt(2 / (pi S)) E1(2 sigma_0^2 / S) dS.

Source: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; separation: C. Yang, B. N. J. Persson, J. Phys.: Condens.
Matter 20 (2008) 215214.  Limits: mean-field; sigma_0 > 0; no adhesion.  SI units at the edge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import erf, exp1

from persson.spectrum import DiscreteSpectrum

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class NonadhesiveContact:
    """What the theory says at one load, SI units.

    Attributes
    ----------
    contact_fraction : float
        A/A0 with all lines resolved.
    separation : float
        Distance of the mean planes, m.
    elastic_energy : float
        J/m^2 of nominal area, without the mean compression.
    contact_fractions : (n_lines,) array
        A/A0 when wavenumbers up to q_m are resolved.
    """

    spectrum: DiscreteSpectrum
    mean_pressure: float
    plane_strain_modulus: float
    contact_fraction: float
    separation: float
    elastic_energy: float
    contact_fractions: FloatArray
    status: str = "converged"

    def pressure_distribution(self, pressure: ArrayLike) -> FloatArray:
        """P(sigma) per nominal area in 1/Pa at pressures in Pa; its integral over sigma > 0 is A/A0."""
        modulus = self.plane_strain_modulus
        stress, mean = np.asarray(pressure, dtype=np.float64) / modulus, self.mean_pressure / modulus
        variance = self.spectrum.slope_variance[-1] / 4
        direct = np.exp(-((stress - mean) ** 2) / (2 * variance))
        image = np.exp(-((stress + mean) ** 2) / (2 * variance))
        value = (direct - image) / (np.sqrt(2 * np.pi * variance) * modulus)
        return np.asarray(np.where(stress > 0, value, 0.0))

    def displacement_power(self, period_wavenumber: float) -> FloatArray:
        """C_u(q_m) = C(q_m) A(q_m)/A0 in m^3, (n_lines,)."""
        return self.spectrum.power(period_wavenumber) * self.contact_fractions

    def pressure_power(self, period_wavenumber: float) -> FloatArray:
        """C_sigma(q_m) = E*^2 q^2 C_u / 4 in Pa^2 m, (n_lines,)."""
        stiffness = self.plane_strain_modulus * self.spectrum.wavenumbers / 2
        return np.asarray(stiffness**2 * self.displacement_power(period_wavenumber))


def solve_nonadhesive(
    spectrum: DiscreteSpectrum, mean_pressure: float, *, youngs_modulus: float, poisson_ratio: float
) -> NonadhesiveContact:
    """Area, separation, energy and spectra at one load.

    Parameters
    ----------
    spectrum : DiscreteSpectrum
    mean_pressure : float
        sigma_0 in Pa, > 0.
    youngs_modulus, poisson_ratio : float
        E > 0 in Pa; nu in (-1, 0.5].

    Raises
    ------
    ValueError
        A value outside its range.

    Examples
    --------
    >>> lines = DiscreteSpectrum([1.0], [0.1])
    >>> contact = solve_nonadhesive(lines, 1.0, youngs_modulus=1.0, poisson_ratio=0.0)
    >>> round(contact.contact_fraction, 6)
    1.0
    """
    if not (mean_pressure > 0 and np.isfinite(mean_pressure)):
        raise ValueError(f"mean_pressure: {mean_pressure} must be finite and > 0 (Pa)")
    if not (youngs_modulus > 0 and np.isfinite(youngs_modulus)):
        raise ValueError(f"youngs_modulus: {youngs_modulus} must be finite and > 0 (Pa)")
    if not -1 < poisson_ratio <= 0.5:
        raise ValueError(f"poisson_ratio: {poisson_ratio} must lie in (-1, 0.5]")
    modulus = youngs_modulus / (1 - poisson_ratio**2)
    load = mean_pressure / modulus
    resolved = spectrum.slope_variance
    bands = np.concatenate([[0.0], resolved])
    inverse = 1 / (4 * spectrum.wavenumbers)
    return NonadhesiveContact(
        spectrum=spectrum,
        mean_pressure=mean_pressure,
        plane_strain_modulus=modulus,
        contact_fraction=float(erf(np.sqrt(2) * load / np.sqrt(resolved[-1]))),
        separation=float(np.sum(inverse * np.diff(_separation_integral(bands, load)))),
        elastic_energy=modulus * float(np.sum(inverse * np.diff(_area_integral(bands, load)))),
        contact_fractions=np.asarray(erf(np.sqrt(2) * load / np.sqrt(resolved))),
    )


def _area_integral(variance: FloatArray, load: float) -> FloatArray:
    """int_0^S erf(c / sqrt S) dS, c = sqrt 2 sigma_0."""
    c = np.sqrt(2) * load
    with np.errstate(divide="ignore"):
        decay = np.exp(-(c**2) / variance)
        inside = erf(c / np.sqrt(variance))
    value = (variance + 2 * c**2) * inside + 2 * c * np.sqrt(variance / np.pi) * decay
    return np.asarray(value - 2 * c**2)


def _separation_integral(variance: FloatArray, load: float) -> FloatArray:
    """int_0^S sqrt(2 / (pi S)) E1(a / S) dS, a = 2 sigma_0^2, by parts twice."""
    a = 2 * load**2
    with np.errstate(divide="ignore"):
        x = a / variance
        root = np.sqrt(variance)
        value = 2 * root * exp1(x) - 4 * root * np.exp(-x) - 4 * np.sqrt(np.pi * a) * (erf(np.sqrt(x)) - 1)
    return np.asarray(np.sqrt(2 / np.pi) * value)
