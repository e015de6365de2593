"""An ensemble with error bars: eight faces of one kind, the mean contact fraction, and how sure it is.

The scatter between realisations is no error of the solver: both are printed.
"""

import numpy as np

import bem

SEEDS = range(8)
PRESSURES = [10e3, 20e3, 40e3]  # Pa
SOLID = bem.Solid(youngs_modulus=1e6, poisson_ratio=0.5)


def main() -> np.ndarray:
    """Solve all members, print a line for each pressure, and return the contact fractions, a row for each member."""
    faces = [bem.Profile.self_affine(0.01, 0.8, 20e-6, 60, seed) for seed in SEEDS]
    loading = {"control": "mean_pressure", "targets": PRESSURES}
    tables = [bem.solve(solid=SOLID, profile=face, loading=loading).to_table("targets") for face in faces]
    table = np.array([member["contact_fraction"] for member in tables])
    largest = np.array([member["error_estimate_contact_fraction"] for member in tables])
    for pressure, fractions, errors in zip(PRESSURES, table.T, largest.T, strict=True):
        scatter = fractions.std(ddof=1)
        print(
            f"{pressure / 1e3:.0f} kPa: contact fraction {fractions.mean():.4f} +- {scatter / len(SEEDS) ** 0.5:.4f} "
            f"(scatter {scatter:.4f}, largest numerical error {errors.max():.0e})"
        )
    return table


if __name__ == "__main__":
    main()
