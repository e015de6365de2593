"""The state between two points of a path at which the load has a given value.

On a branch the load is a smooth function of the control value; it is found by the Illinois form of the secant,
with the predictor and Newton of the path, at the accuracy of a target.  Dimensionless.
"""

from __future__ import annotations

from bem.convex_path import ContactPoint, ConvexPath
from bem.path import Path, Point

SECANT_STEPS = 30
BISECTIONS = 8
LOAD_ACCURACY = 1e-11


def at_load(
    path: Path | ConvexPath, before: Point | ContactPoint, after: Point | ContactPoint, load: float
) -> Point | ContactPoint | None:
    """The polished point between two points at which the load is `load`; None when an event jumped over it.

    Parameters
    ----------
    path : Path or ConvexPath
    before, after : Point or ContactPoint
        With edges; an event at `after` ends the branch there.
    load : float
        Dimensionless load per period.
    """
    assert before.state is not None
    end = _branch_end(path, before, after.value) if after.events else after
    if end is None or end.state is None:
        return None
    low, low_miss = before.value, before.state.load - load
    high, high_miss = end.value, end.state.load - load
    if low_miss * high_miss > 0:
        return None
    last_side = 0
    for _ in range(SECANT_STEPS):
        found = _at_value(path, before, low - low_miss * (high - low) / (high_miss - low_miss))
        if found is None or found.state is None:
            return None
        miss = found.state.load - load
        if abs(miss) <= LOAD_ACCURACY * max(abs(load), 1e-3):
            return found
        side = 1 if miss * high_miss > 0 else -1
        if side > 0:
            high, high_miss = found.value, miss
            low_miss = low_miss / 2 if last_side == side else low_miss
        else:
            low, low_miss = found.value, miss
            high_miss = high_miss / 2 if last_side == side else high_miss
        last_side = side
    return None


def _branch_end(path: Path | ConvexPath, before: Point | ContactPoint, value: float) -> Point | ContactPoint | None:
    """The last point of the branch of `before` that Newton reaches on the way to an event at `value`."""
    reached, beyond = before.value, value
    last = _at_value(path, before, value)
    if last is not None:
        return last
    for _ in range(BISECTIONS):
        middle = (reached + beyond) / 2
        found = _at_value(path, before, middle)
        if found is None:
            beyond = middle
        else:
            reached, last = middle, found
    return last


def _at_value(path: Path | ConvexPath, before: Point | ContactPoint, value: float) -> Point | ContactPoint | None:
    """The polished point at a control value on the branch of `before`; None when the branch ends on the way."""
    if isinstance(path, Path):
        assert isinstance(before, Point)
        return path.polished_at(before, value)
    assert isinstance(before, ContactPoint)
    *_, last = path.advance(before, value)
    return last
