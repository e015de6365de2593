"""Solutions of the ensemble: solved where missing, stored, read; means with their standard errors; the theory.

The result of a member lies in `folder/NAME/` as the solver writes it.  A stored result counts if its checksum holds
and its scene is the member's scene; else the member is solved again.

The standard error of a mean over n realisations is s / sqrt n with the n - 1 standard deviation s.  A quantity taken
from the mean curve, such as a fitted exponent, has the jackknife's: the curve without realisation k gives t_k, and the
error is sqrt((n - 1) / n sum (t_k - mean t)^2).  Loads in units of E*, lengths in m, pressures in Pa.

Source of the jackknife: B. Efron, C. Stein, Ann. Statist. 9 (1981) 586, doi:10.1214/aos/1176345462.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import bem
import persson
from bem.geometry.profile import Profile
from bem.loading.crew import at_work
from bem.scene.digest import digest
from bem.scene.result import Result
from bem.scene.result_file import read_result, write_result
from bem.scene.state import State
from bem.scene.stored_json import CorruptResultError
from bem.scene.surface import surface_of
from persson import AdhesiveContact, DiscreteSpectrum, NonadhesiveContact
from validation.harness.arrays import FloatArray
from validation.paper.members import LOADS, PAPER, Member, Size, members_of
from validation.references.paper_problem import MODULUS, POISSON_RATIO, WORK_OF_ADHESION, YOUNGS_MODULUS

SAME_LOAD = 1e-9  # of E*
SOLID: dict[str, Any] = {"youngs_modulus": YOUNGS_MODULUS, "poisson_ratio": POISSON_RATIO}


@dataclass(frozen=True, eq=False)
class Realisation:
    """Member with its result."""

    name: str
    result: Result

    @cached_property
    def profile(self) -> Profile:
        """The profile, SI units."""
        return surface_of(self.result.scene["profile"], None)

    @property
    def final_load(self) -> float:
        """Highest load reached."""
        return max((state.mean_pressure for state in self.result.states), default=0.0) / MODULUS

    def target_at(self, load: float) -> int | None:
        """Return the index of the target at a load; None if an instability jumps over the load."""
        loads = [state.mean_pressure / MODULUS for state in self.result.targets]
        return next((k for k, reached in enumerate(loads) if abs(reached - load) < SAME_LOAD), None)

    def value_at(self, load: float, of: Callable[[State], float]) -> float:
        """Return a number of the state at a load; interpolate linearly if the load is jumped over."""
        k = self.target_at(load)
        if k is not None:
            return of(self.result.targets[k])
        for before, after in pairwise(self.result.states):
            low, high = before.mean_pressure / MODULUS, after.mean_pressure / MODULUS
            if low < load < high:
                return of(before) + (of(after) - of(before)) * (load - low) / (high - low)
        raise LookupError(f"{self.name}: the load {load:g} E* is never met")

    def field(self, name: str, load: float) -> NDArray[Any]:
        """Return a field of the state at a load; LookupError if there is no such state."""
        k = self.target_at(load)
        if k is None:
            raise LookupError(f"{self.name}: no state at {load:g} E*")
        return self.result.fields[f"{name}_{k}"]


@dataclass(frozen=True, eq=False)
class Ensemble:
    """Realisations by group (members.py), and the theory for the lines that the loading ensemble shares."""

    size: Size
    groups: Mapping[str, Sequence[Realisation]]
    missing: Mapping[str, str]  # members without a result, and why

    @cached_property
    def loading(self) -> list[Realisation]:
        """Realisations of the loading ensemble that reached the highest load."""
        return [member for member in self.groups["loading"] if member.final_load >= LOADS[-1] * (1 - 1e-9)]

    @property
    def shortfall(self) -> str:
        """Reason why the ensemble differs from the paper's; empty if it does not."""
        if self.size != PAPER:
            return f"short form: {len(self.loading)} realisations with {self.size.harmonics} harmonics"
        if len(self.loading) < self.size.seeds:
            return f"only {len(self.loading)} of {self.size.seeds} realisations reached {LOADS[-1]:g} E*"
        return ""

    @property
    def everything(self) -> list[Realisation]:
        """All realisations, group by group."""
        return [realisation for group in self.groups.values() for realisation in group]

    def whole(self, name: str) -> Sequence[Realisation] | None:
        """Return the realisations of a group; None if one of its members has no result."""
        planned, group = members_of(self.size)[name], self.groups[name]
        return group if len(group) == len(planned) else None

    def at_loads(self, of: Callable[[State], float]) -> FloatArray:
        """Return a number of the states at `LOADS`, (n_realisations, n_loads)."""
        return np.array([[realisation.value_at(load, of) for load in LOADS] for realisation in self.loading])

    def fields(self, name: str, load: float) -> FloatArray:
        """Return a field at a load, (n_realisations, n); realisations that jump over the load are left out."""
        members = [realisation for realisation in self.loading if realisation.target_at(load) is not None]
        return np.array([realisation.field(name, load) for realisation in members])

    @cached_property
    def lines(self) -> DiscreteSpectrum:
        """Spectrum that all profiles of the loading ensemble share."""
        return DiscreteSpectrum.of_profile(self.loading[0].profile)

    @cached_property
    def wet(self) -> dict[float, AdhesiveContact]:
        """Persson's theory with adhesion at every load of `LOADS`."""
        return {load: theory_with_adhesion(self.lines, load) for load in LOADS}

    @cached_property
    def dry(self) -> dict[float, NonadhesiveContact]:
        """Persson's theory without adhesion at every load of `LOADS`."""
        return {load: persson.solve_nonadhesive(self.lines, load * MODULUS, **SOLID) for load in LOADS}


