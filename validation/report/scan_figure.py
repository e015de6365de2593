"""A scan before and after its preparation: heights as measured and as they are solved, and in words what was done.

The numbers are those that a result stores (`Scan.drawn` in bem/scans/scan_preparation.py): scan_x, scan_h and
profile_x, profile_h in m.  Both lines are drawn about their own mean.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bem.command_line.answer_table import axis_unit
from validation.harness.figure_data import axes, drawn, trace
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
    """The figure of a result, from its fields and `profile_preparation`; None where its profile is no scan.

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


def caption_of(steps: Sequence[Mapping[str, Any]]) -> str:
    """What was done to a scan, in a sentence."""
    samples = next(step["samples"] for step in steps if step["step"] == "read")
    done = [SAID.get(step["step"], {}).get(step.get("method", ""), "").format_map(step) for step in steps
            if step.get("count") != 0]  # fmt: skip
    cut = next((step for step in steps if step["step"] == "cut"), None)
    if cut is not None:
        done.append(f"{cut['harmonics']} of {cut['of']} harmonics keep {cut['slope_share_kept']:.1%} of the rms slope")
    words = "; ".join(filter(None, done))
    return f"Scan of {samples} samples: {words or 'taken as it is'}."
