"""Gaussian profile filters of ISO 16610-21: a cut by wavelength, at half of the amplitude.

A wave of wavelength lambda passes the short-wave filter of cut-off lambda_s, and the long-wave filter of lambda_c, as

    exp(-pi (alpha lambda_s / lambda)^2),   1 - exp(-pi (alpha lambda_c / lambda)^2),   alpha = sqrt(ln 2 / pi)

(ISO 16610-21:2011, 4.3 and 4.4), without a change of phase.  On a periodic line that is a factor of each mode, exact
and without ends; waves of one wavelength are cut alike in a line and in the same line mirrored.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from bem.geometry.arrays import FloatArray
from bem.geometry.ranges import Mistake


@dataclass(frozen=True)
class GaussianFilter:
    """Cut-off wavelengths lambda_s and lambda_c in m; at 0 and infinity all waves pass.

    Examples
    --------
    >>> GaussianFilter(short=2e-6).transmission([1 / 1e-6, 1 / 2e-6, 1 / 4e-6]).round(4).tolist()
    [0.0625, 0.5, 0.8409]
    >>> GaussianFilter(long=2e-6).transmission([1 / 1e-6, 1 / 2e-6, 1 / 4e-6]).round(4).tolist()
    [0.9375, 0.5, 0.1591]
    """

    short: float = 0.0
    long: float = math.inf

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> GaussianFilter:
        """Return the filter of the keys cutoff_short and cutoff_long of [profile], as far as they are given."""
        given = {name: values.get(f"cutoff_{name}") for name in ("short", "long")}
        return cls(**{name: float(value) for name, value in given.items() if value is not None})

    @property
    def cuts(self) -> dict[str, float]:
        """Finite cut-offs by their keys."""
        both = {"cutoff_short": self.short, "cutoff_long": self.long}
        return {key: value for key, value in both.items() if 0 < value < math.inf}

    def transmission(self, frequency: ArrayLike) -> FloatArray:
        """Return the amplitude passed over amplitude at frequencies 1 / lambda > 0 (1/m), of their shape."""
        f = np.asarray(frequency, dtype=np.float64)
        return np.exp2(-((self.short * f) ** 2)) * -np.expm1(-math.log(2) * (self.long * f) ** 2)

    def mistakes(self, spacing: float, length: float) -> Iterator[Mistake]:
        """Yield the mistakes of cut-offs for a line of a sample distance and a length (m)."""
        wrong = [key for key, value in self.cuts.items() if not 2 * spacing <= value <= length]
        for key in wrong:
            allowed = f"from two sample distances to the length measured, {2 * spacing:.6g} to {length:.6g} (m)"
            yield Mistake(f"profile.{key}", f"= {self.cuts[key]:g}", allowed)
        if not wrong and self.short >= self.long:
            yield Mistake(
                "profile.cutoff_short", f"= {self.short:g}", f"a length below cutoff_long = {self.long:g} (m)"
            )

    def applied(self, h: FloatArray, spacing: float) -> FloatArray:
        """Return the heights of a period, (n,), filtered mode by mode; their mean stays."""
        modes = np.fft.rfft(h)
        modes[1:] *= self.transmission(np.arange(1, modes.size) / (h.size * spacing))
        return np.fft.irfft(modes, h.size)
