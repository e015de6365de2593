"""Targets of a loading path: expansion of a range, the way back, and targets that equal a value.

Values are those of the controlled quantity (m, or Pa for mean_pressure).  The path begins at an origin that
may be infinite: a separated profile comes from separation +inf (penetration -inf), one in complete contact
from the other end; under mean-pressure control a separated profile begins at first touch, at zero load.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

SAME = 1e-9  # format: values closer than this, relative to the largest one, are one target


def expanded(start: float, stop: float, count: int, then_back_to: float | None = None) -> tuple[float, ...]:
    """Return `count` values from start to stop and, if asked for, as many back, the turning point once.

    Examples
    --------
    >>> expanded(0.0, 2.0, 3, then_back_to=1.0)
    (0.0, 1.0, 2.0, 1.5, 1.0)
    """
    way = np.linspace(start, stop, count)
    if then_back_to is not None:
        way = np.append(way, np.linspace(stop, then_back_to, count)[1:])
    return tuple(float(value) for value in way)


def origin(control: str, initial: str, first: float) -> float:
    """Return the controlled value where the path begins, for `initial` "separated" or "complete_contact"."""
    if control == "mean_pressure":
        return 0.0 if initial == "separated" else first
    away = math.inf if control == "separation" else -math.inf
    return away if initial == "separated" else -away


def unloads(control: str, start: float, stop: float) -> bool:
    """Return whether a leg of the path reduces penetration or load.

    Examples
    --------
    >>> unloads("separation", 1.0, 2.0), unloads("mean_pressure", 1.0, 2.0)
    (True, False)
    """
    return stop > start if control == "separation" else stop < start


def equal_target(value: float, targets: Sequence[float]) -> float | None:
    """Return the target that equals `value` within `SAME` of the largest target; None without such a target."""
    if not targets:
        return None
    nearest = min(targets, key=lambda target: abs(target - value))
    return nearest if abs(nearest - value) <= SAME * max(abs(value), *map(abs, targets)) else None
