"""Periodic rough profile h(x) = sum_m h_m cos(m q0 x + phi_m), q0 = 2 pi / period, and its derivatives.

Values at arbitrary points come from a Taylor table: the profile and its derivatives are sampled by FFT on
a grid of at least 16 points per shortest wavelength, and the 14-term expansion about the nearest grid point
is exact to rounding (truncation below 1e-15 of the amplitude for h, 1e-14 for h'' in its own scale).  The
cost per point then does not depend on the number of harmonics.

Heights and positions may be in any unit; `Profile.scaled` gives the dimensionless profile of the solver.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bem.geometry.arrays import FloatArray, IntArray
from bem.geometry.ranges import check, check_harmonics
from bem.kernels.heights import taylor

EQUAL_STEPS = 1e-3  # format: of a step: admitted deviation of a position from equal steps
EQUAL_HEIGHTS = 1e-12  # derived: of the rms height: crests as high as each other, to rounding
POINTS_PER_WAVELENGTH = 16  # derived: of the table of heights: with `_TAYLOR_TERMS` its truncation is 1e-15 of h
_TAYLOR_TERMS = 14  # derived: terms about a point of the table
_BISECTIONS = 55  # derived: of a crest between its neighbours on the grid: also flat crests, where Newton is slow


@dataclass(frozen=True, eq=False, repr=False)
class Profile:
    """Zero-mean periodic profile given by its harmonics.

    Parameters
    ----------
    period : float
        Wavelength of the periodic cell, in m (or any unit of length).
    orders : (n_harmonics,) int array
        Distinct harmonic orders m >= 1.
    amplitudes, phases : (n_harmonics,) float arrays
        h_m in m (or any unit of height) and phi_m in radians.

    Raises
    ------
    ValueError
        Values that a scene refuses too, with the message of a scene (ranges.py).

    Examples
    --------
    >>> wave = Profile(1.0, np.array([1]), np.array([2.0]), np.array([0.0]))
    >>> float(round(wave.height(0.25), 12)), wave.max_height
    (0.0, 2.0)
    """

    period: float
    orders: IntArray
    amplitudes: FloatArray
    phases: FloatArray

    def __post_init__(self) -> None:
        check(profile__period=self.period)
        check_harmonics(self.orders, self.amplitudes, self.phases)

    def __repr__(self) -> str:
        count = self.orders.size
        known = f"rms height {self.rms_height:.6g}, rms slope {self.rms_slope:.6g}"
        return f"<Profile of {count} harmonic{'s' * (count != 1)} in a period of {self.period:g}, {known}>"

    @classmethod
    def from_harmonics(
        cls, period: float, orders: ArrayLike, amplitudes: ArrayLike, phases: ArrayLike | None = None
    ) -> Profile:
        """Return the profile of lists of orders, amplitudes and phases (default 0)."""
        h = np.asarray(amplitudes)
        phi = np.zeros(h.shape) if phases is None else np.asarray(phases)
        check_harmonics(orders, h, phi)
        m = np.asarray(orders, dtype=np.int64)
        return cls(float(period), m, h.astype(np.float64), phi.astype(np.float64))

    @classmethod
    def self_affine(cls, period: float, hurst: float, rms_height: float, harmonics: int, seed: int) -> Profile:
        """Return a self-affine profile, h_m ~ m^-(hurst + 1/2), orders 1..harmonics, uniform random phases.

        Parameters
        ----------
        period, rms_height : float
            In m; sum_m h_m^2 / 2 = rms_height^2.
        hurst : float
            Hurst exponent in (0, 1).
        harmonics, seed : int
            Number of harmonics; phases are `default_rng(seed).uniform(-pi, pi, harmonics)`.
        """
        check(profile__period=period, profile__hurst=hurst, profile__rms_height=rms_height)
        check(profile__harmonics=harmonics, profile__seed=seed)
        m = np.arange(1, harmonics + 1)
        h: FloatArray = np.asarray(m ** -(hurst + 0.5), dtype=np.float64)
        h *= rms_height / np.sqrt(np.sum(h**2) / 2)
        return cls(float(period), m, h, np.random.default_rng(seed).uniform(-np.pi, np.pi, harmonics))

    @classmethod
    def from_samples(
        cls, x: ArrayLike, h: ArrayLike, harmonics: int, detrend: str = "mean", period: float | None = None
    ) -> Profile:
        """Return the Fourier sum through samples at equal steps, up to the order `harmonics`.

        Parameters
        ----------
        x, h : (n,) array
            Positions that rise by equal steps, to a thousandth of a step (end point of the period excluded), and
            heights, in m.
        harmonics : int
            Highest order kept, below n/2.
        detrend : {"mean", "line"}
            Mean or least-squares line, subtracted first.
        period : float, optional
            Replaces n times the sample distance.

        Raises
        ------
        ValueError
            Steps that are unequal or fall; heights that are masked, not finite, or of another number; another trend.
        TypeError
            Complex numbers.
        """
        arrays = (np.ma.asarray(values).astype(np.float64, casting="same_kind") for values in (x, h))
        position, height = (np.asarray(np.ma.filled(array, np.nan)) for array in arrays)
        if position.ndim != 1 or position.shape != height.shape:
            raise ValueError(f"x, h: of shapes {position.shape} and {height.shape}; allowed: two arrays of one length")
        if detrend not in ("mean", "line"):
            raise ValueError(f'detrend: {detrend!r}; allowed: "mean" or "line" (bem.solve knows more)')
        n = position.size
        equal = n > 1 and position[-1] > position[0] and float(off_equal_steps(position).max()) <= EQUAL_STEPS
        if not equal or not np.all(np.isfinite(height)):
            fault = "missing heights" if equal else "unequal or falling steps"
            prepared = 'profile={"kind": "samples", "x": x, "h": h} of bem.solve prepares them'
            raise ValueError(f"samples with {fault}; allowed: finite heights at equal steps ({prepared})")
        if not 1 <= harmonics <= (n - 1) // 2:
            raise ValueError(f"harmonics: {harmonics} must lie in 1..{(n - 1) // 2} for {n} samples")
        if detrend == "line":
            height = height - np.polyval(np.polyfit(position - position[0], height, 1), position - position[0])
        spectrum = np.fft.rfft(height)[1 : harmonics + 1] * (2 / n)
        length = (position[-1] - position[0]) * n / (n - 1) if period is None else period
        m = np.arange(1, harmonics + 1)
        shift = 2 * np.pi * m * position[0] / length
        return cls(float(length), m, np.abs(spectrum), np.angle(spectrum) - shift)

    @property
    def q0(self) -> float:
        """Fundamental wavenumber 2 pi / period."""
        return 2 * np.pi / self.period

    @cached_property
    def max_order(self) -> int:
        """Highest harmonic order."""
        return int(self.orders.max())

    @property
    def rms_height(self) -> float:
        """Root mean square height, sqrt(sum h_m^2 / 2)."""
        return float(np.sqrt(np.sum(self.amplitudes**2) / 2))

    @cached_property
    def rms_slope(self) -> float:
        """Root mean square slope (unit of height per unit of length)."""
        return float(np.sqrt(np.sum((self.q0 * self.orders * self.amplitudes) ** 2) / 2))

    @cached_property
    def rms_curvature(self) -> float:
        """Root mean square curvature (unit of height per square of the unit of length)."""
        return float(np.sqrt(np.sum(((self.q0 * self.orders) ** 2 * self.amplitudes) ** 2) / 2))

    @property
    def is_flat(self) -> bool:
        """True if every amplitude is zero."""
        return not np.any(self.amplitudes)

    @cached_property
    def max_height(self) -> float:
        """Height of the highest crest."""
        return float(self.crests[1].max())

    def scaled(self) -> Profile:
        """Return the profile scaled to period 2 pi and unit rms height; ValueError if flat."""
        if self.is_flat:
            raise ValueError("amplitudes: all zero; a flat profile has no height scale")
        return Profile(2 * np.pi, self.orders, self.amplitudes / self.rms_height, self.phases)

    def height(self, x: ArrayLike) -> FloatArray:
        """Return h(x), shape of x."""
        values: FloatArray = self._expand(x, 0)[0]
        return values

    def slope(self, x: ArrayLike) -> FloatArray:
        """Return h'(x), shape of x."""
        values: FloatArray = self._expand(x, 1)[1]
        return values

    def curvature(self, x: ArrayLike) -> FloatArray:
        """Return h''(x), shape of x."""
        values: FloatArray = self._expand(x, 2)[2]
        return values

    def height_slope_curvature(self, x: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return h, h' and h'' at once, each of the shape of x."""
        values = self._expand(x, 2)
        return values[0], values[1], values[2]

    def derivatives(self, x: ArrayLike) -> FloatArray:
        """Return the height and its first three derivatives at once, (4, ...)."""
        return self._expand(x, 3)

    @cached_property
    def grid(self) -> tuple[FloatArray, FloatArray]:
        """Positions and heights of the table, (n_grid,) each: at least 16 points per shortest wavelength."""
        n = self.table.shape[0]
        return np.arange(n) * (self.period / n), np.ascontiguousarray(self.table[:, 0])

    @cached_property
    def crests(self) -> tuple[FloatArray, FloatArray]:
        """Positions in [0, period), ascending, and heights of all local maxima, (n_crests,) each."""
        return self._extrema(1.0)

    @cached_property
    def has_equal_parts(self) -> bool:
        """True if the period repeats, or is its own mirror image, to rounding: patches then have equal partners."""
        felt = np.abs(self.amplitudes) > EQUAL_HEIGHTS * self.rms_height
        orders, phases = self.orders[felt], self.phases[felt]
        if np.gcd.reduce(orders) > 1:
            return True
        least = EQUAL_HEIGHTS * self.rms_height / np.abs(self.amplitudes[felt])
        centres = (np.pi * np.arange(2 * orders[0]) - phases[0]) / orders[0]  # of the mirror, times q0
        for order, phase, share in zip(orders, phases, least, strict=True):
            centres = centres[np.abs(np.sin(order * centres + phase)) <= share + 16 * order * np.finfo(float).eps]
            if centres.size == 0:
                return False
        return True

    @property
    def highest_crests(self) -> FloatArray:
        """Positions of the highest crests, ascending; more than one where they are equally high, to rounding."""
        positions, heights = self.crests
        return np.asarray(positions[heights >= heights.max() - EQUAL_HEIGHTS])

    @cached_property
    def valleys(self) -> tuple[FloatArray, FloatArray]:
        """Positions in [0, period), ascending, and heights of all local minima, (n_valleys,) each."""
        return self._extrema(-1.0)

    def _extrema(self, sign: float) -> tuple[FloatArray, FloatArray]:
        """Return the positions of the local maxima of sign times the height, and the heights at these positions."""
        if self.is_flat:
            return np.zeros(1), np.zeros(1)
        x, h = self.grid
        top = np.flatnonzero((sign * h >= sign * np.roll(h, 1)) & (sign * h > sign * np.roll(h, -1)))
        spacing = self.period / x.size
        rising, falling = x[top] - spacing, x[top] + spacing
        for _ in range(_BISECTIONS):
            position = (rising + falling) / 2
            up = sign * self.slope(position) > 0
            rising, falling = np.where(up, position, rising), np.where(up, falling, position)
        position = (rising + falling) / 2
        place = position % self.period
        place = np.where(place < self.period, place, 0.0)
        order = np.argsort(place)
        return place[order], self.height(position)[order]

    @cached_property
    def table(self) -> FloatArray:
        """Taylor coefficients h^(k)(x_j) delta^k / k! on the grid, (n_grid, n_terms)."""
        n = max(64, 1 << int(np.ceil(np.log2(POINTS_PER_WAVELENGTH * self.max_order))))
        spectrum: NDArray[np.complex128] = np.zeros(n // 2 + 1, dtype=np.complex128)
        spectrum[self.orders] = self.amplitudes * np.exp(1j * self.phases) * (n / 2)
        factor = 1j * np.arange(n // 2 + 1) * (2 * np.pi / n)
        table = np.empty((n, _TAYLOR_TERMS))
        for k in range(_TAYLOR_TERMS):
            table[:, k] = np.fft.irfft(spectrum, n)
            spectrum *= factor / (k + 1)
        return table

    def _expand(self, x: ArrayLike, derivatives: int) -> FloatArray:
        """Return h, h', ... up to the given derivative, (derivatives + 1, ...)."""
        position = np.asarray(x, dtype=np.float64, order="C")
        values = taylor(self.table, position.ravel(), self.table.shape[0] / self.period, derivatives)
        return values.reshape(derivatives + 1, *position.shape)


def off_equal_steps(x: FloatArray) -> FloatArray:
    """Return the deviations of increasing positions from equal steps between their ends, in steps.

    Examples
    --------
    >>> off_equal_steps(np.array([0.0, 1.25, 2.0, 3.0])).tolist()
    [0.0, 0.25, 0.0, 0.0]
    """
    step = (x[-1] - x[0]) / (x.size - 1)
    return np.asarray(np.abs((x - x[0]) / step - np.arange(x.size)))
