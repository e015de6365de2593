"""Rows of comparisons, with the scales and tolerances that most of them share.

A tolerance is 2.5 times the error measured, which stands in the row; or it is `required`, as asked for whatever was
measured; or it is given as (tolerance, measured).  Where the uncertainty of both sides decides, nothing was measured:
None, and what is required is rounding.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from validation.harness.schema import Band, Code, Norm, Reference, ReferenceKind, Row, Tolerance

Basis = Literal["measured", "required", "provisional"]
Pinned = Literal["exact", "tight", "converged", "unconverged"]
Values = float | None | Iterable[float | None]

SAFETY = 2.5  # times the error measured: a tolerance
REVIEW = "2027-11-21"  # of known discrepancies


def compared(
    quantity: str,
    unit: str,
    reference: Reference,
    expected: Iterable[float | None],
    computed: Iterable[float | None],
    tolerance: float,
    measured: float | None,
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


@dataclass(frozen=True)
class Against:
    """Makes rows against one reference; the first arguments of all are quantity, unit, expected and computed values."""

    kind: ReferenceKind
    source: str
    uncertainty: float = 0.0

    @property
    def reference(self) -> Reference:
        """As rows hold it."""
        return Reference(kind=self.kind, source=self.source, uncertainty=self.uncertainty)

    def row(
        self,
        quantity: str,
        unit: str,
        expected: Values,
        computed: Values,
        measured: float | tuple[float, float] | None,
        norm: Norm = "relative",
        scale: float | None = None,
        *,
        required: float | None = None,
        uncertainty: float = 0.0,
        pinned: Pinned = "converged",
        code: Code | None = None,
    ) -> Row:
        """A comparison with a tolerance, scaled as `compared` does; ValueError where none is given."""
        allowed, known = measured if isinstance(measured, tuple) else (None, measured)
        if required is not None:
            allowed = required
        elif allowed is None:
            if known is None:
                raise ValueError(f"{quantity}: neither an error measured nor one required")
            allowed = SAFETY * known
        return compared(quantity, unit, self.reference, _listed(expected), _listed(computed), allowed, known, norm,
                        scale, basis="measured" if required is None else "required", pinned=pinned,
                        uncertainty=uncertainty, code=code)  # fmt: skip

    def count(
        self,
        quantity: str,
        expected: Values,
        computed: Values,
        tolerance: float = 0.5,
        message: str = "",
        code: Code | None = None,
    ) -> Row:
        """A comparison of counts, or of yes (1) and no (0), which baselines pin exactly; within half a count."""
        row = compared(quantity, "", self.reference, _listed(expected), _listed(computed), tolerance, 0.0, "absolute",
                       basis="required", code=code)  # fmt: skip
        return row.model_copy(update={"pinned": "exact", "message": message})

    def ratio(
        self,
        quantity: str,
        unit: str,
        expected: Values,
        computed: Values,
        band: tuple[float, float],
        cause: str,
        source: str,
        *,
        uncertainty: float = 0.0,
        review: str = REVIEW,
    ) -> Row:
        """A known discrepancy: the ratio lies in a band, for this cause, by this source."""
        known = Band(low=band[0], high=band[1], cause=cause, source=source, review=review)
        return Row(quantity=quantity, unit=unit, reference=self.reference, norm="ratio", expected=_listed(expected),
                   computed=_listed(computed), uncertainty=uncertainty, band=known)  # fmt: skip


def _listed(values: Values) -> list[float | None]:
    many = values if isinstance(values, Iterable) else [values]
    return [None if value is None else float(value) for value in many]
