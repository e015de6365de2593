"""Persson's theory without adhesion for roughness in one direction: closed forms.

The stress distribution diffuses with the slope variance S resolved, dP/dV = 1/2 d2P/dsigma2 with V = S/4 (stress in
units of E*), from delta(sigma - sigma_0), and is absorbed at sigma = 0 where contact is lost:

    A/A0 = erf(sqrt 2 sigma_0 / sqrt S),
    P(sigma) = [exp(-(sigma - sigma_0)^2 / 2V) - exp(-(sigma + sigma_0)^2 / 2V)] / sqrt(2 pi V).

Inside a line q is fixed while S runs over dS_m (narrow-band rule): energy and separation are sums of integrals,

    U_el / (A0 E*) = sum_m (1 / 4 q_m) int A/A0 dS,
    s = sum_m (1 / 4 q_m) int sqrt(2 / (pi S)) E1(2 sigma_0^2 / S) dS,

and integrals over q for a continuous spectrum.  C_u = C A(q)/A0, C_sigma = E*^2 q^2 C_u / 4.

Source: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840, doi:10.1063/1.1388626; separation: C. Yang, B. N. J. Persson,
J. Phys.: Condens. Matter 20 (2008) 215214, doi:10.1088/0953-8984/20/21/215214.  Limits: mean-field; sigma_0 > 0; no
adhesion.  SI units at the edge, stresses in units of E* inside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erf, erfc, exp1

from persson.mathematics.arrays import FloatArray
from persson.spectrum import ContinuousSpectrum, DiscreteSpectrum, Spectrum
from persson.status import Status, advice_for

COMPLETE = 1e-12  # of 1 - A/A0: below, contact is complete to rounding


@dataclass(frozen=True, eq=False)
class NonadhesiveContact:
    """Solution of the theory without adhesion at one load, SI units.

    Attributes
    ----------
    contact_fraction : float
        A/A0 with all roughness resolved.
    separation : float
        Distance of the mean planes, m.
    elastic_energy : float
        J/m^2 of nominal area, without the mean compression.
    contact_fractions : (n,) array
        A/A0 when the wavenumbers of the spectrum up to q_m are resolved.
    status : str
        `converged`, `complete_contact` or `single_line`; `advice` states the action to take.
    """

    spectrum: Spectrum
    mean_pressure: float
    plane_strain_modulus: float
    contact_fraction: float
    separation: float
    elastic_energy: float
    contact_fractions: FloatArray
    status: Status = "converged"

    @property
    def advice(self) -> str:
        """Meaning of the status, and the action to take."""
        return advice_for(self.status)

    def contact_fraction_at(self, wavenumber: float) -> float:
        """Return A/A0 with the roughness up to a wavenumber (rad/m) resolved."""
        variance = self.spectrum.resolved_variance(wavenumber)
        return float(contact_fraction(np.array([variance]), self.mean_pressure / self.plane_strain_modulus)[0])

    def pressure_distribution(self, pressure: ArrayLike, wavenumber: float | None = None) -> FloatArray:
        """Return P(sigma) per nominal area in 1/Pa at pressures in Pa; the integral over sigma > 0 is A/A0.

        With `wavenumber` (rad/m) only the roughness up to that wavenumber is resolved. ValueError if there is none.
        """
        modulus = self.plane_strain_modulus
        stress, mean = np.asarray(pressure, dtype=np.float64) / modulus, self.mean_pressure / modulus
        resolved = self.spectrum.total_slope_variance
        if wavenumber is not None:
            resolved = self.spectrum.resolved_variance(wavenumber)
            if resolved == 0:
                raise ValueError(f"wavenumber: {wavenumber} resolves no roughness; P is a delta function there (rad/m)")
        variance = resolved / 4
        direct = np.exp(-((stress - mean) ** 2) / (2 * variance))
        image = -np.expm1(-2 * stress * mean / variance)
        return np.where(stress > 0, direct * image / (np.sqrt(2 * np.pi * variance) * modulus), 0.0)

    def displacement_power(self, period_wavenumber: float | None = None) -> FloatArray:
        """Return C_u = C A(q)/A0 in m^3 at the wavenumbers of the spectrum; lines need q0 of their period 2 pi / q0."""
        return power(self.spectrum, period_wavenumber) * self.contact_fractions

    def pressure_power(self, period_wavenumber: float | None = None) -> FloatArray:
        """Return C_sigma(q) = E*^2 q^2 C_u / 4 in Pa^2 m, at the wavenumbers of the spectrum."""
        stiffness = self.plane_strain_modulus * self.spectrum.wavenumbers / 2
        return np.asarray(stiffness**2 * self.displacement_power(period_wavenumber))


def solve_nonadhesive(
    spectrum: Spectrum, mean_pressure: float, *, youngs_modulus: float, poisson_ratio: float
) -> NonadhesiveContact:
    """Compute area, separation, energy and spectra at one load.

    Parameters
    ----------
    spectrum : DiscreteSpectrum or ContinuousSpectrum
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
    >>> lines = DiscreteSpectrum([1.0, 2.0], [0.1, 0.05])
    >>> contact = solve_nonadhesive(lines, 0.01, youngs_modulus=1.0, poisson_ratio=0.0)
    >>> round(contact.contact_fraction, 6), contact.status
    (0.158519, 'converged')
    """
    modulus = plane_strain_modulus(youngs_modulus, poisson_ratio)
    load = dimensionless_load(mean_pressure, modulus)
    total = np.array([spectrum.total_slope_variance])
    fraction = float(contact_fraction(total, load)[0])
    return NonadhesiveContact(
        spectrum=spectrum,
        mean_pressure=mean_pressure,
        plane_strain_modulus=modulus,
        contact_fraction=fraction,
        separation=separation_length(spectrum, load),
        elastic_energy=modulus * float(energy_length(spectrum, load, total)[0]),
        contact_fractions=contact_fraction(spectrum.slope_variance, load),
        status=status_of(spectrum, fraction),
    )


def plane_strain_modulus(youngs_modulus: float, poisson_ratio: float) -> float:
    """Return E* = E / (1 - nu^2) in Pa; ValueError outside E > 0, nu in (-1, 0.5].

    Examples
    --------
    >>> plane_strain_modulus(0.75, 0.5)
    1.0
    """
    if not (youngs_modulus > 0 and np.isfinite(youngs_modulus)):
        raise ValueError(f"youngs_modulus: {youngs_modulus} must be finite and > 0 (Pa)")
    if not -1 < poisson_ratio <= 0.5:
        raise ValueError(f"poisson_ratio: {poisson_ratio} must lie in (-1, 0.5]")
    return youngs_modulus / (1 - poisson_ratio**2)


def dimensionless_load(mean_pressure: float, modulus: float) -> float:
    """Return sigma_0 / E*; ValueError unless sigma_0 > 0."""
    if not (mean_pressure > 0 and np.isfinite(mean_pressure)):
        raise ValueError(
            f"mean_pressure: {mean_pressure} must be finite and > 0 (Pa); the separation integral diverges at zero load"
        )
    return mean_pressure / modulus


def status_of(spectrum: Spectrum, fraction: float) -> Status:
    """Return the status of a state from its contact fraction and the kind of its spectrum."""
    if isinstance(spectrum, DiscreteSpectrum) and spectrum.n_carriers == 1:
        return "single_line"
    return "complete_contact" if 1 - fraction < COMPLETE else "converged"


def power(spectrum: Spectrum, period_wavenumber: float | None) -> FloatArray:
    """Return the two-sided C in m^3 at the wavenumbers of the spectrum; lines need the wavenumber of their period."""
    if isinstance(spectrum, ContinuousSpectrum):
        if period_wavenumber is not None:
            raise ValueError(
                f"period_wavenumber: {period_wavenumber}; a continuous spectrum has no period, leave it out"
            )
        return spectrum.power
    if period_wavenumber is None:
        raise ValueError("period_wavenumber: None; lines have a power only for a period 2 pi / q0 (rad/m, > 0)")
    return spectrum.power(period_wavenumber)


def contact_fraction(slope_variance: FloatArray, load: float | FloatArray) -> FloatArray:
    """Return A/A0 at S and sigma_0 / E*, of shapes that broadcast; 1 at S = 0."""
    with np.errstate(divide="ignore"):
        return np.asarray(erf(np.sqrt(2) * load / np.sqrt(slope_variance)))


def energy_length(spectrum: Spectrum, load: float, ends: FloatArray) -> FloatArray:
    """Return 1/4 int_0^S (A/A0) / q dS in m up to each S of ends, (n,).

    The integral is the elastic energy over E* of the roughness below S.
    """

    def antiderivative(s: FloatArray) -> FloatArray:
        return _area_integral(s, load)

    def density(s: FloatArray) -> FloatArray:
        return contact_fraction(s, load)

    return spectrum.weighted_integral(antiderivative, density, ends) / 4


def separation_length(spectrum: Spectrum, load: float) -> float:
    """Return the separation s in m at a load sigma_0 / E*."""

    def antiderivative(s: FloatArray) -> FloatArray:
        return _separation_integral(s, load)

    def density(s: FloatArray) -> FloatArray:
        return np.asarray(np.sqrt(2 / (np.pi * s)) * exp1(2 * load**2 / s))

    return float(spectrum.weighted_integral(antiderivative, density, np.array([spectrum.total_slope_variance]))[0] / 4)


def _area_integral(variance: FloatArray, load: float) -> FloatArray:
    """Return int_0^S erf(c / sqrt S) dS, c = sqrt 2 sigma_0."""
    c = np.sqrt(2) * load
    with np.errstate(divide="ignore"):
        ratio = c / np.sqrt(variance)
    # (S + 2c^2) erf + 2 c sqrt(S / pi) exp(-c^2 / S) - 2 c^2, written without the difference of large numbers
    lost = -(variance + 2 * c**2) * erfc(ratio) + 2 * c * np.sqrt(variance / np.pi) * np.exp(-(ratio**2))
    return np.asarray(variance + lost)


def _separation_integral(variance: FloatArray, load: float) -> FloatArray:
    """Return int_0^S sqrt(2 / (pi S)) E1(a / S) dS, a = 2 sigma_0^2, integrated by parts twice."""
    a = 2 * load**2
    with np.errstate(divide="ignore"):
        x = a / variance
    root = np.sqrt(variance)
    value = 2 * root * exp1(x) - 4 * root * np.exp(-x) + 4 * np.sqrt(np.pi * a) * erfc(np.sqrt(x))
    return np.asarray(np.sqrt(2 / np.pi) * value)
