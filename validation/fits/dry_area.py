"""Fit the five coefficients of persson/contact_slope.py and judge the law on a hold-out; run by hand.

    python -m validation.fits.dry_area --jobs 2               # the fit, 2274 realisations, and the hold-out, 1710
    python -m validation.fits.dry_area --hold-out --seed 7    # the hold-out alone, with a seed root of your own
    python -m validation.fits.dry_area --realisations 2 --highest-order 30    # a trial of a minute

The fit minimises ln(A_law / A_ensemble) over the standard error of the mean and `FLOOR`, at contact fractions from
`LEAST`.  The hold-out has other spectra, loads and seeds, and enters no fit.  Prints coefficients beside the package's,
and the rms error and noise of the hold-out; `--out` writes its areas as CSV (tests/validation/hold_out_dry.csv).
"""

import sys
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.optimize import least_squares

from persson.contact_slope import COEFFICIENTS, contact_fractions
from persson.fitted_area import DRY_DOMAIN, DRY_FORBIDDEN, numbers_of, reasons_outside
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

LEAST, FLOOR = 0.02, 0.015

Observed = tuple[Group, FloatArray, FloatArray]  # mean areas and their relative standard errors, (n_loads,) each


def observe(plan: Plan, jobs: int) -> list[Observed]:
    """Solve the ensembles of a plan."""
    observed = []
    for group, areas in solve_groups(plan, 0.0, jobs):
        mean = areas.mean(axis=0)
        observed.append((group, mean, areas.std(axis=0, ddof=1) / np.sqrt(len(areas)) / mean))
        print(f"{group.name}: {len(areas)} realisations", file=sys.stderr)
    return observed


def errors_of(
    observed: Sequence[Observed], loads: FloatArray, coefficients: Mapping[str, float] = COEFFICIENTS
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return ln(A_law / A_ensemble), the noise, and 1 where a case lies inside the domain, at areas from `LEAST`."""
    columns = []
    for group, mean, noise in observed:
        spectrum = group.lines
        law = contact_fractions(spectrum, loads * RMS_SLOPE, coefficients)
        cases = (numbers_of(spectrum, load * RMS_SLOPE, area) for load, area in zip(loads, mean, strict=True))
        inside = [not reasons_outside(DRY_DOMAIN, case, DRY_FORBIDDEN) for case in cases]
        columns.append(np.stack([np.log(law / mean), noise, inside])[:, mean > LEAST])
    error, noise, inside = np.concatenate(columns, axis=1)
    return error, noise, inside


def fit(observed: Sequence[Observed], loads: FloatArray) -> dict[str, float]:
    """Return the coefficients by least squares, from the package's; ArithmeticError without convergence."""

    def residual(values: FloatArray) -> FloatArray:
        error, noise, _ = errors_of(observed, loads, dict(zip(COEFFICIENTS, values.tolist(), strict=True)))
        return error / np.hypot(noise, FLOOR)

    answer = least_squares(residual, list(COEFFICIENTS.values()), diff_step=1e-3, xtol=1e-6, ftol=1e-8)
    if not answer.success:
        raise ArithmeticError(answer.message)
    return dict(zip(COEFFICIENTS, map(float, answer.x), strict=True))


def main() -> None:
    """Run the fit and the hold-out."""
    options = read_options(__doc__)
    if not options.hold_out:
        plan = read_plan("dry", "fit", options)
        print_coefficients(fit(observe(plan, options.jobs), plan.loads), COEFFICIENTS)
    plan = read_plan("dry", "hold_out", options)
    observed = observe(plan, options.jobs)
    error, noise, inside = errors_of(observed, plan.loads)
    for name, chosen in (("all", inside >= 0), ("in the domain", inside > 0)):
        print(f"hold-out, {name}: error {rms(error[chosen]):.2%}, noise {rms(noise[chosen]):.2%}, {chosen.sum()} loads")
    if options.out:
        cells = ((g, 0.0, *cell) for g, mean, error in observed for cell in zip(plan.loads, mean, error, strict=True))
        write_areas(options.out, cells)


if __name__ == "__main__":
    main()
