"""What opens a report: figures and tables that cases put there, by the first word of their id, and the hard cases.

A figure `centre-...` stands beside the matrix, `cost-...` under what accuracy costs, `landing-...` under what was
found; a table `price-...` lists what an effect costs, the rows of `hard-...` are the map of the hard cases.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from validation.harness.schema import CaseRecord, Figure, Table

PLACES = ("centre", "cost", "landing")
HARD, PRICE = "hard", "price"
_Cell = str | float | int | None
ENDINGS = {  # of a hard case, with whether it is correct: mark, verdict, in words
    ("converged", "yes"): ("✓", "agrees", "converged and correct"),
    ("refused as expected", "yes"): ("⊘", "expected-deviation", "refused as it should be"),
    ("not run", "–"): ("·", "not-run", "at a higher level"),
}
FAILED = ("✗", "deviates", "neither")


@dataclass(frozen=True)
class HardCell:
    """A hard case on the map."""

    name: str
    case: str
    mark: str
    verdict: str
    told: str


@dataclass(frozen=True)
class HardLine:
    """The hard cases of a code."""

    code: str
    cells: list[HardCell]


def place_of(figure: Figure) -> str | None:
    """Where a figure stands on the first screen; None for one that stands with its case."""
    word = figure.id.partition("-")[0]
    return word if word in PLACES else None


def tables_at(cases: Iterable[CaseRecord], place: str) -> list[tuple[str, Table]]:
    """Tables whose id begins with a word, each with its case."""
    return [(case.id, table) for case in cases for table in case.tables if table.id.partition("-")[0] == place]


def hard_map(cases: Iterable[CaseRecord]) -> list[HardLine]:
    """Every hard case once, by code: as it ended here, or else as one of a higher level."""
    found: dict[str, dict[str, HardCell]] = {}
    for case, table in tables_at(cases, HARD):
        for row in table.rows:
            cell = dict(zip(table.columns, row, strict=True))
            known = found.setdefault(str(cell["code"]), {})
            if str(cell["case"]) not in known or cell["ending"] != "not run":
                known[str(cell["case"])] = _cell(case, cell)
    return [HardLine(code, list(cells.values())) for code, cells in found.items()]


def counted_endings(lines: Iterable[HardLine]) -> list[tuple[str, str, int]]:
    """Mark, meaning and number of each ending."""
    given = Counter(cell.mark for line in lines for cell in line.cells)
    return [(mark, words, given[mark]) for mark, _, words in (*ENDINGS.values(), FAILED)]


def _cell(case: str, cell: dict[str, _Cell]) -> HardCell:
    mark, verdict, words = ENDINGS.get((str(cell["ending"]), str(cell["correct"])), FAILED)
    told = f"{words}: expected {cell['expected']}, observed {cell['observed'] or 'nothing'}"
    return HardCell(str(cell["case"]).replace("_", " "), case, mark, verdict, told)
