"""Roughness of a profile: lines of a periodic profile, or a continuous power spectrum; never one for the other.

The theory sees a profile through the slope variance that has been resolved once wavenumbers up to q are seen, S(q).
In full contact the stress has the variance V E*^2, V = S / 4.

Lines:       h = sum_m h_m cos(q_m x + phi_m),  dS_m = q_m^2 h_m^2 / 2,  S_m = dS_1 + .. + dS_m; q = q_m while S runs
             from S_{m-1} to S_m (narrow-band rule).  Two-sided power of a line of a profile of period 2 pi / q0:
             C = h_m^2 / (4 q0), so that int C dq = <h^2>.
Continuous:  S(q) = 2 int q^2 C dq with the two-sided C a power law between the points of a table.

Both offer `weighted_integral`, the integral int f(S) / q(S) dS that energies and separations are made of.

Source: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.  SI units.  Limits:
roughness in one direction.  State which normalisation a number has: for the paper's profile a continuous spectrum with
the density of the lines, C = h_1^2 / (4 q0) at q0, has 0.3 % more contact than the lines; with the rms height of the
lines it has 1.39 times their slope and 28 % less contact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import exprel

from persson.mathematics.arrays import FloatArray, IntArray

ArrayFunction = Callable[[FloatArray], FloatArray]

PANEL_RATIO = 1.25  # growth of S from panel to panel of the quadrature
PANEL_FLOOR = 1e-6  # of S: below, one panel; the integrands are smooth there
GAUSS_POINTS = 12
TABLE_DENSITY = 20  # points to a decade of a self-affine table
SHARES = 1000  # bands of a continuous spectrum, equal in ln q


class PeriodicProfile(Protocol):
    """Profile h = sum_m h_m cos(2 pi m x / period + phi_m), such as a measured one, as the theory reads it."""

    @property
    def period(self) -> float:
        """Period in m."""

    @property
    def orders(self) -> IntArray:
        """Distinct m >= 1, (n_lines,)."""

    @property
    def amplitudes(self) -> FloatArray:
        """h_m in m, of either sign, (n_lines,)."""


@dataclass(frozen=True, eq=False)
class DiscreteSpectrum:
    """Lines of a periodic profile.

    Parameters
    ----------
    wavenumbers : (n_lines,) array
        q_m in rad/m, strictly increasing and > 0.
    amplitudes : (n_lines,) array
        h_m in m, >= 0, not all zero.

    Raises
    ------
    ValueError
        Naming the argument, the value and what is allowed.

    Examples
    --------
    >>> lines = DiscreteSpectrum([1.0, 2.0], [1.0, 0.5])
    >>> round(lines.h_rms**2, 12), round(lines.slope_rms**2, 12)
    (0.625, 1.0)
    """

    wavenumbers: FloatArray
    amplitudes: FloatArray

    def __init__(self, wavenumbers: ArrayLike, amplitudes: ArrayLike) -> None:
        q = _wavenumbers(wavenumbers, least=1)
        h = _values("amplitudes", amplitudes, q.size, "m")
        if not np.any((q * h) ** 2 > 0):
            raise ValueError(f"amplitudes: {h.tolist()[:3]} is zero roughness; at least one must be > 0 (m)")
        object.__setattr__(self, "wavenumbers", q)
        object.__setattr__(self, "amplitudes", h)

    @classmethod
    def self_affine(cls, first_wavenumber: float, hurst: float, h_rms: float, n_lines: int) -> DiscreteSpectrum:
        """Return lines m q0, m = 1..n_lines, with h_m proportional to m^-(H + 1/2) and a given rms height.

        Examples
        --------
        >>> lines = DiscreteSpectrum.self_affine(1.0, 0.7, 1e-3, 100)
        >>> round(lines.h_rms, 9), round(float(lines.amplitudes[0] / lines.amplitudes[1]), 9)
        (0.001, 2.29739671)
        """
        _positive("first_wavenumber", first_wavenumber, "rad/m")
        _hurst(hurst)
        _positive("h_rms", h_rms, "m")
        if n_lines < 1:
            raise ValueError(f"n_lines: {n_lines} must be >= 1")
        order = np.arange(1, n_lines + 1, dtype=np.float64)
        shape = order ** -(hurst + 0.5)
        return cls(first_wavenumber * order, shape * h_rms * np.sqrt(2 / np.sum(shape**2)))

    @classmethod
    def of_profile(cls, profile: PeriodicProfile) -> DiscreteSpectrum:
        """Return the lines of a profile: wavenumbers 2 pi m / period of its orders m, in ascending order.

        Examples
        --------
        >>> from types import SimpleNamespace
        >>> wave = SimpleNamespace(period=0.5, orders=np.array([3, 1]), amplitudes=np.array([1e-6, -2e-6]))
        >>> lines = DiscreteSpectrum.of_profile(wave)
        >>> lines.wavenumbers.round(3).tolist(), lines.amplitudes.tolist()
        ([12.566, 37.699], [2e-06, 1e-06])
        """
        ascending = np.argsort(profile.orders)
        wavenumbers = 2 * np.pi / profile.period * np.asarray(profile.orders)[ascending]
        return cls(wavenumbers, np.abs(np.asarray(profile.amplitudes)[ascending]))

    @property
    def slope_variance_steps(self) -> FloatArray:
        """dS_m, (n_lines,)."""
        return np.asarray((self.wavenumbers * self.amplitudes) ** 2 / 2)

    @property
    def slope_variance(self) -> FloatArray:
        """S_m, (n_lines,)."""
        return np.cumsum(self.slope_variance_steps)

    @property
    def total_slope_variance(self) -> float:
        """S with everything resolved."""
        return float(self.slope_variance[-1])

    @property
    def h_rms(self) -> float:
        """Root mean square height, m."""
        return float(np.sqrt(np.sum(self.amplitudes**2) / 2))

    @property
    def slope_rms(self) -> float:
        """Root mean square slope."""
        return float(np.sqrt(self.total_slope_variance))

    @property
    def full_contact_energy(self) -> float:
        """Elastic energy of full contact over E*, sum q h^2 / 8, m."""
        return float(np.sum(self.wavenumbers * self.amplitudes**2) / 8)

    @property
    def n_carriers(self) -> int:
        """Number of lines that carry roughness."""
        return int(np.count_nonzero(self.slope_variance_steps))

    def power(self, period_wavenumber: float) -> FloatArray:
        """Return the two-sided C(q_m) = h_m^2 / (4 q0) in m^3, (n_lines,), for the period 2 pi / q0."""
        _positive("period_wavenumber", period_wavenumber, "rad/m")
        return np.asarray(self.amplitudes**2 / (4 * period_wavenumber))

    def resolved_variance(self, wavenumber: float) -> float:
        """Return S of the roughness up to and including a wavenumber (rad/m)."""
        _positive("wavenumber", wavenumber, "rad/m")
        return float(np.sum(self.slope_variance_steps[self.wavenumbers <= wavenumber * (1 + 1e-12)]))

    def weighted_integral(self, antiderivative: ArrayFunction, density: ArrayFunction, ends: FloatArray) -> FloatArray:
        """Return int_0^S f / q dS up to each S of ends, (n,), in m times f; exact, from F with F' = f and F(0) = 0."""
        bands = np.concatenate([[0.0], self.slope_variance])
        at_bands = antiderivative(bands)
        full = np.concatenate([[0.0], np.cumsum(np.diff(at_bands) / self.wavenumbers)])
        line = np.clip(np.searchsorted(bands, ends, side="left") - 1, 0, self.wavenumbers.size - 1)
        return np.asarray(full[line] + (antiderivative(ends) - at_bands[line]) / self.wavenumbers[line])


