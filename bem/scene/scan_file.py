"""Two-column profile scans: positions x and heights h of a measured line, as text.

One sample a line, x then h in m, separated by a comma, a semicolon or blanks; empty lines and what follows
a `#` are skipped, and one heading without numbers is allowed.  x increases and is uniform within
1e-3 of the sample distance; the end point of the period is excluded, so that n samples at distance dx cover
the period n dx.  Every mistake of a file is reported, long lists shortened; nothing is repaired.
"""

from __future__ import annotations

import hashlib
import math
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bem.geometry.arrays import FloatArray

UNIFORMITY = 1e-3  # admitted deviation of a position, in sample distances
SHOWN = 3  # mistakes of one sort that are spelt out
FEWEST = 3  # samples that carry one harmonic


class ScanFileError(ValueError):
    """A scan that cannot be used; `mistakes` says everything that is wrong with it."""

    def __init__(self, mistakes: list[str]) -> None:
        super().__init__("; ".join(mistakes))
        self.mistakes = tuple(mistakes)


@dataclass(frozen=True, eq=False)
class Scan:
    """A uniform line scan.

    Parameters
    ----------
    x, h : (n,) arrays
        Positions and heights, m.
    sha256 : str
        Of the file's bytes.

    Examples
    --------
    >>> line = Scan(np.array([0.0, 0.5, 1.0]), np.zeros(3), "")
    >>> line.spacing, line.period, line.max_harmonics
    (0.5, 1.5, 1)
    """

    x: FloatArray
    h: FloatArray
    sha256: str

    @property
    def spacing(self) -> float:
        """Sample distance dx, m."""
        return float(self.x[-1] - self.x[0]) / (self.x.size - 1)

    @property
    def period(self) -> float:
        """Period n dx, m."""
        return self.spacing * self.x.size

    @property
    def max_harmonics(self) -> int:
        """Highest order below half the number of samples."""
        return int(self.x.size - 1) // 2


def read_scan(path: Path) -> Scan:
    """Read a scan and check all of it.

    Parameters
    ----------
    path : Path
        Text file with two columns x, h in m.

    Raises
    ------
    ScanFileError
        Missing or unreadable file, ragged rows, text that is not a number, NaN or infinity, fewer than three samples,
        positions that do not increase or are not uniform.
    """
    try:
        content = path.read_bytes()
        lines = content.decode("utf-8-sig").splitlines()
    except OSError as error:
        raise ScanFileError([f"cannot be read: {error.strerror or error}"]) from error
    except UnicodeDecodeError as error:
        raise ScanFileError([f"is not text: {error.reason} at byte {error.start}"]) from error
    rows, mistakes = _rows(lines)
    if not mistakes and len(rows) < FEWEST:
        mistakes = [f"holds {len(rows)} samples, at least {FEWEST} are needed"]
    if mistakes:
        raise ScanFileError(mistakes)
    table = np.array(rows)
    mistakes = _spacing_mistakes(table[:, 0])
    if mistakes:
        raise ScanFileError(mistakes)
    return Scan(table[:, 0].copy(), table[:, 1].copy(), hashlib.sha256(content).hexdigest())


def _rows(lines: list[str]) -> tuple[list[tuple[float, float]], list[str]]:
    """The samples, and what is wrong with the lines that hold none."""
    rows: list[tuple[float, float]] = []
    ragged: list[str] = []
    invalid: list[str] = []
    heading_allowed = True
    for number, line in enumerate(lines, start=1):
        text = line.split("#", 1)[0].strip()
        if not text:
            continue
        cells = re.split(r"\s*[,;]\s*|\s+", text)
        values = [_number(cell) for cell in cells]
        if heading_allowed and all(value is None for value in values):
            heading_allowed = False
            continue
        heading_allowed = False
        if len(cells) != 2:
            ragged.append(f"line {number} has {len(cells)} column{'s' * (len(cells) != 1)}, two are needed")
            continue
        x, h = values
        if x is None or h is None or not (math.isfinite(x) and math.isfinite(h)):
            invalid.append(f"line {number} ({text[:40]!r}) must hold two finite numbers")
        else:
            rows.append((x, h))
    return rows, [*_shortened(ragged), *_shortened(invalid)]


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _shortened(mistakes: list[str]) -> list[str]:
    """The first mistakes of one sort, and how many more there are."""
    rest = len(mistakes) - SHOWN
    return mistakes if rest <= 0 else [*mistakes[:SHOWN], f"and {rest} more lines like that"]


def _spacing_mistakes(x: FloatArray) -> list[str]:
    """Whether positions increase and are uniform."""
    backward = np.flatnonzero(np.diff(x) <= 0)
    if backward.size:
        k = int(backward[0]) + 1
        return [f"x is not increasing: sample {k + 1} at {x[k]:g} follows {x[k - 1]:g}"]
    uniform = x[0] + (x[-1] - x[0]) * np.arange(x.size) / (x.size - 1)
    deviation = np.abs(x - uniform) * (x.size - 1) / (x[-1] - x[0])
    worst = int(np.argmax(deviation))
    if deviation[worst] > UNIFORMITY:
        return [
            f"x is not uniform: sample {worst + 1} at {x[worst]:g} is {deviation[worst]:.2g} sample distances "
            f"away from a uniform grid, {UNIFORMITY:g} is allowed"
        ]
    return []
