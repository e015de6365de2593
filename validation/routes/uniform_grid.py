"""Answers of a uniform grid to a problem, from gaps, contacts and mean pressures on its points.

Contacts are counted to whole points, edges lie half a spacing beside the last of them.  The displaced surface is gap
plus profile; with its amplitudes a_m, pressures are E* q a_m / 2 and the energy per area sum E* q a_m^2 / 8.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from validation.harness.arrays import FloatArray
from validation.harness.route import Place, Problem
from validation.references.fft_solver import on_grid

WITHOUT_ADHESION = 8  # times as many points


def affordable(problem: Problem, points: int) -> int:
    """Return the points of a grid: eight times as many without adhesion, where a state costs an eighth."""
    return points if problem.work_of_adhesion is not None else WITHOUT_ADHESION * points


@dataclass(frozen=True)
class OnGrid:
    """A state: gap in m and whether in contact at every point (n,), mean pressure in Pa."""

    gap: FloatArray
    contact: Any
    mean_pressure: float


@dataclass(frozen=True)
class Grid:
    """The points of a problem."""

    problem: Problem
    points: int

    @property
    def period(self) -> float:
        """m."""
        return self.problem.period

    @property
    def modulus(self) -> float:
        """E*, Pa."""
        return self.problem.youngs_modulus / (1 - self.problem.poisson_ratio**2)

    @property
    def x(self) -> FloatArray:
        """m, (n,)."""
        return np.asarray(np.arange(self.points) * (self.period / self.points), dtype=np.float64)

    def profile(self) -> tuple[FloatArray, FloatArray]:
        """Return heights and slopes at the points; NotImplementedError if the points do not resolve the profile."""
        return on_grid(self.problem, self.points)


def answers(grid: Grid, states: list[OnGrid]) -> dict[str, list[Any]]:
    """Return the answers from the states at the targets, None beyond the last state, without answers of a path."""
    fractions = [float(np.mean(state.contact)) for state in states]
    spectra = [_amplitudes(grid, state) for state in states]
    quantities: dict[str, Any] = {
        "contact_fraction": fractions,
        "gap_fraction": [1 - fraction for fraction in fractions],
        "mean_pressure": [state.mean_pressure for state in states],
        "separation": [np.mean(state.gap) for state in states],
        "elastic_energy": [float(np.sum(grid.modulus * q * np.abs(modes) ** 2) / 8) for modes, q in spectra],
        "patches": [int(np.sum(state.contact & ~np.roll(state.contact, 1))) for state in states],
    }
    quantities = {name: grid.problem.padded(values) for name, values in quantities.items()}
    for name, what in grid.problem.asked.items():
        if "target" in what and what["target"] <= len(states):
            quantities[name] = _field(grid, states[int(what["target"]) - 1], name, what)
    return grid.problem.answered(quantities)


def _amplitudes(grid: Grid, state: OnGrid) -> tuple[Any, Any]:
    """Return complex amplitudes of the displaced surface, and wavenumbers."""
    modes = np.fft.rfft(state.gap + grid.profile()[0]) * 2 / grid.points
    return modes, 2 * np.pi / grid.period * np.arange(modes.size)


def _field(grid: Grid, state: OnGrid, name: str, what: Place) -> Any:
    """Return a quantity of one state; None if the grid does not offer it."""
    if name == "edges":
        before, after = np.roll(state.contact, 1), np.roll(state.contact, -1)
        half = grid.period / grid.points / 2
        ends = np.concatenate([grid.x[state.contact & ~before] - half, grid.x[state.contact & ~after] + half])
        return np.sort(ends)
    modes, q = _amplitudes(grid, state)
    if name == "displacement_amplitudes":
        return np.abs(modes)[what["orders"]]
    if name == "gap_at":
        return np.interp(what["points"], grid.x, state.gap, period=grid.period)
    if name == "pressure_at":
        pressure = state.mean_pressure + np.fft.irfft(grid.modulus * q * modes / 2 * grid.points / 2, grid.points)
        return np.interp(what["points"], grid.x, pressure, period=grid.period)
    return None
