"""A scan before and after its preparation: heights as measured and as solved, and the preparation in words.

The numbers are those that a result stores (`Scan.drawn` in bem/scans/prepared_scan.py): scan_x, scan_h and
profile_x, profile_h in m.  Both lines are drawn about their own mean.  A second figure is the power spectrum of the
scan, scan_density over scan_wavelength, with its noise floor and the profile's power law, as far as they are found, and
the wavelengths at which it is cut and should be (bem/scans/noise_floor.py).
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.command_line.answer_table import axis_unit, quantity
from bem.scans.scan_keys import CUTOFFS
from validation.harness.figure_data import axes, drawn, loglog, trace
from validation.harness.schema import Figure

SAID = {
    "outliers": {"keep": "spikes found and kept: {count}", "replace": "spikes replaced: {count}"},
    "missing": {"interpolate": "missing heights interpolated: {count}"},
    "spacing": {"resample": "resampled at equal distances"},
    "detrend": {
        "line": "a line subtracted",
        "quadratic": "a quadratic trend subtracted",
        "cubic": "a cubic trend subtracted",
    },
    "periodic": {"mirror": "mirrored", "window": "tapered to zero at both ends"},
}


def preparation_figure(fields: Mapping[str, NDArray[np.float64]], steps: Sequence[Mapping[str, Any]]) -> Figure | None:
    """Draw the scan and the profile of a result from its fields and `profile_preparation`; None without a scan.

    Examples
    --------
    >>> line = np.array([0.0, 1e-3, 2e-3]), np.array([1e-6, 0.0, 2e-6])
    >>> fields = dict(zip(("scan_x", "scan_h", "profile_x", "profile_h"), (*line, *line), strict=True))
    >>> figure = preparation_figure(fields, [{"step": "read", "samples": 3}, {"step": "periodic", "method": "mirror"}])
    >>> figure.caption, figure.solution.xlabel, [series.label for series in figure.solution.series]
    ('Scan of 3 samples: mirrored.', 'x / mm', ['as measured', 'as prepared'])
    >>> preparation_figure({}, []) is None
    True
    """
    if "scan_x" not in fields:
        return None
    lengths, heights = fields["profile_x"] - fields["profile_x"][0], fields["scan_h"] - np.nanmean(fields["scan_h"])
    (length, across), (height, upward) = (axis_unit(float(np.nanmax(np.abs(a))), "m") for a in (lengths, heights))
    series = []
    for name, label, style in (("scan", "as measured", "thin"), ("profile", "as prepared", "line")):
        x, h = length * fields[f"{name}_x"], height * fields[f"{name}_h"]
        y = [float(value) if np.isfinite(value) else None for value in h - np.nanmean(h)]
        series.append(trace(label, x, y, style))
    return drawn("preparation", caption_of(steps), axes(f"x / {across}", f"height / {upward}", *series))


def spectrum_figure(fields: Mapping[str, NDArray[np.float64]], steps: Sequence[Mapping[str, Any]]) -> Figure | None:
    """Draw the power spectrum over wavelengths; None for a result without a spectrum, or with equal heights.

    Examples
    --------
    >>> fields = {"scan_wavelength": np.array([8e-6, 2e-6]), "scan_density": np.array([4e-20, 1e-22])}
    >>> spectrum = {"step": "spectrum", "noise": "flat tail", "noise_density": 1e-22, "noise_rms": 5e-9}
    >>> steps = [spectrum, {"step": "filter", "cutoff_short": 5e-6}]
    >>> [series.label for series in spectrum_figure(fields, steps).solution.series]
    ['power spectrum of the scan', 'noise floor', 'cutoff_short, 5 µm']
    """
    positive = np.flatnonzero(fields.get("scan_density", np.zeros(0)) > 0)
    if not positive.size:
        return None
    wavelength, density = (fields[name][positive] for name in ("scan_wavelength", "scan_density"))
    length, unit = axis_unit(float(wavelength.min()), "m")
    series = [trace("power spectrum of the scan", length * wavelength, density)]
    facts = {key: value for step in steps for key, value in step.items() if step["step"] == "spectrum"}
    if "noise_density" in facts:
        ends = (wavelength.min(), wavelength.max())
        series.append(trace("noise floor", [length * end for end in ends], [facts["noise_density"]] * 2, "dashed"))
    height = [float(density.min()), float(density.max())]
    series += [trace(f"{name}, {length * at:.3g} {unit}", [length * at] * 2, height) for name, at in _cuts(steps)]
    return drawn("spectrum", _noise_in_words(facts), loglog(f"wavelength / {unit}", "density / m³", *series))


def _noise_in_words(facts: Mapping[str, Any]) -> str:
    """State noise floor and suggested cutoff of the spectrum of a scan in a sentence."""
    words = facts["noise"]
    if "noise_rms" in facts:
        words = f"a noise floor of {_rounded(facts['noise_rms'])} rms"
    if "suggested_cutoff" in facts:
        words += f"; the profile falls below it at {_rounded(facts['suggested_cutoff'])}"
    return f"Power spectrum of the scan, one-sided: {words}."


def _rounded(length: float) -> str:
    """Return a length to three digits as text."""
    return quantity(float(f"{length:.3g}"), "m")


def _cuts(steps: Sequence[Mapping[str, Any]]) -> Iterator[tuple[str, float]]:
    """Yield names and wavelengths (m) of the cuts of a scan and of the suggested cut."""
    by_name = {step["step"]: step for step in steps}
    if "period" in by_name.get("periodic", {}) and "cut" in by_name:
        yield "harmonics end", by_name["periodic"]["period"] / by_name["cut"]["harmonics"]
    for key in CUTOFFS:
        if key in by_name.get("filter", {}):
            yield key, by_name["filter"][key]
    if "suggested_cutoff" in by_name.get("spectrum", {}):
        yield "suggested cut", by_name["spectrum"]["suggested_cutoff"]


def caption_of(steps: Sequence[Mapping[str, Any]]) -> str:
    """Describe the preparation of a scan in a sentence."""
    samples = next(step["samples"] for step in steps if step["step"] == "read")
    done = [
        SAID.get(step["step"], {}).get(step.get("method", ""), "").format_map(step)
        for step in steps
        if step.get("count") != 0
    ]
    for step in steps:
        if step["step"] == "filter":
            cuts = (f"{key} {quantity(step[key], 'm')}" for key in CUTOFFS if key in step)
            done.append("Gaussian filter " + ", ".join(cuts))
    cut = next((step for step in steps if step["step"] == "cut"), None)
    if cut is not None:
        done.append(f"{cut['harmonics']} of {cut['of']} harmonics keep {cut['slope_share_kept']:.1%} of the rms slope")
    words = "; ".join(filter(None, done))
    return f"Scan of {samples} samples: {words or 'taken as it is'}."
