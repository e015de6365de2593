"""From a scan to a surface: it passes through its samples wherever the scan begins, and each step is written out.

An odd number of samples carries half as many harmonics without loss, so that the surface passes through the prepared
samples, less their mean; a mirrored line of n samples carries n - 1.  Contact begins at the highest point of the
trigonometric interpolant of the samples about their own first position, summed term by term.  SI units.
"""

import statistics
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

import bem
from bem.geometry.profile import Profile
from bem.scene.scene import Scene, parse_scene
from validation.cases.shared.checks import Against, Found, case
from validation.harness.schema import Row

SAMPLES, SPACING, HEIGHT = 81, 0.25e-3, 1e-6
PERIOD = SAMPLES * SPACING
FEWER = 41  # of the scan that begins anywhere
STARTS = (0.0, 1.7e-3, -31e-3)  # of that scan, m; the last three periods before zero
DEGREES = {"mean": 0, "line": 1, "quadratic": 2, "cubic": 3}
SPIKES = {17: 60.0, 18: 55.0, 50: -70.0, 71: -40.0}  # heights of spikes of both signs, one and two samples wide
NEIGHBOURS, TAPERED = 2, 0.1  # of the median, on either side; share of the line at either end
KEPT = 5  # harmonics after the cut
CUT_OFFS = PERIOD / 6, PERIOD / 2  # of Gaussian filters, m; half of the sixth and of the second wave passes
X = SPACING * np.arange(SAMPLES)  # m
BETWEEN = (np.arange(50) + 0.5) / 50 * PERIOD  # m, places between the samples
LINE = HEIGHT * np.cumsum(np.random.default_rng(11).uniform(-1.0, 1.0, SAMPLES))  # which no step may take for spikes
DRAWN = 1e-6 * np.cumsum(np.random.default_rng(5).normal(size=FEWER))  # of the scan that begins anywhere


