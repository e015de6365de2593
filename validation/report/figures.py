"""Figures as inline SVG, drawn from the numbers of the report alone: solution above, signed error below.

Text stays text, ids are unique on the page, and equal numbers give equal SVG.
"""

from __future__ import annotations

import io
import re
from contextlib import AbstractContextManager
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bem.scene.atomic_file import write_atomically
from validation.harness.schema import Figure, Panel, Series

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Canvas

COLOURS = ("#0b5fa5", "#c8511b", "#2b7a4b", "#7a3e9d", "#8a6d00", "#444444")  # distinguished by colour-blind readers
MARKERS = ("o", "s", "^", "D", "v", "x")
MOST_INSIDE = 7  # series in a legend within the axes; more are listed below them
SETTINGS: Any = {
    "svg.fonttype": "none",
    "svg.hashsalt": "linecontact",
    "font.size": 9.0,
    "font.family": "sans-serif",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
}
WITHOUT_DATE = {
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Producer": None, "Creator": None},
}


def styled(**settings: Any) -> AbstractContextManager[None]:
    """Matplotlib with the settings of all figures and these; it is imported where something is drawn."""
    from matplotlib import rc_context

    return rc_context(SETTINGS | settings)


def canvas_of(figure: Figure) -> Canvas:
    """The figure drawn."""
    from matplotlib.figure import Figure as Canvas

    with styled():
        if figure.error is None:
            count = len(figure.solution.series)
            rows = -(-count // 2) if count > MOST_INSIDE else 0
            canvas = Canvas(figsize=(6.4, 3.9 + 0.19 * rows), layout="constrained")
            _draw(canvas.subplots(), figure.solution)
            return canvas
        canvas = Canvas(figsize=(6.4, 5.6), layout="constrained")
        above, below = canvas.subplots(2, 1, height_ratios=(2, 1))
        _draw(above, figure.solution)
        _draw(below, figure.error)
        if figure.error.yscale != "log":
            below.axhline(0.0, color="#888888", linewidth=0.8)
        if figure.error.yscale == "linear":
            below.ticklabel_format(axis="y", style="sci", scilimits=(-3, 3))
    return canvas


def save(canvas: Canvas, path: Path) -> None:
    """Write a figure as SVG or PDF, as the ending of the path says; equal figures give equal files."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, _printed(canvas, path.suffix.removeprefix(".")))


def _printed(canvas: Canvas, kind: str) -> bytes:
    """A figure as SVG or PDF; it is laid out once, whatever it is printed as: that takes as long as to print it."""
    stream = io.BytesIO()
    with styled(**{"pdf.fonttype": 42}):
        layout = canvas.get_layout_engine()
        if layout is not None:
            layout.execute(canvas)
            canvas.set_layout_engine(None)
        canvas.savefig(stream, format=kind, metadata=WITHOUT_DATE[kind])
    return stream.getvalue()


def svg_of(figure: Figure, prefix: str) -> str:
    """The figure as an SVG element with a role, a title (its caption) and a description (its axes and curves).

    The prefix makes its ids unique on the page.
    """
    return inline_svg(canvas_of(figure), prefix, figure.caption, described(figure))


def inline_svg(canvas: Canvas, prefix: str, title: str, description: str) -> str:
    """A drawn figure as `svg_of` gives it; `description` is text of an SVG."""
    text = _printed(canvas, "svg").decode()
    element = text[text.index("<svg") :]
    element = re.sub(r'\bid="([^"]+)"', rf'id="{prefix}-\1"', element)
    element = re.sub(r'(xlink:href|href)="#([^"]+)"', rf'\1="#{prefix}-\2"', element)
    element = re.sub(r"url\(#([^)]+)\)", rf"url(#{prefix}-\1)", element)
    names = f'role="img" aria-labelledby="{prefix}-title" aria-describedby="{prefix}-desc"'
    said = f'<title id="{prefix}-title">{escape(title)}</title><desc id="{prefix}-desc">{description}</desc>'
    return re.sub(r"<svg ([^>]*)>", lambda opening: f"<svg {names} {opening[1]}>{said}", element, count=1)


def described(figure: Figure) -> str:
    """What a figure shows, in words, as text of an SVG.

    Examples
    --------
    >>> from validation.harness.schema import Panel, Series
    >>> panel = Panel(xlabel="x", ylabel="load", series=[Series(label="a & b", x=[0.0], y=[1.0])])
    >>> described(Figure(id="one", caption="One point.", solution=panel))
    'load against x: a &amp; b.'
    """
    panels = [figure.solution] if figure.error is None else [figure.solution, figure.error]
    words = [f"{panel.ylabel} against {panel.xlabel}: {', '.join(s.label for s in panel.series)}." for panel in panels]
    return escape(" ".join(words))


def _draw(axes: Axes, panel: Panel) -> None:
    from validation.report.tick_labels import label_plainly

    for index, series in enumerate(panel.series):
        hue = (index if series.hue is None else series.hue) % len(COLOURS)
        _draw_series(axes, series, COLOURS[hue], MARKERS[hue])
    axes.set(xlabel=panel.xlabel, ylabel=panel.ylabel, xscale=panel.xscale, yscale=panel.yscale)
    label_plainly(axes.xaxis, axes.yaxis)
    if len(panel.series) > MOST_INSIDE:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, fontsize=8.0)
    else:
        axes.legend()


def _draw_series(axes: Axes, series: Series, colour: str, marker: str) -> None:
    x, y, upper = (np.array(values, dtype=np.float64) for values in (series.x, series.y, series.upper or ()))
    if series.style == "band":
        axes.fill_between(x, y, upper, color=colour, alpha=0.2, linewidth=0, label=series.label)
    elif series.style == "bars":
        half = (upper - y) / 2
        axes.errorbar(x, y + half, half, fmt="none", ecolor=colour, elinewidth=1.0, capsize=2.5, label=series.label)
    elif series.style == "thin":
        shade = {"color": "#9aa0a6"} if series.hue is None else {"color": colour, "alpha": 0.35}
        axes.plot(x, y, "-", linewidth=0.5, zorder=1.5, label=series.label, **shade)
    elif series.style == "dots":
        axes.plot(x, y, ".", color=colour, markersize=1.8, alpha=0.45, linestyle="none", label=series.label)
    elif series.style == "points":
        axes.plot(x, y, marker, color=colour, markersize=3.6, linestyle="none", label=series.label)
    else:
        axes.plot(x, y, "--" if series.style == "dashed" else "-", color=colour, linewidth=1.4, label=series.label)
