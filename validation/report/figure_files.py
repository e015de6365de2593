"""Figures as files: SVG and PDF as they are in the report, and the numbers behind them as CSV.

A CSV has one line for each point: panel (`solution` or `error`), series, x, y, and upper for bands.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bem.scene.atomic_file import write_atomically
from validation.harness.schema import Figure
from validation.report.figures import canvas_of, save

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Canvas

KINDS = ("svg", "pdf", "csv")


def linked(figure: Figure, folder: str) -> Figure:
    """The figure with the paths of its files, relative to the report.

    Examples
    --------
    >>> from validation.harness.schema import Panel, Series
    >>> panel = Panel(xlabel="x", ylabel="y", series=[Series(label="one", x=[0.0], y=[1.0])])
    >>> linked(Figure(id="area", caption="One point.", solution=panel), "figures").files
    ['figures/area.svg', 'figures/area.pdf', 'figures/area.csv']
    """
    return figure.model_copy(update={"files": [f"{folder}/{figure.id}.{kind}" for kind in KINDS]})


def write_figure(figure: Figure, folder: Path) -> None:
    """Write ID.svg, ID.pdf and ID.csv; equal numbers give equal files."""
    write_files(canvas_of(figure), folder / figure.id, table_of(figure))


def write_files(canvas: Canvas, path: Path, table: str) -> None:
    """Write what is drawn as SVG and PDF, and the numbers behind it as CSV, at a path without an ending."""
    for kind in KINDS[:2]:
        save(canvas, path.with_name(f"{path.name}.{kind}"))
    write_atomically(path.with_name(f"{path.name}.csv"), table)


def table_of(figure: Figure) -> str:
    """The numbers of a figure as CSV."""
    return csv_text(["panel", "series", "x", "y", "upper"], _lines(figure))


def csv_text(head: Sequence[str], lines: Iterable[Sequence[str | float | None]]) -> str:
    """Lines under their head as CSV."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(lines)
    return stream.getvalue()


def _lines(figure: Figure) -> Iterable[list[str | float | None]]:
    for name, panel in (("solution", figure.solution), ("error", figure.error)):
        for series in panel.series if panel is not None else ():
            upper = series.upper or [None] * len(series.x)
            for x, y, high in zip(series.x, series.y, upper, strict=True):
                if x is not None:
                    yield [name, series.label, x, y, high]
