"""Rows of comparisons, with the scales and tolerances that most of them share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Literal

from validation.harness.schema import Code, Norm, Reference, Row, Tolerance

Basis = Literal["measured", "required", "provisional"]
Pinned = Literal["exact", "tight", "converged", "unconverged"]


def compared(
    quantity: str,
    unit: str,
    reference: Reference,
    expected: Iterable[float | None],
    computed: Iterable[float | None],
    tolerance: float,
    measured: float,
    norm: Norm = "relative",
    scale: float | None = None,
    *,
    basis: Basis = "measured",
    pinned: Pinned = "converged",
    uncertainty: float = 0.0,
    code: Code | None = None,
) -> Row:
    """A comparison with a tolerance of the scaled error, beside the error measured; None where there is no value.

    The scale is by default the largest value expected, or 1 where the norm is absolute; the basis is that of the
    tolerance, the rest as of `Row`.
    """
    known = [None if value is None else float(value) for value in expected]
    if scale is None:
        scale = 1.0 if norm == "absolute" else max(abs(value) for value in known if value is not None)
    return Row(
        quantity=quantity,
        unit=unit,
        reference=reference,
        norm=norm,
        expected=known,
        computed=[None if value is None else float(value) for value in computed],
        scale=scale,
        uncertainty=uncertainty,
        tolerance=Tolerance(value=tolerance, measured=measured, basis=basis),
        pinned=pinned,
        code=code,
    )


def counted(
    quantity: str,
    reference: Reference,
    expected: Sequence[float | None],
    computed: Sequence[float | None],
    tolerance: float = 0.5,
    message: str = "",
) -> Row:
    """A comparison of counts, or of yes (1) and no (0), which baselines pin exactly; within half a count by default."""
    row = compared(quantity, "", reference, expected, computed, tolerance, 0.0, "absolute", basis="required")
    return row.model_copy(update={"pinned": "exact", "message": message})
