"""Problem in plain SI numbers, which every code that is compared takes.

A problem is raw data, from which every code derives its own constants, so that a mistake in what follows from them
cannot cancel between two codes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from validation.harness.arrays import FloatArray


@dataclass(frozen=True)
class Problem:
    """A rigid periodic profile h = sum h_m cos(2 pi m x / period + phi_m), pressed on an elastic solid along a path."""

    youngs_modulus: float  # Pa
    poisson_ratio: float
    period: float  # m
    orders: tuple[int, ...]  # harmonics, with amplitudes in m and phases
    amplitudes: tuple[float, ...]
    phases: tuple[float, ...]
    control: str  # "mean_pressure", "separation" or "penetration"
    targets: tuple[float, ...]  # Pa or m, visited in this order from surfaces apart
    thickness: float | None = None  # of a bonded layer, m; None: a half-space
    work_of_adhesion: float | None = None  # J/m^2; None: no adhesion
    slope_term: bool = False  # whether adhesion is counted on the true length

    @property
    def harmonics(self) -> tuple[Any, FloatArray, FloatArray]:
        """Orders, amplitudes and phases as arrays."""
        return np.array(self.orders), np.array(self.amplitudes), np.array(self.phases)
