"""Elastic layer of finite thickness, bonded to a rigid plate: a smooth addition to the half-space kernel.

A mode q = m q0 of pressure on the frictionless lower face displaces it by c(q) times itself,

    c(q) = 2 / (E* q) ratio(q d),
    ratio = [(3-4nu) sinh y - y] / [(3-4nu) cosh y + y^2/2 + 5 - 12 nu + 8 nu^2],      y = 2 q d,
    c(0) = d (1-2nu)(1+nu) / (E (1-nu))

(G. Carbone, L. Mangialardi, J. Mech. Phys. Solids 56 (2008) 684).  The ratio tends to 1 for thick layers, so that the
kernel is that of the half-space and a smooth rest S, a series (kernel_series.py) of terms s_m = (1 - ratio_m) / m > 0.

Every sum below has terms of one sign, so neither ratio nor 1 - ratio loses digits for thin or thick layers or at
nu = 1/2; sinh and cosh carry a factor exp(-y) and do not overflow.  S is analytic for |Im x| < 2 q0 d: about
1.1 (ln 1/tolerance) / (2 q0 d) terms are needed, 124 for d = 0.02 periods at 1e-12.
The mean compression c(0) sigma_0 is not part of S; it turns the penetration into the total displacement.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from bem.elastic.kernel_series import KernelSeries, kernel_series
from bem.geometry.arrays import FloatArray
from bem.geometry.scaling import Solid
from bem.geometry.table import limits, table


def compliance_ratio(q_d: ArrayLike, poisson_ratio: float) -> FloatArray:
    """Return the compliance of a layer relative to the half-space, c(q) E* q / 2.

    Parameters
    ----------
    q_d : array
        Wavenumber times thickness, dimensionless, >= 0.
    poisson_ratio : float
        nu in (-1, 0.5].

    Returns
    -------
    array of the shape of q_d, in [0, 1)
        (1-2nu) q d / (2 (1-nu)^2) for thin layers; 2 (q d)^3 / 3 when nu = 1/2.

    Examples
    --------
    >>> round(float(compliance_ratio(1e-9, 0.5)) / 1e-27, 12)       # 2/3 (q d)^3
    0.666666666667
    >>> float(compliance_ratio(1e4, 0.3))
    1.0
    """
    y = 2 * np.asarray(q_d, dtype=np.float64)
    decay = np.exp(-y)
    sinh = -np.expm1(-2 * y) / 2  # times exp(-y), as are the following
    numerator = 2 * (1 - 2 * poisson_ratio) * sinh + _sinh_minus_argument(y)
    return np.asarray(numerator / _denominator(y, decay, poisson_ratio))


def compliance_deficit(q_d: ArrayLike, poisson_ratio: float) -> FloatArray:
    """Return 1 - compliance_ratio, to full relative accuracy also where it is tiny.

    Parameters
    ----------
    q_d : array
        Wavenumber times thickness, dimensionless, >= 0.
    poisson_ratio : float
        nu in (-1, 0.5].

    Examples
    --------
    >>> bool(0 < compliance_deficit(100.0, 0.5) < 1e-80)
    True
    """
    y = 2 * np.asarray(q_d, dtype=np.float64)
    decay = np.exp(-y)
    numerator = decay * ((3 - 4 * poisson_ratio) * decay + y + _constant(poisson_ratio)) + _square_term(y)
    return np.asarray(numerator / _denominator(y, decay, poisson_ratio))


def _constant(poisson_ratio: float) -> float:
    return 5 - 12 * poisson_ratio + 8 * poisson_ratio**2


def _denominator(y: FloatArray, decay: FloatArray, poisson_ratio: float) -> FloatArray:
    cosh = (1 + decay * decay) / 2
    return np.asarray((3 - 4 * poisson_ratio) * cosh + decay * _constant(poisson_ratio) + _square_term(y))


def _square_term(y: FloatArray) -> FloatArray:
    """Return y^2/2 exp(-y), without overflow for any y."""
    return np.asarray((y * np.exp(-y / 2)) ** 2 / 2)


def _sinh_minus_argument(y: FloatArray) -> FloatArray:
    """Return (sinh y - y) exp(-y), for y < 2 by its Taylor series (10 terms, truncation below 1e-18)."""
    small = np.minimum(y, 2.0)
    square = small * small
    series = np.ones_like(small)
    for k in range(21, 3, -2):
        series = 1 + series * square / (k * (k - 1))
    series = series * small * square / 6 * np.exp(-small)
    return np.where(y < 2, series, -np.expm1(-2 * y) / 2 - y * np.exp(-y))


@table("layer")
class Layer:
    """Elastic layer of uniform thickness, its back bonded to a rigid plate.

    Parameters
    ----------
    thickness : float
        In m, > 0 and finite; without a layer the solid is a half-space.

    Examples
    --------
    A layer of 1 mm under 1 kPa gives way by nothing if it is incompressible, else by

    >>> [round(1e3 * Layer(1e-3).mean_compliance(Solid(1e6, nu)) * 1e9) for nu in (0.5, 0.49, 0.3)]  # nm
    [0, 58, 743]
    """

    thickness: Annotated[float, limits("layer.thickness")]

    def mean_compliance(self, solid: Solid) -> float:
        """Return c(0), mean displacement of the face per mean pressure, m/Pa."""
        nu = solid.poisson_ratio
        return self.thickness * (1 - 2 * nu) * (1 + nu) / (solid.youngs_modulus * (1 - nu))

    def total_displacement(self, solid: Solid, penetration: float, mean_pressure: float) -> float:
        """Return the displacement of the plate from first touch, Delta + c(0) sigma_0, in m (m and Pa given)."""
        return penetration + self.mean_compliance(solid) * mean_pressure

    def penetration(self, solid: Solid, total_displacement: float, mean_pressure: float) -> float:
        """Return Delta at a displacement of the plate and a mean pressure, in m (m and Pa given)."""
        return total_displacement - self.mean_compliance(solid) * mean_pressure

    def compliance(self, solid: Solid, wavenumber: ArrayLike) -> FloatArray:
        """Return c(q), m/Pa, at wavenumbers q > 0 in rad/m; shape of `wavenumber`."""
        q = np.asarray(wavenumber, dtype=np.float64)
        return np.asarray(
            2 / (solid.plane_strain_modulus * q) * compliance_ratio(q * self.thickness, solid.poisson_ratio)
        )

    def effect(self, solid: Solid, period: float) -> LayerEffect:
        """Return the effect of the layer on a half-space of its solid, by modes of a period (m)."""
        thickness = 2 * np.pi * self.thickness / period
        return LayerEffect(thickness, solid.poisson_ratio, self.mean_compliance(solid))

    def kernel(self, solid: Solid, period: float, tolerance: float) -> KernelSeries:
        """Return the series that the layer adds to the kernel of the half-space, dimensionless.

        Parameters
        ----------
        solid : Solid
        period : float
            m.
        tolerance : float
            Bound of the truncated terms, sum |s_m|; the kernel itself is of order one.
        """
        return kernel_series(self.effect(solid, period), tolerance)


@dataclass(frozen=True)
class LayerEffect:
    """Elastic effect of a layer, by modes m >= 1.

    Parameters
    ----------
    thickness : float
        q0 d, dimensionless.
    poisson_ratio : float
        nu.
    mean_compliance : float
        c(0), m/Pa.

    Examples
    --------
    >>> kernel = kernel_series(LayerEffect(2 * np.pi * 0.02, 0.5), 1e-12)
    >>> kernel.terms, kernel.truncation < 1e-12
    (124, True)
    """

    thickness: float
    poisson_ratio: float
    mean_compliance: float = 0.0

    @property
    def strip(self) -> float:
        """Half width 2 q0 d of the strip about the real axis in which S is analytic."""
        return 2 * self.thickness

    @property
    def relative_effect(self) -> float:
        """Relative effect on the longest wave, the largest of all."""
        return float(self.deficit(1.0))

    def ratio(self, orders: ArrayLike) -> FloatArray:
        """Return the compliance relative to the half-space, shape of `orders`."""
        return compliance_ratio(np.asarray(orders) * self.thickness, self.poisson_ratio)

    def deficit(self, orders: ArrayLike) -> FloatArray:
        """Return 1 - ratio, shape of `orders`."""
        return compliance_deficit(np.asarray(orders) * self.thickness, self.poisson_ratio)
