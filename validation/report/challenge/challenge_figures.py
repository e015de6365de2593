"""Figures of the challenge: error against seconds of every recorded solver, and of the one that is judged.

The error of a solver on a problem is the geometric mean over its answers, 10 to the minus mean digits; a key's own
uncertainty is the least that shows.  A submission has no seconds: it is a horizontal line.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from validation.report.figures import COLOURS, inline_svg, styled
from validation.report.tick_labels import label_plainly

HUES = (*COLOURS, "#b0306a", "#2f8f9d", "#6b8e23", "#a0522d")
SIGNS = ("o", "s", "^", "D", "v", "x", "P", "<", ">", "h")
JUDGED = "#111111"
SIZE = (6.8, 4.6)
DECADES = 10.0  # of seconds, from which powers of ten alone are labelled


@dataclass(frozen=True)
class SolverCurve:
    """A solver: its points (seconds, error) from setting to setting; seconds None for answers without."""

    label: str
    points: tuple[tuple[float | None, float], ...]


def drawn_standings(title: str, recorded: Sequence[SolverCurve], judged: SolverCurve | None = None) -> Figure:
    """Error against seconds on logarithmic axes; the judged solver as stars, or as a line where it has no seconds."""
    with styled():
        canvas = Figure(figsize=SIZE, layout="constrained")
        axes = canvas.subplots()
        for index, curve in enumerate(recorded):
            known = [(x, y) for x, y in curve.points if x is not None]
            if known:
                axes.plot(*zip(*known, strict=True), marker=SIGNS[index % len(SIGNS)], color=HUES[index % len(HUES)],
                          linewidth=1.1, markersize=4.4, label=curve.label)  # fmt: skip
        for x, y in judged.points if judged is not None else ():
            assert judged is not None
            if x is None:
                axes.axhline(y, color=JUDGED, linestyle="--", linewidth=1.3, label=judged.label)
            else:
                axes.plot([x], [y], "*", color=JUDGED, markersize=13, label=judged.label)
        axes.set(xlabel="CPU seconds", ylabel="error over scale, geometric mean of the answers")
        axes.set(xscale="log", yscale="log")
        label_plainly(axes.xaxis, axes.yaxis)
        axes.set_title(title, fontsize=9.5)
        if axes.get_legend_handles_labels()[1]:
            canvas.legend(loc="outside lower center", ncols=2, fontsize=7.5)
        low, high = axes.get_xlim()
        if high > DECADES * low:
            axes.xaxis.set_minor_formatter(NullFormatter())
    return canvas


def standings_svg(
    prefix: str, title: str, recorded: Sequence[SolverCurve], judged: SolverCurve | None = None
) -> Markup:
    """The same as an element of a page, described in words."""
    every = [*recorded, judged] if judged is not None else recorded
    told = (f"{curve.label}: {', '.join(_word(x, y) for x, y in curve.points)}." for curve in every if curve.points)
    return inline_svg(drawn_standings(title, recorded, judged), prefix, title, " ".join(told))


def error_of_digits(digits: Sequence[float]) -> float:
    """10 to the minus mean digits.

    Examples
    --------
    >>> error_of_digits([2.0, 4.0])
    0.001
    """
    return math.pow(10.0, -math.fsum(digits) / len(digits))


def _word(seconds: float | None, error: float) -> str:
    return f"error {error:.1e}" + ("" if seconds is None else f" in {seconds:.2g} s")
