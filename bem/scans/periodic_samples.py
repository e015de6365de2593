"""Samples of a period, from which the profile is made, and what a cut at `harmonics` leaves of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.gaussian_filter import GaussianFilter
from bem.scans.measured_line import MeasuredLine, Step
from bem.scans.noise_floor import Spectrum

DRAWN = 4000  # format: samples kept for figures
CARRIED = 1e-6  # derived: of the rms slope: contact areas go as its inverse, and the default tolerance is this


@dataclass(frozen=True, eq=False)
class PeriodicSamples:
    """Uniform samples of a period, with the steps of their preparation.

    Examples
    --------
    >>> x = np.array([0.0, 0.5, 1.0])
    >>> line = MeasuredLine(x, np.zeros(3), {})
    >>> samples = PeriodicSamples(x, line.h, line, Spectrum(line.h, 0.5))
    >>> samples.spacing, samples.period, samples.max_harmonics
    (0.5, 1.5, 1)
    """

    x: FloatArray  # positions, m, (n,)
    h: FloatArray  # heights, m, (n,)
    measured: MeasuredLine  # as read
    spectrum: Spectrum  # of the line detrended, neither continued nor filtered
    steps: tuple[Step, ...] = ()  # of the preparation
    gaussian: GaussianFilter = field(default_factory=GaussianFilter)  # which the heights have passed

    @property
    def spacing(self) -> float:
        """Sample distance dx, m."""
        return float(self.x[-1] - self.x[0]) / (self.x.size - 1)

    @property
    def period(self) -> float:
        """Period n dx, m."""
        return self.spacing * self.x.size

    @property
    def max_harmonics(self) -> int:
        """Highest order below half the number of samples."""
        return int(self.x.size - 1) // 2

    @cached_property
    def _moments(self) -> tuple[FloatArray, FloatArray]:
        """Mean squares of height (m^2) and slope of the orders up to each, (n // 2,) each, the order n/2 included."""
        power = np.abs(np.fft.rfft(self.h)[1:]) ** 2 * (2 / self.h.size**2)
        power[self.max_harmonics :] /= 2  # an order n/2 has no phase
        wavenumbers = 2 * np.pi / self.period * np.arange(1, power.size + 1)
        return np.cumsum(power), np.cumsum(power * wavenumbers**2)

    @property
    def harmonics_needed(self) -> int:
        """Smallest number of harmonics that keeps the rms slope but for `CARRIED` of it; at most `max_harmonics`."""
        slopes = self._moments[1]
        return min(int(np.searchsorted(slopes, (1 - CARRIED) ** 2 * slopes[-1])) + 1, self.max_harmonics)

    @cached_property
    def end_jump(self) -> float:
        """Step from the last sample to the first of the next period over the rms step between neighbours."""
        rms = float(np.sqrt(np.mean(np.diff(self.h) ** 2)))
        return abs(float(self.h[0] - self.h[-1])) / rms if rms > 0 else 0.0

    def slope_share(self, harmonics: int) -> float:
        """Return the rms slope of the orders up to `harmonics` over the rms slope of all; 1 if the samples are flat."""
        slopes = self._moments[1]
        return float(np.sqrt(slopes[harmonics - 1] / slopes[-1])) if slopes[-1] > 0 else 1.0

    def noise_share(self, harmonics: int) -> float:
        """Return the share of noise in the mean square slope of the orders up to `harmonics`, as filtered."""
        return self.spectrum.noise_share(harmonics, self.period, self.gaussian)

    def step(self, name: str) -> Step:
        """Return the step of the preparation with a name."""
        return next(step for step in self.steps if step["step"] == name)

    def preparation(self, harmonics: int) -> tuple[Step, ...]:
        """Return all steps, the cut at `harmonics` last."""
        before, after = ([float(np.sqrt(moment[k])) for moment in self._moments] for k in (-1, harmonics - 1))
        share = self.slope_share(harmonics)
        cut: Step = {"step": "cut", "harmonics": harmonics, "of": self.max_harmonics, "slope_share_kept": share}
        return (*self.steps, cut | {"rms_height": [before[0], after[0]], "rms_slope": [before[1], after[1]]})

    def drawn(self) -> dict[str, FloatArray]:
        """Return the thinned arrays that a figure needs.

        Samples as measured (scan_x, scan_h) and prepared (profile_x, profile_h), m; the power spectrum in bands,
        scan_density (m^3) over scan_wavelength (m).
        """
        lines = {}
        for name, line in (("scan", self.measured), ("profile", self)):
            lines[f"{name}_x"], lines[f"{name}_h"] = _thinned(line.x, line.h)
        frequency, density, _ = self.spectrum.bands
        return lines | {"scan_wavelength": 1 / frequency, "scan_density": density}


def _thinned(x: FloatArray, h: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a line of at most `DRAWN` samples: of each stretch of a longer one the lowest and the highest."""
    if x.size <= DRAWN:
        return x, h
    stretches = np.array_split(np.arange(x.size), DRAWN // 2)
    low = np.where(np.isnan(h), np.inf, h)
    high = np.where(np.isnan(h), -np.inf, h)
    extremes = [sorted((part[np.argmin(low[part])], part[np.argmax(high[part])])) for part in stretches]
    chosen = np.array(extremes).ravel()
    return x[chosen], h[chosen]