@dataclass(frozen=True, eq=False)
class ContinuousSpectrum:
    """A two-sided power spectrum, a power law between the points of a table.

    Parameters
    ----------
    wavenumbers : (n_points,) array
        q in rad/m, strictly increasing and > 0, at least two; there is no roughness outside.
    power : (n_points,) array
        Two-sided C(q) in m^3, > 0.

    Raises
    ------
    ValueError
        Naming the argument, the value and what is allowed.

    Examples
    --------
    >>> flat = ContinuousSpectrum([1.0, 2.0], [0.5, 0.5])
    >>> round(flat.h_rms**2, 12), round(flat.slope_rms**2, 12)
    (1.0, 2.333333333333)
    """

    wavenumbers: FloatArray
    power: FloatArray

    def __init__(self, wavenumbers: ArrayLike, power: ArrayLike) -> None:
        q = _wavenumbers(wavenumbers, least=2)
        c = _values("power", power, q.size, "m^3")
        if not np.all(c > 0):
            at = int(np.argmin(c))
            raise ValueError(f"power[{at}]: {c[at]} must be > 0 (m^3); end the spectrum where it ends")
        object.__setattr__(self, "wavenumbers", q)
        object.__setattr__(self, "power", c)

    @classmethod
    def self_affine(cls, lowest: float, highest: float, hurst: float, h_rms: float) -> ContinuousSpectrum:
        """Return C proportional to q^-(1 + 2 H) between two wavenumbers, with a given rms height.

        Exact at and between the points of its table, TABLE_DENSITY to a decade.

        Examples
        --------
        >>> round(ContinuousSpectrum.self_affine(1.0, 1000.0, 0.7, 1e-3).h_rms, 9)
        0.001
        """
        _positive("lowest", lowest, "rad/m")
        if not (np.isfinite(highest) and highest > lowest):
            raise ValueError(f"highest: {highest} must be finite and > lowest = {lowest} (rad/m)")
        _hurst(hurst)
        _positive("h_rms", h_rms, "m")
        count = int(np.ceil(TABLE_DENSITY * np.log10(highest / lowest))) + 1
        q = np.geomspace(lowest, highest, max(count, 2))
        unscaled = cls(q, lowest**-3.0 * (q / lowest) ** -(1 + 2 * hurst))
        return cls(unscaled.wavenumbers, unscaled.power * (h_rms / unscaled.h_rms) ** 2)

    @property
    def h_rms(self) -> float:
        """Root mean square height, m."""
        return float(np.sqrt(np.sum(self._segment_moments(0))))

    @property
    def slope_variance(self) -> FloatArray:
        """S at the wavenumbers of the table, (n_points,)."""
        return np.concatenate([[0.0], np.cumsum(self._segment_moments(2))])

    @property
    def total_slope_variance(self) -> float:
        """S with everything resolved."""
        return float(self.slope_variance[-1])

    @property
    def slope_rms(self) -> float:
        """Root mean square slope."""
        return float(np.sqrt(self.total_slope_variance))

    @property
    def full_contact_energy(self) -> float:
        """Elastic energy of full contact over E*, int q C dq / 2 over q > 0, m."""
        return float(np.sum(self._segment_moments(1)) / 4)

    def power_at(self, wavenumber: ArrayLike) -> FloatArray:
        """Return the two-sided C(q) in m^3; zero outside the table."""
        q = np.asarray(wavenumber, dtype=np.float64)
        inside = (q >= self.wavenumbers[0]) & (q <= self.wavenumbers[-1])
        logarithm = np.interp(np.log(q), np.log(self.wavenumbers), np.log(self.power))
        return np.where(inside, np.exp(logarithm), 0.0)

    def resolved_variance(self, wavenumber: float) -> float:
        """Return S of the roughness up to a wavenumber (rad/m)."""
        _positive("wavenumber", wavenumber, "rad/m")
        q = float(np.clip(wavenumber, self.wavenumbers[0], self.wavenumbers[-1]))
        segment = min(int(np.searchsorted(self.wavenumbers, q, side="right")) - 1, self.wavenumbers.size - 2)
        ratio = np.log(q / self.wavenumbers[segment])
        growth = self._exponents()[segment] + 3
        scale = 2 * self.power[segment] * self.wavenumbers[segment] ** 3
        return float(self.slope_variance[segment] + scale * ratio * exprel(growth * ratio))

    def wavenumber_at(self, slope_variance: FloatArray) -> FloatArray:
        """Return q(S), the inverse of S(q), in rad/m; (n,) for S in [0, S_total]."""
        bands = self.slope_variance
        segment = np.clip(np.searchsorted(bands, slope_variance, side="right") - 1, 0, bands.size - 2)
        growth = (self._exponents() + 3)[segment]
        scaled = (slope_variance - bands[segment]) / (2 * self.power * self.wavenumbers**3)[segment]
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(np.abs(growth) < 1e-9, scaled, np.log1p(growth * scaled) / growth)
        return np.asarray(self.wavenumbers[segment] * np.exp(ratio))

    def weighted_integral(self, antiderivative: ArrayFunction, density: ArrayFunction, ends: FloatArray) -> FloatArray:
        """Return int_0^S f / q dS up to each S of ends, (n,), in m times f, by Gauss panels that grow with S."""
        bands, total = self.slope_variance, float(np.max(ends))
        count = int(np.ceil(np.log(1 / PANEL_FLOOR) / np.log(PANEL_RATIO)))
        growing = total * np.geomspace(PANEL_FLOOR, 1.0, count)
        cuts = np.unique(np.concatenate([[0.0], growing[growing < total], bands[bands < total], ends]))
        point, weight = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        half, centre = np.diff(cuts) / 2, (cuts[1:] + cuts[:-1]) / 2
        s = centre[:, None] + half[:, None] * point
        panels = half * ((density(s) / self.wavenumber_at(s.ravel()).reshape(s.shape)) @ weight)
        return np.asarray(np.concatenate([[0.0], np.cumsum(panels)])[np.searchsorted(cuts, ends)])

    def _exponents(self) -> FloatArray:
        return np.asarray(np.diff(np.log(self.power)) / np.diff(np.log(self.wavenumbers)))

    def _segment_moments(self, power: int) -> FloatArray:
        """Return 2 int q^power C dq over each segment, (n_points - 1,)."""
        ratio = np.diff(np.log(self.wavenumbers))
        scale = 2 * self.power[:-1] * self.wavenumbers[:-1] ** (power + 1)
        return np.asarray(scale * ratio * exprel((self._exponents() + power + 1) * ratio))


