"""What grids tend to: the answers of a solver on grids, each twice as fine, extrapolated, with the error estimated.

Contact counted in whole points is wrong by a term in the spacing; cohesion of a range that must span some spacings is
wrong by its range, which falls as the root of the spacing.  With r = 2 without adhesion and r = sqrt 2 with it, and the
two finest grids,

    x = fine + (fine - coarse) / (r - 1).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from validation.harness.route import Answer

WHOLE = ("patches",)  # counts, of which the finest grid's stands


def extrapolated(problem: Mapping[str, Any], grids: Sequence[Answer]) -> Answer:
    """The answers to a problem that grids, coarsest first, tend to; as the finest where it has none."""
    fine, coarse = grids[-1], grids[-2]
    if fine.status != "answered" or coarse.status != "answered":
        return fine if fine.status != "answered" else coarse
    ratio = math.sqrt(2) if "adhesion" in problem else 2.0
    answers = {
        name: value if name in WHOLE else _limit(value, coarse.values[name], ratio)
        for name, value in fine.values.items()
        if name in coarse.values
    }
    spent = [sum(getattr(grid, name) or 0.0 for grid in grids[-2:]) for name in ("seconds", "cpu_seconds")]
    told = f"from the two finest grids, errors falling by {ratio:.3g}"
    return Answer("answered", told, answers, seconds=spent[0], cpu_seconds=spent[1])


def _limit(fine: Any, coarse: Any, ratio: float) -> Any:
    if isinstance(fine, list):
        if len(fine) != len(coarse):
            return None
        return [_limit(x, y, ratio) for x, y in zip(fine, coarse, strict=True)]
    return None if fine is None or coarse is None else fine + (fine - coarse) / (ratio - 1)
