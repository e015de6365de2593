"""A scan that begins anywhere: the surface passes through its samples where they were taken, and contact begins there.

The reference is the trigonometric interpolant of the samples about their own first position, summed term by term.
SI units.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import bem
from bem.scene.scene import parse_scene
from validation.harness.case import Case, Outcome
from validation.harness.rows import compared
from validation.harness.schema import Reference

SAMPLES, SPACING = 41, 0.25e-3  # an odd number carries 20 harmonics without loss
STARTS = (0.0, 1.7e-3, -31e-3)  # of the scan, m; the last three periods before zero


def _scan(start: float, folder: Path) -> tuple[bem.Profile, bem.Result]:
    """The surface of a scan that begins at a position, and its contact."""
    x = start + SPACING * np.arange(SAMPLES)
    np.savetxt(folder / "scan.csv", np.stack([x, _heights()], axis=1), delimiter=",", fmt="%.17g")
    posed = parse_scene(
        {
            "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
            "profile": {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", "harmonics": SAMPLES // 2},
            "loading": {"control": "penetration", "targets": [1e-6]},
        },
        folder,
    )
    return posed.surface(), bem.solve(posed)


def _heights() -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return 1e-6 * np.cumsum(np.random.default_rng(5).normal(size=SAMPLES))


def _highest(start: float) -> float:
    """Where the interpolant is highest, in [0, period): by the grid, then by Newton."""
    period, series = SAMPLES * SPACING, np.fft.rfft(_heights()) / SAMPLES
    order = np.arange(series.size)

    def derivative(x: float, times: int) -> float:
        wave = (2j * np.pi * order / period) ** times * series * np.exp(2j * np.pi * order * (x - start) / period)
        return float(2 * wave[1:].real.sum()) + (float(wave[0].real) if times == 0 else 0.0)

    grid = start + period * np.arange(4000) / 4000
    at = float(grid[int(np.argmax([derivative(float(x), 0) for x in grid]))])
    for _ in range(6):
        at -= derivative(at, 1) / derivative(at, 2)
    return at % period


def _shifted_scan() -> Outcome:
    heights = _heights() - np.mean(_heights())
    expected, found, highest, touched = [], [], [], []
    with tempfile.TemporaryDirectory() as name:
        for start in STARTS:
            surface, result = _scan(start, Path(name))
            expected += heights.tolist()
            found += surface.height(start + SPACING * np.arange(SAMPLES)).tolist()
            highest.append(_highest(start))
            touched.append(next(event.position for event in result.events if event.kind == "first_touch"))
    samples = Reference(kind="exact", source="the samples, less their mean")
    rows = (
        compared("surface at the samples, over the largest", "m", samples, expected, found, *MEASURED_SURFACE),
        compared("place of first touch", "m",
                 Reference(kind="exact", source="highest point of the trigonometric interpolant"), highest,
                 [float("nan") if place is None else place for place in touched],
                 *MEASURED_PLACE),
    )  # fmt: skip
    return Outcome(rows=rows)


MEASURED_SURFACE, MEASURED_PLACE = (1e-12, 4e-13), (1e-12, 4e-13)

CASES = (
    Case(id="shifted-scan", group="identities", level="quick",
         question="Does the surface of a scan that does not begin at x = 0 pass through its samples?",
         equations=r"$h(x_j) = h_j - \langle h \rangle$ for every sample, wherever $x_0$ is",
         sources=("carbone2009",), compute=_shifted_scan),
)  # fmt: skip