Spectrum = DiscreteSpectrum | ContinuousSpectrum


def slope_shares(spectrum: Spectrum) -> tuple[FloatArray, FloatArray]:
    """Return wavenumbers in rad/m and their shares of the slope variance, (n,) each: lines, or bands of a continuum.

    Examples
    --------
    >>> slope_shares(DiscreteSpectrum([1.0, 2.0], [1.0, 0.5]))[1].tolist()
    [0.5, 0.5]
    """
    if isinstance(spectrum, DiscreteSpectrum):
        steps = spectrum.slope_variance_steps
        return spectrum.wavenumbers, steps / steps.sum()
    edges = np.geomspace(spectrum.wavenumbers[0], spectrum.wavenumbers[-1], SHARES + 1)
    steps = np.diff([spectrum.resolved_variance(float(edge)) for edge in edges])
    return np.sqrt(edges[1:] * edges[:-1]), steps / steps.sum()


def bandwidth_of(spectrum: Spectrum) -> float:
    """Return exp(<ln q>_slope - <ln q>_height), means weighted by slope and by height variance; 1 for one line.

    Examples
    --------
    >>> round(bandwidth_of(DiscreteSpectrum([1.0, 4.0], [0.4, 0.1])), 3)
    1.843
    """
    wavenumbers, slope = slope_shares(spectrum)
    height = slope / wavenumbers**2
    logarithm = np.log(wavenumbers)
    return float(np.exp(logarithm @ slope - (logarithm @ height) / height.sum()))


