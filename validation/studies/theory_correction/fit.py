"""The calibration: three coefficients of persson's corrected theory by least squares on the fit ensembles.

c_0, b_0 and k (persson/corrected_variance.py), without adhesion: residuals ln(A_theory / A_bem) over the relative
standard error of the mean, with a floor for what the closure itself may miss.  Standard errors by a jackknife over the
Hurst exponents: each is left out in turn, which counts the error of the closure as well as the noise, realisations of
different H sharing their phases.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from persson import corrected
from persson.corrected_variance import Correction, area_at, diffused
from persson.diffusion import SAFE
from persson.magnification import magnification_mesh
from validation.harness.arrays import FloatArray
from validation.studies.theory_correction.correction_members import Group, Observed, relative_errors

NAMES = ("c_0", "b_0", "k")
START = (0.8, 1.0, 1.5)
LOWEST, HIGHEST = (0.1, 0.0, 0.05), (0.999, 5.0, 20.0)
FLOOR = 0.015  # relative error of the closure that the weights allow for
STEP = 1e-3  # of the difference quotients
GROWTH = 0.04  # of the mesh: 3e-5 of the area


@dataclass(frozen=True)
class Calibration:
    """Coefficients by name, their standard errors, and how well they fit."""

    values: dict[str, float]
    errors: dict[str, float]
    chi_square: dict[str, float]
    rms: dict[str, float]


def correction_from(values: ArrayLike) -> Correction:
    """The calibrated closure with these coefficients, in the order of `NAMES`.

    Examples
    --------
    >>> correction_from(START).window
    1.5
    """
    first, breadth, window = np.asarray(values, dtype=np.float64).tolist()
    return Correction("calibrated", "slower", (first, 0.0, 1 - first), breadth=breadth, window=window, edges=True)


def areas_of(group: Group, correction: Correction) -> FloatArray:
    """A/A0 by the factor of a correction, without adhesion, at the loads of a group, (n_loads,)."""
    alone, material = replace(correction, edges=False), {"youngs_modulus": 1.0, "poisson_ratio": 0.0}  # E* = 1 Pa
    states = (
        corrected.solve(group.lines, load, correction=alone, **material, with_separation=False) for load in group.loads
    )
    return np.array([state.contact_fraction for state in states])


def calibrate(ensembles: Sequence[Observed]) -> Calibration:
    """Coefficients from the groups of the fit.

    ValueError for a group of the hold-out or with adhesion, and for fewer than two Hurst exponents, ArithmeticError
    where the least squares do not converge.
    """
    held = [one.group.name for one in ensembles if one.group.part != "fit" or one.group.theta > 0]
    if held:
        raise ValueError(f"held out or with adhesion, not to be fitted: {', '.join(held)}")
    hursts = sorted({one.group.hurst for one in ensembles})
    if len(hursts) < 2:
        raise ValueError(f"ensembles: at least two Hurst exponents are needed, not {hursts}")
    errors = relative_errors(ensembles)
    best = fitted(ensembles, errors, START)
    without = np.array([fitted([o for o in ensembles if o.group.hurst != h], errors, best) for h in hursts])
    count = len(hursts)
    spread = np.sqrt((count - 1) / count * np.sum((without - without.mean(axis=0)) ** 2, axis=0))
    pairs = [(one, areas_of(one.group, correction_from(best))) for one in ensembles]
    weighted = np.concatenate([_weighted(one, errors, area) for one, area in pairs])
    misses = np.concatenate([np.log(area / one.area)[np.isfinite(one.area)] for one, area in pairs])
    return Calibration(
        dict(zip(NAMES, map(float, best), strict=True)),
        dict(zip(NAMES, map(float, spread), strict=True)),
        {"without adhesion": float(np.mean(weighted**2))},
        {"without adhesion": float(np.sqrt(np.mean(misses**2)))},
    )


def fitted(ensembles: Sequence[Observed], errors: Mapping[str, FloatArray], start: ArrayLike) -> FloatArray:
    """The three coefficients, (3,), from a start, with relative standard errors (n_loads,) by name of group."""
    meshed = []
    for group in (one.group for one in ensembles):
        mesh = magnification_mesh(group.lines, 4 * (min(group.loads) / SAFE) ** 2 * 0.99, 1 + GROWTH)
        meshed.append((np.array(group.loads), mesh))

    def residual(trial: FloatArray) -> FloatArray:
        correction = correction_from(trial)
        areas = (area_at(loads, diffused(correction, mesh, loads)[:, -1]) for loads, mesh in meshed)
        return np.concatenate([_weighted(one, errors, area) for one, area in zip(ensembles, areas, strict=True)])

    found = least_squares(residual, start, bounds=(LOWEST, HIGHEST), diff_step=STEP, xtol=1e-5, ftol=1e-7)
    if not found.success:
        raise ArithmeticError(f"calibration: {found.message}")
    return np.asarray(found.x)


def _weighted(one: Observed, errors: Mapping[str, FloatArray], area: FloatArray) -> FloatArray:
    there = np.isfinite(one.area)
    return np.asarray((np.log(area / one.area) / np.hypot(errors[one.group.name], FLOOR))[there])
