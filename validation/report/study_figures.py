"""Figures of studies as SVG documents: error curves with their fits, error against time with the reference's band.

Style, colours and markers are those of the report; every point of a work-precision curve is labelled by its unknowns, a
failed one stays as a cross at the edge of the axes with its message in the legend.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from validation.report.figures import COLOURS, MARKERS, save, styled
from validation.report.tick_labels import PlainPowers, label_plainly

WIDE = 64  # characters of a label with which two columns do not fit
LABELLED = 2.5  # decades of an axis up to which twice and five times a power of ten have labels as well


@dataclass(frozen=True)
class Line:
    """One curve."""

    label: str
    x: Sequence[float]
    y: Sequence[float]
    notes: Sequence[str] = ()  # beside the points; empty for none
    grey: Sequence[bool] = ()  # points within the uncertainty of the reference; empty for none
    joined: bool = True  # whether a line joins the points; otherwise the curve is a line alone


@dataclass(frozen=True)
class Plot:
    """Axes with curves."""

    title: str
    xlabel: str
    ylabel: str
    lines: Sequence[Line]
    xscale: str = "log"
    yscale: str = "log"
    # label, x, y of dashed lines in the colours of the curves of the same place
    fits: Sequence[tuple[str, Sequence[float], Sequence[float]]] = ()
    # label and end of intervals of x shaded as the uncertainty of the reference
    bands: Sequence[tuple[str, float]] = ()
    failures: Sequence[str] = ()  # messages of points that failed
    size: tuple[float, float] = field(default=(6.8, 4.4))


def draw(plot: Plot) -> Figure:
    """The figure; also for a look at it in another format."""
    with styled():
        canvas = Figure(figsize=plot.size, layout="constrained")
        axes = canvas.subplots()
        for index, line in enumerate(plot.lines):
            _draw_line(axes, line, COLOURS[index % len(COLOURS)], MARKERS[index % len(MARKERS)])
        for index, (label, x, y) in enumerate(plot.fits):
            axes.plot(x, y, "--", color=COLOURS[index % len(COLOURS)], linewidth=1.0, label=label)
        axes.set(xlabel=plot.xlabel, ylabel=plot.ylabel, xscale=plot.xscale, yscale=plot.yscale)
        label_plainly(axes.xaxis, axes.yaxis)
        if plot.xscale == "log":
            axes.xaxis.set_minor_locator(LogLocator(subs=(2, 5)))
            axes.xaxis.set_minor_formatter(PlainPowers(minor_thresholds=(LABELLED, LABELLED)))
        for label, upper in plot.bands:
            axes.axvspan(axes.get_xlim()[0] if plot.xscale == "linear" else 1e-18, upper, color="#999999", alpha=0.18,
                         linewidth=0, label=label)  # fmt: skip
        if plot.bands:
            known = [x for line in plot.lines for x in line.x]
            axes.set_xlim(min([*known, *(upper for _, upper in plot.bands)]) / 4, max(known, default=1.0) * 4)
        for place, message in enumerate(plot.failures):
            cross = axes.plot([0.985], [0.03 + 0.04 * place], "x", color="#aa0000", label=f"failed: {message}")[0]
            cross.set(linestyle="none", transform=axes.transAxes, clip_on=False)
        axes.set_title(plot.title, fontsize=9.5)
        if plot.lines or plot.failures:
            longest = max(len(text) for text in axes.get_legend_handles_labels()[1])
            canvas.legend(loc="outside lower center", ncols=2 if longest < WIDE else 1, fontsize=7.5)
    return canvas


def write_svg(plot: Plot, path: Path) -> None:
    """The figure as an SVG document; equal numbers give equal files."""
    save(draw(plot), path)


def _draw_line(axes: Axes, line: Line, colour: str, marker: str) -> None:
    if not line.joined:
        axes.plot(line.x, line.y, "-", color=colour, linewidth=1.2, label=line.label)
        return
    axes.plot(line.x, line.y, "-", marker=marker, color=colour, linewidth=1.2, markersize=4.2, label=line.label)
    grey = [(x, y) for x, y, inside in zip(line.x, line.y, line.grey, strict=True) if inside] if line.grey else []
    if grey:
        axes.plot(*zip(*grey, strict=True), marker, color="#b8b8b8", markersize=4.4, linestyle="none")
    for x, y, note in zip(line.x, line.y, line.notes, strict=True) if line.notes else ():
        axes.annotate(note, (x, y), xytext=(3, 3), textcoords="offset points", fontsize=6.0, color=colour)
