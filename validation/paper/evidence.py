"""Numbers of the realisations and of the theory at the loads asked for; means with their standard errors.

The standard error of a mean over n realisations is s / sqrt n with the n - 1 standard deviation s; that of a quantity
taken from the mean curve, such as a fitted exponent, is the jackknife's: the curve without realisation k gives t_k, and
the error is sqrt((n - 1) / n sum (t_k - mean t)^2).  Loads in units of E*, lengths in m, pressures in Pa.

Source of the jackknife: B. Efron, C. Stein, Ann. Statist. 9 (1981) 586, doi:10.1214/aos/1176345462.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bem.geometry.profile import Profile
from bem.scene.result import Result, State
from bem.scene.surface import surface_of
from persson import AdhesiveContact, DiscreteSpectrum, NonadhesiveContact, solve, solve_nonadhesive
from validation.harness.arrays import FloatArray
from validation.harness.figure_data import marks, shaded, trace
from validation.harness.schema import Series
from validation.paper.members import LOADS, PAPER, Size
from validation.paper.statements import Statement
from validation.references.paper_problem import MODULUS

SAME_LOAD = 1e-9  # of E*


@dataclass(frozen=True, eq=False)
class Realisation:
    """A member that was computed."""

    name: str
    result: Result

    @cached_property
    def surface(self) -> Profile:
        """The profile, SI units."""
        return surface_of(self.result.scene["profile"], None)

    @cached_property
    def lines(self) -> DiscreteSpectrum:
        """The lines of the profile, for the theory."""
        return DiscreteSpectrum.of_profile(self.surface)

    @property
    def touching(self) -> list[State]:
        """States that carry a load > 0."""
        return [state for state in self.result.states if state.mean_pressure > 0]

    def path(self, of: Callable[[State], float]) -> tuple[list[float], list[float]]:
        """Return the loads over E* of all states in `touching`, and a number of each state."""
        return [state.mean_pressure / MODULUS for state in self.touching], list(map(of, self.touching))

    @property
    def final_load(self) -> float:
        """Highest load reached."""
        return max((state.mean_pressure for state in self.result.states), default=0.0) / MODULUS

    def value_at(self, load: float, of: Callable[[State], float]) -> float:
        """Return a number of the state at a load; interpolate linearly if the load is jumped over."""
        k = self.index_of(load)
        if k is not None:
            return of(self.result.targets[k])
        for before, after in pairwise(self.result.states):
            low, high = before.mean_pressure / MODULUS, after.mean_pressure / MODULUS
            if low < load < high:
                return of(before) + (of(after) - of(before)) * (load - low) / (high - low)
        raise LookupError(f"{self.name}: the load {load:g} E* is never met")

    def field(self, name: str, load: float) -> NDArray[Any]:
        """Return a field of the state at a load; LookupError if there is no such state."""
        k = self.index_of(load)
        if k is None:
            raise LookupError(f"{self.name}: no state at {load:g} E*")
        return self.result.fields[f"{name}_{k}"]

    def index_of(self, load: float) -> int | None:
        """Return the index of the target at a load; None if an instability jumps over the load."""
        for k, state in enumerate(self.result.targets):
            if abs(state.mean_pressure / MODULUS - load) < SAME_LOAD:
                return k
        return None


@dataclass(frozen=True, eq=False)
class Evidence:
    """Computed members of the ensemble, by purpose."""

    size: Size  # what was asked for
    loading: tuple[Realisation, ...]  # realisations that reached the highest load
    short: tuple[Realisation, ...]  # realisations that ended below the highest load
    shapes: Realisation | None
    high_load: Realisation | None
    hurst: dict[float, tuple[Realisation, ...]]
    faint: tuple[tuple[Realisation, ...], ...]  # of every seed that is whole: one for each of FAINT_WORKS
    sketch: Realisation | None
    missing: dict[str, str]  # members without a result, and why

    @property
    def shortfall(self) -> str:
        """Reason why the ensemble differs from the paper's; empty if it does not."""
        if self.size != PAPER:
            return f"short form: {len(self.loading)} realisations with {self.size.harmonics} harmonics"
        if len(self.loading) < self.size.seeds:
            return f"only {len(self.loading)} of {self.size.seeds} realisations reached {LOADS[-1]:g} E*"
        return ""

    def statement(
        self,
        where: str,
        quantity: str,
        ours: tuple[float, float],
        printed: float,
        allowed: float,
        alternative: float | None = None,
        note: str = "",
        **kind: bool,
    ) -> Statement:
        """Return a statement that rests on the ensemble; `ours` is a number and its standard error."""
        return Statement(
            where, quantity, printed, ours[0], 2 * ours[1], allowed, alternative, note, self.shortfall, **kind
        )

    def jumped(self) -> int:
        """Count the loads of `LOADS` that realisations jump over; `value_at` interpolates at these loads."""
        return sum(realisation.index_of(load) is None for realisation in self.loading for load in LOADS)

    @cached_property
    def lines(self) -> DiscreteSpectrum:
        """Spectrum that all profiles of the loading ensemble share."""
        return self.loading[0].lines

    @cached_property
    def with_adhesion(self) -> dict[float, AdhesiveContact]:
        """Persson's theory with adhesion at every load of `LOADS`."""
        return {load: theory_with_adhesion(self.loading[0], load) for load in LOADS}

    @cached_property
    def without_adhesion(self) -> dict[float, NonadhesiveContact]:
        """Persson's theory without adhesion at every load of `LOADS`."""
        solid = self.loading[0].result.scene["solid"]
        return {load: solve_nonadhesive(self.lines, load * MODULUS, **solid) for load in LOADS}

    def with_fields_at(self, load: float) -> tuple[Realisation, ...]:
        """Return the realisations that have a state at a load, for spectra and distributions."""
        return tuple(realisation for realisation in self.loading if realisation.index_of(load) is not None)

    def against_load(
        self, of: Callable[[State], float], predicted: Callable[[AdhesiveContact | NonadhesiveContact], float | None]
    ) -> "LoadCurve":
        """Return a number of the states, and its value by both theories, at `LOADS`."""
        values = np.array([[realisation.value_at(load, of) for load in LOADS] for realisation in self.loading])
        theories = (self.with_adhesion, self.without_adhesion)
        wet, dry = (np.array([predicted(theory[load]) for load in LOADS], dtype=np.float64) for theory in theories)
        return LoadCurve(values, *mean_and_error(values), wet, dry)


