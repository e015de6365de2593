"""Distances of samples and widths that a file states, against its positions and the scene's `spacing`.

A width is that of n samples: n dx between the outer edges of n pixels, or (n - 1) dx from the first centre to the last.
Of a map it is taken as n dx, as images are; both agree with a spacing.  Each is right to half its last digit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.scan_header import Length
from bem.scans.scan_keys import METRES
from bem.scans.scan_refusal import Refusal, ScanFileError


def distance_of(lengths: Sequence[Length], bare: Sequence[str], count: int, is_map: bool) -> tuple[float, Length]:
    """The distance of samples (m) that a file states, and where; ScanFileError where it states none, or two.

    `bare` are lines with one in no unit.
    """
    for length in lengths:
        if length.kind == "width" and not is_map:
            continue
        dx = length.metres / (1 if length.kind == "spacing" else count)
        unlike = next((other for other in lengths if not _agree(dx, other, count, length.half_digit)), None)
        if unlike is None:
            return dx, length
        found = f"has more than one value in the file: {length}, {unlike}"
        raise ScanFileError([Refusal("spacing", found, "correct the file, or remove the line that is wrong")])
    allowed = "the distance of two samples in unit_x: the file has heights alone"
    if not lengths:
        found = f"is missing: {bare[0]} has no unit" if bare else "is missing"
        raise ScanFileError([Refusal("spacing", found, allowed)])
    width = lengths[0]
    edges, centres = (f"{width.metres / n / METRES[width.unit]:.9g}" for n in (count, max(count - 1, 1)))
    allowed = (
        f'spacing = {centres} if it is from the first sample to the last, {edges} if beyond (unit_x = "{width.unit}")'
    )
    raise ScanFileError([Refusal("spacing", f"is missing: {width} is a width", allowed)])


def refuse_other_distance(spacing: float, unit: str, lengths: Sequence[Length], count: int) -> None:
    """ScanFileError for a spacing of the scene, in its unit, that is not what the file states."""
    for length in lengths:
        if _agree(spacing * METRES[unit], length, count):
            continue
        found = f"= {spacing:g} {unit} contradicts {length}"
        if length.kind == "width":
            found += f": {count} samples are {spacing * count:g} {unit}"
        right = length.metres / METRES[unit] / (1 if length.kind == "spacing" else count)
        raise ScanFileError([Refusal("spacing", found, f"spacing = {right:.9g}, or correct the file")])


def unlike_positions(x: FloatArray, unit: str, lengths: Sequence[Length]) -> str:
    """The statement that the positions (m) contradict, or ""; ScanFileError if the unit stated would explain it."""
    dx = float(x[-1] - x[0]) / (x.size - 1)
    for length in lengths:
        if _agree(dx, length, x.size):
            continue
        if _agree(dx * METRES[length.unit] / METRES[unit], length, x.size):
            found = f'= "{unit}" contradicts {length}: the positions are that in "{length.unit}"'
            raise ScanFileError([Refusal("unit_x", found, f'unit_x = "{length.unit}", or correct the file')])
        return str(length)
    return ""


def _agree(dx: float, length: Length, count: int, doubt: float = 0.0) -> bool:
    """Whether a distance of samples, m, is the one stated, or makes the width."""
    rounding = (length.half_digit + doubt) * (1 + 1e-9) + 4 * float(np.spacing(length.metres))
    if length.kind == "spacing":
        return abs(dx - length.metres) <= rounding
    return dx * (count - 1) - rounding <= length.metres <= dx * count + rounding
