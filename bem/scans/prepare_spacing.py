"""Positions of samples at equal steps: checked as far as their digits tell, or resampled.

Steps are equal if every position is one of x_0 + k dx within `EQUAL_STEPS` of dx, where the ends are exact, or within
half a unit of the last digit that is printed: of such x_0 and dx the ones that leave most room are taken (a linear
program in two unknowns, which only the corners of two convex hulls bound).  The samples then have exactly these
positions: heights stay as they are.  "resample" puts as many samples at equal distances on a curve
through the measured ones that does not overshoot (Fritsch, Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300).
"""

from __future__ import annotations

from dataclasses import replace
from importlib import import_module
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.geometry.profile import EQUAL_STEPS, off_equal_steps
from bem.scans.measured_line import MeasuredLine, Outcome
from bem.scans.scan_file_error import refused


def refuse_disorder(line: MeasuredLine) -> None:
    """Raise ScanFileError for positions that do not increase from sample to sample."""
    falls = np.diff(line.x) <= 0
    if falls.any():
        k = int(np.argmax(falls)) + 1
        allowed = "positions that increase: reverse lines that fall, remove lines that repeat a position, keep one of "
        allowed += "several scan lines, or name another column of positions in columns"
        problem = f"is not increasing in x: {line.place(k)} at {line.x[k]:g} m follows {line.x[k - 1]:g} m"
        raise refused("file", problem, allowed)


def equally_spaced(line: MeasuredLine, method: str) -> Outcome:
    """Return the line at equal steps, and a record of the steps; ScanFileError if unequal steps are refused."""
    x, h = line.x, line.h
    grid = x[0] + (x[-1] - x[0]) * np.arange(x.size) / (x.size - 1)
    deviations = off_equal_steps(x)
    worst = int(np.argmax(deviations))
    facts: dict[str, Any] = {"deviation": float(deviations[worst])}
    if facts["deviation"] <= EQUAL_STEPS:
        return replace(line, x=grid), facts
    if line.half_digits is not None:
        half = line.half_digits()[line.cut : line.cut + x.size]
        even = _line_through(x, grid, half + 4 * np.spacing(np.abs(x).max()))
        if even is not None:
            return replace(line, x=even), facts | {"printed_to": 2 * float(half.min())}
    if method == "refuse":
        problem = f"is not uniform in x: {line.place(worst)} is {deviations[worst]:.2g} sample distances off a"
        allowed = f'at most {EQUAL_STEPS:g}, or half the last digit printed; or unequal_spacing = "resample"'
        raise refused("file", f"{problem} uniform grid", allowed)
    curve = import_module("scipy.interpolate").PchipInterpolator(x, h)
    gaps = np.diff(x)
    return replace(line, x=grid, h=np.asarray(curve(grid))), facts | {
        "least": float(gaps.min()),
        "most": float(gaps.max()),
    }


def _line_through(x: FloatArray, grid: FloatArray, half: FloatArray) -> FloatArray | None:
    """Return x_0 + k dx within `half` of every x_k, as far inside as possible; None if no such line exists."""
    shares, scale = np.arange(x.size) / (x.size - 1), float(half.max())
    rows, limits = [], []
    for side in (1.0, -1.0):  # side (offset + tilt share) + room <= side (x - grid) + half
        bars = (side * (x - grid) + half) / scale
        for k in import_module("scipy.spatial").ConvexHull(np.column_stack([shares, bars])).vertices:
            rows.append([side, side * shares[k], 1.0])
            limits.append(bars[k])
    program = import_module("scipy.optimize").linprog([0, 0, -1], rows, limits, bounds=[(None, None)] * 3)
    if program.status != 0 or program.x[2] < 0:
        return None
    offset, tilt, _ = program.x * scale
    return np.asarray(grid + offset + tilt * shares)
