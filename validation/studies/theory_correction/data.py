"""What the boundary-element ensembles of the theory correction say: area, separation, distribution, with their errors.

A realisation counts at the loads it has a state at; with adhesion an instability may carry it across one, and a path
may end in complete contact.  The share of the period in contact at a pressure above sigma comes from the exact shares
of the solver's own bins.  Loads and stresses in units of E*, heights in rms heights.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bem.scene.result import Result
from validation.harness.arrays import FloatArray
from validation.harness.ensemble import read_member
from validation.references.paper_problem import MODULUS
from validation.studies.theory_correction.correction_members import Group

STRESSES = np.linspace(-0.3, 0.7, 101)  # of E*, at which shares above are compared
SAME_LOAD = 1e-9  # of E*
FEWEST = 4  # realisations from which a group has a standard deviation of its own


@dataclass(frozen=True, eq=False)
class Observed:
    """One group of realisations.

    Parameters
    ----------
    group : Group
    areas, separations : (n_realisations, n_loads) arrays
        A/A0 and s / h_rms; nan where a realisation has no state at the load.
    shares : (n_realisations, n_loads, n_stresses) array
        Of the period in contact at a pressure above `STRESSES`.
    not_certified : int
        States without a certificate.
    commits : tuple of str
        Of the sources that made them.
    """

    group: Group
    areas: FloatArray
    separations: FloatArray
    shares: FloatArray
    not_certified: int
    commits: tuple[str, ...] = ()

    @property
    def counts(self) -> NDArray[np.int64]:
        """Realisations at each load, (n_loads,)."""
        return np.asarray(np.sum(np.isfinite(self.areas), axis=0), dtype=np.int64)

    @property
    def area(self) -> FloatArray:
        """Mean A/A0, (n_loads,)."""
        return mean_of(self.areas)

    @property
    def separation(self) -> FloatArray:
        """Mean s / h_rms, (n_loads,)."""
        return mean_of(self.separations)

    @property
    def share(self) -> FloatArray:
        """Mean share above each stress, (n_loads, n_stresses)."""
        return mean_of(self.shares)


def mean_of(values: FloatArray) -> FloatArray:
    """Mean over the first axis of what is there; nan where nothing is.

    Examples
    --------
    >>> mean_of(np.array([[1.0, np.nan], [3.0, np.nan]]))
    array([ 2., nan])
    """
    there = np.isfinite(values)
    total, count = np.sum(np.where(there, values, 0.0), axis=0), np.sum(there, axis=0)
    return np.asarray(np.where(count > 0, total / np.maximum(count, 1), np.nan))


def observed(group: Group, folder: Path) -> Observed:
    """A group as it is stored.

    Raises
    ------
    FileNotFoundError, CorruptResultError, OtherSceneError
        A realisation is not there, damaged or that of another scene.
    """
    results = [read_member(member, folder) for member in group.members()]
    size = (len(results), len(group.loads))
    areas, separations = np.full(size, np.nan), np.full(size, np.nan)
    shares = np.full((*size, STRESSES.size), np.nan)
    for row, result in enumerate(results):
        for column, load in enumerate(group.loads):
            place = _index_of(result, load)
            if place is None:
                continue
            state = result.targets[place]
            areas[row, column] = state.contact_fraction
            separations[row, column] = state.separation / group.lines.h_rms
            bounds = result.fields[f"sigma_bounds_{place}"] / MODULUS
            below = np.concatenate([[0.0], np.cumsum(result.fields[f"P_{place}"] * np.diff(bounds) * MODULUS)])
            shares[row, column] = below[-1] - np.interp(STRESSES, bounds, below)
    not_certified = sum(not state.certificate.ok for result in results for state in result.targets)
    commits = tuple(sorted({str(result.provenance.get("commit", "unknown")) for result in results}))
    return Observed(group, areas, separations, shares, not_certified, commits)


def relative_errors(ensembles: Sequence[Observed]) -> Mapping[str, FloatArray]:
    """Relative standard error of the mean area of each group, (n_loads,), by name.

    A group of fewer than `FEWEST` realisations takes the median standard deviation of those that have more, with or
    without adhesion as it has: the fluctuation falls with bandwidth, so that this is on the safe side.
    """
    spreads = {
        one.group.name: np.nanstd(one.areas, axis=0, ddof=1) / one.area
        for one in ensembles
        if len(one.areas) >= FEWEST and np.all(one.counts >= FEWEST)
    }
    errors = {}
    for one in ensembles:
        alike = [
            spreads[other.group.name]
            for other in ensembles
            if other.group.name in spreads
            and other.group.part == one.group.part
            and (other.group.theta > 0) == (one.group.theta > 0)
        ]
        if not alike:
            raise ValueError(f"{one.group.name}: no group like it has {FEWEST} realisations, its error is unknown")
        own = spreads.get(one.group.name, np.median(alike, axis=0))
        errors[one.group.name] = np.asarray(own / np.sqrt(np.maximum(one.counts, 1)))
    return errors


def _index_of(result: Result, load: float) -> int | None:
    """Which target has this load and is a contact with gaps."""
    for place, state in enumerate(result.targets):
        if abs(state.mean_pressure / MODULUS - load) < SAME_LOAD and state.n_patches > 0:
            return place
    return None
