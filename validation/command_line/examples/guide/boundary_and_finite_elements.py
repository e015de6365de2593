"""Boundary against finite elements: one adhesive contact of a layer, by two codes that share nothing.

Each number of the finite elements has an uncertainty from three meshes; the two agree within it.
"""

import bem
import fem_reference

SOLID = bem.Solid(youngs_modulus=1e6, poisson_ratio=0.45)
PERIOD, HEIGHT, THICKNESS, WORK = 0.01, 20e-6, 2e-3, 0.03  # m, m, m, J/m^2
PENETRATION = 10e-6  # m


def main() -> tuple[bem.Result, fem_reference.Result]:
    """Solve by both, and print the numbers beside each other; both results."""
    boundary = bem.solve(
        solid=SOLID,
        profile=bem.Profile.from_harmonics(PERIOD, [1], [HEIGHT]),
        layer={"thickness": THICKNESS},
        adhesion={"work_of_adhesion": WORK},
        loading={"control": "penetration", "targets": [PENETRATION]},
    )
    finite = fem_reference.solve(
        youngs_modulus=SOLID.youngs_modulus,
        poisson_ratio=SOLID.poisson_ratio,
        thickness=THICKNESS,
        period=PERIOD,
        harmonics=([1], [HEIGHT], [0.0]),
        work_of_adhesion=WORK,
        control="penetration",
        value=PENETRATION,
        resolution=fem_reference.Resolution(order=2, cells=10, tip_levels=10),
    )
    state = boundary.states[-1]
    for name in ("mean_pressure", "contact_fraction"):
        mine, error = getattr(state, name), getattr(state.error_estimate, name)
        other, uncertainty = getattr(finite, name), finite.uncertainty[name]
        apart = abs(mine - other) / (error + float(uncertainty))
        print(
            f"{name}: {mine:.9g} +- {error:.0e} and {other:.9g} +- {uncertainty:.0e}, {apart:.2f} of both uncertainties"
        )
    return boundary, finite


if __name__ == "__main__":
    main()
