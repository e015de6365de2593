"""The theory and its corrections on the hold-out: errors of area, separation and distribution, before and after.

At every load of every group: the ensemble means with their standard errors, the plain theory, the calibrated
correction, and the corrections of the literature (area alone; with adhesion without the drift).  Raw E, nu, lines,
loads and work of adhesion go to the theory, which derives the rest itself.

Distribution: largest distance between the shares of the period at a pressure above sigma, over the contact fraction;
without adhesion sigma >= 0, with it sigma >= -0.3 E*.  Loads in units of E*, separations in rms heights.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

import persson
from persson.corrected_variance import LITERATURE, Correction
from validation.harness.arrays import FloatArray
from validation.harness.execution import Listener, Note
from validation.references.paper_problem import MODULUS, POISSON_RATIO, YOUNGS_MODULUS
from validation.studies.theory_correction.correction_members import STRESSES, Group, Observed

PLAIN, CALIBRATED = "plain", "calibrated"
WITH_ADHESION = ("yang_persson_2008", "wang_muser_2017", "xu_2024")  # a drift in every iteration costs minutes
COARSE = 0.4  # resolution of the plain theory with adhesion: 1e-3 of the area
FINE_STRESSES = np.linspace(-0.5, 1.5, 4001)  # of E*


@dataclass(frozen=True)
class HeldOut:
    """One load of one group; errors are theory / boundary elements - 1, by name of the theory."""

    group: str
    kind: str
    hurst: float
    harmonics: int
    theta: float
    load: float
    realisations: int
    contact_fraction: float
    area_noise: float  # relative standard error of the mean area
    separation: float  # mean s / h_rms
    separation_noise: float  # standard error of it
    area: dict[str, float]  # error of it
    separations: dict[str, float]  # s / h_rms
    distribution: dict[str, float]  # distance of the distributions
    distribution_noise: float  # largest standard error of the mean share, over the area
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
    one: Observed, noise: FloatArray, correction: Correction, report: Listener, plain_only: bool = False
) -> list[HeldOut]:
    """All loads of a group at which there is a realisation, by the calibrated correction and those of the literature.

    `noise` are the relative standard errors of the mean area, (n_loads,); `plain_only` leaves out the literature.
    """
    group = one.group
    kept = (-1.0 if group.theta > 0 else 0.0) <= STRESSES
    found = []
    for column, load in enumerate(group.loads):
        there = np.isfinite(one.areas[:, column])
        if not there.any():
            continue
        said = _said(group, load, correction, plain_only)
        area, shares = float(one.area[column]), one.shares[there, column][:, kept]
        separations = one.separations[:, column][np.isfinite(one.separations[:, column])]
        apart = {name: value.share - one.share[column] for name, value in said.items() if value.share is not None}
        found.append(
            HeldOut(
                group.name, group.kind, group.hurst, group.harmonics, group.theta, load, int(one.counts[column]), area,
                float(noise[column]), float(separations.mean()), float(_error(separations)),
                area={name: value.area / area - 1 for name, value in said.items()},
                separations={n: value.separation for n, value in said.items() if np.isfinite(value.separation)},
                distribution={name: float(np.max(np.abs(off)[kept]) / area) for name, off in apart.items()},
                distribution_noise=float(np.max(_error(shares)) / area),
                remark="; ".join(f"{name}: {v.status}" for name, v in said.items() if v.status != "converged"),
            )
        )  # fmt: skip
    report(Note(f"{group.name}: {len(found)} loads judged"))
    return found


def _error(values: FloatArray) -> FloatArray:
    """Standard error of the mean over the first axis; nan of a single value."""
    if len(values) < 2:
        return np.full(values.shape[1:], np.nan)
    return np.asarray(values.std(axis=0, ddof=1) / np.sqrt(len(values)))


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


def _said(group: Group, load: float, correction: Correction, plain_only: bool) -> dict[str, Said]:
    """What the plain theory, the calibrated correction and those of the literature say of a group at a load."""
    lines, at = group.lines, load * MODULUS
    asked: Any = {"youngs_modulus": YOUNGS_MODULUS, "poisson_ratio": POISSON_RATIO}
    asked["work_of_adhesion"] = group.work_of_adhesion
    whole = {
        PLAIN: persson.solve(lines, at, **asked, resolution=COARSE),
        CALIBRATED: persson.corrected.solve(lines, at, **asked, correction=correction),
    }
    said = {}
    for name, found in whole.items():
        separation = np.nan if found.separation is None else found.separation / lines.h_rms
        said[name] = Said(found.contact_fraction, separation, _share(found.pressure_distribution), found.status)
    for name, other in {}.items() if plain_only else LITERATURE.items():
        if group.theta == 0 or name in WITH_ADHESION:
            area = persson.corrected.solve(lines, at, **asked, correction=other, with_separation=False,
                                           resolution=COARSE)  # fmt: skip
            said[name] = Said(area.contact_fraction, status=area.status)
    return said


def _share(density: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Share of the nominal area at a pressure above each of `STRESSES`."""
    values = density(FINE_STRESSES * MODULUS) * MODULUS
    steps = (values[1:] + values[:-1]) / 2 * np.diff(FINE_STRESSES)
    above = np.concatenate([np.cumsum(steps[::-1])[::-1], [0.0]])
    return np.asarray(np.interp(STRESSES, FINE_STRESSES, above))