def theory_with_adhesion(lines: DiscreteSpectrum, load: float, detached_width: float = 1.0) -> AdhesiveContact:
    """Solve Persson's theory for the paper's solid; a `detached_width` of 1/f^2 multiplies the detachment stress by f.

    Raises
    ------
    TypeError
        If the theory has no adhesion.
    """
    contact = persson.solve(
        lines, load * MODULUS, work_of_adhesion=WORK_OF_ADHESION, detached_width=detached_width, **SOLID
    )
    if not isinstance(contact, AdhesiveContact):
        raise TypeError(f"theory with adhesion: {type(contact).__name__}")
    return contact


def read_member(member: Member, folder: Path) -> Result | None:
    """Read the stored result of a member; None where it is missing, damaged, or of another scene."""
    try:
        result = read_result(folder / member.name)
    except (FileNotFoundError, CorruptResultError):
        return None
    scene = digest(bem.parse_scene(member.scene).resolved())
    return result if result.provenance.get("scene_sha256") == scene else None


def solve_members(members: Iterable[Member], folder: Path, jobs: int, say: Callable[[str], None]) -> dict[str, str]:
    """Solve and store members that are missing; return the outcome of each by name: its status, or a reason."""
    planned = list(members)
    missing = [member for member in planned if read_member(member, folder) is None]
    if len(missing) < len(planned):
        say(f"{len(planned) - len(missing)} of {len(planned)} members are stored already")
    outcomes: dict[str, str] = {}
    with at_work(max(min(jobs, len(missing)), 1), folder) as each:
        for member, outcome in zip(missing, each(solve_member, missing), strict=True):
            outcomes[member.name] = outcome
            say(f"[{len(outcomes)}/{len(missing)}] {member.name}: {outcome}")
    return outcomes


def solve_member(folder: Path, member: Member) -> str:
    """Solve and store a member; return its status, or why it has no result."""
    try:
        result = bem.solve(dict(member.scene))
    except (ValueError, ArithmeticError, MemoryError, RuntimeError) as error:
        return f"{type(error).__name__}: {error}"
    write_result(result, folder / member.name)
    return result.status


def read_ensemble(size: Size, folder: Path, outcomes: Mapping[str, str]) -> Ensemble:
    """Read the stored members of a size; members without a result are named with the reason."""
    planned = members_of(size)
    read = {member.name: read_member(member, folder) for members in planned.values() for member in members}
    missing = {name: outcomes.get(name, "no result is stored") for name, result in read.items() if result is None}
    groups = {
        group: [Realisation(member.name, result) for member in members if (result := read[member.name]) is not None]
        for group, members in planned.items()
    }
    return Ensemble(size, groups, missing)


def estimate(values: ArrayLike) -> tuple[Any, Any]:
    """Return the mean over the first axis, and its standard error."""
    array = np.asarray(values, dtype=np.float64)
    return array.mean(axis=0), array.std(axis=0, ddof=1) / np.sqrt(len(array))


def jackknife(quantity: Callable[[FloatArray], float], values: ArrayLike) -> tuple[float, float]:
    """Return a quantity of the mean over the first axis, and its standard error."""
    array = np.asarray(values, dtype=np.float64)
    n, total = len(array), array.sum(axis=0)
    without = np.array([quantity((total - value) / (n - 1)) for value in array])
    return quantity(total / n), float(np.sqrt((n - 1) / n * np.sum((without - without.mean()) ** 2)))
