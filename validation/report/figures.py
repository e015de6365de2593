"""Figures drawn from the numbers of the report alone, as inline SVG, and these numbers as CSV.

Text stays text, ids are unique on the page, and equal numbers give equal SVG.  What is written into a page is the tree
of the SVG, every text and value of it escaped; a text that cannot be drawn as mathematics is drawn as it is written.
The CSV has one line for each point: series, x, y, and upper for bands.
"""

from __future__ import annotations

import csv
import io
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from markupsafe import Markup

from validation.harness.figure_data import Figure, Panel, Series
from validation.report.pages import printable

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


def styled() -> AbstractContextManager[None]:
    """Set the settings of all figures; Matplotlib is imported where something is drawn."""
    from bem.scene.plots import own_settings

    return own_settings(**SETTINGS)


def canvas_of(figure: Figure) -> Canvas:
    """Draw a figure."""
    from matplotlib.figure import Figure as Canvas

    with styled():
        count = len(figure.solution.series)
        rows = -(-count // 2) if count > MOST_INSIDE else 0
        canvas = Canvas(figsize=(6.4, 3.9 + 0.19 * rows), layout="constrained")
        _draw(canvas.subplots(), figure.solution)
    return canvas


def _printed(canvas: Canvas) -> bytes:
    """Print a figure as SVG."""
    stream = io.BytesIO()
    with styled():
        _make_drawable(canvas)
        canvas.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


def _make_drawable(canvas: Canvas) -> None:
    """Escape in every text the characters that cannot be drawn; an equation that cannot be set is shown as written."""
    from matplotlib.mathtext import MathTextParser
    from matplotlib.text import Text

    parse = MathTextParser("path").parse
    for text in canvas.findobj(Text):
        text.set_text(printable(text.get_text()))
        if text.get_text().count("$") > 1:
            try:
                parse(text.get_text())
            except (ValueError, RecursionError):
                text.set_parse_math(False)


def svg_of(figure: Figure, prefix: str) -> Markup:
    """Return a figure as an SVG element with a role, a title (its caption) and a description (its axes and curves).

    The prefix makes its ids unique on the page.
    """
    return inline_svg(canvas_of(figure), prefix, figure.caption, described(figure))


def inline_svg(canvas: Canvas, prefix: str, title: str, description: str) -> Markup:
    """Return a drawn figure as an SVG element with a role, a title and a description, its ids prefixed."""
    root = ElementTree.fromstring(_printed(canvas))
    for parent in list(root.iter()):
        for child in list(parent):
            if _plain(child.tag) in ("metadata", "style"):  # the style of every figure stands in style.css
                parent.remove(child)
    for element in root.iter():
        element.tag = _plain(element.tag)
        given = {_plain(name): value for name, value in element.attrib.items()}
        element.attrib.clear()
        element.attrib.update((name, _renamed(name, value, prefix)) for name, value in given.items())
    root.attrib |= {"role": "img", "aria-labelledby": f"{prefix}-title", "aria-describedby": f"{prefix}-desc"}
    for place, (tag, words) in enumerate((("title", title), ("desc", description))):
        element = ElementTree.Element(tag, {"id": f"{prefix}-{tag}"})
        element.text = printable(words)
        root.insert(place, element)
    return Markup(ElementTree.tostring(root, encoding="unicode"))


def _plain(name: str) -> str:
    """Return a name without its namespace, because a page writes no namespaces."""
    return name.rpartition("}")[2]


def _renamed(name: str, value: str, prefix: str) -> str:
    """Return an SVG attribute with the prefix before the ids that it defines or refers to."""
    if name == "id":
        return f"{prefix}-{value}"
    if name == "href":
        return f"#{prefix}-{value.removeprefix('#')}"
    return value.replace("url(#", f"url(#{prefix}-")


def described(figure: Figure) -> str:
    """Describe the axes and curves of a figure in words."""
    panel = figure.solution
    names = ", ".join(series.label for series in panel.series if series.label)
    return f"{panel.ylabel} against {panel.xlabel}: {names}."


def _draw(axes: Axes, panel: Panel) -> None:
    from matplotlib.ticker import MaxNLocator

    from validation.report.tick_labels import label_plainly

    for index, series in enumerate(panel.series):
        hue = (index if series.hue is None else series.hue) % len(COLOURS)
        _draw_series(axes, series, COLOURS[hue], MARKERS[hue])
    axes.set(xlabel=panel.xlabel, ylabel=panel.ylabel)
    axes.set(xscale=_scale(panel.xscale, [x for series in panel.series for x in series.x]))
    axes.set(yscale=_scale(panel.yscale, [y for series in panel.series for y in (*series.y, *(series.upper or ()))]))
    label_plainly(axes.xaxis, axes.yaxis)
    counted = all(x is not None and float(x).is_integer() for series in panel.series for x in series.x)
    if counted and axes.get_xscale() == "linear":
        axes.xaxis.set_major_locator(MaxNLocator("auto", steps=[1, 2, 5, 10], integer=True))
    if not axes.get_legend_handles_labels()[1]:
        return
    if len(panel.series) > MOST_INSIDE:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2, fontsize=8.0)
    else:
        axes.legend()


def _scale(asked: str, values: list[float | None]) -> str:
    """Return the scale asked for, but linear if no value is positive."""
    positive = any(value is not None and 0 < value < np.inf for value in values)
    return asked if positive or asked != "log" else "linear"


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
    elif series.style == "points":
        axes.plot(x, y, marker, color=colour, markersize=3.6, linestyle="none", label=series.label)
    else:
        axes.plot(x, y, "--" if series.style == "dashed" else "-", color=colour, linewidth=1.4, label=series.label)


def table_of(figure: Figure) -> str:
    """Return the numbers of a figure as CSV."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(["series", "x", "y", "upper"])
    for series in figure.solution.series:
        upper = series.upper or [None] * len(series.x)
        points = zip(series.x, series.y, upper, strict=True)
        writer.writerows([series.label, *point] for point in points if point[0] is not None)
    return stream.getvalue()
