"""What opens a report: a sentence, one figure of all results, what cases put there, and the hard cases.

The sentence says how many comparisons hold, the figure shows all of them at one look.  Figures and tables of cases
stand there by the first word of their id: a figure `problem-...` at the head, `centre-...` beside the matrix,
`cost-...` under what accuracy costs, `landing-...` under what was found; a table `price-...` lists what an effect
costs, the rows of `hard-...` are the map of the hard cases.
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from validation.harness.compare import error_over_tolerance
from validation.harness.figure_data import drawn, loglog, marks, trace
from validation.harness.schema import CaseRecord, Figure, Report, Row, Table, is_intact
from validation.harness.verdict import GATING, PASSING, counted, counts, fails, verdict_of
from validation.report.verification.matrix import KINDS, kind_of, rows_of, worst_place

PLACES = ("problem", "centre", "cost", "landing")
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


def place_of(figure: Figure) -> str | None:
    """Where a figure stands on the first screen; None for one that stands with its case."""
    word = figure.id.partition("-")[0]
    return word if word in PLACES else None


def tables_at(cases: Iterable[CaseRecord], place: str) -> list[tuple[str, Table]]:
    """Tables whose id begins with a word, each with its case."""
    return [(case.id, table) for case in cases for table in case.tables if table.id.partition("-")[0] == place]


def hard_map(cases: Iterable[CaseRecord]) -> dict[str, list[HardCell]]:
    """Every hard case once, by code: as it ended here, or else as one of a higher level."""
    found: dict[str, dict[str, HardCell]] = {}
    for case, table in tables_at(cases, HARD):
        for row in table.rows:
            cell = dict(zip(table.columns, row, strict=True))
            known = found.setdefault(str(cell["code"]), {})
            if str(cell["case"]) not in known or cell["ending"] != "not run":
                known[str(cell["case"])] = _cell(case, cell)
    return {code: list(cells.values()) for code, cells in found.items()}


def counted_endings(lines: Mapping[str, Iterable[HardCell]]) -> list[tuple[str, str, int]]:
    """Mark, meaning and number of each ending."""
    given = Counter(cell.mark for cells in lines.values() for cell in cells)
    return [(mark, words, given[mark]) for mark, _, words in (*ENDINGS.values(), FAILED)]


def _cell(case: str, cell: dict[str, _Cell]) -> HardCell:
    mark, verdict, words = ENDINGS.get((str(cell["ending"]), str(cell["correct"])), FAILED)
    told = f"{words}: expected {cell['expected']}, observed {cell['observed'] or 'nothing'}"
    return HardCell(str(cell["case"]).replace("_", " "), case, mark, verdict, told)


def first_sentence(report: Report) -> str:
    """Passed or failed, of how many comparisons, what deviates as is known, and what took longest.

    Examples
    --------
    >>> first_sentence(Report(level="quick", command="run", planned=1, provenance={}, cases=[]))
    'Failed: 0 of 0 comparisons with something else agree; 0 of 1 planned case reported; changed after it was written.'
    """
    given = counts(report.cases)
    rows = [row for _, _, row in rows_of(report.cases) if row.band is None and row.status != "not run"]
    judged = {kind: [row for row in rows if kind_of(row) == kind] for kind in KINDS}
    held = {kind: sum(verdict_of(row) in PASSING for row in rows) for kind, rows in judged.items()}
    failed = fails(report) or not is_intact(report)
    compared, others = len(judged["comparison"]), len(judged["self-comparison"]) + len(judged["limit"])
    within = held["self-comparison"] + held["limit"]
    known, outside = given["expected deviation"], given["changed"]
    many = {"deviates": "deviate", "error": "errors"}
    failing = {name: count for name, count in given.items() if count and name in GATING and name != "changed"}
    slowest = max(report.cases, key=lambda case: case.seconds, default=None)
    words = [
        f"{held['comparison']} of {counted(compared, 'comparison')} with something else "
        f"{'agrees' if compared == 1 else 'agree'}"
        if compared or not others
        else "",
        f"{within} of {others} self-comparisons, counts and limits hold" if others else "",
        *(counted(count, name, many.get(name, name)) for name, count in failing.items()),
        f"{given['marginal']} of these marginal" if given["marginal"] else "",
        counted(known, "known deviation") if known else "",
        f"{counted(outside, 'known deviation')} outside the recorded band" if outside else "",
        f"{given['not run']} not run" if given["not run"] else "",
        f"{len(report.cases)} of {counted(report.planned, 'planned case')} reported"
        if len(report.cases) != report.planned
        else "",
        "" if is_intact(report) else "changed after it was written",
        f"slowest: {slowest.id}, {slowest.seconds:.3g} s" if slowest and slowest.seconds else "",
    ]
    return f"{'Failed' if failed else 'Passed'}: {'; '.join(filter(None, words))}."


def scatter(report: Report) -> Figure | None:
    """Expected against computed of every comparison with something else, below it error over allowed; None without any.

    Each comparison is drawn where its two sides differ most, in SI units whatever they are of.
    """
    pairs = list(_pairs(report))
    places: dict[str, list[tuple[float, float, float]]] = {name: [] for name in HUES}
    for row, x, y in pairs:
        if x * y > 0 and math.isfinite(x) and math.isfinite(y):
            verdict = verdict_of(row)
            kind = "known deviation" if verdict == "expected deviation" else verdict if verdict in PASSING else "fails"
            places[kind].append((abs(x), abs(y), error_over_tolerance(row)))
    shown = {name: points for name, points in places.items() if points}
    ends = [x for points in shown.values() for x, _, _ in points]
    if not ends:
        return None
    across = (min(ends), max(ends))
    above = loglog("expected (magnitude, SI units)", "computed",
                   trace("computed = expected", across, across, "dashed", hue=5),
                   *(marks(name, [x for x, _, _ in points], [y for _, y, _ in points], hue=HUES[name])
                     for name, points in shown.items()))  # fmt: skip
    judged = {name: [(x, ratio) for x, _, ratio in points if 0 < ratio < math.inf] for name, points in shown.items()}
    count, total = len(ends), len(pairs)
    exact = sum(ratio == 0 for points in shown.values() for _, _, ratio in points)
    below = loglog("expected (magnitude, SI units)", "error / allowed",
                   trace("allowed", across, (1.0, 1.0), "dashed", hue=5),
                   *(marks(name, [x for x, _ in points], [ratio for _, ratio in points], hue=HUES[name])
                     for name, points in judged.items() if points))  # fmt: skip
    caption = (
        f"All results at one look: {count} of {total} comparisons, each where its two sides differ most. "
        f"Not on logarithmic axes: {total - count}, where zero is expected or computed. Below, how much of the "
        f"tolerance each one uses; {exact} agree to the last bit, known deviations have a band instead."
    )
    return drawn("all-results", caption, above, below)


HUES = {"agrees": 0, "marginal": 4, "known deviation": 3, "fails": 1}


def _pairs(report: Report) -> Iterator[tuple[Row, float, float]]:
    """Every row that was compared, with the expected and the computed value at its worst place."""
    for _, _, row in rows_of(report.cases):
        k = worst_place(row)
        expected, computed = row.expected[k], row.computed[k]
        if kind_of(row) == "comparison" and row.status == "run" and expected is not None and computed is not None:
            yield row, expected, computed
