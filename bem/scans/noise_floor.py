"""Power spectrum of a scan, its noise floor, and the wavelength at which the profile falls below the floor.

The one-sided density S(f) in m^3 over spatial frequencies f = 1 / lambda, sum S df = <h^2>, is that of the line and
the same in reverse after it, whatever is solved: without a jump at the ends, leakage falls as f^-4, as no profile does
(cosine transform: Denis, Cote, Laprise, Mon. Weather Rev. 130 (2002) 1812).  It is averaged over bands, `BANDS` to the
octave, counted down from the highest frequency 1 / (2 dx).

floor      The noise of an instrument, and of the digits printed, is white: the density ends in a flat tail.  A straight
           line is fitted to ln S over ln f in the highest octave.  The mean of n modes, squares of normal numbers, has
           a logarithm with the bias psi(n/2) - ln(n/2) and the variance psi'(n/2) (Abramowitz, Stegun, 6.3 and 6.4):
           that corrects and weights the bands, and gives the error of the slope.  The tail is flat where the slope is
           nearer to 0 than to that of f^-1, the slowest that a self-affine surface falls (`FLAT`), and its error small
           enough to tell these apart (`LARGEST_ERROR`).  The floor is the median of the bands, white noise of the rms
           height sqrt(floor / (2 dx)).  Flat ranges at longer wavelengths are no floor: surfaces level off there.
crossing   Where the profile alone has the density of the noise, the spectrum has twice the floor.  The cut suggested
           is the middle of the last octave whose mean density is twice the floor, and `SURE` standard errors above it:
           the mean of n modes, squares of normal numbers, has the standard error sqrt(2 / n) of the floor.
share      Of the mean square slope, int (2 pi f T)^2 S df over the harmonics kept and with the transmission T of the
           filters, what the floor makes of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.gaussian_filter import GaussianFilter

BANDS = 12  # format: to the octave
FLAT = 0.5  # format: of what a warning calls flat: exponent of a tail: half way from noise to f^-1
LARGEST_ERROR = 1 / 3  # format: of that exponent: 0 and 1 are three errors apart
SURE = 6.0  # format: standard errors of an octave above the floor


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Power spectrum of a line of uniform heights (n,) at a sample distance, m.

    Examples
    --------
    >>> noise = np.random.default_rng(0).normal(0.0, 2e-9, 10_000)
    >>> spectrum = Spectrum(noise, 1e-6)
    >>> round(spectrum.noise_rms * 1e9, 1), round(spectrum.noise_share(9999, 0.02, GaussianFilter()), 1)
    (2.0, 1.0)
    """

    h: FloatArray
    spacing: float

    @cached_property
    def modes(self) -> tuple[FloatArray, FloatArray]:
        """Frequencies k / (2 n dx), k = 1 .. n - 1, in 1/m, and the density of each, m^3."""
        n = self.h.size
        mirrored = np.fft.rfft(np.concatenate([self.h, self.h[::-1]]))[1:n]
        return np.arange(1, n) / (2 * n * self.spacing), np.abs(mirrored) ** 2 * (self.spacing / n)

    @cached_property
    def bands(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Mean frequency (of logarithms), mean density and number of modes of each band, frequencies ascending."""
        f, density = self.modes
        below = np.floor(-BANDS * np.log2(2 * self.spacing * f)).astype(int)
        counts = np.bincount(below).astype(float)
        filled = counts > 0
        sums = [np.bincount(below, weights=values)[filled] / counts[filled] for values in (np.log(f), density)]
        return np.exp(sums[0])[::-1], sums[1][::-1], counts[filled][::-1]

    @cached_property
    def tail(self) -> tuple[float, float] | None:
        """Power of the wavelength by which the highest octave falls, and its error; None if bands lack heights."""
        f, density, counts = (values[-BANDS:] for values in self.bands)
        if self.bands[0].size <= BANDS or not np.all(density > 0):
            return None
        special = import_module("scipy.special")
        weights = 1 / special.polygamma(1, counts / 2)
        x, y = np.log(f), np.log(density) - special.digamma(counts / 2) + np.log(counts / 2)
        x -= float(weights @ x / weights.sum())
        spread = float(weights @ x**2)
        return -float(weights @ (x * y)) / spread, 1 / math.sqrt(spread)

    @cached_property
    def floor(self) -> float:
        """Density of the noise, m^3; 0 where the tail is not flat."""
        flat = self.tail is not None and abs(self.tail[0]) <= FLAT and self.tail[1] <= LARGEST_ERROR
        return float(np.median(self.bands[1][-BANDS:])) if flat else 0.0

    @property
    def noise_rms(self) -> float:
        """rms height of white noise of this density, m."""
        return math.sqrt(self.floor / (2 * self.spacing))

    @cached_property
    def crossing(self) -> float | None:
        """Wavelength at which the profile falls to the floor, m; None without a floor, or without a profile above."""
        f, density, counts = self.bands
        if not self.floor:
            return None
        octave = np.ones(BANDS)
        modes = np.convolve(counts, octave, "valid")
        means = np.convolve(density * counts, octave, "valid") / modes
        above = np.flatnonzero(means >= self.floor * (1 + np.maximum(1.0, SURE * np.sqrt(2 / modes))))
        return math.exp(-float(np.log(f[above[-1] :][:BANDS]).mean())) if above.size else None

    def noise_share(self, harmonics: int, period: float, gaussian: GaussianFilter) -> float:
        """Return the share of noise in the mean square slope that filters and a cut leave."""
        f, density = self.modes
        passed = f <= harmonics / period
        weights = (f[passed] * gaussian.transmission(f[passed])) ** 2
        total = float(weights @ density[passed])
        return self.floor * float(weights.sum()) / total if total > 0 else 0.0

    def facts(self) -> dict[str, Any]:
        """Return the noise floor and the suggested cut as plain values."""
        if self.tail is None:
            return {"noise": "no floor: no heights of short wavelengths"}
        if not self.floor:
            power, error = self.tail
            fell = "in the octave of the shortest waves the density goes as the power"
            few = f"; {self.h.size} samples are too few to tell" * (error > LARGEST_ERROR)
            return {"noise": f"no floor: {fell} {power:.2g} ± {error:.1g} of the wavelength{few}"}
        facts: dict[str, Any] = {"noise": "flat tail", "noise_density": self.floor, "noise_rms": self.noise_rms}
        if self.crossing is not None:
            facts["suggested_cutoff"] = self.crossing
        return facts
