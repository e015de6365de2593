"""Maps as figures and tables: coloured cells with their numbers, SVG and PDF, and the numbers as CSV.

A cell without a number says why.  The colour scale runs from the least to the largest value of the map.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from validation.replicate.files import WITHOUT_DATE, replace_file
from validation.report.figures import SETTINGS

DARK = 0.55  # of the colour scale, from where the text is white


@dataclass(frozen=True)
class Map:
    """Values over rows and columns, (n_rows, n_columns) each; None without a value.

    Parameters
    ----------
    name, title, row_label, column_label : str
    rows, columns : sequences of str
    values, errors : nested sequences
        Means and their standard errors.
    notes : nested sequence of str
        Why a value is missing, or rests on fewer realisations.
    """

    name: str
    title: str
    row_label: str
    column_label: str
    rows: Sequence[str]
    columns: Sequence[str]
    values: Sequence[Sequence[float | None]]
    errors: Sequence[Sequence[float | None]]
    notes: Sequence[Sequence[str]]


def write_map(found: Map, folder: Path) -> None:
    """Write NAME.svg, NAME.pdf and NAME.csv; equal numbers give equal files."""
    folder.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context({**SETTINGS, "axes.grid": False, "pdf.fonttype": 42}):
        canvas = draw(found)
        for kind, metadata in WITHOUT_DATE.items():
            stream = io.BytesIO()
            canvas.savefig(stream, format=kind, metadata=metadata)
            replace_file(folder / f"{found.name}.{kind}", stream.getvalue())
    replace_file(folder / f"{found.name}.csv", table_of(found).encode())


def draw(found: Map) -> Figure:
    """The map as a figure."""
    values = np.array([[np.nan if value is None else value for value in line] for line in found.values])
    with mpl.rc_context({**SETTINGS, "axes.grid": False}):
        canvas = Figure(figsize=(1.6 + 0.85 * len(found.columns), 1.5 + 0.45 * len(found.rows)), layout="constrained")
        axes = canvas.subplots()
        known = values[np.isfinite(values)]
        low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
        mesh = axes.pcolormesh(values, cmap="cividis_r", vmin=low, vmax=high if high > low else low + 1.0)
        for i, line in enumerate(found.values):
            for j, value in enumerate(line):
                dark = value is not None and high > low and (value - low) / (high - low) > DARK
                text = found.notes[i][j].replace(" ", "\n", 2) if value is None else f"{value:.3g}"
                size = 5.0 if value is None else 7.5
                colour = "white" if dark else "black"
                axes.text(j + 0.5, i + 0.5, text, ha="center", va="center", fontsize=size, color=colour)
        axes.set_xticks(np.arange(len(found.columns)) + 0.5, found.columns)
        axes.set_yticks(np.arange(len(found.rows)) + 0.5, found.rows)
        axes.set_xlabel(found.column_label)
        axes.set_ylabel(found.row_label)
        axes.set_title(found.title, fontsize=9.5)
        canvas.colorbar(mesh, ax=axes)
    return canvas


def table_of(found: Map) -> str:
    """The numbers as CSV, one line for each cell."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([found.row_label, found.column_label, found.title, "standard error", "note"])
    for i, row in enumerate(found.rows):
        for j, column in enumerate(found.columns):
            writer.writerow([row, column, found.values[i][j], found.errors[i][j], found.notes[i][j]])
    return stream.getvalue()
