"""A wave that carries a ripple, loaded and unloaded: its jumps from ripple to ripple, in closed form (one_patch.py).

The mean pressure p(a) of one patch in equilibrium rises and falls with every ripple that the edges cross.  While the
load grows a branch ends at a maximum of p, or before it where the gap at the next crest closes; contact then spreads at
that load to the next a of equal pressure and sets free

    U(a_1) - U(a_2) - p (Delta(a_1) - Delta(a_2)).

A crest on the way is a contact of its own, one each side, if the gap there closes before the edge arrives.  While the
load falls branches end at minima of p.  The ripple makes a loop of what would be one curve: it holds the surfaces
together (Guduru, J. Mech. Phys. Solids 55 (2007) 445).  Under separation control jumps break the symmetry, edge by
edge, but the states between them are those of one patch: at given Delta the first a to which contact spreads.
Limits: symmetric profiles, one patch between jumps.  SI units.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from validation.harness.arrays import FloatArray
from validation.references.one_patch import OnePatch
from validation.references.waves import Waves

PERIOD, MODULUS, AMPLITUDE = 0.01, 1e6 / 0.75, 1e-4
MOST = 0.6  # contact fraction beyond which nothing is looked for
POINTS_PER_RIPPLE = 10
APPROACH = 60  # half widths at which the gap at a crest is looked at while an edge approaches it


@dataclass(frozen=True)
class Jump:
    """Jump between half widths a at a mean pressure, Pa: energy released, J/m^2, and crests touched each side."""

    start: float
    end: float
    pressure: float
    released: float
    touched: int


@dataclass(frozen=True, eq=False)
class RippledWave:
    """The wave of the scene rippled_wave with a ripple of this order, amplitude in m and work of adhesion in J/m^2."""

    order: int
    ripple: float
    work: float

    @cached_property
    def patch(self) -> OnePatch:
        """Closed form of a single patch on the rippled wave."""
        return OnePatch(PERIOD, MODULUS, (AMPLITUDE, *[0.0] * (self.order - 2), self.ripple), self.work)

    @property
    def highest(self) -> float:
        """Height of the middle crest above the mean plane, m."""
        return AMPLITUDE + self.ripple

    @cached_property
    def crests(self) -> list[float]:
        """Crests of the ripple on the right, y in (0, pi)."""
        waves = Waves(2 * np.pi, np.array([1, self.order]), np.array([AMPLITUDE, self.ripple]), np.zeros(2))
        return [float(y) for y in waves.crests if 1e-9 < y < np.pi]

    def loaded(self, *ends: float) -> tuple[list[Jump], list[float]]:
        """Return the jumps while the mean pressure grows from first touch to the last of `ends` in Pa.

        The second list holds the half width a at each of `ends`.
        """
        a, reached = self._next(self._grid, 0.0, 0.0), list[float]()
        jumps = [Jump(0.0, a, 0.0, -float(self.patch.energy(a)), 0)]
        while True:
            top = min(t for t in self.turning[1.0] if t > a)
            ahead = min(y for y in self.crests if y > top)
            if self._clearance(top, ahead) < 0:
                top = float(brentq(lambda b, ahead=ahead: self._clearance(b, ahead), a, top, xtol=1e-13))
            pressure = float(self.patch.mean_pressure(top))
            for end in (end for end in ends[len(reached) :] if end < pressure):
                reached.append(a if end <= jumps[-1].pressure else _root(self.patch.mean_pressure, end, a, top))
            if len(reached) == len(ends):
                return jumps, reached
            a = self._next(self._grid, pressure, top)
            jumps.append(self._jump(top, a))

    def unloaded(self, start: float, *ends: float) -> tuple[list[Jump], list[float]]:
        """Return the jumps while the pressure falls from its value at half width `start` to the last of `ends` in Pa.

        The second list holds the half width at each of `ends`.
        """
        a, jumps, reached = start, list[Jump](), list[float]()
        while True:
            dip = max(t for t in self.turning[-1.0] if t < a)
            pressure = float(self.patch.mean_pressure(dip))
            for end in (end for end in ends[len(reached) :] if end > pressure):
                reached.append(_root(self.patch.mean_pressure, end, dip, a))
            if len(reached) == len(ends):
                return jumps, reached
            a = self._next(self._grid[::-1], pressure, dip)
            jumps.append(self._jump(dip, a))

    def spread(self, penetration: float) -> float:
        """Return the half width a to which contact has spread at a penetration in m."""
        missing = self.patch.penetration(self._grid) - penetration
        up = int(np.flatnonzero((missing[:-1] < 0) & (missing[1:] >= 0))[0])
        return _root(self.patch.penetration, penetration, *self._grid[up : up + 2])

    @cached_property
    def _grid(self) -> FloatArray:
        """Half widths a, ascending."""
        count = int(POINTS_PER_RIPPLE * self.order * MOST / 2)
        return np.asarray(np.pi * MOST * (np.arange(count) + 1.0) / count)

    @cached_property
    def turning(self) -> dict[float, list[float]]:
        """Half widths of the maxima (sign 1) and minima (-1) of the mean pressure, ascending."""
        grid, value = self._grid, self.patch.mean_pressure(self._grid)
        places = {}
        for sign in (1.0, -1.0):
            rises = sign * np.diff(value)
            tops = np.flatnonzero((rises[:-1] > 0) & (rises[1:] <= 0)) + 1
            lowered = partial(self._lowered, sign)
            places[sign] = [_least(lowered, grid[i - 1], grid[i + 1], 1e-12)[0] for i in tops]
        return places

    def _lowered(self, sign: float, a: float) -> float:
        return -sign * float(self.patch.mean_pressure(a))

    def _next(self, grid: FloatArray, pressure: float, start: float) -> float:
        """Return the first a of a stable branch with a given mean pressure, from `start` along the grid.

        ValueError if contact that jumps at the mean pressure does not come to rest below `MOST` or before it vanishes.
        """
        outward = grid[1] > grid[0]
        beyond = grid[grid > start] if outward else grid[grid < start]
        missing = self.patch.mean_pressure(beyond) - pressure
        risen = (missing[:-1] < 0) & (missing[1:] >= 0) if outward else (missing[:-1] > 0) & (missing[1:] <= 0)
        if not risen.any():
            raise ValueError(f"mean pressure: contact that jumps at {pressure:g} Pa does not come to rest")
        at = int(np.flatnonzero(risen)[0])
        return _root(self.patch.mean_pressure, pressure, *sorted(beyond[at : at + 2]))

    def _jump(self, start: float, end: float) -> Jump:
        pressure = float(self.patch.mean_pressure(start))
        energy, depth = self.patch.energy([start, end]), self.patch.penetration([start, end])
        touched = sum(self._touches(start, crest, pressure) for crest in self.crests if start < crest < end)
        released = float(energy[0] - energy[1] - pressure * (depth[0] - depth[1]))
        return Jump(start, end, pressure, released, touched)

    def _touches(self, start: float, crest: float, pressure: float) -> bool:
        """Return True if the gap at a crest closes while an edge approaches the crest from `start`."""
        approach = start + (crest - start) * np.arange(APPROACH) / APPROACH
        return min(self.patch.gap(float(a), pressure, crest) for a in approach) < 0

    def _clearance(self, angle: float, crest: float) -> float:
        """Return the least gap in m about a crest beside a patch in equilibrium."""
        pressure, reach = float(self.patch.mean_pressure(angle)), 0.5 * np.pi / self.order
        return _least(lambda y: self.patch.gap(angle, pressure, y), max(angle, crest - reach), crest + reach, 1e-10)[1]


def _root(quantity: Callable[[float], FloatArray], value: float, low: float, high: float) -> float:
    """Return the half width between `low` and `high` at which a quantity has a value."""
    return float(brentq(lambda a: float(quantity(a)) - value, low, high, xtol=1e-15))


def _least(quantity: Callable[[float], float], low: float, high: float, close: float) -> tuple[float, float]:
    """Return the place between `low` and `high` at which a quantity is least, and the least value."""
    minimum = minimize_scalar(quantity, bounds=(low, high), method="bounded", options={"xatol": close})
    return float(minimum.x), float(minimum.fun)


WAVE = RippledWave(30, 2e-6, 0.062)  # of the scene rippled_wave
