"""The error of a row: max |computed - expected| / scale, or the ratio computed / expected of a known discrepancy.

A value that is missing or not a number makes the error nan, and nan never passes.
"""

import math
from collections.abc import Sequence

import numpy as np

from validation.harness.schema import Row


def error_of(row: Row) -> float:
    """Error of a row, or its largest ratio when it has a band (the one farthest from the middle of the band).

    Dimensionless; nan where a value is missing or no number.

    Examples
    --------
    >>> from validation.harness.schema import Reference, Row, Tolerance
    >>> row = Row(quantity="load", unit="N/m", reference=Reference(kind="exact", source="Johnson 1995"),
    ...           norm="absolute", expected=[1.0], computed=[1.5], tolerance=Tolerance(value=1.0, measured=0.5))
    >>> error_of(row)
    0.5
    """
    expected, computed = (np.array(values, dtype=np.float64) for values in (row.expected, row.computed))  # None is nan
    if row.band is None:
        with np.errstate(invalid="ignore"):
            return float(np.max(np.abs(computed - expected)) / row.scale)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = computed / expected
    if not np.all(np.isfinite(ratio)):
        return math.nan
    return float(ratio[np.argmax(np.abs(ratio - (row.band.low + row.band.high) / 2))])


def combined_uncertainty(row: Row) -> float:
    """What both sides state of themselves, sqrt(u^2 + u_ref^2) / scale: u_val of ASME V&V 20, dimensionless.

    Each uncertainty is one that its code stands for: the true error is to lie below it, which rows of their own ask.
    No factor is put on top.
    """
    return math.hypot(row.uncertainty, row.reference.uncertainty) / row.scale


def combined_tolerance(row: Row) -> float:
    """What the error may be: the tolerance, but never finer than the uncertainties of both sides.

    max(tolerance, u_val), dimensionless; nan for rows with a band.
    """
    if row.tolerance is None:
        return math.nan
    return max(row.tolerance.value, combined_uncertainty(row))


def error_over_tolerance(row: Row) -> float:
    """Error divided by what it may be: 1 is the limit; nan for rows with a band, or without a number."""
    return error_of(row) / combined_tolerance(row)


def fitted_order(size: Sequence[float], error: Sequence[float]) -> float:
    """Exponent p of error ~ size^p by least squares on logarithms of n >= 2 positive sizes and errors, in any unit.

    Examples
    --------
    >>> round(fitted_order([0.1, 0.2, 0.4], [1e-4, 4e-4, 16e-4]), 12)
    2.0
    """
    return float(np.polyfit(np.log(np.asarray(size)), np.log(np.asarray(error)), 1)[0])


def pairwise_orders(size: Sequence[float], error: Sequence[float]) -> list[float]:
    """The n - 1 exponents between neighbours of n positive sizes, which are distinct, and errors, in any unit.

    Examples
    --------
    >>> [round(order, 12) for order in pairwise_orders([0.1, 0.2, 0.4], [1e-4, 4e-4, 32e-4])]
    [2.0, 3.0]
    """
    x, y = np.log(np.asarray(size)), np.log(np.asarray(error))
    return [float(value) for value in np.diff(y) / np.diff(x)]
