"""Matrix of faults against cases as SVG: which case caught a fault, and by how much."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

from validation.report.figures import save, styled

DECADES = 12.0  # of error over allowed, beyond which the colour no longer deepens


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
