"""Jumps of one patch from ripple to ripple: where, over which crests, and what each releases, in closed form.

On a wave with a ripple the mean pressure p(a) of one patch (one_patch.py) rises and falls with every ripple.  While the
load grows its branch ends at a maximum of p, or before it where the gap at the next crest closes; contact then spreads
at that load to the next a of equal pressure and sets free

    U(a_1) - U(a_2) - p (Delta(a_1) - Delta(a_2)).

A crest on the way is a contact of its own, one each side, if the gap there closes before the edge arrives.  While the
load falls branches end at minima of p.  Under separation control jumps break the symmetry, edge by edge, but the states
between them are those of one patch: at given Delta the first a to which contact spreads.  SI units.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar

import bem
from bem.scene.result import Event, Result
from validation.harness.arrays import FloatArray
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.rows import compared, counted
from validation.harness.schema import Figure, Reference, Row
from validation.references import adapters
from validation.references.one_patch import OnePatch

PERIOD, MODULUS, AMPLITUDE, WORK = 0.01, 1e6 / 0.75, 1e-4, 0.06
MOST = 0.6  # contact fraction beyond which nothing is looked for
POINTS_PER_RIPPLE = 10
LONGEST = 1.0  # rms heights: twenty times the largest increment by default
APPROACH = 60  # half widths at which the gap at a crest is looked at while an edge approaches it
LOADING, UNLOADING = (0.0, 1e4), (0.0, -1500.0)  # mean pressures in Pa, order 20
SEPARATIONS = (60e-6, 20e-6)  # m, order 40


@dataclass(frozen=True)
class Jump:
    """From one half width a to another at a mean pressure, Pa: energy released, J/m^2, and crests touched each side."""

    start: float
    end: float
    pressure: float
    released: float
    touched: int


@dataclass(frozen=True, eq=False)
class RippledWave:
    """The wave of the scene rippled_wave with another ripple, of this order and amplitude in m."""

    order: int
    ripple: float

    @property
    def patch(self) -> OnePatch:
        """Its closed form."""
        return OnePatch(PERIOD, MODULUS, (AMPLITUDE, *[0.0] * (self.order - 2), self.ripple), WORK)

    @property
    def profile(self) -> bem.Profile:
        """Its heights."""
        return bem.Profile.from_harmonics(PERIOD, [1, self.order], [AMPLITUDE, self.ripple])

    def crests(self) -> list[float]:
        """Crests of the ripple on the right, y in (0, pi)."""
        places = 2 * np.pi / PERIOD * self.profile.crests[0]
        return [float(y) for y in places if 1e-9 < y < np.pi]

    def loaded(self, end: float) -> tuple[list[Jump], float]:
        """Jumps while the mean pressure grows from first touch to a value in Pa, and the half width a there."""
        tops = self._turning(1.0)
        a = self._next(self._grid, 0.0, 0.0)
        jumps = [Jump(0.0, a, 0.0, -float(self.patch.energy(a)), 0)]
        while True:
            top = min(t for t in tops if t > a)
            ahead = min(y for y in self.crests() if y > top)
            if self._clearance(top, ahead) < 0:
                top = float(brentq(lambda b, ahead=ahead: self._clearance(b, ahead), a, top, xtol=1e-13))
            pressure = float(self.patch.mean_pressure(top))
            if pressure > end:
                at_touch = end <= jumps[-1].pressure
                return jumps, a if at_touch else _root(self.patch.mean_pressure, end, a, top)
            a = self._next(self._grid, pressure, top)
            jumps.append(self._jump(top, a))

    def unloaded(self, start: float, end: float) -> tuple[list[Jump], float]:
        """Jumps while the mean pressure falls from that at a half width to a value in Pa, and the half width there."""
        dips, a = self._turning(-1.0), start
        jumps: list[Jump] = []
        while True:
            dip = max(t for t in dips if t < a)
            pressure = float(self.patch.mean_pressure(dip))
            if pressure < end:
                return jumps, _root(self.patch.mean_pressure, end, dip, a)
            a = self._next(self._grid[::-1], pressure, dip)
            jumps.append(self._jump(dip, a))

    def spread(self, penetration: float) -> float:
        """Half width a to which contact has spread at a penetration in m."""
        missing = self.patch.penetration(self._grid) - penetration
        up = int(np.flatnonzero((missing[:-1] < 0) & (missing[1:] >= 0))[0])
        return _root(self.patch.penetration, penetration, *self._grid[up : up + 2])

    @cached_property
    def _grid(self) -> FloatArray:
        """Half widths a, ascending."""
        count = int(POINTS_PER_RIPPLE * self.order * MOST / 2)
        return np.asarray(np.pi * MOST * (np.arange(count) + 1.0) / count)

    def _turning(self, sign: float) -> list[float]:
        """The maxima (sign 1) or minima (-1) of the mean pressure."""
        grid = self._grid
        value = sign * self.patch.mean_pressure(grid)
        tops = np.flatnonzero((value[1:-1] > value[:-2]) & (value[1:-1] >= value[2:])) + 1
        found = [
            minimize_scalar(
                lambda a: -sign * float(self.patch.mean_pressure(a)),
                bounds=(grid[i - 1], grid[i + 1]),
                method="bounded",
                options={"xatol": 1e-12},
            )
            for i in tops
        ]
        return [float(top.x) for top in found]

    def _next(self, grid: FloatArray, pressure: float, start: float) -> float:
        """The next a on the way of the grid from a start at which a stable branch has this mean pressure."""
        outward = grid[1] > grid[0]
        beyond = grid[grid > start] if outward else grid[grid < start]
        missing = self.patch.mean_pressure(beyond) - pressure
        risen = (missing[:-1] < 0) & (missing[1:] >= 0) if outward else (missing[:-1] > 0) & (missing[1:] <= 0)
        at = int(np.flatnonzero(risen)[0])
        return _root(self.patch.mean_pressure, pressure, *sorted(beyond[at : at + 2]))

    def _jump(self, start: float, end: float) -> Jump:
        patch = self.patch
        pressure = float(patch.mean_pressure(start))
        energy, depth = patch.energy([start, end]), patch.penetration([start, end])
        touched = sum(self._touches(start, crest, pressure) for crest in self.crests() if start < crest < end)
        released = float(energy[0] - energy[1] - pressure * (depth[0] - depth[1]))
        return Jump(start, end, pressure, released, touched)

    def _touches(self, start: float, crest: float, pressure: float) -> bool:
        """Whether the gap at a crest closes while an edge approaches it from a start."""
        approach = start + (crest - start) * np.arange(APPROACH) / APPROACH
        return min(self.patch.gap(float(a), pressure, crest) for a in approach) < 0

    def _clearance(self, angle: float, crest: float) -> float:
        """Least gap in m about a crest beside a patch in equilibrium."""
        pressure, reach = float(self.patch.mean_pressure(angle)), 0.5 * np.pi / self.order
        least = minimize_scalar(
            lambda y: self.patch.gap(angle, pressure, y),
            bounds=(max(angle, crest - reach), crest + reach),
            method="bounded",
            options={"xatol": 1e-10},
        )
        return float(least.fun)

    def solved(self, control: str, targets: list[float], max_increment: float | None = None) -> Result:
        """The path of the solver."""
        changes: dict[str, Any] = {
            "profile": {"orders": [1, self.order], "amplitudes": [AMPLITUDE, self.ripple]},
            "adhesion": {"work_of_adhesion": WORK},
            "loading": {"control": control, "targets": targets},
            "accuracy": {"max_increment": max_increment},
        }
        return bem.solve(adapters.scene("rippled_wave", changes))


def _root(quantity: Callable[[float], FloatArray], value: float, low: float, high: float) -> float:
    """The half width between two at which a quantity has a value."""
    return float(brentq(lambda a: float(quantity(a)) - value, low, high, xtol=1e-15))


def _ripple_jumps() -> Outcome:
    wave, fine = RippledWave(20, 4e-6), RippledWave(40, 2e-6)
    result = wave.solved("mean_pressure", [*LOADING, *UNLOADING])
    driven = fine.solved("separation", list(SEPARATIONS))
    hurried = fine.solved("separation", list(SEPARATIONS), LONGEST)
    up, highest = wave.loaded(LOADING[-1])
    down, lowest = wave.unloaded(highest, UNLOADING[-1])
    jumps = [*up, *down]
    touch, between = wave.loaded(LOADING[0])[1], wave.unloaded(highest, UNLOADING[0])[1]
    wide = [a / np.pi for a in (touch, highest, between, lowest)]
    spread = [fine.spread(fine.profile.max_height - s) / np.pi for s in SEPARATIONS]
    met = [event for event in result.events if (event.energy_released or 0.0) > LEAST_RELEASED * WORK]
    found = [*met, *[None] * len(jumps)][: len(jumps)]
    kinds = [event.kind for event in result.events]
    touched = 2.0 * sum(jump.touched for jump in jumps)
    exact = Reference(kind="exact", source="closed form of one patch")
    rows: tuple[Row, ...] = (
        compared("contact fraction under a load that grows and falls, order 20", "", exact, wide,
                 [state.contact_fraction for state in result.targets],
                 *MEASURED_LOADED),
        compared("contact fraction at two separations, order 40", "", exact, spread,
                 [state.contact_fraction for state in driven.targets],
                 *MEASURED_DRIVEN),
        compared("energy released by every jump, over that of the closed form", "", exact, [1.0] * len(jumps),
                 [float("nan") if event is None else (event.energy_released or 0.0) / jump.released
                 for event, jump in zip(found, jumps, strict=True)], 2.5 * MEASURED_RELEASED, MEASURED_RELEASED),
        compared("mean pressure at every jump, over the largest", "Pa", exact, [jump.pressure for jump in jumps],
                 [float("nan") if event is None else event.mean_pressure for event in found], 2.5 * MEASURED_PRESSURE,
                 MEASURED_PRESSURE),
        compared(
            "jumps whose pressure or energy is farther from the closed form than estimated", "", exact, [0.0],
            [float(sum(event is None or _misjudged(event, jump) for event, jump in zip(found, jumps, strict=True)))],
            0.01, 0.0, "absolute", pinned="exact"
        ),
        counted("jumps on the way, order 40, in increments of an rms height",
                Reference(kind="self", source="the same path in increments as they are by default"),
                [_jumps(driven)], [_jumps(hurried)]),
        counted("new contacts, coalescences, and jumps", exact, [touched, touched, float(len(jumps))],
                [float(kinds.count("new_contact")), float(kinds.count("coalescence")), float(len(met))]),
    )  # fmt: skip
    counts = {"evaluations": sum(state.evaluations for state in (*result.states, *driven.states))}
    return Outcome(rows=rows, figures=(_figure(wave, jumps, result),), counts=counts)


def _jumps(result: Result) -> float:
    """Number of avalanches: whether a sweeping edge meets a crest ahead of it depends on the steps of the descent."""
    return float(sum((event.energy_released or 0.0) > LEAST_RELEASED * WORK for event in result.events))


def _misjudged(event: Event, jump: Jump) -> bool:
    """Whether the errors that an event estimates are too small, beyond the rounding of the closed form."""
    known, estimate = (jump.pressure, jump.released), event.error_estimate
    found = (event.mean_pressure, event.energy_released or 0.0)
    allowed = (estimate.mean_pressure or 0.0, estimate.energy_released or 0.0)
    noise = (ROUNDING * MODULUS * AMPLITUDE / PERIOD, ROUNDING * WORK)
    return any(abs(a - b) > error + least for a, b, error, least in zip(found, known, allowed, noise, strict=True))


def _figure(wave: RippledWave, jumps: list[Jump], result: Result) -> Figure:
    curve = np.linspace(0.01, 0.4, 300)
    return drawn("ripple-jumps",
                 "Mean pressure of one patch on a rippled wave: jumps at constant load from ripple to ripple.",
                 axes("contact fraction", "mean pressure / kPa",
                      trace("closed form of one patch", curve, wave.patch.mean_pressure(np.pi * curve) / 1e3),
                      *(
                          trace("jump", [jump.start / np.pi, jump.end / np.pi], [jump.pressure / 1e3] * 2, "thin")
                          for jump in jumps
                      ),
                      marks("bem", [state.contact_fraction for state in result.states],
                            [state.mean_pressure / 1e3 for state in result.states])))  # fmt: skip


ROUNDING = 1e-13  # of the units of pressure and energy
LEAST_RELEASED = 1e-3  # of the work of adhesion, by a jump: measured 0.017 to 0.23; what releases less is a fold's edge

MEASURED_LOADED, MEASURED_DRIVEN = (1.4e-13, 5.5e-14), (2e-14, 7.8e-15)
MEASURED_RELEASED, MEASURED_PRESSURE = 8.9e-12, 4.4e-12

CASES = (
    Case(id="ripple-jumps", group="closed forms", level="quick",
         question="Does every jump from ripple to ripple happen where it must, touch the crests it must, and release "
         "what it must?",
         equations=r"released $= U(a_1) - U(a_2) - p \, (\Delta(a_1) - \Delta(a_2))$, "
                   r"$p(a_1) = p(a_2)$ a maximum or a touch",
         sources=("johnson1995", "muskhelishvili1953"), compute=_ripple_jumps,
         effects=("half_space", "adhesion", "load_control", "unloading"), scene=adapters.scene_text("rippled_wave")),
)  # fmt: skip
