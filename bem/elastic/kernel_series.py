"""Cosine series that elastic effects add to the kernel of the half-space.

An effect gives mode m the compliance ratio_m / m instead of 1/m, so that

    -sum_m ratio_m cos(m x) / m = log|2 sin(x/2)| + S(x),   S(x) = sum_m s_m cos(m x),   s_m = (1 - ratio_m) / m.

1 - ratio_m decays like exp(-strip m), the strip being where S is analytic about the real axis: ln(1/tolerance) / strip
terms are needed.  Dimensionless.  Limits: effects that decay as a power
of m, a surface tension say, are no such series.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from bem.elastic.skeleton import Coupling, LeftOut, Waves
from bem.elastic.wave_modes import patch_waves
from bem.geometry.arrays import ComplexArray, FloatArray, IntArray
from bem.geometry.chebyshev import profile_nodes
from bem.geometry.patches import Patches
from bem.geometry.profile import Profile

FEW_MODES = 120  # speed: of the kernel, in patches that are not worth while projecting
_BLOCK = 2_000_000  # speed: complex numbers held at a time


class ElasticEffect(Protocol):
    """Effect that changes the compliance of a half-space, by modes m >= 1 of the period."""

    @property
    def strip(self) -> float:
        """Decay rate: 1 - ratio_m decays as exp(-strip m), but for powers of m."""
        ...

    @property
    def relative_effect(self) -> float:
        """Largest |1 - ratio_m|."""
        ...

    @property
    def mean_compliance(self) -> float | None:
        """c(0), mean displacement of the face per mean pressure, m/Pa; None if another effect has it."""
        ...

    def ratio(self, orders: ArrayLike) -> FloatArray:
        """Return the compliance relative to the half-space, shape of `orders`, positive."""
        ...

    def deficit(self, orders: ArrayLike) -> FloatArray:
        """Return 1 - ratio, to full relative accuracy also where it is tiny, shape of `orders`."""
        ...


@dataclass(frozen=True, eq=False)
class KernelSeries:
    """Series S(x) = sum_m s_m cos(m x) that an effect adds to log|2 sin(x/2)|.

    Modes beyond the last term have the compliance of the half-space.

    Parameters
    ----------
    effect : ElasticEffect
    weights : (n_terms,) array
        s_m, m = 1..n_terms.
    truncation : float
        Sum of the terms left out, at least.
    """

    effect: ElasticEffect
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

    def ratio(self, orders: ArrayLike) -> FloatArray:
        """Return the compliance of the modes m >= 1 relative to the half-space, shape of `orders`."""
        return self.effect.ratio(orders)

    @cached_property
    def _series(self) -> Profile:
        weights = np.append(self.weights, 0.0)  # one term at least
        return Profile(2 * np.pi, np.arange(1, weights.size + 1), weights, np.zeros(weights.size))

    def smooth(self, x: ArrayLike) -> FloatArray:
        """Return S(x), shape of x."""
        return self._series.height(x)

    def slope(self, x: ArrayLike) -> FloatArray:
        """Return S'(x), shape of x."""
        return self._series.slope(x)

    def curvature(self, x: ArrayLike) -> FloatArray:
        """Return S''(x), shape of x."""
        return self._series.curvature(x)

    @property
    def columns(self) -> int:
        """Number of the waves: a cosine and a sine each."""
        return 2 * self.terms

    def coupling(self, x: FloatArray, patches: Patches, modes: IntArray, tolerance: float, few: bool) -> Coupling:
        """Return the addition of S to the system of coupled modes with nodes x: as waves if few, or as a matrix.

        The matrix holds S between the nodes, but within a patch that has fewer modes than S its projection onto them;
        waves are projected on such patches.
        """
        matrix = None if few else self.smooth(np.subtract.outer(x, x))
        waves = _powers(np.exp(1j * x), self.terms).T if few else None
        wide, left_out = np.flatnonzero(modes < self.modes_of_kernel(patches.width, tolerance)), None
        if wide.size:
            left_out, ends = LeftOut(np.zeros((2, x.size)), np.zeros((2, patches.count))), np.cumsum(modes)
            for i in wide.tolist():
                own, size = slice(ends[i] - modes[i], ends[i]), max(1, _BLOCK // int(modes[i]))
                if matrix is not None:
                    matrix[own, own] = 0.0
                for few_orders in (slice(first, first + size) for first in range(0, self.terms, size)):
                    orders, weights = self.orders[few_orders], self.weights[few_orders]
                    within = patch_waves(float(patches.half_width[i]), orders, int(modes[i]))
                    field, felt = within.left_out(weights)
                    left_out.fields[:, own] += field
                    left_out.compliance[:, i] += felt
                    if matrix is not None:
                        matrix[own, own] += within.kernel(weights)
                    if waves is not None:
                        waves[few_orders, own] = np.exp(1j * orders * patches.center[i])[:, None] * within.at_nodes()
        return Coupling(matrix, None if waves is None else self._product(waves), left_out)

    def _product(self, waves: ComplexArray) -> Waves:
        """Return S as a product, from exp(i m x), (n_terms, n): sqrt(|s_m|) cos(m x), then sqrt(|s_m|) sin(m x)."""
        scaled = waves * np.sqrt(np.abs(self.weights))[:, None]
        return Waves(np.concatenate([scaled.real, scaled.imag]), np.tile(np.where(self.weights < 0, -1.0, 1.0), 2))

    def field(self, x: FloatArray, sources: FloatArray, charges: FloatArray) -> FloatArray:
        """Return sum_j S(x_i - source_j) charge_j, (n,)."""
        moments = np.empty(self.terms, dtype=np.complex128)
        for first in range(0, self.terms, 256):
            last = min(first + 256, self.terms)
            waves = _powers(np.exp(-1j * sources), last - first)
            moments[first:last] = (charges * np.exp(-1j * first * sources)) @ waves
        return self.from_moments(x, moments)

    def from_moments(self, x: ArrayLike, moments: ComplexArray) -> FloatArray:
        """Return int S(x - x') sigma(x') dx', shape of x, from moments int sigma exp(-i m x) dx, m = 1..n_terms."""
        weights, position = self.weights * moments[: self.terms], np.asarray(x, dtype=np.float64)
        flat = position.ravel()
        total = np.zeros(flat.size)
        block = max(1, _BLOCK // max(1, self.terms))
        for first in range(0, flat.size, block):
            part = slice(first, first + block)
            total[part] = (_powers(np.exp(1j * flat[part]), self.terms) @ weights).real
        return total.reshape(position.shape)

    def coupled_modes(self, width: FloatArray, tolerance: float, max_order: int) -> FloatArray:
        """Return the number of Chebyshev modes of patches of these widths that feel S to `tolerance`, (L,).

        The number suffices for the pressure from harmonics up to `max_order` and from edges, unless S has fewer modes.
        The nearest singularities of the pressure are the images of the edges, a strip away at right angles.
        """
        of_kernel = self.modes_of_kernel(width, tolerance)
        if np.all(of_kernel <= FEW_MODES):
            return of_kernel
        image = 1 + 2j * self.effect.strip / np.asarray(width, dtype=np.float64)
        of_edges = np.log(300 / tolerance) / np.arccosh(image).real + 2.0
        of_pressure = np.maximum(of_edges, profile_nodes(width, max_order))
        return np.where(of_kernel > FEW_MODES, np.minimum(of_pressure, of_kernel), of_kernel)

    def modes_of_kernel(self, width: FloatArray, tolerance: float) -> FloatArray:
        """Return the number of Chebyshev modes of S itself on patches of these widths, to `tolerance`, (L,).

        S(x - x') with both points in the patch is analytic in the Bernstein ellipse of semi-minor axis
        b = strip / r, r = width / 2, so its coefficients decay as rho^-n, rho = b + sqrt(1 + b^2).  The factor 1/300
        was measured on wide patches of thin layers, where pressures are large and heights are the sharper measure:
        with it u is within `tolerance` / 200 rms heights of the profile, with 1/30 within `tolerance` / 6.
        """
        axis = 2 * self.effect.strip / np.asarray(width, dtype=np.float64)
        return np.asarray(np.log(300 / tolerance) / np.arcsinh(axis) + 2.0)


def kernel_series(effect: ElasticEffect, tolerance: float) -> KernelSeries:
    """Return the series that an effect adds to the kernel of the half-space, cut at `tolerance`.

    Parameters
    ----------
    effect : ElasticEffect
    tolerance : float
        Bound of the sum of the terms left out, in (0, 1).

    Raises
    ------
    ValueError
        `tolerance` outside (0, 1); terms that decay more slowly than `effect.strip` says.
    """
    if not 0 < tolerance < 1:
        raise ValueError(f"tolerance: {tolerance} must lie between 0 and 1")
    reach = 30 - 1.2 * np.log(tolerance) + np.log1p(2 / effect.strip)  # strip m at which terms are below any bound
    orders = np.arange(1, int(np.ceil(reach / effect.strip)) + 1)
    weights = effect.deficit(orders) / orders
    if not abs(weights[-1]) * orders.size <= tolerance:
        raise ValueError(f"strip: {effect.strip}: decay is slower, {weights[-1]:g} is left at m = {orders.size}")
    left_out = np.append(np.cumsum(np.abs(weights)[::-1])[::-1], 0.0)  # if cut before term m = 1, 2, ...
    terms = int(np.argmax(left_out <= tolerance))
    return KernelSeries(effect, weights[:terms], float(left_out[terms]))


def _powers(base: ComplexArray, count: int) -> ComplexArray:
    """Return base^1 .. base^count along a new last axis, (n, count), by doubling."""
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
