"""Axes in the numbers of a text file: lines or columns of positions, which are no heights.

A first or last line, or column, counts as an axis, and is refused, if its numbers only rise or only fall while those of
the next two do not.  If all of them do so but a number at an end, that number is the corner of two axes, and the side
that crosses there is refused too.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bem.geometry.arrays import FloatArray
from bem.scans.read_table import TextTable
from bem.scans.scan_file_error import refused

FEWEST_STEPPED, FEWEST_ORDERED = 4, 8  # format: numbers on an axis, at equal steps or in order; by chance, 1 in 20,000
EQUAL_STEP = 0.01  # format: admitted deviation of a step of an axis, in steps
BESIDE_CORNER = {"first": slice(1, None), "last": slice(None, -1)}  # numbers of an axis, by the end with a corner


def refuse_axes(table: TextTable, sides: Sequence[str]) -> None:
    """Raise ScanFileError for sides of the table that hold axes; a corner shows that two sides do."""
    turned = {"line": table.values, "column": table.values.T}
    axes = set()
    for side in sides:
        end, direction = side.split()
        axis = _axis(turned[direction][:: 1 if end == "first" else -1])
        if axis is not None:
            crossing = "column" if direction == "line" else "line"
            axes |= {side} | {f"{place} {crossing}" for place, part in BESIDE_CORNER.items() if part == axis}
    told = [side for side in sides if side in axes]
    if told:
        named = " and ".join(f"the {side}" for side in told)
        kinds = [{side.split()[1] for side in group} for group in (sides, told)]
        more = "".join(f" (and a {kind} of positions, if there is one)" for kind in kinds[0] - kinds[1])
        allowed = f"heights alone: remove {named}{more}, and give the step of the axis along the lines as spacing"
        raise refused("file", f"has axes in {named}, which are no heights", allowed)


def _axis(rows: FloatArray) -> slice | None:
    """Return the part of the first row that holds positions: in order where the next two rows are not."""
    parts = (slice(None), *BESIDE_CORNER.values())
    for stepped in (True, False):
        axes = [part for part in parts if _ordered(rows[0, part], stepped)]
        others = any(_ordered(row[part], stepped) for part in parts for row in rows[1:3])
        if axes and not others and rows.shape[0] > 1:
            return axes[0]
    return None


def _ordered(row: FloatArray, stepped: bool) -> bool:
    """Return whether numbers rise or fall, at equal steps or at any."""
    steps = np.diff(row)
    if row.size < (FEWEST_STEPPED if stepped else FEWEST_ORDERED) or not ((steps > 0).all() or (steps < 0).all()):
        return False
    return not stepped or float(np.abs(steps - steps.mean()).max()) <= EQUAL_STEP * abs(float(steps.mean()))
