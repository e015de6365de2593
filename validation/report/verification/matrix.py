"""What is compared with what: every row by its kind, and the matrix of problems and quantities that rows fill.

A row is a *comparison* of two answers, one of a code with one of something else; a *self-comparison*, of a code with
itself; or a *limit*, a count or a magnitude that is asked to vanish.  A comparison stands in the line of its problem,
in the column that its quantity begins with (COLUMNS), under the two that it compares: a new row is in the matrix
because of what it says, and the rows that no column takes are counted below it.
"""

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from validation.harness.compare import combined_uncertainty, error_of, error_over_tolerance
from validation.harness.schema import CaseRecord, Code, ReferenceKind, Row
from validation.harness.verdict import GATING, Verdict, counted, verdict_of

Kind = Literal["comparison", "self-comparison", "limit"]
KINDS: dict[Kind, str] = {
    "comparison": "comparisons with something else",
    "self-comparison": "of a code with itself",
    "limit": "counts and limits",
}
CODES: dict[Code, tuple[str, str]] = {  # sign, name
    "bem": ("B", "boundary elements"),
    "fem": ("F", "finite elements"),
    "persson": ("T", "Persson's theory"),
    "paper's method": ("M", "the paper's method"),
    "suite": ("S", "the suite itself"),
}
REFERENCES: dict[ReferenceKind, tuple[str, str]] = {
    "exact": ("X", "closed form or exact law"),
    "manufactured": ("X", "closed form or exact law"),
    "FEM": ("F", "finite elements"),
    "theory": ("T", "theory"),
    "predicted order": ("P", "predicted order of convergence"),
    "paper's method": ("M", "the paper's method"),
    "dense algebra": ("D", "dense algebra or prototype"),
    "independent code": ("O", "another code"),
    "self": ("S", "itself"),
}
COLUMNS: dict[str, str] = {  # heading, and what the quantity of a row begins with
    "contact fraction": r"contact fraction|A/A0|share of the contact",
    "separation": r"separation|(largest |mean )?gap\b(?! at)|penetration|total displacement|mean displacement",
    "mean pressure": r"mean pressure|load\b|pull-off|fold",
    "edges": r"edges?\b|place|middle of the contact|patch widths?",
    "energy": r"(elastic|adhesion|total|strain)?( and adhesive)? ?energy(?! release rate)|energies|work of|loop|-dU",
    "K, G": r"(largest )?stress intensity|energy release rate|G\b|K\b",
    "at points": r"pressure\b|interface displacement|displacement|gap at points|(two-sided )?pressure spectrum|stress",
}


@dataclass(frozen=True)
class Entry:
    """One pair in a cell: the worst of its rows."""

    pair: str  # signs of both sides
    shown: str
    verdict: Verdict
    told: str  # in words
    target: str  # id of the row


@dataclass(frozen=True)
class ProblemLine:
    """A problem: its name, its case, and the entries of every column."""

    problem: str
    case: str
    cells: tuple[tuple[Entry, ...], ...]

    @property
    def pairs(self) -> set[str]:
        """Pairs of codes that meet on this problem."""
        return {entry.pair for cell in self.cells for entry in cell}


@dataclass(frozen=True)
class Matrix:
    """Lines, those on which most pairs meet first, and the comparisons that no column takes."""

    lines: list[ProblemLine]
    outside: list[tuple[str, str]]  # id of the row, its quantity

    @property
    def signs(self) -> dict[str, str]:
        """Names of all signs that its entries show."""
        used = {sign for line in self.lines for pair in line.pairs for sign in pair}
        known = (*REFERENCES.values(), *CODES.values())
        return {sign: name for sign, name in known if sign in used}


def kind_of(row: Row) -> Kind:
    """Whether a row compares two answers, a code with itself, or a number with the limit asked of it.

    Examples
    --------
    >>> from validation.harness.schema import Reference, Tolerance
    >>> row = Row(quantity="load", unit="N/m", reference=Reference(kind="self", source="half the step"), expected=[1.0],
    ...           norm="absolute", computed=[1.5], tolerance=Tolerance(value=1.0, measured=0.5))
    >>> kind_of(row), kind_of(row.model_copy(update={"pinned": "exact"}))
    ('self-comparison', 'limit')
    """
    asked = row.tolerance is not None and row.tolerance.basis == "required"
    if row.pinned == "exact" or (asked and not row.unit and not any(row.expected)):
        return "limit"
    return "self-comparison" if row.reference.kind == "self" else "comparison"


def row_id(case: CaseRecord, place: int) -> str:
    """Id of a row of a case on the page."""
    return f"row-{case.id}-{place}"


def rows_of(cases: Iterable[CaseRecord]) -> Iterator[tuple[CaseRecord, str, Row]]:
    """Every row with its case and its id."""
    return ((case, row_id(case, place), row) for case in cases for place, row in enumerate(case.rows))


def code_of(case: CaseRecord, row: Row) -> Code:
    """Whose answer a row judges."""
    return row.code or case.code


