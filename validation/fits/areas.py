"""Fit the laws of `persson.contact_area` to ensembles, and judge them on a hold-out; run by hand.

    python -m validation.fits.areas dry --jobs 2               # the fit, 2274 realisations, and the hold-out, 1710
    python -m validation.fits.areas wet --jobs 2               # the fit and the hold-out, 368 realisations; hours
    python -m validation.fits.areas dry --hold-out --seed 7    # the hold-out alone, with a seed root of your own

Both fits minimise ln(A_law / A_ensemble) over the standard error of the ensemble and a floor, inside the domain; the
dry fit at all contact fractions from `LEAST`.  With adhesion every realisation is solved without it too, on the same
phases, and the law takes the dry area from the ensemble: p_d(A) is moved onto its mean, so that noise and errors that
both share cancel; the error is then the jackknife's of the ratio wet / dry.  The hold-out judges `persson.contact_area`
as it is; it has other spectra, loads, seeds and works of adhesion, and enters no fit.  Prints coefficients beside the
package's, and the rms error and noise of the hold-out; `--out` writes its areas
(tests/validation/hold_out_dry.csv and hold_out_wet.csv).
"""

import argparse
import csv
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

import persson
from persson.adhesive_edges import COEFFICIENTS as WET
from persson.adhesive_edges import EdgeLaw
from persson.contact_slope import COEFFICIENTS as DRY
from persson.contact_slope import contact_fractions
from persson.fitted_area import WET_DOMAIN, numbers_of, reasons_outside
from validation.fits.ensembles import Group, Plan, read_plan, solve_groups
from validation.harness.arrays import FloatArray
from validation.references.paper_problem import MODULUS, POISSON_RATIO, RMS_SLOPE, YOUNGS_MODULUS

LEAST = {"dry": 0.02, "wet": 0.05}  # contact fractions that count
FLOOR = {"dry": 0.015, "wet": 0.02}  # of the relative errors


@dataclass(frozen=True)
class Means:
    """Mean areas of one group, with and without adhesion, and relative standard errors; (n,) arrays over the loads."""

    group: Group
    theta: float
    loads: FloatArray
    area: FloatArray
    error: FloatArray
    dry: FloatArray
    ratio_error: FloatArray

    def judged(self) -> FloatArray:
        """Return ln(A_law / A_ensemble) of `persson.contact_area`, the noise, 1 in the domain, and A, (4, n)."""
        lines, columns = self.group.lines, []
        work = self.theta * MODULUS * lines.full_contact_energy or None
        solid = {"youngs_modulus": YOUNGS_MODULUS, "poisson_ratio": POISSON_RATIO}
        for load, area, error in zip(self.loads, self.area, self.error, strict=True):
            law = persson.contact_area(lines, load * RMS_SLOPE * MODULUS, work_of_adhesion=work, **solid)
            columns.append((np.log(law.contact_fraction / area), error, law.status == "in_domain", area))
        return np.array(columns, dtype=np.float64).reshape(-1, 4).T

    def wet_law(self, coefficients: Mapping[str, float]) -> FloatArray:
        """Return A/A0 by the law with p_d(A) moved, in ln p, onto the dry areas of the ensemble, (n,)."""
        lines = self.group.lines
        law = EdgeLaw(lines, self.theta * lines.full_contact_energy, coefficients)
        pressed = self.loads * lines.slope_rms
        grid = np.geomspace(0.2 * pressed[0], 5 * pressed[-1], 2000)
        area = contact_fractions(lines, grid)
        at_dry = np.exp(np.interp(np.log(self.dry), np.log(area), np.log(grid)))
        moved = grid * np.exp(np.interp(np.log(area), np.log(self.dry), np.log(pressed / at_dry)))
        partial = area < 1 - 1e-9
        moved, area = moved[partial], area[partial]
        load = moved - law.tension(moved, area)
        top = int(np.argmax(load)) + 1
        return np.interp(pressed, np.maximum.accumulate(load[:top]), area[:top])


def means_of(group: Group, theta: float, loads: FloatArray, areas: FloatArray, dry: FloatArray) -> Means:
    """Return the means of areas (n_realisations, n_loads), errors by the jackknife, at loads where all have one."""
    known = np.isfinite(areas.mean(0))
    mine, free = areas[:, known], dry[:, known]
    with_it, without = (np.log([np.delete(side, i, 0).mean(0) for i in range(len(side))]) for side in (mine, free))
    error, of_ratio = (np.sqrt((len(mine) - 1) * np.var(logs, axis=0)) for logs in (with_it, with_it - without))
    return Means(group, theta, loads[known], mine.mean(0), error, free.mean(0), of_ratio)


