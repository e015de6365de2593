"""Preparation of a measured line to the samples of a periodic profile, every step recorded.

In this order, each as [profile] asks for it:

dropouts, outliers, missing   Heights that are none of the surface (prepare_heights.py).
spacing    Positions at equal steps (prepare_spacing.py).
detrend    A least-squares polynomial is subtracted: degree 0 (mean) to 3 (cubic).  A profile has no mean in any case.
spectrum   Nothing is changed: the power spectrum and its noise floor, with the cut that follows (noise_floor.py).
periodic   "as_is": n samples at distance dx are the period n dx.  "mirror": followed by the same in reverse, 2 n dx.
           "window": multiplied by a cosine-tapered window (Tukey's; Harris, Proc. IEEE 66 (1978) 51) that goes to zero
           over `TAPER` of the line at either end.
filter     Gaussian filters of ISO 16610-21, profile.cutoff_short and cutoff_long (gaussian_filter.py), mode by mode.
cut        Harmonics from 1 to profile.harmonics are kept (Profile.from_samples).

Each step has the rms height and the rms slope before and after: of the samples about their mean, and of the steps
between neighbours over their distance; after the cut, of the harmonics.
scipy is imported by the steps that need it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np

from bem.scans.gaussian_filter import GaussianFilter
from bem.scans.measured_line import MeasuredLine, Outcome, Step
from bem.scans.noise_floor import Spectrum
from bem.scans.periodic_samples import PeriodicSamples
from bem.scans.prepare_heights import refuse_few, without_dropouts, without_gaps, without_outliers
from bem.scans.prepare_spacing import equally_spaced, refuse_disorder
from bem.scans.scan_file_error import ScanFileError, refused
from bem.scans.scan_keys import DEFAULTS

TAPER = 0.1  # format: of the line, at either end
DEGREES = {"mean": 0, "line": 1, "quadratic": 2, "cubic": 3}
RIDGE = "a row of a map is solved as a ridge: its heights are the same all along the other direction of the map"


def prepare(measured: MeasuredLine, values: Mapping[str, Any]) -> PeriodicSamples:
    """Return the samples of a period.

    `values` are those of [profile]: dropouts, missing, outliers, detrend, periodic, unequal_spacing, cutoff_short,
    cutoff_long, as far as they are given.
    ScanFileError for positions that do not increase or are unequal, missing samples, fewer than three samples or
    more than half of them missing, cut-offs that the line does not hold.
    """
    asked = DEFAULTS | {key: values[key] for key in DEFAULTS if key in values}
    refuse_disorder(measured)
    refuse_few(measured)
    height, slope = measured.roughness
    steps: list[Step] = [
        {"step": "read"} | measured.facts | {"samples": measured.h.size, "rms_height": height, "rms_slope": slope}
    ]
    if "row" in measured.facts:
        steps.append({"step": "map", "model": RIDGE})
    line = measured

    def record(step: str, method: str, outcome: Outcome) -> MeasuredLine:
        """Record the change of the line by a step, and return the new line."""
        new, facts = outcome
        change = zip(("rms_height", "rms_slope"), zip(line.roughness, new.roughness, strict=True), strict=True)
        steps.append({"step": step, "method": method} | facts | {name: list(both) for name, both in change})
        return new

    line = record("dropouts", asked["dropouts"], without_dropouts(line, asked["dropouts"]))
    dropouts = steps[-1]
    line = record("outliers", asked["outliers"], without_outliers(line, asked["outliers"]))
    line = record("missing", asked["missing"], without_gaps(line, asked["missing"], dropouts))
    line = record("spacing", asked["unequal_spacing"], equally_spaced(line, asked["unequal_spacing"]))
    line = record("detrend", asked["detrend"], _detrended(line, asked["detrend"]))
    spectrum = Spectrum(line.h, float(line.x[-1] - line.x[0]) / (line.x.size - 1))
    steps.append({"step": "spectrum"} | spectrum.facts())
    line = record("periodic", asked["periodic"], _periodic(line, asked["periodic"]))
    samples = PeriodicSamples(line.x, line.h, measured, spectrum)
    steps[-1] |= {"period": samples.period, "end_jump": samples.end_jump}
    gaussian = GaussianFilter.of(values)
    mistakes = list(gaussian.mistakes(samples.spacing, spectrum.h.size * samples.spacing))
    if mistakes:
        raise ScanFileError(mistakes)
    if gaussian.cuts:
        line = record("filter", "gaussian", (replace(line, h=gaussian.applied(line.h, samples.spacing)), gaussian.cuts))
    return replace(samples, h=line.h, gaussian=gaussian, steps=tuple(steps))


def _detrended(line: MeasuredLine, method: str) -> Outcome:
    """Return the line without the least-squares polynomial that `method` names, and what was subtracted.

    The tilt and the bow of the line, and the values subtracted at its first and last sample.
    """
    x, h = line.x, line.h
    tilt, parabola = (np.polynomial.Polynomial.fit(x, h, degree) for degree in (1, 2))
    facts: Step = {"tilt": float(tilt.deriv()(0.0)), "rms_without_tilt": float(np.std(h - tilt(x)))}
    bow = parabola(x) - tilt(x)
    facts |= {"bow": float(np.ptp(bow)), "rms_bow": float(np.std(bow))}
    if method == "none":
        return line, facts
    if DEGREES[method] >= x.size:
        raise refused("detrend", f'= "{method}" of {x.size} samples', f"more than {DEGREES[method]} samples")
    if DEGREES[method] == 0:
        return replace(line, h=h - h.mean()), facts | {"removed": [float(h.mean())] * 2}
    trend = np.polynomial.Polynomial.fit(x, h, DEGREES[method])(x)
    return replace(line, h=h - trend), facts | {"removed": [float(trend[0]), float(trend[-1])]}


def _periodic(line: MeasuredLine, method: str) -> Outcome:
    """Return a line that can be repeated."""
    x, h = line.x, line.h
    if method == "mirror":
        step = (x[-1] - x[0]) / (x.size - 1)
        return replace(line, x=x[0] + step * np.arange(2 * x.size), h=np.concatenate([h, h[::-1]])), {}
    if method == "window":
        return replace(line, h=h * import_module("scipy.signal.windows").tukey(x.size, 2 * TAPER)), {"taper": TAPER}
    return line, {}
