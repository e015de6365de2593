"""Cheapest setting of a curve of error against CPU time for given digits.

A point counts for d digits when its error is at most 10^-d and not below what its reference resolves.  Of settings
whose times differ by less than TIE, which is noise, the coarsest counts.
"""

from dataclasses import dataclass

TIE = 0.1  # of the least time


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
    """Return the point of least seconds, within TIE, for an error of at most 10^-digits; None where none is that good.

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
