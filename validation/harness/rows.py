"""Rows of comparisons, with the scales and tolerances that most of them share."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from validation.harness.schema import Norm, Reference, Row, Tolerance


def compared(
    quantity: str,
    unit: str,
    reference: Reference,
    expected: Sequence[float],
    computed: Sequence[float],
    tolerance: float,
    measured: float,
    norm: Norm = "relative",
) -> Row:
    """A comparison scaled by the largest value expected, or not at all where the norm is absolute.

    Parameters
    ----------
    quantity, unit, reference, norm
        As of `Row`.
    expected, computed : sequences of n floats
    tolerance, measured : float
        Of the scaled error, and the error measured.
    """
    return Row(
        quantity=quantity,
        unit=unit,
        reference=reference,
        norm=norm,
        expected=[float(value) for value in expected],
        computed=[float(value) for value in computed],
        scale=1.0 if norm == "absolute" else float(np.max(np.abs(expected))),
        tolerance=Tolerance(value=tolerance, measured=measured),
    )
