"""Positions of samples: that they increase, and whether their steps are equal, as far as their digits tell.

Steps are equal if every position is one of x_0 + k dx within `UNIFORMITY` of dx, or within half a unit of the last
digit that is printed: of such x_0 and dx the ones that leave most room are taken (a linear program in two unknowns,
of which only the corners of two convex chains bound it).
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.scan_file import RawScan
from bem.scans.scan_refusal import Refusal, ScanFileError

UNIFORMITY = 1e-3  # format: admitted deviation of a position, in sample distances


def refuse_disorder(raw: RawScan) -> None:
    """ScanFileError for positions that do not increase from sample to sample, by what they do instead."""
    order = _order(raw.x)
    if order == "increases":
        return
    steps = np.diff(raw.x)
    k = int(np.argmax(steps <= 0)) + 1
    allowed = {
        "falls": "positions that increase: reverse the order of the lines",
        "repeats values": "one height at each position: keep one of the lines that share a position",
    }.get(order, "positions that increase from line to line")
    other = _order(raw.h)
    if order == other == "goes to and fro" and raw.x[k] <= raw.x[:k].min() and (steps > 0).sum() > (steps <= 0).sum():
        order, allowed = "begins again", "one scan line: remove the others"
    found = f"is not increasing in x: {raw.place(k)} at {raw.x[k]:g} m follows {raw.x[k - 1]:g} m, it {order}"
    used = raw.used
    if used is not None and order == "goes to and fro" != other:
        found += f"; column {used[1]}, taken for heights, {other}: are these the positions?"
        allowed += f"; columns = [{used[1]}, {used[0]}] if that is so"
    raise ScanFileError([Refusal("file", found, allowed)])


def _order(values: FloatArray) -> str:
    """How values follow one another."""
    steps = np.diff(values)
    if (steps > 0).all():
        return "increases"
    if (steps < 0).all():
        return "falls"
    return "repeats values" if (steps >= 0).all() and steps.any() else "goes to and fro"


def equal_steps(raw: RawScan, x: FloatArray, first: int) -> tuple[FloatArray, dict[str, Any]] | None:
    """Positions at equal steps that these stand for, with what was found; None where their steps are unequal.

    `x` are positions of the scan from sample `first` on.
    """
    grid = uniform(x)
    _, deviation = deviation_of(x, grid)
    facts: dict[str, Any] = {"deviation": deviation}
    if deviation <= UNIFORMITY:
        return x, facts
    if raw.half_digits is None:
        return None
    half = raw.half_digits()[first : first + x.size]
    line = _line_through(x, half + 4 * np.spacing(np.abs(x).max()))
    return None if line is None else (line, facts | {"printed_to": 2 * float(half.min())})


def uniform(x: FloatArray) -> FloatArray:
    """As many positions at equal steps between the same ends."""
    return np.asarray(x[0] + (x[-1] - x[0]) * np.arange(x.size) / (x.size - 1))


def deviation_of(x: FloatArray, grid: FloatArray) -> tuple[int, float]:
    """The position that is farthest from its place, and how far, in sample distances."""
    deviation = np.abs(x - grid) * ((x.size - 1) / (x[-1] - x[0]))
    worst = int(np.argmax(deviation))
    return worst, float(deviation[worst])


def _line_through(x: FloatArray, half: FloatArray) -> FloatArray | None:
    """x_0 + k dx within `half` of every x_k, as far inside as can be; None where there is none."""
    shares, grid, scale = np.arange(x.size) / (x.size - 1), uniform(x), float(half.max())
    rows, limits = [], []
    for side in (1.0, -1.0):  # side (offset + tilt share) + room <= side (x - grid) + half
        for share, limit in _lower_chain(shares, (side * (x - grid) + half) / scale):
            rows.append([side, side * share, 1.0])
            limits.append(limit)
    found = import_module("scipy.optimize").linprog([0, 0, -1], rows, limits, bounds=[(None, None)] * 3)
    if found.status != 0 or found.x[2] < 0:
        return None
    offset, tilt, _ = found.x * scale
    return np.asarray(grid + offset + tilt * shares)


def _lower_chain(x: FloatArray, y: FloatArray) -> list[tuple[float, float]]:
    """The corners of the largest convex curve below points in the order of x (Andrew, Inf. Proc. Lett. 9 (1979) 216).

    Examples
    --------
    >>> _lower_chain(np.array([0.0, 1.0, 2.0, 3.0]), np.array([0.0, 2.0, 0.5, 3.0]))
    [(0.0, 0.0), (2.0, 0.5), (3.0, 3.0)]
    """
    chain: list[tuple[float, float]] = []
    for point in zip(x.tolist(), y.tolist(), strict=True):
        while len(chain) > 1 and _turns_right(chain[-2], chain[-1], point):
            chain.pop()
        chain.append(point)
    return chain


def _turns_right(first: tuple[float, float], second: tuple[float, float], third: tuple[float, float]) -> bool:
    return (second[0] - first[0]) * (third[1] - first[1]) <= (second[1] - first[1]) * (third[0] - first[0])
