"""Your own scan: what is done to it, what the cut leaves out, and what another cut changes.

Put your file in place of own-scan.csv, two columns with their units in the heading.
"""

import bem

CUTS = [5, 20, 100]  # harmonics: waves in the length of the scan


def solved(harmonics: int) -> bem.Result:
    """Solve the scan under 100 kPa with a cut after so many harmonics."""
    return bem.solve(
        {
            "solid": {"youngs_modulus": 50e6, "poisson_ratio": 0.49},
            "profile": {"kind": "samples", "file": "own-scan.csv", "detrend": "line", "harmonics": harmonics},
            "loading": {"control": "mean_pressure", "targets": [100e3]},
        }
    )


def main() -> dict[int, bem.Result]:
    """Solve with each cut, print the changes, and return the results."""
    results = {cut: solved(cut) for cut in CUTS}
    for step in results[CUTS[-1]].profile_preparation:
        if step["step"] != "read" and "rms_height" in step:
            before, after = step["rms_height"]
            done = step.get("method", "")
            print(f"{step['step']} {done}: rms height from {1e6 * before:.3f} to {1e6 * after:.3f} um")
    for cut, result in results.items():
        state = result.states[-1]
        share = result.profile_preparation[-1]["slope_share_kept"]
        print(f"{cut} harmonics keep {share:.0%} of the rms slope: contact fraction {state.contact_fraction:.4f}")
        for warning in result.warnings:
            print(f"  {warning.about}: {warning.message}")
    return results


if __name__ == "__main__":
    main()
