"""The paper's double Gaussian as a fit of a stress distribution, with a relaxed sigma_a and G.

    P(sigma) = [exp(-(s - sigma_0)^2 / 4 G sigma_0^2) - exp(-(s + sigma_0)^2 / 4 G sigma_0^2)] / (2 sigma_0 sqrt(pi G)),
    s = sigma + sigma_a > 0, and zero below.

It vanishes at -sigma_a and solves the diffusion equation with a barrier held there, from delta(sigma - sigma_0 +
sigma_a): its centres lie at -sigma_a +- sigma_0, and its load is sigma_0 - sigma_a A/A0, not sigma_0.  The theory's
barrier moves with the wavenumber, so that this is a fit of the theory's own P too, and its sigma_a a number of the fit.
The paper relaxes sigma_a and G.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, final double Gaussian, with
G sigma_0^2 where the print mixes units.  SI units.  Limits: the tensile tail |sigma|^-3 of a real contact lies outside,
so that the window and the weights of a fit decide about sigma_a: state them, and read the residual.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares
from scipy.special import erf

from persson.mathematics.arrays import FloatArray

LEAST_POINTS = 4
STARTS = (0.02, 0.2, 0.6, 1.5)  # of sigma_a, in standard deviations of the density given
LEAST = 1e-3  # of the largest density: where ln P is fitted
FLOOR = 1e-8  # of the largest density: what ln P sees of a fit that has ended
WIDEST = 14.0  # standard deviations of sigma_a, and logarithms of G: bounds of a fit to noise
MOST_EVALUATIONS = 5000  # of one fit: noise has long valleys


@dataclass(frozen=True)
class DoubleGaussian:
    """A fit: sigma_0 and sigma_a in Pa, G dimensionless; rms residual over the largest P."""

    mean_pressure: float
    detachment_stress: float
    diffusivity: float
    residual: float

    @property
    def load(self) -> float:
        """int sigma P dsigma in Pa: sigma_0 - sigma_a A/A0 with A/A0 = erf(1 / (2 sqrt G))."""
        area = erf(1 / (2 * np.sqrt(self.diffusivity)))
        return float(self.mean_pressure - self.detachment_stress * area)

    def __call__(self, pressure: ArrayLike) -> FloatArray:
        """Return P in 1/Pa at pressures in Pa; zero below -sigma_a."""
        return double_gaussian(pressure, self.mean_pressure, self.detachment_stress, self.diffusivity)


def double_gaussian(
    pressure: ArrayLike, mean_pressure: float, detachment_stress: float, diffusivity: float
) -> FloatArray:
    """Return P in 1/Pa at pressures in Pa, any shape.

    Examples
    --------
    >>> round(float(double_gaussian(1.0, 1.0, 0.0, 0.5)), 9)
    0.344951314
    >>> float(double_gaussian(-0.8, 1.0, 0.8, 0.6))
    0.0
    """
    above = np.asarray(pressure, dtype=np.float64) + detachment_stress
    spread = 4 * diffusivity * mean_pressure**2
    difference = np.exp(-((above - mean_pressure) ** 2) / spread) - np.exp(-((above + mean_pressure) ** 2) / spread)
    return np.where(above > 0, difference / np.sqrt(np.pi * spread), 0.0)


def fit_double_gaussian(
    pressure: ArrayLike,
    density: ArrayLike,
    mean_pressure: float,
    *,
    logarithmic: bool = False,
) -> DoubleGaussian:
    """Fit sigma_a and G to the given points by least squares, sigma_0 fixed, from the best of several starts.

    Parameters
    ----------
    pressure, density : (n,) array
        sigma in Pa and P in 1/Pa, n >= 4, finite.
    mean_pressure : float
        sigma_0 in Pa, > 0.
    logarithmic : bool
        Equal weights of ln P, over the points with more than 1e-3 of the largest P, rather than of P.

    Raises
    ------
    ValueError
        Bad input.
    ArithmeticError
        If the least squares do not converge.

    Examples
    --------
    >>> sigma = np.linspace(-0.4, 5.0, 60)
    >>> fit = fit_double_gaussian(sigma, double_gaussian(sigma, 1.0, 0.3, 0.6), 1.0)
    >>> round(fit.detachment_stress, 6), round(fit.diffusivity, 6), fit.residual < 1e-9
    (0.3, 0.6, True)
    """
    sigma, target = _checked(pressure, density, mean_pressure)
    peak = float(np.max(target))
    variance = max(float(np.sum(target * (sigma - mean_pressure) ** 2) / np.sum(target)), 1e-6 * mean_pressure**2)
    inside = target > LEAST * peak if logarithmic else np.full(target.shape, True)

    def made(parameters: FloatArray, residual: float = np.nan) -> DoubleGaussian:
        stress, diffusivity = parameters[0] * np.sqrt(variance), np.exp(parameters[1])
        return DoubleGaussian(mean_pressure, float(stress), float(diffusivity), residual)

    def misfit(parameters: FloatArray) -> FloatArray:
        fitted = made(parameters)(sigma[inside])
        if logarithmic:
            return np.asarray(np.log(np.maximum(fitted, FLOOR * peak)) - np.log(target[inside]))
        return np.asarray((fitted - target[inside]) / peak)

    spread = np.log(variance / (2 * mean_pressure**2))
    fits = [
        least_squares(
            misfit,
            np.array([start, spread]),
            bounds=([0.0, spread - WIDEST], [WIDEST, spread + WIDEST]),
            xtol=1e-12,
            ftol=1e-12,
            gtol=1e-12,
            max_nfev=MOST_EVALUATIONS,
        )
        for start in STARTS
    ]
    ended = [fit for fit in fits if fit.success]
    if not ended:
        raise ArithmeticError(f"double Gaussian: {fits[0].message}")
    best = min(ended, key=lambda fit: float(fit.cost))
    return made(best.x, float(np.sqrt(np.mean(((made(best.x)(sigma) - target) / peak) ** 2))))


def _checked(pressure: ArrayLike, density: ArrayLike, mean_pressure: float) -> tuple[FloatArray, FloatArray]:
    """Return the points as arrays; ValueError names the invalid value."""
    sigma, target = np.asarray(pressure, dtype=np.float64), np.asarray(density, dtype=np.float64)
    if sigma.ndim != 1 or sigma.size < LEAST_POINTS or sigma.shape != target.shape:
        raise ValueError(
            f"pressure, density: shapes {sigma.shape}, {target.shape}; two lists of one length >= {LEAST_POINTS} needed"
        )
    if not (np.all(np.isfinite(sigma)) and np.all(np.isfinite(target)) and np.any(target > 0)):
        raise ValueError("density: finite values with some > 0 are needed (1/Pa)")
    if not (np.isfinite(mean_pressure) and mean_pressure > 0):
        raise ValueError(f"mean_pressure: {mean_pressure} must be finite and > 0 (Pa)")
    return sigma, target
