"""Measured line: positions and heights in m, from its file to the last step of its preparation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from bem.geometry.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class MeasuredLine:
    """Positions and heights of a line, and where they stand in its file.

    Examples
    --------
    >>> line = MeasuredLine(np.arange(4.0), np.array([1.0, -1.0, 1.0, -1.0]), {})
    >>> line.roughness, line.place(0, 2)
    ((1.0, 2.0), 'samples 1 to 3')
    """

    x: FloatArray  # positions, m, (n,)
    h: FloatArray  # heights, m, (n,); NaN where missing
    facts: dict[str, Any]  # how it was read: plain values
    sha256: str = ""  # of the file's bytes
    lines: IntArray | None = None  # line of the file of each sample read; None where there are no lines
    half_digits: Callable[[], FloatArray] | None = None  # half a unit of the last digit of each position read, m
    cut: int = 0  # samples read that were cut off before the first

    def place(self, first: int, last: int | None = None) -> str:
        """Return the place of a sample (from 0), or of samples `first` to `last`, in the file."""
        ends = [self.cut + sample for sample in (first, first if last is None else last)]
        word, numbers = "sample", [end + 1 for end in ends]
        if self.lines is not None:
            word, numbers = "line", [int(self.lines[end]) for end in ends]
        return f"{word} {numbers[0]}" if ends[0] == ends[1] else f"{word}s {numbers[0]} to {numbers[1]}"

    @property
    def roughness(self) -> tuple[float, float]:
        """rms height (m) about the mean and rms slope between neighbours, missing heights left out."""
        known = np.isfinite(self.h)
        slopes = np.diff(self.h[known]) / np.diff(self.x[known])
        return float(np.std(self.h[known])), float(np.sqrt(np.mean(slopes**2)))


Step = dict[str, Any]  # of the preparation: its name, what was done, and what changed, as plain values
Outcome = tuple[MeasuredLine, Step]  # of a step: the new line, and what was done
