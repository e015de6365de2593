"""Pull-off: pressed together, pulled apart, and the tension at which it comes apart.

The separation is prescribed, so that the path goes on behind the largest tension, which ends one under loads.
"""

import bem

SCENE = {
    "title": "Pull-off of a soft solid from a rough face",
    "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
    "profile": {
        **{"kind": "self_affine", "period": 0.01, "hurst": 0.7},
        **{"rms_height": 50e-6, "harmonics": 20, "seed": 1},
    },
    "adhesion": {"work_of_adhesion": 0.03},
    "loading": {"control": "separation", "start": 150e-6, "stop": 40e-6, "count": 3, "then_back_to": 200e-6},
}


def main() -> bem.Result:
    """Solve, print the pull-off and all events, and return the result."""
    result = bem.solve(SCENE)
    last = result.events[-1]
    error = last.error_estimate.mean_pressure
    print(f"{last.kind} at a tension of {-last.mean_pressure:.6f} Pa, numerical error {error:.0e} Pa")
    for event in result.events:
        released = "" if event.energy_released is None else f", {event.energy_released:.3g} J/m^2 released"
        print(f"{event.kind} at a mean pressure of {event.mean_pressure:.3f} Pa{released}")
    return result


if __name__ == "__main__":
    main()