def _wavenumbers(values: ArrayLike, least: int) -> FloatArray:
    q = np.array(values, dtype=np.float64)
    if q.ndim != 1 or q.size < least:
        raise ValueError(f"wavenumbers: shape {q.shape}; a list of at least {least} values is needed (rad/m)")
    bad = ~(np.isfinite(q) & (q > 0))
    if np.any(bad):
        at = int(np.argmax(bad))
        raise ValueError(f"wavenumbers[{at}]: {q[at]} must be finite and > 0 (rad/m)")
    steps = np.diff(q)
    if np.any(steps <= 0):
        at = int(np.argmax(steps <= 0)) + 1
        kind = "a duplicate" if steps[at - 1] == 0 else "unsorted"
        raise ValueError(f"wavenumbers[{at}]: {q[at]} is {kind}; values must increase strictly (rad/m)")
    return q


def _values(name: str, values: ArrayLike, size: int, unit: str) -> FloatArray:
    array = np.array(values, dtype=np.float64)
    if array.shape != (size,):
        raise ValueError(f"{name}: shape {array.shape}, but there are {size} wavenumbers; equal lengths are needed")
    bad = ~(np.isfinite(array) & (array >= 0))
    if np.any(bad):
        at = int(np.argmax(bad))
        raise ValueError(f"{name}[{at}]: {array[at]} must be finite and >= 0 ({unit})")
    return array


def _positive(name: str, value: float, unit: str) -> None:
    if not (np.isfinite(value) and value > 0):
        raise ValueError(f"{name}: {value} must be finite and > 0 ({unit})")


def _hurst(value: float) -> None:
    if not 0 < value < 1:
        raise ValueError(f"hurst: {value} must lie in (0, 1)")