def observe(plan: Plan, jobs: int) -> list[Means]:
    """Solve the ensembles of a plan: without adhesion, and with each of its works of adhesion."""
    dry, means = dict[str, FloatArray](), []
    for theta in (0.0, *plan.thetas):
        for group, areas in solve_groups(plan, theta, jobs):
            print(f"{group.name}, theta {theta:g}: {len(areas)} realisations", file=sys.stderr)
            free = dry.setdefault(group.name, areas)
            if theta or not plan.thetas:
                means.append(means_of(group, theta, plan.loads, areas, free))
    return means


def fit_dry(means: Sequence[Means]) -> dict[str, float]:
    """Return the five coefficients of persson/contact_slope.py."""

    def residual(coefficients: Mapping[str, float]) -> FloatArray:
        errors = []
        for of in means:
            law = contact_fractions(of.group.lines, of.loads * RMS_SLOPE, coefficients)
            errors.append((np.log(law / of.area) / np.hypot(of.error, FLOOR["dry"]))[of.area > LEAST["dry"]])
        return np.concatenate(errors)

    return _fitted(DRY, residual, 1e-3, 1e-6)


def fit_wet(means: Sequence[Means]) -> dict[str, float]:
    """Return the two coefficients of persson/adhesive_edges.py."""

    def inside(of: Means) -> list[bool]:
        lines, work = of.group.lines, of.theta * of.group.lines.full_contact_energy
        cases = (numbers_of(lines, p * RMS_SLOPE, a, work) for p, a in zip(of.loads, of.area, strict=True))
        return [not reasons_outside(WET_DOMAIN, case) for case in cases]

    counted = [inside(of) for of in means]

    def residual(coefficients: Mapping[str, float]) -> FloatArray:
        errors = [np.log(of.wet_law(coefficients) / of.area) / np.hypot(of.ratio_error, FLOOR["wet"]) for of in means]
        return np.concatenate([error[chosen] for error, chosen in zip(errors, counted, strict=True)])

    return _fitted(WET, residual, 1e-2, 1e-4)


def _fitted(
    start: Mapping[str, float], residual: Callable[[Mapping[str, float]], FloatArray], step: float, tolerance: float
) -> dict[str, float]:
    """Return the coefficients of least squares, from the package's; ArithmeticError without convergence."""

    def of_values(values: FloatArray) -> FloatArray:
        return residual(dict(zip(start, values.tolist(), strict=True)))

    answer = least_squares(of_values, list(start.values()), diff_step=step, xtol=tolerance, ftol=tolerance / 100)
    if not answer.success:
        raise ArithmeticError(answer.message)
    return dict(zip(start, map(float, answer.x), strict=True))


def main() -> None:
    """Run the fit and the hold-out."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("law", choices=("dry", "wet"))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--hold-out", action="store_true", help="without the fit")
    parser.add_argument("--seed", type=int, help="root of the seeds of the hold-out; default: that of plans.json")
    parser.add_argument("--out", type=Path, help="CSV for the areas of the hold-out")
    options = parser.parse_args()
    packaged, fit = (DRY, fit_dry) if options.law == "dry" else (WET, fit_wet)
    if not options.hold_out:
        plan = read_plan(options.law, "fit")
        for name, value in fit(observe(plan, options.jobs)).items():
            print(f"{name:4} fitted {value:.4g}, in the package {packaged[name]:.4g}")
    means = observe(read_plan(options.law, "hold_out", options.seed), options.jobs)
    error, noise, inside, area = np.concatenate([of.judged() for of in means], axis=1)
    counted = area > LEAST[options.law]
    for name, chosen in (("all", counted), ("in the domain", counted & (inside > 0))):
        off, scatter = (float(np.sqrt(np.mean(values[chosen] ** 2))) for values in (error, noise))
        print(f"hold-out, {name}: error {off:.2%}, noise {scatter:.2%}, {chosen.sum()} loads")
    if options.out:
        with options.out.open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(["spectrum", "parameters", "theta", "load", "area", "error"])
            for of in means:
                for load, mean, error in zip(of.loads, of.area, of.error, strict=True):
                    numbers = [f"{of.theta:g}", f"{load:g}", f"{mean:.5f}", f"{error:.5f}"]
                    table.writerow([of.group.spectrum, json.dumps(of.group.parameters), *numbers])


if __name__ == "__main__":
    main()
