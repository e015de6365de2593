"""Heights of a measured line that are no heights of the surface: dropouts, spikes and gaps.

dropouts   A value that an instrument writes where it has seen nothing (-9999, 32767, 0): runs of one value whose
           neighbours are more than `OUTLIER` median steps away, `FEWEST_DROPOUTS` samples of it or more, or one sample
           of a size in `NOTHING_SEEN` or above `UNSEEN`.  "missing" takes them for missing heights.
outliers   Samples that lie more than `OUTLIER` median steps between neighbours from the running median of `WIDTH`
           samples are counted and, with "replace", set to that median (Tukey, Exploratory Data Analysis, 1977,
           chapter 7).  Steps are |h_{i+1} - h_i| > 0.
missing    "interpolate" fills gaps along straight lines and cuts off what is missing at either end.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.geometry.lengths import METRES
from bem.scans.measured_line import MeasuredLine, Outcome
from bem.scans.pick_row import FEWEST_SAMPLES
from bem.scans.read_table import SHOWN
from bem.scans.scan_file_error import refused

OUTLIER = 15.0  # median steps; of a normal distribution of steps, ten standard deviations
WIDTH = 5  # samples of the running median, which sees spikes of one or two
FEWEST_DROPOUTS = WIDTH // 2 + 1  # samples of one value: of fewer the running median sees that they are spikes
MOST_MISSING = 0.5  # format: of the samples
NOTHING_SEEN = (9999.0, 99999.0, 32767.0, 32768.0, 65535.0, 2147483647.0, 2147483648.0)  # format: ends of integers
UNSEEN = 1e30  # format: in the unit of the file, of the ends of single precision


def refuse_few(line: MeasuredLine) -> None:
    """Raise ScanFileError for too few heights."""
    known = int(np.isfinite(line.h).sum())
    if known < FEWEST_SAMPLES:
        problem = f"holds {known} samples with a height"
        raise refused("file", problem, f"at least {FEWEST_SAMPLES} of them")
    if known < (1 - MOST_MISSING) * line.h.size:
        problem = f"lacks {line.h.size - known} of {line.h.size} heights"
        raise refused("file", problem, f"at most {MOST_MISSING:.0%} missing, as missing_value and valid_value say")


def without_dropouts(line: MeasuredLine, method: str) -> Outcome:
    """Return the line and a record of its dropouts, which are marked as missing unless `method` is "keep"."""
    h = line.h
    known = np.flatnonzero(np.isfinite(h))
    starts = np.flatnonzero(np.diff(h[known], prepend=np.nan) != 0)  # of runs of one value
    lengths, values = np.diff(starts, append=known.size), h[known][starts]
    jumps = np.abs(np.diff(values)) > OUTLIER * _median_step(h[known])
    alone = np.append(True, jumps) & np.append(jumps, True) & (starts.size > 1)
    kinds, kind = np.unique(values, return_inverse=True)
    unit = line.facts["unit_h"]
    sizes = np.abs(kinds) / METRES[unit]
    nothing = (sizes > UNSEEN) | np.isclose(sizes[:, None], NOTHING_SEEN, rtol=1e-12).any(axis=1)
    many = nothing | (np.bincount(kind, lengths * alone) >= FEWEST_DROPOUTS)
    runs = np.flatnonzero(alone & many[kind])
    if not runs.size:
        return line, {"count": 0}
    gone = np.concatenate([known[starts[run] : starts[run] + lengths[run]] for run in runs])
    ends = [(known[starts[run]], known[starts[run] + lengths[run] - 1]) for run in runs]
    facts = {"count": int(gone.size), "places": _shortened([line.place(int(a), int(b)) for a, b in ends])}
    facts |= {"values": _shortened([f"{value / METRES[unit]:.9g} {unit}" for value in np.unique(values[runs])])}
    if method == "keep":
        return line, facts
    rest = h.copy()
    rest[gone] = np.nan
    line = replace(line, h=rest)
    refuse_few(line)
    return line, facts


def _median_step(h: FloatArray) -> float:
    """Return the median of the steps > 0 between neighbours; infinity without such steps."""
    steps = np.abs(np.diff(h))
    return float(np.median(steps[steps > 0])) if steps.any() else np.inf


def without_outliers(line: MeasuredLine, method: str) -> Outcome:
    """Return the line and a record of samples far from the running median, replaced unless `method` is "keep"."""
    h = line.h
    known = np.flatnonzero(np.isfinite(h))
    threshold = OUTLIER * _median_step(h[known])
    middle = import_module("scipy.ndimage").median_filter(h[known], WIDTH, mode="mirror")
    excess = np.abs(h[known] - middle)
    far = excess > threshold
    facts: dict[str, Any] = {"count": int(far.sum()), "width": WIDTH, "median_steps": OUTLIER}
    if far.any():
        facts |= {"threshold": threshold, "largest": float(excess.max()), "first": line.place(int(known[far][0]))}
    if method == "keep" or not far.any():
        return line, facts
    replaced = h.copy()
    replaced[known[far]] = middle[far]
    return replace(line, h=replaced), facts


def without_gaps(line: MeasuredLine, method: str, dropouts: Mapping[str, Any]) -> Outcome:
    """Return the line with gaps filled and ends cut off, and a record of gaps; ScanFileError if gaps are refused."""
    x, h = line.x, line.h
    gone = np.flatnonzero(np.isnan(h))
    facts: dict[str, Any] = {"count": int(gone.size)}
    if not gone.size:
        return line, facts
    if method == "refuse":
        problem = f'= "refuse", and {gone.size} of {h.size} heights are missing'
        allowed = 'missing = "interpolate" fills gaps along straight lines'
        if dropouts["count"] and dropouts["method"] == "missing":
            problem += f" or dropouts: {dropouts['values']} in {dropouts['places']}"
            allowed += '; dropouts = "keep" takes these for heights'
        else:
            problem += f" ({_shortened([line.place(int(k)) for k in gone])})"
        raise refused("missing", problem, allowed)
    known = np.flatnonzero(np.isfinite(h))
    first, last = int(known[0]), int(known[-1])
    runs = np.diff(known) - 1
    facts |= {"longest_gap": int(runs.max()), "cut_at_ends": [first, h.size - 1 - last]}
    inside = x[first : last + 1]
    return replace(line, x=inside, h=np.interp(inside, x[known], h[known]), cut=line.cut + first), facts


def _shortened(places: list[str]) -> str:
    """Return the first `SHOWN` places, followed by dots if there are more."""
    return ", ".join(places[:SHOWN]) + (", .." if len(places) > SHOWN else "")
