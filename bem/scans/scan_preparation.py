"""From a line as measured to the samples of a periodic profile, every step recorded.

In this order, each as [profile] asks for it:

dropouts   A value that an instrument writes where it has seen nothing (-9999, 32767, 0): runs of one value whose
           neighbours are more than `OUTLIER` median steps away, `FEWEST_DROPOUTS` samples of it or more.  "missing"
           takes them for missing heights.  Runs that lie farther from all others than these span are only reported:
           they may be dropouts from which a tilt was subtracted, or a groove.
outliers   Samples that lie more than `OUTLIER` median steps between neighbours from the running median of `WIDTH`
           samples are counted and, with "replace", set to that median (Tukey, Exploratory Data Analysis, 1977,
           chapter 7).  Steps are |h_{i+1} - h_i| > 0.
missing    "interpolate" fills gaps along straight lines and cuts off what is missing at either end.
spacing    Positions must be at equal steps, as far as their digits tell (scan_positions.py); "resample" puts as many
           samples at equal distances on a curve through the measured ones that does not overshoot (Fritsch, Butland,
           SIAM J. Sci. Stat. Comput. 5 (1984) 300).
detrend    A least-squares polynomial is subtracted: degree 0 (mean) to 3 (cubic).  A profile has no mean in any case.
spectrum   Nothing is changed: the power spectrum and its noise floor, with the cut that follows (noise_floor.py).
periodic   "as_is": n samples at distance dx are the period n dx.  "mirror": followed by the same in reverse, 2 n dx.
           "window": multiplied by a cosine-tapered window (Tukey's; Harris, Proc. IEEE 66 (1978) 51) that goes to zero
           over `TAPER` of the line at either end.
filter     Gaussian filters of ISO 16610-21, profile.cutoff_short and cutoff_long (gaussian_filter.py), mode by mode.
cut        Harmonics from 1 to profile.harmonics are kept (Profile.from_samples).

Each step has the rms height and the rms slope before and after: of the samples about their mean, and of the steps
between neighbours over their distance; after the cut, of the harmonics, with Ra, Rq and Rz (height_parameters.py).
scipy is imported by the steps that need it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.gaussian_filter import GaussianFilter
from bem.scans.height_parameters import height_parameters
from bem.scans.noise_floor import Spectrum
from bem.scans.scan_file import RawScan
from bem.scans.scan_keys import DEFAULTS, METRES
from bem.scans.scan_positions import UNIFORMITY, deviation_of, equal_steps, refuse_disorder, uniform
from bem.scans.scan_refusal import Refusal, ScanFileError
from bem.scans.scan_text import FEWEST, SHOWN

OUTLIER = 15.0  # median steps; of a normal distribution of steps, ten standard deviations
WIDTH = 5  # samples of the running median, which sees spikes of one or two
FEWEST_DROPOUTS = WIDTH // 2 + 1  # samples of one value: of fewer the running median sees that they are spikes
TAPER = 0.1  # format: of the line, at either end
DRAWN = 4000  # format: samples kept for figures
MOST_MISSING = 0.5  # format: of the samples
CARRIED = 1e-6  # derived: of the rms slope: contact areas go as its inverse, and the default tolerance is this
DEGREES = {"mean": 0, "line": 1, "quadratic": 2, "cubic": 3}

Line = tuple[FloatArray, FloatArray]
Step = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Scan:
    """Uniform samples of a period, and how they came about.

    Examples
    --------
    >>> x = np.array([0.0, 0.5, 1.0])
    >>> line = Scan(x, np.zeros(3), "", (x, np.zeros(3)), (), Spectrum(np.zeros(3), 0.5))
    >>> line.spacing, line.period, line.max_harmonics
    (0.5, 1.5, 1)
    """

    x: FloatArray  # positions, m, (n,)
    h: FloatArray  # heights, m, (n,)
    sha256: str  # of the file's bytes
    measured: Line  # positions and heights as read, m, (n_measured,) each; missing heights are NaN
    steps: tuple[Step, ...]  # what was done, step by step, as plain values
    spectrum: Spectrum  # of the line detrended, neither continued nor filtered
    gaussian: GaussianFilter = field(default_factory=GaussianFilter)  # which the heights have passed
    unfiltered: Scan | None = None  # before these filters

    @property
    def spacing(self) -> float:
        """Sample distance dx, m."""
        return float(self.x[-1] - self.x[0]) / (self.x.size - 1)

    @property
    def period(self) -> float:
        """Period n dx, m."""
        return self.spacing * self.x.size

    @property
    def max_harmonics(self) -> int:
        """Highest order below half the number of samples."""
        return int(self.x.size - 1) // 2

    @cached_property
    def _moments(self) -> tuple[FloatArray, FloatArray]:
        """Mean squares of height (m^2) and slope of the orders up to each, (n // 2,) each, the order n/2 included."""
        power = np.abs(np.fft.rfft(self.h)[1:]) ** 2 * (2 / self.h.size**2)
        power[self.max_harmonics :] /= 2  # an order n/2 has no phase
        wavenumbers = 2 * np.pi / self.period * np.arange(1, power.size + 1)
        return np.cumsum(power), np.cumsum(power * wavenumbers**2)

    @property
    def carrying(self) -> int:
        """The least order up to which all of the rms slope is but `CARRIED`; the highest where there is none."""
        slopes = self._moments[1]
        return min(int(np.searchsorted(slopes, (1 - CARRIED) ** 2 * slopes[-1])) + 1, self.max_harmonics)

    def slope_share(self, harmonics: int) -> float:
        """rms slope of the orders up to `harmonics` over that of all; 1 if the samples are flat."""
        slopes = self._moments[1]
        return float(np.sqrt(slopes[harmonics - 1] / slopes[-1])) if slopes[-1] > 0 else 1.0

    def noise_share(self, harmonics: int) -> float:
        """Share of the mean square slope of the orders up to `harmonics` that noise makes, as filtered."""
        return self.spectrum.noise_share(harmonics, self.period, self.gaussian)

    def filtered(self, gaussian: GaussianFilter) -> Scan:
        """The same scan, which is not filtered, with filters."""
        steps, h = list(self.steps), gaussian.applied(self.h, self.spacing)
        _done(steps, "filter", "gaussian", (self.x, self.h), ((self.x, h), gaussian.cuts))
        return replace(self, h=h, steps=tuple(steps), gaussian=gaussian, unfiltered=self)

    @cached_property
    def end_jump(self) -> float:
        """Step from the last sample to the first of the next period over the rms step between neighbours."""
        rms = float(np.sqrt(np.mean(np.diff(self.h) ** 2)))
        return abs(float(self.h[0] - self.h[-1])) / rms if rms > 0 else 0.0

    def drawn(self) -> dict[str, FloatArray]:
        """What a figure needs, few numbers.

        Samples as measured (scan_x, scan_h) and prepared (profile_x, profile_h), m; the power spectrum in bands,
        scan_density (m^3) over scan_wavelength (m).
        """
        pairs = {"scan": self.measured, "profile": (self.x, self.h)}
        thin = {name: _thinned(*line) for name, line in pairs.items()}
        lines = {
            f"{name}_{axis}": values for name, line in thin.items() for axis, values in zip("xh", line, strict=True)
        }
        frequency, density, _ = self.spectrum.bands
        return lines | {"scan_wavelength": 1 / frequency, "scan_density": density}

    def preparation(self, harmonics: int) -> tuple[Step, ...]:
        """All steps, the cut with them."""
        before = (float(np.sqrt(self._moments[0][-1])), float(np.sqrt(self._moments[1][-1])))
        after = [float(np.sqrt(moment[harmonics - 1])) for moment in self._moments]
        share = self.slope_share(harmonics)
        facts = {"harmonics": harmonics, "of": self.max_harmonics, "slope_share_kept": share}
        mirrored = any(step.get("method") == "mirror" for step in self.steps)
        facts |= height_parameters(self.h, harmonics, 2 if mirrored else 1)
        return (*self.steps, {"step": "cut"} | facts | _compared(before, (after[0], after[1])))


def roughness(x: FloatArray, h: FloatArray) -> tuple[float, float]:
    """rms height (m) about the mean and rms slope of a line, missing samples left out.

    Examples
    --------
    >>> roughness(np.arange(4.0), np.array([1.0, -1.0, 1.0, -1.0]))
    (1.0, 2.0)
    """
    known = np.isfinite(h)
    slopes = np.diff(h[known]) / np.diff(x[known])
    return float(np.std(h[known])), float(np.sqrt(np.mean(slopes**2)))


def _thinned(x: FloatArray, h: FloatArray) -> Line:
    """A line of at most `DRAWN` samples: of each stretch of a longer one the lowest and the highest."""
    if x.size <= DRAWN:
        return x, h
    stretches = np.array_split(np.arange(x.size), DRAWN // 2)
    low = np.where(np.isnan(h), np.inf, h)
    high = np.where(np.isnan(h), -np.inf, h)
    kept = [sorted((part[np.argmin(low[part])], part[np.argmax(high[part])])) for part in stretches]
    chosen = np.array(kept).ravel()
    return x[chosen], h[chosen]


def prepare(raw: RawScan, values: Mapping[str, Any]) -> Scan:
    """Samples of a period.

    `values` are those of [profile]: dropouts, missing, outliers, detrend, periodic, unequal_spacing, cutoff_short,
    cutoff_long, as far as they are given.
    ScanFileError for positions that do not increase or are unequal, missing samples, fewer than three, cut-offs that
    the line does not hold.
    """
    asked = DEFAULTS | {key: values[key] for key in DEFAULTS if key in values}
    refuse_disorder(raw)
    line: Line = (raw.x, raw.h)
    before = _known(raw, raw.h)
    facts = raw.facts | {"samples": raw.h.size, "rms_height": before[0], "rms_slope": before[1]}
    steps: list[Step] = [{"step": "read"} | facts]
    for step, work in (("dropouts", _dropouts), ("outliers", _outliers)):
        line = _done(steps, step, asked[step], line, work(raw, line, asked[step]))
    line = _done(steps, "missing", asked["missing"], line, _missing(raw, line, asked["missing"], steps[1]))
    line = _done(
        steps, "spacing", asked["unequal_spacing"], line, _even(raw, line, steps[-1], asked["unequal_spacing"])
    )
    line = _done(steps, "detrend", asked["detrend"], line, _detrended(line, asked["detrend"]))
    spectrum = Spectrum(line[1], float(line[0][-1] - line[0][0]) / (line[0].size - 1))
    steps.append({"step": "spectrum"} | spectrum.facts())
    line = _done(steps, "periodic", asked["periodic"], line, _periodic(line, asked["periodic"]))
    scan = Scan(*line, raw.sha256, (raw.x, raw.h), tuple(steps), spectrum)
    steps[-1] |= {"period": scan.period, "end_jump": scan.end_jump}
    gaussian = GaussianFilter.of(values)
    refusals = list(gaussian.refusals(scan.spacing, spectrum.h.size * scan.spacing))
    if refusals:
        raise ScanFileError(refusals)
    return scan.filtered(gaussian) if gaussian.cuts else scan


def _done(steps: list[Step], name: str, method: str, before: Line, outcome: tuple[Line, Step]) -> Line:
    """The line after a step, which is recorded."""
    line, facts = outcome
    compared = _compared(roughness(*before), roughness(*line))
    steps.append({"step": name, "method": method} | facts | compared)
    return line


def _compared(before: tuple[float, float], after: tuple[float, float]) -> Step:
    """rms height and slope before and after a step."""
    return {"rms_height": [before[0], after[0]], "rms_slope": [before[1], after[1]]}


def _known(raw: RawScan, h: FloatArray) -> tuple[float, float]:
    """Roughness of the heights that are there; ScanFileError for too few samples."""
    known = int(np.isfinite(h).sum())
    if known < FEWEST:
        found = f"holds {known} samples with a height"
        raise ScanFileError([Refusal("file", found, f"at least {FEWEST} of them")])
    if known < (1 - MOST_MISSING) * raw.h.size:
        found = f"lacks {raw.h.size - known} of {raw.h.size} heights"
        raise ScanFileError([Refusal("file", found, f"at most {MOST_MISSING:.0%} missing")])
    return roughness(raw.x, h)


def _median_step(h: FloatArray) -> float:
    """The median of the steps > 0 between neighbours; infinite where there are none."""
    steps = np.abs(np.diff(h))
    return float(np.median(steps[steps > 0])) if steps.any() else np.inf


def _dropouts(raw: RawScan, line: Line, method: str) -> tuple[Line, Step]:
    """Samples that hold a value for "nothing seen"."""
    x, h = line
    known = np.flatnonzero(np.isfinite(h))
    starts = np.flatnonzero(np.diff(h[known], prepend=np.nan) != 0)  # of runs of one value
    lengths, values = np.diff(starts, append=known.size), h[known][starts]
    jumps = np.abs(np.diff(values)) > OUTLIER * _median_step(h[known])
    alone = np.append(True, jumps) & np.append(jumps, True) & (starts.size > 1)
    kind = np.unique(values, return_inverse=True)[1]
    counts = np.bincount(kind, lengths * alone)
    runs = np.flatnonzero(alone & (counts >= FEWEST_DROPOUTS)[kind])
    if not runs.size:
        return line, {"count": 0} | _apart(raw, h)
    gone = np.concatenate([known[starts[run] : starts[run] + lengths[run]] for run in runs])
    ends = [(known[starts[run]], known[starts[run] + lengths[run] - 1]) for run in runs]
    unit = raw.facts["unit_h"]
    facts: Step = {"count": int(gone.size), "places": _shortened([raw.stretch(int(a), int(b)) for a, b in ends])}
    facts |= {"values": _shortened([f"{value / METRES[unit]:.9g} {unit}" for value in np.unique(values[runs])])}
    if method == "keep":
        return line, facts
    rest = h.copy()
    rest[gone] = np.nan
    _known(raw, rest)
    return (x, rest), facts | _apart(raw, rest)


def _apart(raw: RawScan, h: FloatArray) -> Step:
    """The fewer samples on one side of the widest gap between heights, where it is wider than the others span."""
    known = np.flatnonzero(np.isfinite(h))
    ranked = known[np.argsort(h[known], kind="stable")]
    gaps = np.diff(h[ranked])
    split = int(np.argmax(gaps)) + 1
    few, others = sorted((ranked[:split], ranked[split:]), key=len)
    span = float(np.ptp(h[others]))
    few = np.sort(few)
    runs = np.split(few, np.flatnonzero(np.diff(few) > 1) + 1)
    if few.size < FEWEST_DROPOUTS * len(runs) or not 0.0 < span < gaps[split - 1]:
        return {}
    places = _shortened([raw.stretch(int(run[0]), int(run[-1])) for run in runs])
    return {"apart": {"count": int(few.size), "places": places, "distance": float(gaps[split - 1]), "span": span}}


def _shortened(places: list[str]) -> str:
    """The first places, and whether there are more."""
    return ", ".join(places[:SHOWN]) + (", .." if len(places) > SHOWN else "")


def _outliers(raw: RawScan, line: Line, method: str) -> tuple[Line, Step]:
    """Samples far from the running median of those that are there."""
    x, h = line
    known = np.flatnonzero(np.isfinite(h))
    threshold = OUTLIER * _median_step(h[known])
    middle = import_module("scipy.ndimage").median_filter(h[known], WIDTH, mode="mirror")
    excess = np.abs(h[known] - middle)
    far = excess > threshold
    facts: Step = {"count": int(far.sum()), "width": WIDTH, "median_steps": OUTLIER}
    if far.any():
        facts |= {"threshold": threshold, "largest": float(excess.max()), "first": raw.place(int(known[far][0]))}
    if method == "keep" or not far.any():
        return line, facts
    replaced = h.copy()
    replaced[known[far]] = middle[far]
    return (x, replaced), facts


def _missing(raw: RawScan, line: Line, method: str, dropouts: Step) -> tuple[Line, Step]:
    """Gaps filled, ends cut."""
    x, h = line
    gone = np.flatnonzero(np.isnan(h))
    facts: Step = {"count": int(gone.size)}
    if not gone.size:
        return line, facts
    if method == "refuse":
        found = f'= "refuse", and {gone.size} of {h.size} heights are missing'
        allowed = 'missing = "interpolate" fills gaps along straight lines'
        if dropouts["count"] and dropouts["method"] == "missing":
            found += f" or dropouts: {dropouts['values']} in {dropouts['places']}"
            allowed += '; dropouts = "keep" takes these for heights'
        else:
            found += f" ({_shortened([raw.place(int(k)) for k in gone])})"
        raise ScanFileError([Refusal("missing", found, allowed)])
    known = np.flatnonzero(np.isfinite(h))
    first, last = int(known[0]), int(known[-1])
    runs = np.diff(known) - 1
    facts |= {"longest_gap": int(runs.max()), "cut_at_ends": [first, h.size - 1 - last]}
    inside = slice(first, last + 1)
    return (x[inside], np.interp(x[inside], x[known], h[known])), facts


def _even(raw: RawScan, line: Line, missing: Step, method: str) -> tuple[Line, Step]:
    """Uniform positions, or a refusal."""
    x, h = line
    first = missing.get("cut_at_ends", [0])[0]
    found = equal_steps(raw, x, first)
    if found is not None:
        return (found[0], h), found[1]
    grid = uniform(x)
    worst, deviation = deviation_of(x, grid)
    facts: Step = {"deviation": deviation}
    if method == "refuse":
        place = raw.place(first + worst)
        told = f"is not uniform in x: {place} is {deviation:.2g} sample distances off a uniform grid"
        allowed = f'at most {UNIFORMITY:g}, or half the last digit printed; or unequal_spacing = "resample"'
        raise ScanFileError([Refusal("file", told, allowed)])
    curve = import_module("scipy.interpolate").PchipInterpolator(x, h)
    gaps = np.diff(x)
    facts |= {"least": float(gaps.min()), "most": float(gaps.max())}
    return (grid, np.asarray(curve(grid))), facts


def _detrended(line: Line, method: str) -> tuple[Line, Step]:
    """The line less a polynomial fitted to it, and the range of that polynomial."""
    x, h = line
    tilt = np.polynomial.Polynomial.fit(x, h, 1)
    facts: Step = {"tilt": float(tilt.deriv()(0.0)), "rms_without_tilt": float(np.std(h - tilt(x)))}
    if method == "none":
        return line, facts
    if DEGREES[method] == 0:
        return (x, h - h.mean()), facts | {"removed": [float(h.mean())] * 2}
    trend = np.polynomial.Polynomial.fit(x, h, DEGREES[method])(x)
    return (x, h - trend), facts | {"removed": [float(trend[0]), float(trend[-1])]}


def _periodic(line: Line, method: str) -> tuple[Line, Step]:
    """A line that can be repeated."""
    x, h = line
    if method == "mirror":
        step = (x[-1] - x[0]) / (x.size - 1)
        return (x[0] + step * np.arange(2 * x.size), np.concatenate([h, h[::-1]])), {}
    if method == "window":
        return (x, h * import_module("scipy.signal.windows").tukey(x.size, 2 * TAPER)), {"taper": TAPER}
    return line, {}