def _posed(x: NDArray[Any], h: NDArray[Any], **asked: Any) -> Scene:
    """A scan in a scene."""
    with tempfile.TemporaryDirectory() as name:
        np.savetxt(Path(name) / "scan.csv", np.stack([x, h], axis=1), delimiter=",", fmt="%.17g")
        profile = {"kind": "samples", "file": "scan.csv", "unit_x": "m", "unit_h": "m", "harmonics": x.size // 2}
        tables = {
            "solid": {"youngs_modulus": 1e6, "poisson_ratio": 0.5},
            "profile": profile | asked,
            "loading": {"control": "penetration", "targets": [1e-6]},
        }
        return parse_scene(tables, Path(name))


def _surface(h: NDArray[Any], x: NDArray[Any] = X, **asked: Any) -> Profile:
    """The surface of a scan as its scene prepares it."""
    return _posed(x, h, **asked).surface()


def _highest(start: float) -> float:
    """Where the interpolant is highest, in [0, period): by the grid, then by Newton."""
    period, series = FEWER * SPACING, np.fft.rfft(DRAWN) / FEWER
    order = np.arange(series.size)

    def derivative(x: float, times: int) -> float:
        wave = (2j * np.pi * order / period) ** times * series * np.exp(2j * np.pi * order * (x - start) / period)
        return float(2 * wave[1:].real.sum()) + (float(wave[0].real) if times == 0 else 0.0)

    grid = start + period * np.arange(4000) / 4000
    at = float(grid[int(np.argmax([derivative(float(x), 0) for x in grid]))])
    for _ in range(6):
        at -= derivative(at, 1) / derivative(at, 2)
    return at % period


def _shifted_scan() -> Found:
    found, touched = list[float](), list[float | None]()
    for start in STARTS:
        x = start + SPACING * np.arange(FEWER)
        scene = _posed(x, DRAWN)
        found += scene.surface().height(x).tolist()
        touched.append(next(event.position for event in bem.solve(scene).events if event.kind == "first_touch"))
    yield Against("exact", "the samples, less their mean").row(
        "surface at the samples, over the largest", "m", (DRAWN - np.mean(DRAWN)).tolist() * len(STARTS), found,
        (1e-12, 4e-13))  # fmt: skip
    yield Against("exact", "highest point of the trigonometric interpolant").row(
        "place of first touch", "m", map(_highest, STARTS), touched, (1e-12, 4e-13))  # fmt: skip


def _step(name: str, source: str, expected: ArrayLike, found: ArrayLike, measured: float) -> Row:
    """The surface after a step against what is right."""
    return Against("exact", source).row(f"surface after the step, over the largest: {name}", "m", np.ravel(expected),
                                        np.ravel(found), measured)  # fmt: skip


def _steps() -> Found:
    bases = (np.linalg.qr(np.vander((X - X.mean()) / PERIOD, degree + 1))[0] for degree in DEGREES.values())
    yield _step("trend", "least squares: mean, line, quadratic, cubic",
                [LINE - basis @ (basis.T @ LINE) for basis in bases],
                [_surface(LINE, detrend=method).height(X) for method in DEGREES], 4.3e-15)  # fmt: skip
    both = np.concatenate([LINE, LINE[::-1]])
    mirrored = _surface(LINE, periodic="mirror", harmonics=SAMPLES - 1)
    yield _step("mirror", "the line and its reverse", both - both.mean(),
                mirrored.height(SPACING * np.arange(2 * SAMPLES)), 3.1e-15)  # fmt: skip
    h, reach = LINE - LINE.mean(), TAPERED * (SAMPLES - 1)
    from_end = np.minimum(np.arange(SAMPLES), np.arange(SAMPLES)[::-1])
    tapered = h * np.where(from_end < reach, 0.5 * (1 - np.cos(np.pi * from_end / reach)), 1.0)
    yield _step("window", "half a cosine over a tenth of the line at either end", tapered - tapered.mean(),
                _surface(h, detrend="mean", periodic="window").height(X), 1.8e-15)  # fmt: skip
    spiked = LINE + HEIGHT * np.array([SPIKES.get(k, 0.0) for k in range(SAMPLES)])
    clean = spiked.copy()
    for k in SPIKES:
        clean[k] = statistics.median(spiked[k - NEIGHBOURS : k + NEIGHBOURS + 1].tolist())
    yield _step("spikes", "median of five samples at each spike, up and down", clean - clean.mean(),
                _surface(spiked, outliers="replace").height(X), 4.7e-15)  # fmt: skip
    # a straight line at unequal steps: any curve through it that does not overshoot is that line
    x = X + 0.3 * SPACING * np.sin(np.arange(SAMPLES)) * (np.arange(SAMPLES) % (SAMPLES - 1) > 0)
    line = HEIGHT * X / PERIOD
    resampled = _surface(HEIGHT * x / PERIOD, x, unequal_spacing="resample", detrend="none")
    yield _step("unequal steps", "a straight line", line - line.mean(), resampled.height(X), 6.7e-15)
    order = np.arange(1, 8)  # of seven waves
    at_samples, between = (HEIGHT / order * np.cos(2 * np.pi * np.outer(at / PERIOD, order) + order - 1)
                           for at in (X, BETWEEN))  # fmt: skip
    waves = at_samples.sum(axis=1)
    yield _step("cut", "the waves that are kept, between the samples", between[:, :KEPT].sum(axis=1),
                _surface(waves, harmonics=KEPT).height(BETWEEN), 1.9e-15)  # fmt: skip
    short, long = (np.log(2) * (cut * order / PERIOD) ** 2 for cut in CUT_OFFS)
    filtered = _surface(waves, cutoff_short=CUT_OFFS[0], cutoff_long=CUT_OFFS[1])
    yield _step("cut-offs", "each wave by the Gaussian filters of ISO 16610-21",
                between @ (np.exp(-short) * (1 - np.exp(-long))), filtered.height(BETWEEN), 1.9e-15)  # fmt: skip


CASES = (
    case("shifted-scan", "identities", _shifted_scan,
         "Does the surface of a scan that does not begin at x = 0 pass through its samples?",
         r"$h(x_j) = h_j - \langle h \rangle$ for every sample, wherever $x_0$ is", "carbone2009"),
    case("scan-steps", "identities", _steps,
         "Does each step from a scan to a surface give what it is to give?",
         r"$h - Q Q^T h$ with $Q$ a basis of polynomials; mirror; taper; median of five; the waves kept; "
         r"$e^{-\ln 2 (\lambda_s / \lambda)^2} (1 - e^{-\ln 2 (\lambda_c / \lambda)^2})$",
         "carbone2009", problem="a scan becomes a surface"),
)  # fmt: skip
