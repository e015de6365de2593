"""Figures of the replication as files: SVG and PDF as they are in the report, and the numbers behind them as CSV.

A CSV has one line for each point: panel (`solution` or `error`), series, x, y, and upper for bands.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from pathlib import Path

from bem.scene.atomic_file import write_atomically
from validation.harness.schema import Figure
from validation.report.figures import canvas_of, save

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
    canvas = canvas_of(figure)
    for kind in KINDS[:2]:
        save(canvas, folder / f"{figure.id}.{kind}")
    write_atomically(folder / f"{figure.id}.csv", table_of(figure))


def table_of(figure: Figure) -> str:
    """The numbers of a figure as CSV."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["panel", "series", "x", "y", "upper"])
    writer.writerows(_lines(figure))
    return stream.getvalue()


def _lines(figure: Figure) -> Iterable[list[str | float | None]]:
    for name, panel in (("solution", figure.solution), ("error", figure.error)):
        for series in panel.series if panel is not None else ():
            upper = series.upper or [None] * len(series.x)
            for x, y, high in zip(series.x, series.y, upper, strict=True):
                if x is not None:
                    yield [name, series.label, x, y, high]
