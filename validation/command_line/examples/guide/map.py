"""A map: the largest tension on unloading against Hurst exponent and work of adhesion, drawn as map.svg.

theta is the work of adhesion over the elastic energy of complete contact. A map of use has more waves, and the mean of
several seeds at each point.
"""

import math

from matplotlib.figure import Figure

import bem

RUBBER = bem.Solid(youngs_modulus=1e6, poisson_ratio=0.5)
MODULUS = 1e6 / (1 - 0.5**2)  # Pa
HURST, THETA = [0.3, 0.6, 0.9], [0.01, 0.1]
PERIOD, RMS_HEIGHT, WAVES, SEED = 0.01, 50e-6, 8, 0  # m


def tension(hurst: float, theta: float) -> float:
    """Load a profile to a separation of half its rms height, unload it, and return the largest tension in Pa."""
    face = bem.Profile.self_affine(PERIOD, hurst, RMS_HEIGHT, WAVES, SEED)
    energy = MODULUS * 2 * math.pi / PERIOD * float(face.orders @ face.amplitudes**2) / 8  # J/m^2
    targets = [RMS_HEIGHT / 2, face.max_height + 6 * RMS_HEIGHT]
    loading = {"control": "separation", "targets": targets}
    adhesion = bem.Adhesion(work_of_adhesion=theta * energy)
    largest = bem.solve(solid=RUBBER, profile=face, adhesion=adhesion, loading=loading).largest_tension
    return math.nan if largest is None else -largest.mean_pressure


def main() -> list[list[float]]:
    """Solve every point, print the map and draw it; the values."""
    values = [[tension(hurst, theta) for theta in THETA] for hurst in HURST]
    for hurst, line in zip(HURST, values, strict=True):
        print(f"H = {hurst:g}: " + ", ".join(f"{value:.4g} Pa" for value in line))
    figure = Figure(figsize=(4.0, 3.5), layout="constrained")
    axes = figure.subplots()
    drawn = axes.pcolormesh(THETA, HURST, values, cmap="cividis_r", shading="nearest")
    axes.set(xlabel="theta", ylabel="Hurst exponent", xscale="log")
    figure.colorbar(drawn, label="largest tension / Pa")
    figure.savefig("map.svg")
    return values


if __name__ == "__main__":
    main()
