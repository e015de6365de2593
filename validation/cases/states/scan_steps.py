"""Every step from a scan to a surface against what it is to give, written out: trend, mirror, window, spikes, cut.

An odd number of samples carries half as many harmonics without loss, so that the surface passes through the prepared
samples, less their mean; a mirrored line of n samples carries n - 1.  SI units.
"""

from __future__ import annotations

import statistics
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from bem.geometry.profile import Profile
from bem.scene.scene import parse_scene
from validation.harness.arrays import FloatArray
from validation.harness.case import Case, Outcome
from validation.harness.rows import compared
from validation.harness.schema import Reference

SAMPLES, SPACING, HEIGHT = 81, 0.25e-3, 1e-6
PERIOD = SAMPLES * SPACING
DEGREES = {"mean": 0, "line": 1, "quadratic": 2, "cubic": 3}
SPIKES = {17: 60.0, 18: 55.0, 50: -70.0, 71: -40.0}  # heights of spikes of both signs, one and two samples wide
NEIGHBOURS, TAPERED = 2, 0.1  # of the median, on either side; share of the line at either end
KEPT = 5  # harmonics after the cut
MEASURED = {
    "trend": 4.3e-15,
    "mirror": 3.1e-15,
    "window": 1.8e-15,
    "spikes": 4.7e-15,
    "unequal steps": 6.7e-15,
    "cut": 1.9e-15,
}


def _surface(x: FloatArray, h: FloatArray, **asked: Any) -> Profile:
    """The surface of a scan, as its scene prepares it."""
    with tempfile.TemporaryDirectory() as name:
        np.savetxt(Path(name) / "scan.csv", np.stack([x, h], axis=1), delimiter=",", fmt="%.17g")
        profile = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", "harmonics": SAMPLES // 2}
        tables = {
            "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
            "profile": profile | asked,
            "loading": {"control": "penetration", "targets": [1e-6]},
        }
        return parse_scene(tables, Path(name)).surface()


def _positions() -> FloatArray:
    return np.asarray(SPACING * np.arange(SAMPLES), dtype=np.float64)


def _heights() -> FloatArray:
    """A rough line that no step may take for spikes."""
    return np.asarray(HEIGHT * np.cumsum(np.random.default_rng(11).uniform(-1.0, 1.0, SAMPLES)), dtype=np.float64)


def _trends() -> tuple[list[FloatArray], list[FloatArray]]:
    """The residue of least squares, by an orthogonal basis of the polynomials."""
    x, h = _positions(), _heights()
    expected, found = [], []
    for method, degree in DEGREES.items():
        basis = np.linalg.qr(np.vander((x - x.mean()) / PERIOD, degree + 1))[0]
        expected.append(h - basis @ (basis.T @ h))
        found.append(_surface(x, h, detrend=method).height(x))
    return expected, found


def _mirrored() -> tuple[FloatArray, FloatArray]:
    x, h = _positions(), _heights()
    both = np.concatenate([h, h[::-1]])
    surface = _surface(x, h, periodic="mirror", harmonics=SAMPLES - 1)
    return both - both.mean(), surface.height(SPACING * np.arange(2 * SAMPLES))


def _windowed() -> tuple[FloatArray, FloatArray]:
    x, h = _positions(), _heights() - _heights().mean()
    reach = TAPERED * (SAMPLES - 1)
    from_end = np.minimum(np.arange(SAMPLES), np.arange(SAMPLES)[::-1])
    taper = np.where(from_end < reach, 0.5 * (1 - np.cos(np.pi * from_end / reach)), 1.0)
    tapered = h * taper
    return tapered - tapered.mean(), _surface(x, h, detrend="mean", periodic="window").height(x)


def _without_spikes() -> tuple[FloatArray, FloatArray]:
    x, rough = _positions(), _heights()
    h = rough + HEIGHT * np.array([SPIKES.get(k, 0.0) for k in range(SAMPLES)])
    clean = h.copy()
    for k in SPIKES:
        clean[k] = statistics.median(h[k - NEIGHBOURS : k + NEIGHBOURS + 1].tolist())
    return clean - clean.mean(), _surface(x, h, outliers="replace").height(x)


def _resampled() -> tuple[FloatArray, FloatArray]:
    """A straight line at unequal steps: any curve through it that does not overshoot is that line."""
    x = _positions() + 0.3 * SPACING * np.sin(np.arange(SAMPLES)) * (np.arange(SAMPLES) % (SAMPLES - 1) > 0)
    line = HEIGHT * _positions() / PERIOD
    surface = _surface(x, HEIGHT * x / PERIOD, unequal_spacing="resample", detrend="none")
    return line - line.mean(), surface.height(_positions())


def _cut() -> tuple[FloatArray, FloatArray]:
    """Of seven waves, the first five, at places between the samples."""
    x, amplitude = _positions(), HEIGHT / np.arange(1, 8)
    waves = np.cos(2 * np.pi * np.outer(x / PERIOD, np.arange(1, 8)) + np.arange(7))
    at = (np.arange(50) + 0.5) / 50 * PERIOD
    kept = np.cos(2 * np.pi * np.outer(at / PERIOD, np.arange(1, KEPT + 1)) + np.arange(KEPT)) @ amplitude[:KEPT]
    return kept, _surface(x, waves @ amplitude, harmonics=KEPT).height(at)


def _steps() -> Outcome:
    expected, found = (np.concatenate(values) for values in _trends())
    steps = {
        "trend": ("least squares: mean, line, quadratic, cubic", expected, found),
        "mirror": ("the line and its reverse", *_mirrored()),
        "window": ("half a cosine over a tenth of the line at either end", *_windowed()),
        "spikes": ("median of five samples at each spike, up and down", *_without_spikes()),
        "unequal steps": ("a straight line", *_resampled()),
        "cut": ("the waves that are kept, between the samples", *_cut()),
    }
    rows = tuple(
        compared(f"surface after the step, over the largest: {name}", "m", Reference(kind="exact", source=source),
                 right, given, 2.5 * MEASURED[name], MEASURED[name])
        for name, (source, right, given) in steps.items()
    )  # fmt: skip
    return Outcome(rows=rows)


CASES = (
    Case(id="scan-steps", group="identities", level="quick", problem="a scan becomes a surface",
         question="Does each step from a scan to a surface give what it is to give?",
         equations=r"$h - Q Q^T h$ with $Q$ a basis of polynomials; mirror; taper; median of five; the waves kept",
         sources=("carbone2009",), compute=_steps),
)  # fmt: skip
