"""The profiles on which the theory is corrected and judged, as scenes, and what their realisations say.

Every profile is scaled to the rms slope of the paper's, 0.272, so that the loads, 0.001 to 0.05 E*, mean the same
p/(E* h'_rms) for all: without adhesion nothing else of the amplitudes matters.  Adhesion is theta = gamma / U,
U = E* sum q_m h_m^2 / 8 the elastic energy of full contact per nominal area: the paper's 0.03 J/m^2 is theta = 0.027.

fit        H 0.3, 0.5, 0.7, 0.9; 30 to 1000 harmonics; no adhesion, which has a fit of its own (adhesive_edges.py)
hold-out   other H, other bandwidth, other seeds, other loads, theta to 0.06: self-affine; with a roll-off (equal
           heights up to order 16, then H = 0.8); not fractal (a Gaussian power spectrum, h_m ~ exp(-(m/40)^2/2); eight
           lines a factor 1.8 apart)

The split is this file: nothing of the hold-out enters a fit.  Large profiles have fewer realisations, the largest one,
without adhesion: cost grows as bandwidth^1.5 and more, and 3000 harmonics would take hours.  Source of the paper's
profile: Carbone, Scaraggi, Tartaglino, Eur. Phys. J. E 30 (2009) 65, arXiv:1006.0601.  Half-space, plane strain,
loading from first touch, no slope term.

What they say: area, separation, distribution, with their errors.  A realisation counts at the loads it has a state at;
with adhesion an instability may carry it across one, and a path may end in complete contact.  The share of the period
in contact at a pressure above sigma comes from the exact shares of the solver's own bins.  Loads and stresses in units
of E*, heights in rms heights.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.scene.result import Result
from persson.spectrum import DiscreteSpectrum
from validation.harness.arrays import FloatArray
from validation.harness.ensemble import Member, member_seed
from validation.references import paper_problem
from validation.references.paper_problem import MODULUS
from validation.studies.contact_slope import lines_of, shape_of

FIT_LOADS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.03, 0.05)  # of E*
HOLD_OUT_LOADS = (0.0015, 0.003, 0.007, 0.014, 0.025, 0.04)
FIT_ROOT, HOLD_OUT_ROOT = 820, 821  # of the seeds
LINES = (1, 2, 3, 6, 10, 19, 34, 61)
DEEPEST = 1e-4  # separation in rms heights: the load stops the path long before


@dataclass(frozen=True)
class Group:
    """Realisations that differ in their phases alone."""

    part: str  # "fit" or "hold-out"
    kind: str  # "self-affine", "roll-off", "gaussian" or "lines"
    hurst: float  # nan where the spectrum has none
    harmonics: int  # the highest order
    theta: float  # work of adhesion over the elastic energy of full contact; 0 for none
    realisations: int

    @property
    def name(self) -> str:
        """Of its members, without their number."""
        exponent = "" if np.isnan(self.hurst) else f"-H{self.hurst:g}"
        return f"{self.part}-{self.kind}{exponent}-M{self.harmonics}-t{self.theta:g}"

    @property
    def loads(self) -> tuple[float, ...]:
        """Over E*."""
        return FIT_LOADS if self.part == "fit" else HOLD_OUT_LOADS

    @property
    def spectrum(self) -> dict[str, Any]:
        """As contact_slope.py takes it."""
        roll_off, breadth = 16, 40.0
        given = {
            "self-affine": [self.hurst, self.harmonics],
            "roll-off": [roll_off, self.hurst, self.harmonics],
            "gaussian": [breadth, self.harmonics],
            "lines": [LINES, 1.1],
        }
        return {"spectrum": self.kind, "parameters": given.get(self.kind, [1])}

    @property
    def lines(self) -> DiscreteSpectrum:
        """Of the rms slope that all share."""
        return lines_of(self.spectrum)

    @property
    def work_of_adhesion(self) -> float | None:
        """In J/m^2; None without adhesion."""
        return self.theta * MODULUS * self.lines.full_contact_energy if self.theta else None

    def member(self, k: int) -> Member:
        """Realisation k: from first touch to the highest load; without adhesion, with no path to follow, by loads."""
        seed = member_seed(FIT_ROOT if self.part == "fit" else HOLD_OUT_ROOT, k)
        orders, amplitudes = shape_of(self.spectrum)[0], self.lines.amplitudes
        phases = np.random.default_rng(seed).uniform(-np.pi, np.pi, orders.size)
        pressures = [load * MODULUS for load in self.loads]
        loading = {"control": "mean_pressure", "targets": pressures}
        if self.theta:
            loading = paper_problem.up_to(pressures, DEEPEST * self.lines.h_rms)
        scene = paper_problem.scene(
            f"theory correction: {self.name}, realisation {k}, seed {seed}",
            paper_problem.lines(orders, amplitudes, phases),
            loading,
            self.work_of_adhesion,
            accuracy={"tolerance": 1e-5},
            output={"pressure_distribution": True},
        )
        return Member(f"{self.name}-{k:02d}", scene)

    def members(self) -> list[Member]:
        """All realisations."""
        return [self.member(k) for k in range(self.realisations)]


def groups(quick: bool = False) -> tuple[Group, ...]:
    """All groups of the study, or a few small ones that show that everything runs."""
    return (*_fit(quick), *_hold_out(quick))


def _fit(quick: bool) -> Iterator[Group]:
    if quick:
        for hurst in (0.5, 0.8):
            yield Group("fit", "self-affine", hurst, 12, 0.0, 4)
        return
    for hurst, (harmonics, realisations) in product((0.3, 0.5, 0.7, 0.9), ((30, 16), (100, 8), (300, 6))):
        yield Group("fit", "self-affine", hurst, harmonics, 0.0, realisations)
    yield Group("fit", "self-affine", 0.7, 1000, 0.0, 1)


def _hold_out(quick: bool) -> Iterator[Group]:
    if quick:
        yield Group("hold-out", "lines", np.nan, LINES[-1], 0.0, 4)
        yield Group("hold-out", "self-affine", 0.6, 16, 0.05, 4)
        return
    for hurst, (harmonics, realisations) in product((0.4, 0.6, 0.8), ((64, 10), (200, 6), (500, 4))):
        yield Group("hold-out", "self-affine", hurst, harmonics, 0.0, realisations)
    for hurst, harmonics, theta, realisations in (
        (0.4, 64, 0.02, 6),
        (0.6, 200, 0.02, 4),
        (0.8, 64, 0.06, 6),
        (0.8, 200, 0.02, 4),
        (0.6, 64, 0.06, 6),
        (0.4, 200, 0.06, 4),
    ):
        yield Group("hold-out", "self-affine", hurst, harmonics, theta, realisations)
    for theta in (0.0, 0.03):
        few = theta > 0
        yield Group("hold-out", "roll-off", 0.8, 256, theta, 2 if few else 6)
        yield Group("hold-out", "gaussian", np.nan, 120, theta, 4 if few else 6)
        yield Group("hold-out", "lines", np.nan, LINES[-1], theta, 6 if few else 12)


STRESSES = np.linspace(-0.3, 0.7, 101)  # of E*, at which shares above are compared
SAME_LOAD = 1e-9  # of E*
FEWEST = 4  # realisations from which a group has a standard deviation of its own


@dataclass(frozen=True, eq=False)
class Observed:
    """One group of realisations; areas and separations are nan where one has no state at a load."""

    group: Group
    areas: FloatArray  # A/A0, (n_realisations, n_loads)
    separations: FloatArray  # s / h_rms, likewise
    shares: FloatArray  # of the period in contact at a pressure above `STRESSES`, (n_realisations, n_loads, n_stresses)
    not_certified: int  # states without a certificate
    commits: tuple[str, ...] = ()  # of the sources that made them

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


def observed(group: Group, results: Sequence[Result]) -> Observed:
    """What the realisations of a group say."""
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
        kind = one.group.part, one.group.theta > 0
        of_kind = [other.group.name for other in ensembles if (other.group.part, other.group.theta > 0) == kind]
        alike = [spreads[name] for name in of_kind if name in spreads]
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