@dataclass(frozen=True, eq=False)
class LoadCurve:
    """A number at `LOADS`: of every realisation, (n_realisations, n_loads), and of both theories, (n_loads,)."""

    values: FloatArray
    mean: FloatArray
    error: FloatArray  # standard
    wet: FloatArray  # the theory with adhesion
    dry: FloatArray


def theory_with_adhesion(realisation: Realisation, load: float, detached_width: float = 1.0) -> AdhesiveContact:
    """Solve Persson's theory for the lines of a profile, from the raw constants of its scene.

    A `detached_width` of 1/f^2 multiplies the detachment stress by f.
    """
    scene = realisation.result.scene
    work = scene["adhesion"]["work_of_adhesion"]
    contact = solve(
        realisation.lines, load * MODULUS, work_of_adhesion=work, detached_width=detached_width, **scene["solid"]
    )
    assert isinstance(contact, AdhesiveContact)
    return contact


def mean_over_period(realisation: Realisation, k: int, values: FloatArray) -> float:
    """Return the mean of values at the places of shape k, by the trapezoidal rule around the period."""
    x, period = realisation.result.fields[f"x_{k}"], float(realisation.result.scene["profile"]["period"])
    return float(np.trapezoid(np.append(values, values[0]), np.append(x, x[0] + period)) / period)


def mean_and_error(values: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the mean over the first axis and its standard error.

    Examples
    --------
    >>> mean, error = mean_and_error([[1.0], [3.0]])
    >>> float(mean[0]), float(error[0])
    (2.0, 1.0)
    """
    array = np.asarray(values, dtype=np.float64)
    return array.mean(axis=0), array.std(axis=0, ddof=1) / np.sqrt(len(array))


def jackknife(quantity: Callable[[FloatArray], float], values: ArrayLike) -> tuple[float, float]:
    """Return a quantity of the mean over the first axis, and its standard error.

    Examples
    --------
    >>> value, error = jackknife(lambda mean: float(mean[0]), [[1.0], [3.0]])
    >>> round(value, 12), round(error, 12)
    (2.0, 1.0)
    """
    array = np.asarray(values, dtype=np.float64)
    n = len(array)
    total = array.sum(axis=0)
    without = np.array([quantity((total - value) / (n - 1)) for value in array])
    return quantity(total / n), float(np.sqrt((n - 1) / n * np.sum((without - without.mean()) ** 2)))


def estimate(values: ArrayLike) -> tuple[float, float]:
    """Return the mean over realisations of one number of each, and its standard error.

    Examples
    --------
    >>> estimate([1.0, 3.0])
    (2.0, 1.0)
    """
    mean, error = mean_and_error(values)
    return float(mean), float(error)


def joined(curves: Sequence[tuple[Sequence[float], Sequence[float]]]) -> tuple[list[float | None], list[float | None]]:
    """Join curves to one series, with gaps between them."""
    x: list[float | None] = []
    y: list[float | None] = []
    for a, b in curves:
        x += [*map(float, a), None]
        y += [*map(float, b), None]
    return x[:-1], y[:-1]


def scattered(
    curves: Sequence[tuple[Sequence[float], Sequence[float]]],
    x: Sequence[float],
    values: ArrayLike,
    each: str = "realisations",
    name: str = "",
    hue: int | None = None,
) -> list[Series]:
    """Return series of every realisation, thin, and of mean and standard error of `values` (n_realisations, n) at x."""
    mean, error = mean_and_error(values)
    return [
        trace(f"{name}{each}", *joined(curves), "thin", hue=hue),
        shaded(f"{name}mean and standard error", x, mean - error, mean + error, hue or 0),
        marks(f"{name}mean", x, mean, hue=hue or 0),
    ]
