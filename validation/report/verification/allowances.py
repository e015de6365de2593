"""What decides a row: its uncertainty budget after ASME V&V 20, rows that state none and why, loose tolerances.

With S what was computed and D what was expected, the comparison error is E = S - D and the validation uncertainty

    u_val = (u_num^2 + u_input^2 + u_D^2)^(1/2),

u_num as the code estimates it of itself, u_D that of the reference.  Both sides are given the same numbers, so that
u_input = 0.  What is shown is the rule that is applied: |E| is at most the larger of u_val and of the tolerance.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from validation.harness.compare import combined_uncertainty
from validation.harness.schema import CaseRecord, ReferenceKind, Row
from validation.report.verification.matrix import CODES, code_of, kind_of, rows_of

LOOSE = 10.0  # times the error measured: a tolerance beyond that is listed
REASONS: dict[ReferenceKind, str] = {
    "exact": "the reference is exact, and the code estimates no error of this quantity: judged by the tolerance",
    "manufactured": "the reference is exact, and the code estimates no error of this quantity: judged by the tolerance",
    "FEM": "neither side states one of this quantity",
    "theory": "the theory states no uncertainty of its assumptions: judged by a band or by the tolerance",
    "predicted order": "an order is predicted of sizes that vanish: how far it is off at these was measured",
    "paper's method": "the paper's method states none",
    "dense algebra": "dense algebra states none: it differs by rounding",
    "independent code": "the other code states none",
    "self": "one code with itself: what differs is its rounding or discretisation, which is what is asked for",
}
COUNTS = "counts, and magnitudes that are asked to vanish: nothing is uncertain"


@dataclass(frozen=True)
class Budget:
    """Uncertainties over the scale of the row; None where a side states none, and what decides the row."""

    numerical: float | None
    data: float | None
    validation: float | None
    decides: str


@dataclass(frozen=True)
class Loose:
    """A row with a tolerance this many times the error that was measured; 0 is measured where both sides were equal."""

    target: str
    name: str
    row: Row
    ratio: float


def budget_of(row: Row) -> Budget:
    """The budget of a row.

    Examples
    --------
    >>> from validation.harness.schema import Reference, Tolerance
    >>> row = Row(quantity="load", unit="N/m", reference=Reference(kind="FEM", source="mesh 4", uncertainty=0.4),
    ...           norm="absolute", expected=[1.0], computed=[1.5], uncertainty=0.3,
    ...           tolerance=Tolerance(value=0.1, measured=0.04))
    >>> found = budget_of(row)
    >>> found.validation, found.decides
    (0.5, 'the uncertainty')
    """
    exact = 0.0 if row.reference.kind in ("exact", "manufactured") else None
    numerical = row.uncertainty / row.scale or None
    data = row.reference.uncertainty / row.scale or exact
    total = combined_uncertainty(row) if numerical or data else None
    if row.tolerance is None:
        return Budget(numerical, data, total, "the band")
    decides = "the uncertainty" if total is not None and total > row.tolerance.value else "the tolerance"
    return Budget(numerical, data, total, decides)


def unstated(cases: Iterable[CaseRecord]) -> dict[str, list[tuple[str, str]]]:
    """All rows of which no side states an uncertainty, by the reason for it: id, and case with quantity."""
    found: dict[str, list[tuple[str, str]]] = {}
    for case, target, row in rows_of(cases):
        if combined_uncertainty(row) == 0:
            counts = kind_of(row) == "limit"
            reason = COUNTS if counts else f"{REASONS[row.reference.kind]}, {CODES[code_of(case, row)][1]}"
            found.setdefault(reason, []).append((target, f"{case.id}, {row.quantity}"))
    return dict(sorted(found.items(), key=lambda item: -len(item[1])))


def loose(cases: Iterable[CaseRecord]) -> list[Loose]:
    """Rows that are no counts or limits whose tolerance is what decides, and far above what was measured."""
    found = []
    for case, target, row in rows_of(cases):
        given = row.tolerance
        if given is None or kind_of(row) == "limit" or budget_of(row).decides != "the tolerance":
            continue
        ratio = given.value / given.measured if given.measured else float("inf")
        if ratio > LOOSE and row.status == "run":
            found.append(Loose(target, f"{case.id}, {row.quantity}", row, ratio))
    return sorted(found, key=lambda one: -one.ratio)
