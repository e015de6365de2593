"""The theory and its corrections on the hold-out: errors of area, separation and distribution, before and after.

At every load of every group: the ensemble means with their standard errors, the plain theory, the calibrated
correction, and the corrections of the literature (area alone; with adhesion without the drift).  Raw E, nu, lines,
loads and work of adhesion go to the theory, which derives the rest itself.

Distribution: largest distance between the shares of the period at a pressure above sigma, over the contact fraction;
without adhesion sigma >= 0, with it sigma >= -0.3 E*.  Loads in units of E*, separations in rms heights.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import persson
from persson.corrected_variance import LITERATURE, Correction
from persson.spectrum import DiscreteSpectrum
from validation.harness.arrays import FloatArray
from validation.harness.execution import Note
from validation.references.paper_problem import MODULUS, POISSON_RATIO, YOUNGS_MODULUS
from validation.studies.theory_correction.data import STRESSES, Observed

PLAIN, CALIBRATED = "plain", "calibrated"
WITH_ADHESION = ("yang_persson_2008", "wang_muser_2017", "xu_2024")  # a drift in every iteration costs minutes
COARSE = 0.4  # resolution of the plain theory with adhesion: 1e-3 of the area
SOLID: Any = {"youngs_modulus": YOUNGS_MODULUS, "poisson_ratio": POISSON_RATIO}
FINE_STRESSES = np.linspace(-0.5, 1.5, 4001)  # of E*


@dataclass(frozen=True)
class HeldOut:
    """One load of one group; errors are theory / boundary elements - 1, by name of the theory.

    Parameters
    ----------
    area_noise : float
        Relative standard error of the mean area.
    separation : float
        Mean s / h_rms.
    separation_noise : float
        Standard error of it.
    area, separations, distribution : dict of str to float
        Error of the area; s / h_rms; distance of the distributions.
    distribution_noise : float
        Largest standard error of the mean share, over the area.
    """

    group: str
    kind: str
    hurst: float
    harmonics: int
    theta: float
    load: float
    realisations: int
    contact_fraction: float
    area_noise: float
    separation: float
    separation_noise: float
    area: dict[str, float]
    separations: dict[str, float]
    distribution: dict[str, float]
    distribution_noise: float
    remark: str = ""

    @property
    def adhesive(self) -> bool:
        """With adhesion or without."""
        return self.theta > 0

    def error(self, quantity: str, theory: str) -> float:
        """Of the area, relative; of the separation, over at least a tenth of the rms height; of the distribution."""
        if quantity == "separation":
            return (self.separations.get(theory, np.nan) - self.separation) / max(self.separation, 0.1)
        return (self.area if quantity == "area" else self.distribution).get(theory, np.nan)


@dataclass(frozen=True)
class Said:
    """What a theory says at one load: A/A0, s / h_rms, shares above `STRESSES`; nan for what was not asked."""

    area: float
    separation: float = np.nan
    share: FloatArray | None = None
    status: str = "converged"


def judge(
    one: Observed, noise: FloatArray, correction: Correction, report: Callable[[Note], None], plain_only: bool = False
) -> list[HeldOut]:
    """All loads of a group at which there is a realisation.

    Parameters
    ----------
    one : Observed
    noise : (n_loads,) array
        Relative standard errors of the mean area.
    correction : Correction
        The calibrated one.
    report : callable
    plain_only : bool
        Leave out the corrections of the literature.
    """
    found = []
    group = one.group
    lines = group.lines
    for column, load in enumerate(group.loads):
        count = int(one.counts[column])
        if count == 0:
            continue
        said = {
            PLAIN: _plain(lines, load, group.work_of_adhesion, lines.h_rms),
            CALIBRATED: _corrected(lines, load, group.work_of_adhesion, lines.h_rms, correction),
        }
        if not plain_only:
            for name, other in LITERATURE.items():
                if group.theta == 0 or name in WITH_ADHESION:
                    said[name] = _literature(lines, load, group.work_of_adhesion, other)
        reached = one.separations[:, column][np.isfinite(one.separations[:, column])]
        lowest = -1.0 if group.theta > 0 else 0.0
        kept = lowest <= STRESSES
        area = float(one.area[column])
        shares = one.shares[np.isfinite(one.areas[:, column]), column][:, kept]
        scatter = shares.std(axis=0, ddof=1) / np.sqrt(count) if count > 1 else np.full(int(kept.sum()), np.nan)
        found.append(
            HeldOut(
                group.name,
                group.kind,
                group.hurst,
                group.harmonics,
                group.theta,
                load,
                count,
                area,
                float(noise[column]),
                float(reached.mean()),
                float(reached.std(ddof=1) / np.sqrt(count)) if count > 1 else np.nan,
                {name: value.area / area - 1 for name, value in said.items()},
                {name: value.separation for name, value in said.items() if np.isfinite(value.separation)},
                {
                    name: float(np.max(np.abs(value.share - one.share[column])[kept]) / area)
                    for name, value in said.items()
                    if value.share is not None
                },
                float(np.max(scatter) / area),
                "; ".join(f"{name}: {v.status}" for name, v in said.items() if v.status != "converged"),
            )
        )
    report(Note(f"{group.name}: {len(found)} loads judged"))
    return found


def rms(values: Sequence[float]) -> float:
    """Root mean square of what is a number; nan without any.

    Examples
    --------
    >>> rms([3.0, 4.0, float("nan")])
    3.5355339059327378
    """
    known = np.array([value for value in values if np.isfinite(value)])
    return float(np.sqrt(np.mean(known**2))) if known.size else np.nan


def rms_of(judged: Sequence[HeldOut], quantity: str, theory: str) -> float:
    """Of the errors of a theory in "area", "separation" or "pressure distribution"."""
    return rms([one.error(quantity, theory) for one in judged])


def theories_of(judged: Sequence[HeldOut]) -> list[str]:
    """Names of the theories that were judged."""
    return list(dict.fromkeys(name for one in judged for name in one.area))


def _plain(lines: DiscreteSpectrum, load: float, work: float | None, height: float) -> Said:
    return _whole(persson.solve(lines, load * MODULUS, **SOLID, work_of_adhesion=work, resolution=COARSE), height)


def _corrected(lines: DiscreteSpectrum, load: float, work: float | None, height: float, correction: Correction) -> Said:
    asked: Any = {"work_of_adhesion": work, "correction": correction}
    return _whole(persson.corrected.solve(lines, load * MODULUS, **SOLID, **asked), height)


def _literature(lines: DiscreteSpectrum, load: float, work: float | None, correction: Correction) -> Said:
    asked: Any = {"work_of_adhesion": work, "correction": correction, "with_separation": False, "resolution": COARSE}
    found = persson.corrected.solve(lines, load * MODULUS, **SOLID, **asked)
    return Said(found.contact_fraction, status=found.status)


def _whole(found: Any, height: float) -> Said:
    """All that a contact of the theory says."""
    separation = np.nan if found.separation is None else found.separation / height
    return Said(found.contact_fraction, separation, _share(found.pressure_distribution), found.status)


def _share(density: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Share of the nominal area at a pressure above each of `STRESSES`."""
    values = density(FINE_STRESSES * MODULUS) * MODULUS
    steps = (values[1:] + values[:-1]) / 2 * np.diff(FINE_STRESSES)
    above = np.concatenate([np.cumsum(steps[::-1])[::-1], [0.0]])
    return np.asarray(np.interp(STRESSES, FINE_STRESSES, above))
