"""Maps as figures and tables: coloured cells with their numbers, SVG and PDF, and the numbers as CSV.

A cell without a number says why; the standard error stands below the mean.  The colour scale runs from the least to
the largest value of the map, logarithmic where they lie more than a factor `DECADES` apart, zero apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from validation.report.figure_files import csv_text, write_files
from validation.report.figures import styled

DARK = 0.55  # of the colour scale, from where the text is white
DECADES = 30.0


@dataclass(frozen=True)
class Map:
    """Values over rows and columns, (n_rows, n_columns) each; None without a value."""

    name: str
    title: str
    row_label: str
    column_label: str
    rows: Sequence[str]
    columns: Sequence[str]
    values: Sequence[Sequence[float | None]]  # means
    errors: Sequence[Sequence[float | None]]  # and their standard errors
    notes: Sequence[Sequence[str]]  # why a value is missing, or rests on fewer realisations


def write_map(found: Map, folder: Path) -> None:
    """Write NAME.svg, NAME.pdf and NAME.csv; equal numbers give equal files."""
    write_files(draw(found), folder / found.name, table_of(found))


def draw(found: Map) -> Figure:
    """The map as a figure."""
    values = np.array([[np.nan if value is None else value for value in line] for line in found.values])
    with styled(**{"axes.grid": False}):
        canvas = Figure(figsize=(1.6 + 0.85 * len(found.columns), 1.5 + 0.5 * len(found.rows)), layout="constrained")
        axes = canvas.subplots()
        norm = _scale(values)
        mesh = axes.pcolormesh(values, cmap="cividis_r", norm=norm)
        for i, line in enumerate(found.values):
            for j, value in enumerate(line):
                dark = value is not None and norm(value) > DARK
                text, size = _words(value, found.errors[i][j], found.notes[i][j])
                colour = "white" if dark else "black"
                axes.text(j + 0.5, i + 0.5, text, ha="center", va="center", fontsize=size, color=colour)
        axes.set_xticks(np.arange(len(found.columns)) + 0.5, found.columns)
        axes.set_yticks(np.arange(len(found.rows)) + 0.5, found.rows)
        axes.set(xlabel=found.column_label, ylabel=found.row_label)
        axes.set_title(found.title, fontsize=9.5)
        canvas.colorbar(mesh, ax=axes)
    return canvas


def _scale(values: NDArray[np.float64]) -> Normalize:
    """Colours over the values that are there; zero takes the least colour of a logarithmic scale."""
    known = values[np.isfinite(values)]
    positive = known[known > 0]
    if positive.size and positive.max() > DECADES * positive.min() and known.min() >= 0:
        return LogNorm(float(positive.min()), float(positive.max()), clip=True)
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    return Normalize(low, high if high > low else low + 1.0)


def _words(value: float | None, error: float | None, note: str) -> tuple[str, float]:
    """What stands in a cell, and its size."""
    if value is None:
        return note.replace(" ", "\n", 2), 5.0
    return f"{value:.3g}" + ("" if not error else f"\n± {error:.2g}"), 7.0


def table_of(found: Map) -> str:
    """The numbers as CSV, one line for each cell."""
    head = [found.row_label, found.column_label, found.title, "standard error", "note"]
    return csv_text(
        head,
        (
            [row, column, found.values[i][j], found.errors[i][j], found.notes[i][j]]
            for i, row in enumerate(found.rows)
            for j, column in enumerate(found.columns)
        ),
    )
