"""A seal on a rough face: how much of it touches at working pressure, and how high the gaps are that it leaves.

The face is random; its parameters are those of a fine turned one. Without adhesion, under given mean pressures.
"""

import bem

FACE = bem.Profile.self_affine(period=1e-3, hurst=0.8, rms_height=2e-6, harmonics=100, seed=1)
RUBBER = bem.Solid(youngs_modulus=8e6, poisson_ratio=0.49)
PRESSURES = [0.1e6, 0.2e6, 0.4e6]  # Pa


def main() -> bem.Result:
    """Solve, print contact, strips and gaps at every pressure, and return the result."""
    loading = {"control": "mean_pressure", "targets": PRESSURES}
    result = bem.solve(solid=RUBBER, profile=FACE, loading=loading, output={"shapes": PRESSURES})
    print(
        f"rms slope {FACE.rms_slope:.3f}; a pressure of {result.groups['pressure_scale'] / 1e6:.2f} MPa presses it flat"
    )
    for k, state in enumerate(result.states):
        gap = result.fields[f"gap_{k}"].max()  # m
        print(
            f"{state.mean_pressure / 1e6:.1f} MPa: touches on {state.contact_fraction:.4f} of the face in "
            f"{state.n_patches} strips, mean gap {1e6 * state.separation:.3f} um, largest {1e6 * gap:.2f} um"
        )
    return result


if __name__ == "__main__":
    main()
