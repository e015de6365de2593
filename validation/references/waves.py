"""A periodic profile as a sum of cosines, h(x) = sum a_m cos(2 pi m x / period + phi_m), summed term by term.

The references' own heights, slopes and crests: nothing is taken from the codes that they judge.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from validation.harness.arrays import FloatArray, IntArray

POINTS = 16  # samples per shortest wavelength, from which Newton's rule for extremes starts
STEPS = 12  # of Newton's rule; it takes five


class Harmonics(Protocol):
    """Anything that has a period in m and orders, amplitudes in m and phases, (n,) each."""

    @property
    def period(self) -> float: ...  # noqa: D102
    @property
    def orders(self) -> IntArray: ...  # noqa: D102
    @property
    def amplitudes(self) -> FloatArray: ...  # noqa: D102
    @property
    def phases(self) -> FloatArray: ...  # noqa: D102


@dataclass(frozen=True, eq=False)
class Waves:
    """Cosines of a period.

    Examples
    --------
    >>> wave = Waves(2 * np.pi, np.array([1]), np.array([0.5]), np.array([0.1]))
    >>> round(wave.highest, 15), [round(x, 6) for x in wave.crests.tolist()]
    (0.5, [6.183185])
    """

    period: float
    orders: IntArray
    amplitudes: FloatArray
    phases: FloatArray

    @classmethod
    def of(cls, profile: Harmonics) -> "Waves":
        """Return the waves of anything that has a period, orders, amplitudes and phases."""
        if isinstance(profile, Waves):
            return profile
        return cls(profile.period, profile.orders, profile.amplitudes, profile.phases)

    def height(self, x: ArrayLike, derivative: int = 0) -> FloatArray:
        """Return h, or a derivative of it, at positions of any shape."""
        q = 2 * np.pi / self.period * self.orders
        angle = np.multiply.outer(np.asarray(x, dtype=np.float64), q) + self.phases + derivative * np.pi / 2
        return np.asarray(np.cos(angle) @ (self.amplitudes * q**derivative))

    @property
    def rms_height(self) -> float:
        """Root of the mean square of h."""
        return float(np.sqrt(np.sum(self.amplitudes**2) / 2))

    @cached_property
    def crests(self) -> FloatArray:
        """Positions of the local maxima in [0, period), ascending."""
        count = POINTS * int(self.orders.max())
        x = np.arange(count) * (self.period / count)
        h = self.height(x)
        x = x[(h >= np.roll(h, 1)) & (h > np.roll(h, -1))]
        for _ in range(STEPS):
            bend = self.height(x, 2)
            x = x - np.where(bend < 0, self.height(x, 1) / np.where(bend < 0, bend, -1.0), 0.0)
        return np.sort(x % self.period)

    @cached_property
    def highest(self) -> float:
        """Height of the highest crest."""
        return float(self.height(self.crests).max())
