"""Elastic layer of finite thickness, bonded to a rigid plate: a smooth addition to the half-space kernel.

A mode q = m q0 of pressure on the frictionless lower face displaces it by c(q) times itself,

    c(q) = 2 / (E* q) ratio(q d),
    ratio = [(3-4nu) sinh y - y] / [(3-4nu) cosh y + y^2/2 + 5 - 12 nu + 8 nu^2],      y = 2 q d,
    c(0) = d (1-2nu)(1+nu) / (E (1-nu))

(G. Carbone, L. Mangialardi, J. Mech. Phys. Solids 56 (2008) 684).  The ratio tends to 1 for thick layers, so that in
the units of the solver (scaling.py) the kernel is that of the half-space and a smooth rest:

    -sum_m ratio_m cos(m x) / m = log|2 sin(x/2)| + S(x),   S(x) = sum_m s_m cos(m x),   s_m = (1 - ratio_m) / m > 0.

Every sum below has terms of one sign, so neither ratio nor 1 - ratio loses digits for thin or thick layers or at
nu = 1/2; sinh and cosh carry a factor exp(-y) and do not overflow.  S is analytic for |Im x| < 2 q0 d: about
1.1 (ln 1/tolerance) / (2 q0 d) terms are needed, 124 for d = 0.02 periods at 1e-12.
The mean compression c(0) sigma_0 is not part of S; it turns the penetration into the total displacement.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bem.geometry.scaling import Solid

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_BLOCK = 2_000_000  # complex numbers held at a time


def compliance_ratio(q_d: ArrayLike, poisson_ratio: float) -> FloatArray:
    """Compliance of a layer relative to the half-space, c(q) E* q / 2.

    Parameters
    ----------
    q_d : array
        Wavenumber times thickness, dimensionless, >= 0.
    poisson_ratio : float
        nu in (-1, 0.5].

    Returns
    -------
    array of the same shape, in [0, 1)
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
    """1 - compliance_ratio, to full relative accuracy also where it is tiny.

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
    """y^2/2 exp(-y), without overflow for any y."""
    return np.asarray((y * np.exp(-y / 2)) ** 2 / 2)


def _sinh_minus_argument(y: FloatArray) -> FloatArray:
    """(sinh y - y) exp(-y): by its Taylor series (10 terms, truncation below 1e-18) for y < 2."""
    small = np.minimum(y, 2.0)
    square = small * small
    series = np.ones_like(small)
    for k in range(21, 3, -2):
        series = 1 + series * square / (k * (k - 1))
    series = series * small * square / 6 * np.exp(-small)
    return np.where(y < 2, series, -np.expm1(-2 * y) / 2 - y * np.exp(-y))


@dataclass(frozen=True)
class Layer:
    """An elastic layer of uniform thickness, its back bonded to a rigid plate.

    Parameters
    ----------
    thickness : float
        d in m, > 0 and finite; a half-space is described by no layer at all.

    Examples
    --------
    >>> Layer(0.001).mean_compliance(Solid(1e6, 0.5))
    0.0
    """

    thickness: float

    def __post_init__(self) -> None:
        if not (self.thickness > 0 and np.isfinite(self.thickness)):
            raise ValueError(f"thickness: {self.thickness} must be finite and > 0 (m)")

    def mean_compliance(self, solid: Solid) -> float:
        """c(0), mean displacement of the face per mean pressure, m/Pa."""
        nu = solid.poisson_ratio
        return self.thickness * (1 - 2 * nu) * (1 + nu) / (solid.youngs_modulus * (1 - nu))

    def total_displacement(self, solid: Solid, penetration: float, mean_pressure: float) -> float:
        """Displacement of the plate from first touch, Delta + c(0) sigma_0, in m (m and Pa given)."""
        return penetration + self.mean_compliance(solid) * mean_pressure

    def penetration(self, solid: Solid, total_displacement: float, mean_pressure: float) -> float:
        """Delta of a state with this displacement of the plate and mean pressure, in m (m and Pa given)."""
        return total_displacement - self.mean_compliance(solid) * mean_pressure

    def compliance(self, solid: Solid, wavenumber: ArrayLike) -> FloatArray:
        """c(q), m/Pa, at wavenumbers q > 0 in rad/m; same shape."""
        q = np.asarray(wavenumber, dtype=np.float64)
        return np.asarray(
            2 / (solid.plane_strain_modulus * q) * compliance_ratio(q * self.thickness, solid.poisson_ratio)
        )

    def relative_effect(self, solid: Solid, period: float) -> float:
        """Largest relative change of the compliance of any mode against the half-space (that of q0; the mean apart)."""
        return float(compliance_deficit(2 * np.pi * self.thickness / period, solid.poisson_ratio))

    def is_negligible(self, solid: Solid, period: float, tolerance: float) -> bool:
        """Whether the half-space kernel serves to a relative `tolerance`; the mean compression remains.

        Parameters
        ----------
        solid : Solid
        period : float
            m.
        tolerance : float
            Relative.

        Examples
        --------
        >>> solid = Solid(1e6, 0.5)
        >>> Layer(0.03).is_negligible(solid, 0.01, 1e-6), Layer(0.01).is_negligible(solid, 0.01, 1e-6)
        (True, False)
        """
        return self.relative_effect(solid, period) < tolerance

    def kernel(self, solid: Solid, period: float, tolerance: float) -> LayerKernel:
        """The smooth addition S to the half-space kernel, dimensionless.

        Parameters
        ----------
        solid : Solid
        period : float
            m.
        tolerance : float
            Bound of the truncated terms, sum |s_m|; the kernel itself is of order one.
        """
        return layer_kernel(2 * np.pi * self.thickness / period, solid.poisson_ratio, tolerance)


@dataclass(frozen=True, eq=False)
class LayerKernel:
    """S(x) = sum_m s_m cos(m x), what a layer adds to log|2 sin(x/2)|.

    Modes beyond the last term have the compliance of the half-space.

    Parameters
    ----------
    thickness : float
        q0 d, dimensionless.
    poisson_ratio : float
        nu.
    weights : (n_terms,) array
        s_m, m = 1..n_terms, positive and decreasing.
    truncation : float
        Sum of the terms left out, at least.
    """

    thickness: float
    poisson_ratio: float
    weights: FloatArray
    truncation: float

    @property
    def terms(self) -> int:
        """Number of terms kept."""
        return int(self.weights.size)

    @property
    def orders(self) -> FloatArray:
        """m = 1..n_terms."""
        return np.arange(1.0, self.terms + 1)

    @property
    def strip(self) -> float:
        """Half width 2 q0 d of the strip about the real axis in which S is analytic."""
        return 2 * self.thickness

    def ratio(self, orders: ArrayLike) -> FloatArray:
        """Compliance of the modes m >= 1 relative to the half-space, same shape."""
        return compliance_ratio(np.asarray(orders) * self.thickness, self.poisson_ratio)

    def smooth(self, x: ArrayLike) -> FloatArray:
        """S(x), same shape as x."""
        return self._sum(x, self.weights, imaginary=False)

    def slope(self, x: ArrayLike) -> FloatArray:
        """S'(x), same shape as x."""
        return self._sum(x, -self.weights * self.orders, imaginary=True)

    def curvature(self, x: ArrayLike) -> FloatArray:
        """S''(x), same shape as x."""
        return self._sum(x, -self.weights * self.orders**2, imaginary=False)

    def factors(self, x: FloatArray) -> FloatArray:
        """V (n, 2 n_terms) with S(x_i - x_j) = V_i . V_j: columns sqrt(s_m) cos(m x), then sqrt(s_m) sin(m x)."""
        waves = _powers(np.exp(1j * x), self.terms) * np.sqrt(self.weights)
        return np.concatenate([waves.real, waves.imag], axis=1)

    def matrix(self, x: FloatArray) -> FloatArray:
        """S(x_i - x_j) for all pairs, (n, n): one symmetric product."""
        columns = max(1, _BLOCK // max(1, x.size))
        if self.terms <= columns:
            factors = self.factors(x)
            return np.asarray(factors @ factors.T)
        total = np.zeros((x.size, x.size))
        base = np.exp(1j * x)
        for first in range(0, self.terms, columns):
            weights = self.weights[first : first + columns]
            waves = _powers(base, weights.size) * np.exp(1j * first * x)[:, None] * np.sqrt(weights)
            factors = np.concatenate([waves.real, waves.imag], axis=1)
            total += factors @ factors.T
        return total

    def field(self, x: FloatArray, sources: FloatArray, charges: FloatArray) -> FloatArray:
        """sum_j S(x_i - source_j) charge_j, (n,)."""
        moments = np.empty(self.terms, dtype=np.complex128)
        for first in range(0, self.terms, 256):
            last = min(first + 256, self.terms)
            waves = _powers(np.exp(-1j * sources), last - first)
            moments[first:last] = (charges * np.exp(-1j * first * sources)) @ waves
        return self.from_moments(x, moments)

    def from_moments(self, x: ArrayLike, moments: ComplexArray) -> FloatArray:
        """int S(x - x') sigma(x') dx' from moments int sigma exp(-i m x) dx, m = 1..n_terms; same shape as x."""
        return self._sum(x, self.weights * moments[: self.terms], imaginary=False)

    def coupled_modes(self, width: FloatArray, tolerance: float) -> FloatArray:
        """Chebyshev modes of patches of these widths that feel S to `tolerance`, (L,).

        S(x - x') with both points in the patch is analytic in the Bernstein ellipse of semi-minor axis
        b = 2 q0 d / r, r = width / 2, so its coefficients decay as rho^-n, rho = b + sqrt(1 + b^2).  The factor 1/30
        was measured: with it K is within `tolerance` / 3 also on wide patches of thin layers.
        """
        axis = 2 * self.strip / np.asarray(width, dtype=np.float64)
        return np.asarray(np.log(30 / tolerance) / np.arcsinh(axis) + 2.0)

    def _sum(self, x: ArrayLike, weights: FloatArray | ComplexArray, imaginary: bool) -> FloatArray:
        """Re or Im of sum_m weights_m exp(i m x)."""
        position = np.asarray(x, dtype=np.float64)
        flat = position.ravel()
        total = np.zeros(flat.size)
        block = max(1, _BLOCK // max(1, self.terms))
        for first in range(0, flat.size, block):
            part = slice(first, first + block)
            value = _powers(np.exp(1j * flat[part]), self.terms) @ weights
            total[part] = value.imag if imaginary else value.real
        return total.reshape(position.shape)


def layer_kernel(thickness: float, poisson_ratio: float, tolerance: float) -> LayerKernel:
    """The smooth addition of a layer to the half-space kernel, its series cut at `tolerance`.

    Parameters
    ----------
    thickness : float
        q0 d, dimensionless.
    poisson_ratio : float
        nu in (-1, 0.5].
    tolerance : float
        Bound of the sum of the terms left out, in (0, 1).

    Raises
    ------
    ValueError
        `tolerance` outside (0, 1).

    Examples
    --------
    >>> kernel = layer_kernel(2 * np.pi * 0.02, 0.5, 1e-12)
    >>> kernel.terms, kernel.truncation < 1e-12
    (124, True)
    """
    if not 0 < tolerance < 1:
        raise ValueError(f"tolerance: {tolerance} must lie between 0 and 1")
    reach = 30 - 1.2 * np.log(tolerance) + np.log1p(1 / thickness)  # y at which terms are below any bound
    orders = np.arange(1, int(np.ceil(reach / (2 * thickness))) + 1)
    weights = compliance_deficit(orders * thickness, poisson_ratio) / orders
    left_out = np.append(np.cumsum(weights[::-1])[::-1], 0.0)  # if cut before term m = 1, 2, ...
    terms = int(np.argmax(left_out <= tolerance))
    return LayerKernel(thickness, poisson_ratio, weights[:terms], float(left_out[terms]))


def _powers(base: ComplexArray, count: int) -> ComplexArray:
    """base^1 .. base^count along a new last axis, (n, count), by doubling."""
    powers = np.empty((base.size, count), dtype=np.complex128)
    if count == 0:
        return powers
    powers[:, 0] = base
    done = 1
    while done < count:
        more = min(done, count - done)
        np.multiply(powers[:, :more], powers[:, done - 1, None], out=powers[:, done : done + more])
        done += more
    return powers
