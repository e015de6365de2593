"""A wave that carries a ripple, loaded and unloaded: the whole path of jumps against the closed form of one patch.

The mean pressure p(f) of one patch in equilibrium (merged_crests.py) rises and falls with every ripple that the edges
cross.  While the load grows contact spreads to the first fraction at which p(f) reaches it, and jumps at each maximum
that tops those before; while the load falls contact recedes to the last such fraction, and jumps at each minimum
below those before.  The ripple makes a loop of what would be one curve: it holds the surfaces together (Guduru,
J. Mech. Phys. Solids 55 (2007) 445).  The closed form knows nothing of the path: a jump that ends beyond the nearest
minimum, or is found too late, is seen as a number.  SI units.  Limits: one patch on a symmetric profile.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.optimize import brentq, minimize_scalar

import bem
from bem.scene.result import Result, State
from validation.cases.exact.merged_crests import one_patch_mean_pressure
from validation.harness.arrays import FloatArray
from validation.harness.case import Case, Outcome
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.rows import compared, counted
from validation.harness.schema import Figure, Reference, Row
from validation.references import adapters

# of the scene rippled_wave; SI units
AMPLITUDE, RIPPLE, ORDER, WORK = 1e-4, 2e-6, 30, 0.062
LOADING, UNLOADING = (0.0, 1e3, 3e3, 6e3, 1e4, 1.4e4), (1.2e4, 1e4, 6e3, 3e3, 0.0, -1e3, -1.6e3)
HARMONICS = [AMPLITUDE, *[0.0] * (ORDER - 2), RIPPLE]
LEAST, MOST = 0.03, 0.5  # contact fractions; at the least one p(f) < 0 falls, and it passes the highest load below MOST
POINTS_PER_RIPPLE = 16
LEAST_RELEASED = 1e-3  # of the work of adhesion, by a jump: measured 0.026 to 0.09; next to folds there are lesser ones


def mean_pressure(fraction: float) -> float:
    """Mean pressure of one patch in equilibrium, in Pa, at a contact fraction."""
    return one_patch_mean_pressure(np.pi * fraction, HARMONICS, WORK)


def turning_points() -> FloatArray:
    """Contact fractions at which p(f) has a maximum or a minimum, ascending, (n,)."""
    grid = np.linspace(LEAST, MOST, int(POINTS_PER_RIPPLE * ORDER * (MOST - LEAST) / 2))
    pressure = np.array([mean_pressure(float(f)) for f in grid])
    rise = np.sign(np.diff(pressure))
    turning = np.flatnonzero(rise[1:] != rise[:-1]) + 1
    found = []
    for i in turning:
        sign = 1.0 if pressure[i] < pressure[i - 1] else -1.0
        best = minimize_scalar(
            lambda f, sign=sign: sign * mean_pressure(f),
            bounds=(grid[i - 1], grid[i + 1]),
            method="bounded",
            options={"xatol": 1e-12},
        )
        found.append(float(best.x))
    return np.array(found)


def spreading(turning: FloatArray, pressure: float) -> float:
    """First contact fraction at which p(f) rises to a load in Pa; ValueError where it does not below MOST."""
    stops = [*turning.tolist(), MOST]
    for start, stop in pairwise(stops):
        if mean_pressure(start) < pressure <= mean_pressure(stop):
            return float(brentq(lambda f: mean_pressure(f) - pressure, start, stop, xtol=1e-15))
    raise ValueError(f"mean pressure: {pressure:g} Pa is not reached below a contact fraction of {MOST:g}")


def receding(turning: FloatArray, pressure: float, start: float) -> float:
    """Last contact fraction below a start at which p(f) falls to a load in Pa; ValueError where it lies below all."""
    stops = [start, *turning[turning < start][::-1].tolist()]
    for high, low in pairwise(stops):
        if mean_pressure(low) <= pressure < mean_pressure(high):
            return float(brentq(lambda f: mean_pressure(f) - pressure, low, high, xtol=1e-15))
    raise ValueError(f"mean pressure: {pressure:g} Pa lies below all minima")


def jumps(turning: FloatArray) -> tuple[list[float], list[float]]:
    """Mean pressures at which contact jumps while it is loaded and while it is unloaded, in Pa, in order."""
    pressures = [mean_pressure(f) for f in turning.tolist()]
    highest = spreading(turning, LOADING[-1])
    up = [p for i, p in enumerate(pressures) if LOADING[0] < p < LOADING[-1] and p >= max(pressures[: i + 1])]
    back = [p for f, p in zip(turning.tolist(), pressures, strict=True) if f < highest][::-1]
    down = [p for i, p in enumerate(back) if UNLOADING[-1] < p < LOADING[-1] and p <= min(back[: i + 1])]
    return up, down


def _jumped(result: Result) -> list[float]:
    """Mean pressures of the jumps after first touch; each releases more than a thousandth of the work of adhesion."""
    later = result.events[[event.kind for event in result.events].index("first_touch") + 1 :]
    return [event.mean_pressure for event in later if (event.energy_released or 0.0) > LEAST_RELEASED * WORK]


def _rippled_wave() -> Outcome:
    result = bem.solve(adapters.scene("rippled_wave"))
    turning = turning_points()
    start = spreading(turning, LOADING[-1])
    up = [spreading(turning, load) for load in LOADING]
    down = [receding(turning, load, start) for load in UNLOADING]
    states = list(result.targets)
    spread, receded = states[: len(up)], states[len(up) :]
    expected, met = [p for leg in jumps(turning) for p in leg], _jumped(result)
    exact = Reference(kind="exact", source="closed form of one patch, first and last passage of its mean pressure")
    rows: list[Row] = [compared(f"contact fraction while the load {way}", "", exact, values,
                                [state.contact_fraction for state in leg], 2.5 * measured, measured)
                       for way, values, leg, measured in (("grows", up, spread, MEASURED_UP),
                           ("falls", down, receded, MEASURED_DOWN))]  # fmt: skip
    seen = [float(state.n_patches) for state in states] + [float(len(met))]
    rows += [
        counted("patches of every state, and jumps after first touch", exact,
                [1.0] * len(states) + [float(len(expected))], seen),
        compared("mean pressures at the jumps", "Pa", exact, expected, [*met, *[None] * len(expected)][: len(expected)],
                 2.5 * MEASURED_JUMP, MEASURED_JUMP, scale=max(expected)),
    ]  # fmt: skip
    counts = {"evaluations": sum(state.evaluations for state in result.states), "states": len(result.states)}
    return Outcome(rows=tuple(rows), figures=(_figure(spread, receded, up, down),), counts=counts)


def _figure(spread: list[State], receded: list[State], up: list[float], down: list[float]) -> Figure:
    curve = np.linspace(LEAST, MOST, 600)
    legs = (("loading", spread, up), ("unloading", receded, down))
    return drawn("rippled-wave",
                 "Contact fraction against mean pressure: contact spreads and recedes from ripple to ripple, along the "
                 "outer branches of the closed form.",
                 axes("mean pressure / kPa", "contact fraction",
                      *(
                          marks(f"bem, {name}", [state.mean_pressure / 1e3 for state in leg],
                                [state.contact_fraction for state in leg])
                          for name, leg, _ in legs
                      ),
                      trace("closed form of one patch", [mean_pressure(f) / 1e3 for f in curve], curve)),
                 axes("mean pressure / kPa", "signed error of the contact fraction",
                      *(
                          marks(name, [state.mean_pressure / 1e3 for state in leg],
                                [state.contact_fraction - f for state, f in zip(leg, exact, strict=True)])
                          for name, leg, exact in legs
                      )))  # fmt: skip


# the largest over WORK 0.058 to 0.07 and max_increment 1.5 and 2
MEASURED_UP, MEASURED_DOWN, MEASURED_JUMP = 1.8e-13, 2e-13, 1e-9

CASES = (
    Case(id="rippled-wave", group="closed forms", level="quick",
         question="Does contact on a rippled wave spread and recede by the jumps of the closed form?",
         equations=r"$p(f) = \sum_k c_k L_k(\cos \pi f)$; loading: $f = \min \{f: p(f) \ge \text{load}\}$, "
         r"unloading: $f = \max \{f: p(f) \le \text{load}\}$",
         sources=("guduru2007", "johnson1995", "muskhelishvili1953"), compute=_rippled_wave,
         effects=("half_space", "adhesion"), scene=adapters.scene_text("rippled_wave")),
)  # fmt: skip
