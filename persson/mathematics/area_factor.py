"""Real over projected area of a Gaussian rough surface: how much true length of the profile a contact adheres to.

With xi^2 the variance of the slope not yet resolved, M(xi^2) = <sqrt(1 + h'^2)>.

- Roughness in one direction, Gaussian slope of variance xi^2:
      M = (2 pi xi^2)^-1/2 int sqrt(1 + y^2) exp(-y^2 / 2 xi^2) dy = [K0e(k) + K1e(k)] / (2 xi sqrt(2 pi)),
  k = 1 / (4 xi^2), K_ne(k) = exp(k) K_n(k).
- Two-dimensional isotropic roughness, as the paper has it:
      M = int_0^inf sqrt(1 + xi^2 x) exp(-x) dx = 1 + (sqrt pi / 2) xi erfcx(1 / xi).

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601; B. N. J. Persson,
Eur. Phys. J. E 8 (2002) 385.  Dimensionless.  Limits: M = 1 + xi^2 / 2 for small xi in both.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erfcx, kve

from persson.mathematics.arrays import FloatArray

AreaFactor = Callable[[ArrayLike], FloatArray]

SERIES_BELOW = 1e-4  # of xi^2: next term of the series below 1e-16


def gaussian_slope_1d(unresolved_slope_variance: ArrayLike) -> FloatArray:
    """Return M of a Gaussian slope in one direction.

    Parameters
    ----------
    unresolved_slope_variance : array, any shape
        xi^2 >= 0, dimensionless.

    Examples
    --------
    >>> [round(float(gaussian_slope_1d(v)), 9) for v in (0.0, 1.0)]
    [1.0, 1.354530806]
    """
    variance = np.asarray(unresolved_slope_variance, dtype=np.float64)
    small = variance < SERIES_BELOW
    safe = np.where(small, 1.0, variance)
    k = 1 / (4 * safe)
    closed = (kve(0, k) + kve(1, k)) / (2 * np.sqrt(2 * np.pi * safe))
    series = 1 + variance / 2 - 3 * variance**2 / 8 + 15 * variance**3 / 16
    return np.where(small, series, closed)


def isotropic_2d(unresolved_slope_variance: ArrayLike) -> FloatArray:
    """Return the paper's M for two-dimensional isotropic roughness; xi^2 is the variance of the full gradient.

    Parameters
    ----------
    unresolved_slope_variance : array, any shape
        xi^2 >= 0, dimensionless.

    Examples
    --------
    >>> [round(float(isotropic_2d(v)), 9) for v in (0.0, 1.0)]
    [1.0, 1.378936078]
    """
    variance = np.asarray(unresolved_slope_variance, dtype=np.float64)
    small = variance < SERIES_BELOW
    xi = np.sqrt(np.where(small, 1.0, variance))
    closed = 1 + np.sqrt(np.pi) / 2 * xi * erfcx(1 / xi)
    series = 1 + variance / 2 - variance**2 / 4 + 3 * variance**3 / 8
    return np.where(small, series, closed)


AREA_FACTORS: dict[str, AreaFactor] = {"gaussian_slope_1d": gaussian_slope_1d, "isotropic_2d": isotropic_2d}
