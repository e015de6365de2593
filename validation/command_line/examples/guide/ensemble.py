"""An ensemble with error bars: eight faces of one kind, the mean contact fraction, and how sure it is.

The scatter between realisations is no error of the solver: both are printed.
"""

import numpy as np

import bem

SEEDS = range(8)
PRESSURES = [10e3, 20e3, 40e3]  # Pa
SOLID = bem.Solid(youngs_modulus=1e6, poisson_ratio=0.5)


def main() -> dict[str, np.ndarray]:
    """Solve all members, and print a line for each pressure; the table of all states."""
    faces = [bem.Profile.self_affine(0.01, 0.8, 20e-6, 60, seed) for seed in SEEDS]
    loading = {"control": "mean_pressure", "targets": PRESSURES}
    table = bem.ensemble_table([bem.solve(solid=SOLID, profile=face, loading=loading) for face in faces])
    for k, pressure in enumerate(PRESSURES):
        here = np.arange(table["member"].size) % len(PRESSURES) == k
        fractions, errors = table["contact_fraction"][here], table["error_estimate_contact_fraction"][here]
        scatter = fractions.std(ddof=1)
        print(
            f"{pressure / 1e3:.0f} kPa: contact fraction {fractions.mean():.4f} +- {scatter / len(SEEDS) ** 0.5:.4f} "
            f"(scatter {scatter:.4f}, largest numerical error {errors.max():.0e})"
        )
    return table


if __name__ == "__main__":
    main()
