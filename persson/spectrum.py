"""The roughness of a profile as lines of a spectrum, and the slope variance that they accumulate.

A profile h = sum_m h_m cos(q_m x + phi_m) has lines of slope variance dS_m = q_m^2 h_m^2 / 2; the theory sees it
through S_m = dS_1 + .. + dS_m, the variance of the slope when wavenumbers up to q_m are resolved.  In full contact
the stress has the variance V E*^2 with V = S / 4.  The two-sided power spectrum of a line of a profile of period
2 pi / q0 is C = h_m^2 / (4 q0), so that int C dq = <h^2>.  SI units.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class DiscreteSpectrum:
    """Lines of a periodic profile.

    Parameters
    ----------
    wavenumbers : (n_lines,) array
        q_m in rad/m, increasing and > 0.
    amplitudes : (n_lines,) array
        h_m in m, >= 0, not all zero.

    Raises
    ------
    ValueError
        Naming the argument and what is allowed.

    Examples
    --------
    >>> lines = DiscreteSpectrum([1.0, 2.0], [1.0, 0.5])
    >>> round(lines.h_rms**2, 12), round(lines.slope_rms**2, 12)
    (0.625, 1.0)
    """

    wavenumbers: FloatArray
    amplitudes: FloatArray

    def __init__(self, wavenumbers: ArrayLike, amplitudes: ArrayLike) -> None:
        q = np.asarray(wavenumbers, dtype=np.float64)
        h = np.asarray(amplitudes, dtype=np.float64)
        if q.ndim != 1 or q.size == 0 or not np.all(np.isfinite(q)) or np.any(q <= 0) or np.any(np.diff(q) <= 0):
            raise ValueError("wavenumbers: finite, > 0, strictly increasing values are needed (rad/m)")
        if h.shape != q.shape or not np.all(np.isfinite(h)) or np.any(h < 0):
            raise ValueError(f"amplitudes: {q.size} finite values >= 0 are needed (m)")
        if not np.any(h):
            raise ValueError("amplitudes: all zero; a flat surface has no roughness to resolve")
        object.__setattr__(self, "wavenumbers", q)
        object.__setattr__(self, "amplitudes", h)

    @property
    def slope_variance_steps(self) -> FloatArray:
        """dS_m, (n_lines,)."""
        return np.asarray((self.wavenumbers * self.amplitudes) ** 2 / 2)

    @property
    def slope_variance(self) -> FloatArray:
        """S_m, (n_lines,)."""
        return np.cumsum(self.slope_variance_steps)

    @property
    def h_rms(self) -> float:
        """Root mean square height, m."""
        return float(np.sqrt(np.sum(self.amplitudes**2) / 2))

    @property
    def slope_rms(self) -> float:
        """Root mean square slope."""
        return float(np.sqrt(self.slope_variance[-1]))

    def power(self, period_wavenumber: float) -> FloatArray:
        """Two-sided C(q_m) = h_m^2 / (4 q0) in m^3, (n_lines,), for the period 2 pi / q0."""
        return np.asarray(self.amplitudes**2 / (4 * period_wavenumber))