def tally(cases: Iterable[CaseRecord]) -> list[tuple[str, list[int]]]:
    """Rows by whose answer they judge, and by what they compare it with: the names of `TALLIED`, code by code."""
    found = {code: dict.fromkeys(TALLIED, 0) for code in CODES}
    for case, _, row in rows_of(cases):
        head = KINDS["limit"] if kind_of(row) == "limit" else REFERENCES[row.reference.kind][1]
        found[code_of(case, row)][head] += 1
    return [(CODES[code][1], list(line.values())) for code, line in found.items() if any(line.values())]


TALLIED = [*dict.fromkeys(name for _, name in REFERENCES.values()), KINDS["limit"]]


def column_of(quantity: str) -> int | None:
    """The column that a quantity stands in, by how it begins, or how what follows the name of a state and a colon does.

    Examples
    --------
    >>> column_of("mean pressure over p*"), column_of("d/lambda 0.1: edges"), column_of("patches")
    (2, 3, None)
    """
    return _placed(quantity)[0]


def _placed(quantity: str) -> tuple[int | None, str]:
    """The column of a quantity, and the state that it names, "" where it names none."""
    state, _, name = quantity.partition(": ")
    for begun, named in ((quantity, ""), (name, state)):
        for place, words in enumerate(COLUMNS.values()):
            if re.match(words, begun):
                return place, named
    return None, ""


def matrix_of(cases: Iterable[CaseRecord]) -> Matrix:
    """The matrix of all comparisons with something else that ran."""
    lines: dict[str, tuple[str, list[dict[str, list[tuple[Row, str]]]]]] = {}
    outside = []
    for case, target, row in rows_of(cases):
        if kind_of(row) != "comparison" or row.status != "run":
            continue
        order = row.reference.kind == "predicted order"
        column = None if order or code_of(case, row) == "suite" else column_of(row.quantity)
        if column is None:
            outside.append((target, row.quantity))
            continue
        problem = problem_of(case, row)
        _, cells = lines.setdefault(problem, (case.id, [{} for _ in COLUMNS]))
        pair = CODES[code_of(case, row)][0] + REFERENCES[row.reference.kind][0]
        cells[column].setdefault(pair, []).append((row, target))
    made = [
        ProblemLine(problem, case, tuple(tuple(_entry(pair, rows) for pair, rows in cell.items()) for cell in cells))
        for problem, (case, cells) in lines.items()
    ]
    return Matrix(sorted(made, key=lambda line: (-len(line.pairs), "BF" not in line.pairs)), outside)


def problem_of(case: CaseRecord, row: Row) -> str:
    """The problem of a row: that of its case, with the state that its quantity names."""
    name = case.problem or case.id.removesuffix("-coarse").replace("-", " ")
    return ", ".join(filter(None, (name, _placed(row.quantity)[1])))


def _entry(pair: str, rows: list[tuple[Row, str]]) -> Entry:
    """The worst of rows that compare the same pair: what fails first, then what is farthest in its own allowance."""

    def badness(item: tuple[Row, str]) -> tuple[bool, float]:
        row = item[0]
        return verdict_of(row) in GATING, 0.0 if row.band else error_over_tolerance(row)

    row, target = max(rows, key=badness)
    error, uncertainty = error_of(row), combined_uncertainty(row)
    if row.band is not None:
        shown, told = f"×{error:.2f}", f"ratio {error:.3g}, a known deviation: {row.band.low:g} to {row.band.high:g}"
    elif uncertainty:
        shown, told = f"{error / uncertainty:.2g} u", f"difference {error:.2g}, combined uncertainty {uncertainty:.2g}"
    else:
        shown, told = f"{error:.0e}", f"difference {error:.2g}, no uncertainty stated"
    more = f"; largest error of {counted(len(rows), 'row')}" if len(rows) > 1 else ""
    return Entry(pair, shown, verdict_of(row), f"{row.quantity}: {told}, over {row.scale:.3g} {row.unit}{more}", target)


def worst_place(row: Row) -> int:
    """Index of the value that the error is of: the farthest off, or the ratio farthest from the middle of its band."""
    middle = None if row.band is None else (row.band.low + row.band.high) / 2

    def miss(a: float | None, b: float | None) -> float:
        if a is None or b is None or math.isnan(a - b) or (middle is not None and b == 0):
            return math.inf
        return abs(a - b) if middle is None else abs(a / b - middle)

    misses = [miss(a, b) for a, b in zip(row.computed, row.expected, strict=True)]
    return misses.index(max(misses))


def named(quantity: str, unit: str) -> tuple[str, str]:
    """The name of a quantity with a unit, and what its error is scaled with: "load over p*" holds a load in Pa.

    Examples
    --------
    >>> named("load over p*, two grids", "Pa"), named("load over p*", ""), named("load, over all shifts", "Pa")
    (('load, two grids', 'p*'), ('load over p*', ''), ('load, over all shifts', ''))
    """
    found = re.fullmatch(r"(.*?),? over (?!all\b)([^,]*)(,.*)?", quantity) if unit else None
    return (quantity, "") if found is None else (found[1] + (found[3] or ""), found[2])
