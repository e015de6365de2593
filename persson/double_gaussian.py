"""The paper's double Gaussian as a fit of a stress distribution, with a relaxed sigma_a and G.

    P(sigma) = [exp(-(sigma - sigma_0)^2 / 4 G sigma_0^2) - exp(-(sigma + sigma_0 + sigma_a)^2 / 4 G sigma_0^2)]
               / (2 sigma_0 sqrt(pi G)).

It solves the diffusion equation, but with the barrier at -sigma_a / 2 where it vanishes: a barrier held at -sigma_a
would have its image at -sigma_0 - 2 sigma_a.  The theory's barrier moves, and no double Gaussian solves it.  So it is a
fit and sigma_a a number of the fit, not the detachment stress of the theory; `fit_double_gaussian` returns both
parameters and the residual.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601, final double
Gaussian, with G sigma_0^2 where the print mixes units.  SI units.  Limits: the tensile tail |sigma|^-3 of a real
contact lies outside; state the window of the fit.  At small loads the theory's P is no double Gaussian (residual 0.09,
sigma_a near 0, where the fit is bounded): the residual shows it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

FloatArray = NDArray[np.float64]

LEAST_POINTS = 3


@dataclass(frozen=True)
class DoubleGaussian:
    """Parameters of the fit: sigma_0 and sigma_a in Pa, G dimensionless; rms residual over the largest P."""

    mean_pressure: float
    detachment_stress: float
    diffusivity: float
    residual: float

    def __call__(self, pressure: ArrayLike) -> FloatArray:
        """P in 1/Pa at pressures in Pa; zero below -sigma_a / 2."""
        return double_gaussian(pressure, self.mean_pressure, self.detachment_stress, self.diffusivity)


def double_gaussian(
    pressure: ArrayLike, mean_pressure: float, detachment_stress: float, diffusivity: float
) -> FloatArray:
    """P in 1/Pa at pressures in Pa, any shape.

    Examples
    --------
    >>> round(float(double_gaussian(1.0, 1.0, 0.0, 0.5)), 9)
    0.344951314
    """
    sigma = np.asarray(pressure, dtype=np.float64)
    spread = 4 * diffusivity * mean_pressure**2
    direct = np.exp(-((sigma - mean_pressure) ** 2) / spread)
    image = np.exp(-((sigma + mean_pressure + detachment_stress) ** 2) / spread)
    value = (direct - image) / np.sqrt(np.pi * spread)
    return np.where(sigma > -detachment_stress / 2, value, 0.0)


def fit_double_gaussian(pressure: ArrayLike, density: ArrayLike, mean_pressure: float) -> DoubleGaussian:
    """Least squares over the points given, sigma_0 held.

    Parameters
    ----------
    pressure, density : (n,) array
        sigma in Pa and P in 1/Pa, n >= 3, finite.
    mean_pressure : float
        sigma_0 in Pa, > 0.

    Raises
    ------
    ValueError
        Bad input.
    ArithmeticError
        If the least squares do not converge.

    Examples
    --------
    >>> sigma = np.linspace(-0.4, 5.0, 60)
    >>> fit = fit_double_gaussian(sigma, double_gaussian(sigma, 1.0, 0.8, 0.6), 1.0)
    >>> round(fit.detachment_stress, 6), round(fit.diffusivity, 6)
    (0.8, 0.6)
    """
    sigma, target = np.asarray(pressure, dtype=np.float64), np.asarray(density, dtype=np.float64)
    if sigma.ndim != 1 or sigma.size < LEAST_POINTS or sigma.shape != target.shape:
        raise ValueError(
            f"pressure, density: shapes {sigma.shape}, {target.shape}; two lists of one length >= 3 needed"
        )
    if not (np.all(np.isfinite(sigma)) and np.all(np.isfinite(target)) and np.any(target > 0)):
        raise ValueError("density: finite values with some > 0 are needed (1/Pa)")
    if not (np.isfinite(mean_pressure) and mean_pressure > 0):
        raise ValueError(f"mean_pressure: {mean_pressure} must be finite and > 0 (Pa)")
    scale = float(np.max(target))
    variance = max(float(np.sum(target * (sigma - mean_pressure) ** 2) / np.sum(target)), 1e-6 * mean_pressure**2)

    def residual(parameters: FloatArray) -> FloatArray:
        stress, diffusivity = parameters[0] * np.sqrt(variance), np.exp(parameters[1])
        return np.asarray((double_gaussian(sigma, mean_pressure, stress, diffusivity) - target) / scale)

    start = np.array([0.5, np.log(variance / (2 * mean_pressure**2))])
    fit = least_squares(residual, start, bounds=([0.0, -np.inf], np.inf), xtol=1e-12, ftol=1e-12, gtol=1e-12)
    if not fit.success:
        raise ArithmeticError(f"double Gaussian: {fit.message}")
    return DoubleGaussian(
        mean_pressure=mean_pressure,
        detachment_stress=float(fit.x[0] * np.sqrt(variance)),
        diffusivity=float(np.exp(fit.x[1])),
        residual=float(np.sqrt(np.mean(fit.fun**2))),
    )
