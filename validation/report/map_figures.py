"""Figures of coloured cells: maps with their numbers, as SVG, PDF and CSV, and faults against cases as SVG.

A cell of a map without a number says why; the standard error stands below the mean.  The colour scale runs from the
least to the largest value, logarithmic where they lie more than a factor `APART` apart, zero apart.  A fault is shown
by which case caught it, and by how much.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from validation.report.figures import csv_text, save, styled, write_files

DARK = 0.55  # of the colour scale, from where the text is white
APART = 30.0
DECADES = 12.0  # of error over allowed, beyond which the colour no longer deepens


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
    if positive.size and positive.max() > APART * positive.min() and known.min() >= 0:
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
    numbers = (found.values, found.errors, found.notes)
    cells = product(enumerate(found.rows), enumerate(found.columns))
    return csv_text(head, ([row, column, *(of[i][j] for of in numbers)] for (i, row), (j, column) in cells))


@dataclass(frozen=True)
class FaultLine:
    """A fault."""

    name: str
    excesses: Mapping[str, float]  # cases that caught it, and the largest error over what is allowed in each
    apart: Collection[str]  # cases that crashed or refused
    asked: Collection[str]  # cases that were shown it


def write_matrix(path: Path, cases: Sequence[str], lines: Sequence[FaultLine]) -> None:
    """Draw faults (rows) against cases (columns, without those that were shown no fault) as SVG."""
    shown = [case for case in cases if any(case in line.asked for line in lines)]
    with styled():
        labels = max(len(line.name) for line in lines), max(map(len, shown), default=0)
        size = (4.0 + 0.09 * labels[0] + 0.3 * len(shown), 3.0 + 0.09 * labels[1] + 0.22 * len(lines))
        canvas = Figure(figsize=size, layout="constrained")
        axes = canvas.subplots()
        colours = mpl.colormaps["viridis_r"]
        for y, line in enumerate(lines):
            for x, case in enumerate(shown):
                if case in line.excesses:
                    excess = line.excesses[case]
                    depth = min(math.log10(excess), DECADES) / DECADES if excess < math.inf else 1.0
                    axes.add_patch(mpl.patches.Rectangle((x - 0.45, y - 0.45), 0.9, 0.9, facecolor=colours(depth)))
                elif case in line.apart:
                    axes.plot(x, y, "x", color="#a3261d", markersize=5)
                elif case in line.asked:
                    axes.plot(x, y, ".", color="#999999", markersize=3)
        axes.set_xticks(range(len(shown)), shown, rotation=90)
        axes.set_yticks(range(len(lines)), [line.name for line in lines])
        axes.set(xlim=(-0.5, len(shown) - 0.5), ylim=(len(lines) - 0.5, -0.5))
        axes.grid(visible=False)
        key = "square: caught; cross: crash or refusal; dot: called, not seen; blank: not called or not asked"
        axes.set_title(key, fontsize=8)
        scale = mpl.cm.ScalarMappable(mpl.colors.Normalize(0, DECADES), colours)
        canvas.colorbar(scale, ax=axes, label="log10 of error over allowed", fraction=0.05, aspect=50)
    save(canvas, path)
