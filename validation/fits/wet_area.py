"""Fit the two coefficients of persson/adhesive_edges.py and judge the law on a hold-out; run by hand.

    python -m validation.fits.wet_area --jobs 2               # the fit and the hold-out, 368 realisations; hours
    python -m validation.fits.wet_area --hold-out --seed 7    # the hold-out alone, with a seed root of your own
    python -m validation.fits.wet_area --realisations 2 --highest-order 36    # a trial of some minutes

Every realisation is solved without and with adhesion on the same phases.  For the fit the law takes the area without
adhesion from the same realisations: its p_d(A) is moved onto their mean, so that noise and errors that both share
cancel.  The fit minimises ln(A_law / A_ensemble) over the error of the ratio wet / dry (a jackknife over the
realisations) and `FLOOR`, inside the domain.  The hold-out judges `persson.contact_area` as it is; it has other
spectra, loads, seeds and works of adhesion, and enters no fit.  `--out` writes its areas
(tests/validation/hold_out_wet.csv).
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from persson.adhesive_edges import COEFFICIENTS, EdgeLaw
from persson.contact_slope import contact_fractions
from persson.fitted_area import WET_DOMAIN, numbers_of, reasons_outside
from validation.fits.ensembles import (
    Group,
    Plan,
    print_coefficients,
    read_options,
    read_plan,
    rms,
    solve_groups,
    write_areas,
)
from validation.harness.arrays import FloatArray
from validation.references.paper_problem import RMS_SLOPE

FLOOR = 0.02


@dataclass(frozen=True)
class Pair:
    """Mean areas of one group without and with adhesion, and relative errors; (n,) arrays over the loads."""

    group: Group
    theta: float
    loads: FloatArray
    dry: FloatArray
    wet: FloatArray
    ratio_error: FloatArray
    wet_error: FloatArray

    @property
    def inside(self) -> list[bool]:
        """Loads inside the domain."""
        lines = self.group.lines
        work = self.theta * lines.full_contact_energy
        cases = (numbers_of(lines, p * RMS_SLOPE, a, work) for p, a in zip(self.loads, self.wet, strict=True))
        return [not reasons_outside(WET_DOMAIN, case) for case in cases]

    def law(self) -> FloatArray:
        """Return A/A0 by the law as it is, (n,)."""
        lines = self.group.lines
        law = EdgeLaw(lines, self.theta * lines.full_contact_energy)
        return np.array([law.at(float(load))[1] for load in self.loads * lines.slope_rms])

    def law_on_the_dry_area(self, coefficients: Mapping[str, float]) -> FloatArray:
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


def pair_of(group: Group, theta: float, loads: FloatArray, dry: FloatArray, wet: FloatArray) -> Pair:
    """Return the means and jackknife errors of areas (n_realisations, n_loads) without and with adhesion."""
    means = [(np.delete(wet, i, 0).mean(0), np.delete(dry, i, 0).mean(0)) for i in range(len(wet))]
    left_out = [np.stack([np.log(with_it / without), np.log(with_it)]) for with_it, without in means]
    spread = np.sqrt((len(wet) - 1) * np.var(left_out, axis=0))
    known = np.isfinite(wet.mean(0))
    return Pair(group, theta, loads[known], *(row[known] for row in (dry.mean(0), wet.mean(0), *spread)))


def observe(plan: Plan, jobs: int) -> list[Pair]:
    """Solve the ensembles of a plan, without and with adhesion."""
    dry = {group.name: areas for group, areas in solve_groups(plan, 0.0, jobs)}
    pairs = []
    for theta in plan.thetas:
        for group, wet in solve_groups(plan, theta, jobs):
            pairs.append(pair_of(group, theta, plan.loads, dry[group.name], wet))
            print(f"{group.name}, theta {theta:g}: {len(wet)} realisations", file=sys.stderr)
    return pairs


def fit(pairs: Sequence[Pair]) -> dict[str, float]:
    """Return the coefficients by least squares, from the package's; ArithmeticError without convergence."""

    def residual(values: FloatArray) -> FloatArray:
        coefficients = dict(zip(COEFFICIENTS, values.tolist(), strict=True))
        weighted = [
            (np.log(pair.law_on_the_dry_area(coefficients) / pair.wet) / np.hypot(pair.ratio_error, FLOOR))[pair.inside]
            for pair in pairs
        ]
        return np.concatenate(weighted)

    answer = least_squares(residual, list(COEFFICIENTS.values()), diff_step=1e-2, xtol=1e-4, ftol=1e-6)
    if not answer.success:
        raise ArithmeticError(answer.message)
    return dict(zip(COEFFICIENTS, map(float, answer.x), strict=True))


def main() -> None:
    """Run the fit and the hold-out."""
    options = read_options(__doc__)
    if not options.hold_out:
        plan = read_plan("wet", "fit", options)
        print_coefficients(fit(observe(plan, options.jobs)), COEFFICIENTS)
    plan = read_plan("wet", "hold_out", options)
    pairs = observe(plan, options.jobs)
    error = np.concatenate([np.log(pair.law() / pair.wet)[pair.inside] for pair in pairs])
    noise = np.concatenate([pair.wet_error[pair.inside] for pair in pairs])
    print(f"hold-out, in the domain: error {rms(error):.2%}, noise {rms(noise):.2%}, {error.size} loads")
    if options.out:
        cells = ((p.group, p.theta, *cell) for p in pairs for cell in zip(p.loads, p.wet, p.wet_error, strict=True))
        write_areas(options.out, cells)


if __name__ == "__main__":
    main()
