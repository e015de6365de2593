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
from numpy.typing import NDArray

import bem
from bem.geometry.profile import Profile
from bem.scene.scene import Scene, parse_scene
from validation.cases.shared.checks import Against, case
from validation.harness.arrays import FloatArray
from validation.harness.case import Outcome

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


def _shifted_scan() -> Outcome:
    found, touched = list[float](), list[float | None]()
    for start in STARTS:
        x = start + SPACING * np.arange(FEWER)
        scene = _posed(x, DRAWN)
        found += scene.surface().height(x).tolist()
        touched.append(next(event.position for event in bem.solve(scene).events if event.kind == "first_touch"))
    rows = (
        Against("exact", "the samples, less their mean").row(
            "surface at the samples, over the largest", "m", (DRAWN - np.mean(DRAWN)).tolist() * len(STARTS), found,
            (1e-12, 4e-13)),
        Against("exact", "highest point of the trigonometric interpolant").row(
            "place of first touch", "m", map(_highest, STARTS), touched, (1e-12, 4e-13)),
    )  # fmt: skip
    return Outcome(rows=rows)


Pair = tuple[FloatArray, FloatArray]  # what is right, and what is found


def _trends() -> Pair:
    """The residue of least squares, by an orthogonal basis of the polynomials."""
    expected, found = [], []
    for method, degree in DEGREES.items():
        basis = np.linalg.qr(np.vander((X - X.mean()) / PERIOD, degree + 1))[0]
        expected.append(LINE - basis @ (basis.T @ LINE))
        found.append(_surface(LINE, detrend=method).height(X))
    return np.concatenate(expected), np.concatenate(found)


def _mirrored() -> Pair:
    both = np.concatenate([LINE, LINE[::-1]])
    surface = _surface(LINE, periodic="mirror", harmonics=SAMPLES - 1)
    return both - both.mean(), surface.height(SPACING * np.arange(2 * SAMPLES))


def _windowed() -> Pair:
    h, reach = LINE - LINE.mean(), TAPERED * (SAMPLES - 1)
    from_end = np.minimum(np.arange(SAMPLES), np.arange(SAMPLES)[::-1])
    tapered = h * np.where(from_end < reach, 0.5 * (1 - np.cos(np.pi * from_end / reach)), 1.0)
    return tapered - tapered.mean(), _surface(h, detrend="mean", periodic="window").height(X)


def _without_spikes() -> Pair:
    h = LINE + HEIGHT * np.array([SPIKES.get(k, 0.0) for k in range(SAMPLES)])
    clean = h.copy()
    for k in SPIKES:
        clean[k] = statistics.median(h[k - NEIGHBOURS : k + NEIGHBOURS + 1].tolist())
    return clean - clean.mean(), _surface(h, outliers="replace").height(X)


def _resampled() -> Pair:
    """A straight line at unequal steps: any curve through it that does not overshoot is that line."""
    x = X + 0.3 * SPACING * np.sin(np.arange(SAMPLES)) * (np.arange(SAMPLES) % (SAMPLES - 1) > 0)
    line = HEIGHT * X / PERIOD
    surface = _surface(HEIGHT * x / PERIOD, x, unequal_spacing="resample", detrend="none")
    return line - line.mean(), surface.height(X)


def _waves(x: NDArray[Any]) -> FloatArray:
    """Seven waves of a scan, (n, 7)."""
    order = np.arange(1, 8)
    return np.asarray(HEIGHT / order * np.cos(2 * np.pi * np.outer(x / PERIOD, order) + order - 1))


def _cut() -> Pair:
    """Of seven waves, the first five, at places between the samples."""
    return _waves(BETWEEN)[:, :KEPT].sum(axis=1), _surface(_waves(X).sum(axis=1), harmonics=KEPT).height(BETWEEN)


def _filtered() -> Pair:
    """Seven waves, each by what the filters of ISO 16610-21 let pass."""
    short, long = (np.log(2) * (cut * np.arange(1, 8) / PERIOD) ** 2 for cut in CUT_OFFS)
    surface = _surface(_waves(X).sum(axis=1), cutoff_short=CUT_OFFS[0], cutoff_long=CUT_OFFS[1])
    return _waves(BETWEEN) @ (np.exp(-short) * (1 - np.exp(-long))), surface.height(BETWEEN)


STEPS = (  # name, what is right, and the error measured
    ("trend", "least squares: mean, line, quadratic, cubic", _trends, 4.3e-15),
    ("mirror", "the line and its reverse", _mirrored, 3.1e-15),
    ("window", "half a cosine over a tenth of the line at either end", _windowed, 1.8e-15),
    ("spikes", "median of five samples at each spike, up and down", _without_spikes, 4.7e-15),
    ("unequal steps", "a straight line", _resampled, 6.7e-15),
    ("cut", "the waves that are kept, between the samples", _cut, 1.9e-15),
    ("cut-offs", "each wave by the Gaussian filters of ISO 16610-21", _filtered, 1.9e-15),
)


def _steps() -> Outcome:
    rows = (Against("exact", source).row(f"surface after the step, over the largest: {name}", "m", *of(), measured)
            for name, source, of, measured in STEPS)  # fmt: skip
    return Outcome(rows=tuple(rows))


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
