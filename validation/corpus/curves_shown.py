"""Curves (convergence_curves.py) as a report shows them: errors beside the predicted rate, rates between neighbours."""

from collections.abc import Sequence

from validation.corpus.convergence_curves import Curve, predicted_line
from validation.harness.figure_data import axes, drawn, marks, trace
from validation.harness.schema import Cells, Figure, Table


def error_figure(name: str, caption: str, curves: Sequence[Curve]) -> Figure:
    """Errors as points, the predicted rate as lines through the last point fitted; every curve has a rate."""
    series = [
        marks(f"{one.id}: predicted {one.predicted:.3g}, fitted {one.rate.value:.3g}", one.sizes, one.errors)
        for one in curves
    ]
    for curve in curves:
        series.append(trace(f"predicted, {curve.id}", *predicted_line(curve), "dashed"))
    scale = "linear" if curves[0].law == "geometric" else "log"
    return drawn(name, caption, axes(curves[0].knob, "error", *series, xscale=scale, yscale="log"))


def error_table(curves: Sequence[Curve]) -> Table:
    """Errors with their rates between neighbours."""
    rows: list[Cells] = []
    for curve in curves:
        points = zip(curve.sizes, curve.errors, [None, *curve.rate.pairwise], strict=True)
        rows += [
            [curve.id, curve.knob, size, error, rate, "yes" if place in curve.rate.used else "no"]
            for place, (size, error, rate) in enumerate(points)
        ]
    return Table(
        caption="Errors, rates between neighbours (order, or factor per node), and which points were fitted.",
        columns=["curve", "knob", "size", "error", "rate", "fitted"],
        rows=rows,
    )
