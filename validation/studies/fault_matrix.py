"""The figure of the fault study: faults against cases, how far each row that saw a fault is beyond what is allowed."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib as mpl
from matplotlib.figure import Figure as Canvas

from validation.report.figures import SETTINGS
from validation.runner import write_atomically

if TYPE_CHECKING:
    from collections.abc import Sequence

    from validation.studies.faults import Finding

DECADES = 12.0  # beyond which the colour no longer deepens


def write_matrix(path: Path, cases: Sequence[str], findings: Sequence[Finding]) -> None:
    """Draw faults (rows) against cases (columns) as SVG.

    Parameters
    ----------
    path : Path
    cases : sequence of str
        Those of the control run, in order; columns of cases that were shown no fault are left out.
    findings : sequence of Finding
        One row each.
    """
    shown = [case for case in cases if any(case in finding.asked for finding in findings)]
    with mpl.rc_context(SETTINGS):
        labels = max(len(finding.fault.id) for finding in findings), max(map(len, shown), default=0)
        size = (4.0 + 0.09 * labels[0] + 0.3 * len(shown), 3.0 + 0.09 * labels[1] + 0.22 * len(findings))
        canvas = Canvas(figsize=size, layout="constrained")
        axes = canvas.subplots()
        colours = mpl.colormaps["viridis_r"]
        for y, finding in enumerate(findings):
            for x, case in enumerate(shown):
                excesses = [sight.excess for sight in finding.sights if sight.case == case]
                if excesses:
                    depth = min(math.log10(max(excesses)), DECADES) / DECADES if max(excesses) < math.inf else 1.0
                    axes.add_patch(mpl.patches.Rectangle((x - 0.45, y - 0.45), 0.9, 0.9, facecolor=colours(depth)))
                elif case in finding.apart:
                    axes.plot(x, y, "x", color="#a3261d", markersize=5)
                elif case in finding.asked:
                    axes.plot(x, y, ".", color="#999999", markersize=3)
        axes.set_xticks(range(len(shown)), shown, rotation=90)
        axes.set_yticks(range(len(findings)), [finding.fault.id for finding in findings])
        axes.set_xlim(-0.5, len(shown) - 0.5)
        axes.set_ylim(len(findings) - 0.5, -0.5)
        axes.grid(visible=False)
        axes.set_title("square: caught; cross: crash or refusal; dot: called, not seen; blank: not called or not asked")
        axes.title.set_fontsize(8)
        scale = mpl.cm.ScalarMappable(mpl.colors.Normalize(0, DECADES), colours)
        canvas.colorbar(scale, ax=axes, label="log10 of error over allowed")
        stream = io.StringIO()
        canvas.savefig(stream, format="svg", metadata={"Date": None, "Creator": None})
    write_atomically(path, stream.getvalue())
