"""A scan that does not begin at x = 0: its surface passes the samples, and contact begins at the highest point."""

import numpy as np
import pytest

import bem

SAMPLES, SPACING = 41, 0.25e-3
PERIOD = SAMPLES * SPACING
HEIGHTS = 1e-6 * np.cumsum(np.random.default_rng(5).normal(size=SAMPLES))


def highest(start):
    """Return where the trigonometric interpolant is highest, in [0, period): on a grid, then by Newton."""
    series, order = np.fft.rfft(HEIGHTS) / SAMPLES, np.arange(SAMPLES // 2 + 1)

    def derivative(x, times):
        wave = (2j * np.pi * order / PERIOD) ** times * series * np.exp(2j * np.pi * order * (x - start) / PERIOD)
        return 2 * float(wave[1:].real.sum())

    grid = start + PERIOD * np.arange(4000) / 4000
    x = grid[int(np.argmax([derivative(at, 0) for at in grid]))]
    for _ in range(6):
        x -= derivative(x, 1) / derivative(x, 2)
    return x % PERIOD


@pytest.mark.parametrize("start", [0.0, 1.7e-3, -31e-3])  # m; the last three periods before zero
def test_surface_and_first_touch(start, tmp_path):
    x = start + SPACING * np.arange(SAMPLES)
    np.savetxt(tmp_path / "scan.csv", np.stack([x, HEIGHTS], axis=1), delimiter=",", fmt="%.17g")
    profile = {"kind": "samples", "file": str(tmp_path / "scan.csv"), "unit_x": "m", "unit_h": "m", "harmonics": 20}
    scene = bem.parse_scene(
        {
            "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
            "profile": profile,
            "loading": {"control": "penetration", "targets": [1e-6]},
        }
    )
    expected = HEIGHTS - HEIGHTS.mean()
    np.testing.assert_allclose(scene.surface().height(x), expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    touch = next(event.position for event in bem.solve(scene).events if event.kind == "first_touch")
    assert touch == pytest.approx(highest(start), abs=1e-12 * PERIOD)
