"""Page of a map whose rows were solved, each as a ridge: median and scatter of every answer, and answers row by row."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bem.command_line.answer_table import NO_NUMBER, QUANTITIES, axis_unit, pull_off, quantity, readable
from bem.map_rows import ANSWERED, RowResults, read_rows
from bem.row_commands import cells, pull_off_words, warning_lines
from bem.scene.atomic_file import write_atomically
from bem.scene.result_views import UNITS
from validation.harness.figure_data import Figure, drawn, trace
from validation.report.figures import svg_of
from validation.report.pages import PAGE, filled
from validation.report.run_words import scene_in_words

DRAWN = ("contact_fraction", "open_gap_mean")
MOST_TARGETS = 6  # format: of a figure and of the table of rows
DIGITS = 3  # format: of an answer of a row


def write_rows_page(folder: Path) -> RowResults:
    """Render the rows of a map in a folder (`read_rows`) into report.html beside them; the rows."""
    rows = read_rows(folder)
    write_atomically(folder / PAGE, render_rows(rows))
    return rows


def render_rows(rows: RowResults) -> str:
    """Return the page of a map as text."""
    first = next(iter(rows.results.values()), None)
    scene = None if first is None else first.scene
    return filled(
        "rows_page.jinja",
        heading=(scene and scene["title"]) or "Rows of a map",
        rows=rows,
        count=len(rows.results) + len(rows.failures),
        warnings=warning_lines(rows),
        answer=cells(rows, scene["loading"]["control"]) if scene else [],
        pull_off=pull_off_words(rows),
        words=scene_in_words(scene) if scene else [],
        figures=[(figure, svg_of(figure, f"rows-{figure.id}")) for figure in figures_of(rows)],
        columns=list(_by_target(rows, "contact_fraction")),
        listed=list(_listed(rows)),
        made=first.provenance if first else {},
    )


def figures_of(rows: RowResults) -> Iterator[Figure]:
    """Yield answers against the number of the row: a series for each target, and the pull-off."""
    numbers = list(rows.results)
    for name in DRAWN:
        if not (series := _by_target(rows, name)):
            continue
        largest = max(float(np.nanmax(np.abs(values))) for values in series.values())
        factor, unit = axis_unit(largest, UNITS[name]) if name in UNITS else (1.0, "")
        lines = [
            trace(words, numbers, [factor * v if np.isfinite(v) else None for v in values.tolist()], "points")
            for words, values in series.items()
        ]
        label = QUANTITIES[name] + (f" / {unit}" if unit else "")
        yield drawn(name, f"The {QUANTITIES[name].replace(':', ',')} of each row.", "row", label, *lines)
    known = {row: -own.mean_pressure for row, result in rows.results.items() if (own := pull_off(result)) is not None}
    if known:
        factor, unit = axis_unit(max(map(abs, known.values())), "Pa")
        points = trace("pull-off", known, [factor * value for value in known.values()], "points")
        yield drawn("pull-off", "The pull-off of each row that comes apart.", "row", f"pull-off / {unit}", points)


def _by_target(rows: RowResults, name: str) -> dict[str, NDArray[np.float64]]:
    """Return the answers of all rows at the first targets that a row meets, by target in words; not known: NaN."""
    tables = [result.to_table("targets") for result in rows.results.values()]
    if not tables:
        return {}
    unit = UNITS[next(iter(rows.results.values())).scene["loading"]["control"]]
    places = zip(tables[0]["target"].tolist(), tables[0]["branch"].tolist(), strict=True)
    heads = [f"{quantity(target, unit)}, {branch}" for target, branch in places]
    columns = np.array([table[name] for table in tables], dtype=float).T
    known = [column for column in zip(heads, columns, strict=True) if np.isfinite(column[1]).any()]
    return dict(known[:MOST_TARGETS])


def _listed(rows: RowResults) -> Iterator[tuple[int, str, list[str], str]]:
    """Yield number, outcome, contact fractions at the first targets, and pull-off of each row."""
    columns = _by_target(rows, "contact_fraction").values()
    for row in sorted({*rows.results, *rows.failures}):
        if row in rows.failures:
            yield row, rows.failures[row], [NO_NUMBER] * len(columns), NO_NUMBER
            continue
        place = list(rows.results).index(row)
        fractions = [_known(float(values[place])) for values in columns]
        tension = pull_off(rows.results[row])
        yield row, ANSWERED, fractions, NO_NUMBER if tension is None else readable(-tension.mean_pressure, "Pa", DIGITS)


def _known(value: float) -> str:
    """Return a number in words; a dash if it is not known."""
    return NO_NUMBER if np.isnan(value) else readable(value, "", DIGITS)
