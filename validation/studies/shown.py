"""What studies print: tables for a terminal, and memory measured."""

import math
import sys
from collections.abc import Sequence
from typing import Any


def text_table(columns: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """Columns aligned for a terminal; numbers to four digits.

    Examples
    --------
    >>> print(text_table(["n", "error"], [[8, 0.00123456], [16, None]]))
     n     error
     8  0.001235
    16         -
    """
    cells = [list(columns), *[[_shown(cell) for cell in row] for row in rows]]
    widths = [max(len(row[i]) for row in cells) for i in range(len(columns))]
    return "\n".join("  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)) for row in cells)


def peak_megabytes() -> float:
    """Largest resident memory of this process so far; nan where the system does not report it (Windows)."""
    if sys.platform == "win32":
        return math.nan
    import resource  # absent on Windows

    unit = 2**20 if sys.platform == "darwin" else 2**10
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def _shown(cell: Any) -> str:
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return "-"
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)
