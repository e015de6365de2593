"""Preparation of a scan in sentences, one for each step, with lengths in units that a person reads.

The steps are those of `PeriodicSamples.preparation` (bem/scans); result.json keeps all their numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from bem.command_line.answer_table import quantity

if TYPE_CHECKING:
    from bem.scans.measured_line import Step

TRENDS = {"line": "least-squares line", "quadratic": "quadratic trend", "cubic": "cubic trend"}


def preparation_sentences(steps: Iterable[Step]) -> list[str]:
    """Return a sentence for each step of the preparation of a scan, with the change of its roughness.

    Examples
    --------
    >>> trend = {"step": "detrend", "method": "mean", "removed": [1e-6, 1e-6], "tilt": 2e-3}
    >>> preparation_sentences([trend | {"rms_height": [2e-6, 2e-6], "rms_slope": [0.1, 0.1]}])
    ['The mean height is subtracted, 1 µm.']
    >>> preparation_sentences([{"step": "outliers", "method": "keep", "count": 0}])
    ['There are no spikes.']
    """
    return [f"{SENTENCES[step['step']](step)}{_change(step)}." for step in steps]


def _read(step: Step) -> str:
    taken = f" ({step['taken']})" if "taken" in step else ""  # a result of an earlier version has no words for it
    rows = f", one row of a map of {step['rows']} rows{taken}" if "rows" in step else ""
    units = (
        f" in {step['unit_h']}"
        if step["unit_x"] == step["unit_h"]
        else f", positions in {step['unit_x']} and heights in {step['unit_h']}"
    )
    skipped = f"; {step['skip_lines']} lines above are skipped" if "skip_lines" in step else ""
    rough = f"rms height {_length(step['rms_height'])}, rms slope {step['rms_slope']:.3g}"
    return f"The trace has {step['samples']} samples{rows}{units}{skipped}; {rough}"


def _map(step: Step) -> str:
    return f"{step['model'][0].upper()}{step['model'][1:]}"


def _dropouts(step: Step) -> str:
    if not step["count"]:
        return "There are no dropouts"
    fate = "kept as heights" if step["method"] == "keep" else "taken for missing"
    return f"Dropouts ({step['values']} in {step['places']}): {_samples(step)} {fate}"


def _outliers(step: Step) -> str:
    if not step["count"]:
        return "There are no spikes"
    fate = "kept" if step["method"] == "keep" else "replaced by the median of its neighbours"
    limit = f"further than {_length(step['threshold'])} from the median of {step['width']} samples"
    return f"Spikes, {limit}: {_samples(step)} {fate}, the first at {step['first']}"


def _missing(step: Step) -> str:
    if not step["count"]:
        return "No heights are missing"
    cut = sum(step["cut_at_ends"])
    ends = f", {cut} of them cut off at the ends" if cut else ""
    filled = f"gaps are filled along straight lines, at most {step['longest_gap']} in a row"
    heights = "1 height is" if step["count"] == 1 else f"{step['count']} heights are"
    return f"{heights} missing{ends}; {filled}"


def _spacing(step: Step) -> str:
    if "least" in step:
        between = f"which lie {_length(step['least'])} to {_length(step['most'])} apart"
        return f"The samples, {between}, are interpolated at equal distances"
    if "printed_to" in step:
        return f"The samples are equally spaced within the last digit of their positions, {_length(step['printed_to'])}"
    return "The samples are equally spaced"


def _detrend(step: Step) -> str:
    if step["method"] == "none":
        return f"No trend is subtracted; the trace is tilted by {step['tilt']:.3g}"
    first, last = step["removed"]
    if step["method"] == "mean":
        return f"The mean height is subtracted, {_length(first)}"
    ends = f"{_length(first)} at the first sample and {_length(last)} at the last"
    return f"The {TRENDS[step['method']]} is subtracted, {ends}"


def _spectrum(step: Step) -> str:
    if "noise_rms" not in step:
        return f"The power spectrum shows {step['noise'].replace('no floor', 'no noise floor', 1)}"
    words = f"The power spectrum ends in a noise floor of {_length(step['noise_rms'])} rms"
    if "suggested_cutoff" in step:
        words += f", below which the profile falls at wavelengths under {_length(step['suggested_cutoff'])}"
    return words


def _periodic(step: Step) -> str:
    method = step["method"]
    if method == "mirror":
        return f"The trace is followed by its mirror image: the period is {_length(step['period'])}"
    jump = f"from its last sample to its first is a step of {step['end_jump']:.2g} times the rms step between samples"
    if method == "window":
        taper = f"Each end is tapered to zero over {step['taper']:.0%} of the trace"
        return f"{taper}: the period is {_length(step['period'])}"
    return f"The trace is repeated as it is, with the period {_length(step['period'])}; {jump}"


def _filter(step: Step) -> str:
    cuts = [("cutoff_short", "shorter"), ("cutoff_long", "longer")]
    waves = " and ".join(f"{word} than {_length(step[key])}" for key, word in cuts if key in step)
    return f"A Gaussian filter dampens waves {waves}"


def _cut(step: Step) -> str:
    kept = f"{step['slope_share_kept']:.1%} of the rms slope"
    return f"The first {step['harmonics']} of {step['of']} harmonics are kept, with {kept}"


SENTENCES: dict[str, Callable[[Step], str]] = {
    "read": _read,
    "map": _map,
    "dropouts": _dropouts,
    "outliers": _outliers,
    "missing": _missing,
    "spacing": _spacing,
    "detrend": _detrend,
    "spectrum": _spectrum,
    "periodic": _periodic,
    "filter": _filter,
    "cut": _cut,
}


def _samples(step: Step) -> str:
    return "1 sample is" if step["count"] == 1 else f"{step['count']} samples are"


def _change(step: Step) -> str:
    """Return by how much a step changes the rms height and the rms slope, as far as three digits show it."""
    words = []
    for key, name, text in (("rms_height", "rms height", _length), ("rms_slope", "rms slope", "{:.3g}".format)):
        values = step.get(key)
        if isinstance(values, list | tuple) and text(values[0]) != text(values[1]):
            words.append(f"{name} {text(values[0])} before, {text(values[1])} after")
    return "; " * bool(words) + ", ".join(words)


def _length(value: float) -> str:
    """Return a length with three digits."""
    return quantity(float(f"{value:.3g}"), "m")
