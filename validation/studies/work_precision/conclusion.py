"""What the curves of error against CPU time say: the cheapest setting for given digits, and where curves cross.

A point counts for d digits when its error is at most 10^-d and not below what its reference resolves: digits finer
than the uncertainty of the reference are not claimed, nor any against a reference of the same code.  Of settings whose
times differ by less than TIE, which is noise, the coarsest is named.  Two curves cross at the error at which the times
on their lower envelopes (the least time for at most that error), joined by straight lines on logarithmic axes, are
equal; a method that is quick at a small error is as quick where less is asked for.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

DIGITS = (2, 3, 4, 6, 9)
TIE = 0.1  # of the least time
SAMPLES = 400  # of the error between the ends that two curves share


@dataclass(frozen=True)
class Spot:
    """A point of a curve."""

    setting: str
    error: float
    seconds: float


@dataclass(frozen=True)
class MethodCurve:
    """The points of a method on a scene, failed ones left out, and against what they were measured."""

    method: str
    reference: str
    marks: tuple[Spot, ...]
    floor: float = 0.0  # uncertainty of the reference in the error: no finer digits are claimed
    independent: bool = True  # whether the reference is of another code, or exact; self-convergence gives no digits


def cheapest(curve: MethodCurve, digits: int) -> Spot | None:
    """The least seconds, within TIE, for an error of at most 10^-digits; None when no point or reference is that good.

    Examples
    --------
    >>> curve = MethodCurve("a", "exact", (Spot("4", 1e-3, 0.1), Spot("8", 1e-5, 0.3), Spot("16", 1e-7, 2.0)))
    >>> cheapest(curve, 4).setting, cheapest(curve, 8)
    ('8', None)
    """
    limit = 10.0**-digits
    if not curve.independent or curve.floor > limit:
        return None
    good = [mark for mark in curve.marks if mark.error <= limit]
    least = min((mark.seconds for mark in good), default=0.0)
    tied = [mark for mark in good if mark.seconds <= (1 + TIE) * least]
    return max(tied, key=lambda mark: mark.error, default=None)


def crossing(first: MethodCurve, second: MethodCurve) -> list[float]:
    """Errors at which the least times of two curves are equal, largest first.

    Examples
    --------
    >>> slow = MethodCurve("slow", "exact", (Spot("", 1e-2, 1.0), Spot("", 1e-6, 1.0)))
    >>> steep = MethodCurve("steep", "exact", (Spot("", 1e-2, 0.1), Spot("", 1e-6, 10.0)))
    >>> [round(math.log10(error), 6) for error in crossing(slow, steep)]
    [-4.0]
    """
    one, other = _envelope(first), _envelope(second)
    if not one or not other:
        return []
    high, low = _shared(one, other)
    at = [high + (low - high) * k / SAMPLES for k in range(SAMPLES + 1)]
    ahead = [_seconds(one, x) - _seconds(other, x) for x in at]
    found = []
    for (x, before), (y, after) in pairwise(zip(at, ahead, strict=True)):
        if before * after < 0:
            found.append(10.0 ** (x + (y - x) * before / (before - after)))
        elif after == 0 and before != 0:
            found.append(10.0**y)
    return found


def sentences(scene: str, curves: Sequence[MethodCurve]) -> list[str]:
    """The conclusion for one scene."""
    if not curves:
        return [f"{scene}: no method has an answer."]
    reported = list(_digits(scene, curves))
    for first, second in combinations(curves, 2):
        reported += _crossing(scene, first, second)
    reported += [
        f"{scene}: {curve.method} is measured against {curve.reference}: self-convergence, no digits are claimed."
        for curve in curves
        if not curve.independent
    ]
    return reported


def _digits(scene: str, curves: Sequence[MethodCurve]) -> Iterator[str]:
    for digits in DIGITS:
        found = [(curve, cheapest(curve, digits)) for curve in curves]
        known = [(curve, mark) for curve, mark in found if mark is not None]
        if not known:
            yield f"{scene}: no setting reaches {digits} digits that its reference resolves."
            continue
        best, mark = min(known, key=lambda pair: pair[1].seconds)
        others = [
            f"{curve.method} {other.seconds / mark.seconds:.1f} times as long"
            for curve, other in known
            if curve is not best
        ]
        never = [f"{curve.method} not at all{_unresolved(curve, digits)}" for curve, other in found if other is None]
        rest = ", ".join([*others, *never])
        yield (
            f"{scene}: {digits} digits cost least with {best.method} at {mark.setting} ({mark.seconds:.2g} s, "
            f"error {mark.error:.1e} against {best.reference})" + (f"; {rest}." if rest else ".")
        )


def _crossing(scene: str, first: MethodCurve, second: MethodCurve) -> list[str]:
    one, other = _envelope(first), _envelope(second)
    if not one or not other:
        return []
    errors = crossing(first, second)
    high, low = _shared(one, other)
    at = high if _seconds(one, high) != _seconds(other, high) else low
    cheap, dear = (first, second) if _seconds(one, at) < _seconds(other, at) else (second, first)
    if errors:
        first_place, *others = (f"{error:.1e}" for error in errors)
        turns = [f", from there {(dear, cheap)[k % 2].method} down to {place}" for k, place in enumerate(others)]
        return [
            f"{scene}: {cheap.method} is cheaper than {dear.method} down to an error of {first_place}{''.join(turns)}; "
            "then the other way."
        ]
    return [f"{scene}: {cheap.method} is cheaper than {dear.method} at every error that both reach."]


def _shared(one: Sequence[tuple[float, float]], other: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Errors that both reach, in log10: a quick and accurate method also serves where less is asked for."""
    return max(one[0][0], other[0][0]), max(one[-1][0], other[-1][0])


def _envelope(curve: MethodCurve) -> list[tuple[float, float]]:
    """Points (log10 error, log10 seconds), errors falling, of those that no other beats in both."""
    marks = sorted((m for m in curve.marks if m.error > 0 and m.seconds > 0), key=lambda m: (m.error, m.seconds))
    kept: list[Spot] = []
    for mark in marks:  # from the smallest error: a larger one is worth keeping only when it is quicker
        if not kept or mark.seconds < kept[-1].seconds:
            kept.append(mark)
    return [(math.log10(mark.error), math.log10(mark.seconds)) for mark in reversed(kept)]


def _seconds(envelope: Sequence[tuple[float, float]], error: float) -> float:
    """log10 seconds on an envelope at log10 error; at larger errors than all, those of the quickest."""
    if error >= envelope[0][0]:
        return envelope[0][1]
    for (x, above), (y, below) in pairwise(envelope):
        if y <= error <= x:
            return above + (below - above) * ((error - x) / (y - x) if y != x else 1.0)
    return math.inf


def _unresolved(curve: MethodCurve, digits: int) -> str:
    """How many digits the reference of a curve resolves, where they are fewer than are asked for."""
    if curve.floor <= 10.0**-digits:
        return ""
    return f" (its reference, {curve.reference}, resolves {max(0, math.floor(-math.log10(curve.floor)))} digits)"
